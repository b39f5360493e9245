//! What `palpate gap` says in the terminal.

use std::fmt::Write;

use super::regions::words;
use super::result::{Finding, Known, Verdict};
use crate::report::number::quantity;
use crate::wrap::wrapped;

/// The verdict first, then what stands behind it.
pub fn summary(finding: &Finding) -> String {
    let mut text = String::new();
    let mut line = |label: &str, value: &str| {
        let _ = writeln!(text, "{}", wrapped(&format!("  {label:<12}"), value));
    };
    line("gap", &before_and_after(finding));
    line("floor", &floor(finding));
    if !finding.disagreement.is_empty() {
        line("where", &words(&finding.disagreement));
    }
    for own in &finding.effects {
        let numbers: Vec<String> = own.parameters.iter().map(known).collect();
        let mut said = format!("{} {}", own.id.name(), numbers.join(", "));
        if !own.alternatives.is_empty() {
            let others: Vec<&str> = own.alternatives.iter().map(|id| id.name()).collect();
            let _ = write!(said, "; could as well be {}", others.join(" or "));
        }
        line("effect", &said);
        line(
            "",
            &format!(
                "takes off {:.1} % of the squared error it is held against: {}",
                100.0 * own.held_out_gain,
                own.place
            ),
        );
    }
    for (before, after) in finding.base_before.iter().zip(&finding.base_after) {
        line(
            &after.name,
            &format!("{} before, {} after", value(before), value(after)),
        );
    }
    if !finding.remaining.is_empty() {
        line("remains", &words(&finding.remaining));
    }
    line("advice", &finding.advice);
    for note in &finding.notes {
        line("note", note);
    }
    format!("{}\n{text}", verdict(finding))
}

/// The verdict in a sentence.
pub(super) fn verdict(finding: &Finding) -> String {
    let names: Vec<&str> = finding.effects.iter().map(|own| own.id.name()).collect();
    match finding.verdict {
        Verdict::NoMissingEffect => "nothing is missing: the base model explains the log".into(),
        Verdict::MissingEffects => format!("missing: {}", names.join(" and ")),
        Verdict::Ambiguous => format!("ambiguous: {} or a rival", names.join(" and ")),
        Verdict::Unexplained if names.is_empty() => {
            "unexplained: something is missing that the catalogue does not hold".into()
        }
        Verdict::Unexplained => format!(
            "missing: {}; and something unexplained",
            names.join(" and ")
        ),
    }
}

fn before_and_after(finding: &Finding) -> String {
    format!(
        "{} before, {} after, held-out; the floor is {} ({:.2} and {:.2} times what is allowed)",
        quantity(finding.rmse_before_n, 4, "N"),
        quantity(finding.rmse_after_n, 4, "N"),
        quantity(finding.noise_floor_n, 4, "N"),
        finding.ratio_before,
        finding.ratio_after,
    )
}

fn floor(finding: &Finding) -> String {
    let each = finding.floors.iter().map(|own| own.why.clone());
    each.collect::<Vec<_>>().join("; ")
}

fn known(own: &Known) -> String {
    format!("{} {}", own.name, value(own))
}

fn value(own: &Known) -> String {
    match own.std_error {
        Some(error) => format!("{:.6} ± {:.2} {}", Short(own.value), Short(error), own.unit),
        None => format!("{:.6} {}", Short(own.value), own.unit),
    }
}

/// A number with so many significant digits.
struct Short(f64);

impl std::fmt::Display for Short {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let digits = f.precision().unwrap_or(4);
        let size = self.0.abs();
        if size == 0.0 || !(1e-4..1e6).contains(&size) {
            return write!(f, "{:.*e}", digits.saturating_sub(1), self.0);
        }
        let decimals = (digits as i32 - 1 - size.log10().floor() as i32).max(0) as usize;
        write!(f, "{:.*}", decimals, self.0)
    }
}
