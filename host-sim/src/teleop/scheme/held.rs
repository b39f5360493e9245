//! What the slave last knew completely.
//!
//! A master that is told of a parameter that is not observable puts no force out. On a material that the
//! law does not explain, a relaxing foam, parameters come and go; the operator is better off with the last
//! complete impedance than with none. A change of the material ends it.

use estimator_core::Estimate;
use estimator_core::estimate::{Event, Parameters};
use estimator_core::physics::law::LawKind;

/// The last complete parameters.
#[derive(Clone, Copy, Debug, Default)]
pub struct Held(Option<(LawKind, Parameters<f32>)>);

impl Held {
    /// Looks at every estimate, and puts what was known into one that is not complete.
    pub fn complete(&mut self, estimate: &mut Estimate<f32>) {
        if estimate.event == Some(Event::MaterialChange) {
            self.0 = None;
        }
        let slots = estimate.law.parameters().len();
        if estimate.parameters.iter().take(slots).all(Option::is_some) {
            self.0 = Some((estimate.law, estimate.parameters));
        } else if let Some((law, parameters)) = self.0 {
            (estimate.law, estimate.parameters) = (law, parameters);
        }
    }
}
