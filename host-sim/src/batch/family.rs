//! The laws as the fit sees them: a vector of free numbers, the law that it means, and the force
//! along a course, for any scalar.
//!
//! The free numbers are scaled and transformed so that whatever they are the law is possible:
//! K = e^θ > 0, n = ½ + 3½/(1 + e^−θ) in ½…4, cᵢ = e^θᵢ/(1 + Σe^θⱼ) in (0, 1) with Σcᵢ < 1, νᵢ = e^θ > 0.
//! An exponential response (m/b)(e^{bδ} − 1) has bD = e^θ in place of n, and its K is the secant stiffness at
//! the reference depth of the fit as that of a power is; m and b are reported. Damping stays linear and may come out negative: bounded, its standard error would be wrong where
//! there is none. Within the fit the reference depth is half of the depth reached, where K and n are
//! least correlated; K and λ are carried to δ₀ at the end, with their covariance.
//!
//! **Skew.** Force and position of one row are rarely of one instant: 1 ms between them makes the
//! damping of a stiff plastic wrong by 27–53 %. Under Hunt–Crossley the two differ in how they grow
//! with depth, so the delay of the force is a free number there, δ(t − τ) and δ̇(t − τ) to first order
//! in τ, with a prior of ±5 % of a sample period for motions that do not tell (a single ramp). A log that
//! contradicts the prior is fitted again with its motion shifted by what [`lateness`](super::lateness())
//! finds. Under the other laws a delay is a damping or a fast mode, and stays 0.

use estimator_core::maths::scalar::Scalar;
use estimator_core::physics::law::{
    Elastic, Law, LawId, MOST_MODES, ParameterInfo, RELAXATION, RelaxationMode, RelaxingLaw,
    STIFFENING_RATE, SURFACE as SURFACE_INFO, Zener, unilateral,
};

use super::course::{Node, Scales};

/// Positions of the free numbers that all laws have.
pub(super) const SURFACE: usize = 0;
pub(super) const OFFSET: usize = 1;
pub(super) const STIFFNESS: usize = 2;

/// Prior of the skew of Hunt–Crossley, in sample periods.
const SKEW_PRIOR: f64 = 0.05;

/// Smallest exponent, and the range above it.
const LEAST_EXPONENT: f64 = 0.5;
const EXPONENT_RANGE: f64 = 3.5;

/// A law, with the number of its relaxation modes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Family {
    /// The law.
    pub law: LawId,
    /// The number of its relaxation modes.
    pub modes: usize,
    /// How the force grows with depth, where the law leaves that open.
    pub elastic: Form,
}

/// How an elastic force grows with depth.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Form {
    /// Kδ₀(δ/δ₀)ⁿ
    #[default]
    Power,
    /// (m/b)(e^{bδ} − 1), (13).
    Exponential,
}

impl Form {
    /// Both.
    pub const ALL: [Form; 2] = [Form::Power, Form::Exponential];

    /// Name in files.
    pub const fn name(self) -> &'static str {
        match self {
            Form::Power => "power",
            Form::Exponential => "exponential",
        }
    }
}

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
    pub(super) reference_m: f64,
}

impl Family {
    /// Kelvin–Voigt.
    pub const KELVIN_VOIGT: Family = Family::with(LawId::KelvinVoigt, 0);
    /// Hunt–Crossley.
    pub const HUNT_CROSSLEY: Family = Family::with(LawId::HuntCrossley, 0);
    /// Zener.
    pub const ZENER: Family = Family::with(LawId::Zener, 1);

    /// The quasi-linear law with this many modes.
    pub const fn quasi_linear(modes: usize) -> Family {
        Family::with(LawId::QuasiLinear, modes)
    }

    /// The same with a mode more, if its law can have several.
    pub(super) fn with_a_mode_more(self) -> Option<Family> {
        let modes = self.modes + 1;
        (self.law == LawId::QuasiLinear).then_some(Family { modes, ..self })
    }

    /// This family with another elastic response, if its law can have it.
    pub fn shaped(self, elastic: Form) -> Option<Family> {
        let can = elastic == Form::Power || !self.law.info().optional.is_empty();
        can.then_some(Family { elastic, ..self })
    }

