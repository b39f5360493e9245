//! The compiler that builds the firmware.

use crate::packages::{install, which};
use crate::step::{command, output, runs};
use std::env;
use std::fs;
use std::path::Path;
use std::process::Command;

const TARGET: &str = "thumbv7em-none-eabihf";
const DEBIAN_RUSTC: &str = "/usr/bin/rustc";
const DEBIAN_CARGO: &str = "/usr/bin/cargo";

/// A compiler for the board.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Toolchain {
    /// The toolchain that firmware/rust-toolchain.toml names; it has the target.
    Ordinary,
    /// Debian's toolchain, which has no target: core is built from source.
    Debian,
}

impl Toolchain {
    /// Finds the ordinary toolchain if it has the target or if rustup may fetch it, or else Debian's.
    ///
    /// rustup itself is never called. Where it may download, asking rustc for a directory makes it
    /// fetch what firmware/rust-toolchain.toml names; where it may not, nothing happens.
    pub(crate) fn find(firmware: &Path) -> Result<Self, String> {
        if has_target(firmware) {
            return Ok(Toolchain::Ordinary);
        }
        if debian_is_complete(firmware) {
            return Ok(Toolchain::Debian);
        }
        let packages = ["rustc-web", "cargo-web", "rust-web-src", "lld"];
        install(&packages, "a compiler for the board").map_err(|error| {
            format!("{error}\nOr, where rustup may download: rustup target add {TARGET}")
        })?;
        if debian_is_complete(firmware) {
            return Ok(Toolchain::Debian);
        }
        Err(format!(
            "Debian's Rust under /usr/bin is older than 1.89 or has no sources.\n\
             Where rustup may download, run: rustup target add {TARGET}"
        ))
    }

    /// Returns cargo in firmware/ with a verb such as `build`.
    pub(crate) fn cargo(self, firmware: &Path, verb: &str) -> Command {
        let mut cargo = match (self, verb) {
            (Toolchain::Ordinary, _) => command("cargo", firmware),
            // Debian's `cargo clippy` would find rustup's cargo-clippy first.
            (Toolchain::Debian, "clippy") => command("/usr/bin/cargo-clippy", firmware),
            (Toolchain::Debian, _) => command(DEBIAN_CARGO, firmware),
        };
        cargo.arg(verb).args(["--target-dir", self.target_dir()]);
        // Flags for the host's processor do not suit the board's.
        cargo.env_remove("RUSTFLAGS");
        if self == Toolchain::Debian {
            cargo
                .arg("-Zbuild-std=core")
                .env("CARGO", DEBIAN_CARGO)
                .env("RUSTC", DEBIAN_RUSTC)
                .env("RUSTC_BOOTSTRAP", "1")
                .env("CARGO_TARGET_THUMBV7EM_NONE_EABIHF_LINKER", "ld.lld");
        }
        cargo
    }

    /// Returns the target directory under firmware/. Each compiler has one, or each would rebuild everything.
    pub(crate) fn target_dir(self) -> &'static str {
        match self {
            Toolchain::Ordinary => "target",
            Toolchain::Debian => "target/debian",
        }
    }

    /// Returns where a program of the release profile is, under firmware/.
    pub(crate) fn release(self, program: &str) -> String {
        format!("{}/{TARGET}/release/{program}", self.target_dir())
    }

    /// Returns whether `cargo clippy` works, after installing it where possible.
    pub(crate) fn has_clippy(self, firmware: &Path) -> bool {
        if self == Toolchain::Debian && !Path::new("/usr/bin/cargo-clippy").exists() {
            // Clippy is optional: without it, the firmware is still built and tested.
            let _ = install(&["rust-web-clippy"], "clippy for the board's compiler");
        }
        let mut clippy = match self {
            Toolchain::Ordinary => command("cargo", firmware),
            Toolchain::Debian => command("/usr/bin/cargo-clippy", firmware),
        };
        clippy.args(["clippy", "--version"]);
        runs(clippy)
    }
}

fn has_target(firmware: &Path) -> bool {
    let mut rustc = command("rustc", firmware);
    rustc.args(["--print", "target-libdir", "--target", TARGET]);
    let directory = output(rustc).unwrap_or_default();
    // Any file will do: the directory exists only where the target is installed.
    fs::read_dir(directory).is_ok_and(|mut files| files.next().is_some())
}

/// Returns whether /usr/bin has a recent rustc and cargo with the sources of core, and a linker.
fn debian_is_complete(firmware: &Path) -> bool {
    let ask = |arguments: &[&str]| {
        let mut rustc = command(DEBIAN_RUSTC, firmware);
        rustc.args(arguments);
        output(rustc)
    };
    let recent = ask(&["--version"]).is_some_and(|version| minor(&version) >= Some(89));
    let sources = ask(&["--print", "sysroot"]).is_some_and(|root| {
        Path::new(&root)
            .join("lib/rustlib/src/rust/library/core")
            .exists()
    });
    recent && sources && Path::new(DEBIAN_CARGO).exists() && which("ld.lld").is_some()
}

/// Returns 96 for "rustc 1.96.0 (…)".
fn minor(version: &str) -> Option<u32> {
    version.split('.').nth(1)?.parse().ok()
}

/// Describes a toolchain. The environment tells whether rustup may download.
pub(crate) fn describe(toolchain: Toolchain) -> &'static str {
    let offline = env::var("RUSTUP_AUTO_INSTALL").is_ok_and(|value| value == "0");
    match (toolchain, offline) {
        (Toolchain::Ordinary, _) => "the toolchain of firmware/rust-toolchain.toml",
        (Toolchain::Debian, true) => {
            "Debian's, since rustup may not download (RUSTUP_AUTO_INSTALL=0)"
        }
        (Toolchain::Debian, false) => "Debian's, since the target is not installed",
    }
}
