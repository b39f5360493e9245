//! All laws at once, and recursive Gauss–Newton on whichever parameters a law has.
//!
//! θ = (K, λ, n, x₀, B₁, ln ν₁, B₂, ln ν₂), scaled, and with s = ((x − x₀)/δ₀)ⁿ, w the speed
//!
//! F = K·s + λ·s·w − ΣBᵢzᵢ, żᵢ = νᵢ(s − zᵢ),
//!
//! which is (10)–(17) for λ = 0 and Bᵢ = Kcᵢ, Hunt–Crossley (3) for B = 0, Zener (2) for n = 1 and
//! λ = 0. z is carried over a block exactly for the block's mean of s, and so are its derivatives by
//! n, x₀ and ln ν, so that the gradient is that of the force.
//!
//! A short contact tells the product of B and ν, not the two: a step that is straight in both leaves
//! the valley. So each step of Gauss–Newton is two passes: one that finds K, λ and B for the n, x₀ and
//! ν of the reference, exactly, since the force is linear in them, and says what these three cost at
//! best; and one for all of θ from there (variable projection, Golub & Pereyra 1973).

use nalgebra::SVector;

use super::course::Block;
use crate::estimate::rls::Ud;
use crate::maths::scalar::Real;
use crate::physics::law::LawKind;

/// Parameters of all laws together.
pub(super) const SLOTS: usize = 8;
pub(super) const STIFFNESS: usize = 0;
pub(super) const DAMPING: usize = 1;
pub(super) const EXPONENT: usize = 2;
pub(super) const SURFACE: usize = 3;
/// B and ln ν of the two modes.
pub(super) const MODES: [(usize, usize); 2] = [(4, 5), (6, 7)];

/// θ
pub(super) type Theta<T> = SVector<T, SLOTS>;

/// Bounds of n and of ln ν: no step makes a power that single precision cannot hold.
const EXPONENTS: (f64, f64) = (0.3, 4.0);
const LOG_RATES: (f64, f64) = (-9.0, 4.5);
/// Bounds of B/K.
const FRACTIONS: (f64, f64) = (0.003, 0.99);
/// Prior standard deviations of n and ln ν, and of K, λ and B over K.
const PRIOR_EXPONENT: f64 = 0.2;
const PRIOR_LOG_RATE: f64 = 0.7;
const PRIOR_LINEAR: f64 = 0.5;
/// The same of a pass that finds K, λ and B alone.
const PRIOR_PROJECTED: f64 = 3.0;
/// Longest step in n, in ln ν, and in x₀ over its prior standard deviation.
const LONGEST_EXPONENT: f64 = 0.3;
const LONGEST_LOG_RATE: f64 = 1.1;
const LONGEST_SURFACE: f64 = 2.0;
/// Largest variance of the position in a block, over the square of the depth.
const WIDEST: f64 = 0.04;
/// Standard deviations beyond which an error loses weight (Huber 1964).
const HUBER: f64 = 5.0;
/// A block is worth no more than this many samples: what its position is off by is the same for all
/// of them (1 µm of encoder steps on 6 N/mm are 2 mN, what is left of 20 mN by a mean of 100).
const MOST_COUNTED: f64 = 100.0;
/// Largest standard error of ln ν over which a gradient holds.
const STRAIGHT: f64 = 0.2;
/// Memory of the recent errors (blocks).
const RECENT: f64 = 16.0;

/// What a mode remembers: z and its derivatives by n, x₀ and ln ν.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Mode<T> {
    relaxed: T,
    by_exponent: T,
    by_surface: T,
    by_log_rate: T,
    pace: Pace<T>,
}

/// What a duration does to a mode; most blocks in motion last equally long, and exponentials are
/// half of what a block costs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Pace<T> {
    log_rate: T,
    duration_s: T,
    /// ν·duration, e^{−x} and (1 − e^{−x})/x.
    x: T,
    decayed: T,
    mean: T,
}

impl<T: Real> Pace<T> {
    fn at(&mut self, log_rate: T, duration_s: T) -> Self {
        if self.log_rate != log_rate || self.duration_s != duration_s || self.mean == T::zero() {
            let x = log_rate.exp() * duration_s;
            *self = Pace {
                log_rate,
                duration_s,
                x,
                decayed: (-x).exp(),
                mean: (-x).exprel(),
            };
        }
        *self
    }
}

