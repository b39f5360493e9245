//! Motions as the logs of a rig would show them.

use crate::gap::data::{fit_data::FitData, scales::Scales};
use crate::gap::experiment::discriminability::Discriminability;
use crate::gap::model::{dataset::Dataset, shape::Shape};
use crate::gap::noise::floor::NoiseFloor;
use crate::gap::thresholds::Thresholds;
use crate::log::UniformLog;
use crate::motion::Motion;

/// Samples of a motion: enough for 12 Hz in 20 s.
const SAMPLES: usize = 1_500;
/// Most samples from which the speed and acceleration of a motion are taken.
const MOST_SMOOTHED: usize = 60_000;

/// Logs, or motions that have no log yet, with their noise.
#[derive(Clone, Default)]
pub(super) struct Recordings {
    pub(super) logs: Vec<FitData>,
    pub(super) floors: Vec<NoiseFloor>,
    /// How many samples of the rig each sample of a log stands for.
    pub(super) repeats: Vec<f64>,
}

/// The sensors that record a motion.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sensor {
    /// Samples per second.
    pub(super) rate_hz: f64,
    /// Resolution of the position (m).
    pub(super) position_step_m: f64,
    /// Standard deviation of the force (N).
    pub(super) noise_n: f64,
}

impl Recordings {
    /// The same with a further motion.
    pub(super) fn and(&self, motion: &Motion, sensor: Sensor) -> Recordings {
        let mut all = self.clone();
        let (log, repeats) = sensor.record(motion);
        all.logs.push(log);
        all.repeats.push(repeats);
        all.floors.push(NoiseFloor::white(sensor.noise_n, "given"));
        all
    }

    /// What these recordings show of effects beside a base.
    pub(super) fn discriminability<'a>(
        &'a self,
        shape: &'a Shape,
        numbers: &'a [f64],
        scales: &'a Scales,
        thresholds: &'a Thresholds,
    ) -> Discriminability<'a> {
        let dataset = Dataset {
            logs: &self.logs,
            floors: &self.floors,
            low_pass: None,
            scales,
            known: None,
            thresholds,
        };
        Discriminability::new(shape, numbers, dataset, &self.repeats)
    }
}

impl Sensor {
    /// A motion as a log would show it, without its force, and how many samples of the rig each of its
    /// samples stands for.
    fn record(self, motion: &Motion) -> (FitData, f64) {
        let samples = (motion.duration_s() * self.rate_hz).ceil().max(50.0);
        let slower = (samples / MOST_SMOOTHED as f64).max(1.0);
        let rate_hz = self.rate_hz / slower;
        let count = (samples / slower) as usize;
        let time_s: Vec<f64> = (0..count).map(|at| at as f64 / rate_hz).collect();
        let position_m = time_s.iter().map(|t| self.rounded(motion.position(*t).0));
        let log = UniformLog {
            rate_hz,
            position_m: position_m.collect(),
            force_n: vec![0.0; count],
            in_gap: vec![false; count],
            time_s,
            ..UniformLog::default()
        };
        let step = count.div_ceil(SAMPLES);
        (FitData::of(&log).thinned(step), slower * step as f64)
    }

    fn rounded(self, position_m: f64) -> f64 {
        let step = self.position_step_m;
        if step > 0.0 {
            (position_m / step).round() * step
        } else {
            position_m
        }
    }
}
