//! Whether the motion tells what depends on its speed.
//!
//! A cantilever goes down to the sample at one speed and up at one: the liquid's drag is then one force down and another
//! one up, as a dry friction is. Only the reversal tells them apart, and it is where every other form errs, too.

use crate::gap::model::{dataset::Dataset, fit::Fit};
use crate::gap::search::blocks::are_touches_few;
use crate::stats::{median, quantile};

/// Below this share of the fastest speeds a rig rests.
const RESTING: f64 = 0.25;
/// Speeds that differ by less than this share are one.
const ALIKE: f64 = 0.15;
/// And by less than so many standard deviations of their noise.
const NOISE_SIGMAS: f64 = 2.0;

/// Whether the logs move at one speed each way, and reverse so seldom that a reversal is no evidence: there a drag is a
/// friction, beside a zero that is not known either.
pub(super) fn is_one_speed(dataset: &Dataset<'_>, best: &Fit) -> bool {
    let each = dataset
        .logs
        .iter()
        .flat_map(|log| log.speed_mps.iter().zip(&log.speed_noise_mps));
    let speeds: Vec<(f64, f64)> = each.map(|(speed, noise)| (*speed, *noise)).collect();
    is_mostly_alike(&speeds, dataset.thresholds.rivalry.alike_speeds)
        && are_touches_few(dataset, best)
}

/// Whether this share of the speeds that are no rest, each with its noise, is within [`ALIKE`] of the median of those of
/// their sign.
fn is_mostly_alike(speeds: &[(f64, f64)], share: f64) -> bool {
    let resting = RESTING * quantile(speeds.iter().map(|(speed, _)| speed.abs()), 0.95);
    let (mut alike, mut moving) = (0, 0);
    for way in [1.0, -1.0] {
        let own = speeds.iter().map(|(speed, noise)| (way * speed, noise));
        let own: Vec<(f64, &f64)> = own.filter(|(speed, _)| *speed > resting).collect();
        let usual = median(own.iter().map(|(speed, _)| *speed));
        let is_alike = |(speed, noise): &&(f64, &f64)| {
            (*speed - usual).abs() < ALIKE * usual + NOISE_SIGMAS * **noise
        };
        alike += own.iter().filter(is_alike).count();
        moving += own.len();
    }
    alike as f64 >= share * moving as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gap::thresholds::Rivalry;

    #[test]
    fn a_triangle_has_one_speed_each_way_and_a_sine_has_all() {
        let speeds = |of: fn(f64) -> f64| -> Vec<(f64, f64)> {
            let each = (0..1000).map(|at| of(f64::from(at) * 1e-3));
            each.map(|speed| (speed, 0.01)).collect()
        };
        let share = Rivalry::default().alike_speeds;
        let is_one = |of| is_mostly_alike(&speeds(of), share);
        // GIVEN 5 mm/s down, a rest, and 8 mm/s up
        let press = |at: f64| match at {
            at if at < 0.45 => 5.0,
            at if at < 0.6 => 0.0,
            _ => -8.0,
        };
        assert!(is_one(press));
        // THEN in contact it may be a little less, AND two speeds of one way are two.
        assert!(is_one(|at| if (0.42..0.5).contains(&at) {
            4.0
        } else {
            5.0
        }));
        assert!(!is_one(|at| if at < 0.5 { 5.0 } else { 8.0 }));
        assert!(!is_one(|at| (6.3 * at).cos()));
    }
}
