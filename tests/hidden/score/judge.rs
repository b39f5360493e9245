//! Whether an answer is right.

use super::answer::{Answer, Estimates};
use super::truth::{Numbers, Truth};

/// What an answer is worth. The first three name what is there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Mark {
    /// Exactly what is there, and adequate; for nothing, `no_missing_effect`; for a stranger,
    /// `unexplained` without any name.
    Exact,
    /// `ambiguous`, and every name stands for something that is there, by itself or an alternative.
    InGroup,
    /// Exactly what is there, but the verdict is `unexplained`.
    NotAdequate,
    /// For a stranger: `unexplained`, with names that are junk.
    Junk,
    /// Some of what is there, nothing else.
    Incomplete,
    /// `unexplained` or `ambiguous`, with something wrong in it.
    Doubtful,
    /// Nothing is missing, it says, although something is.
    Missed,
    /// A name that is wrong, as a certainty.
    ConfidentWrong,
    /// No answer: exit status or gap.json.
    Failed,
}

/// Judges one answer.
pub(crate) fn mark(truth: &Truth, answer: &Answer) -> Mark {
    let verdict = answer.verdict.as_str();
    let stranger = truth.effects.iter().any(|id| id == "unknown");
    match (verdict, truth.effects.is_empty(), stranger) {
        ("no_missing_effect", true, _) => Mark::Exact,
        ("no_missing_effect", false, _) => Mark::Missed,
        ("missing_effects", true, _) | ("missing_effects", _, true) => Mark::ConfidentWrong,
        (_, true, _) => Mark::Doubtful,
        ("unexplained", _, true) if answer.effects.is_empty() => Mark::Exact,
        ("unexplained", _, true) => Mark::Junk,
        (_, _, true) => Mark::Doubtful,
        _ => named(truth, answer),
    }
}

fn named(truth: &Truth, answer: &Answer) -> Mark {
    let ids = answer.ids();
    let all = truth
        .effects
        .iter()
        .all(|id| ids.iter().any(|named| truth.same(id, named)));
    let only = ids
        .iter()
        .all(|named| truth.effects.iter().any(|id| truth.same(id, named)));
    match answer.verdict.as_str() {
        "missing_effects" if all && only => Mark::Exact,
        "unexplained" if all && only => Mark::NotAdequate,
        "ambiguous" if in_group(truth, answer) => Mark::InGroup,
        _ if only && !ids.is_empty() => Mark::Incomplete,
        "missing_effects" => Mark::ConfidentWrong,
        _ => Mark::Doubtful,
    }
}

/// Every effect that is there is named or an alternative, and every name stands for one of them.
fn in_group(truth: &Truth, answer: &Answer) -> bool {
    let stands = |id: &str, named: &super::answer::Named| {
        truth.same(id, &named.id) || named.alternatives.iter().any(|also| truth.same(id, also))
    };
    truth
        .effects
        .iter()
        .all(|id| answer.effects.iter().any(|named| stands(id, named)))
        && answer
            .effects
            .iter()
            .all(|named| truth.effects.iter().any(|id| stands(id, named)))
}

/// Whether the first name is one of those that are there.
pub(crate) fn first(truth: &Truth, answer: &Answer) -> bool {
    let first = answer.effects.first();
    first.is_some_and(|named| truth.effects.iter().any(|id| truth.same(id, &named.id)))
}

/// Names, and errors over standard errors.
pub(crate) type Errors = Vec<(String, f64)>;

/// Of the added and of the base's parameters, each with both a truth and a standard error.
pub(crate) fn errors(truth: &Truth, answer: &Answer) -> (Errors, Errors) {
    let mut added = Vec::new();
    for (id, numbers) in &truth.params {
        let mut found = answer.effects.iter().filter(|named| named.id == *id);
        // Two effects of one id have no order that a truth could be compared with.
        if let (Some(named), None) = (found.next(), found.next()) {
            compare(&format!("{id}."), numbers, &named.params, &mut added);
        }
    }
    let mut base = Vec::new();
    compare("", &truth.base, &answer.base, &mut base);
    (added, base)
}

fn compare(prefix: &str, numbers: &Numbers, estimates: &Estimates, into: &mut Vec<(String, f64)>) {
    // A wave of negative amplitude is one half a turn on.
    let flipped = match (numbers.get("amplitude"), estimates.get("amplitude")) {
        (Some(truth), Some((value, _))) => truth * value < 0.0,
        _ => false,
    };
    for (name, truth) in numbers {
        let Some((value, error)) = estimates.get(name) else {
            continue;
        };
        // A width of zero is no width: the form without it.
        if *error <= 0.0 || (name == "width" && *truth == 0.0) {
            continue;
        }
        let mut wrong = value - truth;
        if name == "phase" {
            let turn = std::f64::consts::TAU;
            wrong += if flipped { 0.5 * turn } else { 0.0 };
            wrong -= turn * (wrong / turn).round();
        } else if name == "amplitude" && flipped {
            wrong = -value - truth;
        }
        into.push((format!("{prefix}{name}"), wrong / error));
    }
}
