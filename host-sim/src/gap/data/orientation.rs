//! The sign of a force that drives instead of resisting.

use std::borrow::Cow;

use crate::inspect::gives_work;
use crate::log::{Channel, UniformLog};
use crate::model::Model;

/// The logs of a machine that touches nothing, with the force reversed where the motion would take work out of
/// a load that has none: such a file holds what the motor gives, or what its cell reads, with the other sign,
/// and every drag, friction and mass of it would be negative. A note says so.
pub(crate) fn oriented<'a>(model: &Model, logs: &'a [UniformLog]) -> Cow<'a, [UniformLog]> {
    if !model.environment.is_free() || logs.is_empty() || !logs.iter().all(gives_work) {
        return Cow::Borrowed(logs);
    }
    let turned = |log: &UniformLog| {
        let mut turned = log.clone();
        turned.force_n.iter_mut().for_each(|force| *force = -*force);
        let other_way = log.columns().option(&[(Channel::Force, -1.0)]);
        turned.notes.push(format!(
            "the force drives the motion and resists none of it: its sign is taken the other way round. Give it so to \
             the other verbs as well ({other_way})"
        ));
        turned
    };
    Cow::Owned(logs.iter().map(turned).collect())
}
