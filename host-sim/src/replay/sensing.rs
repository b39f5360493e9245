//! The faults that the samples of a log show, found by the board's own code, and the readings that the
//! estimator sees in their place.
//!
//! A board sees a spike when the next sample has come, and a converter that hangs after a while; a log
//! has them all at once, so here a fault stands where it begins. A reading that is missing or off by itself
//! is bridged by the straight line between its neighbours: the filter goes on over it, and the instant is not
//! learned from. After a longer gap, and after every other fault, nothing is learned until the filter has
//! forgotten it, as on the board.

use std::borrow::Cow;
use std::collections::HashMap;
use std::ops::Range;

use estimator_core::board::sensing::{Codes, Conversion, LATE, Watch};
use estimator_core::{Fault, Faults};

use super::limits::LogSensors;
use super::width::SAMPLES;
use crate::log::UniformLog;
use crate::stats::extent;

/// Longest gap that is bridged (samples): a quarter of the filter's window of 17.
const BRIDGED: usize = 4;

/// What a replay makes of the readings of a log. What is not touched is the log's own: most logs have no fault.
#[derive(Clone, Debug)]
pub(super) struct Readings<'a> {
    /// Position (m) as the estimator sees it.
    pub(super) position_m: Cow<'a, [f64]>,
    /// Force (N) as the estimator sees it.
    pub(super) force_n: Cow<'a, [f64]>,
    /// The faults of each sample that the estimator is told.
    pub(super) faults: Marked,
    /// The faults that were bridged, and that only the reader is told.
    pub(super) bridged_faults: Marked,
    /// The samples that were invented, here or by the resampling.
    pub(super) invented: Invented<'a>,
}

/// The faults of those samples that have any.
#[derive(Clone, Debug, Default)]
pub(super) struct Marked(HashMap<usize, Faults>);

impl Marked {
    /// The faults of a sample.
    pub(super) fn at(&self, sample: usize) -> Faults {
        // Most logs have none, and every sample is asked for.
        match self.0.is_empty() {
            true => Faults::NONE,
            false => self.0.get(&sample).copied().unwrap_or(Faults::NONE),
        }
    }

    fn add(&mut self, sample: usize, fault: Fault) {
        let faults = self.0.entry(sample).or_insert(Faults::NONE);
        *faults = faults.with(fault);
    }
}

/// The samples that were invented.
#[derive(Clone, Debug)]
pub(super) struct Invented<'a>(Cow<'a, [bool]>);

impl Invented<'_> {
    /// Whether a sample is one of them.
    pub(super) fn contains(&self, sample: usize) -> bool {
        self.0[sample]
    }
}

