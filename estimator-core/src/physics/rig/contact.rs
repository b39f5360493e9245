//! From the tip's motion to the contact force: depth, elastic force, relaxation, damping, adhesion.

use crate::maths::scalar::Scalar;
use crate::physics::effect::Effect;
use crate::physics::law::{Damping, Decay, Environment, MOST_MODES, Recovery, dent_n};
use crate::physics::rig::effects::{Effects, MOST_EFFECTS};
use crate::physics::rig::pace::Pace;

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

/// What is touched, with the effects that change the contact.
pub(super) struct Contact<'a, S> {
    pub(super) environment: &'a Environment<S>,
    pub(super) effects: &'a Effects<S>,
    pub(super) pace: &'a Pace<S>,
}

/// What a contact remembers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactState<S> {
    /// Largest tip − surface so far (m), 0 before the first touch.
    deepest_m: S,
    depth_m: S,
    /// F⁽ᵉ⁾ (N) at the last sample.
    elastic_n: S,
    /// wᵢ (N) of the environment's modes.
    modes: [S; MOST_MODES],
    /// What each effect remembers: a stress relaxation wᵢ (N), others what their files say.
    effects: [S; MOST_EFFECTS],
}

impl<S: Scalar> ContactState<S> {
    pub(super) fn at_rest() -> ContactState<S> {
        let zero = S::zero();
        ContactState {
            deepest_m: zero,
            depth_m: zero,
            elastic_n: zero,
            modes: [zero; MOST_MODES],
            effects: [zero; MOST_EFFECTS],
        }
    }
}

