//! Crystals that are dead, late, or die; nothing that locks; a debugger that takes the cycle counter away.

use crate::common::{REST_S, Rendering, identified, pressing, within_the_model};
use estimator_core::Fault;
use f405::bench::{Bench, analog};
use f405::chip::{Crystal, Part, Reset};
use f405::report::Report;
use f405::world::Material;

fn with(crystal: Crystal) -> Part {
    Part {
        crystal,
        ..Part::default()
    }
}

fn logged(bench: &Bench, text: &str) -> bool {
    bench.log().iter().any(|line| line.contains(text))
}

#[test]
fn with_a_dead_crystal_it_measures_on_the_internal_oscillator_and_says_so() {
    let mut report = Report::new("dead crystal");
    for crystal in [Crystal::Dead, Crystal::Unlockable] {
        let mut bench = pressing(analog(), with(crystal), Material::GEL, 2);
        bench.run(5.0);
        within_the_model(&bench);
        assert!(
            logged(&bench, "registers as expected"),
            "{:#?}",
            bench.log()
        );
        let health = bench.healths().last().expect("health comes");
        assert!(health.clock_fallback && health.faults.has(Fault::ClockInternal));
        assert_eq!((bench.lost(), bench.host.garbled), (0, 0));
        // The oscillator is 0.3 % fast, and so is the board's time.
        let found = identified(&bench).expect("converged");
        report.row(format!("{crystal:?}: K, λ, n"), format!("{found:.4?}"));
        for (found, truth) in found.iter().zip([1350.0, 36.0, 1.35]) {
            assert!((found / truth - 1.0).abs() < 0.01, "{found} for {truth}");
        }
    }
}

#[test]
fn a_late_crystal_is_waited_for() {
    let mut bench = pressing(analog(), with(Crystal::Late(60)), Material::GEL, 2);
    bench.run(1.5);
    within_the_model(&bench);
    assert!(logged(&bench, "registers as expected"));
    let health = bench.healths().last().expect("health comes");
    assert!(!health.clock_fallback);
    let (at, _) = bench.estimates().next().expect("estimates");
    Report::new("late crystal, 60 ms")
        .row("first estimate after power", format!("{:.1} ms", at * 1e3));
}

#[test]
fn without_any_clock_the_watchdog_starts_the_board_again() {
    let mut report = Report::new("no clock at all");
    for hz in [17_000, 47_000] {
        let part = Part {
            watchdog_hz: hz,
            ..with(Crystal::Dead)
        };
        let mut bench = pressing(analog(), part, Material::GEL, 2);
        bench.machine.internal_never_locks();
        bench.run(25.0);
        within_the_model(&bench);
        assert!(logged(&bench, "does not lock"));
        let resets = &bench.machine.chip.trace.resets;
        let (at, why) = resets.first().expect("a reset");
        assert_eq!(*why, Reset::Watchdog);
        let after = crate::common::seconds(*at);
        report.row(
            format!("reset after, watchdog at {hz} Hz"),
            format!("{after:.1} s"),
        );
        assert!(
            bench
                .machine
                .chip
                .trace
                .drive
                .iter()
                .all(|(_, drive)| drive.is_rest(0.0))
        );
    }
}

// Before the repair: PB12 was an input while the crystal was waited for, and without any clock.
#[test]
fn the_gate_driver_is_held_off_while_a_clock_is_waited_for_and_where_there_is_none() {
    let mut bench = pressing(analog(), with(Crystal::Dead), Material::GEL, 2);
    bench.machine.internal_never_locks();
    for (what, until) in [("the crystal is waited for", 0.05), ("no clock", 3.0)] {
        bench.run(until - bench.machine.chip.seconds());
        assert!(bench.machine.chip.gate_driver_is_off(), "{what}");
    }
    within_the_model(&bench);
    assert!(logged(&bench, "does not lock"));
}

// Before the repair: 10 203 ms, the watchdog's; before that the pin stands where it was, high or low.
#[test]
fn a_crystal_that_dies_while_a_force_is_put_out_takes_it_away_at_once() {
    const DEATH_US: u64 = 1_500_000;
    let mut report = Report::new("dying crystal");
    let mut longest = 0.0_f64;
    // The pin stands where it was: at four instants of a period it is high or low.
    for later_us in [0, 8, 16, 24] {
        let crystal = Crystal::Dies(DEATH_US + later_us);
        let mut rendering = Rendering::start(analog(), with(crystal));
        rendering.go_on(12.0);
        within_the_model(&rendering.bench);
        let from = 1e-6 * (DEATH_US + later_us) as f64;
        longest = longest.max(rendering.bench.time_to_rest(from, 0.0));
        let resets = &rendering.bench.machine.chip.trace.resets;
        report.row("resets", format!("{resets:?}"));
        let health = rendering.bench.healths().last().expect("health comes");
        assert!(
            health.clock_fallback,
            "it goes on from the internal oscillator"
        );
    }
    report.row("output at rest after", format!("{:.2} ms", longest * 1e3));
    assert!(longest <= REST_S, "{longest} s");
}

// Before the repair: one sample in the second after it: every tick counts as a spurious one.
#[test]
fn a_debugger_that_switches_the_cycle_counter_off_does_not_stop_the_samples() {
    let mut bench = pressing(analog(), Part::default(), Material::GEL, 2);
    bench.run(1.0);
    let before = bench.estimates().count();
    bench.machine.trace_off();
    bench.run(1.0);
    let after = bench.estimates().count() - before;
    Report::new("cycle counter taken away").row("samples in the second after it", after);
    assert!((990..=1010).contains(&after), "{after}");
}
