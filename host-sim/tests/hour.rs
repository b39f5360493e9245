//! An hour of palpation at 1 kHz: how much memory its estimate takes, and how large its report is.

mod common;

use std::io::Write;
use std::process::{Command, Stdio};
use std::time::Duration;

use common::Folder;

/// Samples of an hour at 1 kHz.
const SAMPLES: u32 = 3_600_000;
/// 1.39 GB before records were kept in little memory; measured: see README, Today's numbers.
const MOST_BYTES: u64 = 300_000_000;

/// Presses of 0.8 Hz into gel, with noise that repeats after a while, as a log.
fn write_hour(path: &std::path::Path) {
    let mut file = std::io::BufWriter::new(std::fs::File::create(path).unwrap());
    writeln!(file, "t_s,x_m,f_n").unwrap();
    let mut random = 1_u64;
    for at in 0..SAMPLES {
        let time_s = f64::from(at) * 1e-3;
        let phase = std::f64::consts::TAU * 0.8 * time_s;
        let (mut x_m, mut speed_mps) = (-2.5e-3, 0.0);
        if time_s > 1.0 {
            x_m = -1.5e-3 + 2.5e-3 * phase.sin();
            speed_mps = 2.5e-3 * std::f64::consts::TAU * 0.8 * phase.cos();
        }
        let pressed = (x_m.max(0.0) / 1e-3).powf(1.35);
        // Twelve uniform numbers less their mean have a variance of 1.
        let mut noise = -6.0;
        for _ in 0..12 {
            random = random
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            noise += (random >> 40) as f64 / (1_u64 << 24) as f64;
        }
        let force_n = pressed * (1.35 + 36.0 * speed_mps) + 0.02 * noise;
        writeln!(
            file,
            "{time_s:.3},{x_m:.6},{:.3}",
            (force_n / 5e-3).round() * 5e-3
        )
        .unwrap();
    }
    file.flush().unwrap();
}

/// The most memory that a process has held so far (bytes): Linux counts it.
fn most_held(process: u32) -> Option<u64> {
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    let kilobytes: u64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(1024 * kilobytes)
}

/// Runs `palpate` to its end and gives the most memory that it has held; 0 where the system does not count it.
fn run(folder: &Folder, arguments: &[&str]) -> u64 {
    let mut command: Command = folder.command(arguments);
    let mut child = command.stdout(Stdio::null()).spawn().unwrap();
    let mut most = 0;
    loop {
        // The count never falls, so that the last look before the end has seen all but its last moments.
        most = most.max(most_held(child.id()).unwrap_or(0));
        if let Some(status) = child.try_wait().unwrap() {
            assert!(status.success());
            return most;
        }
        std::thread::sleep(Duration::from_millis(20));
    }
}

#[test]
fn an_hour_is_estimated_in_300_mb_and_its_report_has_less_than_2_mb() {
    let folder = Folder::new();
    write_hour(&folder.path("hour.csv"));
    let most = run(&folder, &["estimate", "hour.csv", "--out", "hour"]);
    println!("{:.0} MB", most as f64 * 1e-6);
    assert!(most < MOST_BYTES, "{most} bytes");
    let estimate: serde_json::Value =
        serde_json::from_str(&folder.read("hour/estimate.json")).unwrap();
    assert_eq!(
        estimate["status"], "converged",
        "{}",
        estimate["status_reason"]
    );
    let stiffness = estimate["parameters"]["stiffness"]["value"]
        .as_f64()
        .unwrap();
    assert!((stiffness / 1350.0 - 1.0).abs() < 0.01, "{stiffness}");
    let report = folder.read("hour/report.html");
    assert!(report.len() < 2_000_000, "{} bytes", report.len());
    #[cfg(feature = "browser")]
    opens(&folder);
}

#[cfg(feature = "browser")]
#[path = "common/browser.rs"]
mod browser;

/// The report of an hour opens like every other; how long that takes is said.
#[cfg(feature = "browser")]
fn opens(folder: &Folder) {
    let report = [("hour", folder.path("hour/report.html"))];
    let looked = browser::opened(&folder.path(""), &report, &browser::WIDTHS[..1]);
    browser::assert_good(&looked);
    println!("opened in {} ms", looked[0]["load_ms"]);
}
