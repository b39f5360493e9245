//! `palpate gap --plan`: before any log, which effects of the catalogue a motion will show, which of
//! them it will not tell apart, and what to record as well.
//!
//! Every effect is put in as strong as the search would first try it (5 % of the force's range, an
//! exponent of 1.4, …), or weaker: so that it changes the force by three times the noise, root mean
//! square. That it is seen, or told from a rival, means a χ² beyond the search's own price.

use crate::gap::model::given::given;
use estimator_core::physics::effect::EffectId;
use rayon::prelude::*;

use crate::diagnostic::Diagnostic;
use crate::gap::data::fit_data::Course;
use crate::gap::data::scales::Scales;
use crate::gap::decide::rivals::related;
use crate::gap::experiment::discriminability::{Bench, Presence, least};
use crate::gap::experiment::excitations::{Dish, Reach, menu};
use crate::gap::model::fit::forces;
use crate::gap::model::shape::{Shape, Term};
use crate::gap::noise::floor::Floor;
use crate::log::UniformLog;
use crate::model::Model;
use crate::motion::Motion;
use crate::plant::depth_at_m;

/// Samples of a motion: enough for 12 Hz in 20 s.
const SAMPLES: usize = 1_500;
/// Samples that its speed and acceleration are taken from.
const SMOOTHED: usize = 60_000;
/// The change of the force by an effect (root mean square) in units of the noise, at most.
const STRENGTH: f64 = 3.0;
/// Force at the deepest point in units of the noise: 10 N at 0.02 N.
const DEEPEST: f64 = 500.0;
/// Where nothing pushes back (m): the chapter's depth on gel, in reference depths.
const FREE_DEPTHS: f64 = 4.2;

/// What is planned.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// The motion, in words.
    pub motion: String,
    /// Its length (s) and the rate of the sensors (Hz).
    pub duration_s: f64,
    /// Samples per second.
    pub rate_hz: f64,
    /// Noise of the force (N), one standard deviation.
    pub noise_n: f64,
    /// Difference that counts, in standard deviations.
    pub least_sigma: f64,
    /// The effects that mean anything on this model.
    pub effects: Vec<Planned>,
}

/// An effect in a plan.
#[derive(Clone, Debug, PartialEq)]
pub struct Planned {
    /// Which one.
    pub id: EffectId,
    /// Root mean square of what it does to the force (N), as strong as it is put in.
    pub change_n: f64,
    /// By how many standard deviations it shows once the base is refitted.
    pub seen_sigma: f64,
    /// By how many it stands out from each rival, the nearest first; relatives left out.
    pub rivals: Vec<(EffectId, f64)>,
    /// What to record as well, where it is not seen or not told from a rival.
    pub further: Option<Further>,
}

/// A further motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Further {
    /// Its name in the menu.
    pub name: &'static str,
    /// What to record.
    pub words: String,
    /// By how many standard deviations the effect then stands out from base and rivals.
    pub sigma: f64,
    /// The motion itself, at the positions of model and log.
    pub motion: Motion,
}

impl Plan {
    /// Whether a number of standard deviations counts.
    pub fn counts(&self, sigma: f64) -> bool {
        sigma >= self.least_sigma
    }

    /// Effects that the motion shows but does not tell apart, directly or through others.
    pub fn groups(&self) -> Vec<Vec<EffectId>> {
        let mut groups: Vec<Vec<EffectId>> = Vec::new();
        for own in self
            .effects
            .iter()
            .filter(|own| self.counts(own.seen_sigma))
        {
            let near = own
                .rivals
                .iter()
                .filter(|(_, sigma)| !self.counts(*sigma))
                .map(|(id, _)| *id);
            let seen = |id: &EffectId| {
                self.effects
                    .iter()
                    .any(|other| other.id == *id && self.counts(other.seen_sigma))
            };
            let mut group: Vec<EffectId> = near.filter(seen).collect();
            if group.is_empty() {
                continue;
            }
            group.push(own.id);
            let shares = |other: &Vec<EffectId>| other.iter().any(|id| group.contains(id));
            let (joined, apart): (Vec<_>, Vec<_>) = groups.drain(..).partition(shares);
            groups = apart;
            group.extend(joined.into_iter().flatten());
            group.sort();
            group.dedup();
            groups.push(group);
        }
        groups
    }
}

/// Motions on a bench, and what their noise is.
#[derive(Clone)]
pub(in crate::gap) struct Recorded {
    pub(in crate::gap) courses: Vec<Course>,
    pub(in crate::gap) floors: Vec<Floor>,
    pub(in crate::gap) repeats: Vec<f64>,
}

