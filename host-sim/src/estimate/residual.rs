//! The law with the final parameters over a log's own motion, and what of the raw force it leaves.

use std::ops::Range;

use estimator_core::estimate::identify::method_info;
use estimator_core::estimate::{Estimated, Parameters, Phase};
use estimator_core::physics::law::{Law, RelaxingLaw, unilateral};
use estimator_core::{Faults, LawKind};

use crate::kinematics::{Kinematics, Smoother};
use crate::log::UniformLog;
use crate::replay::Replay;
use crate::signal;
use crate::stats::{correlation, rms};

/// Samples on either side of the fixed window: a count of 1 µm then makes a speed of 30 µm/s at 1 kHz, and a
/// touch is over after 5 ms.
const FIXED_HALF_WIDTH: usize = 5;
/// Samples on either side of a fault whose motion it may bend.
const BENT_SAMPLES: usize = 5;

/// The value of the parameter of that name.
pub(super) fn named(
    law: LawKind,
    parameters: &Parameters<f32>,
    name: &str,
) -> Option<Estimated<f32>> {
    let slot = law.parameters().iter().position(|info| info.name == name)?;
    parameters[slot]
}

/// The law with a set of parameters, in double precision; `None` while one of them is not known.
pub fn law_with(
    kind: LawKind,
    parameters: &Parameters<f32>,
    reference_depth_m: f64,
) -> Option<Law<f64>> {
    let value = |name: &str| named(kind, parameters, name).map(|p| f64::from(p.value));
    Law::from_values(kind.law(), kind.modes(), value, reference_depth_m)
}

/// The motion of a log, smoothed in two ways. As little as its noise allows: a fixed window rounds off what
/// happens within it, and 11 samples at 1 kHz take 7 % off the speed of a chatter at 25 Hz, 20 times the noise
/// of a soft gel. And over a fixed window: where stamps jitter, a window that gives way to every sample leaves
/// three times as much. A law is judged by the one that leaves less.
///
/// Each is worked out sample by sample: those of an hour would take 120 MB.
pub(crate) struct Motions<'a> {
    each: Vec<Box<Motion<'a>>>,
    /// How far the position may be off (m).
    pub(super) error_m: f64,
    /// Standard deviation of what its counts round off (m); `None` of one without counts.
    pub(super) rounding_m: Option<f64>,
}

/// A position (m) and its rate (m/s) at a sample.
type Motion<'a> = dyn Fn(usize) -> (f64, f64) + 'a;

