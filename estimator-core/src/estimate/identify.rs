//! The estimators of the menu, one file each, behind one face.

mod affine;
mod bank;
mod bank_refiner;
mod confidence;
mod contract;
mod equation_error;
mod hammerstein;
#[cfg(feature = "relaxing")]
mod history;
mod hunt_crossley;
mod kelvin_voigt;
mod log_linear;
mod modes;
mod params;
mod pool;
mod refiner;
mod zener;

pub use affine::Affine;
pub use bank::{Bank, Candidate};
pub use bank_refiner::BankRefiner;
pub use confidence::Confidence;
pub use contract::{ForceNoise, Identify, Instant};
pub use hammerstein::{Cascade, Cascade1, Cascade2};
#[cfg(feature = "relaxing")]
pub use history::HistoryFit;
pub use hunt_crossley::TwoStage;
pub use kelvin_voigt::Linear;
pub use log_linear::LogLinear;
pub use modes::hammerstein_coefficients;
pub use params::{IdentifyParams, Scale, Start};
pub use pool::{Memory, Pool, Pooled};
pub use refiner::{Prior, Refiner};
pub use zener::{Solid, ZenerArx};

use crate::estimate::contact::SurfacePosition;
use crate::estimate::method::Method;
use crate::estimate::monitor::ParameterEstimate;
use crate::estimate::{Estimated, PARAMETER_SLOTS, Parameters};
use crate::maths::scalar::Real;
use crate::physics::law::LawKind;

/// The estimator that was chosen.
#[derive(Clone, Debug)]
pub enum Identifier<T: Real> {
    /// See [`Linear`].
    Linear(Linear<T>),
    /// See [`TwoStage`].
    TwoStage(TwoStage<T>),
    /// See [`LogLinear`].
    LogLinear(LogLinear<T>),
    /// See [`ZenerArx`].
    ZenerArx(ZenerArx<T>),
    /// See [`Cascade`].
    Cascade1(Cascade1<T>),
    /// See [`Cascade`].
    Cascade2(Cascade2<T>),
    /// See [`BankRefiner`].
    BankRefiner(BankRefiner<T>),
    /// See [`Affine`].
    Affine(Affine<T>),
    /// See [`HistoryFit`].
    #[cfg(feature = "relaxing")]
    History(HistoryFit<T>),
}

impl<T: Real> Identifier<T> {
    /// Before the first contact.
    pub fn new(params: &IdentifyParams<T>) -> Self {
        match params.method {
            Method::KelvinVoigt => Self::Linear(Linear::new(params)),
            Method::HuntCrossleyTwoStage => Self::TwoStage(TwoStage::new(params)),
            Method::HuntCrossleyLogLinear => Self::LogLinear(LogLinear::new(params)),
            Method::ZenerArx => Self::ZenerArx(ZenerArx::new(params)),
            Method::HammersteinCascade => Self::Cascade1(Cascade::new(params)),
            Method::HammersteinCascade2 => Self::Cascade2(Cascade::new(params)),
            Method::HuntCrossleyBank | Method::HuntCrossleyBankSkew => {
                Self::BankRefiner(BankRefiner::new(params))
            }
            Method::KelvinVoigtSurface if params.surface_known => Self::Linear(Linear::new(params)),
            Method::KelvinVoigtSurface => Self::Affine(Affine::new(params)),
            #[cfg(feature = "relaxing")]
            Method::ZenerBank
            | Method::QuasiLinearBank
            | Method::QuasiLinearBank2
            | Method::Selection => Self::History(HistoryFit::new(params)),
            // Refused by `Config::validate`.
            #[cfg(not(feature = "relaxing"))]
            Method::ZenerBank
            | Method::QuasiLinearBank
            | Method::QuasiLinearBank2
            | Method::Selection => Self::Linear(Linear::new(params)),
        }
    }

    /// The law that it holds to be the right one now.
    pub fn law(&self, params: &IdentifyParams<T>) -> LawKind {
        match self {
            #[cfg(feature = "relaxing")]
            Self::History(own) => own.law().unwrap_or(params.method.law()),
            _ => params.method.law(),
        }
    }

    /// The surface, where the estimator finds it itself.
    pub fn surface(
        &self,
        params: &IdentifyParams<T>,
        noise: &ForceNoise<T>,
    ) -> Option<SurfacePosition<T>> {
        match self {
            Self::BankRefiner(own) => own.surface(params),
            Self::Affine(own) => own.surface(params, noise),
            #[cfg(feature = "relaxing")]
            Self::History(own) => own.surface(params),
            _ => None,
        }
    }

    /// Whether the whole window of the filter is in the material for sure, by a surface that is
    /// better known than that of the impact.
    pub fn is_inside(&self, at: &Instant<T>) -> bool {
        match self {
            Self::BankRefiner(own) => own.is_inside(at),
            _ => false,
        }
    }