/// What a contact remembers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Memory<T> {
    modes: [Mode<T>; 2],
}

impl<T: Real> Memory<T> {
    /// That of a neighbouring θ, to first order.
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

/// Mean force of a block, its gradient, and the memory at its end.
#[derive(Clone, Copy, Debug)]
pub(super) struct Predicted<T: Real> {
    pub(super) force: T,
    pub(super) gradient: Theta<T>,
    pub(super) memory: Memory<T>,
}

/// s, its derivatives by n and x₀, and s·w: means over a block.
struct Shape<T> {
    s: T,
    by_exponent: T,
    by_surface: T,
    damped: T,
    log: T,
    /// 1/depth as far as the damper depends on it.
    damped_per_depth: T,
    /// Whether two orders of the power describe the block.
    narrow: bool,
}

impl<T: Real> Shape<T> {
    fn of(theta: &Theta<T>, block: &Block<T>) -> Self {
        let exponent = theta[EXPONENT];
        let depth = block.position - theta[SURFACE];
        if depth <= T::zero() {
            return Shape {
                s: T::zero(),
                by_exponent: T::zero(),
                by_surface: T::zero(),
                damped: T::zero(),
                log: T::zero(),
                damped_per_depth: T::zero(),
                narrow: false,
            };
        }
        let log = depth.ln();
        let power = (exponent * log).exp();
        let per_depth = T::one() / depth;
        let narrow = block.position_variance < T::from_f64(WIDEST) * depth * depth;
        let curve = if narrow {
            T::from_f64(0.5)
                * exponent
                * (exponent - T::one())
                * block.position_variance
                * per_depth
                * per_depth
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
}

impl<T: Real> Shape<T> {
    /// The damper of Kelvin–Voigt (1), which takes no part in the depth.
    fn with_plain_damper(self, speed: T) -> Self {
        let inside = self.s > T::zero();
        Shape {
            damped: if inside { speed } else { T::zero() },
            damped_per_depth: T::zero(),
            ..self
        }
    }
}

/// F̂ of a law and its gradient over a block.
pub(super) fn predict<T: Real>(
    theta: &Theta<T>,
    law: LawKind,
    memory: &Memory<T>,
    block: &Block<T>,
) -> Predicted<T> {
    let shape = match law {
        LawKind::KelvinVoigt => Shape::of(theta, block).with_plain_damper(block.speed),
        _ => Shape::of(theta, block),
    };
    let mut memory = *memory;
    let stiffness = theta[STIFFNESS];
    let mut force = stiffness * shape.s;
    let mut by_exponent = stiffness * shape.by_exponent;
    let mut by_surface = stiffness * shape.by_surface;
    let mut gradient = Theta::<T>::repeat(T::zero());
    for (mode, (relaxing, log_rate)) in memory.modes.iter_mut().zip(MODES).take(modes(law)) {
        let share = theta[relaxing];
        let Pace {
            x, decayed, mean, ..
        } = mode.pace.at(theta[log_rate], block.duration_s);
        let apart = shape.s - mode.relaxed;
        let lag = mode.by_log_rate * mean + apart * (mean - decayed);
        mode.by_log_rate = decayed * (mode.by_log_rate + x * apart);
        let carry = |state: &mut T, input: T| {
            let away = *state - input;
            *state = input + away * decayed;
            input + away * mean
        };
        let relaxed = carry(&mut mode.relaxed, shape.s);
        force -= share * relaxed;
        by_exponent -= share * carry(&mut mode.by_exponent, shape.by_exponent);
        by_surface -= share * carry(&mut mode.by_surface, shape.by_surface);
        gradient[relaxing] = -relaxed;
        gradient[log_rate] = -(share * lag);
    }
    let damping = theta[DAMPING];
    let damper = damping * shape.damped;
    force = if shape.s > T::zero() {
        force + damper
    } else {
        T::zero()
    };
    if shape.narrow {
        gradient[STIFFNESS] = shape.s;
        gradient[DAMPING] = shape.damped;
        gradient[EXPONENT] = by_exponent + damper * shape.log;
        gradient[SURFACE] = by_surface - damper * theta[EXPONENT] * shape.damped_per_depth;
    } else {
        gradient = Theta::repeat(T::zero());
    }
    Predicted {
        force,
        gradient,
        memory,
    }
}

/// Relaxation modes of a law.
pub(super) fn modes(law: LawKind) -> usize {
    match law {
        LawKind::KelvinVoigt | LawKind::HuntCrossley | LawKind::HuntCrossleySkew => 0,
        LawKind::Zener | LawKind::QuasiLinear => 1,
        LawKind::QuasiLinear2 => 2,
    }
}

/// Which of θ a law has: (λ, n), and K and x₀ always.
fn has(law: LawKind) -> (bool, bool) {
    match law {
        LawKind::KelvinVoigt => (true, false),
        // The skew is no parameter here: no method over a history has it.
        LawKind::HuntCrossley | LawKind::HuntCrossleySkew => (true, true),
        LawKind::Zener => (false, false),
        LawKind::QuasiLinear | LawKind::QuasiLinear2 => (false, true),
    }
}

/// How many parameters a law has.
pub(super) fn parameters(law: LawKind) -> usize {
    law.parameters().len()
}

/// θ within its bounds, and 0 or 1 where the law says so.
pub(super) fn bounded<T: Real>(law: LawKind, mut theta: Theta<T>) -> Theta<T> {
    let within = |value: T, (low, high): (f64, f64)| {
        let raised = T::from_f64(low).max_of(value);
        let high = T::from_f64(high);
        if raised > high { high } else { raised }
    };
    let (damps, curves) = has(law);
    if !damps {
        theta[DAMPING] = T::zero();
    }
    theta[EXPONENT] = if curves {
        within(theta[EXPONENT], EXPONENTS)
    } else {
        T::one()
    };
    let mut left = FRACTIONS.1;
    for (index, (relaxing, log_rate)) in MODES.into_iter().enumerate() {
        let stiffness = theta[STIFFNESS];
        let share = within(theta[relaxing] / stiffness, (FRACTIONS.0, left));
        let has = index < modes(law) && share.is_finite();
        theta[relaxing] = if has { share * stiffness } else { T::zero() };
        if has {
            left = FRACTIONS.0.max(left - share.to_f64());
        }
        theta[log_rate] = within(theta[log_rate], LOG_RATES);
    }
    theta
}

/// One pass of Gauss–Newton over the blocks, at a reference that stays.
///
/// The covariance is in units of the prior standard deviations and of the noise of the raw force, so
/// that P(0) = I.
#[derive(Clone, Debug)]
pub(super) struct Fit<T: Real> {
    law: LawKind,
    reference: Theta<T>,
    /// (θ − reference)/prior
    deviation: Theta<T>,
    prior: Theta<T>,
    covariance: Ud<T, SLOTS>,
    memory: Memory<T>,
    /// Number of the next block.
    next: u32,
    /// Σ of squared errors at the reference, and of what is left of them, over their variance.
    cost: T,
    left: T,
    blocks: T,
    recent: T,
    informed: bool,
}

impl<T: Real> Fit<T> {
    /// Knows nothing; `surface_error` is the prior standard deviation of x₀, 0 if it is known.
    pub(super) fn new(law: LawKind, reference: &Theta<T>, surface_error: T) -> Self {
        let reference = bounded(law, *reference);
        let (damps, curves) = has(law);
        let only = |is: bool, value: T| if is { value } else { T::zero() };
        let linear = T::from_f64(PRIOR_LINEAR) * reference[STIFFNESS];
        let mut prior = Theta::<T>::repeat(T::zero());
        prior[STIFFNESS] = linear;
        prior[DAMPING] = only(damps, linear);
        prior[EXPONENT] = only(curves, T::from_f64(PRIOR_EXPONENT));
        prior[SURFACE] = surface_error;
        for (relaxing, log_rate) in MODES.into_iter().take(modes(law)) {
            prior[relaxing] = linear;
            prior[log_rate] = T::from_f64(PRIOR_LOG_RATE);
        }
        Fit {
            law,
            reference,
            deviation: Theta::repeat(T::zero()),
            prior,
            covariance: Ud::new(T::one()),
            memory: Memory::default(),
            next: 0,
            cost: T::zero(),
            left: T::zero(),
            blocks: T::zero(),
            recent: T::one(),
            informed: false,
        }
    }

    /// A pass at another reference, that knows what this fit knew where it stands.
    pub(super) fn again(&self, law: LawKind, reference: &Theta<T>, surface_error: T) -> Self {
        let mut fit = Fit::new(law, reference, surface_error);
        fit.memory = self.memory.moved(&(fit.reference - self.reference));
        fit.next = self.next;
        if self.informed && self.law == law {
            let away = self.reference + self.deviation.component_mul(&self.prior) - fit.reference;
            fit.deviation = away.zip_map(&self.prior, |away, prior| {
                if prior > T::zero() {
                    away / prior
                } else {
                    T::zero()
                }
            });
            fit.prior = self.prior;
            fit.covariance = self.covariance.clone();
            fit.informed = true;
        }
        fit
    }

    /// The same for K, λ and B alone.
    pub(super) fn projected(&self, law: LawKind, reference: &Theta<T>) -> Self {
        let mut fit = Fit::new(law, reference, T::zero());
        fit.memory = self.memory.moved(&(fit.reference - self.reference));
        fit.next = self.next;
        fit.prior *= T::from_f64(PRIOR_PROJECTED / PRIOR_LINEAR);
        fit.prior[EXPONENT] = T::zero();
        for (_, log_rate) in MODES {
            fit.prior[log_rate] = T::zero();
        }
        fit
    }

    /// Takes a block that may be learned from or not; `beta` is the forgetting factor.
    pub(super) fn absorb(&mut self, block: &Block<T>, noise_raw: T, beta: T) {
        self.next = self.next.wrapping_add(1);
        let there = predict(&self.reference, self.law, &self.memory, block);
        self.memory = there.memory;
        if block.count <= T::zero() || there.gradient[STIFFNESS] == T::zero() {
            return;
        }
        let per_count = T::one() / block.count + T::from_f64(1.0 / MOST_COUNTED);
        let per_sigma = T::one() / (noise_raw * per_count.sqrt());
        let phi = there.gradient.component_mul(&self.prior) * per_sigma;
        let at_reference = (block.force - there.force) * per_sigma;
        let error = at_reference - phi.dot(&self.deviation);
        let weight = self.weight(error, &phi);
        let update = self.covariance.update(&phi, beta, weight);
        self.deviation += update.gain * error;
        let after = error - phi.dot(&update.gain) * error;
        self.cost += robust(at_reference);
        self.left += weight * error * after;
        self.blocks += T::one();
        let share = T::from_f64(1.0 / RECENT);
        self.recent += share * (after * after - self.recent);
        self.informed = true;
    }

    /// 1, or less for an error that is not to be expected.
    fn weight(&self, error: T, phi: &Theta<T>) -> T {
        let size = error.abs();
        let usual = T::one().max_of(self.recent);
        if size * size <= T::from_f64(HUBER * HUBER) * usual {
            return T::one();
        }
        let model = self.covariance.variance(phi);
        let expected = T::from_f64(HUBER) * (usual + model).sqrt();
        if size > expected {
            expected / size
        } else {
            T::one()
        }
    }

    /// Takes a block for its memory only.
    pub(super) fn pass(&mut self, block: &Block<T>) {
        self.next = self.next.wrapping_add(1);
        self.memory = predict(&self.reference, self.law, &self.memory, block).memory;
    }

    pub(super) fn law(&self) -> LawKind {
        self.law
    }

    pub(super) fn next(&self) -> u32 {
        self.next
    }

    pub(super) fn blocks(&self) -> T {
        self.blocks
    }

    pub(super) fn reference(&self) -> Theta<T> {
        self.reference
    }

    /// θ̂
    pub(super) fn values(&self) -> Theta<T> {
        bounded(
            self.law,
            self.reference + self.deviation.component_mul(&self.prior),
        )
    }

    /// θ̂, or as far towards it as a step may go.
    pub(super) fn stepped(&self, surface_error: T) -> Theta<T> {
        let to = self.values();
        let step = to - self.reference;
        let [(_, fast), (_, slow)] = MODES;
        let longest = [
            (EXPONENT, T::from_f64(LONGEST_EXPONENT)),
            (SURFACE, T::from_f64(LONGEST_SURFACE) * surface_error),
            (fast, T::from_f64(LONGEST_LOG_RATE)),
            (slow, T::from_f64(LONGEST_LOG_RATE)),
        ];
        let mut share = T::one();
        for (slot, longest) in longest {
            let size = step.get(slot).copied().unwrap_or_default().abs();
            if size * share > longest {
                share = longest / size;
            }
        }
        bounded(self.law, self.reference + step * share)
    }

    /// Begins with this block.
    pub(super) fn starts_at(&mut self, block: u32) {
        self.next = block;
    }

    /// Knows something of what has left the history.
    pub(super) fn is_informed(&self) -> bool {
        self.informed
    }

    /// The memory that goes with [`Fit::values`].
    pub(super) fn memory(&self) -> Memory<T> {
        self.memory.moved(&(self.values() - self.reference))
    }

    /// Variance of a quantity from its gradient by θ; of a force, without the noise.
    pub(super) fn variance(&self, gradient: &Theta<T>) -> T {
        self.covariance
            .variance(&gradient.component_mul(&self.prior))
    }

    /// Standard errors of θ̂.
    pub(super) fn std_errors(&self) -> Theta<T> {
        let variances = self.covariance.variances();
        self.prior
            .zip_map(&variances, |prior, variance| prior * variance.sqrt())
    }

    /// Mean squared error at the reference over its variance.
    pub(super) fn cost(&self) -> T {
        self.cost / self.blocks.max_of(T::one())
    }

    /// Mean of what is left.
    pub(super) fn left(&self) -> T {
        self.left / self.blocks.max_of(T::one())
    }

    /// How far it is from its reference, in standard errors.
    pub(super) fn step(&self) -> T {
        let variances = self.covariance.variances();
        let mut most = T::zero();
        for (deviation, variance) in self.deviation.iter().zip(variances.iter()) {
            if *variance > T::zero() {
                most = most.max_of(deviation.abs() / variance.sqrt());
            }
        }
        most
    }

    /// Whether its gradient holds over its standard errors.
    pub(super) fn is_straight(&self) -> bool {
        let errors = self.std_errors();
        MODES.into_iter().all(|(_, log_rate)| {
            let error = errors.get(log_rate).copied().unwrap_or_default();
            error < T::from_f64(STRAIGHT)
        })
    }

    /// The values can be a contact: finite, and a spring that pushes.
    pub(super) fn is_sound(&self) -> bool {
        let values = self.reference + self.deviation.component_mul(&self.prior);
        values.iter().all(|value| value.is_finite())
            && values[STIFFNESS] > T::zero()
            && self.left.is_finite()
            && self.cost.is_finite()
    }
}

/// e² near zero, 2·HUBER·|e| far from it.
fn robust<T: Real>(error: T) -> T {
    let (size, bend) = (error.abs(), T::from_f64(HUBER));
    if size > bend {
        bend * (size + size - bend)
    } else {
        size * size
    }
}

#[cfg(test)]
mod tests {
    use super::*;
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
            let mut memory = Memory::default();
            let mut last = None;
            for i in 0..100 {
                let predicted = predict(theta, LawKind::QuasiLinear2, &memory, &block(i));
                memory = predicted.memory;
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
        let (mut state, mut memory) = (law.at_rest(), Memory::default());
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
                &memory,
                &Block {
                    position: mean,
                    position_variance: square - mean * mean,
                    duration_s: 8e-3,
                    ..Block::default()
                },
            );
            memory = predicted.memory;
            // (νD)²/12 of what a block changes, and the shallow end of the stroke.
            assert!(
                (predicted.force - force).abs() < 2e-3,
                "{i}: {} {force}",
                predicted.force
            );
        }
    }
}
