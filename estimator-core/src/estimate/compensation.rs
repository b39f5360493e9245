//! The chain backwards: from what encoder and load cell read to the tip and the contact force.
//!
//! An estimator that is fed with the readings of a rig finds the rig's friction and inertia in the
//! material. [`Compensation`] takes off what belongs to the rig, in the order of the chain from its
//! ends: the encoder's error, the delay between the channels, the lag of the load cell, what the load
//! path adds, and what the transmission takes from the way.
//!
//! What belongs to the material stays in the force, since it is what an estimator is asked for:
//! relaxation, adhesion, hysteretic and depth-dependent damping, stiffening, permanent set, cyclic
//! softening, buried layers, and a surface that moves.
//!
//! **Speed, acceleration and rate of force.** Drag, friction, inertia and lag need derivatives, and
//! the derivative of a 1 µm encoder needs a window. It is that of [`SavitzkyGolay`], ±5 ms: position
//! and force leave it as the same average hₖ, and its slope is the rate of that average, so that a
//! force m·a, b·v or τḞ is taken off exactly however fast the motion changes. A narrow derivative
//! beside a raw force would leave m(a − ā) at each corner of a motion: 0.15 N for a tool of 0.2 kg
//! that starts at 8 mm/s. Acceleration and Ḟ are central differences of two neighbouring averages:
//! 0.014 m/s² of noise from a 1 µm encoder at 1 kHz. Laws that are not linear in the motion
//! (friction, cogging) are averaged over the window along the parabola x̄, v̄, ā.
//!
//! What moves slower than half a count of the encoder in half a window rests: sliding friction then
//! has no direction, and a motor that swings out below that keeps 0.4 N of it for 25 ms.
//!
//! The result is late by the half width and one sample (6 ms at 1 kHz), and by a `time_delay`; a rig
//! whose effects need no derivative has neither window nor lateness. Noise that went through the
//! window is no longer white: give the estimator the raw one (`contact.force_noise_n`, or
//! [`crate::State::hear`]). What is wrong with a sample is wrong with every result that it is in.

use crate::estimate::error::{ConfigError, require};
use crate::estimate::fault::{Fault, Faults};
use crate::estimate::filter::{Aligned, SavitzkyGolay, SavitzkyGolayParams};
use crate::estimate::sample::Sample;
use crate::maths::scalar::{Real, Scalar};
use crate::physics::effect::{Effect, EffectId, Motion, Place};
use crate::physics::rig::MOST_EFFECTS;

/// Longest `time_delay` (samples), either way.
pub const LONGEST_DELAY: usize = 64;

/// Half of the window (s): the rise of a position-controlled motor of 100 Hz.
const HALF_WINDOW_S: f64 = 5e-3;

/// A reading within this share of the cell's limit stands at it: 1 %, noise and steps included.
const AT_LIMIT: f64 = 0.99;

/// Faults of one sample that are in every result whose window it is in.
const LINGER: [Fault; 3] = [
    Fault::ForceSaturated,
    Fault::ForceStuck,
    Fault::PositionStuck,
];

/// Whether the effect belongs to the rig and is taken off; else it belongs to what is touched.
pub const fn compensates(id: EffectId) -> bool {
    matches!(
        id.place(),
        Place::PositionReading | Place::Transmission | Place::LoadPath | Place::ForceReading
    )
}

/// What is to be taken off, and how.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Compensation<T> {
    effects: [Option<Effect<T>>; MOST_EFFECTS],
    /// The last of them that is one, and one more.
    used: usize,
    rate_hz: T,
    period_us: u64,
    /// F(t − T_d) in whole samples and a part of one; of the position if the force is late.
    delay: (usize, T),
    position_waits: bool,
    window: Option<Window<T>>,
    delay_s: f64,
}

/// The window that derivatives need.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Window<T> {
    filter: SavitzkyGolayParams<T>,
    /// Σhₖ(kT)² (s²)
    spread_s2: T,
    /// Variance of the position (m²) up to which it may be a rest: a count that comes and goes.
    still_m2: T,
}

/// What a compensation remembers.
#[derive(Clone, Debug)]
pub struct CompensationState<T> {
    /// The channel that waits for the other, the newest first.
    waiting: [T; LONGEST_DELAY + 2],
    filter: SavitzkyGolay<T>,
    /// The last three averages, the newest first.
    averages: [Aligned<T>; 3],
    /// Friction's z, by effect; the motor side (m) and the far side of a play (m).
    sliding: [T; MOST_EFFECTS],
    motor_m: T,
    far_m: T,
    /// What was wrong with a sample, and how many more samples the window remembers it for.
    lingering: Faults,
    distrust: usize,
    last_time_us: Option<u64>,
}

