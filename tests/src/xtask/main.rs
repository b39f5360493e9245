//! Sets up what the tests need and runs them: `cargo xtask test`; or runs a firmware in the
//! emulator: `cargo xtask qemu`.

mod check;
mod firmware;
mod model;
mod packages;
mod qemu;
mod step;
mod toolchain;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

const USAGE: &str = "\
cargo xtask test         set up what is missing and run everything: host tests, firmware builds,
                         link proof, emulator, the board's image on its model, reports in a browser;
                         --without-browser leaves the last out
cargo xtask firmware     build the images of every board as .elf, .bin and .hex, into target/firmware
cargo xtask qemu [ELF]   run a firmware in the emulator on a simulated palpation and print its log;
                         without ELF: build it first
";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let result = match words[..] {
        ["test"] => check::everything(true),
        ["test", "--without-browser"] => check::everything(false),
        ["firmware"] => firmware::images(),
        ["qemu"] => qemu::run(None),
        ["qemu", elf] => qemu::run(Some(Path::new(elf))),
        _ => Err(USAGE.into()),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("\n{error}");
            ExitCode::FAILURE
        }
    }
}

/// The repository's root.
fn root() -> PathBuf {
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    package.parent().unwrap_or(package).to_path_buf()
}
