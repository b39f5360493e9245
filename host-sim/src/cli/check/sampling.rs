//! How a log was sampled, in words.

use crate::log::{Gap, Log, Sampling, Stamps, Timing};
use crate::number::{counted, quantity};

/// The lines of `check` about time, without the notes of the reader.
pub(super) fn lines(raw: &Log, facts: &Sampling) -> Vec<String> {
    let timing = raw.timing();
    let first = format!(
        "{} samples, {}, {} Hz, {}",
        raw.len(),
        quantity(raw.duration_s(), 4, "s"),
        (facts.rate_hz * 1e3).round() / 1e3,
        evenness(facts, &timing),
    );
    let further = [missing, coarse_stamps, pieces, toggling];
    let mut lines = vec![first];
    lines.extend(further.into_iter().filter_map(|say| say(facts)));
    lines.extend(facts.slower.iter().map(|(from_s, to_s)| {
        let long = timing.gaps.iter();
        let within = long.filter(|gap| (*from_s..*to_s).contains(&gap.from_s));
        format!(
            "{} in a row from {from_s} to {to_s} s: sampled more slowly there",
            counted(within.count(), "gap")
        )
    }));
    lines
}

/// Below a millionth of a period it is the rounding of the stamps.
fn evenness(facts: &Sampling, timing: &Timing) -> String {
    let scatter = |jitter_s: f64| quantity(jitter_s, 2, "s");
    match facts.stamps {
        Stamps::Even if timing.jitter_s > 1e-6 * timing.base_period_s => {
            format!("jitter {}", scatter(timing.jitter_s))
        }
        Stamps::Even => "no jitter".into(),
        Stamps::Jittered if facts.is_rounding() => {
            "no jitter beyond the rounding of the stamps".into()
        }
        Stamps::Jittered => format!(
            "the stamps jitter by {} rms, the sampling itself is even",
            scatter(facts.jitter_s)
        ),
        Stamps::Uneven => format!("sampled unevenly, by {} rms", scatter(facts.jitter_s)),
    }
}

fn missing(facts: &Sampling) -> Option<String> {
    let drops = &facts.drops;
    let length = |gap: &&Gap| gap.to_s - gap.from_s;
    let longest = drops
        .gaps
        .iter()
        .max_by(|a, b| length(a).total_cmp(&length(b)))?;
    Some(format!(
        "{}: {} missing ({:.2} %), the longest from {} to {} s",
        counted(drops.gaps.len(), "gap"),
        counted(drops.missing, "sample"),
        100.0 * drops.share,
        longest.from_s,
        longest.to_s
    ))
}

/// A step of the stamps that does not divide the period rounds every stamp.
fn coarse_stamps(facts: &Sampling) -> Option<String> {
    let step_s = facts.resolution_s?;
    let steps = 1.0 / (facts.clock_rate_hz * step_s);
    let divides = (steps - steps.round()).abs() < 1e-3 * steps;
    (!divides && steps < 1000.0).then(|| {
        let step = quantity(step_s, 2, "s");
        format!("the stamps are rounded to {step}: {steps:.1} steps a sample")
    })
}

fn pieces(facts: &Sampling) -> Option<String> {
    let pieces = &facts.segments;
    (pieces.len() > 1).then(|| {
        let each = pieces.iter().map(|(from, to)| format!("{from} to {to}"));
        format!(
            "in {} pieces: {} s",
            pieces.len(),
            each.collect::<Vec<_>>().join(", ")
        )
    })
}

fn toggling(facts: &Sampling) -> Option<String> {
    (facts.toggles > 0).then(|| {
        format!(
            "the position goes one count there and back {}: a path with as few turns as possible keeps that out of \
             the speed",
            counted(facts.toggles, "time")
        )
    })
}
