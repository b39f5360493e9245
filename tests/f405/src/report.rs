//! The table of what was measured: a file for each story, which `cargo xtask test` prints together.

use std::fmt::Display;
use std::path::PathBuf;
use std::{env, fs};

/// The rows of a story.
pub struct Report {
    story: &'static str,
    rows: Vec<String>,
}

impl Report {
    /// The report of a story.
    pub fn new(story: &'static str) -> Self {
        Report {
            story,
            rows: Vec::new(),
        }
    }

    /// Adds a row: what, and how much with its unit.
    pub fn row(&mut self, what: impl Display, value: impl Display) {
        let row = format!("| {} | {what} | {value} |", self.story);
        println!("{row}");
        self.rows.push(row);
    }
}

impl Drop for Report {
    fn drop(&mut self) {
        // Where nobody collects the table, the rows are in the test's output.
        if let Some(directory) = env::var_os("PALPATE_F405_REPORT") {
            let name = self.story.replace([' ', ',', '/'], "_");
            let _ = fs::create_dir_all(&directory);
            let file = PathBuf::from(directory).join(name);
            let _ = fs::write(file, self.rows.join("\n") + "\n");
        }
    }
}
