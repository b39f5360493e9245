//! `palpate estimate --method batch`: the whole log at once.
//!
//! Who has a record of an indentation, and no loop, does not want a recursion: here every sample is
//! seen at once, without delay, and the law that explains the record best gets the parameters that
//! explain it best. The sentence, a file a word:
//!
//! `kinematics` takes depth and speed from the position, `course` makes block means of them and of
//! the raw force, `start` scans for where to begin, `fit` walks to the minimum over the parameters of
//! a `family`, `select` compares the laws, `behind` does so behind the `low_pass` that a force went
//! through before it was logged (`filtered` finds it), `error` says how well the parameters are known, `touch`
//! looks at each touch by itself, and `modulus` makes a material constant of it. What decides is in
//! `thresholds`.

mod assemble;
mod behind;
mod blocks;
mod course;
mod dent;
mod error;
mod family;
mod filtered;
mod fit;
mod held;
mod instead;
mod judge;
mod lateness;
mod low_pass;
mod modulus;
mod natural;
mod note;
mod options;
mod regression;
mod rest_noise;
mod result;
mod scales;
mod select;
mod start;
mod thresholds;
mod touch;
mod weights;
mod young;

use std::ops::Range;

use estimator_core::estimate::method::Method;
use estimator_core::{Config, Status};

pub use dent::is_dented;
pub use family::{Family, Form};
pub use held::Held;
pub use instead::batch_instead;
pub use lateness::lateness;
pub use modulus::Indenter;
pub use options::{Options, all_families};
pub use result::{Batch, Columns, FoundLowPass, Modulus, ModulusKind, Parameter, TouchFit, Tried};
pub use thresholds::Thresholds;

use crate::kinematics::{Kinematics, kinematics};
use assemble::Given;
use course::Course;
use dent::creeping;
use lateness::Seen;
use select::{Candidate, Fixed, finished, roughly_fitted};

use crate::diagnostic::Diagnostic;
use crate::estimate::{
    Choices, Lateness, NOISE_ALONE, Outcome, Reason, Setup, replayed, setup, touched,
    touches::departure,
};
use crate::inspect::inspect;
use crate::log::UniformLog;
use crate::replay::{Replay, as_seen};

#[cfg(test)]
mod tests;

/// Fits a whole log.
///
/// # Errors
/// The field of the configuration that cannot be used, or a log too short to have free air.
pub fn batch(log: &UniformLog, base: Config, options: &Options) -> Result<Batch, Diagnostic> {
    let choices = Choices {
        reference_depth_m: options.reference_depth_m,
        surface_m: options.surface_m,
    };
    let Setup { config, notes } = setup(log, base, Method::KELVIN_VOIGT, choices);
    // The recursion finds the touches, the events and what is in the log; its estimates are dropped.
    let replay = replayed(log, &config, touched(log))?;
    let seen = as_seen(log);
    let motion = kinematics(&seen).completed();
    let mut empty = nothing(log, &replay, &motion, notes);
    let log: &UniformLog = &seen;
    let Some(course) = Course::of(log, &motion, replay.contacts(), options.thresholds) else {
        empty.notes.extend(note::nothing(log, &empty));
        return Ok(empty);
    };
    let slower_n = course.rest_noise_n(log);
    if let Some(noise_n) = slower_n {
        empty.notes.push(note::rest_noise(noise_n, empty.noise_n));
        empty.noise_n = noise_n;
    }
    let mut held = options.held.clone();
    held.fixed
        .extend(options.surface_m.map(|at| ("surface".into(), at)));
    let fixed = &Fixed {
        held,
        reference_depth_m: empty.reference_depth_m,
        without_skew: false,
    };
    let given = Given {
        log,
        motion: &motion,
        course: &course,
        reference_depth_m: empty.reference_depth_m,
        // Noise that is slower than a sample leaves a baseline by itself.
        departure: slower_n.map_or_else(|| departure(log, &replay), |_| None),
        late: None,
        filtered: None,
    };
    let fitted = given.fitted(empty.clone(), options, fixed);
    if let Some(behind) = given.behind_low_pass(&fitted, &empty, options, fixed) {
        return Ok(behind);
    }
    let Some(late) = given.late(&fitted, replay.contacts(), options, fixed) else {
        return Ok(fitted);
    };
    let motion = motion.delayed(late.late_s.value / log.period_s());
    let Some(course) = Course::of(log, &motion, replay.contacts(), options.thresholds) else {
        return Ok(fitted);
    };
    let given = Given {
        motion: &motion,
        course: &course,
        late: Some(late),
        ..given
    };
    let mut again = given.fitted(empty, options, fixed);
    again.widen_by_lateness(&fitted, late.late_s);
    Ok(again)
}