    const fn with(law: LawId, modes: usize) -> Family {
        Family {
            law,
            modes,
            elastic: Form::Power,
        }
    }

    /// The families of a law: one for each number of modes that it can have.
    pub fn of(law: LawId) -> impl Iterator<Item = Family> {
        let modes = match law.info().most_modes {
            0 => usize::from(law.info().relaxes)..=usize::from(law.info().relaxes),
            most => 1..=most,
        };
        modes.map(move |modes| Family::with(law, modes))
    }

    /// The name in files.
    pub fn name(self) -> &'static str {
        self.law.name()
    }

    /// Modes that are parameters themselves; the one of a Zener material follows from its springs and
    /// damper.
    pub(crate) fn listed_modes(self) -> usize {
        self.modes.min(self.law.info().most_modes)
    }

    /// Free numbers of the fit: those of the law, and the force offset.
    pub fn free(self) -> usize {
        self.first_mode() + 2 * self.modes + usize::from(self.skew().is_some())
    }

    /// Where the skew stands among the free numbers.
    pub(super) fn skew(self) -> Option<usize> {
        (self.law == LawId::HuntCrossley).then_some(self.first_mode())
    }

    /// Free numbers that are known before the fit: which, and 1/σ² around 0.
    pub(super) fn prior(self) -> Option<(usize, f64)> {
        Some((self.skew()?, SKEW_PRIOR.powi(-2)))
    }

    /// Where the exponent stands among the free numbers.
    pub(super) fn exponent(self) -> Option<usize> {
        self.position("exponent")
    }

    /// Where the rate of an exponential response stands among the free numbers: in place of the exponent.
    pub(super) fn stiffening_rate(self) -> Option<usize> {
        let law = Family {
            elastic: Form::Power,
            ..self
        };
        law.exponent().filter(|_| self.elastic == Form::Exponential)
    }

    /// Where the damping stands among the free numbers.
    pub(super) fn damping(self) -> Option<usize> {
        self.position("damping")
    }

    /// Where a parameter of the law stands among the free numbers, if it is one.
    fn position(self, name: &str) -> Option<usize> {
        let mut infos = self.own().take(self.first_mode() - STIFFNESS);
        Some(STIFFNESS + infos.position(|info| info.name == name)?)
    }

    /// The law's own parameters; an exponential response has its rate in place of the exponent.
    pub(super) fn own(self) -> impl Iterator<Item = &'static ParameterInfo> {
        let is_exponent = |info: &ParameterInfo| info.name == "exponent";
        self.law.info().parameters.iter().map(move |info| {
            match self.elastic == Form::Exponential && is_exponent(info) {
                true => &STIFFENING_RATE,
                false => info,
            }
        })
    }

    /// Where fraction and rate of the modes begin: behind the law's parameters, of which Zener has the
    /// stiffness alone, since its mode stands for the others.
    pub(super) fn first_mode(self) -> usize {
        match self.law {
            LawId::Zener => STIFFNESS + 1,
            law => STIFFNESS + law.info().parameters.len(),
        }
    }

    /// The parameters in the order of `estimate.json`.
    pub fn parameters(self) -> impl Iterator<Item = &'static ParameterInfo> {
        let modes = RELAXATION[..self.listed_modes()].iter().flatten();
        self.own().chain(modes).chain([&SURFACE_INFO])
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
        reference_m,
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
    /// recovered yet, and the probe is then free.
    pub(super) fn along(&self, family: Family, nodes: &[Node], mut each: impl FnMut(&Node, S)) {
        self.unsaturated(family, nodes, |node, force| {
            each(node, unilateral(force) + self.offset_n);
        });
    }

    /// Force of the law alone (N) at every node in turn.
    pub(super) fn unsaturated(&self, family: Family, nodes: &[Node], each: impl FnMut(&Node, S)) {
        // A mode that is not used would cost as much as one that is.
        match family.modes {
            0 | 1 => self.run(&self.law::<1>(family), nodes, each),
            2 => self.run(&self.law::<2>(family), nodes, each),
            3 => self.run(&self.law::<3>(family), nodes, each),
            _ => self.run(&self.law::<MOST_MODES>(family), nodes, each),
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
