//! Whether an answer is right.

use super::answer::{Answer, Estimates};
use super::truth::{Numbers, Truth};

/// What an answer is worth. The first three name what is hidden.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Mark {
    /// It names exactly what is hidden, as `missing_effects`; where nothing is hidden,
    /// `no_missing_effect`; for a misfit that is in no catalogue, `unexplained` without any name. Names of
    /// true parts that are not asked for are left out first.
    Exact,
    /// It is `ambiguous` or `partly_explained`, and every name stands for another hidden effect, by itself
    /// or through an alternative.
    InGroup,
    /// It names exactly what is hidden, but the verdict is `unexplained` or `partly_explained`.
    NotAdequate,
    /// It is `unexplained` with names, for a misfit that is in no catalogue.
    Junk,
    /// It names some of what is hidden and nothing else.
    Incomplete,
    /// It leaves a name open that is wrong.
    Doubtful,
    /// It says that nothing is missing, although something is.
    Missed,
    /// It gives a wrong name as certain or strong.
    ConfidentWrong,
    /// There is no answer: the program failed, or its gap.json cannot be read.
    Failed,
}

/// Judges an answer.
pub fn mark(truth: &Truth, answer: &Answer) -> Mark {
    let left = answer.without(|named| truth.tolerates(named));
    let only_tolerated = left.effects.is_empty() && !answer.effects.is_empty();
    let answer = &left;
    let stands = answer.effects.iter().any(|named| answer.stands_for(named));
    let stranger = truth.effects.iter().any(|id| id == "unknown");
    match (answer.verdict.as_str(), truth.effects.is_empty(), stranger) {
        ("no_missing_effect", true, _) => Mark::Exact,
        ("no_missing_effect", false, _) => Mark::Missed,
        ("missing_effects" | "ambiguous", true, _) if only_tolerated => Mark::Exact,
        // It names what is there, and says that nothing else is.
        ("missing_effects", _, true) if only_tolerated => Mark::Missed,
        ("missing_effects", _, true) => Mark::ConfidentWrong,
        (_, true, _) | (_, _, true) if stands => Mark::ConfidentWrong,
        (_, true, _) => Mark::Doubtful,
        ("unexplained" | "partly_explained", _, true) if answer.effects.is_empty() => Mark::Exact,
        ("unexplained" | "partly_explained", _, true) => Mark::Junk,
        (_, _, true) => Mark::Doubtful,
        _ => named(truth, answer),
    }
}

fn named(truth: &Truth, answer: &Answer) -> Mark {
    let ids = answer.ids();
    let sets = truth.right_sets();
    // One name for each effect: Coulomb and Stribeck together are one too many for one friction.
    let one_each = |ids: &[&str]| {
        sets.iter().any(|set| {
            let stand = |id: &str, at: usize| truth.same(id, ids[at]);
            ids.len() == set.len() && paired(set, ids.len(), &stand)
        })
    };
    let right = |ids: &[&str]| {
        sets.iter().any(|set| {
            let one = |named: &&str| set.iter().any(|id| truth.same(id, named));
            ids.len() <= set.len() && ids.iter().all(one)
        })
    };
    let firm = answer.without(|named| !answer.stands_for(named));
    match answer.verdict.as_str() {
        "missing_effects" if one_each(&ids) => Mark::Exact,
        "unexplained" if one_each(&ids) => Mark::NotAdequate,
        "partly_explained" if firm.ids() == ids && one_each(&ids) => Mark::NotAdequate,
        _ if !right(&firm.ids()) => Mark::ConfidentWrong,
        "ambiguous" | "partly_explained" if in_group(truth, answer) => Mark::InGroup,
        _ if right(&ids) && !ids.is_empty() => Mark::Incomplete,
        "missing_effects" => Mark::ConfidentWrong,
        _ => Mark::Doubtful,
    }
}

/// Whether each name stands for another hidden effect, by itself or through an alternative, and every
/// hidden effect has one.
fn in_group(truth: &Truth, answer: &Answer) -> bool {
    let ids = answer.ids();
    let stands = |id: &str, at: usize| {
        let named = answer.effects.iter().filter(|named| named.id == ids[at]);
        let mut also = named.flat_map(|named| &named.alternatives);
        truth.same(id, ids[at]) || also.any(|also| truth.same(id, also))
    };
    let sets = truth.right_sets();
    sets.iter()
        .any(|set| ids.len() == set.len() && paired(set, ids.len(), &stands))
}

/// Whether the `effects` can be paired with different ones of `count` names.
fn paired(effects: &[String], count: usize, stand: &dyn Fn(&str, usize) -> bool) -> bool {
    fn rest(effects: &[String], free: &mut [bool], stand: &dyn Fn(&str, usize) -> bool) -> bool {
        let Some((id, others)) = effects.split_first() else {
            return true;
        };
        (0..free.len()).any(|at| {
            if !free[at] || !stand(id, at) {
                return false;
            }
            free[at] = false;
            let done = rest(others, free, stand);
            free[at] = true;
            done
        })
    }
    rest(effects, &mut vec![true; count], stand)
}

/// Names of parameters, with their errors over their standard errors.
pub(crate) type Errors = Vec<(String, f64)>;

/// The errors of the added effects' and of the base's parameters, where there is both a truth and a
/// standard error.
pub fn errors(truth: &Truth, answer: &Answer) -> (Errors, Errors) {
    let truth = &exchanged(truth, answer);
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

/// The truth with the base's relaxation mode and the hidden one exchanged if the rates of the answer are
/// nearer to that: two modes in parallel have no order.
fn exchanged(truth: &Truth, answer: &Answer) -> Truth {
    let mut truth = truth.clone();
    let modes = || -> Option<([f64; 2], [f64; 2], f64, f64)> {
        let hidden = truth.params.get("stress_relaxation")?;
        let mut named = answer
            .effects
            .iter()
            .filter(|named| named.id == "stress_relaxation");
        let named = named.next()?;
        let mode =
            |of: &Numbers, fraction: &str, rate: &str| Some([*of.get(fraction)?, *of.get(rate)?]);
        let hidden = mode(hidden, "fraction", "rate")?;
        let base = mode(&truth.base, "relaxation_fraction_1", "relaxation_rate_1")?;
        Some((
            hidden,
            base,
            named.params.get("rate")?.0,
            answer.base.get("relaxation_rate_1")?.0,
        ))
    };
    if let Some((hidden, base, named, fitted)) = modes() {
        let far = |a: f64, b: f64| (a / b).ln().abs();
        if far(named, base[1]) + far(fitted, hidden[1])
            < far(named, hidden[1]) + far(fitted, base[1])
        {
            let pair = |names: [&str; 2], values: [f64; 2]| -> Numbers {
                names
                    .iter()
                    .map(|name| (*name).to_string())
                    .zip(values)
                    .collect()
            };
            let effect = pair(["fraction", "rate"], base);
            truth.params.insert("stress_relaxation".into(), effect);
            let names = ["relaxation_fraction_1", "relaxation_rate_1"];
            truth.base.extend(pair(names, hidden));
        }
    }
    truth
}

fn compare(prefix: &str, numbers: &Numbers, estimates: &Estimates, into: &mut Vec<(String, f64)>) {
    // A wave of negative amplitude is a positive one that is half a turn ahead.
    let flipped = match (numbers.get("amplitude"), estimates.get("amplitude")) {
        (Some(truth), Some((value, _))) => truth * value < 0.0,
        _ => false,
    };
    for (name, truth) in numbers {
        let Some((value, error)) = estimates.get(name) else {
            continue;
        };
        // A true width of zero means the form without a width.
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
