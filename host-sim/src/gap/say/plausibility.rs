//! What a finding says about its input.

use crate::gap::finding::Finding;
use crate::gap::thresholds::Thresholds;
use crate::log::{Channel, UniformLog};
use crate::model::Model;
use crate::number::quantity;
use crate::stats::highest;

/// Notes on what the result says about the input: a stiffness of another order, a surface that is never
/// reached.
pub(crate) fn implausible(
    model: &Model,
    log: &UniformLog,
    finding: &Finding,
    thresholds: &Thresholds,
) -> Vec<String> {
    let another_unit = thresholds.regions.another_unit;
    let mut notes = Vec::new();
    for (given, found) in model
        .environment
        .parameters()
        .iter()
        .zip(&finding.base_after)
    {
        let times = found.value / given.value;
        if given.name == "stiffness" && !(1.0 / another_unit..=another_unit).contains(&times) {
            notes.push(format!(
                "the fitted stiffness is {}, the model's {}: another unit or sign of position or force, or another \
                 rig's log? ({})",
                quantity(found.value, 3, found.unit),
                quantity(given.value, 3, given.unit),
                log.columns().option(&[(Channel::Position, 1e-3)]),
            ));
        }
    }
    let depths = finding.curves.iter().flat_map(|curves| &curves.depth_m);
    let touches = highest(depths.copied()) > 0.0;
    if !model.environment.is_free() && !touches {
        notes.push(
            "the fitted surface is never reached, so the base model's parameters are not observable: its \
             law is not what this log shows"
                .into(),
        );
    }
    notes
}