impl<'a> Readings<'a> {
    /// Looks for the faults of a log.
    pub(super) fn of(log: &'a UniformLog) -> Readings<'a> {
        let mut readings = Readings {
            position_m: Cow::Borrowed(&log.position_m),
            force_n: Cow::Borrowed(&log.force_n),
            faults: Marked::default(),
            bridged_faults: Marked::default(),
            invented: Invented(Cow::Borrowed(&log.in_gap)),
        };
        if !log.recognised.is_empty() {
            readings.take_recognised(log);
            return readings;
        }
        // What was taken off a log leaves edges where friction turns: they are no readings of a sensor.
        let seen = log.compensated.noise_n.is_none().then(|| watched(log));
        for (at, faults) in seen.into_iter().flatten().enumerate() {
            if faults == Faults::NONE {
                continue;
            }
            // Where the resampling invented samples lie straight lines, whose corners are no fault.
            let mut window = at.saturating_sub(2 * LATE)..at + 1;
            if !window.any(|at| log.in_gap[at] || log.is_slower(at)) {
                faults
                    .iter()
                    .for_each(|fault| readings.take(log, at, fault));
            }
        }
        for (at, saturated) in log.compensated.saturated.iter().enumerate() {
            if *saturated {
                readings.mark(at..at + 1, Fault::ForceSaturated);
            }
        }
        readings.take_gaps(log);
        readings.take_turns(log);
        readings
    }

    /// Takes the faults of means: those that were bridged have left a mean of the other samples.
    fn take_recognised(&mut self, log: &UniformLog) {
        for (at, faults) in log.recognised.iter().enumerate() {
            for fault in faults.iter() {
                let bridged = match fault {
                    Fault::ForceUnusable => true,
                    Fault::SampleMissed => !log.in_gap[at],
                    _ => false,
                };
                match bridged {
                    true => self.bridged_faults.add(at, fault),
                    false => self.faults.add(at, fault),
                }
            }
        }
    }

    /// Takes one fault that showed at a sample to where it began.
    fn take(&mut self, log: &UniformLog, at: usize, fault: Fault) {
        match fault {
            // A converter that goes on again leaps like a spike.
            Fault::ForceUnusable if self.faults.at(at - LATE - 1).has(Fault::ForceStuck) => {}
            Fault::ForceUnusable => {
                self.force_n.to_mut()[at - LATE] = between(&log.force_n, at - LATE);
                self.bridge(at - LATE, fault);
            }
            Fault::PositionJump if is_back(&log.position_m[at - 4..=at]) => {
                self.position_m.to_mut()[at - LATE] = between(&log.position_m, at - LATE);
                self.bridge(at - LATE, fault);
            }
            Fault::PositionJump => self.mark(at - LATE..at - LATE + 1, fault),
            Fault::PositionStuck => self.mark_since(&log.position_m, at - LATE - 1, fault),
            // One that hung shows by the leap with which it goes on.
            Fault::ForceStuck => {
                let goes_on = at > 0 && log.force_n[at] != log.force_n[at - 1];
                self.mark_since(&log.force_n, at - usize::from(goes_on), fault);
            }
            _ => self.mark(at..at + 1, fault),
        }
    }

    fn mark(&mut self, samples: Range<usize>, fault: Fault) {
        samples.for_each(|sample| self.faults.add(sample, fault));
    }

    /// Marks the samples up to one that read the same as it does, back to those that are marked already: the board
    /// says it at each of them, and a channel may hang for an hour.
    fn mark_since(&mut self, channel: &[f64], at: usize, fault: Fault) {
        let run = (0..=at)
            .rev()
            .take_while(|sample| channel[*sample] == channel[at]);
        for sample in run {
            if self.faults.at(sample).has(fault) {
                break;
            }
            self.faults.add(sample, fault);
        }
    }

    fn bridge(&mut self, at: usize, fault: Fault) {
        self.invented.0.to_mut()[at] = true;
        self.bridged_faults.add(at, fault);
    }

    /// Nothing is missing where a friction turns. A line over it cuts the corner of a force that stops, and the filter sees
    /// that from half of its window.
    fn take_turns(&mut self, log: &UniformLog) {
        for (at, turns) in log.compensated.turning.iter().enumerate() {
            if *turns {
                let window = at.saturating_sub(SAMPLES)..(at + SAMPLES + 1).min(log.len());
                self.invented.0.to_mut()[window].fill(true);
            }
        }
    }

    /// Samples that the resampling invented are missing, unless the log was sampled more slowly there.
    fn take_gaps(&mut self, log: &UniformLog) {
        let way_m = match log.slower.is_empty() {
            true => 0.0,
            false => f64::from(LogSensors::of(log).limits.stuck_way_m),
        };
        let mut at = 0;
        for run in log.in_gap.chunk_by(|a, b| a == b) {
            let here = at..at + run.len();
            at = here.end;
            if !run[0] {
                continue;
            }
            if log.is_slower(here.start) {
                // Nothing is missing between the samples of a slower rate. The line through those of a hold is
                // what is known of it, and all that the estimator can see of its relaxation. Where the probe
                // moves, the line is no motion: neither it nor its corners are learned from.
                let ends = here.start.saturating_sub(1)..(here.end + 1).min(log.len());
                let (low, high) = extent(&log.position_m[ends.clone()]);
                let invented = self.invented.0.to_mut();
                match high - low > way_m {
                    true => invented[ends].fill(true),
                    false => invented[here].fill(false),
                }
                continue;
            }
            match run.len() <= BRIDGED {
                true => here.for_each(|at| self.bridge(at, Fault::SampleMissed)),
                false => self.mark(here, Fault::SampleMissed),
            }
        }
    }
}

/// What the board's code says to each sample.
fn watched(log: &UniformLog) -> impl Iterator<Item = Faults> + '_ {
    let sensors = LogSensors::of(log);
    let (n_per_code, m_per_code) = (sensors.n_per_code, sensors.m_per_code);
    let conversion = Conversion::new(n_per_code as f32, 0.0, m_per_code as f32, sensors.limits);
    let mut watch = Watch::default();
    let period_us = 1e6 / log.rate_hz;
    let start_m = log.position_m.first().copied().unwrap_or_default();
    let pairs = log.position_m.iter().zip(&log.force_n).zip(1u64..);
    pairs.map(move |((position_m, force_n), count)| {
        let force = (force_n / n_per_code).round() as i32;
        let codes = Codes {
            time_us: (count as f64 * period_us).round() as u64,
            force,
            force_low: force,
            force_high: force,
            position: ((position_m - start_m) / m_per_code).round() as i32,
            faults: Faults::NONE,
        };
        conversion.sample(&mut watch, &codes).faults
    })
}

