//! What happens to every instant on a board, and nothing else: convert, compensate, step, record. The
//! firmware's sampling task, its link proof and the host's simulated board are made of it.

use crate::config::Params;
use crate::estimate::Estimate;
use crate::estimator::{State, step};
use crate::link::Change;
use crate::rig::{Compensation, CompensationState};
use crate::sample::Sample;
use crate::sensing::{Codes, Watch};
use crate::settings::Setup;

/// What the sampling task leaves behind at every tick.
#[derive(Clone, Copy, Debug)]
pub struct Record {
    /// What the converters said; `None` of a recording in SI units.
    pub codes: Option<Codes>,
    /// What was read, before anything was taken off: recorded, it can be replayed with other
    /// settings.
    pub sample: Sample<f32>,
    /// What came out, with the stamp of the instant that it belongs to.
    pub estimate: Estimate<f32>,
}

/// The sampling task's own state.
#[derive(Clone, Debug)]
pub struct Sampler {
    setup: Setup,
    watch: Watch,
    memory: Option<CompensationState<f32>>,
    state: State<f32>,
    count: u16,
}

impl Sampler {
    /// Before the first sample. Never inlined: 2 KiB of flash each time, and 10 KiB of stack.
    #[inline(never)]
    pub fn new(setup: Setup) -> Self {
        Sampler {
            setup,
            watch: Watch::default(),
            memory: at_rest(&setup),
            state: State::new(&setup.params),
            count: 0,
        }
    }

    /// Takes over other settings.
    #[inline(never)]
    pub fn apply(&mut self, change: &Change) {
        match change.restart {
            true => *self = Sampler::new(change.setup),
            false => self.setup = change.setup,
        }
    }

    /// Codes in SI units, watched.
    pub fn convert(&mut self, codes: &Codes) -> Sample<f32> {
        self.setup.conversion.sample(&mut self.watch, codes)
    }

    /// The sample without what the rig adds; as it is if nothing is to be taken off.
    pub fn compensate(&mut self, read: Sample<f32>) -> Sample<f32> {
        let (Some(compensation), Some(memory)) = (&self.setup.compensation, &mut self.memory)
        else {
            return read;
        };
        self.state.hear(read.force_n);
        isolated_compensation(compensation, memory, read)
    }

    /// The estimator's step, on what [`Sampler::compensate`] gave. The stamp of the estimate is that
    /// of the instant that it belongs to: the filter's delay, and the compensation's, before the
    /// newest sample.
    pub fn step(&mut self, sample: Sample<f32>) -> Estimate<f32> {
        // Changed where it is: a copy costs 300 instructions.
        let mut estimate = isolated_step(&self.setup.params, &mut self.state, sample);
        estimate.time_us = estimate.time_us.saturating_sub(self.setup.late_us);
        estimate
    }

    /// Whether this record is one of those that are sent: every so many, and those in which
    /// something happens.
    pub fn is_sent(&mut self, estimate: &Estimate<f32>) -> bool {
        self.count = self.count.saturating_add(1);
        let due = self.count >= self.setup.every;
        if due {
            self.count = 0;
        }
        due || estimate.event.is_some()
    }
}

fn at_rest(setup: &Setup) -> Option<CompensationState<f32>> {
    setup.compensation.as_ref().map(Compensation::at_rest)
}

/// The compensation, never inlined, for the same reason as the step.
#[inline(never)]
fn isolated_compensation(
    compensation: &Compensation<f32>,
    memory: &mut CompensationState<f32>,
    read: Sample<f32>,
) -> Sample<f32> {
    compensation.step(memory, read)
}

/// `step`, never inlined: the compiler would move parts of it past the stopwatch.
#[inline(never)]
fn isolated_step(
    params: &Params<f32>,
    state: &mut State<f32>,
    sample: Sample<f32>,
) -> Estimate<f32> {
    step(params, state, sample)
}
