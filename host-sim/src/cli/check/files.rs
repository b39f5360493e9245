//! `check.json`.

use serde_json::{Value, json};

use crate::cli::estimate::events;
use crate::inspect::Inspection;
use crate::json::{number, seconds};
use crate::log::{Log, Sampling};
use crate::replay::EventMark;

/// The content of `check.json`.
pub(super) fn json(
    raw: &Log,
    facts: &Sampling,
    inspection: &Inspection,
    faults: &[EventMark],
) -> Value {
    let touches = inspection.touches.iter().map(|touch| {
        json!({
            "from_s": seconds(touch.from_s),
            "to_s": seconds(touch.to_s),
            "peak_force_n": number(touch.peak_force_n),
            "peak_depth_m": number(touch.peak_depth_m),
        })
    });
    json!({
        "kind": raw.kind.unwrap_or_default().name(),
        "samples": raw.len(),
        "duration_s": number(raw.duration_s()),
        "sampling": sampling(facts),
        "force_noise_n": number(inspection.noise_n),
        "force_step_n": inspection.force_step_n.map(number),
        "position_step_m": inspection.position_step_m.map(number),
        "rest_n": number(inspection.rest_n),
        "free_s": number(inspection.free_s),
        "saturated_n": inspection.saturated_n.map(number),
        "touches": touches.collect::<Vec<_>>(),
        "events": events(faults),
        "notes": raw.notes,
    })
}

fn sampling(facts: &Sampling) -> Value {
    let stretches = |stretches: &[(f64, f64)]| -> Vec<Value> {
        let each = stretches.iter();
        each.map(|(from, to)| json!({ "from_s": seconds(*from), "to_s": seconds(*to) }))
            .collect()
    };
    json!({
        "rate_hz": number(facts.rate_hz),
        "clock_rate_hz": number(facts.clock_rate_hz),
        "stamps": facts.stamps.name(),
        "jitter_s": number(facts.jitter_s),
        "stamp_step_s": facts.resolution_s.map(number),
        "gaps": facts.drops.gaps.len(),
        "missing": facts.drops.missing,
        "missing_share": number(facts.drops.share),
        "longest_gap_s": number(facts.drops.longest_s),
        "slower": stretches(&facts.slower),
        "segments": stretches(&facts.segments),
        "toggles": facts.toggles,
    })
}
