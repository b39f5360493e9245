//! The catalogue on the terminal.

use std::fmt::Write;

use estimator_core::estimate::Estimated;
use estimator_core::physics::effect::{EffectId, ParameterInfo};

use super::Ignored;
use crate::kind::{self, Kind};
use crate::number::{Measured, quantity};
use crate::wrap::wrapped;

/// All effects in the order of the signal chain.
pub(super) fn catalogue() -> String {
    let mut ids = EffectId::ALL.to_vec();
    ids.sort_by_key(|id| id.info().stage);
    let mut text = format!("{} effects, in the order of the signal chain\n", ids.len());
    let mut stage = None;
    for id in ids {
        let info = id.info();
        if stage != Some(info.stage) {
            stage = Some(info.stage);
            // Writing into a String cannot fail.
            let _ = writeln!(text, "\n{}", info.stage.name());
        }
        let _ = writeln!(text, "{}", wrapped(&format!("  {}: ", id.name()), info.law));
        let parameters = || info.parameters.iter().map(parameter).collect();
        let names: Vec<String> = kind::worded(of(id), parameters);
        let _ = writeln!(text, "{}", wrapped("      ", &names.join(", ")));
        let _ = writeln!(text, "{}", wrapped("      signature: ", info.signature));
    }
    text + "\n`palpate effects ID` shows one in detail; --out DIR draws figures of all.\n"
}

/// The kind of machine that an effect is worded for: the one that is asked for, unless only the other can have it.
pub(super) fn of(id: EffectId) -> Kind {
    match kind::of_words().can_have(id) {
        true => kind::of_words(),
        false => Kind::Rotary,
    }
}

/// Name, unit and bounds.
fn parameter(info: &ParameterInfo) -> String {
    let usual = match info.default {
        None => String::new(),
        Some(value) => format!(", {value} unless given"),
    };
    // An angle says its unit with its bounds.
    match info.bounds {
        estimator_core::physics::effect::Bounds::Angle => {
            format!("{} ({}{usual})", info.name, info.bounds.name())
        }
        _ => format!(
            "{} ({}, {}{usual})",
            info.name,
            kind::unit(info.unit.symbol()),
            info.bounds.name()
        ),
    }
}

/// One effect, with what it does to the base.
pub(super) fn one(shown: &Ignored) -> String {
    let facts = kind::worded(of(shown.id), || facts(shown.id));
    facts + &kind::worded(shown.touched.kind, || when_ignored(shown))
}

fn facts(id: EffectId) -> String {
    let info = id.info();
    let mut text = format!("{}, in the {}\n", id.name(), info.stage.name());
    let mut line = |lead: &str, what: &str| {
        text.push_str(&wrapped(&format!("  {lead:<12}"), what));
        text.push('\n');
    };
    line("law", info.law);
    for own in info.parameters {
        line("parameter", &parameter(own));
    }
    line("shows as", info.signature);
    line("shown by", info.motion);
    line("compensated", taken_off(id));
    text
}

/// What a fit that does not know the effect makes of the base.
fn when_ignored(shown: &Ignored) -> String {
    let mut text = format!(
        "\n{}\n",
        wrapped(
            "",
            &format!(
                "When it is ignored: simulated palpation of {}, with {}",
                shown.touched.name,
                settings(shown)
            )
        )
    );
    let rows: Vec<[String; 3]> = shown.base.iter().map(|own| row(shown, own)).collect();
    let width = |at: usize| rows.iter().map(|row| row[at].chars().count()).max();
    let (truths, fits) = (width(0).unwrap_or(0), width(1).unwrap_or(0));
    for ((name, ..), [truth, found, off]) in shown.base.iter().zip(&rows) {
        let line = format!("  {name:<10} true {truth:<truths$}  fitted {found:<fits$}  {off}");
        text.push_str(line.trim_end());
        text.push('\n');
    }
    if let Some(misfit) = shown.misfit {
        let times = quantity(misfit, 3, "1");
        text.push_str(&format!("  residual   {} × the noise\n", times.trim_end()));
    }
    text
}

/// A parameter of the base: its true value, the fitted one, and how far that is off.
fn row(
    shown: &Ignored,
    (name, unit, truth, found): &(&'static str, &'static str, f64, Option<Estimated<f64>>),
) -> [String; 3] {
    let found = match found {
        Some(own) => Measured::new(own.value, Some(own.std_error), unit).to_string(),
        None => "not observable".into(),
    };
    [
        Measured::new(*truth, None, unit).to_string(),
        found,
        shown.bias(name).map_or(String::new(), percent),
    ]
}

/// Whether `estimate --compensate` takes it off.
pub(super) fn taken_off(id: EffectId) -> &'static str {
    match id.belongs_to_rig() {
        true => "yes, it belongs to the rig (estimate --compensate)",
        false => "no, it belongs to what is touched",
    }
}

/// The parameters that were simulated.
pub(super) fn settings(shown: &Ignored) -> String {
    let parameters = shown.id.info().parameters.iter().zip(shown.row);
    let given = parameters.filter(|(info, value)| info.default != Some(*value));
    let texts: Vec<String> = given
        .map(|(info, value)| {
            let value = quantity(value, 3, info.unit.symbol());
            format!("{} {}", info.name, value.trim_end())
        })
        .collect();
    texts.join(", ")
}

/// +12 %
pub(super) fn percent(share: f64) -> String {
    let text = quantity(100.0 * share.abs(), 2, "1");
    let sign = if share < 0.0 { "−" } else { "+" };
    format!("{sign}{} %", text.trim_end())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_catalogue_names_every_effect_with_its_parameters_once() {
        let text = catalogue();
        for id in EffectId::ALL {
            assert_eq!(
                text.matches(&format!("\n  {}: ", id.name())).count(),
                1,
                "{}",
                id.name()
            );
        }
        assert!(
            text.contains("force (N, more than zero), width (m, zero or more, 0 unless given)"),
            "{text}"
        );
        assert!(text.contains("phase (an angle in rad)"), "{text}");
        assert!(
            text.lines()
                .all(|line| line.chars().count() <= crate::wrap::WIDTH),
            "{text}"
        );
    }

    #[test]
    fn a_bias_is_a_percentage_with_its_sign() {
        assert_eq!(percent(-0.123), "−12 %");
        assert_eq!(percent(0.0042), "+0.42 %");
    }
}
