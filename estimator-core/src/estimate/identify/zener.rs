//! Zener as ARX by recursive least squares, (18) and (20)–(24).
//!
//! The model F(h) = −θ₁F(h−1) + θ₂δ(h) + θ₃δ(h−1) is written in differences:
//!
//! (F(h) − F(h−1))/T = −α·F(h−1) + μ·δ(h−1) + κ·(δ(h) − δ(h−1))/T,
//! θ₁ = αT − 1, θ₂ = κ, θ₃ = μT − κ.
//!
//! At 1 kHz a material that relaxes in seconds has θ₁ = −0.999…: in single precision αT would be
//! known to 10⁻⁴ at best. F and δ come from the same filter, equally late, so that the model holds
//! for the filtered signals as it does for the raw ones. T is half the filter's memory, 8 ms by
//! default: samples that are closer add no information.

use nalgebra::{SVector, Vector1, Vector3};

use super::equation_error::{Equation, EquationError};
use super::modes::{ModelPeriod, PerPeriod, RelaxationExcitation, rate_of};
use super::params::{IdentifyParams, SPEED_PER_DEPTH};
use super::slots::size;
use super::{Identify, Instant};
use crate::estimate::config::Inversion;
use crate::estimate::method::{MethodInfo, Offer, methods};
use crate::estimate::monitor::ParameterEstimate;
use crate::estimate::record::PARAMETER_SLOTS;
use crate::maths::{Dual, Real, Scalar};

methods! {
    /// Zener as ARX by recursive least squares, (18).
    ZENER_ARX = 3, Zener, "arx", "Recursive least squares on force and depth of two samples",
        offer: Offer::Default;
}

/// The estimator of the standard linear solid, scaled: θ = [α, μ, κ].
#[derive(Clone, Debug)]
pub struct ZenerArx<T: Real> {
    fit: EquationError<T, 3, 1>,
    excitation: RelaxationExcitation<T>,
    solid: Option<Solid<T>>,
    /// The last sample that was used, unless there was a gap or no contact since then.
    last: Option<Instant<T>>,
    /// Number of samples since then.
    since: u32,
    period: ModelPeriod<T>,
    inversion: Inversion,
}

/// The parameters of Zener (2) in units of N, δ₀ and s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solid<S> {
    /// Stiffness κ₁.
    pub stiffness: S,
    /// Stiffness κ₂.
    pub second_stiffness: S,
    /// Damping λ.
    pub damping: S,
}

impl<S: Scalar> Solid<S> {
    /// The inversion as printed at (18), by forward Euler: κ₁ = θ₂ = κ, (κ₁+κ₂)/λ = α, κ₁κ₂/λ = μ.
    fn by_euler([alpha, mu, kappa]: [S; 3]) -> Self {
        let damping = kappa / (alpha - mu / kappa);
        Solid {
            stiffness: kappa,
            second_stiffness: damping * mu / kappa,
            damping,
        }
    }

    /// The inversion that is exact for a depth that is linear between samples, at any period.
    ///
    /// With e = e^{−νT} and φ = (1 − e)/νT, (2) becomes αT = 1 − e, κ = κ₁(1 − c(1−φ)),
    /// μ/α = κ₁(1−c), c = κ₁/(κ₁+κ₂).
    fn exactly([alpha, mu, kappa]: [S; 3], period_s: S) -> Self {
        let rate = rate_of(alpha, period_s);
        let lag = S::one() - alpha / rate;
        let rest = mu / alpha;
        let gain = rest / kappa;
        let fraction = (S::one() - gain) / (S::one() - gain * lag);
        let stiffness = kappa / (S::one() - fraction * lag);
        let second_stiffness = stiffness * (S::one() - fraction) / fraction;
        Solid {
            stiffness,
            second_stiffness,
            damping: (stiffness + second_stiffness) / rate,
        }
    }

    /// The solid with this θ by the configured inversion; `None` where there is no such solid.
    fn of(theta: [S; 3], period_s: S, inversion: Inversion) -> Option<Self> {
        let [alpha, mu, kappa] = theta;
        let relaxes = alpha > S::zero() && alpha * period_s < S::one();
        // 0 < relaxed stiffness μ/α < instantaneous stiffness κ.
        let softens = mu > S::zero() && kappa * alpha > mu;
        (relaxes && softens).then(|| match inversion {
            Inversion::Exact => Solid::exactly(theta, period_s),
            Inversion::ForwardEuler => Solid::by_euler(theta),
        })
    }

    fn fraction(&self) -> S {
        self.stiffness / (self.stiffness + self.second_stiffness)
    }

    fn rate(&self) -> S {
        (self.stiffness + self.second_stiffness) / self.damping
    }
}

impl<T: Real> ZenerArx<T> {
    /// The estimator before the first contact: θ̂(0) is a spring of the configured stiffness.
    pub fn new(params: &IdentifyParams<T>) -> Self {
        let start = Vector3::new(T::zero(), T::zero(), params.start.stiffness);
        ZenerArx {
            fit: EquationError::new(start, params.start.covariance),
            excitation: RelaxationExcitation::new(ModelPeriod::new(params)),
            solid: None,
            last: None,
            since: 0,
            period: ModelPeriod::new(params),
            inversion: params.inversion,
        }
    }

