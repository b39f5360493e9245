//! The catalogue on the terminal.

use std::fmt::Write;

use estimator_core::physics::effect::{EffectId, ParameterInfo};

use super::Ignored;
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
        let names: Vec<String> = info.parameters.iter().map(parameter).collect();
        let _ = writeln!(text, "{}", wrapped("      ", &names.join(", ")));
        let _ = writeln!(text, "{}", wrapped("      signature: ", info.signature));
    }
    text + "\n`palpate effects ID` says more of one; --out DIR draws them.\n"
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
            info.unit,
            info.bounds.name()
        ),
    }
}

/// One effect, with what it does to the base.
pub(super) fn one(shown: &Ignored) -> String {
    let info = shown.id.info();
    let mut text = format!("{}, in the {}\n", shown.id.name(), info.stage.name());
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
    line("compensated", taken_off(shown.id));
    text.push_str(&format!(
        "\nIgnored, on the simulated gel, {}:\n",
        settings(shown)
    ));
    for (name, unit, truth, found) in &shown.base {
        let truth = Measured::new(*truth, None, unit).to_string();
        let found = match found {
            Some(own) => Measured::new(own.value, Some(own.std_error), unit).to_string(),
            None => "not observable".into(),
        };
        let off = shown.bias(name).map_or(String::new(), percent);
        text.push_str(&format!(
            "  {name:<10} true {truth:<12} fitted {found:<24} {off}\n"
        ));
    }
    if let Some(misfit) = shown.misfit {
        let times = quantity(misfit, 3, "1");
        text.push_str(&format!(
            "  residual   {} times the noise\n",
            times.trim_end()
        ));
    }
    text
}

/// Whether `estimate --compensate` takes it off.
pub(super) fn taken_off(id: EffectId) -> &'static str {
    match id.belongs_to_rig() {
        true => "yes: it is the rig's (estimate --compensate)",
        false => "no: it is a property of what is touched",
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
