//! `palpate gap`: where simulation and measurement disagree, which effects are missing, and the proof.
//!
//! The rooms, from the ground up:
//!
//! - `data` checks the logs, brings them within a budget, and gives them speed, acceleration and scales.
//! - `noise` says without any model what the noise of the force is: from second differences, from the spectrum at
//!   rest, without disturbances that are lines, and from stretches of the motion where nothing rests.
//! - `model` holds the law with effects and its free numbers, where their fits start, the least squares, the
//!   weights of the residuals, standard errors, and the bias that errors of the motion cause.
//! - `search` proposes effects from a linearized fit, then adds, swaps and drops them. Each time everything is
//!   refitted, and an effect must be significant. Over all sets that were fitted it weighs the evidence for each
//!   effect against what the best set leaves.
//! - `decide` refits at the log's own rate, checks on held-out parts, and compares with rivals. Where something
//!   remains, the effects with strong evidence stand, each for itself.
//! - `rounds` asks again for what remains beside what is named, until nothing more is. Where the model says what it left
//!   when it was identified, `as_identified` allows for that first, and `held` asks beside the numbers of its file as well.
//! - `units` asks first whether the log is in another unit than the model, or with another sign.
//! - `episodes` asks again without a short stretch that nothing explains.
//! - `lost_counts`, `zero_steps`, `surface_steps` and `dents` ask again where counts were lost, where the zero or the surface
//!   has stepped, and where a material was touched again before it had recovered: none of that is an effect of the catalogue.
//! - `experiment` predicts which effects a motion shows: `plan` before any log, `advise` after one.
//! - `say` makes the `finding` of it: regions, estimates, advice.
//!
//! Below all of them, [`thresholds`] holds what decides about answers, every number with its reason and how it was found.
//! The rooms are handed what they decide with, from [`Options`] down, so that a threshold is changed by its
//! name without a recompile: `cargo run --release -p tests --example hidden -- sweep` lists them, and
//! `sweep NAME` scores rigs with hidden effects with it at −25 %, as it is, and at +25 %.

mod as_identified;
mod data;
mod decide;
mod dents;
mod episodes;
mod experiment;
mod finding;
mod held;
mod lost_counts;
mod model;
mod noise;
mod options;
mod progress;
mod rounds;
mod say;
mod search;
mod surface_steps;
pub mod thresholds;
mod units;
mod zero_steps;

pub use experiment::plan::{FurtherMotion, Plan, PlannedEffect, plan};
pub use finding::{
    AdvisedMotion, Candidate, Change, ChangesSince, Curves, Episode, Finding, Grade, MOTION,
    MissingEffect, Next, ParameterEstimate, Pattern, Region, Support, Verdict, changes_in_words,
    regions_in_words, share_in_words, times_larger,
};
pub use noise::floor::NoiseFloor;
pub use options::Options;
pub use progress::{Progress, Silent};

use std::borrow::Cow;
use std::cell::Cell;

use rayon::prelude::*;

use self::model::dataset::Dataset;
use self::model::{given::given, shape::Term};
use as_identified::AsIdentified;
use data::fit_data::FitData;
use data::low_pass::LowPass;
use data::scales::Scales;
use data::{budget, hangs, input, leaps, orientation, ringing, spikes};
use noise::floors::{Floors, largest_correlation};
use rounds::{Answer, Rounds};
use say::{builder, each_log, plausibility::implausible};
use search::sets::keep_first;
use thresholds::{Floor, Input, Rest};

use crate::diagnostic::Diagnostic;
use crate::kind;
use crate::log::{UniformLog, agreed_kind};
use crate::model::{Environment, Model};

/// Most samples that the search uses.
const SEARCHED_SAMPLES: usize = 5_000;
/// Most samples that the last fits use.
const FITTED_SAMPLES: usize = 30_000;

/// Finds what a base model lacks to explain the logs of one rig.
///
/// # Errors
/// A model that does not describe a rig, or a log that nothing can be fitted to: it is too short, it has
/// no motion or no contact, or its columns are exchanged.
pub fn gap(model: &Model, logs: &[UniformLog], options: &Options) -> Result<Finding, Diagnostic> {
    gap_with_progress(model, logs, options, &Silent)
}

/// The same, and tells `progress` how far it is.
///
/// # Errors
/// As [`gap`].
pub fn gap_with_progress(
    model: &Model,
    logs: &[UniformLog],
    options: &Options,
    progress: &dyn Progress,
) -> Result<Finding, Diagnostic> {
    let kind = agreed_kind(model.kind, logs)?;
    let oriented = orientation::oriented(model, logs);
    let logs: &[UniformLog] = &oriented;
    let model = &model.clone().of_kind(kind);
    model.rig()?;
    kind::worded(kind, || workflow(model, logs, options, progress))
}

