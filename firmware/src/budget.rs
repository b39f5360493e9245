//! What the sampling task costs and whether it is in time, counted while it runs.

use estimator_core::link::Range;
use estimator_core::{Fault, Sample};

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
        self.sum = self.sum.wrapping_add(u64::from(value));
        self.count = self.count.wrapping_add(1);
    }

    /// All three; zeros of an empty series.
    pub fn range(&self) -> Range {
        match self.sum.checked_div(u64::from(self.count)) {
            Some(mean) => Range {
                min: self.min,
                mean: mean as u32,
                max: self.max,
            },
            None => Range::default(),
        }
    }
}

/// Counters of the sampling task since start.
#[derive(Clone, Copy)]
pub struct Budget {
    /// Times that the task ran.
    pub ticks: u32,
    /// Samples that went through `step`.
    pub samples: u32,
    /// Records that found the queue full.
    pub dropped: u32,
    /// Times that the task took longer than a tick, or that the board saw it come late.
    pub overruns: u32,
    /// Instants that no sample was taken of.
    pub missed: u32,
    /// Between two starts of the task.
    pub period: Meter,
    /// From the codes to SI units.
    pub convert: Meter,
    /// `step` alone.
    pub step: Meter,
    /// From the estimate to the queue.
    pub queue: Meter,
    /// The whole task.
    pub task: Meter,
    last_start: Option<u32>,
    last_time_us: Option<u64>,
    /// Whether the sensors have reported the end of their recording.
    pub finished: bool,
}

/// The stopwatch at the task's stations.
#[derive(Clone, Copy)]
pub struct Stations {
    /// The task starts.
    pub start: u32,
    /// The codes are there.
    pub acquired: u32,
    /// They are in SI units.
    pub converted: u32,
    /// The estimate is there.
    pub stepped: u32,
    /// It is in the queue, or dropped.
    pub queued: u32,
}

impl Budget {
    /// Nothing counted yet.
    pub const fn new() -> Self {
        Budget {
            ticks: 0,
            samples: 0,
            dropped: 0,
            overruns: 0,
            missed: 0,
            period: Meter::new(),
            convert: Meter::new(),
            step: Meter::new(),
            queue: Meter::new(),
            task: Meter::new(),
            last_start: None,
            last_time_us: None,
            finished: false,
        }
    }

    /// A sample went through. `period_us` and `tick`: the time between two samples in µs and in the
    /// stopwatch's unit; `dropped`: its record found the queue full.
    pub fn sample(
        &mut self,
        at: &Stations,
        sample: &Sample<f32>,
        dropped: bool,
        period_us: u64,
        tick: u32,
    ) {
        self.ticks = self.ticks.wrapping_add(1);
        self.samples = self.samples.wrapping_add(1);
        self.dropped = self.dropped.wrapping_add(u32::from(dropped));
        if let Some(last) = self.last_start.replace(at.start) {
            self.period.record(at.start.wrapping_sub(last));
        }
        self.convert.record(at.converted.wrapping_sub(at.acquired));
        self.step.record(at.stepped.wrapping_sub(at.converted));
        self.queue.record(at.queued.wrapping_sub(at.stepped));
        let task = at.queued.wrapping_sub(at.start);
        self.task.record(task);
        let late = task > tick || sample.faults.has(Fault::Overrun);
        self.overruns = self.overruns.wrapping_add(u32::from(late));
        self.count_missed(sample.time_us, period_us);
    }

    /// Whole periods between two samples, less the one that there should be.
    fn count_missed(&mut self, time_us: u64, period_us: u64) {
        let last = self.last_time_us.unwrap_or(time_us);
        if time_us < last {
            return;
        }
        self.last_time_us = Some(time_us);
        let periods = (time_us - last + period_us / 2)
            .checked_div(period_us)
            .unwrap_or(0);
        let missed = u32::try_from(periods.saturating_sub(1)).unwrap_or(u32::MAX);
        self.missed = self.missed.saturating_add(missed);
    }
}
