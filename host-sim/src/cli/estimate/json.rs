//! What both kinds of `estimate.json` hold in the same words.

use estimator_core::Fault;
use estimator_core::estimate::Estimated;
use serde_json::{Value, json};

use crate::json::{number, seconds};
use crate::replay::{EventKind, EventMark, Touch};

pub(super) fn touches(touches: &[Touch]) -> Value {
    let each = touches.iter().map(|touch| {
        json!({
            "from_s": seconds(touch.from_s),
            "to_s": seconds(touch.to_s),
            "peak_force_n": number(touch.peak_force_n),
            "peak_depth_m": number(touch.peak_depth_m),
            "secant_stiffness": touch.secant_stiffness.map(number),
            "dissipated_j": touch.dissipated_j.map(number),
            "relaxation_ratio": touch.relaxation_ratio.map(number),
        })
    });
    each.collect()
}

pub(crate) fn events(events: &[EventMark]) -> Value {
    let each = events.iter().map(|event| match &event.kind {
        EventKind::Estimator(kind) => json!({ "t_s": seconds(event.time_s), "kind": kind.name() }),
        EventKind::Fault { code, .. } => {
            let name = Fault::with_code(*code).map(Fault::name);
            json!({ "t_s": seconds(event.time_s), "kind": "fault", "code": code, "name": name })
        }
    });
    each.collect()
}

/// A value without a unit of its own, as the key has it.
pub(super) fn measured(estimate: Option<Estimated<f64>>) -> Value {
    estimate.map_or(Value::Null, |estimate| {
        json!({ "value": number(estimate.value), "std_error": number(estimate.std_error) })
    })
}
