//! The mean force of a law over a block, with its gradient and the relaxation that is carried on.
//!
//! With s = ((x − x₀)/δ₀)ⁿ and w the speed, scaled,
//!
//! F = K·s + λ·s·w − ΣBᵢzᵢ, żᵢ = νᵢ(s − zᵢ),
//!
//! which is (10)–(17) for λ = 0 and Bᵢ = Kcᵢ, Hunt–Crossley (3) for B = 0, Zener (2) for n = 1 and
//! λ = 0. z is carried over a block exactly for the block's mean of s, and so are its derivatives by
//! n, x₀ and ln ν, so that the gradient is that of the force.

use super::block::Block;
use super::theta::{DAMPING, EXPONENT, MODES, STIFFNESS, SURFACE, Theta, modes};
use crate::maths::scalar::Real;
use crate::physics::law::LawKind;

/// Largest variance of the position in a block, over the square of the depth.
const WIDEST: f64 = 0.04;

/// z of a mode and its derivatives by n, x₀ and ln ν.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct ModeState<T> {
    relaxed: T,
    by_exponent: T,
    by_surface: T,
    by_log_rate: T,
    decay: Decay<T>,
}

/// What a duration does to a mode, with x = ν·duration; most blocks in motion last equally long, and
/// exponentials are half of what a block costs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Decay<T> {
    log_rate: T,
    duration_s: T,
    x: T,
    /// e^{−x}
    decayed: T,
    /// (1 − e^{−x})/x
    mean: T,
}

impl<T: Real> Decay<T> {
    fn at(&mut self, log_rate: T, duration_s: T) -> Self {
        if self.log_rate != log_rate || self.duration_s != duration_s || self.mean == T::zero() {
            let x = log_rate.exp() * duration_s;
            *self = Decay {
                log_rate,
                duration_s,
                x,
                decayed: (-x).exp(),
                mean: (-x).exprel(),
            };
        }
        *self
    }

    /// Carries a state over the duration at an input that stays; returns its mean.
    fn carry(&self, state: &mut T, input: T) -> T {
        let away = *state - input;
        *state = input + away * self.decayed;
        input + away * self.mean
    }
}

/// How far a material has relaxed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct RelaxationState<T> {
    modes: [ModeState<T>; 2],
}

impl<T: Real> RelaxationState<T> {
    /// The state of a neighbouring θ, to first order.
    pub(super) fn moved(&self, by: &Theta<T>) -> Self {
        let mut moved = *self;
        for (mode, (_, log_rate)) in moved.modes.iter_mut().zip(MODES) {
            mode.relaxed += mode.by_exponent * by[EXPONENT]
                + mode.by_surface * by[SURFACE]
                + mode.by_log_rate * by[log_rate];
        }
        moved
    }
}

/// The mean force of a block, its gradient, and the relaxation at its end.
#[derive(Clone, Copy, Debug)]
pub(super) struct Predicted<T: Real> {
    pub(super) force: T,
    pub(super) gradient: Theta<T>,
    pub(super) relaxation: RelaxationState<T>,
}

/// Means over a block: s, its derivatives by n and x₀, and s·w.
#[derive(Default)]
struct Shape<T> {
    s: T,
    by_exponent: T,
    by_surface: T,
    damped: T,
    log: T,
    /// 1/depth as far as the damper depends on the depth.
    damped_per_depth: T,
    /// Whether two orders of the power describe the block.
    narrow: bool,
}

impl<T: Real> Shape<T> {
    fn of(theta: &Theta<T>, block: &Block<T>) -> Self {
        let exponent = theta[EXPONENT];
        let depth = block.position - theta[SURFACE];
        if depth <= T::zero() {
            return Shape::default();
        }
        let log = depth.ln();
        let power = (exponent * log).exp();
        let per_depth = T::one() / depth;
        let variance = block.position_variance;
        let narrow = variance < T::from_f64(WIDEST) * depth * depth;
        let curve = if narrow {
            let second = T::from_f64(0.5) * exponent * (exponent - T::one());
            second * variance * per_depth * per_depth
        } else {
            T::zero()
        };
        let s = power * (T::one() + curve);
        Shape {
            s,
            by_exponent: s * log,
            by_surface: -(exponent * s * per_depth),
            damped: s * block.speed + power * exponent * block.position_velocity_cov * per_depth,
            log,
            damped_per_depth: per_depth,
            narrow,
        }
    }

    /// The damper of Kelvin–Voigt (1) does not depend on the depth.
    fn with_plain_damper(self, speed: T) -> Self {
        let inside = self.s > T::zero();
        Shape {
            damped: if inside { speed } else { T::zero() },
            damped_per_depth: T::zero(),
            ..self
        }
    }
}

/// F̂ of a law and its gradient over a block that begins with `before`.
pub(super) fn predict<T: Real>(
    theta: &Theta<T>,
    law: LawKind,
    before: &RelaxationState<T>,
    block: &Block<T>,
) -> Predicted<T> {
    let shape = match law {
        LawKind::KelvinVoigt => Shape::of(theta, block).with_plain_damper(block.speed),
        _ => Shape::of(theta, block),
    };
    let mut predicted = Predicted {
        force: theta[STIFFNESS] * shape.s,
        gradient: Theta::repeat(T::zero()),
        relaxation: *before,
    };
    predicted.gradient[EXPONENT] = theta[STIFFNESS] * shape.by_exponent;
    predicted.gradient[SURFACE] = theta[STIFFNESS] * shape.by_surface;
    predicted.relax(theta, &shape, modes(law), block.duration_s);
    predicted.damp(theta, &shape);
    predicted
}

