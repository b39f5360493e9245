//! What the sampling task costs, counted while it runs.

use crate::board::{Board, Selected};
use estimator_core::{Estimate, Params, Sample, State, step};

/// `step`, never inlined: the compiler would move parts of it past the stopwatch.
#[inline(never)]
pub fn isolated_step(
    params: &Params<f32>,
    state: &mut State<f32>,
    sample: Sample<f32>,
) -> Estimate<f32> {
    step(params, state, sample)
}

/// Smallest, largest and mean of a series.
#[derive(Clone, Copy)]
pub struct Meter {
    min: u32,
    max: u32,
    sum: u64,
    count: u32,
}

impl Meter {
    const fn new() -> Self {
        Meter {
            min: u32::MAX,
            max: 0,
            sum: 0,
            count: 0,
        }
    }

    fn record(&mut self, value: u32) {
        self.min = self.min.min(value);
        self.max = self.max.max(value);
        self.sum += u64::from(value);
        self.count += 1;
    }

    fn mean(&self) -> u32 {
        self.sum.checked_div(u64::from(self.count)).unwrap_or(0) as u32
    }
}

impl defmt::Format for Meter {
    fn format(&self, f: defmt::Formatter) {
        if self.count == 0 {
            return defmt::write!(f, "none");
        }
        defmt::write!(f, "{}/{}/{}", self.min, self.mean(), self.max)
    }
}

/// Counters of the sampling task since start.
#[derive(Clone, Copy)]
pub struct Budget {
    /// Times that the task ran.
    ticks: u32,
    /// Samples that went through `step`.
    samples: u32,
    /// Frames that found the queue full.
    dropped: u32,
    /// Between two starts of the task.
    period: Meter,
    /// `step` alone.
    step: Meter,
    /// The whole task.
    task: Meter,
    last_start: Option<u32>,
    /// Whether the sensors have reported the end of their recording.
    pub finished: bool,
}

impl Budget {
    /// Nothing counted yet.
    pub const fn new() -> Self {
        Budget {
            ticks: 0,
            samples: 0,
            dropped: 0,
            period: Meter::new(),
            step: Meter::new(),
            task: Meter::new(),
            last_start: None,
            finished: false,
        }
    }

    /// The task starts.
    pub fn tick(&mut self, start: u32) {
        self.ticks += 1;
        if let Some(last) = self.last_start.replace(start) {
            self.period.record(start.wrapping_sub(last));
        }
    }

    /// A sample went through `step`, which took from `before` to `after`; `queued`: whether there
    /// was room for its frames.
    pub fn sample(&mut self, before: u32, after: u32, queued: bool) {
        self.samples += 1;
        self.dropped += u32::from(!queued);
        self.step.record(after.wrapping_sub(before));
    }

    /// The task ends.
    pub fn end(&mut self, start: u32, now: u32) {
        self.task.record(now.wrapping_sub(start));
    }

    /// Logs everything, as `key=value` (tests/qemu.rs reads it) with min/mean/max.
    pub fn log(&self) {
        defmt::info!(
            "budget: unit={=str} samples={=u32} ticks={=u32} dropped={=u32} tick={=u32} period={} step={} task={}",
            Selected::COST_UNIT,
            self.samples,
            self.ticks,
            self.dropped,
            Selected::TICK,
            self.period,
            self.step,
            self.task
        );
    }
}
