//! The laws as the fit sees them: a vector of free numbers, the law that it means, and the force
//! along a course, for any scalar.
//!
//! The free numbers are scaled and transformed so that whatever they are the law is possible:
//! K = e^θ > 0, n = ½ + 3½/(1 + e^−θ) in ½…4, cᵢ = e^θᵢ/(1 + Σe^θⱼ) in (0, 1) with Σcᵢ < 1, νᵢ = e^θ > 0.
//! Damping stays linear and may come out negative: bounded, its standard error would be wrong where
//! there is none. Within the fit the reference depth is half of the depth reached, where K and n are
//! least correlated; K and λ are carried to δ₀ at the end, with their covariance.

//!
//! **Skew.** Force and position of one row are rarely of one instant: 1 ms between them makes the
//! damping of a stiff plastic wrong by 27–53 %. Under Hunt–Crossley the two differ in how they grow
//! with depth, so the delay of the force is a free number there, δ(t − τ) and δ̇(t − τ) to first order
//! in τ, with a prior of ±5 % of a sample period for motions that do not tell (a single ramp). Under
//! the other laws a delay is a damping or a fast mode, and stays 0.

use estimator_core::maths::scalar::Scalar;
use estimator_core::physics::law::{
    Elastic, HuntCrossley, KelvinVoigt, QuasiLinear, RelaxationMode, RelaxingLaw, Zener, unilateral,
};

use super::course::{Node, Scales};

/// Most relaxation modes.
pub const MOST_MODES: usize = 4;

/// Positions of the free numbers that all laws have.
pub(super) const SURFACE: usize = 0;
pub(super) const OFFSET: usize = 1;
pub(super) const STIFFNESS: usize = 2;

/// Where the skew of Hunt–Crossley stands.
const SKEW: usize = 5;
/// Its prior, in sample periods.
const SKEW_PRIOR: f64 = 0.05;

/// Smallest exponent, and the range above it.
const LEAST_EXPONENT: f64 = 0.5;
const EXPONENT_RANGE: f64 = 3.5;

/// A law, with the number of its relaxation modes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// F = Kδ + λδ̇, (1)
    KelvinVoigt,
    /// F = (Kδ₀ + λδ̇)(δ/δ₀)ⁿ, (3)
    HuntCrossley,
    /// F + λ/(κ₁+κ₂)·Ḟ = κ₁/(κ₁+κ₂)·(κ₂δ + λδ̇), (2)
    Zener,
    /// Kδ₀(δ/δ₀)ⁿ, relaxing in so many modes, (9)–(17)
    QuasiLinear(usize),
}

/// What the free numbers mean, in SI units at the fit's own reference depth.
#[derive(Clone, Copy, Debug)]
pub(super) struct Natural<S> {
    pub(super) surface_m: S,
    pub(super) offset_n: S,
    pub(super) stiffness: S,
    pub(super) damping: S,
    pub(super) exponent: S,
    pub(super) modes: [RelaxationMode<S>; MOST_MODES],
    /// How late the force is (s), and whether the law can tell.
    pub(super) skew_s: S,
    pub(super) skewed: bool,
    pub(super) reference_m: f64,
}

