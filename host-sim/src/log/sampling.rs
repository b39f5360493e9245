//! Facts about how a log was sampled, in one place for every verb: rate, jitter, drops, resolution of
//! the stamps, segments, and encoders that toggle.
//!
//! Stamps that scatter about an even clock have two causes that ask for opposite cures. Either the
//! instants of sampling scatter, and the stamps tell the truth: then the log is interpolated at the
//! stamps. Or the sampling was even, and only the stamps scatter (a host that stamps what a board has
//! sampled): then the stamps are replaced by the line through them. Force and position tell which
//! ([`evidence`]).

mod evidence;
mod numbering;
mod resolution;

use super::record::Log;
use super::timing::{Gap, Timing, snapped};
use crate::signal;
use crate::stats::rms;

pub(super) use numbering::Line;
pub(super) use resolution::of as step_of_stamps;

/// Stamps that deviate from the line by less than this share of a period are even.
pub(super) const EVEN_PERIODS: f64 = 0.01;
/// A run of at least so many long intervals is a slower rate, and not so many drops in a row: with
/// 30 % of the samples dropped at random, ten gaps in a row occur once in 10⁵ samples.
const SLOWER_RUN: usize = 10;
/// A gap of at least so many seconds and periods separates two segments.
const SEGMENT_S: f64 = 1.0;
const SEGMENT_PERIODS: f64 = 20.0;

/// What the stamps of a log are worth.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Stamps {
    /// Even within 1 % of a period, but for missing samples.
    #[default]
    Even,
    /// The stamps scatter and the sampling was even: force and position do not follow the stamps.
    Jittered,
    /// The sampling itself is uneven: force and position follow the stamps, or the stamps lie on no
    /// line.
    Uneven,
}

impl Stamps {
    /// Its name in files.
    pub const fn name(self) -> &'static str {
        match self {
            Stamps::Even => "even",
            Stamps::Jittered => "stamps_jitter",
            Stamps::Uneven => "sampling_uneven",
        }
    }
}

/// Samples that are missing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drops {
    /// The places.
    pub gaps: Vec<Gap>,
    /// Number of missing samples.
    pub missing: usize,
    /// Of all samples that should be there, the share that is missing.
    pub share: f64,
    /// Longest interval without a sample (s); 0 without a drop.
    pub longest_s: f64,
}

/// How a log was sampled.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sampling {
    /// Samples per second (Hz), a round number if the log's is within 0.1 % of one.
    pub rate_hz: f64,
    /// Slope of the stamps over the numbers of the samples, as a rate (Hz): what the clock of the
    /// stamps makes of the rate.
    pub clock_rate_hz: f64,
    /// What the stamps are worth.
    pub stamps: Stamps,
    /// Standard deviation of the stamps about the line (s).
    pub jitter_s: f64,
    /// Step of the stamps (s), if they have one.
    pub resolution_s: Option<f64>,
    /// Missing samples.
    pub drops: Drops,
    /// From when to when (s) the log was sampled more slowly on purpose, such as in a thinned hold.
    pub slower: Vec<(f64, f64)>,
    /// Parts that long gaps separate, from and to (s); one for a log in one piece.
    pub segments: Vec<(f64, f64)>,
    /// Resolution of the position (m), if it is quantised.
    pub position_step_m: Option<f64>,
    /// Resolution of the force (N), if it is quantised.
    pub force_step_n: Option<f64>,
    /// How often the position goes one count there and back again; 0 for an encoder that does not toggle.
    pub toggles: usize,
}

impl Sampling {
    /// Whether the stamps scatter by no more than their rounding to a step, which has an rms of step/√12.
    pub fn is_rounding(&self) -> bool {
        is_rounding(self.jitter_s, self.resolution_s)
    }
}

/// The same of a scatter (s) and a step (s).
pub(super) fn is_rounding(jitter_s: f64, resolution_s: Option<f64>) -> bool {
    resolution_s.is_some_and(|step_s| jitter_s < 0.35 * step_s)
}

