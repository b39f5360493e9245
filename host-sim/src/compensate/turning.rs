//! Where a friction turns, or comes to rest: to which side it goes there an encoder does not tell to the sample, and what is
//! taken off is wrong by up to twice the friction.

use std::ops::Range;

use estimator_core::Sample;
use estimator_core::estimate::compensation::Compensation;
use estimator_core::physics::effect::Effect;
use estimator_core::physics::rig::Effects;

use crate::log::UniformLog;
use crate::stats::highest;

/// A friction turns where what is taken off changes from one sample to the next by more than the noise and this share of its
/// largest force.
const HOP: f64 = 0.05;
/// A motor that comes to rest swings about its end for so long (s) by less than an encoder shows: a position loop of 100 Hz,
/// 45 ms.
const SWINGS_S: f64 = 50e-3;

/// The stretches of a log (samples) in which it is not known to which side the frictions of a rig go.
pub(super) fn turning(log: &UniformLog, effects: &Effects<f64>, count_m: f64) -> Vec<Range<usize>> {
    let reverses = |effect: &Effect<f64>| match effect {
        Effect::CoulombFriction(own) => own.width_m == 0.0,
        Effect::StribeckFriction(own) => own.width_m == 0.0,
        _ => false,
    };
    // What says at which instant, and how far, the motor has moved stays.
    let moves = |effect: &Effect<f64>| {
        matches!(
            effect,
            Effect::TimeDelay(_) | Effect::EncoderPeriodicError(_)
        )
    };
    if !effects.iter().any(reverses) {
        return Vec::new();
    }
    let own = effects.filtered(|effect| reverses(effect) || moves(effect));
    let Ok(compensation) = Compensation::<f64>::new(&own, log.rate_hz as f32, count_m) else {
        return Vec::new();
    };
    let taken_n = taken_n(log, &compensation);
    let most_n = highest(taken_n.iter().map(|force| force.abs()));
    let hop_n = log.force_noise_n().max(HOP * most_n);
    let reach = compensation.memory_samples() / 2;
    let swings = (SWINGS_S * log.rate_hz) as usize;
    let mut stretches: Vec<Range<usize>> = Vec::new();
    for at in 1..taken_n.len() {
        if (taken_n[at] - taken_n[at - 1]).abs() <= hop_n {
            continue;
        }
        let after = match taken_n[at].abs() <= hop_n {
            true => swings.max(reach),
            false => reach,
        };
        let own = at.saturating_sub(reach)..(at + after).min(taken_n.len());
        match stretches.last_mut() {
            Some(last) if last.end >= own.start => last.end = last.end.max(own.end),
            _ => stretches.push(own),
        }
    }
    stretches
}

/// What is taken off the force of each sample (N).
fn taken_n(log: &UniformLog, compensation: &Compensation<f64>) -> Vec<f64> {
    let mut state = compensation.at_rest();
    let taken = (0..log.len()).map(|at| {
        let without_force = Sample {
            force_n: 0.0,
            ..log.sample(at)
        };
        -compensation.step(&mut state, without_force).force_n
    });
    taken.collect()
}
