//! How often the 95 % intervals hold the truth.

use super::wrapped;
use crate::hidden::score::judge::{Mark, errors};
use crate::hidden::score::scored::Scored;
use crate::hidden::score::share::Share;
use crate::tolerance::SURE;
use std::collections::BTreeMap;

/// The share of truths within their 95 % intervals, over the answers that name exactly what is hidden in
/// the catalogue's form; empty where there is none.
pub(super) fn text(scored: &[Scored]) -> String {
    let (mut added, mut base) = (Share::default(), Share::default());
    let (mut numbers, mut without) = (0, 0);
    let mut each: BTreeMap<String, Share> = BTreeMap::new();
    for one in scored {
        let Ok(answer) = &one.answer else { continue };
        let same_form = one.truth.params.len() == one.truth.effects.len();
        let shown = !["none", "poor"].contains(&one.truth.kind.as_str());
        if !same_form || !shown || one.mark() != Mark::Exact {
            continue;
        }
        let (of_added, of_base) = errors(&one.truth, answer);
        // An estimate at a bound may have no interval; it is neither covered nor part of the share.
        for effect in &answer.effects {
            numbers += effect.params.len() + effect.without_error;
            without += effect.without_error;
        }
        for (name, error) in of_added {
            added.push(error.abs() <= SURE);
            each.entry(name).or_default().push(error.abs() <= SURE);
        }
        for (name, error) in of_base {
            base.push(error.abs() <= SURE);
            let name = format!("base.{name}");
            each.entry(name).or_default().push(error.abs() <= SURE);
        }
    }
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