impl Log {
    /// How the log was sampled; nothing is known of fewer than two samples.
    pub fn sampling(&self) -> Sampling {
        let timing = self.timing();
        let line = Line::through(&self.time_s, &timing);
        let stamps = self.stamps(line.as_ref());
        let facts = self.facts(&timing, line.as_ref());
        Sampling {
            stamps,
            // Jitter cuts the intervals off that the mean period is made of; the line sees all of them.
            rate_hz: match stamps {
                Stamps::Jittered => snapped(facts.clock_rate_hz),
                _ => facts.rate_hz,
            },
            ..facts
        }
    }

    /// What the stamps are worth, and the line where they should be replaced by it.
    pub(super) fn stamps(&self, line: Option<&Line>) -> Stamps {
        match line {
            None => Stamps::Uneven,
            Some(line) if line.worst_s() < EVEN_PERIODS * line.period_s => Stamps::Even,
            Some(line) if line.has_other_instants(&self.time_s) => Stamps::Uneven,
            Some(line) if evidence::follow_the_line(self, line) => Stamps::Jittered,
            Some(_) => Stamps::Uneven,
        }
    }

    fn facts(&self, timing: &Timing, line: Option<&Line>) -> Sampling {
        let rate_hz = timing.rate_hz();
        let long = line.map_or(timing.gaps.clone(), |line| line.gaps(&self.time_s));
        let (slower, gaps) = slower(&long);
        Sampling {
            rate_hz,
            clock_rate_hz: line.map_or(rate_hz, |line| 1.0 / line.period_s),
            stamps: Stamps::Even,
            jitter_s: line.map_or(timing.jitter_s, |line| rms(line.residuals(&self.time_s))),
            resolution_s: resolution::of(&self.time_s),
            drops: drops(gaps, self.len(), line, timing.base_period_s),
            slower,
            segments: segments(&self.time_s, timing),
            position_step_m: signal::step(&self.position_m),
            force_step_n: signal::step(&self.force_n),
            toggles: signal::toggling(&self.position_m).map_or(0, |(_, toggles)| toggles),
        }
    }
}

/// Long intervals: stretches that were sampled more slowly, and gaps in which samples are missing.
pub(super) fn slower(long: &[Gap]) -> (Vec<(f64, f64)>, Vec<Gap>) {
    let (mut slower, mut gaps) = (Vec::new(), Vec::new());
    for run in long.chunk_by(|a, b| a.index + 1 == b.index) {
        if run.len() >= SLOWER_RUN {
            slower.push((run[0].from_s, run[run.len() - 1].to_s));
        } else {
            gaps.extend_from_slice(run);
        }
    }
    (slower, gaps)
}

fn drops(gaps: Vec<Gap>, measured: usize, line: Option<&Line>, period_s: f64) -> Drops {
    // An interval of 1.5 periods without a line lacks one sample.
    let by_interval =
        |gap: &Gap| (((gap.to_s - gap.from_s) / period_s).round() as usize).max(2) - 1;
    let missing_in =
        |gap: &Gap| line.map_or(by_interval(gap), |line| line.missing_after(gap.index));
    let missing: usize = gaps.iter().map(missing_in).sum();
    let longest_s = gaps.iter().map(|gap| gap.to_s - gap.from_s);
    Drops {
        missing,
        share: missing as f64 / (missing + measured).max(1) as f64,
        longest_s: longest_s.fold(0.0, f64::max),
        gaps,
    }
}

/// Whether an interval (s) separates two segments.
pub(super) fn is_pause(interval_s: f64, timing: &Timing) -> bool {
    interval_s > SEGMENT_S.max(SEGMENT_PERIODS * timing.base_period_s)
}

fn segments(time_s: &[f64], timing: &Timing) -> Vec<(f64, f64)> {
    let near = |a: &f64, b: &f64| !is_pause(b - a, timing);
    // A slower rate is no pause: three samples make a piece.
    let pieces: Vec<&[f64]> = time_s.chunk_by(near).collect();
    match pieces.iter().all(|piece| piece.len() > 2) {
        true => pieces
            .iter()
            .map(|piece| (piece[0], piece[piece.len() - 1]))
            .collect(),
        false => time_s
            .first()
            .zip(time_s.last())
            .map(|(first, last)| (*first, *last))
            .into_iter()
            .collect(),
    }
}

#[cfg(test)]
mod tests;
