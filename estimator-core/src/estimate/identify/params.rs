//! Checked parameters of the estimators, in the scales that they compute in.

use crate::estimate::{
    config::Cascade, config::Config, config::Initial, config::Inversion, config::Reference,
    config::Weight, contact::ContactParams, error::ConfigError, error::require_each,
    filter::FilterParams, method::Method, method::MethodInfo, rls::ForgettingParams,
};
use crate::maths::{scalar::Real, units::Unit};
use crate::physics::law::LawKind;

/// Reference speed over reference depth (1/s): 10 mm/s at 1 mm, as in a palpation.
pub(super) const SPEED_PER_DEPTH: f64 = 10.0;

/// The scales in which the estimators compute: depth, speed and force are of the order of 1 in
/// them, from nanonewtons at micrometres to kilonewtons at centimetres. On raw metres an EKF
/// converged from 26–29 % of random starts, on scaled depth from 95 %.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale<T> {
    /// Reference depth δ₀ (m).
    pub depth_m: T,
    /// Reference speed v₀ (m/s).
    pub speed_mps: T,
    /// Reference force F₀ (N).
    pub force_n: T,
}

impl<T: Real> Scale<T> {
    pub(crate) fn new(reference: Reference) -> Self {
        let depth = f64::from(reference.depth_m);
        Scale {
            depth_m: T::from_f64(depth),
            speed_mps: T::from_f64(SPEED_PER_DEPTH * depth),
            force_n: T::from_f64(f64::from(reference.force_n)),
        }
    }

    /// One unit of scaled stiffness (N/m).
    pub fn stiffness(&self) -> T {
        self.force_n / self.depth_m
    }

    /// One unit of scaled damping (N s/m).
    pub fn damping(&self) -> T {
        self.force_n / self.speed_mps
    }

    /// One unit of a scaled parameter, in SI units. Rates are in 1/s throughout.
    pub fn of(&self, unit: Unit) -> T {
        match unit {
            Unit::NewtonPerMetre => self.stiffness(),
            Unit::NewtonSecondPerMetre => self.damping(),
            Unit::Metre => self.depth_m,
            Unit::Second => self.depth_m / self.speed_mps,
            // Rates and fractions are not scaled.
            _ => T::one(),
        }
    }
}

/// Where an estimator starts, scaled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start<T> {
    /// Initial covariance c of P(0) = c·I.
    pub covariance: T,
    /// Initial stiffness K.
    pub stiffness: T,
    /// Initial damping λ.
    pub damping: T,
    /// Initial exponent n.
    pub exponent: T,
}

impl<T: Real> Start<T> {
    pub(crate) fn new(initial: Initial, reference: Reference) -> Self {
        let scale = Scale::<f64>::new(reference);
        Start {
            covariance: T::from_f64(f64::from(initial.covariance)),
            stiffness: T::from_f64(f64::from(initial.stiffness_n_per_m) / scale.stiffness()),
            damping: T::from_f64(f64::from(initial.damping_ns_per_m) / scale.damping()),
            exponent: T::from_f64(f64::from(initial.exponent)),
        }
    }
}

/// The part of the configuration that estimators read, made by [`Config::validate`] only.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IdentifyParams<T> {
    pub(crate) method: Method,
    /// The law that the method identifies, or starts with.
    pub(crate) law: LawKind,
    pub(crate) scale: Scale<T>,
    pub(crate) start: Start<T>,
    pub(crate) forgetting: ForgettingParams<T>,
    pub(crate) excitation_step: T,
    pub(crate) inversion: Inversion,
    pub(crate) cascade: CascadeParams<T>,
    /// Time between two samples of the sensors (µs).
    pub(crate) period_us: u64,
    /// Number of samples that the filter remembers.
    pub(crate) memory_samples: u32,
    /// Variance of a speed over that of the positions in the filter's window, both by their rounding, scaled.
    pub(crate) speed_rounding: T,
    /// Whether the surface is configured, and not a parameter.
    pub(crate) surface_known: bool,
}

