//! The noise floors of all logs, with slow noise where stretches of the motion show it and without.
//!
//! Far from the noise it is enough that a floor is small: what remains of a record counts, and weights that a slow
//! noise levels lost a relaxation under a cantilever. Near it the slow noise decides. A log is therefore asked with second
//! differences first, and again with the slow noise where that may be all that remains.

use crate::gap::data::fit_data::FitData;
use crate::gap::noise::floor::NoiseFloor;
use crate::stats::highest;

/// The noise floors of all logs.
pub(crate) struct Floors {
    /// As second differences and rests have them.
    pub(crate) fast: Vec<NoiseFloor>,
    /// With the slow noise of stretches, where there is one.
    pub(crate) slow: Vec<NoiseFloor>,
}

impl Floors {
    /// How many times as large the noise is with slow noise, where that is most.
    pub(crate) fn times(&self) -> f64 {
        let each = self.slow.iter().zip(&self.fast);
        each.map(|(slow, fast)| slow.noise_n() / fast.noise_n().max(f64::MIN_POSITIVE))
            .fold(1.0, f64::max)
    }
}

/// The largest noise (N) of all logs.
pub(crate) fn largest_noise_n(floors: &[NoiseFloor]) -> f64 {
    highest(floors.iter().map(NoiseFloor::noise_n))
}

/// The most samples for each independent one of all `logs`, of which every `step`-th sample is taken.
pub(crate) fn largest_correlation(floors: &[NoiseFloor], logs: &[FitData], step: usize) -> f64 {
    let samples = |(floor, log): (&NoiseFloor, &FitData)| {
        log.samples_for_each(floor.correlation * log.period_s / step as f64)
    };
    floors.iter().zip(logs).map(samples).fold(1.0, f64::max)
}
