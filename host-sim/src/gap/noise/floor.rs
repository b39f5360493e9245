//! The noise floor of the force, without a model.
//!
//! Estimates are compared. Second differences are a high-pass and see white noise only. Rests in
//! free air show the whole spectrum of what is there when nothing moves; sharp lines in it (a pump, a
//! disturbance) are not noise and are cut to the level of their neighbours, and a line that runs through
//! all free air is taken out first. Where the two differ the noise is coloured, and the estimate at rest
//! is right; its fast part is better known from the whole log. Where nothing rests, or noise behind a filter is more than
//! differences and rests can agree on, stretches of the motion ([`super::stretches`]) say how large slow noise is. What is
//! there at rest may be no noise at all, as a chirp or a burst: then the floor is that of second differences, of the quiet
//! part where they come and go.

use std::ops::Range;

use crate::gap::noise::free_air::rests;
use crate::gap::noise::high_pass::HighPass;
use crate::gap::noise::line::Line;
use crate::gap::noise::lines::{MOST_LINES, lines_in_free_air, without_lines_at_rest};
use crate::gap::noise::rest;
use crate::gap::noise::rest_power::{COLOUR_HZ, RestNoise};
use crate::gap::noise::stretches::SlowNoise;
use crate::gap::thresholds::Floor;
use crate::log::UniformLog;
use crate::model::Remainder;
use crate::signal;
use crate::stats::rounding_deviation;

/// The noise of a measured force.
#[derive(Clone, Debug, PartialEq)]
pub struct NoiseFloor {
    /// Standard deviation (N) from differences.
    pub high_pass_n: f64,
    /// Standard deviation (N) at rest in free air without the lines; `None` without such a rest.
    pub rest_n: Option<f64>,
    /// Root mean square (N) of the lines that were cut out.
    pub lines_n: f64,
    /// The standard deviation (N) that is used.
    pub used_n: f64,
    /// Whether the noise is not white.
    pub coloured: bool,
    /// Standard error of `used_n` as a share of it; 0 where it comes from all samples.
    pub uncertainty: f64,
    /// How many times `used_n` the noise may be though rests agree with second differences: more than 1 where they are
    /// too short to tell, as a minute at 10 Hz has them.
    pub unseen: f64,
    /// Samples for each independent one.
    pub correlation: f64,
    /// The share of its variance that a low-pass leaves; 1 without one.
    pub band_share: f64,
    /// Standard deviation (N) of what rounding to the steps of the readings makes; 0 where they have none.
    pub rounding_n: f64,
    /// Slower noise that stretches of the motion show where there is no rest.
    pub(crate) slow: Option<SlowNoise>,
    /// What a model left when it was identified, where `used_n` allows for that.
    pub(crate) left: Option<Remainder>,
    /// Which estimate is used, and why, in words.
    pub why: String,
}

/// What the forces are before lines are taken out of them.
#[derive(Clone, Copy)]
struct Raw<'a> {
    /// The forces (N) without all lines that are there at rest: they say whether the rest is noise.
    unlined_n: &'a [f64],
    /// The step of the converter (N); 0 where there is none.
    code_n: f64,
}

impl NoiseFloor {
    /// White noise of a standard deviation (N) that is known, and whence.
    pub(crate) fn white(noise_n: f64, why: &str) -> NoiseFloor {
        NoiseFloor {
            high_pass_n: noise_n,
            rest_n: None,
            lines_n: 0.0,
            used_n: noise_n,
            coloured: false,
            uncertainty: 0.0,
            unseen: 1.0,
            correlation: 1.0,
            band_share: 1.0,
            rounding_n: 0.0,
            slow: None,
            left: None,
            why: why.into(),
        }
    }

    /// Estimates the noise floor of a log.
    pub fn of(log: &UniformLog, decide: &Floor) -> NoiseFloor {
        let even = log;
        let log: &UniformLog = &even.as_taken();
        let rests = rests(log, decide);
        let code_n = signal::step(&log.force_n).unwrap_or(0.0);
        let raw = |unlined_n| Raw { unlined_n, code_n };
        if rests.is_empty() {
            let floor = NoiseFloor::with_disturbances(log, raw(&log.force_n), &rests, decide);
            return floor.without_fast_lines(even, log.clone(), code_n, decide);
        }
        let lines = lines_in_free_air(log, decide);
        let unlined_n = without_lines_at_rest(&log.force_n, &lines, &rests);
        let mut floor = NoiseFloor::with_disturbances(log, raw(&unlined_n), &rests, decide);
        let mut quiet = log.clone();
        for line in &lines {
            let mut quieter = quiet.clone();
            line.take_out_of(&mut quieter.force_n);
            let without_line =
                NoiseFloor::with_disturbances(&quieter, raw(&unlined_n), &rests, decide);
            // A line that repeats with the motion is not there at rest.
            if without_line.rest_power_n2() < decide.disturbed * floor.rest_power_n2() {
                (floor, quiet) = (without_line, quieter);
            }
        }
        floor
    }