impl Family {
    /// The name in files.
    pub fn name(self) -> &'static str {
        match self {
            Family::KelvinVoigt => "kelvin_voigt",
            Family::HuntCrossley => "hunt_crossley",
            Family::Zener => "zener",
            Family::QuasiLinear(_) => "quasi_linear",
        }
    }

    /// Relaxation modes.
    pub fn modes(self) -> usize {
        match self {
            Family::QuasiLinear(modes) => modes,
            Family::Zener => 1,
            Family::KelvinVoigt | Family::HuntCrossley => 0,
        }
    }

    /// Free numbers of the fit: those of the law, and the force offset.
    pub fn free(self) -> usize {
        match self {
            Family::KelvinVoigt => 4,
            Family::HuntCrossley => 6,
            Family::Zener => 5,
            Family::QuasiLinear(modes) => 4 + 2 * modes,
        }
    }

    /// Where the skew stands among the free numbers.
    pub(super) fn skew(self) -> Option<usize> {
        (self == Family::HuntCrossley).then_some(SKEW)
    }

    /// Free numbers that are known before the fit: which, and 1/σ² around 0.
    pub(super) fn prior(self) -> Option<(usize, f64)> {
        Some((self.skew()?, SKEW_PRIOR.powi(-2)))
    }

    /// Where the exponent stands among the free numbers.
    pub(super) fn exponent(self) -> Option<usize> {
        match self {
            Family::HuntCrossley => Some(4),
            Family::QuasiLinear(_) => Some(3),
            Family::KelvinVoigt | Family::Zener => None,
        }
    }

    /// Where the damping stands among the free numbers.
    pub(super) fn damping(self) -> Option<usize> {
        matches!(self, Family::KelvinVoigt | Family::HuntCrossley).then_some(3)
    }

    /// Where fraction and rate of the modes begin.
    pub(super) fn first_mode(self) -> usize {
        match self {
            Family::QuasiLinear(_) => 4,
            _ => 3,
        }
    }

    /// Names and units of the parameters, in the order of `estimate.json`.
    pub fn parameters(self) -> Vec<(String, &'static str)> {
        let mut list = vec![("stiffness".to_string(), "N/m")];
        let damping = ("damping".to_string(), "N s/m");
        let exponent = ("exponent".to_string(), "1");
        match self {
            Family::KelvinVoigt => list.push(damping),
            Family::HuntCrossley => list.extend([damping, exponent]),
            Family::Zener => {
                list.push(("second_stiffness".into(), "N/m"));
                list.push(damping);
            }
            Family::QuasiLinear(modes) => {
                list.push(exponent);
                for mode in 1..=modes {
                    list.push((format!("relaxation_fraction_{mode}"), "1"));
                    list.push((format!("relaxation_rate_{mode}"), "1/s"));
                }
            }
        }
        list.push(("surface".into(), "m"));
        list
    }
}

/// n from its free number.
fn exponent_of<S: Scalar>(free: S) -> S {
    let one = S::one();
    S::from_f64(LEAST_EXPONENT) + S::from_f64(EXPONENT_RANGE) / (one + (-free).exp())
}

/// The free number of an exponent.
pub(super) fn free_of_exponent(exponent: f64) -> f64 {
    let share = ((exponent - LEAST_EXPONENT) / EXPONENT_RANGE).clamp(1e-6, 1.0 - 1e-6);
    (share / (1.0 - share)).ln()
}

/// The reference depth within the fit (m).
pub(super) fn reference_m(scales: &Scales) -> f64 {
    0.5 * scales.depth_m
}

/// The unit of damping within the fit (N s/m).
pub(super) fn damping_unit(scales: &Scales) -> f64 {
    scales.force_n
        / scales
            .speed_mps
            .max(1e-9 * scales.depth_m / scales.period_s)
}

/// What a vector of free numbers means.
pub(super) fn natural<S: Scalar>(family: Family, free: &[S], scales: &Scales) -> Natural<S> {
    let number = S::from_f64;
    let (nil, one) = (S::zero(), S::one());
    let reference_m = reference_m(scales);
    let mut modes = [RelaxationMode {
        fraction: nil,
        rate_per_s: one,
    }; MOST_MODES];
    let pairs = &free[family.first_mode()..];
    let used = family.modes();
    if used > 0 {
        let weights: [S; MOST_MODES] =
            std::array::from_fn(|i| if i < used { pairs[2 * i].exp() } else { nil });
        let sum = weights.into_iter().fold(one, |sum, weight| sum + weight);
        for (i, mode) in modes.iter_mut().enumerate().take(used) {
            mode.fraction = weights[i] / sum;
            mode.rate_per_s = pairs[2 * i + 1].exp();
        }
    }
    Natural {
        surface_m: number(scales.touch_m) + free[SURFACE] * number(scales.depth_m),
        offset_n: number(scales.rest_n) + free[OFFSET] * number(scales.force_n),
        stiffness: free[STIFFNESS].exp() * number(scales.force_n / reference_m),
        damping: family
            .damping()
            .map_or(nil, |at| free[at] * number(damping_unit(scales))),
        exponent: family.exponent().map_or(one, |at| exponent_of(free[at])),
        modes,
        skew_s: family
            .skew()
            .map_or(nil, |at| free[at] * number(scales.period_s)),
        skewed: family.skew().is_some(),
        reference_m,
    }
}

