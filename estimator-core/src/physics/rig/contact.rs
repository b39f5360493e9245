//! From the tip's motion to the contact force: depth, elastic force, relaxation, damping, adhesion.

use super::environment::{Damping, MOST_MODES};
use super::{MOST_EFFECTS, Rig};
use crate::maths::scalar::Scalar;
use crate::physics::effect::Effect;
use crate::physics::law::{RelaxationMode, high_passed};

/// A contact at one sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch<S> {
    /// Force on the probe (N).
    pub force_n: S,
    /// Penetration δ (m), negative out of contact.
    pub depth_m: S,
    /// δ̇ (m/s)
    pub speed_mps: S,
}

/// What a contact remembers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactState<S> {
    /// Largest tip − surface so far (m), 0 before the first touch.
    deepest_m: S,
    depth_m: S,
    /// F⁽ᵉ⁾ (N) at the last sample.
    elastic_n: S,
    /// wᵢ (N) of the environment's modes, and of the effects'.
    modes: [S; MOST_MODES],
    memories: [S; MOST_EFFECTS],
}

impl<S: Scalar> ContactState<S> {
    pub(super) fn at_rest() -> ContactState<S> {
        let nil = S::zero();
        ContactState {
            deepest_m: nil,
            depth_m: nil,
            elastic_n: nil,
            modes: [nil; MOST_MODES],
            memories: [nil; MOST_EFFECTS],
        }
    }
}

impl<S: Scalar> Rig<S> {
    /// The contact one period later, the tip being at `tip.0` (m) with the speed `tip.1` (m/s).
    pub(super) fn contact(
        &self,
        state: &mut ContactState<S>,
        tip: (S, S),
        time_s: S,
        period_s: S,
    ) -> Touch<S> {
        let (depth_m, speed_mps) = self.depth(state, tip, time_s);
        let relaxed_n = self.relaxed(state, depth_m, period_s);
        let change_m = S::zero().max_of(depth_m) - S::zero().max_of(state.depth_m);
        state.depth_m = depth_m;
        let mut pushed_n = relaxed_n;
        if let Some(damping) = self.damping() {
            pushed_n = pushed_n + damping.force_n(depth_m, speed_mps);
        }
        for (effect, memory) in self.effects.iter().zip(&mut state.memories) {
            if let Some(Effect::HystereticDamping(own)) = effect {
                pushed_n = pushed_n + own.force_n(memory, depth_m, change_m);
            }
        }
        let touches = depth_m > S::zero() && pushed_n > S::zero();
        let mut force_n = if touches { pushed_n } else { S::zero() };
        for (effect, memory) in self.effects.iter().zip(&mut state.memories) {
            if let Some(Effect::Adhesion(own)) = effect {
                force_n = if own.bond > S::zero() {
                    own.bonded_n(memory, depth_m, pushed_n)
                } else {
                    force_n + own.force_n(memory, depth_m, speed_mps)
                };
            }
        }
        Touch {
            force_n,
            depth_m,
            speed_mps,
        }
    }

    /// δ and δ̇.
    fn depth(&self, state: &mut ContactState<S>, tip: (S, S), time_s: S) -> (S, S) {
        let raw_m = tip.0 - self.environment.surface_m;
        let grows = raw_m > state.deepest_m;
        if grows {
            state.deepest_m = raw_m;
        }
        let (mut depth_m, mut speed_mps) = (raw_m, tip.1);
        for effect in self.effects() {
            match effect {
                Effect::SurfaceMotion(own) => {
                    let (displacement_m, rate_mps) = own.displacement(time_s);
                    depth_m = depth_m - displacement_m;
                    speed_mps = speed_mps - rate_mps;
                }
                Effect::PermanentSet(own) => {
                    let (recession_m, slope) = own.recession_m(state.deepest_m);
                    depth_m = depth_m - recession_m;
                    if grows {
                        speed_mps = speed_mps - slope * tip.1;
                    }
                }
                _ => {}
            }
        }
        (depth_m, speed_mps)
    }

    /// Fᵉ, with what effects make of it.
    fn elastic(&self, state: &ContactState<S>, depth_m: S) -> S {
        let Some(mut elastic) = self.environment.elastic else {
            return S::zero();
        };
        if depth_m <= S::zero() {
            return S::zero();
        }
        for effect in self.effects() {
            if let Effect::PowerLawStiffness(own) = effect {
                elastic = own.bend(elastic);
            }
        }
        let (mut factor, mut layers_n) = (S::one(), S::zero());
        for effect in self.effects() {
            match effect {
                Effect::ExponentialStiffening(own) => factor = factor * own.factor(depth_m),
                Effect::CyclicSoftening(own) => {
                    factor = factor * own.factor(state.deepest_m - depth_m);
                }
                Effect::BuriedLayer(own) => layers_n = layers_n + own.force_n(depth_m),
                _ => {}
            }
        }
        elastic.force_n(depth_m) * factor + layers_n
    }

    /// Fᵉ − Σcᵢ(Fᵉ − wᵢ), (9), over the environment's modes and the effects'.
    fn relaxed(&self, state: &mut ContactState<S>, depth_m: S, period_s: S) -> S {
        let elastic_n = self.elastic(state, depth_m);
        let change_n = elastic_n - state.elastic_n;
        state.elastic_n = elastic_n;
        let mut force_n = elastic_n;
        let mut relax = |mode: &RelaxationMode<S>, w: &mut S| {
            *w = high_passed(*w, change_n, mode.rate_per_s, period_s);
            force_n = force_n - mode.fraction * (elastic_n - *w);
        };
        for (mode, w) in self.environment.modes.iter().zip(&mut state.modes) {
            if mode.fraction != S::zero() {
                relax(mode, w);
            }
        }
        for (effect, w) in self.effects.iter().zip(&mut state.memories) {
            if let Some(Effect::StressRelaxation(own)) = effect {
                relax(&own.mode(), w);
            }
        }
        force_n
    }

    fn damping(&self) -> Option<Damping<S>> {
        let mut damping = self.environment.damping?;
        for effect in self.effects() {
            if let Effect::DepthDependentDamping(own) = effect {
                damping.exponent = own.exponent;
            }
        }
        Some(damping)
    }
}