impl<T: Real> IdentifyParams<T> {
    pub(crate) fn validate(
        config: &Config,
        info: &MethodInfo,
        filter: &FilterParams<T>,
        contact: &ContactParams<T>,
    ) -> Result<Self, ConfigError> {
        config.reference.check()?;
        config.initial.check()?;
        let step = config.forgetting.excitation_step;
        require_each! {
            (0.0..=1.0).contains(&step), "forgetting.excitation_step", step,
                "must lie between 0 (always learn) and 1";
        }
        let scale = Scale::new(config.reference);
        Ok(IdentifyParams {
            method: info.method,
            law: info.law,
            scale,
            start: Start::new(config.initial, config.reference),
            forgetting: ForgettingParams::validate(config, info.alpha_1)?,
            excitation_step: T::from_f64(f64::from(step)),
            inversion: config.inversion,
            cascade: config.cascade.validate(&scale)?,
            period_us: libm::round(1e6 / f64::from(config.rate_hz)) as u64,
            memory_samples: filter.response().memory_samples,
            speed_rounding: speed_rounding(filter.response().memory_samples, config.rate_hz),
            surface_known: contact.surface_known(),
        })
    }
}

/// 12/(n³T²), of the slope of a straight line through n points that are T apart. It is worked out here, once: in the
/// constructor of the estimator it made the longest step, one that starts anew, 28 725 instructions long instead of 12 417.
fn speed_rounding<T: Real>(samples: u32, rate_hz: f32) -> T {
    let samples = f64::from(samples);
    let per_second = f64::from(rate_hz) / SPEED_PER_DEPTH;
    T::from_f64(12.0 * per_second * per_second / (samples * samples * samples))
}

/// The threshold δ̇* of the speed, scaled, and the weight of Γ₁.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CascadeParams<T> {
    pub(crate) loading_speed: T,
    pub(crate) weight: Weight,
}

/// Default of δ̇* over the reference speed: 5 δ₀/s. The chapter's ramp is 30 mm/s.
const LOADING_SPEED: f64 = 0.5;

impl Cascade {
    fn validate<T: Real>(&self, scale: &Scale<T>) -> Result<CascadeParams<T>, ConfigError> {
        let speed = self.loading_speed_mps.unwrap_or(1.0);
        require_each! {
            speed > 0.0 && speed.is_finite(), "cascade.loading_speed_mps", speed,
                "must be positive, in m/s, or absent";
        }
        let loading_speed = match self.loading_speed_mps {
            Some(speed) => T::from_f64(f64::from(speed)) / scale.speed_mps,
            None => T::from_f64(LOADING_SPEED),
        };
        Ok(CascadeParams {
            loading_speed,
            weight: self.weight,
        })
    }
}

impl Reference {
    fn check(&self) -> Result<(), ConfigError> {
        let (depth, force) = (self.depth_m, self.force_n);
        require_each! {
            (1e-10..=1.0).contains(&depth), "reference.depth_m", depth, "must lie between 1e-10 and 1 m";
            (1e-12..=1e6).contains(&force), "reference.force_n", force, "must lie between 1e-12 and 1e6 N";
        }
        Ok(())
    }
}

impl Initial {
    fn check(&self) -> Result<(), ConfigError> {
        let (k, b, n) = (self.stiffness_n_per_m, self.damping_ns_per_m, self.exponent);
        let c = self.covariance;
        require_each! {
            (1e-3..=1e8).contains(&c), "initial.covariance", c, "must lie between 1e-3 and 1e8";
            (0.0..=1e9).contains(&k), "initial.stiffness_n_per_m", k, "must lie between 0 and 1e9 N/m";
            (0.0..=1e9).contains(&b), "initial.damping_ns_per_m", b, "must lie between 0 and 1e9 N s/m";
            (0.5..=3.0).contains(&n), "initial.exponent", n, "must lie between 0.5 and 3";
        }
        Ok(())
    }
}
