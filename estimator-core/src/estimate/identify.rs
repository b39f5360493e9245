//! The estimators, one file each, behind one face.

mod affine;
mod bank;
mod bank_refiner;
mod bounds;
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
mod slots;
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
pub use pool::{Pool, PoolRing, Pooled};
pub use refiner::{Prior, Refiner};
pub use slots::report;
pub use zener::{Solid, ZenerArx};

use crate::estimate::{
    config::Config, contact::ContactParams, contact::SurfacePosition, error::ConfigError,
    filter::FilterParams, method::Method, method::MethodInfo, misfit::Excess,
    monitor::ParameterEstimate, record::PARAMETER_SLOTS, status::Doubt,
};
use crate::maths::scalar::Real;
use crate::physics::law::LawKind;

/// Makes of one list of estimators the enum, the lookups by method, and `each!` for its dispatch:
/// a call per estimator that the compiler can inline.
macro_rules! estimators {
    ($d:tt $($(#[$when:meta])* $name:ident),*) => {
        /// The estimator that runs.
        #[derive(Clone, Debug)]
        pub enum Identifier<T: Real> {
            $(#[doc = concat!("See [`", stringify!($name), "`].")] $(#[$when])* $name($name<T>),)*
        }

        /// The rows of every estimator.
        const ROWS: &[&[MethodInfo]] = &[$($(#[$when])* $name::<f32>::METHODS,)*];

        /// The facts about a method; `None` if this build does not have it.
        // Estimator by estimator, so that the compiler keeps of a row what is read of it: from one
        // table, its texts would be in a board's flash.
        #[inline]
        pub fn method_info(method: Method) -> Option<MethodInfo> {
            $($(#[$when])*
            for row in $name::<f32>::METHODS {
                if row.method == method {
                    return Some(*row);
                }
            })*
            None
        }

        impl<T: Real> Identifier<T> {
            /// The estimator of the configured method, before the first contact.
            pub fn new(params: &IdentifyParams<T>) -> Self {
                $($(#[$when])*
                if $name::<T>::runs(params) {
                    return Self::$name($name::new(params));
                })*
                // Never reached: checked parameters have the method of a row.
                Self::Linear(Linear::new(params))
            }
        }

        macro_rules! each {
            ($d identifier:expr, $d estimator:ident => $d call:expr) => {
                match $d identifier {
                    $($(#[$when])* Identifier::$name($d estimator) => $d call,)*
                }
            };
        }
    };
}

// The list: the first estimator that runs a method is taken for it.
estimators!($
    Linear, Affine, TwoStage, LogLinear, ZenerArx, Cascade1, Cascade2, BankRefiner,
    #[cfg(feature = "relaxing")] HistoryFit
);

/// Every method of this build, the simplest estimators first.
pub fn methods() -> impl Iterator<Item = &'static MethodInfo> {
    ROWS.iter().copied().flatten()
}

const _: () = assert!(numbers_differ(), "two methods have one number");

const fn numbers_differ() -> bool {
    let (mut seen, mut group) = (0u128, 0);
    while group < ROWS.len() {
        let mut row = 0;
        while row < ROWS[group].len() {
            let bit = 1 << ROWS[group][row].method.code();
            if seen & bit != 0 {
                return false;
            }
            seen |= bit;
            row += 1;
        }
        group += 1;
    }
    true
}

/// Checks the part of the configuration that the estimators read.
pub(crate) fn validate<T: Real>(
    config: &Config,
    filter: &FilterParams<T>,
    contact: &ContactParams<T>,
) -> Result<IdentifyParams<T>, ConfigError> {
    let info = method_info(config.method).ok_or(ConfigError {
        field: "method",
        value: f32::from(config.method.code()),
        expected: "must be a method of this build, below 10 without the feature `relaxing`",
    })?;
    IdentifyParams::validate(config, &info, filter, contact)
}

impl<T: Real> Identifier<T> {
    /// See [`Identify::law`].
    pub fn law(&self, params: &IdentifyParams<T>) -> LawKind {
        each!(self, estimator => estimator.law(params))
    }

    /// The surface as the estimator has found it; see [`Identify::surface`].
    pub fn surface(
        &self,
        params: &IdentifyParams<T>,
        noise: &ForceNoise<T>,
    ) -> Option<SurfacePosition<T>> {
        let (position, std_error) = each!(self, estimator => estimator.surface(noise))?;
        Some(SurfacePosition {
            position_m: position * params.scale.depth_m,
            std_error_m: std_error * params.scale.depth_m,
        })
    }

    /// See [`Identify::is_inside`].
    pub fn is_inside(&self, at: &Instant<T>) -> bool {
        each!(self, estimator => estimator.is_inside(at))
    }

    /// See [`Identify::predict`].
    pub fn predict(&self, at: &Instant<T>) -> (T, T) {
        each!(self, estimator => estimator.predict(at))
    }

    /// See [`Identify::excess`].
    pub fn excess(&self) -> Option<Excess<T>> {
        each!(self, estimator => estimator.excess())
    }

    /// See [`Identify::doubt`].
    pub fn doubt(&self, at: &Instant<T>) -> Option<Doubt> {
        each!(self, estimator => estimator.doubt(at))
    }

    /// See [`Identify::observe`].
    pub fn observe(&mut self, at: &Instant<T>, in_contact: bool) {
        each!(self, estimator => estimator.observe(at, in_contact))
    }

    /// See [`Identify::learn`].
    pub fn learn(&mut self, params: &IdentifyParams<T>, at: &Instant<T>, beta: T) -> Option<T> {
        each!(self, estimator => estimator.learn(params, at, beta))
    }

    /// See [`Identify::reset_covariance`].
    pub fn reset_covariance(&mut self, params: &IdentifyParams<T>, since_touch: bool) {
        each!(self, estimator => estimator.reset_covariance(params, since_touch))
    }

    /// See [`Identify::has_come_back`].
    pub fn has_come_back(&mut self) -> bool {
        each!(self, estimator => estimator.has_come_back())
    }

    /// See [`Identify::estimates`].
    pub fn estimates(&self, at: &Instant<T>) -> [ParameterEstimate<T>; PARAMETER_SLOTS] {
        each!(self, estimator => estimator.estimates(at))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_that_is_no_method_is_refused_by_name_and_value() {
        for code in [0, 14, 255] {
            let method = Method::from_code(code);
            let error = Config {
                method,
                ..Config::default()
            }
            .validate::<f32>()
            .unwrap_err();
            assert_eq!((error.field, error.value), ("method", f32::from(code)));
        }
    }

    #[test]
    fn every_method_starts_the_estimator_that_declares_it() {
        for row in methods() {
            let config = Config {
                method: row.method,
                ..Config::default()
            };
            let params = config.validate::<f32>().unwrap().identify;
            let identifier = Identifier::new(&params);
            assert!(
                each!(&identifier, estimator => runs(estimator, &params)),
                "{row:?}"
            );
            assert_eq!(identifier.law(&params), row.law);
        }
    }

    fn runs<E: Identify<f32>>(_estimator: &E, params: &IdentifyParams<f32>) -> bool {
        E::METHODS.iter().any(|row| row.method == params.method)
    }
}