    /// See [`Identify::predict`].
    pub fn predict(&self, at: &Instant<T>, noise: &ForceNoise<T>, surface_error: T) -> (T, T) {
        match self {
            Self::Linear(own) => own.predict(at, noise, surface_error),
            Self::TwoStage(own) => own.predict(at, noise, surface_error),
            Self::LogLinear(own) => own.predict(at, noise, surface_error),
            Self::ZenerArx(own) => own.predict(at, noise, surface_error),
            Self::Cascade1(own) => own.predict(at, noise, surface_error),
            Self::Cascade2(own) => own.predict(at, noise, surface_error),
            Self::BankRefiner(own) => own.predict(at, noise, surface_error),
            Self::Affine(own) => own.predict(at, noise, surface_error),
            #[cfg(feature = "relaxing")]
            Self::History(own) => own.predict(at, noise, surface_error),
        }
    }

    /// See [`Identify::learn`].
    pub fn learn(
        &mut self,
        params: &IdentifyParams<T>,
        at: &Instant<T>,
        noise: &ForceNoise<T>,
        beta: T,
    ) -> Option<T> {
        match self {
            Self::Linear(own) => own.learn(params, at, noise, beta),
            Self::TwoStage(own) => own.learn(params, at, noise, beta),
            Self::LogLinear(own) => own.learn(params, at, noise, beta),
            Self::ZenerArx(own) => own.learn(params, at, noise, beta),
            Self::Cascade1(own) => own.learn(params, at, noise, beta),
            Self::Cascade2(own) => own.learn(params, at, noise, beta),
            Self::BankRefiner(own) => own.learn(params, at, noise, beta),
            Self::Affine(own) => own.learn(params, at, noise, beta),
            #[cfg(feature = "relaxing")]
            Self::History(own) => own.learn(params, at, noise, beta),
        }
    }

    /// Sees every instant before it may be learned from, in contact (`touching`) or not: a material
    /// that relaxes recovers in free air. `usable` and [`Identify::admit`]'s `pushed` are the same.
    pub fn follow(&mut self, at: &Instant<T>, noise: &ForceNoise<T>, usable: bool, touching: bool) {
        match self {
            #[cfg(feature = "relaxing")]
            Self::History(own) => own.follow(at, noise, usable, touching),
            _ => _ = (at, noise, touching),
        }
        self.admit(usable);
    }

    /// See [`Identify::admit`].
    pub fn admit(&mut self, pushed: bool) {
        match self {
            Self::ZenerArx(own) => own.admit(pushed),
            Self::Cascade1(own) => own.admit(pushed),
            Self::Cascade2(own) => own.admit(pushed),
            Self::BankRefiner(own) => own.admit(pushed),
            _ => {}
        }
    }

    /// See [`Identify::reset_covariance`].
    pub fn reset_covariance(&mut self, params: &IdentifyParams<T>) {
        match self {
            Self::Linear(own) => own.reset_covariance(params),
            Self::TwoStage(own) => own.reset_covariance(params),
            Self::LogLinear(own) => own.reset_covariance(params),
            Self::ZenerArx(own) => own.reset_covariance(params),
            Self::Cascade1(own) => own.reset_covariance(params),
            Self::Cascade2(own) => own.reset_covariance(params),
            Self::BankRefiner(own) => own.reset_covariance(params),
            Self::Affine(own) => own.reset_covariance(params),
            #[cfg(feature = "relaxing")]
            Self::History(own) => own.reset_covariance(params),
        }
    }

    /// See [`Identify::estimates`].
    pub fn estimates(
        &self,
        noise: &ForceNoise<T>,
        surface_error: T,
    ) -> [ParameterEstimate<T>; PARAMETER_SLOTS] {
        match self {
            Self::Linear(own) => own.estimates(noise, surface_error),
            Self::TwoStage(own) => own.estimates(noise, surface_error),
            Self::LogLinear(own) => own.estimates(noise, surface_error),
            Self::ZenerArx(own) => own.estimates(noise, surface_error),
            Self::Cascade1(own) => own.estimates(noise, surface_error),
            Self::Cascade2(own) => own.estimates(noise, surface_error),
            Self::BankRefiner(own) => own.estimates(noise, surface_error),
            Self::Affine(own) => own.estimates(noise, surface_error),
            #[cfg(feature = "relaxing")]
            Self::History(own) => own.estimates(noise, surface_error),
        }
    }
}

/// The parameters in SI units, the surface behind the law's own; what is not observable is `None`.
pub fn report<T: Real>(
    params: &IdentifyParams<T>,
    law: LawKind,
    estimates: &[ParameterEstimate<T>],
    surface: SurfacePosition<T>,
) -> Parameters<T> {
    let scale = &params.scale;
    let units = law.parameters().iter().map(|info| scale.of(info.unit));
    let mut parameters = [None; PARAMETER_SLOTS];
    for ((slot, own), unit) in parameters.iter_mut().zip(estimates).zip(units) {
        *slot = own.observable().then(|| Estimated {
            value: own.value * unit,
            std_error: own.std_error * unit,
        });
    }
    if let Some(slot) = parameters.get_mut(estimates.len()) {
        *slot = Some(Estimated {
            value: surface.position_m,
            std_error: surface.std_error_m,
        });
    }
    parameters
}
