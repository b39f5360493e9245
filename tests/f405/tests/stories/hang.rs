//! Hangs of every kind while a force is put out: it is at rest within 2 ms, without an instruction's help if need
//! be, and the board starts anew where nothing else helps.

use crate::common::{REST_S, Rendering, pressing};
use f405::bench::{Bench, analog};
use f405::chip::{Part, Reset};
use f405::report::Report;
use f405::world::Material;

/// Longer than the watchdog's window at 32 kHz.
const SECONDS: f64 = 11.5;

/// Breaks a board that puts a force out and measures until that rests.
fn hangs(story: &'static str, breaks: impl FnOnce(&mut Bench)) {
    let mut rendering = Rendering::start(analog(), Part::default());
    let rest = rendering.rest_after(breaks, SECONDS);
    let mut report = Report::new(story);
    report.row("output at rest after", format!("{:.2} ms", rest * 1e3));
    let resets = &rendering.bench.machine.chip.trace.resets;
    report.row("resets", format!("{resets:?}"));
    assert!(rest <= REST_S, "{:.2} ms", rest * 1e3);
    assert!(
        resets.iter().any(|(_, why)| *why == Reset::Watchdog)
            || rendering
                .bench
                .estimates()
                .last()
                .is_some_and(|(at, _)| { at > rendering.bench.machine.chip.seconds() - 0.1 }),
        "it neither goes on nor starts again"
    );
    assert!(rendering.bench.share() == 0.0, "never armed after a reset");
}

fn symbol(bench: &Bench, name: &str) -> u32 {
    *bench
        .image
        .symbols
        .get(name)
        .expect("the image has symbols")
}

// Before the repair: 9 913 ms, the watchdog's.
#[test]
fn the_sampling_task_hangs() {
    hangs("sampling task hangs", |bench| {
        let task = symbol(bench, "TICK");
        bench.machine.hang_at(task);
    });
}

// Before the repair: 9 913 ms, the watchdog's.
#[test]
fn the_core_hangs_with_interrupts_off() {
    hangs("interrupts off for good", |bench| {
        bench.machine.hang_without_interrupts();
    });
}

// Before the repair: 9 913 ms: the handler logs before it lets the output float, and the log waits for ever.
#[test]
fn a_hard_fault_while_a_probe_that_has_left_blocks_the_log() {
    hangs("hard fault with a blocked log", |bench| {
        bench.probe.block(&mut bench.machine);
        bench.probe_reads = false;
        // The log is full soon, and the fault's own line does not fit.
        bench.probe.fill(&mut bench.machine);
        bench.machine.crash();
    });
}

#[test]
fn a_hard_fault() {
    hangs("hard fault", |bench| bench.machine.crash());
}

/// A board that has stopped leaves the pin of the force as an input, whatever its timer does.
#[test]
fn a_board_that_has_stopped_lets_the_pin_of_the_force_float_by_itself() {
    let mut rendering = Rendering::start(analog(), Part::default());
    assert!(!rendering.bench.machine.chip.force_pin_is_input());
    rendering.bench.machine.crash();
    rendering.bench.run(0.01);
    assert!(rendering.bench.machine.chip.force_pin_is_input());
}

#[test]
fn the_telemetry_task_hangs() {
    let mut rendering = Rendering::start(analog(), Part::default());
    let rest = rendering.rest_after(
        |bench| {
            let task = symbol(bench, "SPARE");
            bench.machine.hang_at(task);
        },
        SECONDS,
    );
    let mut report = Report::new("telemetry task hangs");
    report.row("output at rest after", format!("{:.1} ms", rest * 1e3));
    let resets = &rendering.bench.machine.chip.trace.resets;
    report.row("resets", format!("{resets:?}"));
    // The sampling task goes on; packets come no more, so the force fades: 100 ms and 50 ms.
    assert!(rest <= 0.2, "{rest} s");
    assert!(resets.iter().any(|(_, why)| *why == Reset::Watchdog));
}

// Before the repair: a reset by the watchdog at 15.4 s; half of the estimates of 21 s are missing.
#[test]
fn a_probe_that_leaves_while_it_blocks_the_log_stops_nothing() {
    let mut bench = pressing(analog(), Part::default(), Material::GEL, 4);
    bench.run(1.0);
    bench.probe.block(&mut bench.machine);
    bench.probe_reads = false;
    bench.run(20.0);
    let mut report = Report::new("probe leaves while the log blocks");
    report.row("resets", format!("{:?}", bench.machine.chip.trace.resets));
    let last = bench.estimates().last().map_or(f64::NAN, |(at, _)| at);
    let count = bench.estimates().count();
    report.row(
        "estimates in 21 s",
        format!("{count}, the last at {last:.2} s"),
    );
    assert!(bench.machine.chip.trace.resets.is_empty());
    assert!(count > 20_500, "{count}");
}
