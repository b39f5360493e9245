//! A stretch in which something else happens: a stop is hit, a hand is on the rig, a cable snags.
//!
//! A lift ran against its stop for a second of eighty, with five times the force that it needs elsewhere, and neither its
//! weight nor its friction, 98 % of the rest, was named. Where one short stretch holds most of what the closest set leaves, and
//! effects stand out without it that do not with it, those are named, and it is said that nothing explains the stretch.

use std::borrow::Cow;

use estimator_core::physics::effect::EffectId;

use super::data::hangs::without;
use super::decide::episode::episode;
use super::dents::SLIGHTLY_LESS;
use super::finding::{Episode, Finding, Grade, Verdict};
use super::model::{dataset::Dataset, fit::Fit};
use crate::diagnostic::Diagnostic;
use crate::log::UniformLog;
use crate::model::Model;
use crate::number::quantity;

/// Most stretches that are left out. Not measured.
const MOST: usize = 3;

/// The finding on logs without such stretches, and what is said of them; `ask` finds what is missing in the model, and
/// `alone` fits a model to which nothing is added.
///
/// # Errors
/// Those of `ask` and `alone`.
pub(super) fn left_out(
    model: &Model,
    logs: &[UniformLog],
    ask: impl Fn(&[UniformLog]) -> Result<Finding, Diagnostic>,
    alone: impl Fn(&Model, &[UniformLog]) -> Result<Finding, Diagnostic>,
) -> Result<Finding, Diagnostic> {
    let first = ask(logs)?;
    let mut logs = Cow::Borrowed(logs);
    let mut finding = first.clone();
    let mut episodes: Vec<Episode> = Vec::new();
    // What is gone without one stretch does not come back without two, and each is asked for with all dents and steps.
    while let Some(episode) = finding.episode
        && episodes.len() < MOST
        && names_all(&finding, &first)
    {
        let log = &mut logs.to_mut()[episode.log];
        *log = without(log, &marks(log, episode));
        if !all_show(&first, model, |other| alone(other, &logs))? {
            return Ok(first);
        }
        finding = ask(&logs)?;
        episodes.push(episode);
    }
    if episodes.is_empty() || !says_more(&finding, &first) {
        return Ok(first);
    }
    // Something remains, if only there.
    finding.verdict = Verdict::PartlyExplained;
    if finding.effects.is_empty() {
        finding.verdict = Verdict::Unexplained;
        // What is not explained counts.
        (finding.rmse_before_n, finding.rmse_after_n) = (first.rmse_before_n, first.rmse_after_n);
        (finding.ratio_before, finding.ratio_after) = (first.ratio_before, first.ratio_after);
    }
    let certain = finding.effects.iter_mut();
    let certain = certain.filter(|own| own.grade == Grade::Certain);
    certain.for_each(|own| own.grade = Grade::Strong);
    finding.notes.splice(0..0, episodes.iter().map(in_words));
    finding.advice = format!("Look at what happened there. Elsewhere: {}", finding.advice);
    finding.left_out = episodes;
    Ok(finding)
}

/// The stretch that is to be left out, where something remains: of what the closest set leaves, or of what the base does,
/// since effects that follow what happens there spread what remains of it. Behind a low-pass it is everywhere.
pub(super) fn of(verdict: Verdict, dataset: &Dataset<'_>, fits: [&Fit; 2]) -> Option<Episode> {
    let is_asked = verdict.leaves_a_remainder() && dataset.low_pass.is_none();
    let mut fits = fits.into_iter().filter(|_| is_asked);
    fits.find_map(|fit| episode(dataset, fit))
}

/// Whether a finding names all that another does, and more, or explains the rest with it.
fn says_more(finding: &Finding, other: &Finding) -> bool {
    let is_more = finding.effects.len() > other.effects.len();
    (is_more || !finding.verdict.leaves_a_remainder()) && names_all(finding, other)
}

fn names_all(finding: &Finding, other: &Finding) -> bool {
    let is_named = |id| finding.effects.iter().any(|own| own.id == id);
    other.effects.iter().all(|own| is_named(own.id))
}

