//! The mean force of a law over a block, with its gradient and the relaxation that is carried on.
//!
//! With s = ((x − x₀)/δ₀)ⁿ and w the speed, scaled,
//!
//! F = K·s + λ·s·w − ΣBᵢzᵢ, żᵢ = νᵢ(s − zᵢ),
//!
//! which is (10)–(17) for λ = 0 and Bᵢ = Kcᵢ, Hunt–Crossley (3) for B = 0, Zener (2) for n = 1 and
//! λ = 0. z is carried over a block exactly for an s that changes evenly over it, and so are its derivatives by n,
//! x₀ and ln ν, so that the gradient is that of the force. (With the mean of s alone the force of blocks of 0.4 time
//! constants was eight times as far off.)

use super::block::Block;
use super::theta::{DAMPING, EXPONENT, MODES, STIFFNESS, SURFACE, Theta, modes};
use crate::maths::scalar::Real;
use crate::physics::law::LawKind;

/// Below this share of a time constant a series gives how an even change is followed.
const SHORT: f64 = 0.12;
/// No block is a smaller share of a time constant: the slowest mode is e⁻⁹/s, and a sample lasts 50 µs.
const SHORTEST: f64 = 6e-9;
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
    /// ½(1 + e^{−x}) − (1 − e^{−x})/x: what a change of the input by 1, evenly over the duration, adds to the end.
    change: T,
    /// Its derivative by ln ν.
    change_by_log_rate: T,
}

impl<T: Real> Decay<T> {
    fn at(&mut self, log_rate: T, duration_s: T) -> Self {
        if self.log_rate != log_rate || self.duration_s != duration_s || self.mean == T::zero() {
            let x = log_rate.exp() * duration_s;
            let (decayed, mean) = ((-x).exp(), (-x).exprel());
            let half = T::from_f64(0.5);
            let (change, change_by_log_rate) = match x < T::from_f64(SHORT) {
                // The next terms, x⁴/80 and x⁴/20, are 3·10⁻⁶ and 10⁻⁵ here; beyond, the differences have four digits.
                true => {
                    let twelfth = x * x * T::from_f64(1.0 / 12.0);
                    let (slower, twice) = (T::one() - half * x, T::from_f64(2.0));
                    (twelfth * slower, twelfth * (twice * slower - half * x))
                }
                false => (
                    half * (T::one() + decayed) - mean,
                    mean - decayed * (T::one() + half * x),
                ),
            };
            *self = Decay {
                log_rate,
                duration_s,
                x,
                decayed,
                mean,
                change,
                change_by_log_rate,
            };
        }
        *self
    }

    /// Carries a state over the duration at an input with a mean that rises evenly; returns the state's mean.
    fn carry(&self, state: &mut T, input: T, rise: T) -> T {
        let away = *state - input;
        let more = self.change * rise;
        *state = input + away * self.decayed + more;
        // ż = ν(s − z) over the whole block: what is more at the end was less in the mean.
        input + away * self.mean - more / self.x.max_of(T::from_f64(SHORTEST))
    }

    /// What the rise adds to the derivatives of end and mean by ln ν.
    fn by_log_rate(&self, rise: T) -> (T, T) {
        let less = self.change - self.change_by_log_rate;
        let mean = less * rise / self.x.max_of(T::from_f64(SHORTEST));
        (self.change_by_log_rate * rise, mean)
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
    /// By how much s changes over the block, if it does so evenly, and its derivatives by n and x₀.
    rise: T,
    rise_by_exponent: T,
    rise_by_surface: T,
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
        let variance = block.position_variance;
        if depth <= T::zero() || variance >= T::from_f64(WIDEST) * depth * depth {
            return Shape::wide(exponent, depth, block);
        }
        let log = depth.ln();
        let power = (exponent * log).exp();
        let per_depth = T::one() / depth;
        let second = T::from_f64(0.5) * exponent * (exponent - T::one());
        let s = power * (T::one() + second * variance * per_depth * per_depth);
        let slope = exponent * s * per_depth;
        // An even motion over a way w has the variance w²/12.
        let way = (T::from_f64(12.0) * variance).sqrt();
        let rise = if block.speed > T::zero() {
            slope * way
        } else {
            -(slope * way)
        };
        Shape {
            s,
            rise,
            rise_by_exponent: rise * (log + T::one() / exponent),
            rise_by_surface: -(rise * (exponent - T::one()) * per_depth),
            by_exponent: s * log,
            by_surface: -slope,
            damped: s * block.speed + power * exponent * block.position_velocity_cov * per_depth,
            log,
            damped_per_depth: per_depth,
            narrow: true,
        }
    }

