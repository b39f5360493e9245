//! The serial link at full telemetry: records come soon and all of them, around a `save` and under commands and
//! packets.

use crate::common::{RENDERING, packet, pressing, within_the_model};
use estimator_core::board::frame::Frame;
use estimator_core::board::link::{Answer, Command, Refusal};
use estimator_core::board::settings::Key;
use f405::bench::{Bench, analog};
use f405::chip::Part;
use f405::report::Report;
use f405::world::{Material, REST_M};

const SAMPLE: u32 = 16 + 56;

fn free(part: Part) -> Bench {
    let motion = |_: f64| (REST_M, 0.0);
    let world = f405::world::Press::new(motion, Material::GEL, 9);
    let mut bench = Bench::new(analog(), part, Box::new(world));
    bench.machine.chip.trace.followed = SAMPLE;
    bench
}

/// The mean and the largest lag of the records that came between two times (s).
fn lag(bench: &Bench, from: f64, to: f64) -> (f64, f64) {
    let lags: Vec<f64> = bench
        .lags()
        .into_iter()
        .filter(|(at, _)| (from..to).contains(at))
        .map(|(_, lag)| lag)
        .collect();
    let mean = lags.iter().sum::<f64>() / lags.len().max(1) as f64;
    (mean, lags.iter().copied().fold(0.0, f64::max))
}

/// A board that sends every thousandth record. WHEN the probe is pressed into gel, THEN a save is refused, and after a
/// restart that finds free air there a save is done; and in free air the light flashes for a tenth of a second.
// Before the repair: refused until the next record; the light was that of the last record, on for a second or off.
#[test]
fn what_asks_for_the_phase_gets_that_of_now_though_few_records_are_sent() {
    let motion = |t: f64| match t {
        ..4.0 => (REST_M, 0.0),
        4.0..4.1 => (REST_M + (t - 4.0) * 25e-3, 25e-3),
        _ => (2e-3, 0.0),
    };
    let world = f405::world::Press::new(motion, Material::GEL, 9);
    let mut bench = Bench::new(analog(), Part::default(), Box::new(world));
    bench.run(0.3);
    bench.set(&[(Key::TelemetryEvery, 1000.0)]);
    let mut lit = 0;
    for _ in 0..3000 {
        bench.run(1e-3);
        lit += u32::from(bench.machine.chip.light());
    }
    assert!((290..=310).contains(&lit), "on for {lit} ms of 3 s");
    bench.run(1.0);
    assert!(bench.machine.chip.light(), "in contact");
    let mut ask = |command| bench.ask(command, 1.0).map(|(answer, _)| answer);
    let in_contact = Answer::Refused(Refusal::InContact, 0);
    assert_eq!(ask(Command::Save), Some(in_contact));
    assert_eq!(ask(Command::Restart), Some(Answer::Done));
    bench.run(0.4);
    let saved = bench.ask(Command::Save, 6.0).map(|(answer, _)| answer);
    assert_eq!(saved, Some(Answer::Done));
    within_the_model(&bench);
}

// Before the repair: no health at all.
#[test]
fn saves_in_free_air_lose_no_record_and_leave_no_lag() {
    let mut report = Report::new("six saves in free air");
    let mut bench = free(Part::default());
    bench.run(1.0);
    let (before, _) = lag(&bench, 0.5, 1.0);
    for value in 0..6 {
        bench.set(&[(Key::RenderShaping, 1.0 + value as f32)]);
        let answer = bench.ask(Command::Save, 6.0);
        assert!(matches!(answer, Some((Answer::Done, _))), "{answer:?}");
        bench.run(0.5);
    }
    bench.run(1.0);
    within_the_model(&bench);
    let now = bench.machine.chip.seconds();
    let (after, most) = lag(&bench, now - 0.5, now);
    let (_, most_ever) = lag(&bench, 0.5, now);
    let health = bench.healths().last().copied().unwrap_or_default();
    report.row("mean lag before", format!("{:.1} ms", before * 1e3));
    report.row(
        "mean lag a second after the last",
        format!("{:.1} ms (at most {:.1})", after * 1e3, most * 1e3),
    );
    report.row("largest lag", format!("{:.1} ms", most_ever * 1e3));
    report.row(
        "records dropped, frames lost, samples missed",
        format!("{}, {}, {}", health.dropped, bench.lost(), health.missed),
    );
    let healths = bench.healths().count();
    report.row(
        format!("states of health in {now:.0} s, of which the core stood still for 4"),
        healths,
    );
    assert_eq!((health.dropped, bench.lost()), (0, 0));
    assert!(after < before + 2e-3, "{before} s, then {after} s");
    assert!(healths >= 5, "{healths} states of health");
}

