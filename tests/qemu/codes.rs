//! The whole sampling task: from the codes of the converters to frames.

use crate::SAMPLES;
use crate::budget::{contains, within};
use crate::fields::{assert_same, estimate_fields, sample_fields};
use crate::frames::{codes, every_frame_is_numbered, measured_codes, records};
use crate::replay::REPLAY;
use estimator_core::board::frame::Frame;
use estimator_core::board::link::Health;
use estimator_core::board::sensing::{Codes, Watch};
use estimator_core::board::settings::Settings;
use estimator_core::{Fault, Faults, State, step};
use std::sync::LazyLock;
use tests::emulator::{Budget, Emulator, Run};
use tests::signal::palpation;

/// One run for all tests of the whole task: codes, conversion, watch, step, queue, frames.
pub(crate) static FROM_CODES: LazyLock<(Vec<Codes>, Run, Budget)> = LazyLock::new(|| {
    let mut codes = codes(&palpation(SAMPLES, 2));
    // A conversion at the end of its range, an encoder that jumps, one that stands still.
    codes[40_000].force_high = 4095;
    codes[50_000..]
        .iter_mut()
        .for_each(|c| c.position += 32 * 6000);
    let held = codes[60_000].position;
    codes[60_000..61_500]
        .iter_mut()
        .for_each(|c| c.position = held);
    let held = codes[70_000].force;
    codes[70_000..71_500]
        .iter_mut()
        .for_each(|c| c.force = held);
    let emulator = Emulator::from_env("codes").expect("set-up");
    let (run, budget) = measured_codes(&emulator, &codes);
    (codes, run, budget)
});

#[test]
fn from_codes_to_frames_the_emulator_has_the_bits_of_the_host() {
    let setup = Settings::default().setup().expect("the default is valid");
    let (mut watch, mut state) = (Watch::default(), State::new(&setup.params));
    let (codes, run, _) = &*FROM_CODES;
    every_frame_is_numbered(&run.frames);
    let frames = records(&run.frames);
    assert_eq!(frames.len(), 3 * codes.len());
    let mut seen = Faults::NONE;
    for (index, (codes, frames)) in codes.iter().zip(frames.chunks(3)).enumerate() {
        let sample = setup.conversion.sample(&mut watch, codes);
        let estimate = step(&setup.params, &mut state, sample);
        seen = seen | estimate.faults;
        let [
            Frame::Codes(given),
            Frame::Sample(input),
            Frame::Estimate(output),
        ] = frames
        else {
            panic!("sample {index}: not codes, sample and estimate: {frames:?}");
        };
        assert_eq!(given, codes, "sample {index}");
        assert_same(index, &sample, input, sample_fields);
        assert_same(index, &estimate, output, estimate_fields);
    }
    for fault in [
        Fault::NotCalibrated,
        Fault::ForceSaturated,
        Fault::PositionJump,
        Fault::PositionStuck,
        Fault::ForceStuck,
    ] {
        assert!(seen.has(fault), "{fault:?}");
    }
}

#[test]
fn health_comes_once_a_second_and_counts_what_happened() {
    let (codes, run, budget) = &*FROM_CODES;
    let healths: Vec<&Health> = run
        .frames
        .iter()
        .filter_map(|(_, frame)| match frame {
            Frame::Health(health) => Some(health),
            _ => None,
        })
        .collect();
    assert_eq!(healths.len(), codes.len() / 1000);
    let last = healths.last().expect("one");
    assert_eq!(u64::from(last.samples), budget.samples);
    assert_eq!(
        (last.dropped, last.overruns, last.missed, last.garbled),
        (0, 0, 0, 0)
    );
    assert!(last.faults.has(Fault::NotCalibrated));
    // The counters grow, and the costs are those of the log.
    assert!(
        healths
            .windows(2)
            .all(|pair| pair[0].samples < pair[1].samples)
    );
    assert_eq!(u64::from(last.step.max), budget.step.max);
}

#[test]
fn every_stage_costs_what_the_budget_says() {
    let (_, _, budget) = &*FROM_CODES;
    within("convert", &budget.convert);
    within("queue", &budget.queue);
    within("encode", &budget.encode);
}

#[test]
fn the_stack_never_comes_near_its_end() {
    // Painted before the program starts, read back at the end of the run.
    let (_, _, budget) = &*FROM_CODES;
    contains("stack_free", budget.stack_free);
    contains("stack_free", REPLAY.budget.stack_free);
}
