//! The signal chain of a rig backwards: from what encoder and load cell read to the position of the
//! tip and the contact force.
//!
//! An estimator that is fed with raw readings finds the rig's friction and inertia in the material.
//! [`Compensation`] removes what belongs to the rig, in the order of the chain from its ends: the
//! encoder's error, the delay between the channels, the lag of the load cell, what the load path adds
//! to the force, and the play and springs between motor and tip.
//!
//! What belongs to the material stays in the force, since an estimator is asked for it: relaxation,
//! adhesion, hysteretic and depth-dependent damping, stiffening, permanent set, cyclic softening,
//! buried layers, and a surface that moves.
//!
//! **Speed, acceleration and rate of force.** Drag, friction, inertia and lag need derivatives, and
//! the derivative of a 1 µm encoder needs a window: that of
//! [`SavitzkyGolay`](crate::estimate::filter::SavitzkyGolay), ±5 ms. It averages position and force
//! with the same weights hₖ, and its slope is the rate of that average, so that a force m·a, b·v or τḞ
//! is removed exactly however fast the motion changes. A narrow derivative beside a raw force would
//! leave m(a − ā) at each corner of a motion: 0.15 N for a tool of 0.2 kg that starts at 8 mm/s.
//! Acceleration and Ḟ are central differences of two neighbouring averages: 0.014 m/s² of noise from a
//! 1 µm encoder at 1 kHz. Laws that are not linear in the motion (friction, cogging) are averaged over
//! the window along the parabola x̄, v̄, ā.
//!
//! A motion of less than half a count of the encoder in half a window counts as rest, in which sliding
//! friction has no direction: when the swing of a motor decays below that, 0.4 N of friction stay in the
//! force for 25 ms.
//!
//! The result is delayed by the half width of the window and one sample (6 ms at 1 kHz), and by a
//! `time_delay`. A rig whose effects need no derivative has no window and no such delay. Noise that
//! went through the window is no longer white: give the estimator that of the raw force
//! (`contact.force_noise_n`, or [`crate::State::observe_raw`]). A fault of a sample is a fault
//! of every result that the sample is part of.

mod delay;
mod faults;
mod window;

pub use delay::MAX_DELAY_SAMPLES;

use crate::estimate::error::{ConfigError, require_each};
use crate::estimate::fault::{Fault, Faults};
use crate::estimate::sample::Sample;
use crate::maths::scalar::{Real, Scalar, seconds};
use crate::physics::effect::{Effect, EffectId, LoadPathMemory, Motion, Rubbing};
use crate::physics::load_path::{cables_n, play_m, share_of_load, without_load_friction_n};
use crate::physics::rig::{Effects, MOST_EFFECTS};
use delay::{ChannelDelay, DelayLine};
use faults::LingeringFaults;
use window::{Window, WindowMean, WindowState, resting_at};

/// A force reading at or above this fraction of the load cell's limit counts as saturated: 1 % is left
/// for noise and the cell's steps.
const SATURATED_FRACTION: f64 = 0.99;

/// Faults of one sample that belong to every result whose window contains it.
const LINGERING: Faults = Faults::NONE
    .with(Fault::ForceSaturated)
    .with(Fault::ForceStuck)
    .with(Fault::PositionStuck);

/// The effects of a rig that are removed from its readings, ready to use.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Compensation<T> {
    effects: Effects<T>,
    period_us: u64,
    delay: ChannelDelay<T>,
    /// The window, if an effect needs a derivative.
    window: Option<Window<T>>,
    delay_s: f64,
    /// The same in the precision of the samples, which a board has in hardware.
    behind_s: T,
}

/// What a [`Compensation`] remembers of the samples.
#[derive(Clone, Debug, Default)]
pub struct CompensationState<T: Real> {
    delay_line: DelayLine<T>,
    window: WindowState<T>,
    /// What each effect of the load path remembers.
    load_path: [LoadPathMemory<T>; MOST_EFFECTS],
    /// Positions (m) of the motor side and of the far side of the play.
    motor_m: T,
    far_m: T,
    faults: LingeringFaults,
    last_time_us: Option<u64>,
}

impl<T: Real> Compensation<T> {
    /// Makes a compensation of those `effects` that belong to the rig, for samples at `rate_hz` (Hz).
    /// `position_step_m` is one count of the encoder (m), 0 for a position without steps: motion that
    /// is too slow for it counts as rest, in which sliding friction has no direction.
    ///
    /// # Errors
    /// The rate is not between 0 and 1 MHz, or the delay is longer than [`MAX_DELAY_SAMPLES`].
    pub fn new(
        effects: &Effects<f64>,
        rate_hz: f32,
        position_step_m: f64,
    ) -> Result<Self, ConfigError> {
        let rigs = effects.iter().filter(|effect| effect.id().belongs_to_rig());
        Compensation::from_rig_effects(rigs.map(cast).collect(), rate_hz, position_step_m)
    }

