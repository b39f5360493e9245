//! A rig: a contact law and the effects that the rig adds, in signal order. Position in, the load
//! cell's reading out.
//!
//! ```text
//! x_read → motor side x → tip → depth → elastic → relaxation → contact → load path → F_read
//! ```
//!
//! One formula for simulation, fit and compensation, generic over the scalar: see [`crate::physics::effect`]
//! for the order, and each effect's file for its law. A `time_delay` is the caller's: F(t − T_d) is
//! this rig moved as it was T_d ago.

mod contact;
mod effects;
mod pace;

pub use super::law::{Damping, Environment, MOST_MODES};
use contact::Contact;
pub use contact::{ContactState, Touch};
pub use effects::{Effects, MOST_EFFECTS};
pub use pace::Pace;

use crate::maths::scalar::Scalar;
use crate::physics::effect::{Effect, LoadPathMemory, Motion, Rubbing};
use crate::physics::load_path::{cables_n, play_m, share_of_load, wind};

/// What is touched, and what touches it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rig<S> {
    /// What is touched.
    pub environment: Environment<S>,
    /// What the rig adds, in any order: each effect enters at its stage of the chain.
    pub effects: Effects<S>,
}

/// What a rig remembers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigState<S> {
    contact: ContactState<S>,
    /// Position of the motor side (m) at the last sample.
    motor_m: S,
    /// Position of the far side of a play (m) at the last sample.
    far_m: S,
    /// Deflection of a series compliance (m) at the last two samples.
    deflection_m: [S; 2],
    /// Period between those two samples (s).
    period_s: S,
    /// What each effect of the load path remembers.
    load_path: [LoadPathMemory<S>; MOST_EFFECTS],
    /// Force before the lag (N) at the last sample.
    load_n: S,
    /// Force after the lag (N) at the last sample.
    reading_n: S,
    /// Whether a sample has come yet.
    started: bool,
}

/// What a rig does at one sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading<S> {
    /// What the load cell reads (N).
    pub force_n: S,
    /// The contact itself.
    pub touch: Touch<S>,
}

impl<S: Scalar> RigState<S> {
    /// The same with another material under the probe, at rest; what the rig itself remembers stays.
    #[must_use]
    pub fn renewed(self) -> RigState<S> {
        RigState {
            contact: ContactState::at_rest(),
            deflection_m: [S::zero(); 2],
            ..self
        }
    }
}

impl<S: Scalar> Rig<S> {
    /// A rig that adds nothing.
    pub fn bare(environment: Environment<S>) -> Rig<S> {
        Rig {
            environment,
            effects: Effects::none(),
        }
    }

    /// The same rig with one effect more; unchanged if it has [`MOST_EFFECTS`].
    #[must_use]
    pub fn with(mut self, effect: Effect<S>) -> Rig<S> {
        self.effects.push(effect);
        self
    }

    /// The effects that the rig adds.
    pub fn effects(&self) -> impl Iterator<Item = &Effect<S>> + Clone {
        self.effects.iter()
    }

    /// How late the force is read (s), of all `time_delay`, for the caller to shift the motion by;
    /// `None` without one.
    pub fn delay_s(&self) -> Option<S> {
        let delays = self.effects().filter_map(|effect| match effect {
            Effect::TimeDelay(delay) => Some(delay.delay_s),
            _ => None,
        });
        delays.reduce(|sum, delay_s| sum + delay_s)
    }

    /// Standing still out of contact, for ever.
    pub fn at_rest(&self) -> RigState<S> {
        let zero = S::zero();
        RigState {
            contact: ContactState::at_rest(),
            motor_m: zero,
            far_m: zero,
            deflection_m: [zero; 2],
            period_s: S::one(),
            load_path: [LoadPathMemory::at_rest(); MOST_EFFECTS],
            load_n: zero,
            reading_n: zero,
            started: false,
        }
    }