impl<S: Scalar> Natural<S> {
    /// The parameters in the order of [`Family::parameters`], at a reference depth of `depth_m`.
    pub(super) fn reported(&self, family: Family, depth_m: f64) -> Vec<S> {
        let ratio = S::from_f64(self.reference_m / depth_m);
        // K(δ₀) = K·(D/δ₀)^(1−n) and λ(δ₀) = λ·(D/δ₀)^(−n).
        let stiffness = self.stiffness * ratio.pow_positive(S::one() - self.exponent);
        match family {
            Family::KelvinVoigt => vec![self.stiffness, self.damping, self.surface_m],
            Family::HuntCrossley => {
                let damping = self.damping * ratio.pow_positive(-self.exponent);
                vec![stiffness, damping, self.exponent, self.surface_m]
            }
            Family::Zener => {
                let law = self.zener();
                vec![
                    law.stiffness_n_per_m,
                    law.second_stiffness_n_per_m,
                    law.damping_ns_per_m,
                    self.surface_m,
                ]
            }
            Family::QuasiLinear(modes) => {
                let mut list = vec![stiffness, self.exponent];
                for mode in &self.modes[..modes] {
                    list.extend([mode.fraction, mode.rate_per_s]);
                }
                list.push(self.surface_m);
                list
            }
        }
    }

    /// κ₁, κ₂ and λ of c = κ₁/(κ₁+κ₂) and ν = (κ₁+κ₂)/λ.
    fn zener(&self) -> Zener<S> {
        let [mode, ..] = self.modes;
        let sum = self.stiffness / mode.fraction;
        Zener {
            stiffness_n_per_m: self.stiffness,
            second_stiffness_n_per_m: sum - self.stiffness,
            damping_ns_per_m: sum / mode.rate_per_s,
        }
    }

    fn quasi_linear<const R: usize>(&self) -> QuasiLinear<S, R> {
        QuasiLinear {
            elastic: Elastic::Power {
                stiffness_n_per_m: self.stiffness,
                exponent: self.exponent,
                reference_depth_m: S::from_f64(self.reference_m),
            },
            modes: std::array::from_fn(|i| self.modes[i]),
        }
    }

    /// Elastic force (N): at once, without damping.
    pub(super) fn elastic_n(&self, depth_m: S) -> S {
        self.quasi_linear::<0>().elastic_n(depth_m)
    }

    /// What the load cell reads (N) of a surface that pushes and does not pull, max(law, 0) and the
    /// offset, at every node in turn. A law that remembers is below zero where the material has not
    /// recovered yet, and the probe is then free.
    pub(super) fn along(&self, family: Family, nodes: &[Node], mut each: impl FnMut(&Node, S)) {
        self.unsaturated(family, nodes, |node, force| {
            each(node, unilateral(force) + self.offset_n);
        });
    }

    /// Force of the law alone (N) at every node in turn.
    pub(super) fn unsaturated(&self, family: Family, nodes: &[Node], each: impl FnMut(&Node, S)) {
        match family {
            Family::KelvinVoigt => {
                let law = KelvinVoigt {
                    stiffness_n_per_m: self.stiffness,
                    damping_ns_per_m: self.damping,
                };
                self.run(&law, nodes, each);
            }
            Family::HuntCrossley => {
                let reference_m = S::from_f64(self.reference_m);
                let law =
                    HuntCrossley::new(self.stiffness, self.damping, self.exponent, reference_m);
                self.run(&law, nodes, each);
            }
            Family::Zener => self.run(&self.zener(), nodes, each),
            Family::QuasiLinear(1) => self.run(&self.quasi_linear::<1>(), nodes, each),
            Family::QuasiLinear(2) => self.run(&self.quasi_linear::<2>(), nodes, each),
            Family::QuasiLinear(3) => self.run(&self.quasi_linear::<3>(), nodes, each),
            Family::QuasiLinear(_) => self.run(&self.quasi_linear::<4>(), nodes, each),
        }
    }

