//! Every check, in an order that ends with cargo's summary of the tests.

use crate::firmware::{Firmware, decoder};
use crate::step::{command, lint_level, run, run_quietly, runs};
use crate::{model, packages, root};
use std::process::Command;

/// Runs every step, even after one has failed; an error if any has. The reports are opened in a browser unless that
/// is left out.
pub(crate) fn everything(with_browser: bool) -> Result<(), String> {
    let mut failed = Vec::new();
    let mut note = |result: Result<(), String>| failed.extend(result.err());
    note(host_lints());
    let set_up = firmware_steps(&mut note);
    note(example_effect());
    let mut tests = cargo(&["test", "--workspace", "--no-fail-fast"]);
    tests.args(["--features", "host-sim/foxglove"]);
    match with_browser.then(packages::browser) {
        Some(Ok(browser)) => {
            tests.args(["--features", "host-sim/browser"]);
            tests.env("PALPATE_BROWSER", browser);
        }
        Some(Err(error)) => note(Err(format!(
            "{error}\nSo no report was opened. `cargo xtask test --without-browser` leaves that out."
        ))),
        None => println!("LEFT OUT: reports in a browser, by --without-browser"),
    }
    match set_up {
        Ok(environment) => {
            note(model::stories(&environment));
            tests.args(["--features", "tests/qemu"]).envs(environment);
        }
        Err(error) => note(Err(format!(
            "{error}\nSo the tests on the emulator and on the board's model did not run."
        ))),
    }
    // Nothing is printed after cargo's summary unless something failed.
    note(run_quietly("tests", tests));
    if failed.is_empty() {
        return Ok(());
    }
    Err(format!(
        "{} failed:\n\n{}",
        failed.len(),
        failed.join("\n\n")
    ))
}

/// Builds everything that the emulator's tests need and returns where it is, as environment variables.
fn firmware_steps(
    note: &mut impl FnMut(Result<(), String>),
) -> Result<Vec<(&'static str, std::path::PathBuf)>, String> {
    let qemu = packages::qemu()?;
    let firmware = Firmware::set_up()?;
    let emulated = firmware.build("qemu")?;
    let [board, with_spi] = firmware.images()?;
    if cfg!(unix) {
        note(firmware.flash_without_a_probe());
    }
    note(firmware.prove_panic_freedom());
    note(firmware.control_the_proof());
    match firmware.lint() {
        Some(result) => note(result),
        None => println!("LEFT OUT: clippy for the firmware, its compiler has none"),
    }
    Ok(vec![
        ("PALPATE_QEMU", qemu),
        ("PALPATE_DECODER", decoder()?),
        ("PALPATE_QEMU_ELF", emulated),
        ("PALPATE_F405_ELF", board),
        ("PALPATE_F405_SPI_ELF", with_spi),
        ("PALPATE_RUNS", root().join("target/qemu")),
    ])
}

/// Tests the worked example of how an effect is added, which no other build has. Without optimization
/// its build takes 30 s in place of 110 s, and its run 4 s in place of 0.6 s.
fn example_effect() -> Result<(), String> {
    let mut test = cargo(&["test", "--package", "tests", "--test", "example_effect"]);
    test.args(["--features", "tests/example-effect"]);
    for package in ["host-sim", "tests"] {
        let plain = format!("profile.dev.package.{package}.opt-level=0");
        test.args(["--config", &plain]);
    }
    run("example of an added effect", test)
}

/// Checks formatting and lints. Without the tools, the tests still run and a line names what is left out.
fn host_lints() -> Result<(), String> {
    let mut result = Ok(());
    if runs(cargo(&["fmt", "--version"])) {
        for manifest in [
            "Cargo.toml",
            "firmware/Cargo.toml",
            "tests/decoder/Cargo.toml",
            "tests/f405/Cargo.toml",
        ] {
            let all = if manifest == "Cargo.toml" {
                "--all"
            } else {
                "--quiet"
            };
            let format = cargo(&["fmt", all, "--check", "--manifest-path", manifest]);
            result = result.and(run(&format!("format of {manifest}"), format));
        }
    } else {
        println!("LEFT OUT: formatting. `rustup component add rustfmt` brings it.");
    }
    if runs(cargo(&["clippy", "--version"])) {
        let mut clippy = cargo(&["clippy", "--workspace", "--all-targets"]);
        clippy.args([
            "--features",
            "tests/qemu,host-sim/browser,host-sim/foxglove",
        ]);
        clippy.args(["--", lint_level(), "warnings"]);
        result = result.and(run("clippy", clippy));
    } else {
        println!("LEFT OUT: lints. `rustup component add clippy` brings them.");
    }
    result
}

fn cargo(arguments: &[&str]) -> Command {
    let mut cargo = command("cargo", &root());
    cargo.args(arguments);
    cargo
}