    /// The same behind a low-pass that leaves a share of the variance of white noise: noise that is slow already keeps
    /// more. `filtered` is the log behind it.
    pub(crate) fn in_band(
        self,
        (log, filtered): (&UniformLog, &UniformLog),
        white_share: f64,
        decide: &Floor,
    ) -> NoiseFloor {
        let is_noise_at_rest = |rest_n: f64| rest_n <= decide.coloured * self.used_n;
        let taken_n2 = match (self.rest_n, self.slow) {
            (Some(rest_n), _) if is_noise_at_rest(rest_n) => {
                let rests = rests(log, decide);
                let seen = |log, noise_n| {
                    RestNoise::of(log, &rests, noise_n, decide).map(|rest| rest.seen_n2)
                };
                let least_n = white_share.sqrt() * self.high_pass_n;
                let both = seen(log, self.high_pass_n).zip(seen(filtered, least_n));
                both.map(|(log, filtered)| log - filtered)
            }
            (None, Some(slow)) if self.coloured => slow.taken_n2(log, filtered),
            _ => None,
        };
        let share = |taken_n2: f64| 1.0 - taken_n2 / self.used_n.powi(2).max(f64::MIN_POSITIVE);
        NoiseFloor {
            band_share: taken_n2.map_or(white_share, |taken_n2| {
                share(taken_n2).clamp(white_share.min(1.0), 1.0)
            }),
            ..self
        }
    }

    /// The same with the slow noise of stretches, if there is one.
    pub(crate) fn with_slow_noise(&self) -> NoiseFloor {
        let Some(slow) = self.slow else {
            return self.clone();
        };
        NoiseFloor {
            used_n: slow.noise_n,
            coloured: true,
            correlation: slow.correlation,
            uncertainty: slow.error,
            why: "from stretches of the motion: there is no rest in free air, and the noise is coloured".into(),
            ..self.clone()
        }
    }

    /// Standard deviation (N) of the noise of the force that is fitted.
    pub(crate) fn noise_n(&self) -> f64 {
        self.used_n * self.band_share.sqrt()
    }

    /// Whether the noise is smaller than half a step of the readings: what rounding leaves then follows the force, and is
    /// no noise. Derived: half a step, and the rounding of a whole one, are twice that rounding.
    pub(crate) fn is_mostly_rounding(&self) -> bool {
        self.used_n < 2.0 * self.rounding_n
    }

    /// The same without a low-pass.
    pub(crate) fn raw(&self) -> NoiseFloor {
        NoiseFloor {
            band_share: 1.0,
            ..self.clone()
        }
    }

    /// Without rests: the floor without the lines that stand out of the second differences. What is so fast and
    /// stays in phase throughout is no noise: a sine of 27 Hz in a pendulum's record at 190 Hz made the floor four
    /// times what it was, and the record agreed with any model. Lines are found on the even log and taken out of
    /// the samples as they were taken.
    fn without_fast_lines(
        mut self,
        even: &UniformLog,
        mut taken: UniformLog,
        code_n: f64,
        decide: &Floor,
    ) -> NoiseFloor {
        let is_measured: Vec<bool> = (0..even.len())
            .map(|at| {
                let near = at.saturating_sub(1)..(at + 2).min(even.len());
                near.len() == 3 && !even.in_gap[near].contains(&true)
            })
            .collect();
        let mut searched = even.force_n.clone();
        for _ in 0..MOST_LINES {
            let mut differences = vec![0.0; searched.len()];
            let places = differences.iter_mut().skip(1);
            let inner = searched.windows(3).map(|w| w[2] - 2.0 * w[1] + w[0]);
            places.zip(inner).for_each(|(place, own)| *place = own);
            let Some(line) = Line::strongest(&differences, &is_measured, decide.prominence) else {
                break;
            };
            let line = line.undifferenced();
            line.take_out_of(&mut searched);
            match even.taken {
                None => line.take_out_of(&mut taken.force_n),
                Some(_) => {
                    let start_s = even.time_s.first().copied().unwrap_or(0.0);
                    let place = |time_s: &f64| (time_s - start_s) * even.rate_hz;
                    let each = taken.force_n.iter_mut().zip(&taken.time_s);
                    each.for_each(|(force, time_s)| *force -= line.at(place(time_s)));
                }
            }
            let raw = Raw {
                unlined_n: &taken.force_n,
                code_n,
            };
            let quieter = NoiseFloor::with_disturbances(&taken, raw, &[], decide);
            if quieter.high_pass_n.powi(2) >= decide.disturbed * self.high_pass_n.powi(2) {
                break;
            }
            self = NoiseFloor {
                lines_n: self.lines_n.hypot(line.rms_n()),
                ..quieter
            };
        }
        self
    }

