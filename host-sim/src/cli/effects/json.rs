//! The catalogue as JSON.

use estimator_core::physics::effect::EffectId;
use serde_json::{Value, json};

/// Every effect with its parameters.
pub(super) fn catalogue(ids: &[EffectId]) -> Value {
    json!({ "effects": ids.iter().map(|id| effect(*id)).collect::<Vec<_>>() })
}

fn effect(id: EffectId) -> Value {
    let info = id.info();
    let parameters = info.parameters.iter().map(|parameter| {
        json!({
            "name": parameter.name,
            "unit": parameter.unit.to_string(),
            "bounds": parameter.bounds.name(),
            "default": parameter.default,
        })
    });
    json!({
        "id": id.name(),
        "stage": info.stage.name(),
        "law": info.law,
        "parameters": parameters.collect::<Vec<_>>(),
        "signature": info.signature,
        "motion": info.motion,
    })
}
