//! A log in another unit, or with another sign, than the model: asked before any effect is.
//!
//! Effects fit what is read wrong: a position the other way round was a cable of −3 kN/m and a delay of −12 ms, both with strong
//! evidence, and a force in grams had a friction of 28 N. Where the model does not foretell the size of the force at all, and
//! one change of a unit or a sign brings its numbers back, that is said, and no effect is named.

use super::data::fit_data::FitData;
use super::finding::Finding;
use super::model::simulate::forces_of;
use crate::diagnostic::Diagnostic;
use crate::inspect::falls_inwards;
use crate::kind::Kind;
use crate::log::{Channel, UniformLog};
use crate::model::Model;
use crate::stats::{highest, lowest, range};

/// The force spans this many times more or less than the model as it is foretells. Derived: a gram's weight is 102 times less
/// than a newton, and a model that is off by three is no unit.
const SUSPICIOUS: f64 = 30.0;
/// With the right unit the stiffness is the model's within this factor.
const AS_GIVEN: f64 = 3.0;
/// With the right sign less than this share (rms) is left. Forces and positions the other way round left 100 to 1000 times as
/// much.
const LESS: f64 = 0.5;

/// A travel (m) beyond which a position rather than a force is in another unit: where a force is linear in the depth a
/// thousandth of the stiffness is either. Half a metre is more than rigs that press travel.
const LONG_M: f64 = 0.5;

/// Factors to SI of forces and of positions, with the unit that they are of.
const FORCES: [(f64, &str); 4] = [
    (1e-3, "millinewtons"),
    (9.80665e-3, "grams of weight"),
    (1e-6, "micronewtons"),
    (1e3, "kilonewtons"),
];
const POSITIONS: [(f64, &str); 3] = [
    (1e-3, "millimetres"),
    (1e-6, "micrometres"),
    (25.4e-3, "inches"),
];

/// The finding without effects on logs that seem to be in another unit or to have another sign; `refit` fits the model alone.
///
/// # Errors
/// Those of `refit`, and a model that describes no rig.
pub(super) fn mistaken(
    model: &Model,
    logs: &[UniformLog],
    refit: impl Fn(&[UniformLog]) -> Result<Finding, Diagnostic>,
) -> Result<Option<Finding>, Diagnostic> {
    // Which way a machine goes that touches nothing its own friction says (`data::orientation`).
    let may_turn = !model.environment.is_free();
    let falls = may_turn && logs.iter().all(|log| falls_inwards(log).is_some());
    if !falls && !is_another_size(model, logs)? {
        return Ok(None);
    }
    let mut finding = refit(logs)?;
    let why = match falls {
        true => another_sign(logs, finding.rmse_before_n, refit)?,
        false => another_unit(model, logs, &finding, refit),
    };
    let Some(why) = why else { return Ok(None) };
    finding.advice = format!("Ask again with {}.", why.1);
    finding.mistaken = Some(why.0);
    Ok(Some(finding))
}

/// Whether the force spans much more or less than the model as it is foretells.
fn is_another_size(model: &Model, logs: &[UniformLog]) -> Result<bool, Diagnostic> {
    let rig = model.rig()?;
    let span_n = |log: &UniformLog| {
        let data = [FitData::of(log)];
        range(&log.force_n) / range(&forces_of(&rig, &data))
    };
    let is_near = |times: f64| (1.0 / SUSPICIOUS..=SUSPICIOUS).contains(&times);
    Ok(!logs.iter().any(|log| is_near(span_n(log))))
}

/// Why, and what the columns are then.
type Reason = (String, String);

/// The channel that seems to be the other way round.
fn another_sign(
    logs: &[UniformLog],
    as_read_n: f64,
    refit: impl Fn(&[UniformLog]) -> Result<Finding, Diagnostic>,
) -> Result<Option<Reason>, Diagnostic> {
    let mut best: Option<(f64, Channel)> = None;
    for channel in [Channel::Force, Channel::Position] {
        let n = refit(&times(logs, channel, -1.0))?.rmse_before_n;
        if best.is_none_or(|(least, _)| n < least) {
            best = Some((n, channel));
        }
    }
    let told = best.filter(|(n, _)| *n < LESS * as_read_n);
    Ok(told.map(|(_, channel)| {
        let name = name(channel);
        let option = logs[0].columns().option(&[(channel, -1.0)]);
        let why = format!(
            "the {name} seems to have the other sign: it is the other way round than in the model, and no effect is asked for \
             ({option})"
        );
        (why, option)
    }))
}

