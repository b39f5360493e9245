//! `--compensate`: a log as it would read without the rig's own effects.
//!
//! The core's [`Compensation`] runs over the log in double precision; what comes out is the position
//! of the tip and the contact force, for whatever estimator follows. Effects of the material stay.

mod turning;

use std::ops::Range;
use std::path::Path;

use estimator_core::Fault;
use estimator_core::estimate::compensation::Compensation;

use crate::diagnostic::{Diagnostic, listed};
use crate::log::UniformLog;
use crate::model::Model;
use crate::number::{counted, quantity};
use crate::signal::step;
use turning::turning;

/// The log without what the rig of the model at `path` adds.
///
/// # Errors
/// A model that cannot be used, or a delay longer than a compensation remembers.
pub fn read(log: UniformLog, path: &Path) -> Result<UniformLog, Diagnostic> {
    compensate(&log, &Model::read(path)?)
}

/// The log without what the model's rig adds.
///
/// # Errors
/// As [`read`].
pub fn compensate(log: &UniformLog, model: &Model) -> Result<UniformLog, Diagnostic> {
    let rig = model.rig()?;
    let count_m = log.position_step_m.or_else(|| step(&log.position_m));
    let rate_hz = log.rate_hz as f32;
    let compensation = Compensation::<f64>::new(&rig.effects, rate_hz, count_m.unwrap_or(0.0))
        .map_err(|error| {
            Diagnostic::new("the effects cannot be compensated at this rate")
                .in_file(&model.path)
                .at_key(&format!("effect.{}", error.field))
                .value(error.value)
                .note(format!("the log has {} Hz", log.rate_hz))
                .remedy(format!("it {}", error.expected))
        })?;
    let turns = turning(log, &rig.effects, count_m.unwrap_or(0.0));
    let mut out = run(log, &compensation);
    out.position_step_m = count_m;
    let late = log.len() - out.len();
    bridge(
        &mut out,
        turns
            .iter()
            .map(|own| own.start.saturating_sub(late)..own.end.saturating_sub(late)),
    );
    let names = |own: bool| {
        let effects = rig.effects().map(|effect| effect.id());
        let names = effects.filter(move |id| id.belongs_to_rig() == own);
        names.map(|id| id.name().to_string()).collect::<Vec<_>>()
    };
    let (off, stay) = (names(true), names(false));
    out.notes.extend(notes(&off, &stay, model, &compensation));
    out.compensated.effects = off;
    let turning = out.compensated.turning.iter().filter(|at| **at).count();
    if turning > 0 {
        out.notes.push(format!(
            "{} where a friction turns or comes to rest: to which side it goes is not known to the sample, so they are not learned from",
            counted(turning, "sample")
        ));
    }
    let saturated = out.compensated.saturated.iter().filter(|at| **at).count();
    if saturated > 0 {
        out.notes.push(format!(
            "{} at the load cell's limit or within the window of one: not learned from",
            counted(saturated, "sample")
        ));
    }
    Ok(out)
}

fn notes(
    off: &[String],
    stay: &[String],
    model: &Model,
    compensation: &Compensation<f64>,
) -> Vec<String> {
    let listed = |names: &[String]| listed(names.iter().map(String::as_str));
    let mut notes = Vec::new();
    let of = model.path.display();
    notes.push(match off.is_empty() {
        true => format!("{of} has no effect of the rig to compensate"),
        false => format!(
            "compensated as in {of}: {}; depth is that of the tip, force that of the contact, of {} ago",
            listed(off),
            quantity(compensation.delay_s(), 3, "s")
        ),
    });
    if !stay.is_empty() {
        notes.push(format!(
            "of what is touched, and not compensated: {}",
            listed(stay)
        ));
    }
    notes
}

/// The whole log, each result at the instant that it belongs to; the first ones have no past.
fn run(log: &UniformLog, compensation: &Compensation<f64>) -> UniformLog {
    let delay_s = compensation.delay_s();
    let late = (delay_s * log.rate_hz).ceil() as usize;
    let memory = compensation.memory_samples() - 1;
    let start_s = log.time_s.first().copied().unwrap_or(0.0);
    let mut out = UniformLog {
        path: log.path.clone(),
        kind: log.kind,
        source: log.source.clone(),
        rate_hz: log.rate_hz,
        untouched: false,
        slower: log.slower.clone(),
        notes: log.notes.clone(),
        ..UniformLog::default()
    };
    // The window colours the noise: its strength stays that of the raw force.
    out.compensated.noise_n = Some(log.force_noise_n());
    let mut state = compensation.at_rest();
    for index in 0..log.len() {
        let sample = compensation.step(&mut state, log.sample(index));
        if index < late {
            continue;
        }
        out.time_s
            .push(start_s + index as f64 * log.period_s() - delay_s);
        out.position_m.push(sample.position_m);
        out.force_n.push(sample.force_n);
        out.in_gap
            .push(log.in_gap[index.saturating_sub(memory)..=index].contains(&true));
        let saturated = sample.faults.has(Fault::ForceSaturated);
        out.compensated.saturated.push(saturated);
    }
    out
}

/// Draws a line over each stretch in which it is not known to which side a friction goes: what is taken off would step there,
/// which in free air is a touch of 5 ms.
fn bridge(out: &mut UniformLog, turns: impl Iterator<Item = Range<usize>>) {
    out.compensated.turning = vec![false; out.len()];
    for own in turns.filter(|own| !own.is_empty()) {
        let known = |at: Option<usize>| at.and_then(|at| out.force_n.get(at)).copied();
        let (before, after) = (known(own.start.checked_sub(1)), known(Some(own.end)));
        let Some((from_n, to_n)) = before.or(after).zip(after.or(before)) else {
            continue;
        };
        let steps = (own.len() + 1) as f64;
        for (step, at) in own.enumerate() {
            out.force_n[at] = from_n + (to_n - from_n) * (step + 1) as f64 / steps;
            out.compensated.turning[at] = true;
        }
    }
}

#[cfg(test)]
mod tests;
