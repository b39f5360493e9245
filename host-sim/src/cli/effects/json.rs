//! The catalogue as JSON.

use estimator_core::physics::effect::EffectId;
use serde_json::{Value, json};

use super::text;
use crate::kind::Kind;

/// Every effect with its parameters.
pub(super) fn catalogue(ids: &[EffectId]) -> Value {
    json!({ "effects": ids.iter().map(|id| effect(*id)).collect::<Vec<_>>() })
}

fn effect(id: EffectId) -> Value {
    let info = id.info();
    let kind = text::of(id);
    let kinds = Kind::ALL.into_iter().filter(|kind| kind.can_have(id));
    let parameters = info.parameters.iter().map(|parameter| {
        json!({
            "name": parameter.name,
            "unit": kind.unit(parameter.unit.symbol()),
            "bounds": parameter.bounds.name(),
            "default": parameter.default,
        })
    });
    json!({
        "id": id.name(),
        "stage": info.stage.name(),
        "kinds": kinds.map(Kind::name).collect::<Vec<_>>(),
        "law": info.law,
        "parameters": parameters.collect::<Vec<_>>(),
        "signature": info.signature,
        "motion": info.motion,
    })
}
