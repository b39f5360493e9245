//! The cost of the sampling task and its punctuality, counted while the task runs.

use crate::board::link::{Health, Range};
use crate::board::protection::Latch;
use crate::estimate::{Phase, fault::Fault, sample::Sample};

/// A meter keeps the minimum, the mean and the maximum of a series.
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
    /// A new meter has measured nothing.
    pub const fn new() -> Self {
        Meter {
            min: u32::MAX,
            max: 0,
            sum: 0,
            count: 0,
        }
    }

    /// Adds a value to the series.
    pub fn record(&mut self, value: u32) {
        self.min = self.min.min(value);
        self.max = self.max.max(value);
        self.sum = self.sum.wrapping_add(u64::from(value));
        self.count = self.count.wrapping_add(1);
    }

    /// Returns minimum, mean and maximum, which are zeros while the series is empty.
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

/// The counters and meters of the sampling task since start. Times are in the unit of the board's
/// stopwatch.
#[derive(Clone, Copy, Debug)]
pub struct Budget {
    /// This counts the runs of the task.
    pub ticks: u32,
    /// This counts the samples that went through `step`.
    pub samples: u32,
    /// This counts the records that found the queue full.
    pub dropped: u32,
    /// This counts the runs that took longer than a tick or that the board saw start late.
    pub overruns: u32,
    /// This counts the instants of which no sample was taken.
    pub missed: u32,
    /// This measures the time between two starts of the task; its spread is the jitter.
    pub period: Meter,
    /// This measures the conversion from codes to SI units.
    pub convert: Meter,
    /// This measures the rendering, from the position to the force at the output.
    pub render: Meter,
    /// This measures the compensation of the rig's effects.
    pub compensate: Meter,
    /// This measures `step` alone.
    pub step: Meter,
    /// This measures the way of the record into the queue.
    pub queue: Meter,
    /// This measures the whole task.
    pub task: Meter,
    /// This measures the time from the instant at which a sample was due to the end of its task.
    pub response: Meter,
    /// Whether the output was armed at the last sample.
    pub armed: bool,
    /// What holds it at rest.
    pub latch: Latch,
    /// The phase at the last sample: what is sent may be older, by `telemetry.every` samples or a full queue.
    pub phase: Phase,
    last_start: Option<u32>,
    /// The time of the last sample (µs), of which 32 bits tell how long ago it was: differences of 64 cost more.
    last_time_us: Option<u32>,
    /// This is true as soon as the sensors have reported the end of their recording.
    pub finished: bool,
}

/// The readings of the stopwatch at the begin of a tick.
#[derive(Clone, Copy, Debug)]
pub struct Started {
    /// The instant was due at this reading.
    pub due: u32,
    /// The task started at this reading.
    pub start: u32,
}

/// The readings of the stopwatch in one tick, one at the end of each stage.
#[derive(Clone, Copy, Debug)]
pub struct StageTimes {
    /// The readings before the first stage.
    pub started: Started,
    /// The sensors had been read.
    pub acquired: u32,
    /// The sample was in SI units.
    pub converted: u32,
    /// The rendered force was at the output.
    pub put_out: u32,
    /// The effects of the rig had been taken off.
    pub compensated: u32,
    /// The estimate was ready.
    pub stepped: u32,
    /// The record was in the queue, or dropped.
    pub queued: u32,
}

/// The outcome of a tick, for the budget.
#[derive(Clone, Copy, Debug)]
pub struct Sampled {
    /// The stopwatch was read at the end of each stage.
    pub times: StageTimes,
    /// The sample before the compensation.
    pub sample: Sample<f32>,
    /// The record was due, but the queue was full.
    pub dropped: bool,
    /// The force output is armed and nothing holds it at rest.
    pub armed: bool,
    /// What holds the output at rest since it was armed.
    pub latch: Latch,
    /// The phase after the sample.
    pub phase: Phase,
}

impl Default for Budget {
    fn default() -> Self {
        Budget::new()
    }
}