/// The channel that seems to be in another unit, beside what is found `as_read`.
fn another_unit(
    model: &Model,
    logs: &[UniformLog],
    as_read: &Finding,
    refit: impl Fn(&[UniformLog]) -> Result<Finding, Diagnostic>,
) -> Option<Reason> {
    let times_given = times_given(model, as_read);
    // A model whose own units are right finds its stiffness again, whatever it starts from.
    if times_given.is_some_and(|times| off(times) < SUSPICIOUS) {
        return None;
    }
    let mut units: Vec<(f64, Channel, f64, &str)> = Vec::new();
    let is_free = model.environment.is_free();
    let is_long = !is_free && logs.iter().any(|log| range(&log.position_m) > LONG_M);
    // The stiffness is as many times a force's unit as the force is: nothing must be fitted again.
    let is_turning = model.kind == Some(Kind::Rotary);
    for (factor, unit) in FORCES.into_iter().filter(|_| !is_long) {
        units.extend(times_given.map(|own| (off(own * factor), Channel::Force, factor, unit)));
    }
    if !is_free && !units.iter().any(|own| own.0 < AS_GIVEN) {
        for (factor, unit) in POSITIONS {
            // In some units nothing can be fitted.
            let found = refit(&times(logs, Channel::Position, factor)).ok();
            let own = found.and_then(|found| self::times_given(model, &found));
            units.extend(own.map(|own| (off(own), Channel::Position, factor, unit)));
        }
    }
    let nearest = units.into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
    let told = nearest.filter(|own| own.0 < AS_GIVEN);
    told.map(|(_, channel, factor, unit)| {
        let name = name(channel);
        let option = logs[0].columns().option(&[(channel, factor)]);
        let unit = match is_turning {
            true => format!("{} metres", unit.trim_end_matches('s')),
            false => unit.into(),
        };
        let why = format!(
            "the {name} seems to be in {unit}: so its numbers are about the model's, else they are of another order, and no \
             effect is asked for ({option})"
        );
        (why, option)
    })
}

/// How many times the model's the stiffness of a finding is; `None` where it touches nothing. Of a machine that touches nothing,
/// how many times as large its masses, drags and forces are, if two or more agree.
fn times_given(model: &Model, finding: &Finding) -> Option<f64> {
    let found = |name: &str| finding.base_before.iter().find(|own| own.name == name);
    if model.environment.is_free() {
        let each = model.effects.iter().flat_map(|effect| {
            let name = |own: &str| format!("{}.{own}", effect.id);
            let pairs = effect.parameters.iter();
            pairs.filter_map(move |(own, given)| {
                let found = found(&name(own))?;
                is_of_force(found.unit).then_some(found.value / given)
            })
        });
        let times: Vec<f64> = each.filter(|times| *times > 0.0).collect();
        let (least, most) = (
            lowest(times.iter().copied()),
            highest(times.iter().copied()),
        );
        return (times.len() > 1 && most < AS_GIVEN * least).then(|| (least * most).sqrt());
    }
    let mut depths = finding.curves.iter().flat_map(|own| &own.depth_m);
    if !depths.any(|depth| *depth > 0.0) {
        return None;
    }
    let given = model.environment.parameters();
    let given = given.iter().find(|own| own.name == "stiffness")?;
    Some(found("stiffness")?.value / given.value)
}

/// Whether a unit is in proportion to that of the force.
fn is_of_force(unit: &str) -> bool {
    unit.starts_with('N') || unit.starts_with("kg")
}

/// By which factor, of either side, a number is off.
fn off(times: f64) -> f64 {
    times.max(1.0 / times)
}

const fn name(channel: Channel) -> &'static str {
    match channel {
        Channel::Time => "time",
        Channel::Position => "position",
        Channel::Force => "force",
    }
}

/// Logs with a channel times a factor.
fn times(logs: &[UniformLog], channel: Channel, factor: f64) -> Vec<UniformLog> {
    let scaled = |log: &UniformLog| {
        let mut log = log.clone();
        let (own, taken) = match channel {
            Channel::Position => {
                log.position_step_m = log.position_step_m.map(|step| step * factor.abs());
                (
                    &mut log.position_m,
                    log.taken.as_mut().map(|own| &mut own.position_m),
                )
            }
            _ => (
                &mut log.force_n,
                log.taken.as_mut().map(|own| &mut own.force_n),
            ),
        };
        let all = taken.into_iter().chain([own]).flatten();
        all.for_each(|value| *value *= factor);
        log
    };
    logs.iter().map(scaled).collect()
}
