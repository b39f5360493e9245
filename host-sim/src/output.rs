//! Writing a file whole or not at all, and text for whoever still listens.
//!
//! What the command says is decided once, by `--quiet` and `--json`: text, nothing, or the result alone.

use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

use serde_json::Value;

/// Whether text is left out, and whether the result is written to standard output as JSON.
static QUIET: AtomicBool = AtomicBool::new(false);
static JSON: AtomicBool = AtomicBool::new(false);
/// Files that are being written, under their temporary names.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Sets what the command says, for the whole process: `--json` the result alone, `--quiet` nothing.
pub fn speak(json: bool, quiet: bool) {
    JSON.store(json, Ordering::Relaxed);
    QUIET.store(json || quiet, Ordering::Relaxed);
}

/// Whether text is left out.
pub fn is_quiet() -> bool {
    QUIET.load(Ordering::Relaxed)
}

/// Writes the result to standard output if it was asked for as JSON.
///
/// # Errors
/// What the system says, such as a full disk.
pub fn result(value: &Value) -> io::Result<()> {
    if !JSON.load(Ordering::Relaxed) {
        return Ok(());
    }
    put(&format!("{value:#}\n"))
}

/// Writes an error to standard error. Nobody is to be told if that is closed: the exit status says it.
pub fn complain(text: &str) {
    let _ = writeln!(io::stderr(), "{text}");
}

/// Tries whether files can be written into a folder, before hours of computing: it leaves nothing there, and
/// makes no folder.
///
/// # Errors
/// What the file system says, with the path.
pub fn try_folder(folder: &Path) -> io::Result<()> {
    let mut existing = folder;
    while !existing.exists() {
        match existing.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => existing = parent,
            _ => existing = Path::new("."),
        }
    }
    let name = format!(".palpate-{}.try", std::process::id());
    let tried = existing.join(name);
    let done = File::create(&tried).and_then(|_| fs::remove_file(&tried));
    done.map_err(|error| cannot_write(&folder.join("").display().to_string(), &error))
}

fn cannot_write(what: &str, error: &io::Error) -> io::Error {
    io::Error::new(error.kind(), format!("cannot write {what}: {error}"))
}

/// Removes what is half written; for a process that is interrupted.
pub fn remove_unfinished() {
    let unfinished = UNFINISHED
        .lock()
        .map(|mut paths| std::mem::take(&mut *paths));
    for path in unfinished.unwrap_or_default() {
        let _ = fs::remove_file(path);
    }
}

fn set_unfinished(path: &Path, is_unfinished: bool) {
    if let Ok(mut paths) = UNFINISHED.lock() {
        match is_unfinished {
            true => paths.push(path.to_path_buf()),
            false => paths.retain(|own| own != path),
        }
    }
}

/// Writes `path` by `fill`, through a temporary file beside it that is renamed at the end: whoever
/// reads `path` sees the old file or the whole new one. Its folder is made if it is missing.
///
/// # Errors
/// What the file system says, with the path; the temporary file is then removed.
pub fn write_atomically(
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    let mut name = OsString::from(".");
    name.push(path.file_name().unwrap_or_default());
    name.push(format!(".{}.part", std::process::id()));
    let temporary = path.with_file_name(name);
    set_unfinished(&temporary, true);
    let written = write_whole(&temporary, fill).and_then(|()| fs::rename(&temporary, path));
    set_unfinished(&temporary, false);
    written.map_err(|error| {
        // Best effort: the first error is the one to report.
        let _ = fs::remove_file(&temporary);
        cannot_write(&path.display().to_string(), &error)
    })
}

fn write_whole(
    temporary: &Path,
    fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    if let Some(folder) = temporary.parent().filter(|f| !f.as_os_str().is_empty()) {
        fs::create_dir_all(folder)?;
    }
    let mut writer = BufWriter::with_capacity(1 << 16, File::create(temporary)?);
    fill(&mut writer)?;
    // Before it is renamed: a power cut would leave the new name with nothing behind it.
    writer.into_inner()?.sync_all()
}

/// Writes `text` to standard output. Whoever reads it may stop before its end (`… | head -1`): that
/// is no failure, and what else the verb has to do goes on.
///
/// # Errors
/// What the system says otherwise, such as a full disk.
pub fn say(text: impl AsRef<str>) -> io::Result<()> {
    match is_quiet() {
        true => Ok(()),
        false => put(text.as_ref()),
    }
}

fn put(text: &str) -> io::Result<()> {
    let mut out = io::stdout().lock();
    let said = out.write_all(text.as_bytes()).and_then(|()| out.flush());
    match said {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        Err(error) => Err(cannot_write("to standard output", &error)),
        Ok(()) => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_write_leaves_the_old_file_and_no_rubbish() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        write_atomically(&path, |w| w.write_all(b"old")).unwrap();
        let failed = write_atomically(&path, |w| {
            w.write_all(b"half of the n")?;
            Err(io::Error::other("disk full"))
        });
        assert!(failed.unwrap_err().to_string().contains("disk full"));
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 1);
    }
}