impl<S: Scalar> Contact<'_, S> {
    /// The contact one period later, the tip being at `tip.0` (m) with the speed `tip.1` (m/s).
    pub(super) fn step(&self, state: &mut ContactState<S>, tip: (S, S), time_s: S) -> Touch<S> {
        let (depth_m, speed_mps) = self.depth(&mut state.deepest_m, tip, time_s);
        let change_m = S::zero().max_of(depth_m) - S::zero().max_of(state.depth_m);
        state.depth_m = depth_m;
        let (mut pushed_n, is_reached) = self.relaxed(state, (depth_m, speed_mps), change_m);
        if let Some(damping) = self.damping() {
            pushed_n = pushed_n + damping.force_n(depth_m, speed_mps);
        }
        for (effect, memory) in self.effects.iter().zip(&mut state.effects) {
            if let Effect::HystereticDamping(hysteresis) = effect {
                pushed_n = pushed_n + hysteresis.force_n(memory, depth_m, change_m);
            }
        }
        let touches = depth_m > S::zero() && pushed_n > S::zero() && is_reached;
        let mut force_n = if touches { pushed_n } else { S::zero() };
        for (effect, memory) in self.effects.iter().zip(&mut state.effects) {
            if let Effect::Adhesion(adhesion) = effect {
                force_n = if adhesion.bond > S::zero() {
                    adhesion.bonded_n(memory, depth_m, pushed_n)
                } else {
                    force_n + adhesion.force_n(memory, depth_m, speed_mps)
                };
            }
        }
        Touch {
            force_n,
            depth_m,
            speed_mps,
        }
    }

    /// How long ago (s) the tip met the surface, if within the last period; else the period.
    pub(super) fn since_touch_s(&self, state: &ContactState<S>, tip: (S, S), time_s: S) -> S {
        /// Of the period: its inverse stays a number.
        const LEAST: f64 = 1e-12;
        let (depth_m, speed_mps) = self.depth(&mut { state.deepest_m }, tip, time_s);
        let period_s = self.pace.period_s;
        if depth_m > S::zero() && depth_m < speed_mps * period_s {
            (depth_m / speed_mps).max_of(period_s * S::from_f64(LEAST))
        } else {
            period_s
        }
    }

    /// The penetration δ (m) and its rate δ̇ (m/s).
    fn depth(&self, deepest_m: &mut S, tip: (S, S), time_s: S) -> (S, S) {
        let raw_m = tip.0 - self.environment.surface_m;
        let grows = raw_m > *deepest_m;
        if grows {
            *deepest_m = raw_m;
        }
        let (mut depth_m, mut speed_mps) = (raw_m, tip.1);
        for effect in self.effects.iter() {
            match effect {
                Effect::SurfaceMotion(motion) => {
                    let (displacement_m, rate_mps) = motion.displacement(time_s);
                    depth_m = depth_m - displacement_m;
                    speed_mps = speed_mps - rate_mps;
                }
                Effect::PermanentSet(set) => {
                    let (recession_m, slope) = set.recession_m(*deepest_m);
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

    /// The elastic force F⁽ᵉ⁾ (N), with what effects make of it.
    fn elastic(&self, state: &mut ContactState<S>, (depth_m, speed_mps): (S, S), change_m: S) -> S {
        let Some(mut elastic) = self.environment.elastic else {
            return S::zero();
        };
        if depth_m <= S::zero() {
            return S::zero();
        }
        for effect in self.effects.iter() {
            if let Effect::PowerLawStiffness(power) = effect {
                elastic = power.bend(elastic);
            }
        }
        let (mut factor, mut layers_n) = (S::one(), S::zero());
        for (effect, memory) in self.effects.iter().zip(&mut state.effects) {
            match effect {
                Effect::ExponentialStiffening(stiffening) => {
                    factor = factor * stiffening.factor(depth_m)
                }
                Effect::CyclicSoftening(softening) => {
                    factor = factor * softening.factor(state.deepest_m - depth_m);
                }
                Effect::LoadingCurve(curve) => {
                    factor = factor * curve.factor(memory, (depth_m, speed_mps), change_m);
                }
                Effect::BuriedLayer(layer) => layers_n = layers_n + layer.force_n(depth_m),
                Effect::SnapThrough(snap) => layers_n = layers_n + snap.force_n(depth_m),
                _ => {}
            }
        }
        elastic.force_n(depth_m) * factor + layers_n
    }

    /// The relaxed force F⁽ᵉ⁾ − Σcᵢ(F⁽ᵉ⁾ − wᵢ) (N), (9), over the environment's modes and the effects'; and whether the
    /// probe has reached the surface, which may still be dented.
    fn relaxed(&self, state: &mut ContactState<S>, motion: (S, S), change_m: S) -> (S, bool) {
        let mut elastic_n = self.elastic(state, motion, change_m);
        let mut is_reached = true;
        if self.environment.recovery == Recovery::ByCreep {
            let dent_n = self.dent_n(state);
            is_reached = elastic_n > dent_n;
            elastic_n = elastic_n.max_of(dent_n);
        }
        let change_n = elastic_n - state.elastic_n;
        state.elastic_n = elastic_n;
        let mut force_n = elastic_n;
        let mut relax = |fraction: S, decay: &Decay<S>, w: &mut S| {
            *w = decay.high_passed(*w, change_n);
            force_n = force_n - fraction * (elastic_n - *w);
        };
        let own = self.environment.modes.iter().zip(&self.pace.modes);
        for ((mode, decay), w) in own.zip(&mut state.modes) {
            if mode.fraction != S::zero() {
                relax(mode.fraction, decay, w);
            }
        }
        let added = self.effects.iter().zip(&self.pace.effects);
        for ((effect, decay), w) in added.zip(&mut state.effects) {
            if let Effect::StressRelaxation(mode) = effect {
                relax(mode.fraction, decay, w);
            }
        }
        (force_n, is_reached)
    }

    /// The elastic force (N) at which a probe meets a surface that has crept back for one period more.
    fn dent_n(&self, state: &ContactState<S>) -> S {
        let own = self.environment.modes.iter().zip(self.pace.modes);
        let own = own.zip(state.modes);
        let own = own.map(|((mode, decay), w)| (mode.fraction, decay, w));
        let added = self.effects.iter().zip(self.pace.effects);
        let added = added.zip(state.effects);
        let added = added.filter_map(|((effect, decay), w)| match effect {
            Effect::StressRelaxation(mode) => Some((mode.fraction, decay, w)),
            _ => None,
        });
        dent_n(own.chain(added), state.elastic_n)
    }

    /// The environment's damping, with the exponent that an effect gives it.
    fn damping(&self) -> Option<Damping<S>> {
        let mut damping = self.environment.damping?;
        for effect in self.effects.iter() {
            if let Effect::DepthDependentDamping(dependence) = effect {
                damping.exponent = dependence.exponent;
            }
        }
        Some(damping)
    }
}
