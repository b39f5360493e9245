//! What one period does to all that decays in a rig.
//!
//! An exponential is a fifth of what a sample of a relaxing contact costs, and depends on the period alone: along a log
//! it is taken once.

use crate::maths::scalar::Scalar;
use crate::physics::effect::Effect;
use crate::physics::law::{Decay, Environment, MOST_MODES};
use crate::physics::rig::effects::{Effects, MOST_EFFECTS};

/// A period, and what it does to each mode and lag of one rig.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pace<S> {
    pub(super) period_s: S,
    /// Of the environment's modes.
    pub(super) modes: [Decay<S>; MOST_MODES],
    /// Of the effects; of those that do not decay none.
    pub(super) effects: [Decay<S>; MOST_EFFECTS],
}

impl<S: Scalar> Pace<S> {
    pub(super) fn of(environment: &Environment<S>, effects: &Effects<S>, period_s: S) -> Pace<S> {
        let mut pace = Pace {
            period_s,
            modes: [Decay::none(); MOST_MODES],
            effects: [Decay::none(); MOST_EFFECTS],
        };
        for (mode, decay) in environment.modes.iter().zip(&mut pace.modes) {
            if mode.fraction != S::zero() {
                *decay = mode.decay(period_s);
            }
        }
        for (effect, decay) in effects.iter().zip(&mut pace.effects) {
            match effect {
                Effect::StressRelaxation(mode) => *decay = mode.decay(period_s),
                Effect::ForceLag(lag) => *decay = lag.decay(period_s),
                _ => {}
            }
        }
        pace
    }
}
