//! Recorded samples through `step`: bits, events and faults, the tick, and what a step costs.

use crate::SAMPLES;
use crate::budget::{contains, within};
use crate::fields::{assert_same, estimate_fields, sample_fields};
use crate::frames::{every_frame_is_numbered, measured, records};
use estimator_core::board::frame::Frame;
use estimator_core::estimate::Event;
use estimator_core::{Config, Fault, Faults, Params, Sample, State, step};
use std::sync::LazyLock;
use tests::emulator::{Budget, Emulator, Run};
use tests::signal::palpation;

pub(crate) struct Replay {
    samples: Vec<Sample<f32>>,
    run: Run,
    pub(crate) budget: Budget,
}

/// One run for all tests of a replay.
pub(crate) static REPLAY: LazyLock<Replay> = LazyLock::new(|| {
    let samples = with_faults(palpation(SAMPLES, 1));
    let emulator = Emulator::from_env("replay").expect("set-up");
    let frames: Vec<Frame> = samples.iter().copied().map(Frame::Sample).collect();
    let (run, budget) = measured(&emulator, &frames);
    Replay {
        samples,
        run,
        budget,
    }
});

/// The samples with all that a board may deliver on a bad day, between the first and the second contact
/// and again late in the run.
fn with_faults(mut samples: Vec<Sample<f32>>) -> Vec<Sample<f32>> {
    for start in [2_500, 80_000] {
        samples[start].force_n = f32::NAN;
        samples[start + 10].position_m = f32::INFINITY;
        samples[start + 20].time_us = samples[start].time_us;
        samples[start + 30].faults = Faults::NONE.with(Fault::ForceSaturated);
        samples[start + 40].force_n = f32::MAX;
        samples[start + 50].position_m = -0.0;
        samples[start + 60].force_n = f32::from_bits(1);
    }
    // 250 ms are missing.
    samples.drain(90_000..90_250);
    samples
}

#[test]
fn every_frame_from_the_emulator_has_the_bits_of_the_host() {
    let params: Params<f32> = Config::default().validate().expect("the default is valid");
    let mut state = State::new(&params);
    let Replay { samples, run, .. } = &*REPLAY;
    every_frame_is_numbered(&run.frames);
    let frames = records(&run.frames);
    assert_eq!(frames.len(), 2 * samples.len());
    for (index, (sample, frames)) in samples.iter().zip(frames.chunks(2)).enumerate() {
        let estimate = step(&params, &mut state, *sample);
        let [Frame::Sample(input), Frame::Estimate(output)] = frames else {
            panic!("sample {index}: not a sample and its estimate: {frames:?}");
        };
        assert_same(index, sample, input, sample_fields);
        assert_same(index, &estimate, output, estimate_fields);
    }
}

#[test]
fn the_run_is_about_contact_in_both_materials_and_every_fault_shows() {
    let estimates = || {
        REPLAY
            .run
            .frames
            .iter()
            .filter_map(|(_, frame)| match frame {
                Frame::Estimate(estimate) => Some(estimate),
                _ => None,
            })
    };
    let contacts = estimates().filter(|e| e.event == Some(Event::Contact));
    assert!((60..400).contains(&contacts.count()));
    for fault in [
        Fault::ForceUnusable,
        Fault::PositionUnusable,
        Fault::TimeNotAdvancing,
        Fault::SampleMissed,
        Fault::ForceSaturated,
    ] {
        assert!(estimates().any(|e| e.faults.has(fault)), "{fault:?}");
    }
}

#[test]
fn the_tick_is_one_kilohertz_and_nothing_is_dropped() {
    let budget = &REPLAY.budget;
    let samples = REPLAY.samples.len() as u64;
    assert_eq!((budget.samples, budget.ticks), (samples, samples));
    assert_eq!((budget.dropped, budget.overruns), (0, 0));
    // The 250 ms that the recording lacks, and the two instants whose time stands still.
    assert_eq!(budget.missed, 252);
    // 1 instruction is 1 ns: a tick of 1 ms is 1 000 000 of them. QEMU rounds a period of SysTick
    // down to whole nanoseconds: 999 999.
    assert_eq!(budget.tick, 1_000_000);
    contains("tick.mean", budget.period.mean);
    contains("tick.min", budget.period.min);
    contains("tick.max", budget.period.max);
}

#[test]
fn a_step_costs_what_the_budget_says() {
    let budget = &REPLAY.budget;
    within("step", &budget.step);
    within("task", &budget.task);
}
