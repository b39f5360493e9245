//! A log as the fits see it: position, speed, acceleration and force, at the log's rate or thinned.

use crate::gap::data::{low_pass::LowPass, standstill};
use crate::kinematics::kinematics;
use crate::log::UniformLog;

/// The data of one log that a fit uses, one value for each sample.
#[derive(Clone, Debug)]
pub(crate) struct FitData {
    /// Time between samples (s); where `even` is false, between samples of a motion.
    pub(crate) period_s: f64,
    /// Whether the samples are equally spaced. They are not where rests were thinned more than motions.
    pub(crate) even: bool,
    /// Time (s) on the clock of the log.
    pub(crate) time_s: Vec<f64>,
    /// Smoothed position (m).
    pub(crate) position_m: Vec<f64>,
    /// Speed (m/s).
    pub(crate) speed_mps: Vec<f64>,
    /// Acceleration (m/s²).
    pub(crate) acceleration_mps2: Vec<f64>,
    /// Measured force (N).
    pub(crate) force_n: Vec<f64>,
    /// Standard deviation of the position (m).
    pub(crate) position_noise_m: f64,
    /// Standard deviation of the speed (m/s).
    pub(crate) speed_noise_mps: Vec<f64>,
    /// Standard deviation of the acceleration (m/s²).
    pub(crate) acceleration_noise_mps2: Vec<f64>,
    /// 1 for a measured sample, 0 for one in a gap.
    pub(crate) count: Vec<f64>,
}

impl FitData {
    /// Takes every sample of a log.
    pub(crate) fn of(log: &UniformLog) -> FitData {
        let mut motion = kinematics(log);
        standstill::shrink_speeds(&mut motion);
        FitData {
            period_s: log.period_s(),
            even: true,
            time_s: log.time_s.clone(),
            position_m: motion.position_m,
            speed_mps: motion.speed_mps,
            acceleration_mps2: motion.acceleration_mps2,
            force_n: log.force_n.clone(),
            position_noise_m: motion.noise_m,
            speed_noise_mps: motion.speed_noise_mps,
            acceleration_noise_mps2: motion.acceleration_noise_mps2,
            count: log
                .in_gap
                .iter()
                .map(|gap| f64::from(u8::from(!gap)))
                .collect(),
        }
    }

    /// Keeps every `step`-th sample. Means over blocks would be wrong where a force jumps (at a reversal
    /// under friction, at a touch): the mean force is not the force of the mean motion.
    pub(crate) fn thinned(&self, step: usize) -> FitData {
        FitData {
            period_s: self.period_s * step as f64,
            ..self.picked((step / 2..self.len()).step_by(step))
        }
    }

    /// Keeps the samples at some indices.
    pub(crate) fn picked(&self, indices: impl Iterator<Item = usize> + Clone) -> FitData {
        let picked =
            |channel: &[f64]| -> Vec<f64> { indices.clone().map(|at| channel[at]).collect() };
        FitData {
            period_s: self.period_s,
            even: self.even,
            time_s: picked(&self.time_s),
            position_m: picked(&self.position_m),
            speed_mps: picked(&self.speed_mps),
            acceleration_mps2: picked(&self.acceleration_mps2),
            force_n: picked(&self.force_n),
            position_noise_m: self.position_noise_m,
            speed_noise_mps: picked(&self.speed_noise_mps),
            acceleration_noise_mps2: picked(&self.acceleration_noise_mps2),
            count: picked(&self.count),
        }
    }

    /// The time (s) from the sample before to this one.
    pub(crate) fn step_s(&self, at: usize) -> f64 {
        match at.checked_sub(1) {
            Some(before) if !self.even => self.time_s[at] - self.time_s[before],
            _ => self.period_s,
        }
    }

    /// Passes the force through a low-pass.
    pub(crate) fn filtered(&self, low_pass: Option<LowPass>) -> FitData {
        let mut filtered = self.clone();
        if let Some(low_pass) = low_pass {
            low_pass.apply(&mut filtered.force_n, self.period_s);
        }
        filtered
    }

    /// The number of samples.
    pub(crate) fn len(&self) -> usize {
        self.time_s.len()
    }
}
