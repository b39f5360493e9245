//! What a board tells of the run before, and of its settings: the cause of a reset, what ended the run and where,
//! and every setting with name, unit and bounds.

use crate::common::{packet, pressing, within_the_model};
use estimator_core::board::history::{CrashKind, History, ResetCause, Stage};
use estimator_core::board::link::{Answer, Command, Refusal};
use estimator_core::board::settings::Key;
use f405::bench::{Bench, analog, spi};
use f405::chip::{Crystal, Part};
use f405::report::Report;
use f405::world::Material;

/// Longer than the watchdog's window at 32 kHz, and a second of health after it.
const SECONDS: f64 = 3.0;

/// What the board tells with its last state of health.
fn told(bench: &Bench) -> History {
    within_the_model(bench);
    bench.healths().last().expect("health comes").history
}

fn board() -> Bench {
    let mut bench = pressing(analog(), Part::default(), Material::GEL, 7);
    bench.run(1.5);
    bench
}

/// The address of the function whose symbol has a name in it.
fn symbol(bench: &Bench, name: &str) -> u32 {
    let mut symbols = bench.image.symbols.iter();
    // Tables of the compiler have the names of their functions, behind a dot.
    let found = symbols.find(|(symbol, _)| symbol.contains(name) && !symbol.starts_with('.'));
    found.map(|(_, at)| at & !1).expect("it has symbols")
}

#[test]
fn a_first_start_and_a_supply_that_sank_are_told_and_no_crash_with_them() {
    let mut bench = board();
    let first = told(&bench);
    assert_eq!((first.reset, first.crash), (ResetCause::PowerOn, None));
    bench.machine.brown_out();
    bench.run(1.5);
    let second = told(&bench);
    assert_eq!((second.reset, second.crash), (ResetCause::BrownOut, None));
    let mut report = Report::new("what a start tells");
    report.row("power on", format!("{first:?}"));
    report.row("supply sank", format!("{second:?}"));
}

#[test]
fn a_hang_is_told_with_what_the_board_was_doing_and_told_once() {
    let mut report = Report::new("what a start tells after a hang");
    for (place, stage) in [
        // Where a task begins, it has noted nothing yet: what it interrupted stands there.
        ("SPARE", Stage::Idle),
        ("send_frame", Stage::Send),
    ] {
        let mut bench = board();
        let at = symbol(&bench, place);
        bench.machine.hang_at(at);
        bench.run(SECONDS);
        let history = told(&bench);
        report.row(format!("{place} hangs"), format!("{history:?}"));
        assert_eq!(history.reset, ResetCause::Watchdog);
        let crash = history.crash.expect("a hang");
        assert_eq!(crash.kind, CrashKind::Hang);
        assert_eq!(crash.stage, stage);
        // The next start has another cause, and tells of no hang any more.
        bench.machine.brown_out();
        bench.run(1.5);
        let next = told(&bench);
        assert_eq!((next.reset, next.crash), (ResetCause::BrownOut, None));
    }
}

#[test]
fn a_hard_fault_is_told_with_its_place() {
    let mut bench = board();
    bench.machine.crash();
    bench.run(SECONDS);
    let history = told(&bench);
    Report::new("what a start tells after a hard fault").row("told", format!("{history:x?}"));
    assert_eq!(history.reset, ResetCause::Watchdog);
    let crash = history.crash.expect("a crash");
    assert_eq!(crash.kind, CrashKind::HardFault);
    let flash = 0x0800_0000..0x0810_0000;
    assert!(flash.contains(&crash.at), "{:#x}", crash.at);
}

#[test]
fn a_crystal_that_dies_is_told() {
    let part = Part {
        crystal: Crystal::Dies(1_500_000),
        ..Part::default()
    };
    let mut bench = pressing(analog(), part, Material::GEL, 7);
    bench.run(2.0 + SECONDS);
    let history = told(&bench);
    Report::new("what a start tells after a crystal died").row("told", format!("{history:?}"));
    assert_eq!(history.reset, ResetCause::Watchdog);
    assert_eq!(history.crash.map(|c| c.kind), Some(CrashKind::ClockFailed));
}

/// GIVEN a host that knows no setting. WHEN it asks for one description after the other, THEN it gets every setting
/// of both sets of sensors, as this firmware has them, and at the end a refusal.
#[test]
fn a_board_describes_every_setting_that_it_has() {
    for image in [analog(), spi()] {
        let mut bench = pressing(image, Part::default(), Material::GEL, 7);
        bench.run(0.3);
        let (mut from, mut described) = (0, 0);
        loop {
            let answer = bench.ask(Command::Describe(from), 0.2);
            let setting = match answer {
                Some((Answer::Description(setting), _)) => setting,
                Some((Answer::Refused(reason, _), _)) => {
                    assert_eq!(reason, Refusal::UnknownSetting);
                    break;
                }
                other => panic!("{from}: {other:?}"),
            };
            let key = Key::from_id(setting.id).expect("a setting of this version");
            let info = key.info();
            assert_eq!(setting.name.as_str(), info.name);
            assert_eq!(setting.bounds, info.bounds, "{}", info.name);
            assert_eq!(setting.default, info.default, "{}", info.name);
            assert_eq!(setting.restarts, info.restarts, "{}", info.name);
            described += 1;
            match setting.id.checked_add(1) {
                Some(next) => from = next,
                None => break,
            }
        }
        within_the_model(&bench);
        assert_eq!(described, Key::ALL.len());
    }
}

/// A board that is not armed refuses a packet and says why, whatever was armed before a reset.
#[test]
fn a_reset_disarms() {
    let mut bench = board();
    bench.set(&crate::common::RENDERING);
    bench.arm();
    bench.machine.brown_out();
    bench.run(0.3);
    bench.set(&crate::common::RENDERING);
    let now_us = (bench.machine.chip.seconds() * 1e6) as u64;
    let told = packet(1, now_us, [1350.0, 5.0, 1.35, 0.5e-3]);
    let answer = bench.ask(Command::Reflect(told), 0.2);
    assert!(
        matches!(answer, Some((Answer::Refused(Refusal::NotArmed, _), _))),
        "{answer:?}"
    );
}
