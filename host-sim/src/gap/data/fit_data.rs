//! A log as the fits see it: position, speed, acceleration and force, at the log's rate or thinned.

use crate::gap::data::low_pass::LowPass;
use crate::gap::data::standstill;
use crate::kinematics::kinematics;
use crate::log::UniformLog;

/// One log at one resolution, a value per sample.
#[derive(Clone, Debug)]
pub(in crate::gap) struct Course {
    /// Time between samples (s); between moving ones where `even` is false.
    pub(in crate::gap) period_s: f64,
    /// Whether all samples are as far apart; if not, rests were thinned more than motion.
    pub(in crate::gap) even: bool,
    /// Time (s) on the log's own clock.
    pub(in crate::gap) time_s: Vec<f64>,
    pub(in crate::gap) position_m: Vec<f64>,
    pub(in crate::gap) speed_mps: Vec<f64>,
    pub(in crate::gap) acceleration_mps2: Vec<f64>,
    pub(in crate::gap) force_n: Vec<f64>,
    /// Standard deviations of the position (m), the speed (m/s) and the acceleration (m/s²).
    pub(in crate::gap) position_noise_m: f64,
    pub(in crate::gap) speed_noise_mps: Vec<f64>,
    pub(in crate::gap) acceleration_noise_mps2: Vec<f64>,
    /// 1 for a measurement, 0 in a gap.
    pub(in crate::gap) count: Vec<f64>,
}

impl Course {
    /// A log sample by sample.
    pub(in crate::gap) fn of(log: &UniformLog) -> Course {
        let mut motion = kinematics(log);
        standstill::settle(&mut motion);
        Course {
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

    /// Every `step`-th sample of it. Not a mean: where a force jumps (a reversal under friction, a
    /// touch) the mean over a block is no force of the mean motion.
    pub(in crate::gap) fn thinned(&self, step: usize) -> Course {
        Course {
            period_s: self.period_s * step as f64,
            ..self.picked((step / 2..self.len()).step_by(step))
        }
    }

    /// The samples at some places of it.
    pub(in crate::gap) fn picked(&self, places: impl Iterator<Item = usize> + Clone) -> Course {
        let every =
            |channel: &[f64]| -> Vec<f64> { places.clone().map(|at| channel[at]).collect() };
        Course {
            period_s: self.period_s,
            even: self.even,
            time_s: every(&self.time_s),
            position_m: every(&self.position_m),
            speed_mps: every(&self.speed_mps),
            acceleration_mps2: every(&self.acceleration_mps2),
            force_n: every(&self.force_n),
            position_noise_m: self.position_noise_m,
            speed_noise_mps: every(&self.speed_noise_mps),
            acceleration_noise_mps2: every(&self.acceleration_noise_mps2),
            count: every(&self.count),
        }
    }

    /// Time (s) from the sample before to this one.
    pub(in crate::gap) fn step_s(&self, at: usize) -> f64 {
        match at.checked_sub(1) {
            Some(before) if !self.even => self.time_s[at] - self.time_s[before],
            _ => self.period_s,
        }
    }

    /// The same with its force through a low-pass.
    pub(in crate::gap) fn filtered(&self, low_pass: Option<LowPass>) -> Course {
        let mut filtered = self.clone();
        if let Some(low_pass) = low_pass {
            low_pass.apply(&mut filtered.force_n, self.period_s);
        }
        filtered
    }

    pub(in crate::gap) fn len(&self) -> usize {
        self.time_s.len()
    }
}