    fn run<L: RelaxingLaw<S>>(&self, law: &L, nodes: &[Node], mut each: impl FnMut(&Node, S)) {
        let mut state = law.at_rest();
        for node in nodes {
            let number = S::from_f64;
            let mut depth_m = number(node.position_m) - self.surface_m;
            let mut speed = number(node.speed_mps);
            if self.skewed {
                depth_m = depth_m - speed * self.skew_s;
                speed = speed - number(node.acceleration_mps2) * self.skew_s;
            }
            let force_n = law.step(&mut state, depth_m, speed, number(node.period_s));
            each(node, force_n);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::course::Use;
    use super::*;
    use estimator_core::maths::Dual;

    const SCALES: Scales = Scales {
        touch_m: 1e-4,
        depth_m: 2e-3,
        force_n: 5.0,
        speed_mps: 0.02,
        rest_n: 0.3,
        noise_n: 0.02,
        position_noise_m: 3e-7,
        longest_s: 2.0,
        period_s: 1e-3,
    };

    fn sine() -> Vec<Node> {
        let node = |i: u32| {
            let t = 1e-2 * f64::from(i);
            Node {
                time_s: t,
                period_s: 1e-2,
                position_m: 1.2e-3 + 1.4e-3 * (6.0 * t).sin(),
                speed_mps: 8.4e-3 * (6.0 * t).cos(),
                acceleration_mps2: -0.05 * (6.0 * t).sin(),
                force_n: 0.0,
                count: 1.0,
                held: 1.0,
                used: Use::Contact(0),
            }
        };
        (0..300).map(node).collect()
    }

    fn check<const N: usize>(family: Family, free: [f64; N]) {
        assert_eq!(family.free(), N);
        let run = |free: &[f64]| {
            let mut forces = Vec::new();
            natural(family, free, &SCALES).along(family, &sine(), |_, force| forces.push(force));
            forces
        };
        let dual: [Dual<f64, N>; N] = std::array::from_fn(|i| Dual::parameter(free[i], i));
        let mut exact = Vec::new();
        natural(family, &dual, &SCALES).along(family, &sine(), |_, force| exact.push(force));
        for i in 0..N {
            let moved = |sign: f64| {
                let mut free = free;
                free[i] += sign * 1e-6;
                run(&free)
            };
            let pairs = moved(1.0).into_iter().zip(moved(-1.0)).zip(&exact);
            for ((up, down), exact) in pairs {
                let central = (up - down) / 2e-6;
                // Rounding over 1e-6, of 10 N.
                assert!(
                    (central - exact.gradient[i]).abs() < 1e-7,
                    "{family:?}, {i}: {central}"
                );
            }
        }
    }

    #[test]
    fn the_gradients_of_every_family_agree_with_central_differences() {
        check(Family::KelvinVoigt, [-0.03, 0.01, 0.1, 0.2]);
        check(Family::HuntCrossley, [-0.03, 0.01, 0.1, 0.2, -0.9, 0.3]);
        check(Family::Zener, [-0.03, 0.01, 0.1, -0.5, 1.0]);
        check(Family::QuasiLinear(1), [-0.03, 0.01, 0.1, -0.9, -0.5, 1.0]);
        let two = [-0.03, 0.01, 0.1, -0.9, -0.5, 1.0, -1.5, -0.7];
        check(Family::QuasiLinear(2), two);
    }

    #[test]
    fn whatever_the_free_numbers_the_law_is_possible() {
        for extreme in [-15.0, -3.0, 0.0, 3.0, 15.0] {
            let law = natural(Family::QuasiLinear(4), &[extreme; 12], &SCALES);
            assert!(law.stiffness > 0.0 && (0.5..=4.0).contains(&law.exponent));
            let sum: f64 = law.modes.iter().map(|mode| mode.fraction).sum();
            assert!(sum > 0.0 && sum < 1.0, "{extreme}: {sum}");
            assert!(law.modes.iter().all(|mode| mode.rate_per_s > 0.0));
        }
    }

    #[test]
    fn the_reference_depth_changes_the_numbers_and_not_the_force() {
        let free = [-0.03, 0.01, 0.1, 0.2, -0.9, 0.3];
        let law = natural(Family::HuntCrossley, &free, &SCALES);
        let force = |depth_m: f64| {
            let p = law.reported(Family::HuntCrossley, depth_m);
            HuntCrossley::new(p[0], p[1], p[2], depth_m).step(&mut (), 1.7e-3, 0.01, 1e-3)
        };
        assert!((force(1e-3) / force(1e-4) - 1.0).abs() < 1e-12);
    }
}
