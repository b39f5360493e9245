//! A step: a command with a name, its time, and an environment that is not cargo's.

use std::env;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::Instant;

/// A command in `directory` without what the cargo that started us has set: its RUSTUP_TOOLCHAIN,
/// RUSTC and CARGO_… would lead another cargo to the wrong compiler, its LD_LIBRARY_PATH another
/// compiler to the wrong libraries. What a person sets for every cargo stays.
pub(crate) fn command(program: impl AsRef<Path>, directory: &Path) -> Command {
    const KEPT: [&str; 7] = [
        "CARGO_HOME",
        "CARGO_TARGET_DIR",
        "CARGO_TERM_",
        "CARGO_HTTP_",
        "CARGO_NET_",
        "CARGO_REGISTR",
        "CARGO_SOURCE_",
    ];
    let mut command = Command::new(program.as_ref());
    command.current_dir(directory);
    for (name, _) in env::vars_os() {
        let name = name.to_string_lossy();
        let of_cargo = name.starts_with("CARGO") && !KEPT.iter().any(|kept| name.starts_with(kept));
        let of_rustc = name.starts_with("RUSTC") || name.starts_with("RUSTDOC");
        let of_rustup = name.starts_with("RUSTUP_TOOLCHAIN");
        if of_cargo || of_rustc || of_rustup || name == "LD_LIBRARY_PATH" {
            command.env_remove(&*name);
        }
    }
    command
}

/// Whether a program runs at all.
pub(crate) fn runs(mut command: Command) -> bool {
    let status = command
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status();
    status.is_ok_and(|status| status.success())
}

/// What a program writes to its standard output.
pub(crate) fn output(mut command: Command) -> Option<String> {
    let output = command.stdin(Stdio::null()).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    output.status.success().then(|| text.trim().to_string())
}

/// Runs a command in full view and says how long it took.
pub(crate) fn run(name: &str, command: Command) -> Result<(), String> {
    let start = Instant::now();
    run_quietly(name, command)?;
    println!("    {name}: {:.1} s", start.elapsed().as_secs_f32());
    Ok(())
}

/// Runs a command in full view.
pub(crate) fn run_quietly(name: &str, mut command: Command) -> Result<(), String> {
    println!("\n==> {name}");
    let status = command.status().map_err(|e| cannot_start(&command, &e))?;
    status
        .success()
        .then_some(())
        .ok_or_else(|| format!("{name} failed ({status}): {}", line(&command)))
}

/// What a person would type, without the environment.
fn line(command: &Command) -> String {
    let words = std::iter::once(command.get_program()).chain(command.get_args());
    let words: Vec<_> = words.map(|word| word.to_string_lossy()).collect();
    words.join(" ")
}

/// Runs a command that is expected to fail, and shows nothing.
pub(crate) fn capture(name: &str, mut command: Command) -> Result<Output, String> {
    println!("\n==> {name}");
    command.output().map_err(|e| cannot_start(&command, &e))
}

fn cannot_start(command: &Command, error: &std::io::Error) -> String {
    format!("{}: {error}", command.get_program().display())
}

/// How clippy treats a warning: CI denies it, elsewhere a newer compiler's new lint is no failure.
pub(crate) fn lint_level() -> &'static str {
    if env::var_os("CI").is_some() {
        "-D"
    } else {
        "-W"
    }
}