/// The workflow for logs of the model's kind of machine.
fn workflow(
    model: &Model,
    logs: &[UniformLog],
    options: &Options,
    progress: &dyn Progress,
) -> Result<Finding, Diagnostic> {
    progress.at(0.0, "noise floor and motion");
    let mut notes = input_notes(model, logs, &options.thresholds.input)?;
    let (measured, hangs) = hangs::left_out(logs);
    let (bridged, spikes) = spikes::bridged(&measured);
    let alone = |model: &Model, logs: &[UniformLog]| base_alone(model, logs, options);
    if let Some(mut finding) = units::mistaken(model, &bridged, |logs| alone(model, logs))? {
        let first = finding.mistaken.iter().cloned();
        finding.notes.splice(0..0, first.chain(notes));
        return Ok(finding);
    }
    let left_n = |logs: &[UniformLog]| Ok(alone(model, logs)?.rmse_before_n);
    let (closed, lost) = lost_counts::taken_back(&bridged, left_n)?;
    notes.extend(hangs.into_iter().chain(spikes).chain(lost));
    let ask = |logs: &[UniformLog]| beside_steps_and_dents(model, logs, options, progress);
    let mut finding = episodes::left_out(model, &closed, ask, alone)?;
    finding.notes.splice(0..0, notes);
    Ok(finding)
}

/// The workflow beside what a zero, a surface and a material may have done between touches.
fn beside_steps_and_dents(
    model: &Model,
    logs: &[UniformLog],
    options: &Options,
    progress: &dyn Progress,
) -> Result<Finding, Diagnostic> {
    let refit = |model: &Model, logs: &[UniformLog]| base_alone(model, logs, options);
    let ask = |model: &Model, first: Option<Finding>| {
        let first = Cell::new(first);
        zero_steps::taken_off(logs, |logs| {
            let ask = |logs: &[UniformLog]| match first.take() {
                Some(known) => Ok(known),
                None => asked(model, logs, options, progress),
            };
            surface_steps::taken_off(model, logs, ask, refit)
        })
    };
    let once = |model: &Model, most_added: usize| {
        let few = Options {
            most_added: most_added.min(options.most_added),
            ..options.clone()
        };
        asked(model, logs, &few, progress)
    };
    dents::allowed_for(model, ask, once, |model| refit(model, logs))
}

/// The finding of a model to which nothing may be added.
fn base_alone(
    model: &Model,
    logs: &[UniformLog],
    options: &Options,
) -> Result<Finding, Diagnostic> {
    let nothing = Options {
        catalogue: Vec::new(),
        ..options.clone()
    };
    asked(model, logs, &nothing, &Silent)
}

/// The workflow for logs in which the readings that are wrong are bridged or left out.
fn asked(
    model: &Model,
    whole: &[UniformLog],
    options: &Options,
    progress: &dyn Progress,
) -> Result<Finding, Diagnostic> {
    let given = given(model)?;
    let (options, of_bandwidth) = as_identified::with_bandwidth(model, options);
    let (options, thresholds) = (&options, &options.thresholds);
    let mut notes: Vec<String> = of_bandwidth.into_iter().collect();
    input::can_be_filtered(whole, options.bandwidth_hz, &thresholds.input)?;
    let low_pass = options.bandwidth_hz.map(|corner_hz| LowPass { corner_hz });
    let (logs, shortened) = budget::within(whole, thresholds.rest);
    notes.extend(shortened);
    let floors = floors(&logs, low_pass, &floor_decides(model, options));
    let (filtered, thinned) = fit_data((whole, &logs), low_pass, thresholds.rest);
    notes.extend(thinned);
    let samples: usize = filtered.iter().map(FitData::len).sum();
    let coarse = at_most(&filtered, samples, SEARCHED_SAMPLES);
    let fine = at_most(&filtered, samples, FITTED_SAMPLES);
    let scales = Scales::of(&coarse);
    let dataset = |logs| Dataset {
        logs,
        floors: &floors.fast,
        low_pass,
        scales: &scales,
        known: None,
        thresholds,
    };
    let step = samples.div_ceil(SEARCHED_SAMPLES);
    let catalogue = options.catalogue_of(kind::of_words());
    let rounds = Rounds {
        coarse: dataset(&coarse),
        fine: dataset(&fine),
        ids: &catalogue,
        most_added: options.most_added,
        correlation: largest_correlation(&floors.fast, &coarse, step),
        progress,
    };
    let as_identified = AsIdentified::of(model, options, &logs, step);
    let known = as_identified.as_ref();
    notes.extend(known.and_then(|own| own.noise_in_words(&floors.fast)));
    let of_model = (&model.environment, given.as_slice());
    let (rounds, answer, is_beside) = answered_beside(&rounds, &floors, step, of_model, known);
    notes.extend(is_beside.then(|| as_identified::NOTE.into()));
    progress.at(0.95, "regions and errors");
    let (decision, ladder) = (&answer.decision, answer.ladder);
    let mut finding = builder::finding(model, &rounds.fine, decision, ladder, options);
    let fits = [&answer.closest, &decision.base];
    finding.episode = episodes::of(finding.verdict, &rounds.fine, fits);
    notes.extend(implausible(model, &whole[0], &finding, thresholds));
    finding.differs = each_log::in_words(&rounds.fine, decision, whole);
    if finding.differs.is_some() && finding.verdict == Verdict::Unexplained {
        finding.advice = "Ask about each log by itself, or without the one that differs.".into();
    }
    notes.extend(finding.differs.clone());
    finding.notes.splice(0..0, notes);
    Ok(finding)
}