impl<T: Real> Predicted<T> {
    /// Takes off what relaxes, −ΣBᵢzᵢ.
    fn relax(&mut self, theta: &Theta<T>, shape: &Shape<T>, modes: usize, duration_s: T) {
        let states = self.relaxation.modes.iter_mut();
        for (mode, (relaxing, log_rate)) in states.zip(MODES).take(modes) {
            let share = theta[relaxing];
            let decay = mode.decay.at(theta[log_rate], duration_s);
            let apart = shape.s - mode.relaxed;
            let lag = mode.by_log_rate * decay.mean + apart * (decay.mean - decay.decayed);
            mode.by_log_rate = decay.decayed * (mode.by_log_rate + decay.x * apart);
            let relaxed = decay.carry(&mut mode.relaxed, shape.s);
            self.force -= share * relaxed;
            self.gradient[EXPONENT] -=
                share * decay.carry(&mut mode.by_exponent, shape.by_exponent);
            self.gradient[SURFACE] -= share * decay.carry(&mut mode.by_surface, shape.by_surface);
            self.gradient[relaxing] = -relaxed;
            self.gradient[log_rate] = -(share * lag);
        }
    }

    /// Adds the damper. Outside the material there is no force; a block that two orders do not
    /// describe has no gradient, so that nothing is learned from it.
    fn damp(&mut self, theta: &Theta<T>, shape: &Shape<T>) {
        let damper = theta[DAMPING] * shape.damped;
        self.force = if shape.s > T::zero() {
            self.force + damper
        } else {
            T::zero()
        };
        if shape.narrow {
            self.gradient[STIFFNESS] = shape.s;
            self.gradient[DAMPING] = shape.damped;
            self.gradient[EXPONENT] += damper * shape.log;
            self.gradient[SURFACE] -= damper * theta[EXPONENT] * shape.damped_per_depth;
        } else {
            self.gradient = Theta::repeat(T::zero());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::identify::history::theta::SLOTS;
    use crate::physics::law::{Elastic, QuasiLinear, RelaxationMode, RelaxingLaw};
    use nalgebra::SVector;

    fn theta() -> Theta<f64> {
        SVector::from([2.0, 0.3, 1.6, 0.05, 0.6, -0.7, 0.4, 1.2])
    }

    /// A stroke and a hold in blocks of 8 ms.
    fn block(i: u32) -> Block<f64> {
        let angle = 0.05 * f64::from(i.min(60));
        Block {
            position: 2.0 * (1.0 - libm::cos(angle)) - 0.2,
            speed: 1.2 * libm::sin(angle),
            duration_s: 8e-3,
            position_variance: 1e-4,
            position_velocity_cov: 2e-4,
            count: 8.0,
            ..Block::default()
        }
    }

    #[test]
    fn the_gradient_is_that_of_the_force_with_its_memory() {
        let force = |theta: &Theta<f64>| {
            let mut relaxation = RelaxationState::default();
            let mut last = None;
            for i in 0..100 {
                let predicted = predict(theta, LawKind::QuasiLinear2, &relaxation, &block(i));
                relaxation = predicted.relaxation;
                last = Some(predicted);
            }
            last.unwrap()
        };
        let gradient = force(&theta()).gradient;
        for slot in 0..SLOTS {
            let moved = |by: f64| {
                let mut other = theta();
                other[slot] += by;
                force(&other).force
            };
            let slope = (moved(1e-5) - moved(-1e-5)) / 2e-5;
            // The derivative of the window's curvature by n and x₀ is left out: 1e-4 of 1e-4·s″/s.
            assert!(
                (gradient[slot] - slope).abs() < 2e-4 * slope.abs().max(1.0),
                "{slot}: {} {slope}",
                gradient[slot]
            );
        }
    }

    #[test]
    fn the_mean_force_of_a_block_is_that_of_the_law() {
        let law = QuasiLinear {
            elastic: Elastic::Power {
                stiffness_n_per_m: 2000.0,
                exponent: 1.6,
                reference_depth_m: 1e-3,
            },
            modes: [RelaxationMode {
                fraction: 0.3,
                rate_per_s: 2.0,
            }],
        };
        let theta = SVector::from([2.0, 0.0, 1.6, 0.0, 0.6, libm::log(2.0), 0.0, 0.0]);
        let (mut state, mut relaxation) = (law.at_rest(), RelaxationState::default());
        let depth = |t: f64| 3e-3 * (1.0 - libm::cos(6.0 * t)) / 2.0;
        for i in 0..200 {
            let (mut force, mut mean, mut square) = (0.0, 0.0, 0.0);
            for k in 1..=80 {
                // 0.1 ms each: the mean over the block of 8 ms.
                let d = depth(8e-3 * f64::from(i) + 1e-4 * f64::from(k));
                force += law.step(&mut state, d, 0.0, 1e-4) / 80.0;
                mean += d / 80e-3;
                square += d * d / 80e-6;
            }
            let predicted = predict(
                &theta,
                LawKind::QuasiLinear,
                &relaxation,
                &Block {
                    position: mean,
                    position_variance: square - mean * mean,
                    duration_s: 8e-3,
                    ..Block::default()
                },
            );
            relaxation = predicted.relaxation;
            // (νD)²/12 of what a block changes, and the shallow end of the stroke.
            assert!(
                (predicted.force - force).abs() < 2e-3,
                "{i}: {} {force}",
                predicted.force
            );
        }
    }
}
