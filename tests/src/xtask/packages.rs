//! Programs that a Debian machine can get.

use crate::root;
use crate::step::{command, output, run};
use std::env;
use std::path::PathBuf;

/// Returns where the emulator is, and installs it if it is missing.
pub(crate) fn qemu() -> Result<PathBuf, String> {
    const PROGRAM: &str = "qemu-system-arm";
    if which(PROGRAM).is_none() {
        install(&[PROGRAM], "the emulator")?;
    }
    which(PROGRAM).ok_or_else(|| format!("{PROGRAM} is still not on the PATH"))
}

/// Returns where a browser is that runs without a screen, and installs Debian's if there is none.
pub(crate) fn browser() -> Result<PathBuf, String> {
    const PROGRAMS: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "chrome"];
    let found = || PROGRAMS.iter().find_map(|program| which(program));
    if found().is_none() {
        // Debian's; the letters of a page are part of how it looks.
        install(&["chromium", "fonts-dejavu-core"], "the browser")?;
    }
    found().ok_or_else(|| "chromium is still not on the PATH".into())
}

/// Returns where a program is.
pub(crate) fn which(program: &str) -> Option<PathBuf> {
    env::split_paths(&env::var_os("PATH")?)
        .map(|directory| directory.join(program))
        .find(|path| path.is_file())
}

/// Installs Debian packages as root; for other users the error has the command to run.
pub(crate) fn install(packages: &[&str], what: &str) -> Result<(), String> {
    let list = packages.join(" ");
    let as_root = output_of("id", &["-u"]).as_deref() == Some("0");
    if !as_root || which("apt-get").is_none() {
        return Err(format!(
            "{what} is missing. On Debian or Ubuntu run\n    \
             sudo apt-get update && sudo apt-get install -y --no-install-recommends {list}\n\
             elsewhere install what corresponds, and run `cargo xtask test` again."
        ));
    }
    let apt = |arguments: &[&str]| {
        let mut apt = command("apt-get", &root());
        // Wait for another apt that may be running.
        apt.args(["-o", "DPkg::Lock::Timeout=300", "-qq"])
            .args(arguments);
        apt.env("DEBIAN_FRONTEND", "noninteractive");
        apt
    };
    run("apt-get update", apt(&["update"]))?;
    let mut arguments = vec!["install", "-y", "--no-install-recommends"];
    arguments.extend(packages);
    run(&format!("apt-get install {list}"), apt(&arguments))
}

fn output_of(program: &str, arguments: &[&str]) -> Option<String> {
    let mut command = command(program, &root());
    command.args(arguments);
    output(command)
}