/// The motor side and the force between probe and cell at one instant, or in the mean of a window.
struct Moment<T> {
    motion: Motion<T>,
    load_n: T,
    /// Whether the encoder saw no motion.
    rests: bool,
}

impl<T: Real> Compensation<T> {
    /// A compensation of those `effects` that are the rig's own, at `rate_hz`; `position_step_m` is
    /// a count of the encoder (m), 0 if there are none: what is too slow for it counts as a rest, in
    /// which sliding friction has no direction.
    ///
    /// # Errors
    /// A rate that is none, or a delay longer than [`LONGEST_DELAY`] samples.
    pub fn new(
        effects: &[Option<Effect<f64>>; MOST_EFFECTS],
        rate_hz: f32,
        position_step_m: f64,
    ) -> Result<Self, ConfigError> {
        let own = |effect: &Effect<f64>| compensates(effect.id());
        let effects = effects.map(|slot| slot.filter(own).map(|effect| cast(&effect)));
        Compensation::of(effects, rate_hz, position_step_m)
    }

    /// The same of effects that are the rig's and in its precision already: a board has no others.
    pub(crate) fn of(
        effects: [Option<Effect<T>>; MOST_EFFECTS],
        rate_hz: f32,
        position_step_m: f64,
    ) -> Result<Self, ConfigError> {
        require(
            rate_hz > 0.0 && rate_hz <= 1e6,
            "rate_hz",
            rate_hz,
            "must lie between 0 and 1 MHz",
        )?;
        let rate = f64::from(rate_hz);
        let delays = effects.iter().flatten().map(|effect| match effect {
            Effect::TimeDelay(own) => own.delay_s.to_f64(),
            _ => 0.0,
        });
        let delay_s: f64 = delays.sum();
        let steps = delay_s.abs() * rate;
        require(
            // 64 ms in f32, as a setting has it, are 64.000 000 3 samples.
            steps <= LONGEST_DELAY as f64 * (1.0 + 1e-6),
            "time_delay.delay",
            delay_s as f32,
            "must be at most 64 samples long, either way",
        )?;
        let whole = steps as usize;
        let window = effects.iter().flatten().any(needs_motion);
        let window = window.then(|| Window::new(rate, position_step_m));
        let late = window.map_or(0, |window| window.late());
        let last = effects.iter().rposition(Option::is_some);
        Ok(Compensation {
            used: last.map_or(0, |last| last + 1),
            effects,
            rate_hz: T::from_f64(rate),
            period_us: (1e6 / rate) as u64,
            delay: (whole, T::from_f64(steps - whole as f64)),
            position_waits: delay_s > 0.0,
            window,
            delay_s: late as f64 / rate + delay_s.max(0.0),
        })
    }

