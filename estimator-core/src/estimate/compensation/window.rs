//! The window that speed, acceleration and the rate of the force come from.

use crate::estimate::filter::{Aligned, MAX_HALF_WIDTH, SavitzkyGolay, SavitzkyGolayParams};
use crate::estimate::sample::Sample;
use crate::maths::scalar::{Real, Scalar};
use crate::physics::effect::Motion;

/// Half of the window (s): the rise of a position-controlled motor of 100 Hz.
const HALF_WINDOW_S: f64 = 5e-3;

/// The weights hₖ of the window, and what follows from them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Window<T> {
    filter: SavitzkyGolayParams<T>,
    rate_hz: T,
    /// Σhₖ(kT)² (s²).
    time_variance_s2: T,
    /// Largest variance of the position (m²) that counts as rest: a single count that comes and goes.
    rest_variance_m2: T,
}

/// What the window remembers of the samples.
#[derive(Clone, Debug, Default)]
pub(super) struct WindowState<T: Real> {
    filter: SavitzkyGolay<T>,
    /// The last three averages, newest first.
    averages: [Aligned<T>; 3],
}

/// Mean of the motor's motion and of the force between probe and cell over the window.
pub(super) struct WindowMean<T> {
    pub(super) motion: Motion<T>,
    pub(super) force_n: T,
    /// Whether the encoder saw no motion.
    at_rest: bool,
}

impl<T: Real> WindowMean<T> {
    /// Position and force of one instant, for effects that need no derivative.
    pub(super) fn instant(time_s: T, position_m: T, force_n: T) -> Self {
        WindowMean {
            motion: Motion {
                time_s,
                ..resting_at(position_m)
            },
            force_n,
            at_rest: false,
        }
    }
}

impl<T: Real> Window<T> {
    pub(super) fn new(rate_hz: f64, position_step_m: f64) -> Window<T> {
        let wanted = (rate_hz * HALF_WINDOW_S + 0.5) as usize;
        let half_width = wanted.clamp(2, MAX_HALF_WIDTH) as u8;
        let filter = SavitzkyGolayParams::<T>::new(half_width, rate_hz as f32);
        let variance: f64 = filter
            .sides()
            .iter()
            .zip(1u8..)
            .map(|(side, k)| 2.0 * side.0.to_f64() * f64::from(k) * f64::from(k))
            .sum();
        // A count that is there for half of the window has a variance of ¼ count²; 10 % are added
        // for rounding.
        let rest_variance_m2 = 0.275 * position_step_m * position_step_m;
        Window {
            filter,
            rate_hz: T::from_f64(rate_hz),
            time_variance_s2: T::from_f64(variance / (rate_hz * rate_hz)),
            rest_variance_m2: T::from_f64(rest_variance_m2),
        }
    }

    /// Delay of a mean behind the newest sample (samples): half a window, and one for the central
    /// difference.
    pub(super) fn delay_samples(&self) -> usize {
        self.filter.sides().len() + 1
    }

    /// Takes position (m) and force reading (N) of one instant; gives the means that end with it. The
    /// lag of the load cell is undone: F = y + τẏ.
    pub(super) fn update(
        &self,
        state: &mut WindowState<T>,
        time_s: T,
        (position_m, force_n): (T, T),
        lag_s: T,
    ) -> WindowMean<T> {
        let sample = Sample {
            position_m,
            force_n,
            ..Sample::default()
        };
        let newest = state.filter.update(&self.filter, &sample);
        let [middle, oldest, _] = state.averages;
        state.averages = [newest, middle, oldest];
        let half_rate = T::from_f64(0.5) * self.rate_hz;
        let rate_nps = (newest.force_n - oldest.force_n) * half_rate;
        WindowMean {
            motion: Motion {
                time_s,
                position_m: middle.position_m,
                speed_mps: middle.speed_mps,
                acceleration_mps2: (newest.speed_mps - oldest.speed_mps) * half_rate,
            },
            force_n: middle.force_n + lag_s * rate_nps,
            at_rest: middle.position_variance_m2 < self.rest_variance_m2,
        }
    }

    /// Σ hₖ f(kT), the mean of a force along the parabola x̄, v̄, ā of `mean`.
    #[inline(never)]
    pub(super) fn mean_force_n(
        &self,
        mean: &WindowMean<T>,
        force_n: impl Fn(&Motion<T>) -> T,
    ) -> T {
        let motion = &mean.motion;
        let half = T::from_f64(0.5);
        let middle_m = motion.position_m - half * motion.acceleration_mps2 * self.time_variance_s2;
        let at = |offset_s: T| {
            let speed_mps = motion.speed_mps + motion.acceleration_mps2 * offset_s;
            force_n(&Motion {
                time_s: motion.time_s + offset_s,
                position_m: middle_m + half * (motion.speed_mps + speed_mps) * offset_s,
                speed_mps: if mean.at_rest { T::zero() } else { speed_mps },
                acceleration_mps2: motion.acceleration_mps2,
            })
        };
        let (mut sum, mut weights) = (T::zero(), T::zero());
        for (side, k) in self.filter.sides().iter().zip(1u8..) {
            let offset_s = T::from_u32(u32::from(k)) / self.rate_hz;
            sum += side.0 * (at(offset_s) + at(-offset_s));
            weights += side.0 + side.0;
        }
        sum + (T::one() - weights) * at(T::zero())
    }
}

impl<T: Real> WindowState<T> {
    /// Fills the window as if position (m) and force (N) had always been these.
    pub(super) fn restart(&mut self, position_m: T, force_n: T) {
        self.filter.restart(&Sample {
            position_m,
            force_n,
            ..Sample::default()
        });
        let resting = Aligned {
            position_m,
            force_n,
            ..Aligned::default()
        };
        self.averages = [resting; 3];
    }
}

/// The motion of a motor side that rests at `position_m` (m).
pub(super) fn resting_at<T: Scalar>(position_m: T) -> Motion<T> {
    Motion {
        time_s: T::zero(),
        position_m,
        speed_mps: T::zero(),
        acceleration_mps2: T::zero(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_of_a_force_that_is_linear_in_the_motion_is_the_force_of_the_mean_motion() {
        let window = Window::<f64>::new(1000.0, 0.0);
        let mean = WindowMean {
            motion: Motion {
                time_s: 0.3,
                position_m: 1e-3,
                speed_mps: 0.02,
                acceleration_mps2: 0.7,
            },
            force_n: 0.0,
            at_rest: false,
        };
        let force = |at: &Motion<f64>| {
            300.0 * at.position_m + 5.0 * at.speed_mps + 0.2 * at.acceleration_mps2 - at.time_s
        };
        let error = window.mean_force_n(&mean, force) - force(&mean.motion);
        assert!(error.abs() < 1e-15, "{error:e}");
    }

    #[test]
    fn one_count_that_comes_and_goes_is_rest_and_two_are_motion() {
        let step_m = 1e-6;
        let window = Window::<f64>::new(1000.0, step_m);
        for (counts, rests) in [(1.0, true), (2.0, false)] {
            let mut state = WindowState::default();
            let mut at = |i: u32| {
                let position_m = if i < 20 { 0.0 } else { counts * step_m };
                window.update(&mut state, 0.0, (position_m, 0.0), 0.0)
            };
            let all = (0..40).all(|i| at(i).at_rest);
            assert_eq!(all, rests, "{counts}");
        }
    }
}
