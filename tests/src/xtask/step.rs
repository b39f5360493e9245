//! Steps: commands with a name and a time, in an environment without this cargo's variables.

use std::env;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::Instant;

/// Returns a command in `directory` without the variables of the cargo that started this program: its
/// RUSTUP_TOOLCHAIN, RUSTC and CARGO_… would lead another cargo to the wrong compiler, its LD_LIBRARY_PATH
/// another compiler to the wrong libraries. Variables that a person sets for every cargo stay.
pub(crate) fn command(program: impl AsRef<Path>, directory: &Path) -> Command {
    const KEPT: [&str; 9] = [
        "CARGO_HOME",
        "CARGO_INCREMENTAL",
        "CARGO_PROFILE_",
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

/// Returns whether a program runs and succeeds.
pub(crate) fn runs(mut command: Command) -> bool {
    let status = command
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status();
    status.is_ok_and(|status| status.success())
}

/// Returns the standard output of a program that succeeds.
pub(crate) fn output(mut command: Command) -> Option<String> {
    let output = command.stdin(Stdio::null()).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    output.status.success().then(|| text.trim().to_string())
}

/// Runs a command with its output on the terminal and prints how long it took.
pub(crate) fn run(name: &str, command: Command) -> Result<(), String> {
    let start = Instant::now();
    run_quietly(name, command)?;
    println!("    {name}: {:.1} s", start.elapsed().as_secs_f32());
    Ok(())
}

/// Runs a command with its output on the terminal.
pub(crate) fn run_quietly(name: &str, mut command: Command) -> Result<(), String> {
    println!("\n==> {name}");
    let status = command.status().map_err(|e| cannot_start(&command, &e))?;
    status
        .success()
        .then_some(())
        .ok_or_else(|| format!("{name} failed ({status}): {}", line(&command)))
}

/// Returns the command as a person would type it, without the environment.
fn line(command: &Command) -> String {
    let words = std::iter::once(command.get_program()).chain(command.get_args());
    let words: Vec<_> = words.map(|word| word.to_string_lossy()).collect();
    words.join(" ")
}

/// Runs a command without showing its output, for one that is expected to fail.
pub(crate) fn capture(name: &str, mut command: Command) -> Result<Output, String> {
    println!("\n==> {name}");
    command.output().map_err(|e| cannot_start(&command, &e))
}

fn cannot_start(command: &Command, error: &std::io::Error) -> String {
    format!("{}: {error}", command.get_program().display())
}

/// Returns clippy's flag for warnings: CI denies them; elsewhere a new lint of a newer compiler is no failure.
pub(crate) fn lint_level() -> &'static str {
    if env::var_os("CI").is_some() {
        "-D"
    } else {
        "-W"
    }
}
