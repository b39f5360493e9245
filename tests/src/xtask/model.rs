//! The board's images on the model of the board, tests/f405.

use crate::root;
use crate::step::{command, run};
use std::fs;
use std::path::{Path, PathBuf};

/// Runs the stories on the images in `environment`, and prints what they measured.
pub(crate) fn stories(environment: &[(&'static str, PathBuf)]) -> Result<(), String> {
    let root = root();
    let report = root.join("target/f405/report");
    // Rows of stories that no longer exist would be printed as well.
    let _ = fs::remove_dir_all(&report);
    let mut cargo = command("cargo", &root);
    cargo.args(["test", "--locked", "--manifest-path"]);
    cargo.args(["tests/f405/Cargo.toml", "--target-dir"]);
    cargo.arg(root.join("target/f405"));
    cargo.envs(environment.iter().map(|(name, path)| (name, path)));
    cargo.env("PALPATE_F405_REPORT", &report);
    let result = run("stories of the board, on its model", cargo);
    print(&report);
    result
}

/// Prints the rows of all stories as one table.
fn print(report: &Path) {
    let Ok(entries) = fs::read_dir(report) else {
        return;
    };
    let mut files: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    files.sort();
    println!("\n| story | what | measured |\n|---|---|---|");
    for file in files {
        print!("{}", fs::read_to_string(file).unwrap_or_default());
    }
}
