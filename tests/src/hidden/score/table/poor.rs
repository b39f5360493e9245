//! Rigs under one slow sine: the group of names that is left open, and whether the motion that is
//! advised resolves it.

use super::{Runs, share, wrapped};
use crate::hidden::score::judge::{Mark, mark};
use crate::hidden::score::scored::Scored;
use crate::quantile::quantile;

/// The table, empty where there is no such rig.
pub(super) fn text(of: &[&Scored]) -> String {
    if of.is_empty() {
        return String::new();
    }
    let open: Runs<'_> = of
        .iter()
        .copied()
        .filter(|s| s.verdict() == "ambiguous")
        .collect();
    let sizes: Vec<f64> = open
        .iter()
        .filter_map(|s| Some(s.answer.as_ref().ok()?.group() as f64))
        .collect();
    let advised: Runs<'_> = open
        .iter()
        .copied()
        .filter(|s| s.further.is_some())
        .collect();
    let resolved = |one: &Scored| match &one.further {
        Some(Ok(answer)) => mark(&one.truth, answer) == Mark::Exact,
        _ => false,
    };
    let mut text = format!(
        "poor excitation: of {} the right name alone or the right group {} %",
        of.len(),
        share(of, Scored::is_right)
    );
    line!(text, "; left open {}", open.len());
    if open.is_empty() {
        return text;
    }
    line!(
        text,
        "  ids left open: median {:.0}, most {:.0}",
        quantile(&sizes, 0.5),
        quantile(&sizes, 1.0)
    );
    line!(
        text,
        "  a motion advised for {} of them; with its log as well exactly right {} % of {}",
        advised.len(),
        share(&open, resolved),
        open.len(),
    );
    for one in open.iter().filter(|one| !resolved(one)) {
        let label = match &one.further {
            None => "no motion advised".into(),
            Some(Ok(answer)) => answer.label(),
            Some(Err(error)) => error.clone(),
        };
        let said = format!("{}: {} → {label}", one.rig.display(), one.truth.label);
        text += &wrapped("  not resolved ", &said);
    }
    text
}
