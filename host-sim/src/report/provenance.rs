//! The provenance of a report: everything that is needed to make it again.

use std::fmt::Write;
use std::io::{self, Read};
use std::path::Path;

use sha2::{Digest, Sha256};

use super::html::escape;
use crate::log::bytes;

/// A file that a report was made from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Input {
    name: String,
    hash: String,
}

impl Input {
    /// An input by its name and a hash that was calculated elsewhere.
    pub fn new(name: impl Into<String>, hash: impl Into<String>) -> Input {
        Input {
            name: name.into(),
            hash: hash.into(),
        }
    }

    /// Reads the file, or standard input, and calculates its SHA-256. The hash is that of the bytes on disk: `sha256sum` gives
    /// the same, also for a `.csv.gz`.
    pub fn of_file(path: &Path) -> io::Result<Input> {
        let mut file = bytes(path)?;
        let mut hasher = Sha256::new();
        let mut block = vec![0; 1 << 16];
        loop {
            match file.read(&mut block)? {
                0 => break,
                n => hasher.update(&block[..n]),
            }
        }
        let hex = hasher
            .finalize()
            .iter()
            .fold(String::new(), |mut hex, byte| {
                let _ = write!(hex, "{byte:02x}");
                hex
            });
        Ok(Input::new(
            path.display().to_string(),
            format!("sha256:{hex}"),
        ))
    }
}

/// What a report was made from: command, version, inputs, settings.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Provenance {
    command: String,
    inputs: Vec<Input>,
    settings: Vec<(String, String)>,
}

impl Provenance {
    /// The provenance of a command as it was given; the version of this package is added.
    pub fn new(command: impl Into<String>) -> Provenance {
        Provenance {
            command: command.into(),
            ..Provenance::default()
        }
    }

    /// The provenance of the command that started this process.
    pub fn of_this_process() -> Provenance {
        let arguments: Vec<String> = std::env::args().skip(1).collect();
        Provenance::new(format!("palpate {}", arguments.join(" ")).trim_end())
    }

    /// Adds a file that was read.
    pub fn input(mut self, input: Input) -> Provenance {
        self.inputs.push(input);
        self
    }

    /// Adds a setting that the result depends on, with its unit in the value.
    pub fn setting(mut self, name: impl Into<String>, value: impl Into<String>) -> Provenance {
        self.settings.push((name.into(), value.into()));
        self
    }

    pub(super) fn push_html(&self, out: &mut String) {
        out.push_str(
            "<section id=\"provenance\">\n<h2>Provenance</h2>\n<div class=\"scroll\"><table>\n<tbody>\n",
        );
        let mut row = |name: &str, value: &str, class: &str| {
            let (name, value) = (escape(name), escape(value));
            let _ = writeln!(
                out,
                "<tr><th scope=\"row\">{name}</th><td class=\"{class}\">{value}</td></tr>"
            );
        };
        row("Command", &self.command, "code");
        row(
            "Version",
            concat!("palpate ", env!("CARGO_PKG_VERSION")),
            "code",
        );
        for input in &self.inputs {
            row("Input", &format!("{}\n{}", input.name, input.hash), "code");
        }
        for (name, value) in &self.settings {
            row(name, value, "code");
        }
        out.push_str("</tbody>\n</table></div>\n</section>\n");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hash_is_the_one_that_sha256sum_prints() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        std::fs::write(&path, "abc").unwrap();
        let input = Input::of_file(&path).unwrap();
        assert_eq!(
            input.hash,
            "sha256:ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"
        );
    }
}
