//! `palpate gap --plan`: before any log, which effects of the catalogue a motion will show, which of
//! them it will not tell apart, and what to record as well.
//!
//! Every effect is as strong as the search would first try it (5 % of the force's range, an exponent of
//! 1.4, …), or weaker, so that it changes the force by at most three times the noise, root mean square.
//! An effect is seen, or distinguished from a rival, if that means a χ² beyond the significance threshold of the
//! search.

use estimator_core::physics::effect::EffectId;
use rayon::prelude::*;

use crate::diagnostic::Diagnostic;
use crate::gap::data::scales::Scales;
use crate::gap::experiment::discriminability::{Discriminability, EffectSignature};
use crate::gap::experiment::excitations::{Excitation, ExcitationRange, bounded};
use crate::gap::experiment::recordings::{Recordings, Sensor};
use crate::gap::model::{given::given, shape::Shape, shape::Term, simulate::forces};
use crate::gap::options::Options;
use crate::gap::search::relatives::related;
use crate::kind::{self, Kind};
use crate::model::Model;
use crate::motion::Motion;
use crate::plant::{FORCE_CODES, depth_at_m};
use crate::stats::highest;

/// The largest change of the force by an effect (root mean square) in units of the noise.
const STRENGTH: f64 = 3.0;
/// Force at the deepest point in units of the noise: 10 N at 0.02 N.
const DEEPEST: f64 = 500.0;
/// Share of the force channel's range that a motion may use: 1.5 N of 15 N are 75 times the default noise. Not measured.
const OF_RANGE: f64 = 0.9;
/// Depth of the motions where nothing pushes back, in reference depths.
const FREE_DEPTHS: f64 = 4.2;
/// The same of a machine that turns (rad): a lever shows its weight in it.
const FREE_TURN: f64 = 1.0;

/// What a motion will show.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// The motion, in words.
    pub motion: String,
    /// Duration of the motion (s).
    pub duration_s: f64,
    /// Samples per second.
    pub rate_hz: f64,
    /// Standard deviation of the force (N).
    pub noise_n: f64,
    /// The difference that counts, in standard deviations.
    pub least_sigma: f64,
    /// The effects that this model can have.
    pub effects: Vec<PlannedEffect>,
}

/// What a motion will show of an effect.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedEffect {
    /// The effect.
    pub id: EffectId,
    /// Root mean square of the change that the effect makes to the force (N).
    pub change_n: f64,
    /// By how many standard deviations it shows once the base is refitted.
    pub seen_sigma: f64,
    /// By how many standard deviations it differs from each rival, the nearest first; relatives are left
    /// out.
    pub rivals: Vec<(EffectId, f64)>,
    /// What to record as well, where the effect is not seen or not distinguished from a rival.
    pub further: Option<FurtherMotion>,
}

/// A further motion.
#[derive(Clone, Debug, PartialEq)]
pub struct FurtherMotion {
    /// The kind of the motion.
    pub name: &'static str,
    /// What to record, in words.
    pub words: String,
    /// By how many standard deviations the effect then differs from base and rivals.
    pub sigma: f64,
    /// The motion itself, at the positions of model and log.
    pub motion: Motion,
    /// The largest force (N) that the model expects on the way, where it was asked.
    pub peak_n: Option<f64>,
}

impl Plan {
    /// Whether a number of standard deviations counts.
    pub fn counts(&self, sigma: f64) -> bool {
        sigma >= self.least_sigma
    }

    /// Effects that the motion shows but does not discriminate, directly or through others.
    pub fn groups(&self) -> Vec<Vec<EffectId>> {
        let mut groups: Vec<Vec<EffectId>> = Vec::new();
        for effect in &self.effects {
            let mut group = self.seen_and_near(effect);
            if group.is_empty() || !self.counts(effect.seen_sigma) {
                continue;
            }
            group.push(effect.id);
            let overlaps = |other: &Vec<EffectId>| other.iter().any(|id| group.contains(id));
            let (joined, separate): (Vec<_>, Vec<_>) = groups.drain(..).partition(overlaps);
            groups = separate;
            group.extend(joined.into_iter().flatten());
            group.sort();
            group.dedup();
            groups.push(group);
        }
        groups
    }

    /// The rivals that the motion shows but does not tell from an effect.
    fn seen_and_near(&self, effect: &PlannedEffect) -> Vec<EffectId> {
        let is_seen = |id: &EffectId| {
            let mut others = self.effects.iter();
            others.any(|other| other.id == *id && self.counts(other.seen_sigma))
        };
        let rivals = effect.rivals.iter();
        let near = rivals.filter(|(_, sigma)| !self.counts(*sigma));
        near.map(|(id, _)| *id).filter(is_seen).collect()
    }
}

