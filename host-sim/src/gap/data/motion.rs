//! The motion of a rig at a sample of a log, without and with a delay.

use estimator_core::maths::Scalar;
use estimator_core::physics::effect::Motion;

use crate::gap::data::fit_data::{FitData, Spacing};

impl FitData {
    /// Where the instant `delay_s` before a sample lies, in samples.
    fn place_before(&self, at: usize, delay_s: f64) -> f64 {
        let last = self.len() - 1;
        if self.spacing == Spacing::Even {
            return (at as f64 - delay_s / self.period_s).clamp(0.0, last as f64);
        }
        let instant_s = self.time_s[at] - delay_s;
        // Delays are a few samples long.
        let mut first = at.min(last.saturating_sub(1));
        while first > 0 && self.time_s[first] > instant_s {
            first -= 1;
        }
        while first + 1 < last && self.time_s[first + 1] <= instant_s {
            first += 1;
        }
        let step_s = self.step_s((first + 1).min(last));
        let share = ((instant_s - self.time_s[first]) / step_s).clamp(0.0, 1.0);
        first as f64 + share
    }

    /// The motion at a sample.
    pub(crate) fn motion<S: Scalar>(&self, at: usize) -> Motion<S> {
        Motion {
            time_s: S::from_f64(self.time_s[at]),
            position_m: S::from_f64(self.position_m[at]),
            speed_mps: S::from_f64(self.speed_mps[at]),
            acceleration_mps2: S::from_f64(self.acceleration_mps2[at]),
        }
    }

    /// The motion `delay_s` before a sample, from the cubic through the positions and speeds of the two
    /// samples around that time.
    pub(crate) fn delayed_motion<S: Scalar>(&self, at: usize, delay_s: S) -> Motion<S> {
        let place = self.place_before(at, delay_s.to_f64());
        let first = (place.floor() as usize).min(self.len().saturating_sub(2));
        let second = (first + 1).min(self.len() - 1);
        let share = place - first as f64;
        let period_s = self.step_s(second);
        let mix = |channel: &[f64]| channel[first] + share * (channel[second] - channel[first]);
        let (x0, x1) = (self.position_m[first], self.position_m[second]);
        let slopes = (
            self.speed_mps[first] * period_s,
            self.speed_mps[second] * period_s,
        );
        let (a, b) = (slopes.0 - (x1 - x0), (x1 - x0) - slopes.1);
        let position =
            mix(&self.position_m) + share * (1.0 - share) * ((1.0 - share) * a + share * b);
        let (speed, acceleration) = (mix(&self.speed_mps), mix(&self.acceleration_mps2));
        let change = self.acceleration_mps2[second] - self.acceleration_mps2[first];
        // The value of this is 0: it only carries the derivative by the delay into the motion.
        let further = delay_s - S::from_f64(delay_s.to_f64());
        let number = S::from_f64;
        Motion {
            time_s: number(self.time_s[at]) - delay_s,
            position_m: number(position) - further * number(speed),
            speed_mps: number(speed) - further * number(acceleration),
            // Without it a mass gives the fit of a delay no direction: 3 ms put into a servo's record were not found.
            acceleration_mps2: number(acceleration) - further * number(change / period_s),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::Log;
    use estimator_core::maths::Dual;

    #[test]
    fn a_delay_changes_position_speed_and_acceleration() {
        // GIVEN 2 mm at 3 Hz and 1 kHz
        let time: Vec<f64> = (0..2000).map(|at| 1e-3 * f64::from(at)).collect();
        let position: Vec<f64> = time.iter().map(|t| 2e-3 * (18.85 * t).sin()).collect();
        let log = Log::from_channels(time, position, vec![0.0; 2000]);
        let data = FitData::of(&log.uniform().unwrap());
        for at in [200, 731, 1500] {
            let gradient = data.delayed_motion(at, Dual::<f64, 1>::parameter(2.4e-3, 0));
            // WHEN the delay is 10 µs longer
            let (a, b) = (
                data.delayed_motion::<f64>(at, 2.4e-3),
                data.delayed_motion::<f64>(at, 2.41e-3),
            );
            // THEN each is what its gradient says, to 2 % of what it is a radian of the motion later.
            for (slope, change, largest) in [
                (gradient.position_m, b.position_m - a.position_m, 0.038),
                (gradient.speed_mps, b.speed_mps - a.speed_mps, 0.71),
                (
                    gradient.acceleration_mps2,
                    b.acceleration_mps2 - a.acceleration_mps2,
                    13.4,
                ),
            ] {
                let off = (slope.gradient[0] - change / 1e-5).abs();
                assert!(off < 0.02 * largest, "{at}: {off} of {largest}");
            }
        }
    }
}
