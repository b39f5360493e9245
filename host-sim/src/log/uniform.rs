//! A log with even spacing in time, as everything behind the reading takes it.

use std::borrow::Cow;
use std::ops::Range;
use std::path::PathBuf;

use estimator_core::{Faults, Sample};

use super::origin::SourceColumns;
use crate::kind::Kind;
use crate::signal;

/// What was taken off a log, see [`crate::compensate`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Compensated {
    /// Ids of the effects.
    pub effects: Vec<String>,
    /// Noise of the force (N) before a window made it smoother than it is.
    pub noise_n: Option<f64>,
    /// Samples that the load cell's limit has touched; empty if none can.
    pub saturated: Vec<bool>,
    /// Samples at which a friction turns to a side that is not known; empty if none does.
    pub turning: Vec<bool>,
    /// Instants (s) from each of which on the zero is off by a force that is known to its errors only.
    pub stepped_s: Vec<f64>,
    /// Instants (s) from each of which on the surface is farther by so much (m), in the order of time.
    pub surface_steps: Vec<(f64, f64)>,
}

/// The samples of an uneven log as they were taken, which interpolation has made smoother than they are.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Taken {
    /// Time stamps (s).
    pub time_s: Vec<f64>,
    /// Position (m).
    pub position_m: Vec<f64>,
    /// Force (N).
    pub force_n: Vec<f64>,
}

impl Taken {
    /// The samples after an instant (s), up to another.
    fn between(&self, after_s: f64, until_s: f64) -> Taken {
        let upto = |time_s: f64| self.time_s.partition_point(|stamp| *stamp <= time_s);
        let part = |channel: &[f64]| channel[upto(after_s)..upto(until_s)].to_vec();
        Taken {
            time_s: part(&self.time_s),
            position_m: part(&self.position_m),
            force_n: part(&self.force_n),
        }
    }
}

/// A log with even spacing in time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct UniformLog {
    /// Where it came from; empty for a log that is in memory only.
    pub path: PathBuf,
    /// Whether the machine turns, where the log says so.
    pub kind: Option<Kind>,
    /// Samples per second (Hz).
    pub rate_hz: f64,
    /// Time (s): the log's own stamps if nothing was interpolated.
    pub time_s: Vec<f64>,
    /// Position (m).
    pub position_m: Vec<f64>,
    /// Force (N).
    pub force_n: Vec<f64>,
    /// Whether the sample was invented between samples more than 1.5 median periods apart.
    pub in_gap: Vec<bool>,
    /// From when to when (s) the log was sampled more slowly on purpose, and nothing is missing.
    pub slower: Vec<(f64, f64)>,
    /// The count of the position (m), where its samples were interpolated or averaged; else they show it.
    pub position_step_m: Option<f64>,
    /// Whether the channels are the log's own, bit for bit.
    pub untouched: bool,
    /// What was interpolated, where the sampling itself was uneven.
    pub taken: Option<Taken>,
    /// The faults of each sample, where they were recognised before its samples were averaged; else empty.
    pub recognised: Vec<Faults>,
    /// The corner (Hz) of a low-pass that the force went through before it was logged, where its noise shows one.
    pub low_pass_hz: Option<f64>,
    /// What was taken off its channels.
    pub compensated: Compensated,
    /// The columns that it was read from; `None` for those of our own logs.
    pub source: Option<SourceColumns>,
    /// The log's notes, and what was done to its samples.
    pub notes: Vec<String>,
}

impl UniformLog {
    /// Whether a sample lies in a stretch that was sampled more slowly, where nothing is missing.
    pub(crate) fn is_slower(&self, at: usize) -> bool {
        let time_s = self.time_s[at];
        let mut stretches = self.slower.iter();
        stretches.any(|(from_s, to_s)| (*from_s..=*to_s).contains(&time_s))
    }