    /// Of a block that begins or ends near the surface, or on its other side, as of an even motion: it is nothing to learn
    /// from, and a material that relaxes remembers it. With the mean depth alone, a surface in the middle of a block of
    /// 40 ms left a mode of 30/s 6 % too slow.
    fn wide(exponent: T, depth: T, block: &Block<T>) -> Self {
        let half = (T::from_f64(3.0) * block.position_variance).sqrt();
        let (shallow, deep) = (T::zero().max_of(depth - half), depth + half);
        // Nothing is known of the motion within a flight.
        if deep <= T::zero() || half <= T::zero() || block.count < T::zero() {
            return Shape::default();
        }
        let more = exponent + T::one();
        let per_way = T::one() / (half + half);
        let (deep, shallow) = (Power::of(deep, exponent), Power::of(shallow, exponent));
        let s = (deep.integral - shallow.integral) * per_way / more;
        let by_exponent = (deep.by_exponent - shallow.by_exponent) * per_way;
        let (rise, slope) = (
            deep.value - shallow.value,
            (deep.value - shallow.value) * per_way,
        );
        let sign = if block.speed > T::zero() {
            T::one()
        } else {
            -T::one()
        };
        Shape {
            s,
            by_exponent: by_exponent / more - s / more,
            by_surface: -slope,
            damped: s * block.speed + slope * block.position_velocity_cov,
            rise: sign * rise,
            rise_by_exponent: sign * (deep.log_value - shallow.log_value),
            rise_by_surface: -(sign * exponent * (deep.per_depth - shallow.per_depth)),
            ..Shape::default()
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

/// dⁿ at one end of a block.
#[derive(Default)]
struct Power<T> {
    value: T,
    /// dⁿ⁺¹
    integral: T,
    /// dⁿ ln d
    log_value: T,
    /// dⁿ⁺¹ ln d
    by_exponent: T,
    /// dⁿ⁻¹
    per_depth: T,
}

impl<T: Real> Power<T> {
    fn of(depth: T, exponent: T) -> Self {
        if depth <= T::zero() {
            return Power::default();
        }
        let log = depth.ln();
        let value = (exponent * log).exp();
        Power {
            value,
            integral: value * depth,
            log_value: value * log,
            by_exponent: value * depth * log,
            per_depth: value / depth,
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
            let (end, mean) = decay.by_log_rate(shape.rise);
            let lag = mode.by_log_rate * decay.mean + apart * (decay.mean - decay.decayed) + mean;
            mode.by_log_rate = decay.decayed * (mode.by_log_rate + decay.x * apart) + end;
            let relaxed = decay.carry(&mut mode.relaxed, shape.s, shape.rise);
            let (exponent, surface) = (&mut mode.by_exponent, &mut mode.by_surface);
            let by_exponent = decay.carry(exponent, shape.by_exponent, shape.rise_by_exponent);
            let by_surface = decay.carry(surface, shape.by_surface, shape.rise_by_surface);
            self.force -= share * relaxed;
            self.gradient[EXPONENT] -= share * by_exponent;
            self.gradient[SURFACE] -= share * by_surface;
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
        gradient_is_that_of_the_force(block, 2e-4);
        // In blocks of 0.2 s, 0.7 time constants of the faster mode, that move by a twentieth of the depth.
        let slow = |i: u32| Block {
            duration_s: 0.2,
            position_variance: 1e-3,
            ..block(i)
        };
        gradient_is_that_of_the_force(slow, 2e-3);
    }

    fn gradient_is_that_of_the_force(block: impl Fn(u32) -> Block<f64>, within: f64) {
        let force = |theta: &Theta<f64>| {
            let mut relaxation = RelaxationState::default();
            let mut last = None;
            // Until the end of the stroke, and into the hold.
            for i in 0..70 {
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
                (gradient[slot] - slope).abs() < within * slope.abs().max(1.0),
                "{slot}: {} {slope}",
                gradient[slot]
            );
        }
    }

    /// How far the force of a mode of 2/s is off, at most, over a stroke whose blocks have `samples` of 0.1 ms each.
    fn error_over_blocks(samples: u32, rad_per_s: f64) -> f64 {
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
        let depth = |t: f64| 3e-3 * (1.0 - libm::cos(rad_per_s * t)) / 2.0;
        let (count, duration_s) = (f64::from(samples), 1e-4 * f64::from(samples));
        let mut largest = 0.0_f64;
        for i in 0..(1.6 * 6.0 / rad_per_s / duration_s) as u32 {
            let (mut force, mut mean, mut square) = (0.0, 0.0, 0.0);
            let from_s = duration_s * f64::from(i);
            for k in 1..=samples {
                let d = depth(from_s + 1e-4 * f64::from(k));
                force += law.step(&mut state, d, 0.0, 1e-4) / count;
                mean += d / count / 1e-3;
                square += d * d / count / 1e-6;
            }
            let predicted = predict(
                &theta,
                LawKind::QuasiLinear,
                &relaxation,
                &Block {
                    position: mean,
                    position_variance: square - mean * mean,
                    speed: libm::sin(rad_per_s * (from_s + 0.5 * duration_s)),
                    duration_s,
                    ..Block::default()
                },
            );
            relaxation = predicted.relaxation;
            largest = largest.max((predicted.force - force).abs());
        }
        largest
    }

    /// Blocks of 40 ms, 1.2 time constants of the mode, of which the first is half outside.
    #[test]
    fn a_block_across_the_surface_is_remembered_from_the_surface_on() {
        let law = QuasiLinear {
            elastic: Elastic::Power {
                stiffness_n_per_m: 2000.0,
                exponent: 1.2,
                reference_depth_m: 1e-3,
            },
            modes: [RelaxationMode {
                fraction: 0.3,
                rate_per_s: 30.0,
            }],
        };
        let theta = SVector::from([2.0, 0.0, 1.2, 0.0, 0.6, libm::log(30.0), 0.0, 0.0]);
        let (mut state, mut relaxation) = (law.at_rest(), RelaxationState::default());
        let mut off = 0.0;
        for from in [-0.5, 0.5, 1.5] {
            // 1 mm a block.
            let inside = |k: u32| 1e-3 * (from + (f64::from(k) + 0.5) / 400.0);
            let forces = (0..400).map(|k| law.step(&mut state, inside(k), 0.025, 1e-4));
            let force = forces.sum::<f64>() / 400.0;
            let block = Block {
                position: from + 0.5,
                position_variance: 1.0 / 12.0,
                speed: 1.0,
                duration_s: 0.04,
                ..Block::default()
            };
            let predicted = predict(&theta, LawKind::QuasiLinear, &relaxation, &block);
            relaxation = predicted.relaxation;
            off = (predicted.force - force) / force;
        }
        // 1.1 % where the mode began in the middle of the block that is half outside.
        assert!(off.abs() < 3e-3, "{off}");
    }

    #[test]
    fn the_mean_force_of_a_block_is_that_of_the_law() {
        // Of up to 11.6 N: in blocks of 8 ms, at the shallow end of the stroke,
        let fast = error_over_blocks(80, 6.0);
        assert!(fast < 1e-4, "{fast}");
        // and in those of a slow one, of 0.2 s each, 0.4 time constants of the mode: 0.8 mN where only the mean is seen.
        let slow = error_over_blocks(2000, 0.3);
        assert!(slow < 2e-4, "{slow}");
    }
}