/// The mean of the neighbours of a sample.
pub(crate) fn between(channel: &[f64], at: usize) -> f64 {
    0.5 * (channel[at - 1] + channel[at + 1])
}

/// Whether the fourth of five readings is nearer to the way of the first two than the third.
fn is_back(readings: &[f64]) -> bool {
    let way = readings[1] - readings[0];
    let off = |at: usize| (readings[at] - readings[1] - (at - 1) as f64 * way).abs();
    off(3) < 0.5 * off(2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::Log;

    #[test]
    fn a_channel_that_hangs_for_minutes_is_marked_once_from_where_it_began() {
        // GIVEN strokes of 1 mm into 2 N/mm, and 7 min in which the force reads the same all the time; going over all
        // that is marked at each of them took 10¹⁰ steps for 100 s
        const MOVES: usize = 4000;
        let time: Vec<f64> = (0..400_000).map(|at| f64::from(at) * 1e-3).collect();
        let x = |t: f64| 1e-3 * (6.0 * t).sin();
        let position: Vec<f64> = time.iter().map(|t| (1e6 * x(*t)).round() * 1e-6).collect();
        let noise_n = |at: usize| (at * at % 97) as f64 * 1e-3;
        let each = position.iter().enumerate();
        let mut force: Vec<f64> = each
            .map(|(at, x)| (2000.0 * x.max(0.0) / 1e-3).round() * 1e-3 + noise_n(at))
            .collect();
        force[MOVES..].fill(3.2105);
        let log = Log::from_channels(time, position, force).uniform().unwrap();
        let readings = Readings::of(&log);
        // THEN it is stuck from its first sample on, and was not before.
        let is_stuck = |at: &usize| readings.faults.at(*at).has(Fault::ForceStuck);
        let stuck: Vec<usize> = (0..log.len()).filter(is_stuck).collect();
        assert!(
            stuck.iter().copied().eq(MOVES..log.len()),
            "{:?}",
            stuck.first()
        );
    }

    #[test]
    fn a_converter_that_hung_for_five_readings_of_a_press_is_marked_there() {
        // GIVEN presses at 60 N/s with 20 mN of noise in counts of 5 mN, in the second of which the force hangs
        const HUNG: Range<usize> = 1420..1426;
        let time: Vec<f64> = (0..6000).map(|at| f64::from(at) * 1e-3).collect();
        let way = |t: f64| (0.5 - (t % 1.0 - 0.5).abs() - 0.2).max(-0.05);
        let position: Vec<f64> = time
            .iter()
            .map(|t| (2e4 * way(*t)).round() * 1e-6)
            .collect();
        let noise = |at: usize| ((at * 7919 % 101) as f64 - 50.0) * 0.15;
        let each = time.iter().enumerate();
        let mut force: Vec<f64> = each
            .map(|(at, t)| (1.2e4 * way(*t).max(0.0) + noise(at)).round() * 5e-3)
            .collect();
        let held = force[HUNG.start];
        force[HUNG].fill(held);
        let log = Log::from_channels(time, position, force).uniform().unwrap();
        let readings = Readings::of(&log);
        // THEN it is stuck there, and nowhere else.
        let is_stuck = |at: &usize| readings.faults.at(*at).has(Fault::ForceStuck);
        let stuck: Vec<usize> = (0..log.len()).filter(is_stuck).collect();
        assert!(stuck.iter().copied().eq(HUNG), "{stuck:?}");
    }
}
