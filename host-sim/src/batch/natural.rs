//! What a vector of free numbers means: a law with its surface, and its force along a course, for any scalar.
//!
//! The free numbers are scaled and transformed so that whatever they are the law is possible:
//! K = e^θ > 0, n = ½ + 3½/(1 + e^−θ) in ½…4, cᵢ = e^θᵢ/(1 + Σe^θⱼ) in (0, 1) with Σcᵢ < 1, νᵢ = e^θ > 0.
//! An exponential response (m/b)(e^{bδ} − 1) has bD = e^θ in place of n, and its K is the secant stiffness
//! at the reference depth of the fit as that of a power is; m and b are reported. Damping stays linear and
//! may come out negative: bounded, its standard error would be wrong where there is none. Within the fit
//! the reference depth is half of the depth reached, where K and n are least correlated; K and λ are
//! carried to δ₀ at the end, with their covariance.

use estimator_core::maths::scalar::Scalar;
use estimator_core::physics::law::{
    Elastic, Law, LawId, MOST_MODES, ParameterInfo, RELAXATION, Recovery, RelaxationMode,
    RelaxingLaw, Zener, unilateral,
};

use super::blocks::Node;
use super::family::{Family, Form, OFFSET, STIFFNESS, SURFACE};
use super::low_pass::LowPass;
use super::scales::Scales;

/// Smallest exponent, and the range above it.
const LEAST_EXPONENT: f64 = 0.5;
const EXPONENT_RANGE: f64 = 3.5;

/// What the free numbers mean, in SI units at the reference depth of the fit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Natural<S> {
    pub(super) surface_m: S,
    pub(super) offset_n: S,
    pub(super) stiffness: S,
    pub(super) damping: S,
    pub(super) exponent: S,
    /// b (1/m) of an exponential response.
    pub(super) stiffening_rate: S,
    pub(super) modes: [RelaxationMode<S>; MOST_MODES],
    /// How late the force is (s), and whether the law can tell.
    pub(super) skew_s: S,
    pub(super) skewed: bool,
    /// What its surface does between touches.
    pub(super) recovery: Recovery,
    pub(super) reference_m: f64,
    /// What its force went through before it was logged.
    pub(super) low_pass: Option<LowPass>,
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
    let used = family.modes;
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
        stiffening_rate: family
            .stiffening_rate()
            .map_or(nil, |at| free[at].exp() / number(scales.depth_m)),
        modes,
        skew_s: family
            .skew()
            .map_or(nil, |at| free[at] * number(scales.period_s)),
        skewed: family.skew().is_some(),
        recovery: family.recovery,
        reference_m,
        low_pass: scales.low_pass,
    }
}

impl<S: Scalar> Natural<S> {
    /// The parameters in the order of [`Family::parameters`], at a reference depth of `depth_m`.
    pub(super) fn reported(&self, family: Family, depth_m: f64) -> Vec<S> {
        let ratio = S::from_f64(self.reference_m / depth_m);
        let scaled = family.exponent().is_some();
        let shaped = family.elastic == Form::Exponential;
        let value = |info: &ParameterInfo| {
            let value = self.value(family, info.name).unwrap_or(S::zero());
            match info.name {
                // K(δ₀) = K·(D/δ₀)^(1−n) and λ(δ₀) = λ·(D/δ₀)^(−n).
                "stiffness" if shaped => self.surface_stiffness(),
                "stiffness" if scaled => value * ratio.pow_positive(S::one() - self.exponent),
                "damping" if scaled => value * ratio.pow_positive(-self.exponent),
                _ => value,
            }
        };
        family.parameters().map(value).collect()
    }

    /// A parameter of the law by its name, at the reference depth of the fit.
    fn value(&self, family: Family, name: &str) -> Option<S> {
        Some(match (family.law, name) {
            (LawId::Zener, "second_stiffness") => self.zener().second_stiffness_n_per_m,
            (LawId::Zener, "damping") => self.zener().damping_ns_per_m,
            (_, "stiffness") => self.stiffness,
            (_, "damping") => self.damping,
            (_, "exponent") => self.exponent,
            (_, "stiffening_rate") => self.stiffening_rate,
            (_, "surface") => self.surface_m,
            _ => {
                let is = |info: &ParameterInfo| info.name == name;
                let (mode, [fraction, _]) = std::iter::zip(&self.modes, RELAXATION)
                    .find(|(_, infos)| infos.iter().any(is))?;
                match is(fraction) {
                    true => mode.fraction,
                    false => mode.rate_per_s,
                }
            }
        })
    }

