//! The options of the workflow.

use estimator_core::physics::effect::EffectId;

use crate::gap::search::run::MOST_ADDED;
use crate::gap::thresholds::Thresholds;
use crate::kind::Kind;

/// Options of [`gap`](fn@crate::gap::gap).
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Corner (Hz) of the zero-phase low-pass that measured and predicted force go through.
    pub bandwidth_hz: Option<f64>,
    /// The effects that may be named.
    pub catalogue: Vec<EffectId>,
    /// Most effects that a search adds; of fewer than by default it is asked once, without a second round.
    pub most_added: usize,
    /// What decides.
    pub thresholds: Thresholds,
}

impl Options {
    /// The effects that may be named on a machine of a kind.
    pub(crate) fn catalogue_of(&self, kind: Kind) -> Vec<EffectId> {
        let all = self.catalogue.iter().copied();
        all.filter(|id| kind.can_have(*id)).collect()
    }
}

impl Default for Options {
    fn default() -> Options {
        Options {
            bandwidth_hz: None,
            catalogue: EffectId::ALL.to_vec(),
            most_added: MOST_ADDED,
            thresholds: Thresholds::default(),
        }
    }
}