    /// Estimates the noise floor without looking for disturbances.
    fn with_disturbances(
        log: &UniformLog,
        raw: Raw<'_>,
        rests: &[Range<usize>],
        decide: &Floor,
    ) -> NoiseFloor {
        let mut high_pass = HighPass::second(log, raw.code_n, decide.spike_sigmas);
        let mut rest = RestNoise::of(log, rests, high_pass.noise_n, decide);
        let is_quieter = |rest: &RestNoise| rest.power_n2() < high_pass.noise_n.powi(2);
        if rest.as_ref().is_some_and(is_quieter) {
            high_pass = high_pass.beside_motion(log, decide);
        }
        if high_pass.is_fourth {
            rest = RestNoise::of(log, rests, high_pass.noise_n, decide);
        }
        let high_pass_n = high_pass.noise_n;
        let rest_n = rest.as_ref().map(RestNoise::noise_n);
        let (used_n, why) = used(log, raw, rests, (high_pass, rest_n), decide);
        // A force at rest stays on one step of a coarse converter: steps of 0.5 N had a floor of 44 mN, and nothing
        // explained the 0.14 N that they leave of any motion.
        let rounding_n = rounding_deviation(raw.code_n);
        let (used_n, why) = match used_n < rounding_n {
            true => (
                rounding_n,
                "from the steps of the readings, which its noise does not reach",
            ),
            false => (used_n, why),
        };
        let coloured = used_n > decide.coloured * high_pass_n;
        let (at_rest, agreeing) = match &rest {
            Some(rest) if coloured => (Some(rest), None),
            Some(rest) if rest.noise_n() <= decide.coloured * used_n => (None, Some(rest)),
            _ => (None, None),
        };
        NoiseFloor {
            coloured,
            correlation: if coloured {
                rest::correlation_at(log, rests)
            } else {
                1.0
            },
            uncertainty: at_rest.map_or(0.0, RestNoise::error),
            unseen: agreeing.map_or(1.0, |rest| {
                let most_n = rest.noise_n() * (1.0 + decide.sigmas * rest.error());
                (most_n / (decide.coloured * used_n).max(f64::MIN_POSITIVE)).max(1.0)
            }),
            high_pass_n,
            rest_n,
            band_share: 1.0,
            rounding_n,
            slow: match rest {
                Some(_) => None,
                None => SlowNoise::beside(high_pass_n, log, decide).filter(|slow| slow.is_all),
            },
            left: None,
            lines_n: rest.map_or(0.0, |rest| rest.lines_n2.sqrt()),
            used_n,
            why: why.into(),
        }
    }

    /// Power at rest (N²) with the lines.
    fn rest_power_n2(&self) -> f64 {
        self.rest_n.unwrap_or(0.0).powi(2) + self.lines_n.powi(2)
    }
}

/// The standard deviation (N) that is used, of those from second differences and at rest, and why.
fn used(
    log: &UniformLog,
    raw: Raw<'_>,
    rests: &[Range<usize>],
    (high_pass, rest_n): (HighPass, Option<f64>),
    decide: &Floor,
) -> (f64, &'static str) {
    let high_pass_n = high_pass.noise_n;
    let quiet_n = rest::quiet_n(log, rests, (high_pass_n, raw.code_n), decide);
    match (quiet_n, rest_n) {
        (Some(quiet_n), _) => (
            quiet_n,
            "from the quiet part of the rest in free air: what is there comes and goes, and is no noise",
        ),
        (None, None) => (
            high_pass_n,
            "from second differences: there is no rest in free air",
        ),
        // Both see the same noise; differences take it from all samples.
        (None, Some(rest)) if rest <= decide.coloured * high_pass_n => (
            high_pass_n,
            match high_pass.is_fourth {
                true => {
                    "from fourth differences, and rest in free air agrees: second differences see the motion"
                }
                false => "from second differences, and rest in free air agrees",
            },
        ),
        (None, Some(rest_n))
            if is_noise_at_rest(log, raw, rests, (high_pass_n, rest_n), decide) =>
        {
            (rest_n, "from rest in free air: the noise is coloured")
        }
        (None, Some(_)) => (
            high_pass_n,
            "from second differences: what is there at rest in free air is larger, and no noise",
        ),
    }
}

/// Whether what is there at rest is noise, though more than second differences see.
fn is_noise_at_rest(
    log: &UniformLog,
    raw: Raw<'_>,
    rests: &[Range<usize>],
    (high_pass_n, rest_n): (f64, f64),
    decide: &Floor,
) -> bool {
    let slower_n = match (log.rate_hz / COLOUR_HZ) as usize {
        0 | 1 => high_pass_n,
        step => {
            let slower = forces_at_every(log, step);
            HighPass::second(&slower, raw.code_n, decide.spike_sigmas).noise_n
        }
    };
    let kurtosis = rest::kurtosis(raw.unlined_n, rests, decide);
    // Behind a filter noise is many times what differences say, and stretches of the motion have it as well.
    let in_stretches = || SlowNoise::beside(high_pass_n, log, decide);
    rest::is_noise(rest_n / slower_n, kurtosis, decide)
        || kurtosis.off.abs() <= 1.0
            && in_stretches().is_some_and(|slow| rest_n <= decide.slight_colour * slow.noise_n)
}

/// The forces of a log at every so many samples.
fn forces_at_every(log: &UniformLog, step: usize) -> UniformLog {
    UniformLog {
        force_n: log.force_n.iter().step_by(step).copied().collect(),
        in_gap: log.in_gap.iter().step_by(step).copied().collect(),
        ..UniformLog::default()
    }
}

#[cfg(test)]
mod tests;
