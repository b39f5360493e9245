//! The host over a serial device of the system: a pseudo-terminal with the board at its other end.

#[path = "../common/terminal.rs"]
mod terminal_end;

use crate::common::Folder;
use crate::world;
use estimator_core::board::link::BYTES_PER_MS;
use estimator_core::board::settings::{Key, Settings};
use palpate::cli::config::compensate::{self, CompensateArgs};
use palpate::kind::Kind;
use palpate::link::port::Serial;
use palpate::link::world::Hand;
use palpate::link::{Device, SimulatedBoard, record};
use palpate::log::{Log, ReadOptions};
use serialport::{SerialPort, TTYPort};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Sends a model between two touches of the hand, which touches once a second.
fn compensated(device: &mut Device<Serial>, model: &Path) {
    let args = CompensateArgs {
        model: Some(model.to_path_buf()),
        off: false,
    };
    let plan = compensate::plan(&args).unwrap();
    let said = (0..100).find_map(|_| compensate::run(device, plan.as_ref()).ok());
    let said = said.expect("free air within a second");
    assert!(said.contains("tool_inertia"), "{said}");
}

#[test]
fn settings_telemetry_and_a_recording_go_over_a_pseudo_terminal() {
    let (master, slave) = TTYPort::pair().unwrap();
    let name = slave.name().unwrap();
    // It holds a lock on the port.
    drop(slave);
    let stop = Arc::new(AtomicBool::new(false));
    let board = SimulatedBoard::new(world(Hand::Palpating), BYTES_PER_MS);
    let board = terminal_end::serve(master, board, Arc::clone(&stop));
    let mut device = Device::new(Serial::open(&name).unwrap());
    assert_eq!(device.identity().unwrap().board.as_str(), "simulated");
    assert_eq!(device.settings().unwrap(), Settings::default());
    device.set(Key::TelemetryEvery, 2.0).unwrap();
    assert_eq!(device.get(Key::TelemetryEvery).unwrap(), 2.0);
    let model = "[environment]\nlaw = \"free\"\n[[effect]]\nid = \"tool_inertia\"\nmass = 0.25\n";
    let rig = Folder::with("rig.toml", model);
    compensated(&mut device, &rig.path("rig.toml"));
    let mass = Key::from_name("compensation.tool_inertia.mass").unwrap();
    assert_eq!(device.get(mass).unwrap(), 0.25);
    let folder = Folder::new();
    let out = folder.path("run");
    let statistics = record::record(&mut device, &out, Some(500_000)).unwrap();
    assert_eq!((statistics.lost, statistics.garbled), (0, 0));
    record::convert(&out, Kind::Linear).unwrap();
    let log = Log::read(&out.join("log.csv"), &ReadOptions::default()).unwrap();
    // Every second sample of half a second, and what came while the settings were asked for.
    assert!((240..2000).contains(&log.len()), "{}", log.len());
    stop.store(true, Ordering::Relaxed);
    drop(device);
    drop(board.join().unwrap());
}
