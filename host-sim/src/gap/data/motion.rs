//! The motion of a rig at a sample of a log, without and with a delay.

use estimator_core::maths::Scalar;
use estimator_core::physics::effect::Motion;

use crate::gap::data::fit_data::FitData;

impl FitData {
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
        let period_s = self.step_s(at);
        let back = delay_s.to_f64() / period_s;
        let place = (at as f64 - back).clamp(0.0, (self.len() - 1) as f64);
        let first = (place.floor() as usize).min(self.len().saturating_sub(2));
        let second = (first + 1).min(self.len() - 1);
        let share = place - first as f64;
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
        // The value of this is 0: it only carries the derivative by the delay into the motion.
        let further = delay_s - S::from_f64(delay_s.to_f64());
        let number = S::from_f64;
        Motion {
            time_s: number(self.time_s[at]) - delay_s,
            position_m: number(position) - further * number(speed),
            speed_mps: number(speed) - further * number(acceleration),
            acceleration_mps2: number(acceleration),
        }
    }
}
