//! The README's way from nothing to a first estimate, as it is printed there.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::common::{Folder, complained, press, said};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The commands of the first block below "Your own log", without their comments.
fn commands() -> Vec<String> {
    let readme = std::fs::read_to_string(root().join("README.md")).unwrap();
    let (_, below) = readme.split_once("## Your own log").unwrap();
    let block = below.split("```").nth(1).unwrap();
    let lines = block
        .lines()
        .map(|line| line.split('#').next().unwrap().trim());
    lines
        .filter(|line| !line.is_empty())
        .map(str::to_string)
        .collect()
}

/// What a machine exports, of a press into 2 N/mm.
fn export() -> String {
    let rows = press().into_iter();
    let rows = rows.map(|[t, x, f]| format!("{t:.3};{:.4};{f:.4}\n", x * 1e3).replace('.', ","));
    format!(
        "\"Prüfprotokoll\"\n\nPrüfzeit;Standardweg;Standardkraft\ns;mm;N\n{}",
        rows.collect::<String>()
    )
}

#[test]
fn four_commands_lead_from_a_clone_to_an_estimate() {
    let commands = commands();
    assert_eq!(commands.len(), 4, "{commands:?}");
    let folder = Folder::new();
    // A source archive without its history is what a clone would give.
    let is_repository = root().join(".git").exists();
    let home = match is_repository {
        true => {
            let line = commands[0].replace("REPOSITORY", root().to_str().unwrap());
            let done = Command::new("sh")
                .args(["-c", &line])
                .current_dir(folder.path(""))
                .output()
                .unwrap();
            assert!(done.status.success(), "{line}: {}", complained(&done));
            folder.path("palpate")
        }
        false => root(),
    };
    assert_installs_palpate(&commands[1], &home);
    folder.write("your-log.csv", export());
    for line in &commands[2..] {
        let line = line.strip_prefix("palpate ").unwrap();
        let text = folder.succeeds(line);
        assert!(
            text.contains("read as: time from `Prüfzeit` in s"),
            "{text}"
        );
    }
    assert!(folder.read("result/report.html").contains("</html>"));
    let json: serde_json::Value =
        serde_json::from_str(&folder.read("result/estimate.json")).unwrap();
    let stiffness = json["parameters"]["stiffness"]["value"].as_f64().unwrap();
    assert!((stiffness / 2000.0 - 1.0).abs() < 0.01, "{stiffness}");
}

/// The package that is installed has the command as its program: this test runs the one that was built from it.
fn assert_installs_palpate(line: &str, home: &Path) {
    let path = line.strip_prefix("cargo install --path ").unwrap();
    let manifest = home.join(path).join("Cargo.toml");
    let done = Command::new(env!("CARGO"))
        .args([
            "metadata",
            "--no-deps",
            "--format-version",
            "1",
            "--manifest-path",
        ])
        .arg(&manifest)
        .output()
        .unwrap();
    assert!(done.status.success(), "{}", complained(&done));
    let metadata: serde_json::Value = serde_json::from_str(&said(&done)).unwrap();
    let packages = metadata["packages"].as_array().unwrap().iter();
    let targets = packages.flat_map(|package| package["targets"].as_array().unwrap());
    let mut programs = targets
        .filter(|target| target["kind"][0] == "bin")
        .map(|target| &target["name"]);
    assert!(programs.any(|name| name == "palpate"), "{metadata}");
}
