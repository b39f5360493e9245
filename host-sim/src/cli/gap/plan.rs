//! A plan in the terminal, and `plan.json`.

use std::fmt::Write;

use serde_json::{Value, json};

use super::motion::{self as advised_motion, Note};
use crate::gap::{FurtherMotion, Plan, PlannedEffect};
use crate::json::number;
use crate::number::quantity;
use crate::wrap::wrapped;

/// The table, the groups, and what to record as well.
pub(super) fn summary(plan: &Plan) -> String {
    let lead = format!(
        "{} s at {} Hz, noise {}",
        crate::number::setting(plan.duration_s, ""),
        crate::number::setting(plan.rate_hz, ""),
        quantity(plan.noise_n, 2, "N")
    );
    let mut text = wrapped("plan for ", &format!("{} ({lead})", plan.motion));
    let _ = writeln!(
        text,
        "\n\n  {:<25} {:>10} {:>9}  nearest rival",
        "effect", "change", "seen"
    );
    for own in &plan.effects {
        let _ = writeln!(
            text,
            "  {:<25} {:>10} {:>9}  {}",
            own.id.name(),
            quantity(own.change_n, 2, "N"),
            if plan.counts(own.seen_sigma) {
                sigma(own.seen_sigma)
            } else {
                "not seen".into()
            },
            nearest(own),
        );
    }
    text.push('\n');
    for group in plan.groups() {
        let names: Vec<&str> = group.iter().map(|id| id.name()).collect();
        let _ = writeln!(text, "{}", wrapped("  not told apart  ", &names.join(", ")));
    }
    for (further, effects) in advised(plan) {
        let names = effects.iter().map(|own| {
            let sigma_with = own.further.as_ref().map_or(0.0, |own| own.sigma);
            format!("{} ({})", own.id.name(), sigma(sigma_with))
        });
        let names = names.collect::<Vec<_>>().join(", ");
        let _ = writeln!(
            text,
            "{}",
            wrapped(
                "  record as well  ",
                &format!("{}: for {names}", further.words)
            )
        );
    }
    for own in plan
        .effects
        .iter()
        .filter(|own| needs(plan, own) && own.further.is_none())
    {
        let _ = writeln!(
            text,
            "{}",
            wrapped(
                "  no motion here  ",
                &format!("{}: {}", own.id.name(), own.id.info().motion)
            )
        );
    }
    let _ = writeln!(
        text,
        "{}",
        wrapped(
            "  change          ",
            &format!(
                "is the root mean square of what an effect does to the force; seen and rival are standard \
                 deviations of what no refit takes back, at least {:.1} to count",
                plan.least_sigma
            )
        )
    );
    text
}

fn sigma(value: f64) -> String {
    if value < 10.0 {
        format!("{value:.1} σ")
    } else {
        format!("{value:.0} σ")
    }
}

fn nearest(own: &PlannedEffect) -> String {
    own.rivals.first().map_or(String::new(), |(id, apart)| {
        format!("{} {}", id.name(), sigma(*apart))
    })
}

/// Whether an effect is not seen, or not told from a rival.
fn needs(plan: &Plan, own: &PlannedEffect) -> bool {
    !plan.counts(own.seen_sigma) || own.rivals.iter().any(|(_, sigma)| !plan.counts(*sigma))
}

/// Each further motion with the effects that it is for; the one that is for most comes first.
pub(super) fn advised(plan: &Plan) -> Vec<(&FurtherMotion, Vec<&PlannedEffect>)> {
    let mut motions: Vec<(&FurtherMotion, Vec<&PlannedEffect>)> = Vec::new();
    for own in plan.effects.iter().filter(|own| needs(plan, own)) {
        let Some(further) = &own.further else {
            continue;
        };
        match motions.iter_mut().find(|(of, _)| of.name == further.name) {
            Some((_, effects)) => effects.push(own),
            None => motions.push((further, vec![own])),
        }
    }
    motions.sort_by_key(|(_, effects)| std::cmp::Reverse(effects.len()));
    motions
}

/// The file of the motion that helps most effects, if any does.
pub(super) fn motion(plan: &Plan) -> Option<String> {
    let (further, effects) = advised(plan).into_iter().next()?;
    let names: Vec<&str> = effects.iter().map(|own| own.id.name()).collect();
    let note = Note {
        words: &further.words,
        purpose: &format!(
            "The motion that was planned does not show these, or not apart from others, and both \
             motions do: {}.",
            names.join(", ")
        ),
        command: "palpate gap --model MODEL.toml --log PLANNED.csv --log NEW.csv --out DIR",
        limits: None,
    };
    Some(advised_motion::text(&further.motion, &note))
}

/// The content of `plan.json`.
pub(super) fn json(plan: &Plan) -> Value {
    json!({
        "motion": plan.motion,
        "duration_s": number(plan.duration_s),
        "rate_hz": number(plan.rate_hz),
        "noise_n": number(plan.noise_n),
        "least_sigma": number(plan.least_sigma),
        "effects": plan.effects.iter().map(|own| effect(plan, own)).collect::<Vec<_>>(),
        "groups": plan.groups().iter()
            .map(|ids| ids.iter().map(|id| id.name()).collect::<Vec<_>>())
            .collect::<Vec<_>>(),
    })
}

fn effect(plan: &Plan, own: &PlannedEffect) -> Value {
    let rivals = own.rivals.iter().take(5);
    let rivals = rivals.map(|(id, sigma)| json!({ "id": id.name(), "sigma": number(*sigma) }));
    let further = own.further.as_ref().map(|further| {
        json!({
            "motion": further.name,
            "words": further.words,
            "sigma": number(further.sigma),
        })
    });
    json!({
        "id": own.id.name(),
        "change_n": number(own.change_n),
        "seen": plan.counts(own.seen_sigma),
        "sigma": number(own.seen_sigma),
        "rivals": rivals.collect::<Vec<_>>(),
        "further": further,
    })
}