    /// As at rest, but with those of the first effects that stick wound up to a `side`, from −1 to 1 what it takes to slide:
    /// so an earlier motion may have left them.
    pub fn wound(&self, side: S, first: usize) -> RigState<S> {
        let mut state = self.at_rest();
        let each = self.effects.iter().zip(&mut state.load_path).take(first);
        each.for_each(|(effect, memory)| wind(effect, memory, side));
        state
    }

    /// The reading one period (s) after the last one; `read` is the motion as the encoder gives it.
    /// The first step starts the memories: whatever its period, nothing has moved before it.
    pub fn step(&self, state: &mut RigState<S>, read: Motion<S>, period_s: S) -> Reading<S> {
        self.step_at(&self.pace(period_s), state, read)
    }

    /// What a period (s) does to all that decays in this rig, for [`Rig::step_at`].
    pub fn pace(&self, period_s: S) -> Pace<S> {
        Pace::of(&self.environment, &self.effects, period_s)
    }

    /// The same at the [`Rig::pace`] of the period: of this rig, or one that decays alike.
    pub fn step_at(&self, pace: &Pace<S>, state: &mut RigState<S>, read: Motion<S>) -> Reading<S> {
        let motor = self.motor_side(read);
        if !state.started {
            (state.motor_m, state.far_m) = (motor.position_m, motor.position_m);
        }
        let touch = self.touch(state, &motor, pace);
        let load_n = touch.force_n + self.load_path_n(state, &motor, touch.force_n);
        if !state.started {
            (state.load_n, state.reading_n) = (load_n, load_n);
        }
        let force_n = self.reading(state, load_n, pace);
        state.motor_m = motor.position_m;
        state.started = true;
        Reading { force_n, touch }
    }

    /// The contact alone, one period after `state`, which stays as it is: what a motor would feel there.
    pub fn trial(&self, state: &RigState<S>, motor: &Motion<S>, period_s: S) -> Touch<S> {
        self.touch(&mut { *state }, motor, &self.pace(period_s))
    }

    /// The motor side behind its encoder.
    pub fn motor_side(&self, read: Motion<S>) -> Motion<S> {
        let mut motion = read;
        for effect in self.effects() {
            if let Effect::EncoderPeriodicError(error) = effect {
                motion = error.motor_side(motion);
            }
        }
        motion
    }

    fn contact<'a>(&'a self, pace: &'a Pace<S>) -> Contact<'a, S> {
        Contact {
            environment: &self.environment,
            effects: &self.effects,
            pace,
        }
    }

    /// From the motor side to the contact force.
    fn touch(&self, state: &mut RigState<S>, motor: &Motion<S>, pace: &Pace<S>) -> Touch<S> {
        let mut tip = (motor.position_m, motor.speed_mps);
        let mut yields = false;
        for effect in self.effects() {
            match effect {
                Effect::Backlash(backlash) => {
                    let (far_m, taken) = backlash.follow(state.far_m, motor.position_m);
                    state.far_m = far_m;
                    tip = (far_m, if taken { tip.1 } else { S::zero() });
                }
                Effect::SeriesCompliance(_) => yields = true,
                _ => {}
            }
        }
        if yields {
            self.yielding(state, tip, motor.time_s, pace)
        } else {
            self.contact(pace)
                .step(&mut state.contact, tip, motor.time_s)
        }
    }

