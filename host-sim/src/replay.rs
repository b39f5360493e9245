//! The board's step over a log: same code, same single precision, same bits.

mod decimate;
mod limits;
mod marks;
mod records;
mod sensing;
mod steps;
mod width;

pub use decimate::decimated;
pub use marks::{EventKind, EventMark, FaultTally, Touch, fault_tallies};
pub use records::{Records, Said};
pub(crate) use sensing::between;
pub use steps::Steps;
pub(crate) use width::half_width;

use std::borrow::Cow;
use std::ops::Range;

use estimator_core::estimate::{Phase, params::Params};
use estimator_core::physics::law::LawKind;
use estimator_core::{Config, ConfigError, Estimate, Fault, Faults, Sample, State, step};

use crate::log::UniformLog;
use sensing::Readings;

/// What the estimator said to each sample of a log.
#[derive(Clone, Debug)]
pub struct Replay {
    /// The configuration that was replayed.
    pub config: Config,
    /// Its coefficients.
    pub params: Params<f32>,
    /// A record per sample. Record `i` describes sample `i − delay`.
    pub records: Records,
    /// The resting force (N) at each sample.
    pub rest_n: Vec<f32>,
    /// Position of the surface (m) that the depth of each record is measured from.
    pub surface_m: Steps,
    /// The records from which on the position is another by a jump that stays.
    pub jumps: Vec<usize>,
    /// The touches of a log that begins in contact: the estimator took the force that it began with for its resting force.
    pub touched: Option<Vec<Range<usize>>>,
    /// Standard deviation of the raw force (N) as the estimator measured it.
    pub noise_n: f64,
    /// Samples that the records are late.
    pub delay: usize,
    /// Time of the first sample (s).
    pub start_s: f64,
    /// Time between samples (s).
    pub period_s: f64,
}

/// Runs the estimator over a log.
///
/// # Errors
/// The field of the configuration that cannot be used.
pub fn replay(log: &UniformLog, config: &Config) -> Result<Replay, ConfigError> {
    let params = config.validate::<f32>()?;
    let mut state = State::new(&params);
    let mut records = Records::with_capacity(log.len());
    let mut rest_n = Vec::with_capacity(log.len());
    let mut surface_m = Steps::default();
    let mut jumps = Vec::new();
    let delay = (params.delay_us() as f64 * 1e-6 * log.rate_hz).round() as usize;
    let readings = Readings::of(log);
    for (index, sample) in readings.samples(log.rate_hz).enumerate() {
        // The instant that a record describes must have been measured.
        let described = index.checked_sub(delay);
        state.enable_learning(described.is_none_or(|at| !readings.invented.contains(at)));
        if sample.faults.has(Fault::PositionJump) {
            jumps.push(index + delay);
        }
        let mut record = step(&params, &mut state, sample);
        record.faults = record.faults | readings.bridged_faults.at(index);
        records.push(record);
        rest_n.push(state.resting_force_n());
        surface_m.push(state.surface_m(&params).unwrap_or_default());
    }
    Ok(Replay {
        config: *config,
        params,
        records,
        rest_n,
        surface_m,
        jumps,
        touched: None,
        noise_n: f64::from(state.force_noise_n()),
        delay,
        start_s: log.time_s.first().copied().unwrap_or(0.0),
        period_s: log.period_s(),
    })
}

/// The samples at which the position is another by a jump that stays, as the board's own code recognises it.
pub(crate) fn position_jumps(log: &UniformLog) -> impl Iterator<Item = usize> {
    let readings = Readings::of(log);
    (0..log.len()).filter(move |at| readings.faults.at(*at).has(Fault::PositionJump))
}

/// Whether force and position hang at each sample, as the board's own code recognises it.
pub(crate) fn hanging(log: &UniformLog) -> Vec<[bool; 2]> {
    let readings = Readings::of(log);
    (0..log.len()).map(|at| readings.hang(at)).collect()
}

