//! What the tests of the command share: a folder that disappears after the test, the command run in it, and
//! a good log.

// Every test program compiles this and uses a part of it.
#![allow(dead_code)]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;
use tempfile::TempDir;

/// A folder that disappears with its test.
pub(crate) struct Folder(TempDir);

impl Folder {
    pub(crate) fn new() -> Folder {
        Folder(tempfile::tempdir().unwrap())
    }

    /// A folder with one file in it.
    pub(crate) fn with(name: &str, content: impl AsRef<[u8]>) -> Folder {
        let folder = Folder::new();
        folder.write(name, content);
        folder
    }

    pub(crate) fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), content).unwrap();
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub(crate) fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.path(name)).unwrap()
    }

    /// The command, to be run in this folder.
    pub(crate) fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_palpate"));
        command.current_dir(self.0.path()).args(arguments);
        command
    }

    /// `palpate` with the arguments of a line that holds no quotes, run in this folder.
    pub(crate) fn palpate(&self, line: &str) -> Output {
        let arguments: Vec<&str> = line.split_whitespace().collect();
        self.command(&arguments).output().unwrap()
    }

    /// Runs a line that must succeed, and gives its standard output.
    pub(crate) fn succeeds(&self, line: &str) -> String {
        let done = self.palpate(line);
        assert_eq!(done.status.code(), Some(0), "{line}: {}", complained(&done));
        said(&done)
    }
}

/// Every JSON file of a run has to be as its schema says.
fn assert_as_described(folder: &Path) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if path.is_dir() {
            assert_as_described(&path);
        } else if let Some(kind) = name.strip_suffix(".json") {
            let schemas = Path::new(env!("CARGO_MANIFEST_DIR")).join("schemas");
            // A file of the test itself has none.
            let Ok(schema) = std::fs::read_to_string(schemas.join(format!("{kind}.schema.json")))
            else {
                continue;
            };
            let schema = serde_json::from_str(&schema).unwrap();
            let text = std::fs::read_to_string(&path).unwrap();
            let written = serde_json::from_str(&text).unwrap();
            let validator = jsonschema::validator_for(&schema).unwrap();
            let errors = validator.iter_errors(&written);
            let wrong: Vec<String> = errors
                .map(|e| format!("{}: {e}", e.instance_path()))
                .collect();
            assert!(wrong.is_empty(), "{name}: {}", wrong.join("; "));
        }
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        if !std::thread::panicking() {
            assert_as_described(self.0.path());
        }
    }
}

/// The path of a record in tests/data.
pub(crate) fn record(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data");
    path.join(name).to_str().unwrap().to_string()
}

/// The ids of the effects that a gap.json names.
pub(crate) fn named(json: &serde_json::Value) -> Vec<&str> {
    let effects = json["effects"].as_array().unwrap();
    effects
        .iter()
        .map(|effect| effect["id"].as_str().unwrap())
        .collect()
}

/// The standard output of the command.
pub(crate) fn said(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

/// The standard error of the command.
pub(crate) fn complained(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

/// The text with every run of blanks and line breaks as one plain space, so that wrapped sentences are in
/// one piece.
pub(crate) fn flowing(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// A model to simulate.
pub(crate) const MODEL: &str = "[environment]\nlaw = \"hunt_crossley\"\nstiffness = 1350.0\n\
                     damping = 36.0\nexponent = 1.35\n";

/// Rows of time (s), position (m) and force (N): two presses of 3 mm into 2 N/mm at 1 kHz, after 0.3 s of
/// rest 1 mm before the surface, with 5 mN of noise.
pub(crate) fn press() -> Vec<[f64; 3]> {
    let row = |i: u32| {
        let time = f64::from(i) * 1e-3;
        let swing = 1.0 - (std::f64::consts::TAU * (time - 0.3).max(0.0)).cos();
        let position = 2e-3 * swing - 1e-3;
        [
            time,
            position,
            2000.0 * position.max(0.0) + 0.0173 * uniform(i),
        ]
    };
    (0..2000).map(row).collect()
}

/// Noise between −½ and ½, the same at the same place.
fn uniform(place: u32) -> f64 {
    let mut hash = place.wrapping_mul(0x9e37_79b9);
    hash = (hash ^ (hash >> 15)).wrapping_mul(0x85eb_ca6b);
    hash = (hash ^ (hash >> 13)).wrapping_mul(0xc2b2_ae35);
    f64::from(hash ^ (hash >> 16)) / f64::from(u32::MAX) - 0.5
}

/// The text of a log with these rows.
pub(crate) fn csv(rows: impl IntoIterator<Item = [f64; 3]>) -> String {
    let lines = rows
        .into_iter()
        .map(|[t, x, f]| format!("{t:.3},{x:.6},{f:.3}\n"));
    format!("t_s,x_m,f_n\n{}", lines.collect::<String>())
}

/// How far strokes have grown (1) within 2 s, without a step of their acceleration.
pub(crate) fn grown(t: f64) -> f64 {
    let share = (t / 2.0).min(1.0);
    share.powi(3) * (10.0 - 15.0 * share + 6.0 * share * share)
}

/// The tables of effects in a model file, each its id and its numbers.
pub(crate) fn tables(effects: &[(&str, &str)]) -> String {
    let effect = |(id, numbers): &(&str, &str)| format!("[[effect]]\nid = \"{id}\"\n{numbers}\n");
    effects.iter().map(effect).collect()
}

/// A way that starts and ends at rest: how far it has come (1) after a share of its time.
pub(crate) fn rounded(share: f64) -> f64 {
    share * share * (3.0 - 2.0 * share)
}

/// A press: how far it is (1) a time (s) after it began, with ways in and out of `way_s` and a hold of `hold_s` between them.
pub(crate) fn pressed(at: f64, way_s: f64, hold_s: f64) -> f64 {
    let out = way_s + hold_s;
    match at {
        at if at < way_s => rounded(at / way_s),
        at if at < out => 1.0,
        at if at < out + way_s => 1.0 - rounded((at - out) / way_s),
        _ => 0.0,
    }
}

/// Where a probe is (m) that rests for 0.6 s and then presses so often, 1.45 s each, to three depths of up to `depth_m`
/// under a surface at 0.
pub(crate) fn presses_m(t: f64, depth_m: f64, presses: u32) -> f64 {
    let at = (t - 0.6).max(0.0);
    let press = (at / 1.45) as u32;
    let depth = [1.0, 0.7, 0.85][press as usize % 3];
    let way = match press < presses {
        true => pressed(at.rem_euclid(1.45), 0.3, 0.4),
        false => 0.0,
    };
    depth_m * (-0.4 + (0.4 + depth) * way)
}

/// Runs `estimate` on a log and reads its numbers.
pub(crate) fn estimated(folder: &Folder, log: &str, options: &str) -> Value {
    folder.succeeds(&format!("estimate {log} --out out {options}"));
    serde_json::from_str(&folder.read("out/estimate.json")).unwrap()
}

/// A number of a JSON document.
pub(crate) fn number(json: &Value, path: &str) -> f64 {
    let value = json.pointer(path).and_then(Value::as_f64);
    value.unwrap_or_else(|| panic!("no {path} in {json}"))
}

/// Value and standard error of a parameter in `estimate.json`.
pub(crate) fn parameter(json: &Value, name: &str) -> (f64, f64) {
    let of = |field: &str| number(json, &format!("/parameters/{name}/{field}"));
    (of("value"), of("std_error"))
}

/// White noise of variance 1, the same at the same place.
pub(crate) fn white(place: u32) -> f64 {
    (0..12).map(|k| uniform(12 * place + k)).sum()
}
