//! A run in the emulator whose log a person reads.

use crate::firmware::{Firmware, decoder};
use crate::{packages, root};
use std::fs;
use std::path::Path;
use tests::emulator::Emulator;
use tests::signal::palpation;

/// 20 s of palpation: both materials, a few seconds to read.
const SAMPLES: usize = 20_000;

/// Runs the firmware `elf`, or builds one and runs it.
pub(crate) fn run(elf: Option<&Path>) -> Result<(), String> {
    let qemu = packages::qemu()?;
    let elf = match elf {
        Some(elf) => fs::canonicalize(elf).map_err(|e| format!("{}: {e}", elf.display()))?,
        None => Firmware::set_up()?.build("qemu")?,
    };
    let directory = root().join("target/qemu");
    fs::create_dir_all(&directory).map_err(|e| format!("{}: {e}", directory.display()))?;
    // The file exists from the start, so that `palpate config --port target/qemu` reaches the firmware.
    let commands = directory.join("commands.frames");
    fs::write(&commands, []).map_err(|e| format!("{}: {e}", commands.display()))?;
    let emulator = Emulator {
        qemu,
        decoder: decoder()?,
        elf,
        directory,
    };
    println!(
        "\n==> QEMU: {} s of simulated palpation, gel, then plastic",
        SAMPLES / 1000
    );
    let run = emulator.run(&palpation(SAMPLES, 1), |line| println!("{line}"))?;
    println!(
        "\n{} frames in {}",
        run.frames.len(),
        emulator.directory.join("telemetry.frames").display()
    );
    Ok(())
}
