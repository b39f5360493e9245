//! How often the 95 % intervals hold the truth.

use super::wrapped;
use crate::hidden::score::judge::{Mark, errors};
use crate::hidden::score::scored::Scored;
use crate::hidden::score::share::Share;
use crate::tolerance::SURE;
use std::collections::BTreeMap;

/// The shares of truths within their 95 % intervals.
#[derive(Default)]
pub(super) struct Coverage {
    pub(super) added: Share,
    pub(super) base: Share,
    /// The truths within three standard errors, base and added.
    pub(super) near: Share,
    /// The same for each parameter.
    each: BTreeMap<String, Share>,
    /// The numbers of named effects, and those without an interval.
    numbers: usize,
    without: usize,
}

/// Counts over the answers that name exactly what is hidden in the catalogue's form.
pub(super) fn of<'a>(scored: impl IntoIterator<Item = &'a Scored>) -> Coverage {
    let mut coverage = Coverage::default();
    for one in scored {
        let Ok(answer) = &one.answer else { continue };
        let same_form = one.truth.params.len() == one.truth.effects.len();
        let shown = one.truth.kind != "poor";
        if !same_form || !shown || one.mark() != Mark::Exact {
            continue;
        }
        let (of_added, of_base) = errors(&one.truth, answer);
        for (_, error) in of_added.iter().chain(&of_base) {
            coverage.near.push(error.abs() <= 3.0);
        }
        // An estimate at a bound may have no interval; it is neither covered nor part of the share.
        for effect in &answer.effects {
            coverage.numbers += effect.params.len() + effect.without_error;
            coverage.without += effect.without_error;
        }
        for (name, error) in of_added {
            coverage.added.push(error.abs() <= SURE);
            let each = coverage.each.entry(name).or_default();
            each.push(error.abs() <= SURE);
        }
        for (name, error) in of_base {
            coverage.base.push(error.abs() <= SURE);
            let each = coverage.each.entry(format!("base.{name}")).or_default();
            each.push(error.abs() <= SURE);
        }
    }
    coverage
}

/// The shares in words; empty where there is none. Rigs that hide nothing are left out.
pub(super) fn text(scored: &[Scored]) -> String {
    let something = scored.iter().filter(|one| one.truth.kind != "none");
    let Coverage {
        added,
        base,
        each,
        numbers,
        without,
        ..
    } = of(something);
    if added.of + base.of == 0 {
        return String::new();
    }
    let mut text = format!(
        "95 % intervals cover: added parameters {added} % of {}, base {base} % of {}\n",
        added.of, base.of
    );
    line!(
        text,
        "  without an interval: {without} of the {numbers} numbers of named effects"
    );
    // A list of the parameters whose share is unlikely (< 5 %) if the true one is 95 %.
    let poor = each.iter().filter(|(_, share)| share.interval().1 < 0.95);
    let poor: Vec<String> = poor
        .map(|(name, s)| format!("{name} {}/{}", s.hits, s.of))
        .collect();
    if !poor.is_empty() {
        text += &wrapped("  too narrow: ", &poor.join(", "));
    }
    text
}
