//! Converters and streams that stop: said at once, and started again; a force that was put out is taken away.

use crate::common::{REST_S, Rendering, pressing, within_the_model};
use estimator_core::Fault;
use estimator_core::Status;
use estimator_core::board::settings::Key;
use f405::bench::{Bench, analog};
use f405::chip::Part;
use f405::report::Report;
use f405::world::{Loose, Material, Press, Strokes};

/// Breaks a sensor while the probe presses into gel; measures until a fault comes, and until samples are good
/// again.
fn breaks(story: &'static str, what: impl Fn(&mut Bench)) {
    let mut report = Report::new(story);
    let mut bench = pressing(analog(), Part::default(), Material::GEL, 6);
    bench.run(3.0);
    let from = bench.machine.chip.seconds();
    what(&mut bench);
    bench.run(3.0);
    within_the_model(&bench);
    let told =
        |faults: estimator_core::Faults| faults.iter().any(|fault| fault != Fault::NotCalibrated);
    let first = bench
        .estimates()
        .find(|(at, estimate)| *at > from && told(estimate.faults))
        .map(|(at, _)| at - from);
    let later = || bench.estimates().filter(|(at, _)| *at > from + 1.0);
    let count = later().count();
    let good = later().filter(|(_, estimate)| !told(estimate.faults));
    let good = good.count();
    let wrong = bench
        .estimates()
        .filter(|(at, _)| *at > from)
        .filter_map(|(_, estimate)| estimate.parameters[0].map(|k| (k.value / 1350.0 - 1.0).abs()))
        .fold(0.0, f32::max);
    let shown = first.map_or("never".into(), |s| format!("{:.1} ms", s * 1e3));
    report.row("fault said after", &shown);
    report.row(
        "estimates from 1 s to 3 s after it, and those without a fault",
        format!("{count}, {good}"),
    );
    report.row(
        "largest error of K after it",
        format!("{:.1} %", 100.0 * wrong),
    );
    assert!(first.is_some_and(|s| s < 0.02), "fault said after {shown}");
    assert!(count > 1950, "{count} estimates in 2 s");
    assert!(good > 1950, "{good} of them without a fault");
    assert!(wrong < 0.05, "K was off by {wrong}");
    let mut rendering = Rendering::start(analog(), Part::default());
    let rest = rendering.rest_after(&what, 1.0);
    report.row("output at rest after", format!("{:.2} ms", rest * 1e3));
    assert!(rest <= REST_S, "{rest} s");
}

// Before the repair: never said, no sample any more; the output stands until the watchdog, 10 s.
#[test]
fn an_overrun_of_the_adc() {
    breaks("ADC overrun", |bench| bench.machine.overrun_adc());
}

// Before the repair: as above.
#[test]
fn the_stream_of_the_force_stops() {
    breaks("force stream stops", |bench| {
        bench.machine.stop_stream(2, 0)
    });
}

// Before the repair: said after 2486 ms, where the force has risen by 5 N.
#[test]
fn the_stream_of_the_position_stops() {
    breaks("position stream stops", |bench| {
        bench.machine.stop_stream(1, 7)
    });
}

// Before the repair: the first arming was answered with "done", and the next look at the old latch took it away.
#[test]
fn after_a_fault_that_latched_one_arming_brings_the_force_back() {
    let mut rendering = Rendering::start(analog(), Part::default());
    rendering.bench.machine.stop_stream(1, 7);
    rendering.go_on(0.2);
    assert_eq!(rendering.bench.share(), 0.0, "it latched");
    rendering.bench.arm();
    rendering.go_on(0.7);
    within_the_model(&rendering.bench);
    let share = rendering.bench.share();
    assert!((0.3..0.7).contains(&share), "{share}");
}

/// A board whose cables come off and are put back, with the settings that tell.
fn loose(force: (f64, f64), position: (f64, f64)) -> Bench {
    let motion = Strokes::random(6, 0.8, 100.0, Strokes::depths(Material::GEL));
    let press = Press::new(motion, Material::GEL, 6);
    let world = Loose {
        world: press,
        force,
        position,
    };
    let mut bench = Bench::new(analog(), Part::default(), Box::new(world));
    bench.run(0.3);
    bench.set(&[
        // The amplifier's live zero: 410 to 3686 of 4095 codes for the whole range.
        (Key::ForceLowestCode, 410.0),
        (Key::ForceHighestCode, 3686.0),
        (Key::ForceBrokenBeyond, 205.0),
        (Key::PositionReachM, 0.02),
    ]);
    bench
}

/// The faults that are told between two times (s), and the largest relative error of K at the end.
fn told(bench: &Bench, from: f64, to: f64) -> Vec<Fault> {
    let mut all: Vec<Fault> = Vec::new();
    for (at, estimate) in bench.estimates() {
        if (from..to).contains(&at) {
            all.extend(estimate.faults.iter());
        }
    }
    all.sort_by_key(|fault| fault.code());
    all.dedup();
    all
}

const NEVER: (f64, f64) = (f64::INFINITY, f64::INFINITY);

#[test]
fn the_cable_of_the_load_cell_comes_off() {
    let mut report = Report::new("load cell's cable off for a second");
    let mut bench = loose((4.0, 5.0), NEVER);
    bench.run(8.0);
    within_the_model(&bench);
    assert!(!told(&bench, 0.5, 4.0).contains(&Fault::ForceUnusable));
    let first = bench
        .estimates()
        .find(|(_, estimate)| estimate.faults.has(Fault::ForceUnusable))
        .map(|(at, _)| at - 4.0);
    let first = first.expect("it is told");
    report.row("fault said after", format!("{:.1} ms", first * 1e3));
    assert!(first < 5e-3, "{first} s");
    // Nothing is learned of it, and it goes on where it was.
    let k =
        |estimate: &estimator_core::Estimate| estimate.parameters[0].map(|k| f64::from(k.value));
    let off = bench
        .estimates()
        .filter(|(at, _)| *at > 4.0)
        .filter_map(|(_, estimate)| k(estimate))
        .map(|k| (k / 1350.0 - 1.0).abs())
        .fold(0.0, f64::max);
    report.row("largest error of K since", format!("{:.1} %", 100.0 * off));
    assert!(off < 0.05, "{off}");
    let (_, last) = bench.estimates().last().expect("estimates");
    assert_eq!(last.status, Status::Converged);
}

#[test]
fn the_cable_of_the_encoder_comes_off() {
    let mut report = Report::new("encoder's cable off");
    // The counter takes noise for 100 counts a millisecond: 0.1 m/s, which is no jump.
    let mut bench = loose(NEVER, (4.0, 5.0));
    bench.run(6.0);
    within_the_model(&bench);
    let first = bench
        .estimates()
        .find(|(_, estimate)| estimate.faults.has(Fault::PositionUnusable))
        .map(|(at, _)| at - 4.0);
    let first = first.expect("it is told");
    report.row(
        "fault said after, at 0.1 m/s and a reach of 20 mm",
        format!("{:.0} ms", first * 1e3),
    );
    assert!(first < 0.25, "{first} s");
}
