//! Settings through a power cut at any operation on the flash, and erases at both ends of the watchdog.

use crate::common::within_the_model;
use estimator_core::Fault;
use estimator_core::board::link::{Answer, Command};
use estimator_core::board::settings::Key;
use estimator_core::board::settings::store::SLOT;
use f405::bench::{Bench, analog};
use f405::chip::{Operation, Part, apply};
use f405::report::Report;
use f405::world::{Material, Press, REST_M};
use std::thread;

/// The settings' two sectors (memory.x leaves them out).
const SETTINGS: usize = 768 * 1024;
const SECTOR: usize = 128 * 1024;

fn free(part: Part) -> Bench {
    let world = Press::new(|_: f64| (REST_M, 0.0), Material::GEL, 9);
    Bench::new(analog(), part, Box::new(world))
}

fn save(bench: &mut Bench, every: f32) {
    bench.set(&[(Key::TelemetryEvery, every)]);
    let answer = bench.ask(Command::Save, 6.0);
    assert!(matches!(answer, Some((Answer::Done, _))), "{answer:?}");
}

/// A flash with 7 saved in the last place of the first sector: the next save erases the other one.
fn full_sector() -> Vec<u8> {
    let mut bench = free(Part::default());
    bench.run(0.3);
    save(&mut bench, 7.0);
    let mut flash = bench.machine.flash().to_vec();
    let (first, last) = (SETTINGS, SETTINGS + SECTOR - SLOT);
    let record = flash[first..first + SLOT].to_vec();
    flash[first..last].fill(0);
    flash[last..last + SLOT].copy_from_slice(&record);
    // Something in the other sector, so that its erase is one.
    flash[SETTINGS + SECTOR..].fill(0);
    flash
}

/// What a board that starts with this flash has as its setting.
fn found(flash: &[u8]) -> f32 {
    let mut bench = free(Part::default());
    bench.machine.set_flash(flash);
    bench.run(0.025);
    match bench.ask(Command::Get(Key::TelemetryEvery.id()), 0.5) {
        Some((Answer::Value(_, value), _)) => value,
        other => panic!("{other:?}; the log: {:#?}", bench.log()),
    }
}

#[test]
fn a_power_cut_at_any_operation_leaves_the_old_settings_or_the_new() {
    let before = full_sector();
    let mut bench = free(Part::default());
    bench.machine.set_flash(&before);
    bench.run(0.3);
    let start = bench.machine.flash_operations().len();
    save(&mut bench, 9.0);
    within_the_model(&bench);
    let operations: Vec<Operation> = bench.machine.flash_operations()[start..]
        .iter()
        .map(|(_, operation)| *operation)
        .collect();
    let erases = operations
        .iter()
        .filter(|o| matches!(o, Operation::Erase { .. }));
    assert_eq!(erases.count(), 1);
    let check = |first: usize| {
        let mut flash = before.clone();
        let (mut old, mut new) = (0, 0);
        for (index, operation) in operations.iter().enumerate() {
            if index % 2 == first {
                for share in [0.0, 0.5] {
                    let mut cut = flash.clone();
                    apply(&mut cut, *operation, share);
                    match found(&cut) {
                        7.0 => old += 1,
                        9.0 => new += 1,
                        other => panic!("cut at {operation:?}, {share} of it: {other}"),
                    }
                }
            }
            apply(&mut flash, *operation, 1.0);
        }
        assert_eq!(found(&flash), 9.0);
        (old, new)
    };
    let (even, odd) = thread::scope(|scope| {
        let odd = scope.spawn(|| check(1));
        (check(0), odd.join().expect("no panic"))
    });
    let mut report = Report::new("power cut at any operation of the flash");
    report.row("operations of a save with its erase", operations.len());
    report.row(
        "cuts with the old settings, with the new",
        format!("{}, {}", even.0 + odd.0, even.1 + odd.1),
    );
    assert_eq!(even.0 + even.1 + odd.0 + odd.1, 2 * operations.len());
}

#[test]
fn an_erase_of_four_seconds_ends_before_the_watchdog_at_both_ends_of_its_oscillator() {
    let mut report = Report::new("save with an erase of 4 s");
    let flash = full_sector();
    for watchdog_hz in [17_000, 47_000] {
        let part = Part {
            watchdog_hz,
            ..Part::default()
        };
        let mut bench = free(part);
        bench.machine.set_flash(&flash);
        bench.run(0.5);
        // Every record, so that a fault of a single sample shows.
        save(&mut bench, 1.0);
        bench.run(2.0);
        within_the_model(&bench);
        assert!(bench.machine.chip.trace.resets.is_empty());
        let (window, longest) = bench.machine.chip.watchdog();
        report.row(
            format!("watchdog at {watchdog_hz} Hz"),
            format!("window {window:.1} s, longest time between feeds {longest:.1} s"),
        );
        let health = bench.healths().last().expect("health comes");
        report.row(
            "records dropped, frames lost, samples missed",
            format!("{}, {}, {}", health.dropped, bench.lost(), health.missed),
        );
        assert_eq!((health.dropped, bench.lost()), (0, 0));
        // Nobody has followed the encoder meanwhile: its first count afterwards is any, and the next ones follow it.
        let jumps = bench
            .estimates()
            .filter(|(_, estimate)| estimate.faults.has(Fault::PositionJump));
        let jumps: Vec<f64> = jumps.map(|(at, _)| at).collect();
        assert_eq!(jumps.len(), 1, "{jumps:?}");
    }
}
