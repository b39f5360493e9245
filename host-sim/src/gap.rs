//! `palpate gap`: where simulation and measurement disagree, what is missing, and the proof.
//!
//! The steps, a file a word: `floor` says what noise leaves without any model, by the rests' `spectrum`
//! and without a disturbance's `line`; `course` is a log as the fits see it, `standstill` what is done to
//! its speeds near rests; `shape` says which numbers a law with effects has, `fit` finds them; `weights`
//! says what a residual may be; `start` says where a candidate may start, `propose` what it promises there;
//! `search` adds, swaps and drops effects, each time refitting everything, for a `price`; `decide` judges
//! on held-out parts; `attenuation` takes off what the errors of the motion do to the numbers; `regions` says
//! where, `error` how well, also where noise is `coloured`; `files` writes it down. `plan` says before
//! any log what a motion will show: `menu` has the motions, `apart` what tells effects apart, `record` writes the one to
//! record next. Before all that
//! `input` refuses what cannot be fitted.

mod data;
mod decide;
mod experiment;
mod finding;
mod model;
mod noise;
mod options;
mod progress;
mod say;
mod search;

pub use experiment::plan::{Further, Plan, Planned, plan};
pub use finding::{
    Advised, Curves, Finding, Known, MOTION, Named, Region, Tried, Verdict, times_larger, words,
};
pub use noise::floor::Floor;
pub use options::Options;
pub use progress::{Progress, Silent};
pub(crate) use say::regions::phase;

use rayon::prelude::*;

use data::fit_data::Course;
use data::low_pass::LowPass;
use data::scales::Scales;
use data::{budget, input};
use decide::evidence::Evidence;
use model::given::given;
use say::{builder, plausibility};
use search::search::Search;

use crate::diagnostic::Diagnostic;
use crate::log::UniformLog;
use crate::model::Model;

/// Samples of a search, and of the last fits.
const SEARCHED: usize = 5_000;
const FITTED: usize = 30_000;

/// Finds what a base model lacks to explain logs of one rig.
///
/// # Errors
/// A model that is no rig, or a log that nothing can be fitted to: see `input`.
pub fn gap(model: &Model, logs: &[UniformLog], options: &Options) -> Result<Finding, Diagnostic> {
    gap_watched(model, logs, options, &Silent)
}

/// The same, with somebody to tell how far it is.
///
/// # Errors
/// As [`gap`].
pub fn gap_watched(
    model: &Model,
    logs: &[UniformLog],
    options: &Options,
    progress: &dyn Progress,
) -> Result<Finding, Diagnostic> {
    model.rig()?;
    progress.at(0.0, "noise floor and motion");
    let given = given(model)?;
    let mut said = Vec::new();
    for log in logs {
        said.extend(input::suspected(model, log)?);
        said.extend(log.notes.iter().cloned());
    }
    let low_pass = options.bandwidth_hz.map(|corner_hz| LowPass { corner_hz });
    let (logs, mut notes) = budget::within(logs);
    let floors: Vec<Floor> = logs.par_iter().map(|log| Floor::of(log)).collect();
    let mut raw: Vec<Course> = logs.par_iter().map(|log| Course::of(log)).collect();
    if low_pass.is_none() {
        notes.extend(budget::shorten(&mut raw, FITTED));
    }
    let samples: usize = raw.iter().map(Course::len).sum();
    let filtered: Vec<Course> = raw.iter().map(|course| course.filtered(low_pass)).collect();
    let thinned = |most: usize| -> Vec<Course> {
        let step = samples.div_ceil(most);
        filtered.iter().map(|course| course.thinned(step)).collect()
    };
    let (coarse, fine) = (thinned(SEARCHED), thinned(FITTED));
    let scales = Scales::of(&coarse);
    let mut search = Search {
        courses: &coarse,
        floors: &floors,
        low_pass,
        weights: vec![1.0; coarse.iter().map(Course::len).sum()],
        base: &model.environment,
        given: &given,
        scales: &scales,
        ids: &options.catalogue,
        progress,
        floor: 0.0,
        tried: Vec::new(),
        correlation: floors
            .iter()
            .map(|own| own.correlation / samples.div_ceil(SEARCHED) as f64)
            .fold(1.0, f64::max),
    };
    progress.at(0.05, "fitting the base");
    let base = search.base_fit();
    search.weigh(&base);
    let base = search.refitted(&base);
    let found = search.run(base.clone());
    let evidence = Evidence {
        courses: &fine,
        floors: &floors,
        low_pass,
        scales: &scales,
    };
    let ladder = search.ladder(&base, &found);
    progress.at(0.8, "held-out part and rivals");
    let decision = evidence.decide(&base, found, &ladder);
    progress.at(0.95, "regions and errors");
    let mut finding = builder::finding(model, &evidence, decision, ladder, options);
    said.extend(notes);
    said.extend(plausibility::implausible(model, &finding));
    finding.notes.splice(0..0, said);
    Ok(finding)
}