    /// The law; nothing to touch where it has more than `R` modes.
    fn law<const R: usize>(&self, family: Family) -> Law<S, R> {
        let shaped = family.elastic == Form::Exponential;
        let value = |name: &str| match name {
            "stiffening_rate" if !shaped => None,
            "stiffness" if shaped => Some(self.surface_stiffness()),
            name => self.value(family, name),
        };
        let reference_m = S::from_f64(self.reference_m);
        Law::from_values(family.law, family.listed_modes(), value, reference_m).unwrap_or(Law::Free)
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

    /// m (N/m) of an exponential response whose secant stiffness at the reference depth is K.
    fn surface_stiffness(&self) -> S {
        self.stiffness / (self.stiffening_rate * S::from_f64(self.reference_m)).exprel()
    }

    /// Elastic force (N): at once, without damping.
    pub(super) fn elastic_n(&self, family: Family, depth_m: S) -> S {
        let elastic = match family.elastic {
            Form::Power => Elastic::Power {
                stiffness_n_per_m: self.stiffness,
                exponent: self.exponent,
                reference_depth_m: S::from_f64(self.reference_m),
            },
            Form::Exponential => Elastic::Exponential {
                stiffness_n_per_m: self.surface_stiffness(),
                stiffening_rate_per_m: self.stiffening_rate,
            },
        };
        elastic.force_n(depth_m)
    }

    /// What the load cell reads (N) of a surface that pushes and does not pull, max(law, 0) and the
    /// offset, at every node in turn. A law that remembers is below zero where the material has not
    /// recovered yet, and the probe is then free. What it reads went through the low-pass.
    pub(super) fn along(&self, family: Family, nodes: &[Node], mut each: impl FnMut(&Node, S)) {
        let surface = |_: &Node| self.recovery;
        let Some(low_pass) = self.low_pass else {
            self.run(family, nodes, surface, |node, force| {
                each(node, unilateral(force) + self.offset_n);
            });
            return;
        };
        let mut forces = Vec::with_capacity(nodes.len());
        self.run(family, nodes, surface, |_, force| {
            forces.push(unilateral(force));
        });
        low_pass.through(&mut forces, |at| nodes[at].period_s);
        for (node, force) in nodes.iter().zip(forces) {
            each(node, force + self.offset_n);
        }
    }

    /// Force of the law alone (N) at every node in turn; from `touched_s` on, of the chapter's surface.
    pub(super) fn unsaturated(
        &self,
        family: Family,
        nodes: &[Node],
        touched_s: f64,
        each: impl FnMut(&Node, S),
    ) {
        let surface = |node: &Node| match node.time_s < touched_s {
            true => self.recovery,
            false => Recovery::WithProbe,
        };
        self.run(family, nodes, surface, each);
    }

    fn run(
        &self,
        family: Family,
        nodes: &[Node],
        surface: impl Fn(&Node) -> Recovery,
        each: impl FnMut(&Node, S),
    ) {
        // A mode that is not used would cost as much as one that is.
        match family.modes {
            0 | 1 => self.run_law(&self.law::<1>(family), nodes, surface, each),
            2 => self.run_law(&self.law::<2>(family), nodes, surface, each),
            3 => self.run_law(&self.law::<3>(family), nodes, surface, each),
            _ => self.run_law(&self.law::<MOST_MODES>(family), nodes, surface, each),
        }
    }

    fn run_law<L: RelaxingLaw<S>>(
        &self,
        law: &L,
        nodes: &[Node],
        surface: impl Fn(&Node) -> Recovery,
        mut each: impl FnMut(&Node, S),
    ) {
        let mut state = law.at_rest();
        for node in nodes {
            let number = S::from_f64;
            let mut depth_m = number(node.position_m) - self.surface_m;
            let mut speed = number(node.speed_mps);
            if self.skewed {
                depth_m = depth_m - speed * self.skew_s;
                speed = speed - number(node.acceleration_mps2) * self.skew_s;
            }
            let period_s = number(node.period_s);
            let force_n = surface(node).step(law, &mut state, depth_m, speed, period_s);
            each(node, force_n);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::blocks::Use;
    use super::*;
    use estimator_core::maths::Dual;
    use estimator_core::physics::law::HuntCrossley;

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
        low_pass: None,
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
        check(Family::KELVIN_VOIGT, [-0.03, 0.01, 0.1, 0.2]);
        check(Family::HUNT_CROSSLEY, [-0.03, 0.01, 0.1, 0.2, -0.9, 0.3]);
        check(Family::ZENER, [-0.03, 0.01, 0.1, -0.5, 1.0]);
        check(Family::quasi_linear(1), [-0.03, 0.01, 0.1, -0.9, -0.5, 1.0]);
        let two = [-0.03, 0.01, 0.1, -0.9, -0.5, 1.0, -1.5, -0.7];
        check(Family::quasi_linear(2), two);
        let shaped = Family::quasi_linear(1).shaped(Form::Exponential).unwrap();
        check(shaped, [-0.03, 0.01, 0.1, 0.9, -0.5, 1.0]);
        let creeping = |family: Family| family.creeping().unwrap();
        check(creeping(Family::ZENER), [-0.03, 0.01, 0.1, -0.5, 1.0]);
        check(creeping(Family::quasi_linear(2)), two);
    }

    #[test]
    fn whatever_the_free_numbers_the_law_is_possible() {
        for extreme in [-15.0, -3.0, 0.0, 3.0, 15.0] {
            let law = natural(Family::quasi_linear(4), &[extreme; 12], &SCALES);
            assert!(law.stiffness > 0.0 && (0.5..=4.0).contains(&law.exponent));
            let sum: f64 = law.modes.iter().map(|mode| mode.fraction).sum();
            assert!(sum > 0.0 && sum < 1.0, "{extreme}: {sum}");
            assert!(law.modes.iter().all(|mode| mode.rate_per_s > 0.0));
        }
    }

    #[test]
    fn the_reference_depth_changes_the_numbers_and_not_the_force() {
        let free = [-0.03, 0.01, 0.1, 0.2, -0.9, 0.3];
        let law = natural(Family::HUNT_CROSSLEY, &free, &SCALES);
        let force = |depth_m: f64| {
            let p = law.reported(Family::HUNT_CROSSLEY, depth_m);
            HuntCrossley::new(p[0], p[1], p[2], depth_m).step(&mut (), 1.7e-3, 0.01, 1e-3)
        };
        assert!((force(1e-3) / force(1e-4) - 1.0).abs() < 1e-12);
    }
}