/// An effect and how many times as strong it is as its term says.
type Target = (Term, f64);

/// Plans a recording of a motion, or of a palpation if none is given.
///
/// # Errors
/// A model that does not describe a rig.
pub fn plan(
    model: &Model,
    motion: Option<&Motion>,
    noise_n: Option<f64>,
    options: &Options,
) -> Result<Plan, Diagnostic> {
    model.rig()?;
    let kind = model.kind.unwrap_or_default();
    kind::worded(kind, || planned(model, motion, noise_n, options))
}

/// The same in the words of the model's kind of machine.
fn planned(
    model: &Model,
    motion: Option<&Motion>,
    noise_n: Option<f64>,
    options: &Options,
) -> Result<Plan, Diagnostic> {
    let catalogue = &options.catalogue_of(kind::of_words());
    let decide = &options.thresholds;
    let noise_n = noise_n.unwrap_or(model.sensors.force_noise_n);
    let sensor = Sensor {
        rate_hz: model.sensors.rate_hz,
        position_step_m: model.sensors.position_step_m,
        noise_n: noise_n.max(f64::MIN_POSITIVE),
    };
    let terms = given(model)?;
    let peak_n = |motion: &Motion| {
        let mut alone = Recordings::default().and(motion, sensor);
        predict_base(&mut alone, model, &terms, sensor);
        let forces = alone.logs.iter().flat_map(|log| &log.force_n);
        highest(forces.map(|force| force.abs()))
    };
    let excitations = bounded(range(model, motion, sensor)?, most_n(model), peak_n);
    let (words, motion) = match motion {
        Some(motion) => ("the motion given".to_string(), motion.clone()),
        None => (excitations[0].words.clone(), excitations[0].motion.clone()),
    };
    let mut recordings = Recordings::default().and(&motion, sensor);
    let scales = predict_base(&mut recordings, model, &terms, sensor);
    let shape = Shape::new(&model.environment, terms, &scales);
    let numbers = shape.start();
    let analysis = recordings.discriminability(&shape, &numbers, &scales, decide);
    let least_sigma = decide.significance.chi2_of(catalogue.len()).sqrt();
    let (targets, mut effects) = planned_effects(&analysis, catalogue, sensor, least_sigma);
    let with_further: Vec<Vec<Option<f64>>> = excitations
        .par_iter()
        .map(|excitation| {
            let mut both = recordings.and(&excitation.motion, sensor);
            predict_base(&mut both, model, &shape.terms, sensor);
            // With the scales of the first motion, so that the effects are the same and as strong.
            let analysis = both.discriminability(&shape, &numbers, &scales, decide);
            sigmas_where_needed(&analysis, &targets, &effects, least_sigma)
        })
        .collect();
    for (at, effect) in effects.iter_mut().enumerate() {
        let sigma = |excitation: usize| with_further[excitation][at];
        effect.further = best_excitation(&excitations, sigma, least_sigma);
    }
    Ok(Plan {
        motion: words,
        duration_s: motion.duration_s(),
        rate_hz: sensor.rate_hz,
        noise_n: sensor.noise_n,
        least_sigma,
        effects,
    })
}

/// The largest force (N) that a motion may reach: what is left of the model's force channel with its noise and what a
/// motor overshoots.
fn most_n(model: &Model) -> f64 {
    let sensors = &model.sensors;
    match sensors.force_step_n > 0.0 {
        true => OF_RANGE * (sensors.force_min_n + FORCE_CODES * sensors.force_step_n),
        false => f64::INFINITY,
    }
}

/// Depth and pace of the motions: those of the motion given, or what the noise suggests.
fn range(
    model: &Model,
    motion: Option<&Motion>,
    sensor: Sensor,
) -> Result<ExcitationRange, Diagnostic> {
    let (contact, effects) = model.simulated()?;
    let surface_m = model.environment.surface_m;
    let free_m = match kind::of_words() {
        Kind::Linear => FREE_DEPTHS * model.environment.reference_depth_m,
        Kind::Rotary => FREE_TURN,
    };
    let by_force = depth_at_m(&contact, &effects, DEEPEST * sensor.noise_n).unwrap_or(free_m);
    let of_motion = motion
        .map(|motion| motion.highest_m() - surface_m)
        .filter(|depth| *depth > 0.0);
    let touches = !model.environment.is_free();
    Ok(ExcitationRange {
        surface_m: if touches { surface_m } else { 0.0 },
        touches,
        depth_m: of_motion.unwrap_or(by_force),
        // A stroke of a second; slower where a second has few samples.
        stroke_s: f64::max(1.0, 200.0 / sensor.rate_hz),
    })
}