    /// A contact behind a spring: tip = x − u(F), solved for the deflection u at the end of the
    /// period by Newton's method. u̇ is the slope of the parabola through the last three
    /// deflections, which is exact to second order and stable for any period.
    fn yielding(
        &self,
        state: &mut RigState<S>,
        tip: (S, S),
        time_s: S,
        pace: &Pace<S>,
    ) -> Touch<S> {
        /// Newton's steps at most, and the share of the deflection below which a step is the last: it
        /// squares. The gradients of dual numbers lag one step behind the value.
        const STEPS: usize = 4;
        const LAST: f64 = 1e-6;
        let [u1, u2] = state.deflection_m;
        // A spring that is not yet deflected knows no slope: at touch it has a corner. Since then it has had no more time
        // than the tip: over a whole period it would be ahead of it, and a damper's force was that of a rigid rig for one
        // sample, and late after it.
        let is_new = u1 == S::zero();
        let period_s = match is_new {
            true => self
                .contact(pace)
                .since_touch_s(&state.contact, tip, time_s),
            false => pace.period_s,
        };
        let (now, then) = (S::one() / period_s, S::one() / state.period_s);
        let both = S::one() / (period_s + state.period_s);
        let (weights, slope) = if is_new {
            ([now, S::zero()], now)
        } else {
            ([now + then, then - both], now + both)
        };
        let rate = |u: S| slope * u - weights[0] * u1 + weights[1] * u2;
        let contact = |from: &mut ContactState<S>, u: S| {
            let yielded = (tip.0 - u, tip.1 - rate(u));
            self.contact(pace).step(from, yielded, time_s)
        };
        let mut u = u1;
        for _ in 0..STEPS {
            let touch = contact(&mut state.contact.clone(), u);
            let stiffness = self
                .environment
                .slope(touch.depth_m, touch.speed_mps, slope);
            let (given_way, softness) = self.given_way(touch.force_n);
            let error = u - given_way;
            u = u - error / (S::one() + stiffness * softness);
            if error.abs() <= S::from_f64(LAST) * u.abs() {
                break;
            }
        }
        state.deflection_m = [u, u1];
        state.period_s = period_s;
        contact(&mut state.contact, u)
    }

    /// How far the springs give way (m) to a force, and how much further per newton (m/N).
    fn given_way(&self, force_n: S) -> (S, S) {
        let mut sum = (S::zero(), S::zero());
        for effect in self.effects() {
            if let Effect::SeriesCompliance(compliance) = effect {
                sum.0 = sum.0 + compliance.deflection_m(force_n);
                sum.1 = sum.1 + compliance.softness_m_per_n(force_n);
            }
        }
        sum
    }

    /// What comes to the contact force (N) between contact and load cell (N).
    fn load_path_n(&self, state: &mut RigState<S>, motor: &Motion<S>, contact_n: S) -> S {
        let change_m = motor.position_m - state.motor_m;
        let play_m = play_m(self.effects());
        let mut force_n = S::zero();
        let each = self.effects.iter().zip(&mut state.load_path);
        let rubbing = Rubbing {
            speed_mps: motor.speed_mps,
            change_m,
            play_m,
        };
        let share = share_of_load(each, |friction, memory| {
            friction.share_of_load(memory, &rubbing)
        });
        if let Some(share) = share {
            let cables_n = cables_n(self.effects(), motor.position_m, play_m);
            force_n = share * (contact_n + cables_n).abs();
        }
        for (effect, memory) in self.effects.iter().zip(&mut state.load_path) {
            force_n = force_n + effect.load_n(memory, motor, change_m, play_m);
        }
        force_n
    }

    /// From the force to its reading: lag, then limit.
    fn reading(&self, state: &mut RigState<S>, load_n: S, pace: &Pace<S>) -> S {
        let mut lagged_n = load_n;
        for (effect, decay) in self.effects().zip(&pace.effects) {
            if let Effect::ForceLag(_) = effect {
                // Exact for a force that is linear in between.
                let (behind_n, change_n) = (state.load_n - state.reading_n, load_n - state.load_n);
                lagged_n = load_n - decay.high_passed(behind_n, change_n);
            }
        }
        (state.load_n, state.reading_n) = (load_n, lagged_n);
        let mut force_n = lagged_n;
        for effect in self.effects() {
            if let Effect::ForceSaturation(saturation) = effect {
                force_n = saturation.reading_n(force_n);
            }
        }
        force_n
    }
}

#[cfg(test)]
mod tests;
