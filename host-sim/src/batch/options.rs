//! What a whole log is fitted with.

use estimator_core::physics::law::LawId;

use super::{family::Family, modulus::Indenter, thresholds::Thresholds};

/// What to fit.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// The laws to compare, simplest first.
    pub families: Vec<Family>,
    /// δ₀ (m)
    pub reference_depth_m: Option<f64>,
    /// Position of the surface (m), if it is known.
    pub surface_m: Option<f64>,
    /// What touches, if it is known.
    pub indenter: Option<Indenter>,
    /// ν of the material; 0.5 does not change its volume.
    pub poisson: f64,
    /// What decides about the fit.
    pub thresholds: Thresholds,
}

impl Default for Options {
    fn default() -> Options {
        Options {
            families: all_families(),
            reference_depth_m: None,
            surface_m: None,
            indenter: None,
            poisson: 0.5,
            thresholds: Thresholds::default(),
        }
    }
}

/// Every law, simplest first.
pub fn all_families() -> Vec<Family> {
    let laws = LawId::ALL.iter().filter(|law| **law != LawId::Free);
    laws.flat_map(|law| Family::of(*law)).collect()
}