impl Budget {
    /// A new budget has counted nothing.
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
            response: Meter::new(),
            armed: false,
            latch: Latch::new(),
            phase: Phase::Settling,
            last_start: None,
            last_time_us: None,
            finished: false,
        }
    }

    /// Counts a tick. The time between two samples is `period_us` (µs), and `tick` in the unit of
    /// the stopwatch.
    pub fn count(&mut self, sampled: &Sampled, period_us: u64, tick: u32) {
        let Sampled {
            times,
            sample,
            dropped,
            armed,
            latch,
            phase,
        } = sampled;
        (self.armed, self.latch, self.phase) = (*armed, *latch, *phase);
        let Started { due, start } = times.started;
        self.ticks = self.ticks.wrapping_add(1);
        self.samples = self.samples.wrapping_add(1);
        self.dropped = self.dropped.wrapping_add(u32::from(*dropped));
        if let Some(last) = self.last_start.replace(start) {
            self.period.record(start.wrapping_sub(last));
        }
        self.convert
            .record(times.converted.wrapping_sub(times.acquired));
        self.render
            .record(times.put_out.wrapping_sub(times.converted));
        self.compensate
            .record(times.compensated.wrapping_sub(times.put_out));
        self.step
            .record(times.stepped.wrapping_sub(times.compensated));
        self.queue.record(times.queued.wrapping_sub(times.stepped));
        self.task.record(times.queued.wrapping_sub(start));
        let response = times.queued.wrapping_sub(due);
        self.response.record(response);
        let late = response > tick || sample.faults.has(Fault::Overrun);
        self.overruns = self.overruns.wrapping_add(u32::from(late));
        self.count_missed(sample.time_us as u32, period_us as u32);
    }

    /// Returns the part of the board's health that the budget knows; the other fields have their
    /// defaults.
    pub fn health(&self) -> Health {
        Health {
            samples: self.samples,
            dropped: self.dropped,
            overruns: self.overruns,
            missed: self.missed,
            period: self.period.range(),
            step: self.step.range(),
            task: self.task.range(),
            response: self.response.range(),
            armed: self.armed,
            latched: self.latch.faults(),
            ..Health::default()
        }
    }

    /// Counts the whole periods between two samples, without the one that there should be. Gaps of more than
    /// 35 minutes are counted short.
    fn count_missed(&mut self, time_us: u32, period_us: u32) {
        let last = self.last_time_us.unwrap_or(time_us);
        let elapsed = time_us.wrapping_sub(last);
        if elapsed > u32::MAX / 2 {
            return;
        }
        self.last_time_us = Some(time_us);
        let periods = (elapsed + period_us / 2)
            .checked_div(period_us)
            .unwrap_or(0);
        self.missed = self.missed.saturating_add(periods.saturating_sub(1));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::fault::Faults;

    const TICK: u32 = 168_000;

    /// Counts a task that starts at `start` and takes `cost`, with a sample of time `time_us`.
    fn run(budget: &mut Budget, start: u32, cost: u32, time_us: u64, faults: Faults) {
        let times = StageTimes {
            started: Started { due: start, start },
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
        let sampled = Sampled {
            times,
            sample,
            dropped: false,
            armed: false,
            latch: Latch::new(),
            phase: Phase::Free,
        };
        budget.count(&sampled, 1000, TICK);
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
        // A task that takes a whole tick is in time; one count more is an overrun.
        run(&mut budget, start, TICK, 11_000, Faults::NONE);
        assert_eq!(budget.overruns, 0);
        run(&mut budget, start, TICK + 1, 12_000, Faults::NONE);
        assert_eq!(budget.overruns, 1);
        // The board saw it come late, two instants are gone.
        let late = Faults::NONE.with(Fault::Overrun);
        run(&mut budget, start, 20_000, 15_000, late);
        assert_eq!((budget.overruns, budget.missed), (2, 2));
        // Time that stands still or runs back adds no missing instant.
        run(&mut budget, start, 20_000, 15_000, Faults::NONE);
        run(&mut budget, start, 20_000, 3_000, Faults::NONE);
        assert_eq!((budget.overruns, budget.missed), (2, 2));
        assert_eq!(budget.samples, 15);
    }

    /// The task starts 0.9 ms late and takes 0.2 ms: each is within a tick, together they are not.
    #[test]
    fn a_response_later_than_a_tick_is_an_overrun_though_the_task_is_short() {
        let mut budget = Budget::new();
        for late in [0, TICK * 9 / 10] {
            let times = StageTimes {
                started: Started {
                    due: 0,
                    start: late,
                },
                acquired: late,
                converted: late,
                put_out: late,
                compensated: late,
                stepped: late,
                queued: late + TICK / 5,
            };
            let sampled = Sampled {
                times,
                sample: Sample::default(),
                dropped: false,
                armed: true,
                latch: Latch::new(),
                phase: Phase::Contact,
            };
            budget.count(&sampled, 1000, TICK);
        }
        assert_eq!(budget.overruns, 1);
        let health = budget.health();
        assert_eq!(health.response.max, TICK * 9 / 10 + TICK / 5);
        assert_eq!(health.task.max, TICK / 5);
        assert!(health.armed);
        assert_eq!(budget.phase, Phase::Contact);
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
