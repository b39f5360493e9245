//! What `palpate gap` says in the terminal.

use std::fmt::Write;

use estimator_core::physics::effect::EffectId;

use crate::gap::{
    Candidate, Finding, MissingEffect, ParameterEstimate, Verdict, changes_in_words,
    regions_in_words, share_in_words, times_larger,
};
use crate::number::{Measured, column, quantity, spaced};
use crate::wrap::wrapped;

/// The column at which the text of a line begins, as blanks.
const INDENT: &str = "              ";

/// The verdict first, then what it rests on.
pub fn summary(finding: &Finding) -> String {
    let mut text = format!("{}\n", verdict(finding));
    for note in &finding.notes {
        line(&mut text, "note", note);
    }
    line(&mut text, "error", &error(finding));
    line(&mut text, "floor", &floor(finding));
    line(&mut text, "where", &regions_in_words(&finding.disagreement));
    if let Some(best) = closest(finding) {
        line(
            &mut text,
            "closest",
            &closest_in_words(best, &finding.ladder),
        );
    }
    for missing in &finding.effects {
        effect(&mut text, missing);
    }
    base(&mut text, finding);
    for words in changes_in_words(finding.changed.as_ref()) {
        line(&mut text, "changed", &words);
    }
    line(&mut text, "slow", &finding.slow_remainder_in_words());
    // Without effects the remaining regions are those above.
    if !finding.effects.is_empty() {
        line(&mut text, "remains", &regions_in_words(&finding.remaining));
    }
    line(&mut text, "advice", &finding.advice);
    text
}

/// A line with a label; none where it would say nothing.
fn line(text: &mut String, label: &str, value: &str) {
    if value.is_empty() {
        return;
    }
    let value = spaced(value);
    // Writing into a String cannot fail.
    let _ = writeln!(text, "{}", wrapped(&format!("  {label:<12}"), &value));
}

/// The verdict in a sentence.
pub(super) fn verdict(finding: &Finding) -> String {
    let ids: Vec<EffectId> = finding.effects.iter().map(|effect| effect.id).collect();
    let names = listed(&ids);
    if let Some(why) = &finding.mistaken {
        return why.clone();
    }
    match finding.verdict {
        Verdict::NoMissingEffect if finding.has_changed() => {
            "nothing is missing, but numbers have changed: with those the base model explains the log".into()
        }
        Verdict::NoMissingEffect => "nothing is missing: the base model explains the log".into(),
        Verdict::MissingEffects => format!("missing: {names}"),
        Verdict::Ambiguous => format!("ambiguous: {names} or a rival"),
        Verdict::PartlyExplained => partly_explained(finding, &names),
        Verdict::Unexplained if finding.nothing_new => {
            let what = finding.nothing_new_in_words();
            format!("{what}: hardly more is left than the model left when it was identified")
        }
        Verdict::Unexplained if finding.differs.is_some() => {
            "unexplained: the logs are not of one rig as it was; see the note on what each of them says".into()
        }
        Verdict::Unexplained if !finding.left_out.is_empty() => format!(
            "unexplained: nothing is missing{}",
            finding.outside_in_words()
        ),
        Verdict::Unexplained if finding.may_be_slow_noise() => format!(
            "unexplained: {:.2} times what noise and the motion's errors allow remains, which may be slow noise of \
             the force or an effect that is not in the catalogue",
            finding.ratio_after
        ),
        Verdict::Unexplained if closest(finding).is_some() => {
            "unexplained: something is missing, and no effect of the catalogue stands out".into()
        }
        Verdict::Unexplained => {
            "unexplained: something is missing that is not in the catalogue".into()
        }
    }
}

/// What was found, then what remains: "time_delay explains 74 % of the disagreement; 14 times the noise
/// remains, 40 % of it in holds".
fn partly_explained(finding: &Finding, names: &str) -> String {
    let explains = match finding.effects.len() {
        1 => "explains",
        _ => "explain",
    };
    let share = share_in_words(finding.explained_share().unwrap_or(0.0));
    let remains = match finding.slow_remainder {
        Some(_) => "what remains is no noise".into(),
        None => format!(
            "{:.1} times what noise and the motion's errors allow remains{}",
            finding.ratio_after,
            match finding.is_beside_remainder {
                true => ", about as much as when the model was identified",
                false => "",
            }
        ),
    };
    let outside = finding.outside_in_words();
    let text = format!(
        "partly explained: {names} {explains} {share} of the disagreement{outside}; {remains}"
    );
    match regions_in_words(finding.remaining.get(..1).unwrap_or_default()) {
        words if words.is_empty() => text,
        words => format!("{text}: {}", words.replace("of the excess ", "of it ")),
    }
}

