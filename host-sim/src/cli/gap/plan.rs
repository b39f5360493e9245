//! A plan in the terminal, and `plan.json`.

use std::fmt::Write;

use estimator_core::physics::effect::EffectId;
use serde_json::{Value, json};

use super::motion::{self as advised_motion, Note};
use crate::gap::{FurtherMotion, Plan, PlannedEffect};
use crate::json::number;
use crate::number::{quantity, setting};
use crate::wrap::wrapped;

/// The table, the groups that are not discriminated, and what to record as well.
pub(super) fn summary(plan: &Plan) -> String {
    let lead = format!(
        "{} s at {} Hz, noise {}",
        setting(plan.duration_s, ""),
        setting(plan.rate_hz, ""),
        quantity(plan.noise_n, 2, "N")
    );
    let mut text = wrapped("plan for ", &format!("{} ({lead})", plan.motion));
    table(&mut text, plan);
    for group in plan.groups() {
        line(&mut text, "not told apart", &ids(&group));
    }
    further_motions(&mut text, plan);
    let change = format!(
        "is the root mean square of what an effect does to the force; seen is how clearly it remains after the model \
         is refitted without it, rival after the nearest other effect is refitted in its place, both in standard \
         deviations; at least {:.1} counts",
        plan.least_sigma
    );
    line(&mut text, "change", &change);
    text
}

fn line(text: &mut String, label: &str, value: &str) {
    // Writing into a String cannot fail.
    let _ = writeln!(text, "{}", wrapped(&format!("  {label:<16}"), value));
}

/// What the motion shows of each effect.
fn table(text: &mut String, plan: &Plan) {
    let _ = writeln!(
        text,
        "\n\n  {:<25} {:>10} {:>9}  nearest rival",
        "effect", "change", "seen"
    );
    for effect in &plan.effects {
        let seen = match plan.counts(effect.seen_sigma) {
            true => sigma(effect.seen_sigma),
            false => "not seen".into(),
        };
        let _ = writeln!(
            text,
            "  {:<25} {:>10} {seen:>9}  {}",
            effect.id.name(),
            quantity(effect.change_n, 2, "N"),
            nearest(effect),
        );
    }
    text.push('\n');
}

/// What to record for the effects that the motion does not show, or not apart from others.
fn further_motions(text: &mut String, plan: &Plan) {
    for (further, effects) in advised(plan) {
        let names = effects.iter().map(|effect| {
            let sigma_with = effect.further.as_ref().map_or(0.0, |further| further.sigma);
            format!("{} ({})", effect.id.name(), sigma(sigma_with))
        });
        let names = names.collect::<Vec<_>>().join(", ");
        let value = format!("{}{}: for {names}", further.words, peak(further));
        line(text, "record as well", &value);
    }
    let needy = plan.effects.iter().filter(|effect| needs(plan, effect));
    for effect in needy.filter(|effect| effect.further.is_none()) {
        let value = format!("{}: {}", effect.id.name(), effect.id.info().motion);
        line(text, "no motion here", &value);
    }
}

/// The largest force that is expected on the way.
fn peak(further: &FurtherMotion) -> String {
    further.peak_n.map_or(String::new(), |peak_n| {
        format!(", up to {}", quantity(peak_n, 2, "N"))
    })
}

fn ids(effects: &[EffectId]) -> String {
    let names: Vec<&str> = effects.iter().map(|id| id.name()).collect();
    names.join(", ")
}

fn sigma(value: f64) -> String {
    if value < 10.0 {
        format!("{value:.1} σ")
    } else {
        format!("{value:.0} σ")
    }
}

fn nearest(effect: &PlannedEffect) -> String {
    let nearest = effect.rivals.first();
    nearest.map_or(String::new(), |(id, of_rival)| {
        format!("{} {}", id.name(), sigma(*of_rival))
    })
}

/// Whether an effect is not seen, or not distinguished from a rival.
fn needs(plan: &Plan, effect: &PlannedEffect) -> bool {
    !plan.counts(effect.seen_sigma) || effect.rivals.iter().any(|(_, sigma)| !plan.counts(*sigma))
}

/// Each further motion with the effects that it is for. The one for most effects comes first.
pub(super) fn advised(plan: &Plan) -> Vec<(&FurtherMotion, Vec<&PlannedEffect>)> {
    let mut motions: Vec<(&FurtherMotion, Vec<&PlannedEffect>)> = Vec::new();
    for effect in plan.effects.iter().filter(|effect| needs(plan, effect)) {
        let Some(further) = &effect.further else {
            continue;
        };
        match motions.iter_mut().find(|(of, _)| of.name == further.name) {
            Some((_, effects)) => effects.push(effect),
            None => motions.push((further, vec![effect])),
        }
    }
    motions.sort_by_key(|(_, effects)| std::cmp::Reverse(effects.len()));
    motions
}

/// The file of the motion that helps most effects, if any does.
pub(super) fn motion(plan: &Plan) -> Option<String> {
    let (further, effects) = advised(plan).into_iter().next()?;
    let names: Vec<&str> = effects.iter().map(|effect| effect.id.name()).collect();
    let note = Note {
        words: &further.words,
        purpose: &format!(
            "The motion that was planned does not show these, or not apart from others, and both \
             motions do: {}.",
            names.join(", ")
        ),
        command: "palpate gap --model MODEL.toml --log PLANNED.csv --log NEW.csv --out DIR",
        limits: None,
        peak_n: further.peak_n,
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
        "effects": plan.effects.iter().map(|planned| effect(plan, planned)).collect::<Vec<_>>(),
        "groups": plan.groups().iter()
            .map(|ids| ids.iter().map(|id| id.name()).collect::<Vec<_>>())
            .collect::<Vec<_>>(),
    })
}

fn effect(plan: &Plan, planned: &PlannedEffect) -> Value {
    let rivals = planned.rivals.iter().take(5);
    let rivals = rivals.map(|(id, sigma)| json!({ "id": id.name(), "sigma": number(*sigma) }));
    let further = planned.further.as_ref().map(|further| {
        json!({
            "motion": further.name,
            "words": further.words,
            "sigma": number(further.sigma),
        })
    });
    json!({
        "id": planned.id.name(),
        "change_n": number(planned.change_n),
        "seen": plan.counts(planned.seen_sigma),
        "sigma": number(planned.seen_sigma),
        "rivals": rivals.collect::<Vec<_>>(),
        "further": further,
    })
}