// Before the repair: no health in 60 s; a mean lag of 68 ms.
#[test]
fn health_comes_every_second_under_commands_and_packets_at_full_telemetry() {
    const SECONDS: usize = 60;
    let mut report = Report::new("60 s of full telemetry, health, commands, packets, saves");
    let mut bench = pressing(analog(), Part::default(), Material::GEL, 8);
    bench.machine.chip.trace.followed = SAMPLE;
    bench.run(0.3);
    bench.set(&RENDERING);
    bench.set(&[(Key::ReflectionEvery, 50.0)]);
    let (mut asked, mut answered, mut slowest) = (0, 0, 0.0_f64);
    let mut sequence = 0;
    while bench.machine.chip.seconds() < SECONDS as f64 {
        bench.run(0.09);
        sequence += 1;
        let now_us = (bench.machine.chip.seconds() * 1e6) as u64;
        let told = packet(sequence, now_us, [1350.0, 5.0, 1.35, 0.5e-3]);
        let command = match sequence % 20 {
            7 => Command::Save,
            // A save disarms; a force that is put out has a frame of its own at every sample.
            8 | 1 => Command::Arm,
            n if n % 2 == 0 => Command::Reflect(told),
            _ => Command::Get(Key::EstimatorHalfWidth.id()),
        };
        asked += 1;
        if let Some((_, took)) = bench.ask(command, 6.0) {
            answered += 1;
            slowest = slowest.max(took);
        }
    }
    within_the_model(&bench);
    let now = bench.machine.chip.seconds();
    let (mean, most) = lag(&bench, 1.0, now);
    let health = bench.healths().last().copied().unwrap_or_default();
    let records = bench
        .host
        .frames
        .iter()
        .filter(|r| matches!(r.frame, Frame::Codes(_)));
    report.row("records", records.count());
    let rendered = bench.host.frames.iter();
    let rendered = rendered.filter(|r| matches!(r.frame, Frame::Rendered(_)));
    let rendered = rendered.count();
    report.row("rendered forces", rendered);
    // More than a line carries that is looked at once a millisecond: 128 bytes.
    assert!(rendered > 40_000, "{rendered}");
    report.row(
        "lag",
        format!("{:.1} ms mean, {:.1} ms at most", mean * 1e3, most * 1e3),
    );
    report.row(
        "records dropped, frames lost, late tasks",
        format!("{}, {}, {}", health.dropped, bench.lost(), health.overruns),
    );
    report.row("states of health", bench.healths().count());
    report.row(
        "commands answered",
        format!(
            "{answered} of {asked}, the slowest after {:.0} ms",
            slowest * 1e3
        ),
    );
    report.row(
        "bytes a millisecond",
        format!("{:.0}", bench.host.bytes as f64 / now / 1e3),
    );
    assert_eq!(answered, asked);
    assert_eq!((health.dropped, bench.lost()), (0, 0));
    // The core stands still for 4 s, while the first save erases.
    assert!(
        bench.healths().count() >= SECONDS - 6,
        "{}",
        bench.healths().count()
    );
}