/// The set of effects that came closest to a log that is not explained, if it takes off most of what noise does not.
fn closest(finding: &Finding) -> Option<&Candidate> {
    let is_unexplained = finding.verdict == Verdict::Unexplained;
    nearest(&finding.ladder).filter(|_| is_unexplained)
}

/// The first set of a ladder that says something, if it takes most of the base's excess off.
fn nearest(ladder: &[Candidate]) -> Option<&Candidate> {
    let excess = |set: &Candidate| (set.ratio * set.ratio - 1.0).max(0.0);
    let base = ladder.iter().find(|set| set.ids.is_empty())?;
    let best = ladder.iter().find(|set| says_something(set))?;
    (excess(best) < 0.5 * excess(base)).then_some(best)
}

/// Whether a set has effects, and none of them is a series of waves, which follows any curve.
fn says_something(set: &Candidate) -> bool {
    let often = |id: &EffectId| set.ids.iter().filter(|other| *other == id).count() > 1;
    let mut each = set.ids.iter();
    !set.ids.is_empty() && !each.any(|id| id.info().repeats.has_spectrum() && often(id))
}

/// The closest set, with the next that has none of its effects if that is hardly behind.
fn closest_in_words(best: &Candidate, ladder: &[Candidate]) -> String {
    let leaves =
        |set: &Candidate| format!("{} ({:.1} times the noise)", listed(&set.ids), set.ratio);
    let is_rival = |set: &&Candidate| {
        says_something(set)
            && set.ratio < 1.5 * best.ratio
            && best.ids.iter().all(|id| !set.ids.contains(id))
    };
    let why = match ladder.iter().find(is_rival) {
        Some(rival) => format!("closely followed by {}", leaves(rival)),
        None => "not all of the log bears it out".into(),
    };
    format!("{}, not named: {why}", leaves(best))
}

/// The names of effects, each once: a spectrum has its effect several times.
fn listed(ids: &[EffectId]) -> String {
    let mut names: Vec<String> = Vec::new();
    for (at, id) in ids.iter().enumerate() {
        let times = ids.iter().filter(|other| *other == id).count();
        match times {
            _ if ids[..at].contains(id) => {}
            1 => names.push(id.name().into()),
            _ => names.push(format!("{times} × {}", id.name())),
        }
    }
    match names.split_last() {
        Some((last, others)) if !others.is_empty() => format!("{} and {last}", others.join(", ")),
        _ => names.concat(),
    }
}

fn error(finding: &Finding) -> String {
    let (unit, values) = column(&[finding.rmse_before_n, finding.rmse_after_n], 4, "N");
    let value = |at: usize| format!("{}\u{a0}{unit}", values.get(at).map_or("–", String::as_str));
    let allowed = "times what noise and the motion's errors allow";
    match finding.effects.is_empty() {
        true => format!(
            "{} rms on held-out parts: {:.2} {allowed}",
            value(0),
            finding.ratio_before
        ),
        false => format!(
            "{} before, {} after, rms on held-out parts: {:.2} and {:.2} {allowed}",
            value(0),
            value(1),
            finding.ratio_before,
            finding.ratio_after
        ),
    }
}

fn floor(finding: &Finding) -> String {
    let mut each: Vec<&str> = finding.floors.iter().map(|own| own.why.as_str()).collect();
    each.dedup();
    let noise = quantity(finding.noise_floor_n, 3, "N");
    format!("{noise} {}", each.join("; "))
}

/// An effect: its parameters below each other, then what it explains.
fn effect(text: &mut String, missing: &MissingEffect) {
    line(
        text,
        "effect",
        &format!("{} ({})", missing.id.name(), missing.grade.name()),
    );
    let widest = missing
        .parameters
        .iter()
        .map(|parameter| parameter.name.chars().count())
        .max()
        .unwrap_or(0);
    for parameter in &missing.parameters {
        let _ = writeln!(
            text,
            "{INDENT}  {:<widest$}  {}",
            parameter.name,
            measured(parameter)
        );
    }
    let mut said = format!(
        "without it the squared error is {} (held-out gain {:.1} %)",
        times_larger(missing.held_out_gain),
        100.0 * missing.held_out_gain
    );
    if !missing.place.is_empty() {
        let _ = write!(
            said,
            "; of that, {}",
            missing.place.replace("of the excess ", "")
        );
    }
    line(text, "", &said);
    if !missing.alternatives.is_empty() {
        let others: Vec<&str> = missing.alternatives.iter().map(|id| id.name()).collect();
        line(text, "", &format!("may instead be {}", others.join(" or ")));
    }
}