    /// The effects that are taken off.
    pub fn ids(&self) -> impl Iterator<Item = EffectId> + '_ {
        self.own().map(Effect::id)
    }

    fn own(&self) -> impl Iterator<Item = &Effect<T>> {
        self.effects.iter().take(self.used).flatten()
    }

    /// How long before the newest sample the instant lies that a result belongs to (s).
    pub fn delay_s(&self) -> f64 {
        self.delay_s
    }

    /// Before the first sample.
    pub fn at_rest(&self) -> CompensationState<T> {
        let nil = T::zero();
        CompensationState {
            waiting: [nil; LONGEST_DELAY + 2],
            filter: SavitzkyGolay::default(),
            averages: [Aligned::default(); 3],
            sliding: [nil; MOST_EFFECTS],
            motor_m: nil,
            far_m: nil,
            lingering: Faults::NONE,
            distrust: 0,
            last_time_us: None,
        }
    }

    /// Position of the tip and contact force, [`Compensation::delay_s`] ago. The stamp is that of the
    /// newest sample; a sample that is no number passes as it is, for the estimator to refuse.
    pub fn step(&self, state: &mut CompensationState<T>, read: Sample<T>) -> Sample<T> {
        if !(read.position_m.is_finite() && read.force_n.is_finite()) {
            return read;
        }
        let position_m = self.motor_side_m(read.position_m);
        let interrupted =
            state.interrupted(read.time_us, self.period_us) || read.faults.has(Fault::PositionJump);
        if interrupted {
            state.restart(position_m, &read, self.position_waits);
        }
        let started = state.last_time_us.replace(read.time_us).is_some();
        let faults = self.faults(state, &read, interrupted && started);
        let time_s = T::from_f64(read.time_us as f64 * 1e-6 - self.delay_s);
        let together = self.together(state, position_m, read.force_n);
        let moment = self.moment(state, time_s, together);
        let force_n = moment.load_n - self.load_path_n(state, &moment);
        Sample {
            time_us: read.time_us,
            position_m: self.tip_m(state, moment.motion.position_m, force_n),
            force_n,
            faults,
        }
    }

    /// The motor side (m) behind the encoder's error.
    fn motor_side_m(&self, read_m: T) -> T {
        self.own().fold(read_m, |at_m, effect| match effect {
            Effect::EncoderPeriodicError(own) => own.motor_side(still(at_m)).position_m,
            _ => at_m,
        })
    }

    /// Position and force of one instant: the one that is early waits.
    fn together(&self, state: &mut CompensationState<T>, position_m: T, force_n: T) -> (T, T) {
        let (whole, part) = self.delay;
        if whole == 0 && part == T::zero() {
            return (position_m, force_n);
        }
        let early = if self.position_waits {
            position_m
        } else {
            force_n
        };
        state.waiting.rotate_right(1);
        if let Some(newest) = state.waiting.first_mut() {
            *newest = early;
        }
        let before = |steps: usize| state.waiting.get(steps).copied().unwrap_or(early);
        let waited = before(whole) + part * (before(whole + 1) - before(whole));
        match self.position_waits {
            true => (waited, force_n),
            false => (position_m, waited),
        }
    }

    /// Motion and force through the window, the lag undone: F = y + τẏ.
    fn moment(&self, state: &mut CompensationState<T>, time_s: T, together: (T, T)) -> Moment<T> {
        let (position_m, reading_n) = together;
        let Some(window) = &self.window else {
            let motion = Motion {
                time_s,
                ..still(position_m)
            };
            return Moment {
                motion,
                load_n: reading_n,
                rests: false,
            };
        };
        let sample = Sample {
            position_m,
            force_n: reading_n,
            ..Sample::default()
        };
        let newest = state.filter.update(&window.filter, &sample);
        let [before, oldest, _] = state.averages;
        state.averages = [newest, before, oldest];
        let half_rate = T::from_f64(0.5) * self.rate_hz;
        let rate_nps = (newest.force_n - oldest.force_n) * half_rate;
        let lag_s = self.own().fold(T::zero(), |sum, effect| match effect {
            Effect::ForceLag(own) => sum + own.time_constant_s,
            _ => sum,
        });
        Moment {
            motion: Motion {
                time_s,
                position_m: before.position_m,
                speed_mps: before.speed_mps,
                acceleration_mps2: (newest.speed_mps - oldest.speed_mps) * half_rate,
            },
            load_n: before.force_n + lag_s * rate_nps,
            rests: before.spread_m2 < window.still_m2,
        }
    }

    /// What the load path adds (N), in the mean of the window.
    fn load_path_n(&self, state: &mut CompensationState<T>, moment: &Moment<T>) -> T {
        let mean = &moment.motion;
        let change_m = mean.position_m - state.motor_m;
        state.motor_m = mean.position_m;
        let mut force_n = T::zero();
        for (effect, z) in self.effects.iter().take(self.used).zip(&mut state.sliding) {
            let Some(effect) = effect else { continue };
            force_n += match &self.window {
                // A force that follows the way has its memory at one end of the window.
                Some(window) if !sticks(effect) => window.mean(self.rate_hz, moment, |at| {
                    effect.load_n(&mut { *z }, at, T::zero())
                }),
                _ => effect.load_n(z, mean, change_m),
            };
        }
        force_n
    }

    /// Where the tip is (m): behind the play and the springs.
    fn tip_m(&self, state: &mut CompensationState<T>, motor_m: T, force_n: T) -> T {
        let mut tip_m = motor_m;
        for effect in self.own() {
            if let Effect::Backlash(own) = effect {
                state.far_m = own.follow(state.far_m, motor_m).0;
                tip_m = state.far_m;
            }
        }
        self.own().fold(tip_m, |tip_m, effect| match effect {
            Effect::SeriesCompliance(own) => tip_m - own.deflection_m(force_n),
            _ => tip_m,
        })
    }

    /// What is wrong with the result: all that is wrong with the sample, and what lingers of those
    /// before it. A window that started anew is not to be learned from until it is full.
    fn faults(
        &self,
        state: &mut CompensationState<T>,
        read: &Sample<T>,
        restarted: bool,
    ) -> Faults {
        let mut lingering = Faults::NONE;
        for fault in LINGER.into_iter().filter(|fault| read.faults.has(*fault)) {
            lingering = lingering.with(fault);
        }
        if self.is_at_limit(read.force_n) {
            lingering = lingering.with(Fault::ForceSaturated);
        }
        if restarted {
            lingering = lingering.with(Fault::SampleMissed);
        }
        if lingering != Faults::NONE {
            state.lingering = state.lingering | lingering;
            state.distrust = self.window.map_or(0, |window| 2 * window.late()) + self.delay.0 + 1;
        } else {
            state.distrust = state.distrust.saturating_sub(1);
        }
        if state.distrust == 0 {
            state.lingering = Faults::NONE;
        }
        read.faults | state.lingering
    }

    fn is_at_limit(&self, reading_n: T) -> bool {
        self.own().any(|effect| match effect {
            Effect::ForceSaturation(own) => {
                // A rounded limit is e⁻³ of its softness off where this begins.
                let rounded_n = T::from_f64(3.0) * own.softness_n;
                reading_n >= own.limit_n * T::from_f64(AT_LIMIT) - rounded_n
            }
            _ => false,
        })
    }
}