/// Whether each effect that a finding names is needed elsewhere, too: its model leaves less (rms) there than without. What
/// only shows where the stretch is cannot be named without. A bond that breaks within 12 ms of a cantilever's record was
/// asked for again for three quarters of the time, and not found.
fn all_show(
    finding: &Finding,
    model: &Model,
    alone: impl Fn(&Model) -> Result<Finding, Diagnostic>,
) -> Result<bool, Diagnostic> {
    let mut ids: Vec<EffectId> = finding.effects.iter().map(|own| own.id).collect();
    ids.sort();
    ids.dedup();
    if ids.is_empty() {
        return Ok(true);
    }
    // What it left of the whole logs is no measure of what it leaves here.
    let whole = Model {
        remainder: None,
        ..finding.model.clone()
    };
    let with_n = alone(&whole)?.whole_n();
    for id in ids {
        let mut other = whole.clone();
        let given = model.effects.len().min(other.effects.len());
        let added = other.effects.drain(given..);
        let kept: Vec<_> = added.filter(|own| own.id != id.name()).collect();
        other.effects.extend(kept);
        if with_n >= SLIGHTLY_LESS * alone(&other)?.whole_n() {
            return Ok(false);
        }
    }
    Ok(true)
}

/// Where an episode hides the force.
fn marks(log: &UniformLog, episode: Episode) -> Vec<[bool; 2]> {
    let is_in = |time_s: &f64| (episode.from_s..=episode.until_s).contains(time_s);
    let each = log.time_s.iter().map(is_in);
    each.map(|is_in| [is_in, false]).collect()
}

fn in_words(episode: &Episode) -> String {
    format!(
        "for {} from {:.2} s on the force does what it does nowhere else in the log, as where a stop is hit or a hand is on \
         the rig: left out, and not explained",
        quantity(episode.length_s(), 2, "s"),
        episode.from_s
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gap::{Options, gap};
    use crate::log::Log;
    use crate::toml_reader::TomlFile;
    use std::path::Path;

    /// Strokes of 2 mm at 1 Hz against 1 N/mm, with 1 mN of noise and a friction.
    fn strokes(friction_n: f64) -> UniformLog {
        let time: Vec<f64> = (0..4000).map(|at| 1e-3 * f64::from(at)).collect();
        let phase = |t: f64| std::f64::consts::TAU * t;
        let noise = |at: u32| f64::from(at.wrapping_mul(2_654_435_761) >> 16) / 32768.0 - 1.0;
        let position = time.iter().map(|t| 2e-3 * phase(*t).sin());
        let force = (0..).zip(&time).map(|(at, t)| {
            2.0 * phase(*t).sin() + friction_n * phase(*t).cos().signum() + 1.7e-3 * noise(at)
        });
        let log = Log::from_channels(time.clone(), position.collect(), force.collect());
        log.uniform().unwrap()
    }

    #[test]
    fn what_is_named_shows_elsewhere_only_where_it_is() {
        let path = Path::new("base.toml");
        let text = "[environment]\nlaw = \"free\"\n[[effect]]\nid = \"cable_stiffness\"\nstiffness = 900.0\n";
        let model = Model::from_toml(&TomlFile::parse(text.into(), path).unwrap(), path).unwrap();
        let options = |catalogue: &[EffectId]| Options {
            catalogue: catalogue.to_vec(),
            ..Options::default()
        };
        let alone = |other: &Model, log: UniformLog| gap(other, &[log], &options(&[]));
        // GIVEN a friction that is named
        let friction = EffectId::CoulombFriction;
        let finding = gap(&model, &[strokes(0.1)], &options(&[friction])).unwrap();
        let names: Vec<EffectId> = finding.effects.iter().map(|own| own.id).collect();
        assert_eq!(names, [friction]);
        // THEN a part of the log that has it shows it, and one that has not does not.
        let shows = |log: UniformLog| all_show(&finding, &model, |other| alone(other, log.clone()));
        assert!(shows(strokes(0.1)).unwrap());
        assert!(!shows(strokes(0.0)).unwrap());
    }
}