/// A sensor that records further motions.
#[derive(Clone, Copy, Debug)]
pub(in crate::gap) struct Sensor {
    pub(in crate::gap) rate_hz: f64,
    pub(in crate::gap) position_step_m: f64,
    pub(in crate::gap) noise_n: f64,
}

impl Recorded {
    /// The same and a further motion.
    pub(in crate::gap) fn and(&self, motion: &Motion, sensor: Sensor) -> Recorded {
        let mut all = self.clone();
        let (course, repeats) = course(motion, sensor);
        all.courses.push(course);
        all.repeats.push(repeats);
        all.floors.push(Floor {
            high_pass_n: sensor.noise_n,
            rest_n: None,
            lines_n: 0.0,
            uncertainty: 0.0,
            used_n: sensor.noise_n,
            coloured: false,
            correlation: 1.0,
            why: "given".into(),
        });
        all
    }

    pub(in crate::gap) fn bench<'a>(
        &'a self,
        shape: &'a Shape,
        numbers: &'a [f64],
        scales: &'a Scales,
    ) -> Bench<'a> {
        Bench::new(
            shape,
            numbers,
            &self.courses,
            scales,
            &self.floors,
            &self.repeats,
        )
    }
}

/// A motion as a log would show it, and how many samples of the rig each of its samples stands for.
fn course(motion: &Motion, sensor: Sensor) -> (Course, f64) {
    let samples = (motion.duration_s() * sensor.rate_hz).ceil().max(50.0);
    let slower = (samples / SMOOTHED as f64).max(1.0);
    let rate_hz = sensor.rate_hz / slower;
    let count = (samples / slower) as usize;
    let time_s: Vec<f64> = (0..count).map(|at| at as f64 / rate_hz).collect();
    let step = sensor.position_step_m;
    let rounded = |x: f64| {
        if step > 0.0 {
            (x / step).round() * step
        } else {
            x
        }
    };
    let log = UniformLog {
        rate_hz,
        position_m: time_s
            .iter()
            .map(|t| rounded(motion.position(*t).0))
            .collect(),
        force_n: vec![0.0; count],
        in_gap: vec![false; count],
        time_s,
        ..UniformLog::default()
    };
    let thin = count.div_ceil(SAMPLES);
    (Course::of(&log).thinned(thin), slower * thin as f64)
}

