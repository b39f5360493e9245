//! Which instants a sample describes: force and position the same ones, whatever the software's latency.

use crate::common::{Rendering, within_the_model};
use estimator_core::board::frame::Frame;
use f405::bench::{Bench, analog};
use f405::chip::{Drive, MICROSECOND, Part};
use f405::report::Report;
use f405::world::{Material, Press, Random};

const DMA2_STREAM0: u32 = 56;
/// 50 mm/s away from the surface, in codes a millisecond: 50 counts, 32 latches summed.
const CODES_PER_MS: i64 = 50 * 32;

fn moving() -> Bench {
    let motion = |t: f64| (-1e-3 - 50e-3 * t, -50e-3);
    let world = Press::new(motion, Material::GEL, 1);
    Bench::new(analog(), Part::default(), Box::new(world))
}

/// Positions of the records with their times (ms).
fn positions(bench: &Bench) -> Vec<(i64, i64)> {
    let codes = bench.host.frames.iter().filter_map(|r| match &r.frame {
        Frame::Codes(codes) => Some((codes.time_us as i64 / 1000, i64::from(codes.position))),
        _ => None,
    });
    codes.collect()
}

// Before the repair: 450 codes (14.1 µm) with delays up to 300 µs, without a fault.
#[test]
fn three_hundred_microseconds_of_latency_shift_no_sample() {
    let mut report = Report::new("300 µs of latency at 50 mm/s");
    let mut bench = moving();
    bench.run(0.5);
    let mut random = Random(77);
    for _ in 0..400 {
        // Somewhere in a millisecond, for up to 300 µs.
        bench.run(1e-3 * (1.0 + random.unit()));
        let us = (300.0 * random.unit()) as u64;
        bench.machine.hold_interrupts(&[DMA2_STREAM0], us);
    }
    bench.run(0.1);
    within_the_model(&bench);
    let positions = positions(&bench);
    let (start, first) = positions[20];
    // The mean line is known: the speed is.
    let shifts = positions
        .iter()
        .skip(20)
        .map(|(ms, code)| code - first + CODES_PER_MS * (ms - start));
    let most = shifts.map(i64::abs).max().unwrap_or(0);
    report.row(
        "largest shift of a sample",
        format!("{most} codes, {:.2} µm", most as f64 / 32.0),
    );
    // A count of quantisation in each of 32 latches.
    assert!(most <= 32, "{most} codes");
}

// Before the repair: 22.86 µs after its own latch, 8.39 µs before the next.
#[test]
fn the_adc_holds_when_the_encoder_is_latched() {
    let mut bench = moving();
    bench.machine.chip.trace.keep_instants = true;
    bench.run(0.2);
    let trace = &bench.machine.chip.trace;
    let distance = |hold: &u64| {
        let next = trace.latches.partition_point(|latch| latch < hold);
        let around = [next.wrapping_sub(1), next].map(|i| trace.latches.get(i));
        around
            .into_iter()
            .flatten()
            .map(|latch| latch.abs_diff(*hold))
            .min()
    };
    let holds = &trace.holds[10..trace.holds.len() - 10];
    let most = holds.iter().filter_map(distance).max().expect("holds");
    let us = most as f64 / MICROSECOND as f64;
    Report::new("force and position").row(
        "hold of the ADC to the nearest latch of the encoder",
        format!("{us:.2} µs"),
    );
    assert!(us <= 1.0, "{us} µs");
}

// Before the repair: 0.01 µs: the edge sweeps over the hold at 73 % of the range.
#[test]
fn no_edge_of_the_output_is_within_a_microsecond_of_a_hold() {
    let mut rendering = Rendering::start_along(analog(), Part::default(), |t: f64| match t {
        ..0.5 => (-0.5e-3, 0.0),
        ..0.6 => (-0.5e-3 + (t - 0.5) * 30e-3, 30e-3),
        ..1.0 => (2.5e-3, 0.0),
        _ => (2.5e-3 + 2.4e-3 * (3.0 * (t - 1.0)).sin(), 0.0),
    });
    let from = rendering.bench.machine.chip.now;
    rendering.go_on(2.5);
    within_the_model(&rendering.bench);
    let trace = &rendering.bench.machine.chip.trace;
    let shares = trace
        .drive
        .iter()
        .filter(|(at, _)| *at > from)
        .map(|(_, drive)| match drive {
            Drive::Share(share) => *share,
            Drive::Floating => 0.0,
        });
    let (least, most) = shares.fold((1.0_f64, 0.0_f64), |(a, b), s| (a.min(s), b.max(s)));
    assert!(least < 0.05 && most > 0.9, "swept from {least} to {most}");
    let us = trace.nearest_edge.expect("edges") as f64 / MICROSECOND as f64;
    Report::new("edges of the output").row("nearest to a hold of the ADC", format!("{us:.2} µs"));
    assert!(us >= 1.0, "{us} µs");
}
