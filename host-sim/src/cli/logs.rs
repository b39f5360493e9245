//! Which logs a verb is given: files, folders, patterns, standard input.

use std::path::{Path, PathBuf};

use crate::diagnostic::Diagnostic;
use crate::log::STANDARD_INPUT;

/// Endings of the files that a folder is searched for.
const ENDINGS: [&str; 8] = ["csv", "csv.gz", "tsv", "txt", "tra", "asc", "dat", "mcap"];
/// Files that `palpate` itself writes beside logs, which are none.
const OWN_FILES: [&str; 2] = ["estimate.csv", "summary.csv"];

/// Every log that the arguments mean, in their order: of a folder and those in it all files with the ending of
/// a log, sorted by name; of a pattern (`run*/log.csv`, `**` for folders) all that fit.
///
/// # Errors
/// A folder or a pattern without any log.
pub(super) fn expanded(given: &[PathBuf]) -> Result<Vec<PathBuf>, Diagnostic> {
    let mut logs = Vec::new();
    for path in given {
        if path.is_dir() {
            let before = logs.len();
            collect(path, &mut logs);
            if logs.len() == before {
                return Err(Diagnostic::new("no log is in this folder")
                    .in_file(path)
                    .note(format!("a log ends in .{}", ENDINGS.join(", .")))
                    .remedy("give the log itself, or the folder that holds it"));
            }
        } else if is_pattern(path) && !path.exists() {
            logs.extend(fitting(path)?);
        } else {
            logs.push(path.clone());
        }
    }
    Ok(logs)
}

fn is_pattern(path: &Path) -> bool {
    path.to_string_lossy().contains(['*', '?', '['])
}

fn fitting(path: &Path) -> Result<Vec<PathBuf>, Diagnostic> {
    let pattern = path.to_string_lossy();
    let wrong = |what: String| {
        let remedy = "write it like 'runs/*.csv': * for a part of a name, ** for folders";
        Diagnostic::new(what).value(&pattern).remedy(remedy)
    };
    let paths =
        glob::glob(&pattern).map_err(|error| wrong(format!("not a pattern: {}", error.msg)))?;
    let found: Vec<PathBuf> = paths
        .filter_map(Result::ok)
        .filter(|path| path.is_file())
        .collect();
    match found.is_empty() {
        true => Err(wrong("no file fits this pattern".into())),
        false => Ok(found),
    }
}

fn collect(folder: &Path, logs: &mut Vec<PathBuf>) {
    // What cannot be listed holds no log that could be read.
    let Ok(entries) = std::fs::read_dir(folder) else {
        return;
    };
    let mut entries: Vec<PathBuf> = entries
        .filter_map(Result::ok)
        .map(|entry| entry.path())
        .collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            collect(&path, logs);
        } else if is_log(&path) {
            logs.push(path);
        }
    }
}

fn is_log(path: &Path) -> bool {
    let name = path
        .file_name()
        .unwrap_or_default()
        .to_string_lossy()
        .to_lowercase();
    let ends = |ending: &str| {
        name.strip_suffix(ending)
            .is_some_and(|name| name.ends_with('.'))
    };
    !name.starts_with('.') && !OWN_FILES.contains(&name.as_str()) && ENDINGS.into_iter().any(ends)
}

/// A folder for each log: its name without endings, and with a number where an earlier log has the
/// same (`simulate` calls every one log.csv).
pub(super) fn names(logs: &[PathBuf]) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for path in logs {
        let name = name(path);
        let numbered = (2..).map(|number| format!("{name}-{number}"));
        let free = std::iter::once(name.clone())
            .chain(numbered)
            .find(|name| !names.contains(name));
        names.extend(free);
    }
    names
}

fn name(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    if name == STANDARD_INPUT {
        return "standard-input".into();
    }
    let name = name.strip_suffix(".gz").unwrap_or(&name);
    let stem = ENDINGS
        .iter()
        .find_map(|ending| name.strip_suffix(ending)?.strip_suffix('.'));
    stem.unwrap_or(name).to_string()
}

/// The folder of a recording below `--out`, where `name` is that of its file among several: none for the only
/// recording of the only file.
pub(super) fn folder(
    name: Option<&str>,
    is_one: bool,
    file: &Path,
    recording: &Path,
) -> Option<String> {
    match (name, is_one) {
        (None, true) => None,
        (Some(name), _) => Some(part_name(name, recording)),
        (None, false) => Some(part_name(&self::name(file), recording)),
    }
}

/// The name of a recording within the file of that name: `log.csv#A` of `log` is `log-A`.
fn part_name(file: &str, recording: &Path) -> String {
    let name = recording.file_name().unwrap_or_default().to_string_lossy();
    match name.rsplit_once('#') {
        Some((_, label)) => format!("{file}-{label}"),
        None => file.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_folder_of_a_log_is_its_name_without_endings() {
        assert_eq!(names(&["a/b/log.1.csv.gz".into()]), ["log.1"]);
        assert_eq!(
            names(&["a/b/zwick.TXT".into(), "-".into()]),
            ["zwick.TXT", "standard-input"]
        );
        assert_eq!(part_name("log", Path::new("a/log.csv#A")), "log-A");
    }

    #[test]
    fn logs_of_one_name_do_not_overwrite_each_other() {
        let logs = ["a/log.csv", "b/log.csv", "log-2.csv", "c/log.csv.gz"].map(PathBuf::from);
        assert_eq!(names(&logs), ["log", "log-2", "log-2-2", "log-3"]);
    }

    #[test]
    fn a_folder_and_a_pattern_mean_the_logs_in_them() {
        let temporary = tempfile::tempdir().unwrap();
        let folder = temporary.path().to_path_buf();
        std::fs::create_dir_all(folder.join("b")).unwrap();
        for name in [
            "b/log.csv",
            "a.txt",
            "notes.md",
            "estimate.csv",
            ".hidden.csv",
        ] {
            std::fs::write(folder.join(name), "").unwrap();
        }
        let wanted = [folder.join("a.txt"), folder.join("b/log.csv")];
        assert_eq!(expanded(std::slice::from_ref(&folder)).unwrap(), wanted);
        assert_eq!(expanded(&[folder.join("**/lo*.csv")]).unwrap(), wanted[1..]);
        assert!(expanded(&[folder.join("*.nothing")]).is_err());
    }
}
