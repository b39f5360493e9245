//! What to look for.

use estimator_core::physics::effect::EffectId;

/// What to look for, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Corner of the zero-phase low-pass that measured and predicted force go through (Hz).
    pub bandwidth_hz: Option<f64>,
    /// The effects that may be named.
    pub catalogue: Vec<EffectId>,
}

impl Default for Options {
    fn default() -> Options {
        Options {
            bandwidth_hz: None,
            catalogue: EffectId::ALL.to_vec(),
        }
    }
}
