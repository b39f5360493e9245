//! What the sampling task costs and whether it is in time, counted while it runs.

use crate::board::link::Range;
use crate::estimate::fault::Fault;
use crate::estimate::sample::Sample;

/// Smallest, largest and mean of a series.
#[derive(Clone, Copy, Debug)]
pub struct Meter {
    min: u32,
    max: u32,
    sum: u64,
    count: u32,
}

impl Default for Meter {
    fn default() -> Self {
        Meter::new()
    }
}

impl Meter {
    /// Nothing measured yet.
    pub const fn new() -> Self {
        Meter {
            min: u32::MAX,
            max: 0,
            sum: 0,
            count: 0,
        }
    }

    /// One more of the series.
    pub fn record(&mut self, value: u32) {
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
#[derive(Clone, Copy, Debug)]
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
    /// From the position to the force that is put out.
    pub render: Meter,
    /// What the rig adds is taken off.
    pub compensate: Meter,
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
#[derive(Clone, Copy, Debug)]
pub struct Stations {
    /// The task starts.
    pub start: u32,
    /// The codes are there.
    pub acquired: u32,
    /// They are in SI units.
    pub converted: u32,
    /// The force that is rendered is out.
    pub put_out: u32,
    /// The rig's own effects are off.
    pub compensated: u32,
    /// The estimate is there.
    pub stepped: u32,
    /// It is in the queue, or dropped.
    pub queued: u32,
}

impl Default for Budget {
    fn default() -> Self {
        Budget::new()
    }
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
            render: Meter::new(),
            compensate: Meter::new(),
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
        self.render.record(at.put_out.wrapping_sub(at.converted));
        self.compensate
            .record(at.compensated.wrapping_sub(at.put_out));
        self.step.record(at.stepped.wrapping_sub(at.compensated));
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::fault::Faults;

    const TICK: u32 = 168_000;

    /// A task that starts at `start` and takes `cost`, with a sample of time `time_us`.
    fn run(budget: &mut Budget, start: u32, cost: u32, time_us: u64, faults: Faults) {
        let at = Stations {
            start,
            acquired: start.wrapping_add(93),
            converted: start.wrapping_add(143),
            put_out: start.wrapping_add(150),
            compensated: start.wrapping_add(170),
            stepped: start.wrapping_add(cost - 10),
            queued: start.wrapping_add(cost),
        };
        let sample = Sample {
            time_us,
            faults,
            ..Sample::default()
        };
        budget.sample(&at, &sample, false, 1000, TICK);
    }

    #[test]
    fn a_late_task_a_late_start_and_every_missing_instant_are_counted() {
        let mut budget = Budget::new();
        let mut start = u32::MAX - 3 * TICK;
        for i in 1..=10_u64 {
            // The stopwatch wraps on the way.
            run(&mut budget, start, 20_000, i * 1000, Faults::NONE);
            start = start.wrapping_add(TICK);
        }
        assert_eq!((budget.overruns, budget.missed), (0, 0));
        // As long as a tick is in time, one more is not.
        run(&mut budget, start, TICK, 11_000, Faults::NONE);
        assert_eq!(budget.overruns, 0);
        run(&mut budget, start, TICK + 1, 12_000, Faults::NONE);
        assert_eq!(budget.overruns, 1);
        // The board saw it come late, two instants are gone.
        let late = Faults::NONE.with(Fault::Overrun);
        run(&mut budget, start, 20_000, 15_000, late);
        assert_eq!((budget.overruns, budget.missed), (2, 2));
        // Time that stands still or runs back is none that is missing.
        run(&mut budget, start, 20_000, 15_000, Faults::NONE);
        run(&mut budget, start, 20_000, 3_000, Faults::NONE);
        assert_eq!((budget.overruns, budget.missed), (2, 2));
        assert_eq!(budget.samples, 15);
    }

    #[test]
    fn jitter_is_the_spread_of_the_periods() {
        let mut budget = Budget::new();
        let mut start = 0;
        for (i, late) in [0, 0, 40, 0, 0].into_iter().enumerate() {
            let time_us = 1000 * (i as u64 + 1);
            run(&mut budget, start + late, 500, time_us, Faults::NONE);
            start += TICK;
        }
        let expected = Range {
            min: TICK - 40,
            mean: TICK,
            max: TICK + 40,
        };
        assert_eq!(budget.period.range(), expected);
        assert_eq!(budget.convert.range().max, 50);
        assert_eq!(budget.render.range().max, 7);
        assert_eq!(budget.compensate.range().max, 20);
        assert_eq!(budget.step.range().max, 500 - 10 - 170);
        assert_eq!(budget.queue.range().max, 10);
        assert_eq!(Budget::new().step.range(), Range::default());
    }
}