impl Given<'_> {
    /// The best law with its parameters, and what is to be said of it.
    fn fitted(&self, mut empty: Batch, options: &Options, fixed: &Fixed) -> Batch {
        let tried = self.tried(options, fixed);
        let Some(best) = self.best(&tried, fixed) else {
            empty.notes.push("no law has a minimum on this log".into());
            empty.status = Status::Unobservable;
            empty.reason = Some(Reason::Excitation);
            return empty;
        };
        self.told(empty, best, &tried, options, fixed)
    }

    /// The same of laws that were tried, and the best of them.
    pub(super) fn told(
        &self,
        empty: Batch,
        best: &Candidate,
        tried: &[Candidate],
        options: &Options,
        fixed: &Fixed,
    ) -> Batch {
        let batch = self.result(empty, best, tried, fixed);
        let mut batch = self.judged(self.without_ringing(batch, &best.fit), &best.fit);
        if batch.family == Family::KELVIN_VOIGT {
            batch.widen_damper(self.unknown_delay_s());
        }
        batch.modulus = options.indenter.and_then(|indenter| {
            self.modulus(
                best,
                batch.value("exponent"),
                indenter,
                options.poisson,
                fixed,
            )
        });
        let notes = note::notes(self, &batch, options);
        batch.notes.extend(notes);
        batch
    }

    /// How late the force is, where a fit says that it is: the skew of a fit is one step of first order from a
    /// prior of almost none, and of 3 ms it takes a half, and the damping the rest. A law without one says nothing, and
    /// is always asked: of a force that came 3.5 ms early a mode of 8.3/s was one of 10.9 ± 0.6. What relaxes may be
    /// Kelvin and Voigt's damper whose force is late.
    fn late(
        &self,
        fitted: &Batch,
        touches: Vec<Range<usize>>,
        options: &Options,
        fixed: &Fixed,
    ) -> Option<Lateness> {
        if fitted.family.skew().is_some() {
            note::late_s(self, fitted)?;
        }
        let family = fitted.family;
        let seen = Seen::of(self.log, touches, fixed.clone())?;
        let other = Family::KELVIN_VOIGT;
        if options.families.contains(&other)
            && fixed.held.suits(other)
            && let Some(late) = seen.late_instead(family)
        {
            return Some(late);
        }
        let found = seen.lateness(family)?;
        found.reason().map(|_| found)
    }

    /// Every law that was asked for, fitted; a law that relaxes also with a surface that recovers by creep where
    /// that is another force. Exponential responses are tried too where the best power leaves more than noise, since they
    /// take twice as long.
    pub(super) fn tried(&self, options: &Options, fixed: &Fixed) -> Vec<Candidate> {
        let shaped = |form: Form| {
            let families = options.families.iter();
            let shaped = families.filter_map(move |family| family.shaped(form));
            shaped.filter(|family| fixed.held.suits(*family))
        };
        let powers: Vec<Family> = shaped(options.elastic.unwrap_or(Form::Power)).collect();
        let mut first = roughly_fitted(self.course, &powers, fixed);
        let mut tried = finished(self.course, first.clone(), fixed);
        let best = self.best(&tried, fixed);
        let creeps = best.is_some_and(|own| self.course.leaves_a_dent(own));
        if creeps {
            first.extend(roughly_fitted(self.course, &creeping(&powers), fixed));
            tried = finished(self.course, first.clone(), fixed);
        }
        let noise_n = NOISE_ALONE * self.course.scales.noise_n;
        let best = self.best(&tried, fixed);
        let is_noise = best.is_some_and(|own| self.rmse(own) <= noise_n);
        let others: Vec<Family> = shaped(Form::Exponential).collect();
        if is_noise || options.elastic.is_some() || others.is_empty() {
            return tried;
        }
        first.extend(roughly_fitted(self.course, &others, fixed));
        if creeps {
            first.extend(roughly_fitted(self.course, &creeping(&others), fixed));
        }
        finished(self.course, first, fixed)
    }
}

/// The result of a log in which nothing is touched.
fn nothing(log: &UniformLog, replay: &Replay, motion: &Kinematics, notes: Vec<String>) -> Batch {
    let outcome = Outcome::along(
        log,
        replay,
        &crate::estimate::outcome::Motions::known(motion),
    );
    let inspection = inspect(log, replay, &outcome.touches);
    Batch {
        family: Family::KELVIN_VOIGT,
        status: Status::NoContact,
        reason: Some(Reason::Excitation),
        parameters: unknown(Family::KELVIN_VOIGT),
        offset: None,
        skew: None,
        low_pass: None,
        reference_depth_m: f64::from(replay.config.reference.depth_m),
        force_rmse_n: None,
        noise_n: log.force_noise_n(),
        allowed_n: log.force_noise_n(),
        misfit: 1.0,
        selection: Vec::new(),
        per_touch: Vec::new(),
        modulus: None,
        touches: outcome.touches,
        // A change of material is the recursion's opinion.
        events: outcome
            .events
            .into_iter()
            .filter(|event| !event.is_material_change())
            .collect(),
        inspection,
        notes: notes.into_iter().chain(log.notes.iter().cloned()).collect(),
        columns: Columns::default(),
        elastic: Default::default(),
    }
}

fn unknown(family: Family) -> Vec<Parameter> {
    let infos = family.parameters();
    infos.map(|info| Parameter::new(info, None)).collect()
}
