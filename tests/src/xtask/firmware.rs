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
        let kept = self.kept(board);
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
    Firmware::set_up()?.images().map(|_| ())
}

impl Firmware {
    /// Builds the image of every board in all three forms, and returns the ELFs, those of [`BOARDS`].
    pub(crate) fn images(&self) -> Result<[PathBuf; 2], String> {
        let folder = root().join("target/firmware");
        fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
        let [analog, spi] = BOARDS.map(|board| self.image(board, &folder));
        println!("\nflash a .bin at {FLASH_START:#010x}; .elf and .hex carry their addresses");
        Ok([analog?, spi?])
    }

    fn image(&self, board: &str, folder: &Path) -> Result<PathBuf, String> {
        let elf = self.build(board)?;
        let stem = folder.join(format!("palpate-{}", board.replace(",spi-sensors", "-spi")));
        let image = Image::of(&elf)?;
        write(&stem.with_extension("elf"), &read(&elf)?)?;
        write(&stem.with_extension("bin"), &image.bytes)?;
        write(&stem.with_extension("hex"), image.to_hex().as_bytes())?;
        Ok(elf)
    }

    /// Runs the aliases that flash a board, with a program in place of probe-rs that keeps what it is told: the
    /// chip, and the image of these features.
    pub(crate) fn flash_without_a_probe(&self) -> Result<(), String> {
        let folder = root().join("target/no-probe");
        let (program, told) = (folder.join("probe-rs"), folder.join("told"));
        fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
        let script = format!("#!/bin/sh\nprintf '%s\\n' \"$@\" > '{}'\n", told.display());
        executable_file(&program, &script)?;
        let path = std::env::var_os("PATH").unwrap_or_default();
        let paths = [folder.clone()]
            .into_iter()
            .chain(std::env::split_paths(&path));
        let paths = std::env::join_paths(paths).map_err(|e| e.to_string())?;
        for (alias, board) in [("flash-f405", BOARDS[0]), ("flash-f405-spi", BOARDS[1])] {
            let _ = fs::remove_file(&told);
            let mut cargo = self.cargo(alias);
            cargo.env("PATH", &paths);
            run(&format!("cargo {alias}, without a probe"), cargo)?;
            let words = String::from_utf8_lossy(&read(&told)?).into_owned();
            let words: Vec<&str> = words.lines().collect();
            let ["run", "--chip", "STM32F405RG", elf] = words[..] else {
                return Err(format!("cargo {alias} tells probe-rs {words:?}"));
            };
            if read(Path::new(elf))? != read(&self.kept(board))? {
                return Err(format!(
                    "cargo {alias} flashes another image than that of {board}"
                ));
            }
        }
        Ok(())
    }

    /// Where the ELF of a board is kept.
    fn kept(&self, board: &str) -> PathBuf {
        let elf = self.directory.join(self.toolchain.release(APPLICATION));
        elf.with_extension(board)
    }
}

/// Writes a program that a shell runs.
fn executable_file(path: &Path, text: &str) -> Result<(), String> {
    fs::write(path, text).map_err(|e| format!("{}: {e}", path.display()))?;
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        let permissions = fs::Permissions::from_mode(0o755);
        fs::set_permissions(path, permissions).map_err(|e| format!("{}: {e}", path.display()))?;
    }
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