/// The log as [`replay`] has seen it: single readings that are wrong are bridged and none of its own, and neither are
/// those of a channel that hangs. A fit of all samples learned from 39 spikes of 5 N, and said that they were dropped.
pub(crate) fn as_seen(log: &UniformLog) -> Cow<'_, UniformLog> {
    let readings = Readings::of(log);
    let is_wrong = |at: usize| {
        let bridged = [Fault::ForceUnusable, Fault::PositionJump];
        readings.hang(at).contains(&true)
            || (bridged.iter()).any(|fault| readings.bridged_faults.at(at).has(*fault))
    };
    let wrong: Vec<bool> = (0..log.len()).map(is_wrong).collect();
    if !wrong.contains(&true) {
        return Cow::Borrowed(log);
    }
    let in_gap = log.in_gap.iter().zip(&wrong);
    Cow::Owned(UniformLog {
        in_gap: in_gap.map(|(gap, wrong)| *gap || *wrong).collect(),
        position_m: readings.position_m.to_vec(),
        force_n: readings.force_n.to_vec(),
        ..log.clone()
    })
}

/// The log as the board would have sampled it; the first sample is one period after time zero. The faults
/// that [`replay`] recognises are not among those of the samples.
pub fn samples(log: &UniformLog) -> impl Iterator<Item = Sample<f32>> + '_ {
    let saturated = log.compensated.saturated.iter().copied();
    let saturated = saturated.chain(std::iter::repeat(false));
    let faults = saturated.map(|saturated| match saturated {
        true => Faults::NONE.with(Fault::ForceSaturated),
        false => Faults::NONE,
    });
    sampled(log.rate_hz, &log.position_m, &log.force_n, faults)
}

impl Readings<'_> {
    /// Whether force and position hang at a sample.
    fn hang(&self, at: usize) -> [bool; 2] {
        let faults = self.faults.at(at);
        [Fault::ForceStuck, Fault::PositionStuck].map(|fault| faults.has(fault))
    }

    fn samples(&self, rate_hz: f64) -> impl Iterator<Item = Sample<f32>> + '_ {
        let faults = (0..self.position_m.len()).map(|at| self.faults.at(at));
        sampled(rate_hz, &self.position_m, &self.force_n, faults)
    }
}

fn sampled<'a>(
    rate_hz: f64,
    position_m: &'a [f64],
    force_n: &'a [f64],
    faults: impl Iterator<Item = Faults> + 'a,
) -> impl Iterator<Item = Sample<f32>> + 'a {
    let period_us = 1e6 / rate_hz;
    let channels = position_m.iter().zip(force_n);
    let each = channels.zip(1u64..).zip(faults);
    each.map(move |(((position, force), count), faults)| Sample {
        time_us: (count as f64 * period_us).round() as u64,
        position_m: *position as f32,
        force_n: *force as f32,
        faults,
    })
}

impl Replay {
    /// Time (s) of the instant that record `index` describes.
    pub fn time_s(&self, index: usize) -> f64 {
        self.start_s + (index as f64 - self.delay as f64) * self.period_s
    }

    /// Time (s) of the raw sample that record `index` was made at: contact, release and faults are
    /// decided on it, and not on the smoothed signals that the record describes.
    pub fn raw_time_s(&self, index: usize) -> f64 {
        self.start_s + index as f64 * self.period_s
    }

    /// The index of the sample that record `index` describes; `None` before the first.
    pub fn sample_of(&self, index: usize) -> Option<usize> {
        index.checked_sub(self.delay)
    }

    /// Depth (m) that record `index` describes, below the surface that is known at the end: an
    /// estimator that finds the surface moves the depths of its records with it.
    pub fn final_depth_m(&self, index: usize) -> f64 {
        let surface = self.surface_m.last();
        let position = self.records.depth_m(index) + self.surface_m.at(index);
        f64::from(position) - f64::from(surface)
    }

    /// The law of the last record: an estimator may choose among several.
    pub fn law(&self) -> LawKind {
        self.last().map_or(self.params.law(), |record| record.law)
    }

    /// The last record; `None` of an empty log.
    pub fn last(&self) -> Option<&Estimate<f32>> {
        self.records.last()
    }

    /// Stretches of contact as ranges of records.
    pub fn contacts(&self) -> Vec<Range<usize>> {
        if let Some(touched) = &self.touched {
            return touched.clone();
        }
        let mut contacts: Vec<Range<usize>> = Vec::new();
        let in_contact = |said: &Said| said.phase == Phase::Contact;
        let stretches = self.records.stretches();
        for (range, _) in stretches.filter(|(_, said)| in_contact(said)) {
            match contacts.last_mut() {
                Some(last) if last.end == range.start => last.end = range.end,
                _ => contacts.push(range),
            }
        }
        contacts
    }
}

#[cfg(test)]
mod tests;
