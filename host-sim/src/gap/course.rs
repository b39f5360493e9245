//! A log as the fits see it: position, speed, acceleration and force, at the log's rate or thinned.

use super::low_pass::LowPass;
use super::standstill;
use crate::kinematics::kinematics;
use crate::log::UniformLog;

/// One log at one resolution, a value per sample.
#[derive(Clone, Debug)]
pub(super) struct Course {
    /// Time between samples (s); between moving ones where `even` is false.
    pub(super) period_s: f64,
    /// Whether all samples are as far apart; if not, rests were thinned more than motion.
    pub(super) even: bool,
    /// Time (s) on the log's own clock.
    pub(super) time_s: Vec<f64>,
    pub(super) position_m: Vec<f64>,
    pub(super) speed_mps: Vec<f64>,
    pub(super) acceleration_mps2: Vec<f64>,
    pub(super) force_n: Vec<f64>,
    /// Standard deviations of the position (m), the speed (m/s) and the acceleration (m/s²).
    pub(super) position_noise_m: f64,
    pub(super) speed_noise_mps: Vec<f64>,
    pub(super) acceleration_noise_mps2: Vec<f64>,
    /// 1 for a measurement, 0 in a gap.
    pub(super) count: Vec<f64>,
}

impl Course {
    /// A log sample by sample.
    pub(super) fn of(log: &UniformLog) -> Course {
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
    pub(super) fn thinned(&self, step: usize) -> Course {
        Course {
            period_s: self.period_s * step as f64,
            ..self.picked((step / 2..self.len()).step_by(step))
        }
    }

    /// The samples at some places of it.
    pub(super) fn picked(&self, places: impl Iterator<Item = usize> + Clone) -> Course {
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
    pub(super) fn step_s(&self, at: usize) -> f64 {
        match at.checked_sub(1) {
            Some(before) if !self.even => self.time_s[at] - self.time_s[before],
            _ => self.period_s,
        }
    }

    /// The same with its force through a low-pass.
    pub(super) fn filtered(&self, low_pass: Option<LowPass>) -> Course {
        let mut filtered = self.clone();
        if let Some(low_pass) = low_pass {
            low_pass.apply(&mut filtered.force_n, self.period_s);
        }
        filtered
    }

    pub(super) fn len(&self) -> usize {
        self.time_s.len()
    }
}

/// Sizes that starts, bounds and thresholds are made of: nothing in the workflow is absolute.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scales {
    /// Range of the position (m).
    pub(super) travel_m: f64,
    /// 99 % of the force's range (N).
    pub(super) force_n: f64,
    /// Largest force (N).
    pub(super) highest_n: f64,
    /// Smallest force (N).
    pub(super) lowest_n: f64,
    /// 95 % of the speeds' sizes while it moves (m/s).
    pub(super) speed_mps: f64,
    /// The same of the accelerations (m/s²).
    pub(super) acceleration_mps2: f64,
    /// Longest log (s).
    pub(super) duration_s: f64,
    /// Time between samples (s).
    pub(super) period_s: f64,
    /// Noise of position (m) and speed (m/s).
    pub(super) position_noise_m: f64,
    pub(super) speed_noise_mps: f64,
    /// Deepest position (m).
    pub(super) deepest_m: f64,
    /// Largest distance of the position from 0 (m).
    pub(super) reach_m: f64,
}

impl Scales {
    pub(super) fn of(courses: &[Course]) -> Scales {
        let all = |channel: fn(&Course) -> &Vec<f64>| -> Vec<f64> {
            let mut values: Vec<f64> = courses
                .iter()
                .flat_map(|own| channel(own).clone())
                .collect();
            values.sort_unstable_by(f64::total_cmp);
            values
        };
        let sizes = |channel: fn(&Course) -> &Vec<f64>, above: f64| {
            let mut sizes: Vec<f64> = courses
                .iter()
                .flat_map(|own| channel(own).iter().map(|value| value.abs()))
                .filter(|size| *size > above)
                .collect();
            sizes.sort_unstable_by(f64::total_cmp);
            quantile(&sizes, 0.95)
        };
        let position = all(|own| &own.position_m);
        let force = all(|own| &own.force_n);
        let first = &courses[0];
        let mut noises: Vec<f64> = first.speed_noise_mps.clone();
        noises.sort_unstable_by(f64::total_cmp);
        let speed_noise_mps = quantile(&noises, 0.5);
        let duration = |own: &Course| match (own.time_s.first(), own.time_s.last()) {
            (Some(first), Some(last)) => last - first + own.period_s,
            _ => 0.0,
        };
        Scales {
            travel_m: quantile(&position, 1.0) - quantile(&position, 0.0),
            force_n: (quantile(&force, 0.995) - quantile(&force, 0.005)).max(f64::MIN_POSITIVE),
            highest_n: quantile(&force, 1.0),
            lowest_n: quantile(&force, 0.0),
            speed_mps: sizes(|own| &own.speed_mps, 3.0 * speed_noise_mps),
            acceleration_mps2: sizes(|own| &own.acceleration_mps2, 0.0),
            duration_s: courses.iter().map(duration).fold(0.0, f64::max),
            period_s: first.period_s,
            position_noise_m: first.position_noise_m,
            speed_noise_mps,
            deepest_m: quantile(&position, 1.0),
            reach_m: quantile(&position, 1.0)
                .abs()
                .max(quantile(&position, 0.0).abs()),
        }
    }
}

/// The value below which this share of sorted values lies; 0 of nothing.
pub(super) fn quantile(sorted: &[f64], share: f64) -> f64 {
    let last = sorted.len().saturating_sub(1);
    sorted
        .get((share * last as f64).round() as usize)
        .copied()
        .unwrap_or(0.0)
}