/// The parameters of the base in a table: before and after where effects changed them.
fn base(text: &mut String, finding: &Finding) {
    if finding.base_after.is_empty() {
        return;
    }
    let changed = !finding.effects.is_empty();
    let mut rows = vec![["".into(), "before".to_string(), "after".to_string()]];
    for (before, after) in finding.base_pairs() {
        let before = before.map_or("–".into(), measured);
        rows.push([after.name.clone(), before, measured(after)]);
    }
    let width = |at: usize| {
        rows.iter()
            .map(|row: &[String; 3]| row[at].chars().count())
            .max()
            .unwrap_or(0)
    };
    let (name, value) = (width(0), width(1));
    for (at, [parameter, before, after]) in rows.iter().enumerate() {
        let label = if at == 0 { "base" } else { "" };
        let row = match changed {
            true => format!("  {label:<12}{parameter:<name$}  {before:<value$}  {after}"),
            false if at == 0 => continue,
            false => {
                let label = if at == 1 { "base" } else { "" };
                format!("  {label:<12}{parameter:<name$}  {after}")
            }
        };
        let _ = writeln!(text, "{}", row.trim_end());
    }
}

fn measured(estimate: &ParameterEstimate) -> String {
    let value = Measured::new(estimate.value, estimate.std_error, estimate.unit);
    match (estimate.at_bound, estimate.remark()) {
        (true, _) => format!("{value} (at its bound)"),
        (_, Some(remark)) => format!("{value} ({remark})"),
        _ => value.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rate_that_may_as_well_be_nothing_is_said_to_be_slower_than_the_log() {
        let rate = |value: f64, std_error: f64| {
            measured(&ParameterEstimate {
                name: "rate".into(),
                value,
                std_error: Some(std_error),
                at_bound: false,
                unit: "1/s",
            })
        };
        assert_eq!(
            rate(1.0, 19.0),
            "1 ± 19\u{a0}1/s (slower than this log shows)"
        );
        assert_eq!(rate(0.50, 0.02), "0.500 ± 0.020\u{a0}1/s");
    }

    #[test]
    fn a_set_that_takes_most_off_is_told_with_what_is_hardly_behind() {
        use EffectId as E;
        let set = |ids: &[E], ratio: f64| Candidate {
            ids: ids.to_vec(),
            ratio,
        };
        // GIVEN a drag and an offset that a cantilever's record does not tell apart
        let (drag, base) = (set(&[E::AsymmetricDrag], 4.4), set(&[], 27.0));
        let ladder = [drag, set(&[E::ForceOffset], 4.5), base];
        let words = nearest(&ladder).map(|best| closest_in_words(best, &ladder));
        let both = "asymmetric_drag (4.4 times the noise), not named: closely followed by \
            force_offset (4.5 times the noise)";
        assert_eq!(words.as_deref(), Some(both));
        // AND one that has no rival
        let alone = [ladder[0].clone(), ladder[2].clone()];
        let words = nearest(&alone).map(|best| closest_in_words(best, &alone));
        assert!(words.is_some_and(|words| words.ends_with("not all of the log bears it out")));
        // THEN what takes little off is not told, and no series of waves.
        let series = set(&[E::SurfaceMotion, E::SurfaceMotion], 1.1);
        assert_eq!(nearest(&[series, set(&[], 27.0)]), None);
        assert_eq!(nearest(&[set(&[E::Cogging], 2.5), set(&[], 3.0)]), None);
    }

    #[test]
    fn names_stand_once_and_in_a_row() {
        use EffectId as E;
        assert_eq!(listed(&[]), "");
        assert_eq!(listed(&[E::Adhesion]), "adhesion");
        assert_eq!(
            listed(&[
                E::Adhesion,
                E::StressRelaxation,
                E::ForceLag,
                E::StressRelaxation
            ]),
            "adhesion, 2 × stress_relaxation and force_lag"
        );
    }
}
