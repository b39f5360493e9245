//! Whether logs that are not explained together are explained one by one: then something differs between them.
//!
//! Of three records of a stage the last had a spring that was a quarter softer, a force that was 4 ms late, or a zero half
//! a newton off. Together nothing of the catalogue explains them, and each is explained by itself, or two are.

use std::slice::from_ref;

use crate::diagnostic::listed;
use crate::gap::decide::decision::Decision;
use crate::gap::finding::ParameterEstimate;
use crate::gap::model::{dataset::Dataset, error::std_errors, fit::Fit};
use crate::gap::say::estimates::Estimates;
use crate::log::UniformLog;
use crate::number::Measured;

/// A number differs between two logs if it does by so many standard errors: residuals that are not white make them too
/// small.
const DIFFERS: f64 = 5.0;

/// The base fitted to one log.
struct Alone {
    name: String,
    /// What it leaves, over what noise and the motion's errors allow.
    ratio: f64,
    numbers: Vec<ParameterEstimate>,
}

/// What differs between the logs, in a sentence; `None` where they are one log, explained together, or none of them is by
/// itself.
pub(crate) fn in_words(
    dataset: &Dataset<'_>,
    decision: &Decision,
    logs: &[UniformLog],
) -> Option<String> {
    if dataset.logs.len() < 2 || !decision.verdict.leaves_a_remainder() {
        return None;
    }
    let each: Vec<Alone> = (0..dataset.logs.len())
        .map(|at| alone(dataset, decision, at, name(logs, at)))
        .collect();
    let decide = &dataset.thresholds.explained;
    // A floor is known that well where the noise is coloured.
    let most = decide.residuals * decide.coloured;
    let (good, bad): (Vec<&Alone>, Vec<&Alone>) = each.iter().partition(|own| own.ratio <= most);
    let names = |own: &[&Alone]| listed(own.iter().map(|own| own.name.as_str()));
    if good.is_empty() {
        return None;
    }
    if !bad.is_empty() {
        return Some(format!(
            "the base explains {} by {}, and not {}: ask what is missing there alone",
            names(&good),
            if good.len() == 1 {
                "itself"
            } else {
                "themselves"
            },
            names(&bad)
        ));
    }
    let differs = largest_difference(&good).map_or(String::new(), |words| format!(": {words}"));
    Some(format!(
        "the base explains each log by itself, and not all together: something has changed between them{differs}"
    ))
}

/// The name of a log's file, with its folders where another's is the same.
fn name(logs: &[UniformLog], at: usize) -> String {
    let file = |log: &UniformLog| log.path.file_name().unwrap_or_default().to_owned();
    let own = file(&logs[at]);
    let alike = logs.iter().filter(|log| file(log) == own).count();
    match alike {
        1 => own.to_string_lossy().into_owned(),
        _ => logs[at].path.display().to_string(),
    }
}

/// The base of a decision fitted to one of the logs.
fn alone(dataset: &Dataset<'_>, decision: &Decision, at: usize, name: String) -> Alone {
    let own = Dataset {
        logs: from_ref(&dataset.logs[at]),
        floors: from_ref(&dataset.floors[at]),
        ..*dataset
    };
    // Effects of the base may have taken on forms beside those that are added.
    let best = &decision.best;
    let mut terms = best.shape.terms_at(&best.numbers);
    terms.retain(|term| term.given);
    let (shape, numbers) = best.with_terms(terms, dataset.scales);
    let mut fit = Fit {
        shape,
        numbers,
        cost: best.cost,
    };
    let mut weights = own.weights(&fit);
    // The errors of the motion count by what the law makes of them.
    for _ in 0..2 {
        weights = own.weights(&fit);
        fit = own.problem(&weights).fit(&fit.shape, fit.numbers);
    }
    let problem = own.problem(&weights);
    let freedom = problem.used().len().saturating_sub(fit.numbers.len());
    let errors = std_errors(&problem, &fit);
    Alone {
        name,
        ratio: (fit.cost / freedom.max(1) as f64).sqrt(),
        numbers: Estimates::of(&fit, &errors).of_base(),
    }
}

/// The number that differs most between two logs, in standard errors, in words.
fn largest_difference(each: &[&Alone]) -> Option<String> {
    let mut largest: Option<(f64, String)> = None;
    for (at, one) in each.iter().enumerate() {
        for other in &each[at + 1..] {
            for (a, b) in one.numbers.iter().zip(&other.numbers) {
                let (Some(of_a), Some(of_b)) = (a.std_error, b.std_error) else {
                    continue;
                };
                let sigmas = (a.value - b.value).abs() / of_a.hypot(of_b);
                // Where the rig stands is no property of it, and a bound is no value.
                let says_nothing = a.name == "surface" || a.at_bound || b.at_bound;
                if says_nothing || sigmas <= largest.as_ref().map_or(DIFFERS, |own| own.0) {
                    continue;
                }
                let value = |of: &ParameterEstimate| {
                    Measured::new(of.value, of.std_error, of.unit).to_string()
                };
                let (name, one, other) = (&a.name, &one.name, &other.name);
                let words = format!(
                    "{name} is {} in {one} and {} in {other}",
                    value(a),
                    value(b)
                );
                largest = Some((sigmas, words));
            }
        }
    }
    largest.map(|(_, words)| words)
}