    /// The columns that it was read from, or those of a log of our own.
    pub(crate) fn columns(&self) -> Cow<'_, SourceColumns> {
        match &self.source {
            Some(source) => Cow::Borrowed(source),
            None => Cow::Owned(SourceColumns::own(self.kind.unwrap_or_default())),
        }
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.time_s.len()
    }

    /// Whether there is no sample at all.
    pub fn is_empty(&self) -> bool {
        self.time_s.is_empty()
    }

    /// Standard deviation of the force noise (N), from the samples that were not invented.
    pub fn force_noise_n(&self) -> f64 {
        if let Some(noise_n) = self.compensated.noise_n {
            return noise_n;
        }
        match &self.taken {
            Some(taken) => signal::noise(&taken.force_n),
            None => signal::noise_of_measured(&self.force_n, &self.in_gap),
        }
    }

    /// The log with the samples as they were taken, at their own stamps.
    pub(crate) fn as_taken(&self) -> Cow<'_, UniformLog> {
        let Some(taken) = &self.taken else {
            return Cow::Borrowed(self);
        };
        Cow::Owned(UniformLog {
            rate_hz: self.rate_hz,
            kind: self.kind,
            in_gap: vec![false; taken.time_s.len()],
            time_s: taken.time_s.clone(),
            position_m: taken.position_m.clone(),
            force_n: taken.force_n.clone(),
            source: self.source.clone(),
            ..UniformLog::default()
        })
    }

    /// The first so many samples as a log of their own.
    pub(crate) fn first(&self, count: usize) -> UniformLog {
        self.part(0..count)
    }

    /// A part of the samples as a log of its own.
    pub(crate) fn part(&self, samples: Range<usize>) -> UniformLog {
        let within = |count: usize| samples.start.min(count)..samples.end.min(count);
        let channel = |channel: &[f64]| channel[within(channel.len())].to_vec();
        let marks = |all: &[bool]| all[within(all.len())].to_vec();
        let before = samples
            .start
            .checked_sub(1)
            .and_then(|at| self.time_s.get(at));
        let after_s = before.copied().unwrap_or(f64::NEG_INFINITY);
        let time_s = channel(&self.time_s);
        let until_s = time_s.last().map_or(0.0, |last| last.max(after_s));
        let taken = self.taken.as_ref();
        let taken = taken.map(|taken| taken.between(after_s, until_s));
        UniformLog {
            path: self.path.clone(),
            rate_hz: self.rate_hz,
            kind: self.kind,
            time_s,
            position_m: channel(&self.position_m),
            force_n: channel(&self.force_n),
            in_gap: marks(&self.in_gap),
            slower: self.slower.clone(),
            position_step_m: self.position_step_m,
            untouched: self.untouched,
            taken,
            recognised: self.recognised[within(self.recognised.len())].to_vec(),
            compensated: Compensated {
                saturated: marks(&self.compensated.saturated),
                turning: marks(&self.compensated.turning),
                ..self.compensated.clone()
            },
            low_pass_hz: self.low_pass_hz,
            source: self.source.clone(),
            notes: self.notes.clone(),
        }
    }

    pub(super) fn push(&mut self, time_s: f64, position_m: f64, force_n: f64, in_gap: bool) {
        self.time_s.push(time_s);
        self.position_m.push(position_m);
        self.force_n.push(force_n);
        self.in_gap.push(in_gap);
    }

    /// A sample as a board would have taken it, the first one at time 0.
    pub(crate) fn sample(&self, at: usize) -> Sample<f64> {
        Sample {
            time_us: (at as f64 * self.period_s() * 1e6).round() as u64,
            position_m: self.position_m[at],
            force_n: self.force_n[at],
            faults: Faults::NONE,
        }
    }

    /// Whether the force of a sample was measured: it was not invented, and what was taken off is known.
    pub fn has_force(&self, at: usize) -> bool {
        !self.in_gap[at] && self.compensated.turning.get(at) != Some(&true)
    }

    /// Time between samples (s).
    pub fn period_s(&self) -> f64 {
        1.0 / self.rate_hz
    }
}