/// The same beside what the model is `known` to have left, and whether that was allowed for. What the noise hides of it is
/// asked for only where nothing else explains the log.
fn answered_beside<'a>(
    rounds: &Rounds<'a>,
    floors: &'a Floors,
    step: usize,
    of_model: (&Environment, &[Term]),
    known: Option<&AsIdentified>,
) -> (Rounds<'a>, Answer, bool) {
    let asked = || answered(rounds, floors, step, of_model);
    let first = known.filter(|own| own.left_little()).map(|_| asked());
    let is_answered = |(_, answer): &(_, Answer)| answer.decision.verdict != Verdict::Unexplained;
    let new = match first.as_ref().is_some_and(is_answered) {
        true => None,
        false => known.and_then(|own| own.answer(rounds, of_model.0, of_model.1)),
    };
    match new {
        Some(answer) => (*rounds, answer, true),
        None => {
            let (rounds, answer) = first.unwrap_or_else(asked);
            (rounds, answer, false)
        }
    }
}

/// What is missing in an environment with effects, and what it was asked with: the slow noise too, where that may be
/// all that remains.
fn answered<'a>(
    rounds: &Rounds<'a>,
    floors: &'a Floors,
    step: usize,
    (environment, given): (&Environment, &[Term]),
) -> (Rounds<'a>, Answer) {
    let answer = rounds.answer(environment, given);
    if !answer.leaves_what_may_be_noise(floors.times()) {
        return (*rounds, answer);
    }
    let beside = rounds.with(
        &floors.slow,
        largest_correlation(&floors.slow, rounds.coarse.logs, step),
    );
    let slow = beside.answer(environment, given);
    match slow.takes_names_back(&answer) {
        true => (*rounds, answer),
        false => (beside, slow),
    }
}

/// What decides on the noise floors of a rig.
fn floor_decides(model: &Model, options: &Options) -> Floor {
    match model.environment.is_free() {
        true => options.thresholds.floor.without_free_air(),
        false => options.thresholds.floor,
    }
}

/// The noise floors of the forces that are fitted.
fn floors(logs: &[Cow<'_, UniformLog>], low_pass: Option<LowPass>, decide: &Floor) -> Floors {
    let both = |log: &Cow<'_, UniformLog>| {
        let fast = NoiseFloor::of(log, decide);
        let slow = fast.with_slow_noise();
        let Some(low_pass) = low_pass else {
            return (fast, slow);
        };
        let (filtered, white_share) = low_pass.behind(log);
        let in_band = |floor: NoiseFloor| floor.in_band((log, &filtered), white_share, decide);
        (in_band(fast), in_band(slow))
    };
    let (fast, slow) = logs.par_iter().map(both).unzip();
    Floors { fast, slow }
}

/// What looks wrong in the logs, and what their reader noted.
fn input_notes(
    model: &Model,
    logs: &[UniformLog],
    decide: &Input,
) -> Result<Vec<String>, Diagnostic> {
    let mut notes = Vec::new();
    for log in logs {
        notes.extend(input::suspected(model, log, decide)?);
        notes.extend(log.notes.iter().cloned());
    }
    // Of several logs of a rig each says the same.
    keep_first(&mut notes, String::clone);
    Ok(notes)
}

/// The logs, of which the `whole` ones are known too, with speeds and accelerations and through the low-pass, with notes on what was left out or thinned.
/// With a low-pass nothing is: it needs equally spaced samples, and takes what rings away.
fn fit_data(
    (whole, logs): (&[UniformLog], &[Cow<'_, UniformLog>]),
    low_pass: Option<LowPass>,
    decide: Rest,
) -> (Vec<FitData>, Vec<String>) {
    let of = |log: &Cow<'_, UniformLog>| match &log.taken {
        // A low-pass needs equally spaced samples.
        Some(taken) if low_pass.is_none() => FitData::of(log).as_taken(taken),
        _ => FitData::of(log),
    };
    let mut data: Vec<FitData> = logs.par_iter().map(of).collect();
    budget::leave_lead_in_out(&mut data, whole);
    let mut notes = Vec::new();
    if low_pass.is_none() {
        notes.extend(leaps::left_out(&mut data, logs.iter().map(|log| &**log)));
        notes.extend(ringing::left_out(&mut data));
        notes.extend(budget::thin_rests(&mut data, FITTED_SAMPLES, decide));
    }
    let filtered = data.iter().map(|log| log.filtered(low_pass)).collect();
    (filtered, notes)
}

/// The logs thinned to at most `most` samples together.
fn at_most(logs: &[FitData], samples: usize, most: usize) -> Vec<FitData> {
    let step = samples.div_ceil(most);
    logs.iter().map(|log| log.thinned(step)).collect()
}