/// Plans a recording.
///
/// # Errors
/// A model that is no rig.
pub fn plan(
    model: &Model,
    motion: Option<&Motion>,
    noise_n: Option<f64>,
    catalogue: &[EffectId],
) -> Result<Plan, Diagnostic> {
    model.rig()?;
    let sensor = Sensor {
        rate_hz: model.sensors.rate_hz,
        position_step_m: model.sensors.position_step_m,
        noise_n: noise_n
            .unwrap_or(model.sensors.force_noise_n)
            .max(f64::MIN_POSITIVE),
    };
    let reach = reach(model, motion, sensor)?;
    let usual = menu(reach);
    let (words, motion) = match motion {
        Some(motion) => ("the motion given".to_string(), motion.clone()),
        None => (usual[0].words.clone(), usual[0].motion.clone()),
    };
    let nothing = Recorded {
        courses: Vec::new(),
        floors: Vec::new(),
        repeats: Vec::new(),
    };
    let mut recorded = nothing.and(&motion, sensor);
    let terms = given(model)?;
    let scales = settle(&mut recorded, model, &terms, sensor);
    let shape = Shape::new(&model.environment, terms, &scales);
    let numbers = shape.start();
    let bench = recorded.bench(&shape, &numbers, &scales);
    let least_sigma = least(catalogue.len()).sqrt();
    let (targets, mut effects) = alone(&bench, catalogue, sensor, least_sigma);
    let remedied: Vec<Vec<Option<f64>>> = usual
        .par_iter()
        .map(|dish| {
            let mut both = recorded.and(&dish.motion, sensor);
            settle(&mut both, model, &shape.terms, sensor);
            // The scales of the first motion: the same effects, as strong.
            with(
                &both.bench(&shape, &numbers, &scales),
                &targets,
                &effects,
                least_sigma,
            )
        })
        .collect();
    for (at, own) in effects.iter_mut().enumerate() {
        own.further = best(&usual, |dish| remedied[dish][at], least_sigma);
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

/// Depth and pace: the motion's own, or what the noise suggests.
fn reach(model: &Model, motion: Option<&Motion>, sensor: Sensor) -> Result<Reach, Diagnostic> {
    let (contact, effects) = model.simulated()?;
    let surface_m = model.environment.surface_m;
    let usual_m = FREE_DEPTHS * model.environment.reference_depth_m;
    let by_force = depth_at_m(&contact, &effects, DEEPEST * sensor.noise_n).unwrap_or(usual_m);
    let own = motion
        .map(|own| own.highest_m() - surface_m)
        .filter(|depth| *depth > 0.0);
    // A stroke of a second; slower where a second is few samples.
    let stroke_s = f64::max(1.0, 200.0 / sensor.rate_hz);
    let touches = !model.environment.is_free();
    Ok(Reach {
        surface_m: if touches { surface_m } else { 0.0 },
        touches,
        depth_m: own.unwrap_or(by_force),
        stroke_s,
    })
}

/// Writes the base's own force into the courses, and measures them.
fn settle(recorded: &mut Recorded, model: &Model, terms: &[Term], sensor: Sensor) -> Scales {
    let scales = Scales::of(&recorded.courses);
    let shape = Shape::new(&model.environment, terms.to_vec(), &scales);
    let all = forces(&shape, &shape.start(), &recorded.courses);
    let mut from = 0;
    for course in &mut recorded.courses {
        let to = from + course.len();
        course.force_n.copy_from_slice(&all[from..to]);
        from = to;
    }
    let own = Scales::of(&recorded.courses);
    Scales {
        // A base that gives no force still has noise to measure strengths by.
        force_n: own.force_n.max(20.0 * sensor.noise_n),
        ..own
    }
}

/// What a motion shows of each effect, and the effects as strong as they were put in.
fn alone(
    bench: &Bench<'_>,
    catalogue: &[EffectId],
    sensor: Sensor,
    least_sigma: f64,
) -> (Vec<(Term, f64)>, Vec<Planned>) {
    let presences = bench.presences(catalogue);
    let possible: Vec<usize> = (0..catalogue.len())
        .filter(|at| !presences[*at].is_empty())
        .collect();
    possible
        .par_iter()
        .map(|at| {
            let target = typical(&presences[*at]);
            let strength = bench.strength(target);
            let times = (STRENGTH / strength.max(1e-300)).min(1.0);
            let seen_sigma = bench.seen(target, times).sqrt();
            let mut rivals: Vec<(EffectId, f64)> = possible
                .iter()
                .filter(|other| {
                    !related(catalogue[*at], catalogue[**other]) && seen_sigma >= least_sigma
                })
                .map(|other| {
                    (
                        catalogue[*other],
                        bench.apart(target, times, &presences[*other]).sqrt(),
                    )
                })
                .collect();
            rivals.sort_by(|a, b| a.1.total_cmp(&b.1));
            let planned = Planned {
                id: catalogue[*at],
                change_n: strength * times * sensor.noise_n,
                seen_sigma,
                rivals,
                further: None,
            };
            ((target.term.clone(), times), planned)
        })
        .unzip()
}

/// The start that stands for an effect: not its weakest, not its strongest.
fn typical(starts: &[Presence]) -> &Presence {
    &starts[starts.len() / 3]
}

/// By how many standard deviations each effect that needs it stands out from base and rivals when a
/// further motion is recorded.
fn with(
    bench: &Bench<'_>,
    targets: &[(Term, f64)],
    effects: &[Planned],
    least_sigma: f64,
) -> Vec<Option<f64>> {
    let ids: Vec<EffectId> = effects.iter().map(|own| own.id).collect();
    let all = bench.presences(&ids);
    let each = targets.iter().zip(effects);
    each.map(|((term, times), own)| {
        let unseen = own.seen_sigma < least_sigma;
        let near = own.rivals.iter().filter(|(_, sigma)| *sigma < least_sigma);
        let mut near: Vec<EffectId> = near.map(|(id, _)| *id).collect();
        if unseen {
            near = ids
                .iter()
                .copied()
                .filter(|id| !related(*id, own.id))
                .collect();
        }
        if near.is_empty() {
            return None;
        }
        let target = bench.presence(term.clone())?;
        let rivals = ids.iter().zip(&all).filter(|(id, _)| near.contains(id));
        let apart = rivals.map(|(_, starts)| bench.apart(&target, *times, starts));
        Some(apart.fold(bench.seen(&target, *times), f64::min).sqrt())
    })
    .collect()
}

/// The motion of the menu that does most, if it does enough.
pub(in crate::gap) fn best(
    menu: &[Dish],
    sigma: impl Fn(usize) -> Option<f64>,
    least_sigma: f64,
) -> Option<Further> {
    let each = (0..menu.len()).filter_map(|at| Some((at, sigma(at)?)));
    let (at, sigma) = each.max_by(|a, b| a.1.total_cmp(&b.1))?;
    (sigma >= least_sigma).then(|| Further {
        name: menu[at].name,
        words: menu[at].words.clone(),
        sigma,
        motion: menu[at].motion.clone(),
    })
}

#[cfg(test)]
#[path = "plan_tests.rs"]
mod tests;
