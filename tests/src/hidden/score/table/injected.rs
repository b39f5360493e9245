//! Effects injected into measured records.

use super::wrapped;
use crate::hidden::score::injected::{Clean, Examined, Injected, Outcome, stands};
use crate::hidden::score::share::Share;
use crate::quantile::quantile;
use std::collections::BTreeMap;

/// The tables: the clean records, the effects by size and by name, the misses, what left the count and why.
pub fn text(examined: &[Examined]) -> String {
    [
        clean(examined),
        effects(examined),
        misses(examined),
        left(examined),
    ]
    .join("\n")
}

/// A row for each record.
fn clean(examined: &[Examined]) -> String {
    let mut text = format!(
        "{:<24}{:>11}{:>11}{:>10}{:>11}{:>7}  again from its own answer\n",
        "clean record", "before", "after", "of floor", "reproduced", "n"
    );
    for one in examined {
        let counted = one
            .injected
            .iter()
            .filter(|injected| injected.outcome.is_ok())
            .count();
        match &one.clean {
            Ok(Clean { found, again, .. }) => {
                let names: Vec<&str> = again
                    .effects
                    .iter()
                    .filter(|named| stands(named))
                    .map(|named| named.id.as_str())
                    .collect();
                let said = if names.is_empty() {
                    "nothing".into()
                } else {
                    names.join("+")
                };
                line!(
                    text,
                    "{:<24}{:>11.3e}{:>11.3e}{:>10.1}{:>11.3}{counted:>7}  {said} ({})",
                    one.record,
                    found.rmse_before_n,
                    found.rmse_after_n,
                    found.rmse_after_n / found.floor_n,
                    again.rmse_before_n / found.rmse_after_n,
                    again.verdict,
                );
                let share = found.explained_share.map_or(String::new(), |share| {
                    format!(", explains {:.1} %", 100.0 * share)
                });
                let model = format!("owner's model: {}{share}", found.label());
                text += &wrapped("    ", &model);
            }
            Err(error) => line!(text, "{:<24}  no model: {error}", one.record),
        }
    }
    line!(
        text,
        "reproduced: what the written model leaves over what was found to be left."
    );
    text
}

type Counted<'a> = Vec<&'a Outcome>;

fn effects(examined: &[Examined]) -> String {
    let mut by_size: BTreeMap<String, Counted<'_>> = BTreeMap::new();
    let mut by_name: BTreeMap<String, Counted<'_>> = BTreeMap::new();
    let mut by_record: BTreeMap<String, Counted<'_>> = BTreeMap::new();
    for (record, injected) in each(examined) {
        let Ok(outcome) = &injected.outcome else {
            continue;
        };
        by_size
            .entry(format!("{} × the remainder", injected.size))
            .or_default()
            .push(outcome);
        by_name
            .entry(injected.id.to_string())
            .or_default()
            .push(outcome);
        by_record
            .entry(record.to_string())
            .or_default()
            .push(outcome);
    }
    let mut text = format!(
        "{:<24}{:>5}{:>16}{:>16}{:>10}{:>17}{:>13}{:>7}\n",
        "injected",
        "n",
        "named, %",
        "or open, %",
        "best set",
        "a wrong one, %",
        "within 20 %",
        "left"
    );
    for (name, counted) in by_size.iter().chain(&by_name).chain(&by_record) {
        let share = |what: &dyn Fn(&Outcome) -> bool| Share {
            hits: counted.iter().filter(|one| what(one)).count(),
            of: counted.len(),
        };
        let named = share(&|one| one.named);
        let close = Share {
            hits: share(&|one| one.close()).hits,
            of: named.hits,
        };
        let left: Vec<f64> = counted.iter().map(|one| one.left).collect();
        line!(
            text,
            "{name:<24}{:>5}{:>16}{:>16}{:>10}{:>17}{:>13}{:>7.2}",
            counted.len(),
            named.to_string(),
            share(&|one| one.open).to_string(),
            share(&|one| one.in_best_set).hits,
            share(&|one| one.companion).to_string(),
            format!("{} of {}", close.hits, close.of),
            quantile(left.iter().filter(|one| one.is_finite()), 0.5),
        );
    }
    let all = |what: &dyn Fn(&Outcome) -> bool| {
        let outcomes = each(examined).filter_map(|(_, injected)| injected.outcome.as_ref().ok());
        outcomes.filter(|one| what(one)).count()
    };
    line!(
        text,
        "named: itself or a member of its nested family stands, or its size, where the model has it, is said to\n\
         have changed ({}; of all, {} are said to have another number changed). or open: among what is left open.\n\
         best set: it is in the best set of all that were fitted. left: error after over the error on the clean\n\
         record, median; 1 is as good as before the effect came.",
        all(&|one| one.by_change),
        all(&|one| !one.also_changed.is_empty()),
    );
    text
}

fn each(examined: &[Examined]) -> impl Iterator<Item = (&str, &Injected)> {
    examined.iter().flat_map(|one| {
        let injected = one.injected.iter();
        injected.map(|injected| (one.record.as_str(), injected))
    })
}

fn misses(examined: &[Examined]) -> String {
    let mut text = String::from(
        "missed, with a wrong companion, or of another size (! unexplained, ~ partly explained with what it\n\
         leaves open in brackets, ? ambiguous; * the effect is in the best set):\n",
    );
    for (record, injected) in each(examined) {
        let Ok(one) = &injected.outcome else { continue };
        if one.named && !one.companion && one.close() {
            continue;
        }
        let size = one.ratio.map_or(String::new(), |ratio| {
            format!(", size {ratio:.2} of the true one")
        });
        let said = format!(
            "{record} {} {} ×{}: {:.2} times worse → {} leaves {:.2}{size} ({})",
            injected.id,
            injected.size,
            if one.in_best_set { " *" } else { "" },
            one.worse,
            one.label,
            one.left,
            one.detail,
        );
        text += &wrapped("  ", &said);
    }
    text
}

fn left(examined: &[Examined]) -> String {
    let mut reasons: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    for (record, injected) in each(examined) {
        if let Err(reason) = &injected.outcome {
            let name = format!("{record} {} {} ×", injected.id, injected.size);
            reasons.entry(reason).or_default().push(name);
        }
    }
    let mut text = String::new();
    for (reason, names) in reasons {
        text += &wrapped(
            &format!("left the count, {}, {reason}: ", names.len()),
            &names.join(", "),
        );
    }
    text
}