    /// The estimated solid, once the data describe one.
    pub fn solid(&self) -> Option<Solid<T>> {
        self.solid
    }

    fn equation(&self, last: &Instant<T>, at: &Instant<T>, period_s: T) -> Equation<T, 3, 1> {
        let theta = &self.fit.rls.theta;
        let per_s = T::one() / period_s;
        Equation {
            phi: Vector3::new(-last.force, last.depth, (at.depth - last.depth) * per_s),
            y: (at.force - last.force) * per_s,
            by_noise: [theta.x - per_s, per_s, T::zero()],
            // A surface further in makes every depth smaller.
            by_considered: Vector1::new(theta.y),
        }
    }
}

impl<T: Real> Identify<T> for ZenerArx<T> {
    const METHODS: &'static [MethodInfo] = METHODS;

    /// F̂ from the last sample used, at most one period ago; from rest if there is none.
    fn predict(&self, at: &Instant<T>) -> (T, T) {
        let [alpha, mu, kappa] = self.fit.rls.theta.into();
        let Some(last) = &self.last else {
            return (kappa * at.depth, T::zero());
        };
        let elapsed_s = T::from_u32(self.since + 1) * self.period.sample_s;
        let change = at.depth - last.depth;
        let force = match &self.solid {
            Some(solid) => {
                let PerPeriod { decayed, lag } = PerPeriod::of(solid.rate(), elapsed_s);
                let rest = solid.stiffness * (T::one() - solid.fraction());
                let at_once = solid.stiffness * (T::one() - solid.fraction() * lag);
                last.force + at_once * change - decayed * (last.force - rest * last.depth)
            }
            None => {
                last.force + kappa * change + elapsed_s * (mu * last.depth - alpha * last.force)
            }
        };
        // Both ends of the prediction have noise; the errors of the parameters add little over one
        // period.
        (force, at.noise.filtered * at.noise.filtered)
    }

    fn learn(&mut self, params: &IdentifyParams<T>, at: &Instant<T>, beta: T) -> Option<T> {
        let Some(last) = self.last else {
            self.last = Some(*at);
            self.since = 0;
            return None;
        };
        self.since += 1;
        if self.since < self.period.samples {
            return Some(beta);
        }
        self.last = Some(*at);
        self.since = 0;
        let period_s = self.period.seconds();
        let equation = self.equation(&last, at, period_s);
        let phi = [last.force, last.depth, at.speed];
        let sigma = self.period.variance(&at.noise).sqrt();
        let gate = self
            .excitation
            .admits(phi, last.force, params.excitation_step, sigma, beta);
        if let Some(beta) = gate {
            self.fit.update(&equation, beta, T::one());
            let theta: [T; 3] = self.fit.rls.theta.into();
            self.solid = Solid::of(theta, period_s, self.inversion);
        } else {
            self.fit.break_off();
        }
        Some(gate.unwrap_or(T::one()))
    }

    fn observe(&mut self, _at: &Instant<T>, _in_contact: bool) {
        if self.last.take().is_some() {
            self.fit.break_off();
        }
    }

    fn reset_covariance(&mut self, params: &IdentifyParams<T>, _since_touch: bool) {
        self.fit.reset_covariance(params.start.covariance);
        self.last = None;
    }