    /// Makes a compensation as [`Compensation::new`] does, of effects that all belong to the rig and
    /// have its precision: a board stores no others.
    pub(crate) fn from_rig_effects(
        effects: Effects<T>,
        rate_hz: f32,
        position_step_m: f64,
    ) -> Result<Self, ConfigError> {
        require_each! {
            rate_hz > 0.0 && rate_hz <= 1e6, "rate_hz", rate_hz, "must lie between 0 and 1 MHz";
        }
        let rate = f64::from(rate_hz);
        let delays = effects.iter().map(|effect| match effect {
            Effect::TimeDelay(delay) => delay.delay_s.to_f64(),
            _ => 0.0,
        });
        let delay_s: f64 = delays.sum();
        let delay = ChannelDelay::new(delay_s, rate)?;
        let moving = effects.iter().any(Effect::needs_derivative);
        let window = moving.then(|| Window::new(rate, position_step_m));
        let window_samples = window.map_or(0, |window| window.delay_samples());
        let delay_s = window_samples as f64 / rate + delay_s.max(0.0);
        Ok(Compensation {
            effects,
            period_us: (1e6 / rate) as u64,
            delay,
            window,
            delay_s,
            behind_s: T::from_f64(delay_s),
        })
    }

    /// The effects that are removed.
    pub fn ids(&self) -> impl Iterator<Item = EffectId> + '_ {
        self.effects().map(Effect::id)
    }

    fn effects(&self) -> impl Iterator<Item = &Effect<T>> {
        self.effects.iter()
    }

    /// Delay of a result behind the newest sample (s).
    pub fn delay_s(&self) -> f64 {
        self.delay_s
    }

    /// The state before the first sample.
    pub fn at_rest(&self) -> CompensationState<T> {
        CompensationState::default()
    }

    /// Takes one raw sample; gives the position of the tip and the contact force of the instant that
    /// lies [`Compensation::delay_s`] before it, with the time stamp of the raw sample. A sample that is
    /// not finite is passed on unchanged, and the estimator drops it.
    pub fn step(&self, state: &mut CompensationState<T>, read: Sample<T>) -> Sample<T> {
        if !(read.position_m.is_finite() && read.force_n.is_finite()) {
            return read;
        }
        let position_m = self.motor_side_m(read.position_m);
        let last_us = state.last_time_us.replace(read.time_us);
        let follows = last_us.is_some_and(|last| self.follows(last, read.time_us));
        let restarts = !follows || read.faults.has(Fault::PositionJump);
        if restarts {
            self.restart(state, position_m, read.force_n);
        }
        let faults = self.faults(state, &read, restarts && last_us.is_some());
        let mean = self.mean(state, read.time_us, position_m, read.force_n);
        let force_n = self.contact_n(state, &mean);
        Sample {
            time_us: read.time_us,
            position_m: self.tip_m(state, mean.motion.position_m, force_n),
            force_n,
            faults,
        }
    }

    /// Whether a sample is the next after that at `last` (µs): it comes within 1.5 periods.
    fn follows(&self, last: u64, time_us: u64) -> bool {
        time_us >= last && time_us - last <= self.period_us + self.period_us / 2 + 1
    }

    /// Position of the motor side (m) for a reading of the encoder.
    fn motor_side_m(&self, read_m: T) -> T {
        self.effects().fold(read_m, |at_m, effect| match effect {
            Effect::EncoderPeriodicError(error) => error.motor_side(resting_at(at_m)).position_m,
            _ => at_m,
        })
    }

    /// Motion and force at one instant, in the mean over the window if there is one.
    fn mean(
        &self,
        state: &mut CompensationState<T>,
        time_us: u64,
        position_m: T,
        force_n: T,
    ) -> WindowMean<T> {
        let time_s = seconds::<T>(time_us) - self.behind_s;
        let (position_m, force_n) = self.delay.align(&mut state.delay_line, position_m, force_n);
        let Some(window) = &self.window else {
            return WindowMean::instant(time_s, position_m, force_n);
        };
        let lag_s = self.effects().fold(T::zero(), |sum, effect| match effect {
            Effect::ForceLag(lag) => sum + lag.time_constant_s,
            _ => sum,
        });
        window.update(&mut state.window, time_s, (position_m, force_n), lag_s)
    }

    /// The contact force (N): the mean over the window without what the load path adds.
    fn contact_n(&self, state: &mut CompensationState<T>, mean: &WindowMean<T>) -> T {
        let play_m = play_m(self.effects());
        let change_m = mean.motion.position_m - state.motor_m;
        state.motor_m = mean.motion.position_m;
        let known_n = mean.force_n - self.load_path_n(state, mean, change_m, play_m);
        let each = self.effects.iter().zip(&mut state.load_path);
        let share = share_of_load(each, |friction, memory| {
            let follows_way = friction.width_m > T::zero();
            self.in_the_mean(
                mean,
                follows_way,
                memory,
                change_m,
                |memory, at, change_m| {
                    let rubbing = Rubbing {
                        speed_mps: at.speed_mps,
                        change_m,
                        play_m,
                    };
                    friction.share_of_load(memory, &rubbing)
                },
            )
        });
        let Some(share) = share else {
            return known_n;
        };
        let cables_n = cables_n(self.effects(), mean.motion.position_m, play_m);
        without_load_friction_n(known_n, cables_n, share)
    }

    /// Force that the load path adds (N), in the mean over the window, but for a friction that grows
    /// with the load.
    fn load_path_n(
        &self,
        state: &mut CompensationState<T>,
        mean: &WindowMean<T>,
        change_m: T,
        play_m: T,
    ) -> T {
        let mut force_n = T::zero();
        for (effect, memory) in self.effects.iter().zip(&mut state.load_path) {
            let follows_way = effect.depends_on_travel();
            force_n += self.in_the_mean(
                mean,
                follows_way,
                memory,
                change_m,
                |memory, at, change_m| effect.load_n(memory, at, change_m, play_m),
            );
        }
        force_n
    }

    /// What an effect does in the mean over the window; what follows the way has its memory at one end of the window
    /// only, and is taken after the whole way of `change_m`.
    fn in_the_mean(
        &self,
        mean: &WindowMean<T>,
        follows_way: bool,
        memory: &mut LoadPathMemory<T>,
        change_m: T,
        does: impl Fn(&mut LoadPathMemory<T>, &Motion<T>, T) -> T,
    ) -> T {
        match &self.window {
            Some(window) if !follows_way => {
                window.mean_force_n(mean, |at| does(&mut { *memory }, at, T::zero()))
            }
            _ => does(memory, &mean.motion, change_m),
        }
    }

    /// Position of the tip (m) behind the play and the springs of the transmission.
    fn tip_m(&self, state: &mut CompensationState<T>, motor_m: T, force_n: T) -> T {
        let mut tip_m = motor_m;
        for effect in self.effects() {
            if let Effect::Backlash(play) = effect {
                state.far_m = play.follow(state.far_m, motor_m).0;
                tip_m = state.far_m;
            }
        }
        self.effects().fold(tip_m, |tip_m, effect| match effect {
            Effect::SeriesCompliance(spring) => tip_m - spring.deflection_m(force_n),
            _ => tip_m,
        })
    }

    /// Faults of the result: those of the sample, and those that linger from the samples before it.
    /// After a restart, nothing should be learned until the window is full.
    fn faults(
        &self,
        state: &mut CompensationState<T>,
        read: &Sample<T>,
        restarted: bool,
    ) -> Faults {
        let mut lingering = read.faults.intersection(LINGERING);
        if self.is_saturated(read.force_n) {
            lingering = lingering.with(Fault::ForceSaturated);
        }
        if restarted {
            lingering = lingering.with(Fault::SampleMissed);
        }
        read.faults | state.faults.update(lingering, self.memory_samples())
    }

    /// Number of samples that a result is made of, the newest among them.
    pub fn memory_samples(&self) -> usize {
        let window_samples = self.window.map_or(0, |window| 2 * window.delay_samples());
        window_samples + self.delay.samples() + 1
    }

    fn is_saturated(&self, reading_n: T) -> bool {
        self.effects().any(|effect| match effect {
            Effect::ForceSaturation(cell) => {
                // A rounded limit is e⁻³ of its softness off where this begins.
                let rounded_n = T::from_f64(3.0) * cell.softness_n;
                reading_n >= cell.limit_n * T::from_f64(SATURATED_FRACTION) - rounded_n
            }
            _ => false,
        })
    }

    /// Sets the state as if position (m) and force (N) had always been these.
    fn restart(&self, state: &mut CompensationState<T>, position_m: T, force_n: T) {
        self.delay
            .restart(&mut state.delay_line, position_m, force_n);
        state.window.restart(position_m, force_n);
        (state.motor_m, state.far_m) = (position_m, position_m);
    }
}

/// The same effect in another precision.
fn cast<T: Scalar>(effect: &Effect<f64>) -> Effect<T> {
    Effect::new(effect.id(), &effect.row().map(T::from_f64))
}

#[cfg(test)]
mod tests;