impl<'a> Motions<'a> {
    pub(crate) fn of(log: &'a UniformLog) -> Motions<'a> {
        let (narrow, period_s) = (Smoother::of(log), log.period_s());
        let fixed = move |at| signal::parabola(&log.position_m, at, FIXED_HALF_WIDTH, period_s);
        let errors = narrow.errors();
        let each: Vec<Box<Motion<'a>>> =
            vec![Box::new(move |at| narrow.motion(at)), Box::new(fixed)];
        Motions {
            each,
            error_m: errors.held_m,
            rounding_m: errors.rounding_m,
        }
    }

    /// The one that is there already.
    pub(crate) fn known(motion: &'a Kinematics) -> Motions<'a> {
        let at = |at: usize| (motion.position_m[at], motion.speed_mps[at]);
        Motions {
            each: vec![Box::new(at)],
            error_m: motion.noise_m,
            rounding_m: None,
        }
    }

    /// One after the other.
    pub(super) fn each(&self) -> impl Iterator<Item = &Motion<'a>> {
        self.each.iter().map(Box::as_ref)
    }
}

/// The motion of so many samples ago; at the ends of the log its first or last.
fn delayed(motion: &Motion<'_>, at: usize, samples: f64, count: usize) -> (f64, f64) {
    let last = count.saturating_sub(1);
    let at = (at as f64 - samples).clamp(0.0, last as f64);
    let (before, share) = (at as usize, at.fract());
    let (a, b) = (motion(before), motion((before + 1).min(last)));
    (a.0 + share * (b.0 - a.0), a.1 + share * (b.1 - a.1))
}

/// The law over a motion of the log. What a law remembers runs on between the touches; a
/// force is due in contact only.
pub(super) fn replay_force(
    log: &UniformLog,
    replay: &Replay,
    motion: &Motion<'_>,
    kind: LawKind,
    parameters: &Parameters<f32>,
) -> Vec<f32> {
    let reference_depth_m = f64::from(replay.config.reference.depth_m);
    let mut forces = vec![0.0; replay.records.len()];
    let Some(law) = law_with(kind, parameters, reference_depth_m) else {
        return forces;
    };
    let finds_surface = method_info(replay.config.method).is_some_and(|info| info.finds_surface);
    let found = match finds_surface {
        true => parameters[kind.parameters().len() - 1],
        false => None,
    };
    let skew = named(kind, parameters, "skew");
    let skew_samples = skew.map(|skew| f64::from(skew.value) / log.period_s());
    let remembers = kind.law().info().relaxes;
    let mut state = law.at_rest();
    let stretches = replay.records.stretches();
    // A force finds a touch late, and what relaxes began to do so at the surface; one that the impact gave is no
    // earlier than that.
    let knows_its_surface = remembers && found.is_some();
    let mut touched = stretches
        .skip_while(|(_, said)| !knows_its_surface && said.phase != Phase::Contact)
        // What a law forgets at once needs no free air.
        .filter(|(_, said)| remembers || said.phase == Phase::Contact)
        .flat_map(|(range, said)| range.map(move |index| (index, said.phase)));
    for (index, phase) in &mut touched {
        let Some(sample) = replay.sample_of(index) else {
            continue;
        };
        let (position_m, speed_mps) = match skew_samples {
            Some(samples) => delayed(motion, sample, samples, log.len()),
            None => motion(sample),
        };
        let surface_m = found.map_or(replay.surface_m.at(index), |surface| surface.value);
        let depth_m = position_m - f64::from(surface_m);
        let force_n = law.step(&mut state, depth_m, speed_mps, log.period_s());
        // A material that lags behind its depth lets go of the probe; the chapter saturates the
        // force of its Hammerstein model, and lets its linear one show that it pulls (E2).
        let force_n = match remembers {
            true => unilateral(force_n),
            false => force_n,
        };
        if phase == Phase::Contact {
            forces[index] = force_n as f32;
        }
    }
    forces
}

/// What a surface that is wrong by its standard error would change the force by (N rms in contact).
pub(super) fn surface_misfit(
    replay: &Replay,
    kind: LawKind,
    parameters: &Parameters<f32>,
) -> Option<f64> {
    let error_m = f64::from(named(kind, parameters, "surface")?.std_error);
    depth_misfit(replay, kind, parameters, error_m)
}

/// What a depth that is wrong by `error_m` would change the force by (N rms in contact).
pub(super) fn depth_misfit(
    replay: &Replay,
    kind: LawKind,
    parameters: &Parameters<f32>,
    error_m: f64,
) -> Option<f64> {
    let reference_depth_m = f64::from(replay.config.reference.depth_m);
    let law = law_with(kind, parameters, reference_depth_m)?;
    let contacts = replay.contacts().into_iter().flatten();
    let changes = contacts.map(|index| {
        let records = &replay.records;
        let (depth, speed) = (
            records.depth_m(index).into(),
            records.speed_mps(index).into(),
        );
        let (depth, speed): (f64, f64) = (depth, speed);
        law.force_n(depth + error_m, speed) - law.force_n(depth, speed)
    });
    Some(rms(changes))
}

/// The root mean square (N) of [`errors`].
pub(super) fn force_rmse(
    log: &UniformLog,
    replay: &Replay,
    replayed_n: &[f32],
    stretch: Range<usize>,
) -> Option<f64> {
    let errors = errors(log, replay, replayed_n, stretch);
    let known = replayed_n.iter().any(|force| *force != 0.0);
    (known && !errors.is_empty()).then(|| rms(errors))
}

/// How many times as large as a method says the standard errors are that the forces leave, which it takes for white
/// noise of the size that it knows.
pub(super) fn times_the_errors(log: &UniformLog, replay: &Replay, replayed_n: &[f32]) -> f64 {
    let errors = errors(log, replay, replayed_n, 0..replay.records.len());
    let memory = correlation(&errors);
    rms(errors) / replay.noise_n * memory.sqrt()
}

/// Raw forces (N) less those of the law, over the instants whose whole filter window lies in contact: there the smoothed
/// depth and speed are those of the raw force. Samples that the board knows to be faulty, or that were invented in a
/// gap, are no measurements.
fn errors(
    log: &UniformLog,
    replay: &Replay,
    replayed_n: &[f32],
    stretch: Range<usize>,
) -> Vec<f64> {
    let memory = 2 * replay.delay + 1;
    let is_sound = sound(log, replay);
    let errors = replay.contacts().into_iter().flat_map(|contact| {
        contact.skip(memory).filter_map(|index| {
            let sample = replay.sample_of(index)?;
            let raw = log.force_n[sample] - f64::from(replay.rest_n[index]);
            let counts = is_sound[sample] && stretch.contains(&index);
            counts.then(|| raw - f64::from(replayed_n[index]))
        })
    });
    errors.collect()
}

/// Whether each sample, and those that its motion is smoothed over, were measured without a fault.
fn sound(log: &UniformLog, replay: &Replay) -> Vec<bool> {
    let mut faulty: Vec<bool> = (0..log.len()).map(|at| !log.has_force(at)).collect();
    for (range, said) in replay.records.stretches() {
        if said.faults != Faults::NONE {
            faulty[range].fill(true);
        }
    }
    let mut sound = vec![true; log.len()];
    let faulty = || (0..log.len()).filter(|at| faulty[*at]);
    // Where most of a log is faulty nothing else is left to judge by.
    if 2 * faulty().count() > log.len() {
        return sound;
    }
    for at in faulty() {
        let end = (at + BENT_SAMPLES + 1).min(log.len());
        sound[at.saturating_sub(BENT_SAMPLES)..end].fill(false);
    }
    sound
}