    fn estimates(&self, at: &Instant<T>) -> [ParameterEstimate<T>; PARAMETER_SLOTS] {
        let mut estimates = [ParameterEstimate::default(); PARAMETER_SLOTS];
        let theta: [T; 3] = self.fit.rls.theta.into();
        let mut index = 0..3;
        let dual = theta.map(|value| Dual::parameter(value, index.next().unwrap_or(3)));
        let period_s = Dual::constant(self.period.seconds());
        let Some(solid) = Solid::<Dual<T, 3>>::of(dual, period_s, self.inversion) else {
            return estimates;
        };
        let covariance = self.fit.covariance(self.period.variance(&at.noise));
        let shift = self.fit.shift() * at.surface_error;
        let per_speed = Dual::from_f64(SPEED_PER_DEPTH);
        let values = [
            solid.stiffness,
            solid.second_stiffness,
            solid.damping * per_speed,
        ];
        for (slot, dual) in estimates.iter_mut().zip(values) {
            let gradient = SVector::<T, 3>::from(dual.gradient);
            let by_surface = gradient.dot(&shift.column(0));
            let variance = gradient.dot(&(covariance * gradient)) + by_surface * by_surface;
            *slot = ParameterEstimate {
                value: dual.value,
                std_error: T::zero().max_of(variance).sqrt(),
                scale: size(dual.value, solid.stiffness.value),
            };
        }
        estimates
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::identify::ForceNoise;

    /// θ of (18) for a solid and a period, exact for a depth that is linear between samples.
    fn theta(solid: Solid<f64>, period_s: f64) -> [f64; 3] {
        let x = solid.rate() * period_s;
        let (decayed, lag) = (-libm::expm1(-x), 1.0 + libm::expm1(-x) / x);
        let alpha = decayed / period_s;
        let rest = solid.stiffness * (1.0 - solid.fraction());
        [
            alpha,
            alpha * rest,
            solid.stiffness * (1.0 - solid.fraction() * lag),
        ]
    }

    const GEL: Solid<f64> = Solid {
        stiffness: 3.0,
        second_stiffness: 0.9,
        damping: 0.78,
    };

    #[test]
    fn the_exact_inversion_has_no_bias_at_any_period_and_eulers_has_its_own() {
        for period_s in [1e-4, 1e-3, 1e-2, 0.1] {
            let theta = theta(GEL, period_s);
            let exact = Solid::of(theta, period_s, Inversion::Exact).unwrap();
            let euler = Solid::of(theta, period_s, Inversion::ForwardEuler).unwrap();
            for (got, truth) in [
                (exact.stiffness, 3.0),
                (exact.second_stiffness, 0.9),
                (exact.damping, 0.78),
            ] {
                assert!((got / truth - 1.0).abs() < 1e-9, "{period_s}: {exact:?}");
            }
            // νT/2 in the rate and c·νT/2 in κ₁, ν = 5/s: half a percent at a millisecond.
            let off = 1.0 - euler.rate() / 5.0;
            let x = 5.0 * period_s;
            assert!((0.4 * x..0.51 * x).contains(&off), "{period_s}: {off}");
        }
    }

    #[test]
    fn what_no_solid_can_be_is_not_inverted() {
        for theta in [
            [-0.1, 1.0, 3.0],
            [5.0, -1.0, 3.0],
            [5.0, 16.0, 3.0],
            [200.0, 1.0, 3.0],
            [f64::NAN; 3],
        ] {
            assert_eq!(Solid::of(theta, 1e-2, Inversion::Exact), None, "{theta:?}");
        }
    }

    #[test]
    fn strokes_on_a_solid_give_it_up_exactly() {
        let params = crate::estimate::config::Config::default()
            .validate()
            .unwrap()
            .identify;
        let mut arx = ZenerArx::<f64>::new(&params);
        let noise = ForceNoise {
            raw: 0.02,
            filtered: 0.005,
        };
        let law = crate::physics::law::Zener {
            stiffness_n_per_m: 3000.0,
            second_stiffness_n_per_m: 900.0,
            damping_ns_per_m: 780.0,
        };
        let mut memory = crate::physics::law::RelaxingLaw::at_rest(&law);
        for i in 0..8000 {
            let depth_m = 2e-3 + 1e-3 * libm::sin(7e-3 * f64::from(i));
            let force =
                crate::physics::law::RelaxingLaw::step(&law, &mut memory, depth_m, 0.0, 1e-3);
            let at = Instant {
                depth: depth_m / 1e-3,
                speed: 0.7 * libm::cos(7e-3 * f64::from(i)),
                force,
                noise,
                ..Instant::default()
            };
            // Once it has learned, the prediction between two periods is that of the solid.
            if i > 1000 {
                let (predicted, _) = arx.predict(&at);
                // A depth that is not linear over 10 ms: (ωT)²/8 of what relaxes in them.
                assert!((predicted - force).abs() < 1e-4, "{i}: {predicted} {force}");
            }
            arx.learn(&params, &at, 1.0);
        }
        let solid = arx.solid().unwrap();
        // (ωT)²/12 = 0.04 % in the rate.
        assert!((solid.stiffness / 3.0 - 1.0).abs() < 2e-4, "{solid:?}");
        assert!(
            (solid.second_stiffness / 0.9 - 1.0).abs() < 5e-4,
            "{solid:?}"
        );
        assert!((solid.damping / 0.78 - 1.0).abs() < 1e-3, "{solid:?}");
        let [stiffness, ..] = arx.estimates(&Instant::uncertain(noise, 0.0));
        assert!(stiffness.observable());
    }

    #[test]
    fn an_equation_does_not_reach_across_a_release() {
        let params = crate::estimate::config::Config::default()
            .validate()
            .unwrap()
            .identify;
        let mut arx = ZenerArx::<f64>::new(&params);
        let noise = ForceNoise {
            raw: 0.02,
            filtered: 0.005,
        };
        let at = |depth| Instant {
            depth,
            speed: 0.0,
            force: 3.0 * depth,
            noise,
            ..Instant::default()
        };
        for i in 0..40 {
            // Five pushed samples at a time: less than a period.
            let at = at(1.0 + f64::from(i % 6));
            if i % 6 == 0 {
                arx.observe(&at, false);
            } else {
                arx.learn(&params, &at, 1.0);
            }
        }
        assert_eq!(arx.solid(), None);
        assert_eq!(arx.fit.rls.theta.z, params.start.stiffness);
    }
}
