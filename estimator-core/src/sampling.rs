//! What happens to every instant on a board, and nothing else: convert, step, record. The firmware's
//! sampling task, its link proof and the host's simulated board are made of it.

use crate::config::Params;
use crate::estimate::Estimate;
use crate::estimator::{State, step};
use crate::link::Change;
use crate::sample::Sample;
use crate::sensing::{Codes, Watch};
use crate::settings::Setup;

/// What the sampling task leaves behind at every tick.
#[derive(Clone, Copy, Debug)]
pub struct Record {
    /// What the converters said; `None` of a recording in SI units.
    pub codes: Option<Codes>,
    /// What went in: recorded, it can be replayed with other settings.
    pub sample: Sample<f32>,
    /// What came out.
    pub estimate: Estimate<f32>,
}

/// The sampling task's own state.
#[derive(Clone, Debug)]
pub struct Sampler {
    setup: Setup,
    watch: Watch,
    state: State<f32>,
    count: u16,
}

impl Sampler {
    /// Before the first sample.
    pub fn new(setup: Setup) -> Self {
        Sampler {
            setup,
            watch: Watch::default(),
            state: State::new(&setup.params),
            count: 0,
        }
    }

    /// Takes over other settings.
    pub fn apply(&mut self, change: &Change) {
        self.setup = change.setup;
        if change.restart {
            self.watch = Watch::default();
            self.state = State::new(&self.setup.params);
        }
    }

    /// Codes in SI units, watched.
    pub fn convert(&mut self, codes: &Codes) -> Sample<f32> {
        self.setup.conversion.sample(&mut self.watch, codes)
    }

    /// The estimator's step.
    pub fn step(&mut self, sample: Sample<f32>) -> Estimate<f32> {
        isolated_step(&self.setup.params, &mut self.state, sample)
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

/// `step`, never inlined: the compiler would move parts of it past the stopwatch.
#[inline(never)]
fn isolated_step(
    params: &Params<f32>,
    state: &mut State<f32>,
    sample: Sample<f32>,
) -> Estimate<f32> {
    step(params, state, sample)
}