/// Writes the force of the base into the logs, and measures their scales.
fn predict_base(
    recordings: &mut Recordings,
    model: &Model,
    terms: &[Term],
    sensor: Sensor,
) -> Scales {
    let scales = Scales::of(&recordings.logs);
    let shape = Shape::new(&model.environment, terms.to_vec(), &scales);
    let all = forces(&shape, &shape.start(), &recordings.logs);
    let mut from = 0;
    for log in &mut recordings.logs {
        let to = from + log.len();
        log.force_n.copy_from_slice(&all[from..to]);
        from = to;
    }
    let scales = Scales::of(&recordings.logs);
    Scales {
        // A base that gives no force still has noise to measure strengths by.
        force_n: scales.force_n.max(20.0 * sensor.noise_n),
        ..scales
    }
}

/// What a motion shows of each effect, and the effects as strong as they were taken.
fn planned_effects(
    analysis: &Discriminability<'_>,
    catalogue: &[EffectId],
    sensor: Sensor,
    least_sigma: f64,
) -> (Vec<Target>, Vec<PlannedEffect>) {
    let signatures = analysis.signatures(catalogue);
    let possible: Vec<usize> = (0..catalogue.len())
        .filter(|at| !signatures[*at].is_empty())
        .collect();
    let of_effect = |at: &usize| {
        let (id, target) = (catalogue[*at], typical(&signatures[*at]));
        let strength = analysis.rms_change(target);
        let times = (STRENGTH / strength.max(1e-300)).min(1.0);
        let seen_sigma = analysis.detection_chi2(target, times).sqrt();
        let others = possible
            .iter()
            .filter(|other| !related(id, catalogue[**other]) && seen_sigma >= least_sigma);
        let mut rivals: Vec<(EffectId, f64)> = others
            .map(|other| {
                let chi2 = analysis.discrimination_chi2(target, times, &signatures[*other]);
                (catalogue[*other], chi2.sqrt())
            })
            .collect();
        rivals.sort_by(|a, b| a.1.total_cmp(&b.1));
        let planned = PlannedEffect {
            id,
            change_n: strength * times * sensor.noise_n,
            seen_sigma,
            rivals,
            further: None,
        };
        ((target.term.clone(), times), planned)
    };
    possible.par_iter().map(of_effect).unzip()
}

/// The start that stands for an effect: neither its weakest nor its strongest.
fn typical(starts: &[EffectSignature]) -> &EffectSignature {
    &starts[starts.len() / 3]
}

/// By how many standard deviations each effect that needs a further motion differs from base and rivals
/// with it.
fn sigmas_where_needed(
    analysis: &Discriminability<'_>,
    targets: &[Target],
    effects: &[PlannedEffect],
    least_sigma: f64,
) -> Vec<Option<f64>> {
    let ids: Vec<EffectId> = effects.iter().map(|effect| effect.id).collect();
    let signatures = analysis.signatures(&ids);
    let each = targets.iter().zip(effects);
    each.map(|((term, times), effect)| {
        let near = match effect.seen_sigma < least_sigma {
            true => others_than_relatives(&ids, effect.id),
            false => near_rivals(effect, least_sigma),
        };
        if near.is_empty() {
            return None;
        }
        let target = analysis.signature(term.clone())?;
        let rivals = ids.iter().zip(&signatures);
        let rivals = rivals.filter(|(id, _)| near.contains(id));
        let chi2 = rivals.map(|(_, rival)| analysis.discrimination_chi2(&target, *times, rival));
        let seen = analysis.detection_chi2(&target, *times);
        Some(chi2.fold(seen, f64::min).sqrt())
    })
    .collect()
}

fn others_than_relatives(ids: &[EffectId], id: EffectId) -> Vec<EffectId> {
    let others = ids.iter().copied();
    others.filter(|other| !related(*other, id)).collect()
}

fn near_rivals(effect: &PlannedEffect, least_sigma: f64) -> Vec<EffectId> {
    let near = effect.rivals.iter();
    let near = near.filter(|(_, sigma)| *sigma < least_sigma);
    near.map(|(id, _)| *id).collect()
}

/// The motion with the most standard deviations, if they suffice.
pub(super) fn best_excitation(
    excitations: &[Excitation],
    sigma: impl Fn(usize) -> Option<f64>,
    least_sigma: f64,
) -> Option<FurtherMotion> {
    let each = (0..excitations.len()).filter_map(|at| Some((at, sigma(at)?)));
    let (at, sigma) = each.max_by(|a, b| a.1.total_cmp(&b.1))?;
    let best = &excitations[at];
    (sigma >= least_sigma).then(|| FurtherMotion {
        name: best.name,
        words: best.words.clone(),
        sigma,
        motion: best.motion.clone(),
        peak_n: best.peak_n,
    })
}

#[cfg(test)]
mod tests;