impl<T: Real> Window<T> {
    fn new(rate_hz: f64, position_step_m: f64) -> Window<T> {
        let wanted = (rate_hz * HALF_WINDOW_S + 0.5) as usize;
        let half_width = wanted.clamp(2, crate::estimate::filter::MAX_HALF_WIDTH) as u8;
        let filter = SavitzkyGolayParams::<T>::new(half_width, rate_hz as f32);
        let spread: f64 = filter
            .sides()
            .iter()
            .zip(1u8..)
            .map(|(side, k)| 2.0 * side.0.to_f64() * f64::from(k) * f64::from(k))
            .sum();
        // A count that is there for half of the window has a variance of a quarter; 10 % for rounding.
        let still_m2 = 0.275 * position_step_m * position_step_m;
        Window {
            filter,
            spread_s2: T::from_f64(spread / (rate_hz * rate_hz)),
            still_m2: T::from_f64(still_m2),
        }
    }

    /// Samples that a result is late: half a window, and one for the central difference.
    fn late(&self) -> usize {
        self.filter.sides().len() + 1
    }

    /// Σ hₖ f(kT) along the parabola whose mean over the window is that of the moment.
    #[inline(never)]
    fn mean(&self, rate_hz: T, moment: &Moment<T>, force: impl Fn(&Motion<T>) -> T) -> T {
        let mean = &moment.motion;
        let half = T::from_f64(0.5);
        let middle_m = mean.position_m - half * mean.acceleration_mps2 * self.spread_s2;
        let at = |offset_s: T| {
            let speed_mps = mean.speed_mps + mean.acceleration_mps2 * offset_s;
            force(&Motion {
                time_s: mean.time_s + offset_s,
                position_m: middle_m + half * (mean.speed_mps + speed_mps) * offset_s,
                speed_mps: if moment.rests { T::zero() } else { speed_mps },
                acceleration_mps2: mean.acceleration_mps2,
            })
        };
        let (mut sum, mut weights) = (T::zero(), T::zero());
        for (side, k) in self.filter.sides().iter().zip(1u8..) {
            let offset_s = T::from_f64(f64::from(k)) / rate_hz;
            sum += side.0 * (at(offset_s) + at(-offset_s));
            weights += side.0 + side.0;
        }
        sum + (T::one() - weights) * at(T::zero())
    }
}

impl<T: Real> CompensationState<T> {
    /// Whether this is the first sample, or one after more than 1.5 periods or a step back in time.
    fn interrupted(&self, time_us: u64, period_us: u64) -> bool {
        self.last_time_us
            .is_none_or(|last| time_us < last || time_us - last > period_us + period_us / 2 + 1)
    }

    /// As if everything had always been where it is.
    fn restart(&mut self, position_m: T, read: &Sample<T>, position_waits: bool) {
        let sample = Sample {
            position_m,
            ..*read
        };
        self.waiting = [if position_waits {
            position_m
        } else {
            read.force_n
        }; LONGEST_DELAY + 2];
        self.filter.restart(&sample);
        let resting = Aligned {
            position_m,
            force_n: read.force_n,
            ..Aligned::default()
        };
        self.averages = [resting; 3];
        (self.motor_m, self.far_m) = (position_m, position_m);
    }
}

/// Whether an effect cannot be taken off without speed, acceleration or the rate of the force.
fn needs_motion<T: Scalar>(effect: &Effect<T>) -> bool {
    match effect {
        Effect::CoulombFriction(own) => own.width_m <= T::zero(),
        Effect::StribeckFriction(_)
        | Effect::ViscousDrag(_)
        | Effect::AsymmetricDrag(_)
        | Effect::ToolInertia(_)
        | Effect::ForceLag(_) => true,
        _ => false,
    }
}

/// Whether the force follows the way and remembers it (Dahl).
fn sticks<T: Scalar>(effect: &Effect<T>) -> bool {
    matches!(effect, Effect::CoulombFriction(own) if own.width_m > T::zero())
}

/// A motor side that rests at `position_m`.
fn still<T: Scalar>(position_m: T) -> Motion<T> {
    Motion {
        time_s: T::zero(),
        position_m,
        speed_mps: T::zero(),
        acceleration_mps2: T::zero(),
    }
}

/// The same effect in another precision.
fn cast<T: Scalar>(effect: &Effect<f64>) -> Effect<T> {
    Effect::new(effect.id(), &effect.row().map(T::from_f64))
}

#[cfg(test)]
mod tests;
