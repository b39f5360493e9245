//! Speeds next to a standstill.
//!
//! The last count before a rest comes late, and the slope of the cubic over it is a speed where there is
//! none. Small speeds near a rest are mostly the rest itself: on a simulated servo (1 µm, 1 kHz) speeds
//! that were found to be 30 to 100 µm/s were 26 µm/s too large in the mean. Far from a rest a small speed is
//! as likely as any other and stays as it is.

use super::motion_errors::SPEED_ERROR_FACTOR;
use crate::kinematics::Kinematics;

/// A position that reads the same for this many samples rests: the widest window of `kinematics`.
const RESTING_SAMPLES: f64 = 31.0;
/// A sample is near a rest if it is at most this many samples before or after it.
const NEAR_SAMPLES: usize = 31;

/// Takes from the speeds near a rest what the rest puts into them: v → v·v²/(v² + σ²), the mean of what a
/// speed can be that is either 0 or anything.
pub(crate) fn shrink_speeds(motion: &mut Kinematics) {
    let count = motion.held.len();
    let mut near_rest = vec![false; count];
    for at in (0..count).filter(|at| motion.held[*at] >= RESTING_SAMPLES) {
        near_rest[at.saturating_sub(NEAR_SAMPLES)..(at + NEAR_SAMPLES + 1).min(count)].fill(true);
    }
    let speeds = motion.speed_mps.iter_mut().zip(&motion.speed_noise_mps);
    for ((speed, noise), _) in speeds.zip(near_rest).filter(|(_, near)| *near) {
        let (square, error) = (*speed * *speed, SPEED_ERROR_FACTOR * noise);
        if square > 0.0 {
            *speed *= square / (square + error * error);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kinematics::kinematics;
    use crate::log::Log;

    /// Mean excess (m/s) of the speeds that are found between 30 and 100 µm/s.
    fn excess(found: &[f64], speed: impl Fn(usize) -> f64) -> (f64, usize) {
        let small = (0..found.len()).filter(|at| (3e-5..1e-4).contains(&found[*at].abs()));
        let each: Vec<f64> = small
            .map(|at| (found[at] - speed(at)) * found[at].signum())
            .collect();
        (each.iter().sum::<f64>() / each.len() as f64, each.len())
    }

    #[test]
    fn a_motor_that_comes_to_rest_is_not_found_to_creep_on() {
        // GIVEN 100 stops of a motor of 25 Hz, each at another place between two counts, 1 µm at 1 kHz
        let rate = std::f64::consts::TAU * 25.0;
        let way = |t: f64| 1.0 - (1.0 + rate * t) * (-rate * t).exp();
        let (every, step_m) = (400, 0.50137e-3);
        let (position, speed): (Vec<f64>, Vec<f64>) = (0..100 * every)
            .map(|at| {
                let t = (at % every) as f64 * 1e-3;
                let x = step_m * ((at / every) as f64 + way(t));
                (
                    (x * 1e6).round() * 1e-6,
                    step_m * rate * rate * t * (-rate * t).exp(),
                )
            })
            .unzip();
        let time: Vec<f64> = (0..position.len()).map(|at| at as f64 * 1e-3).collect();
        let force = vec![0.0; position.len()];
        let log = Log::from_channels(time, position, force);
        let mut motion = kinematics(&log.uniform().unwrap());
        let (before, count) = excess(&motion.speed_mps, |at| speed[at]);
        // WHEN the speeds near the rests are shrunk
        shrink_speeds(&mut motion);
        let (after, _) = excess(&motion.speed_mps, |at| speed[at]);
        // THEN a third of what was too much is gone (38 %): a shrinkage that took all would take from
        // motion.
        assert!(count > 200 && before > 1.5e-5, "{count} {before:e}");
        assert!(
            after > 0.0 && after < 0.7 * before,
            "{after:e} after {before:e}"
        );
    }

    #[test]
    fn a_slow_motion_that_never_rests_keeps_its_speed() {
        let time: Vec<f64> = (0..4000).map(|at| f64::from(at) * 1e-3).collect();
        let position = time.iter().map(|t| (60.0 * t).round() * 1e-6).collect();
        let log = Log::from_channels(time, position, vec![0.0; 4000]);
        let mut motion = kinematics(&log.uniform().unwrap());
        let before = motion.speed_mps.clone();
        shrink_speeds(&mut motion);
        assert_eq!(motion.speed_mps, before);
    }
}
