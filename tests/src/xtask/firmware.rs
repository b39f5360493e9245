//! Builds of the firmware, and the proof that its sampling task cannot panic.

use crate::root;
use crate::step::{capture, command, lint_level, run};
use crate::toolchain::Toolchain;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use tests::emulator::{FLASH_START, Image, footprint};

/// The symbol that a panic would need: firmware/src/bin/panic_free.rs.
const PROOF: &str = "a_panic_path_is_left";
const APPLICATION: &str = "palpate-firmware";
/// Limits of an image (bytes): a third of the flash, three eighths of the RAM.
const FLASH_LIMIT: u64 = 256 * 1024;
const RAM_LIMIT: u64 = 48 * 1024;

/// The firmware's sources with the compiler that builds them.
pub(crate) struct Firmware {
    directory: PathBuf,
    toolchain: Toolchain,
}

impl Firmware {
    /// Finds the compiler or installs it.
    pub(crate) fn set_up() -> Result<Self, String> {
        let directory = root().join("firmware");
        let toolchain = Toolchain::find(&directory)?;
        println!(
            "compiler for the board: {}",
            crate::toolchain::describe(toolchain)
        );
        Ok(Firmware {
            directory,
            toolchain,
        })
    }

    /// Builds the application for a board and keeps the ELF under the board's name: the next board
    /// overwrites cargo's.
    pub(crate) fn build(&self, board: &str) -> Result<PathBuf, String> {
        let mut cargo = self.cargo("build");
        cargo.args(["--locked", "--release", "--bin", APPLICATION]);
        cargo.args(["--no-default-features", "--features", board]);
        run(&format!("firmware for {board}"), cargo)?;
        let elf = self.directory.join(self.toolchain.release(APPLICATION));
        let kept = elf.with_extension(board);
        fs::copy(&elf, &kept).map_err(|e| format!("{}: {e}", elf.display()))?;
        within_limits(board, &kept)?;
        Ok(kept)
    }

    /// Builds the proof with either set of sensors: it links only if no panic is left.
    pub(crate) fn prove_panic_freedom(&self) -> Result<(), String> {
        for features in ["panic-proof", "panic-proof,spi-sensors"] {
            let name = format!("link proof: the sampling task cannot panic, {features}");
            run(&name, self.proof(features)).map_err(|e| {
                format!("{e}\nAn undefined `{PROOF}` means that a panic path is left in it.")
            })?;
        }
        Ok(())
    }

    /// Builds the proof with a panic path: it must fail, and for that reason.
    pub(crate) fn control_the_proof(&self) -> Result<(), String> {
        let name = "link proof, control: a panic path does not link";
        let output = capture(name, self.proof("panic-control"))?;
        let errors = String::from_utf8_lossy(&output.stderr);
        if !output.status.success() && errors.contains(PROOF) {
            println!("    fails to link, as it must: undefined `{PROOF}`");
            return Ok(());
        }
        Err(format!(
            "{name}: should fail with an undefined `{PROOF}`, but:\n{errors}"
        ))
    }

    /// Runs the lints for both boards; `None` where there is no clippy.
    pub(crate) fn lint(&self) -> Option<Result<(), String>> {
        self.toolchain.has_clippy(&self.directory).then(|| {
            for features in ["qemu", "panic-proof", "panic-proof,spi-sensors"] {
                let mut clippy = self.cargo("clippy");
                clippy.args(["--locked", "--release", "--no-default-features"]);
                clippy.args(["--features", features, "--", lint_level(), "warnings"]);
                run(&format!("clippy, firmware for {features}"), clippy)?;
            }
            Ok(())
        })
    }

    fn proof(&self, features: &str) -> Command {
        let mut cargo = self.cargo("build");
        cargo.args(["--locked", "--release", "--bin", "panic-free"]);
        cargo.args(["--no-default-features", "--features", features]);
        cargo
    }

    fn cargo(&self, verb: &str) -> Command {
        self.toolchain.cargo(&self.directory, verb)
    }
}

/// The boards with hardware, each as features of the firmware.
const BOARDS: [&str; 2] = ["f405", "f405,spi-sensors"];

/// Builds the image of every board as .elf, .bin and .hex, for whatever tool flashes it.
pub(crate) fn images() -> Result<(), String> {
    let firmware = Firmware::set_up()?;
    let folder = root().join("target/firmware");
    fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    for board in BOARDS {
        let elf = firmware.build(board)?;
        let stem = folder.join(format!("palpate-{}", board.replace(",spi-sensors", "-spi")));
        let image = Image::of(&elf)?;
        write(&stem.with_extension("elf"), &read(&elf)?)?;
        write(&stem.with_extension("bin"), &image.bytes)?;
        write(&stem.with_extension("hex"), image.to_hex().as_bytes())?;
    }
    println!("\nflash a .bin at {FLASH_START:#010x}; .elf and .hex carry their addresses");
    Ok(())
}

fn read(path: &Path) -> Result<Vec<u8>, String> {
    fs::read(path).map_err(|e| format!("{}: {e}", path.display()))
}

fn write(path: &Path, bytes: &[u8]) -> Result<(), String> {
    fs::write(path, bytes).map_err(|e| format!("{}: {e}", path.display()))?;
    println!("    {}: {} bytes", path.display(), bytes.len());
    Ok(())
}

/// Fails for an image that is larger than the limits.
fn within_limits(board: &str, elf: &Path) -> Result<(), String> {
    let (flash, ram) = footprint(elf)?;
    println!("    {board}: {flash} bytes of flash, {ram} bytes of RAM without stack");
    for (what, bytes, limit) in [("flash", flash, FLASH_LIMIT), ("RAM", ram, RAM_LIMIT)] {
        if bytes > limit {
            return Err(format!(
                "{board}: {bytes} bytes of {what}, the limit is {limit}"
            ));
        }
    }
    Ok(())
}

/// Builds the program that decodes a firmware's log into lines.
pub(crate) fn decoder() -> Result<PathBuf, String> {
    let root = root();
    let mut cargo = command("cargo", &root);
    let target = root.join("target/decoder");
    cargo.args([
        "build",
        "--locked",
        "--manifest-path",
        "tests/decoder/Cargo.toml",
    ]);
    cargo.arg("--target-dir").arg(&target);
    run("decoder of the firmware's log", cargo)?;
    Ok(executable(&target.join("debug"), "defmt-lines"))
}

fn executable(directory: &Path, name: &str) -> PathBuf {
    directory
        .join(name)
        .with_extension(std::env::consts::EXE_EXTENSION)
}
