//! Converters and streams that stop: said at once, and started again; a force that was put out is taken away.

use crate::common::{REST_S, Rendering, pressing, within_the_model};
use estimator_core::Fault;
use f405::bench::{Bench, analog};
use f405::chip::Part;
use f405::report::Report;
use f405::world::Material;

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
    let count = bench.estimates().filter(|(at, _)| *at > from + 1.0).count();
    let wrong = bench
        .estimates()
        .filter(|(at, _)| *at > from)
        .filter_map(|(_, estimate)| estimate.parameters[0].map(|k| (k.value / 1350.0 - 1.0).abs()))
        .fold(0.0, f32::max);
    let shown = first.map_or("never".into(), |s| format!("{:.1} ms", s * 1e3));
    report.row("fault said after", &shown);
    report.row("estimates from 1 s to 3 s after it", count);
    report.row(
        "largest error of K after it",
        format!("{:.1} %", 100.0 * wrong),
    );
    assert!(first.is_some_and(|s| s < 0.02), "fault said after {shown}");
    assert!(count > 1950, "{count} estimates in 2 s");
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
