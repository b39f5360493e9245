//! Sizes of a log, and what share of it lies below a value.

use super::fit_data::Course;

/// Sizes that starts, bounds and thresholds are made of: nothing in the workflow is absolute.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::gap) struct Scales {
    /// Range of the position (m).
    pub(in crate::gap) travel_m: f64,
    /// 99 % of the force's range (N).
    pub(in crate::gap) force_n: f64,
    /// Largest force (N).
    pub(in crate::gap) highest_n: f64,
    /// Smallest force (N).
    pub(in crate::gap) lowest_n: f64,
    /// 95 % of the speeds' sizes while it moves (m/s).
    pub(in crate::gap) speed_mps: f64,
    /// The same of the accelerations (m/s²).
    pub(in crate::gap) acceleration_mps2: f64,
    /// Longest log (s).
    pub(in crate::gap) duration_s: f64,
    /// Time between samples (s).
    pub(in crate::gap) period_s: f64,
    /// Noise of position (m) and speed (m/s).
    pub(in crate::gap) position_noise_m: f64,
    pub(in crate::gap) speed_noise_mps: f64,
    /// Deepest position (m).
    pub(in crate::gap) deepest_m: f64,
    /// Largest distance of the position from 0 (m).
    pub(in crate::gap) reach_m: f64,
}

impl Scales {
    pub(in crate::gap) fn of(courses: &[Course]) -> Scales {
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
pub(in crate::gap) fn quantile(sorted: &[f64], share: f64) -> f64 {
    let last = sorted.len().saturating_sub(1);
    sorted
        .get((share * last as f64).round() as usize)
        .copied()
        .unwrap_or(0.0)
}
