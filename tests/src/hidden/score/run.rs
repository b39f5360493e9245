//! Runs `palpate gap` on every rig below given folders.

use super::answer::Answer;
use super::further::{self, MOTION};
use super::process::{self, Took};
use super::scored::Scored;
use super::truth::Truth;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// How to run the command.
#[derive(Clone, Debug)]
pub struct Options {
    /// The program `palpate`.
    pub palpate: PathBuf,
    /// The folder for all answers.
    pub out: PathBuf,
    /// How many programs run at a time.
    pub jobs: usize,
    /// Whether the answers of the last run are scored, without another run.
    pub reuse: bool,
    /// Whether a rig's second log (richer.csv) is given as well, where there is one.
    pub richer: bool,
    /// Arguments that are passed on to `gap`.
    pub arguments: Vec<String>,
}

/// The folders with a truth.json at any depth, sorted.
pub fn rigs(dir: &Path) -> Vec<PathBuf> {
    if dir.join("truth.json").is_file() {
        return vec![dir.to_path_buf()];
    }
    let entries = std::fs::read_dir(dir).into_iter().flatten().flatten();
    let mut below: Vec<PathBuf> = entries.map(|e| e.path()).filter(|p| p.is_dir()).collect();
    below.sort();
    below.iter().flat_map(|path| rigs(path)).collect()
}

/// The log of a rig, gzipped or not.
pub(crate) fn measured(rig: &Path) -> PathBuf {
    let plain = rig.join("measured.csv");
    match plain.is_file() {
        true => plain,
        false => rig.join("measured.csv.gz"),
    }
}

/// Runs the command on all rigs and scores its answers, in the order of the rigs.
pub fn all(rigs: &[PathBuf], options: &Options) -> Result<Vec<Scored>, String> {
    each(rigs, options.jobs, |rig, index| score(rig, index, options))
}

/// Scores rigs, several at a time, in their order.
pub fn each(
    rigs: &[PathBuf],
    jobs: usize,
    score: impl Fn(&Path, usize) -> Result<Scored, String> + Sync,
) -> Result<Vec<Scored>, String> {
    let next = AtomicUsize::new(0);
    let scored: Mutex<Vec<(usize, Result<Scored, String>)>> = Mutex::new(Vec::new());
    std::thread::scope(|scope| {
        for _ in 0..jobs.max(1) {
            scope.spawn(|| {
                loop {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    let Some(rig) = rigs.get(index) else { break };
                    let one = score(rig, index);
                    eprint!("\r{} of {} ", index + 1, rigs.len());
                    if let Ok(mut scored) = scored.lock() {
                        scored.push((index, one));
                    }
                }
            });
        }
    });
    eprintln!();
    let mut scored = scored.into_inner().map_err(|e| e.to_string())?;
    scored.sort_by_key(|(index, _)| *index);
    scored.into_iter().map(|(_, one)| one).collect()
}

fn score(rig: &Path, index: usize, options: &Options) -> Result<Scored, String> {
    let truth = Truth::read(&rig.join("truth.json"))?;
    let parent = rig.parent().and_then(Path::file_name).unwrap_or_default();
    let name = rig.file_name().unwrap_or_default();
    let out = options.out.join(format!(
        "{index:04}-{}-{}",
        parent.display(),
        name.display()
    ));
    let measured = measured(rig);
    let richer = Some(rig.join("richer.csv")).filter(|path| options.richer && path.is_file());
    let logs: Vec<PathBuf> = std::iter::once(measured.clone()).chain(richer).collect();
    let answer = answered(rig, &logs, &out, options);
    let open = answer.as_ref().is_ok_and(|a| a.verdict == "ambiguous");
    let motion = out.join(MOTION);
    let further = (truth.kind == "poor" && open && motion.is_file()).then(|| {
        let log = match out.join("further.csv") {
            old if options.reuse => old,
            _ => further::record(rig, &motion, &out)?,
        };
        answered(rig, &[measured, log], &out.join("further"), options)
    });
    Ok(Scored {
        rig: rig.to_path_buf(),
        truth,
        answer,
        further,
    })
}

/// The answer to logs of a rig, from a new run or from the last one.
fn answered(rig: &Path, logs: &[PathBuf], out: &Path, options: &Options) -> Result<Answer, String> {
    let took = if options.reuse {
        took(out)
    } else {
        let took = run(rig, logs, out, options)?;
        let text = json!({ "wall_s": took.seconds, "cpu_s": took.cpu_s }).to_string();
        let path = out.join("took.json");
        std::fs::write(&path, text).map_err(|e| format!("{}: {e}", path.display()))?;
        took
    };
    Ok(Answer {
        seconds: took.seconds,
        cpu_s: took.cpu_s,
        ..Answer::read(&out.join("gap.json"))?
    })
}

/// The times of the last run; NaN where they were not written down.
fn took(out: &Path) -> Took {
    let text = std::fs::read_to_string(out.join("took.json")).unwrap_or_default();
    let json: Value = serde_json::from_str(&text).unwrap_or_default();
    let number = |name: &str| json[name].as_f64().unwrap_or(f64::NAN);
    Took {
        seconds: number("wall_s"),
        cpu_s: number("cpu_s"),
    }
}

fn run(rig: &Path, logs: &[PathBuf], out: &Path, options: &Options) -> Result<Took, String> {
    std::fs::create_dir_all(out).map_err(|e| format!("{}: {e}", out.display()))?;
    for old in ["gap.json", MOTION, "further.csv"] {
        // An old answer must not stand for a run that fails; it is no error if there is none.
        let _ = std::fs::remove_file(out.join(old));
    }
    let mut command = Command::new(&options.palpate);
    command.arg("gap").arg("--model").arg(rig.join("base.toml"));
    for log in logs {
        command.arg("--log").arg(log);
    }
    command.arg("--out").arg(out).args(&options.arguments);
    process::run(&mut command, &out.join("stderr.txt"))
}
