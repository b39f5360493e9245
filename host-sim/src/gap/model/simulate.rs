//! The force that a law with effects predicts along the motion of a log.

use estimator_core::maths::Scalar;
use estimator_core::physics::rig::{Reading, Rig, RigState};

use crate::gap::data::fit_data::FitData;
use crate::gap::model::shape::Shape;

/// Periods that differ by this share are the same one: differences of stamps differ by 10⁻¹⁶ of an hour, 10⁻¹⁰ of 5 ms.
const ROUNDING: f64 = 1e-9;

/// Runs a rig along a log and hands over its reading at each sample.
pub(crate) fn run_rig<S: Scalar>(rig: &Rig<S>, log: &FitData, each: impl FnMut(usize, Reading<S>)) {
    run_from(rig, rig.at_rest(), log, each);
}

fn run_from<S: Scalar>(
    rig: &Rig<S>,
    mut state: RigState<S>,
    log: &FitData,
    mut each: impl FnMut(usize, Reading<S>),
) {
    let delay_s = rig.delay_s();
    let mut rig = *rig;
    let mut paced_s = log.period_s;
    let mut pace = rig.pace(S::from_f64(paced_s));
    let mut slips = log.surface_steps.iter().peekable();
    for at in 0..log.len() {
        while let Some((_, by_m)) = slips.next_if(|own| own.0 <= log.time_s[at]) {
            rig.environment.surface_m = rig.environment.surface_m + S::from_f64(*by_m);
        }
        let motion = match delay_s {
            Some(delay_s) => log.delayed_motion(at, delay_s),
            None => log.motion(at),
        };
        let step_s = log.step_s(at);
        if (step_s - paced_s).abs() > ROUNDING * paced_s {
            paced_s = step_s;
            pace = rig.pace(S::from_f64(paced_s));
        }
        each(at, rig.step_at(&pace, &mut state, motion));
    }
}

/// The predicted forces (N), log after log.
pub(crate) fn forces(shape: &Shape, numbers: &[f64], logs: &[FitData]) -> Vec<f64> {
    forces_of(&shape.rig(numbers), logs)
}

/// The forces (N) that a rig predicts, log after log.
pub(crate) fn forces_of(rig: &Rig<f64>, logs: &[FitData]) -> Vec<f64> {
    forces_from(rig, rig.at_rest(), logs)
}

fn forces_from(rig: &Rig<f64>, state: RigState<f64>, logs: &[FitData]) -> Vec<f64> {
    let mut forces = Vec::with_capacity(logs.iter().map(FitData::len).sum());
    for log in logs {
        run_from(rig, state, log, |_, reading| forces.push(reading.force_n));
    }
    forces
}

/// The predicted forces (N), log after log, where what sticks in the model is wound up to either side before the log;
/// `None` where nothing does. What a search adds is not wound up: it would leave out what speaks against it.
pub(crate) fn forces_of_wound(
    shape: &Shape,
    numbers: &[f64],
    logs: &[FitData],
) -> Option<[Vec<f64>; 2]> {
    let rig = shape.rig(numbers);
    let given = shape.terms.iter().filter(|term| term.given).count();
    let sides = [1.0, -1.0].map(|side| rig.wound(side, given));
    (sides[0] != rig.at_rest()).then(|| sides.map(|state| forces_from(&rig, state, logs)))
}

/// The predicted forces (N) for logs that are changed first.
pub(crate) fn forces_of_changed(
    shape: &Shape,
    numbers: &[f64],
    logs: &[FitData],
    change: impl FnMut(&mut FitData),
) -> Vec<f64> {
    let mut changed = logs.to_vec();
    changed.iter_mut().for_each(change);
    forces(shape, numbers, &changed)
}

/// The predicted penetrations (m) at each sample, for each log; 0 where there is nothing to touch.
pub(crate) fn depths(shape: &Shape, numbers: &[f64], logs: &[FitData]) -> Vec<Vec<f64>> {
    if shape.base.is_free() {
        return logs.iter().map(|log| vec![0.0; log.len()]).collect();
    }
    let rig = shape.rig(numbers);
    let depths_of = |log: &FitData| {
        let mut depths = Vec::with_capacity(log.len());
        run_rig(&rig, log, |_, reading| {
            depths.push(reading.touch.depth_m);
        });
        depths
    };
    logs.iter().map(depths_of).collect()
}
