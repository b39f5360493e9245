//! The signal chain of the simulated rig: the core's, with the sensors' ends of it that need the truth.
//!
//! The core's [`Rig`] goes from an encoder's reading to a load cell's. A simulation knows the motor
//! side itself, so the encoder's error is added to the reading instead of removed from it; and a
//! delay shifts a channel that has a past. The motor feels the contact force; what the load path
//! adds (friction, drag, inertia, cable, …) reaches the load cell only: it lies within the control
//! loop of a drive, which a position-controlled motor overcomes, and what matters to an estimator is
//! what the cell sees of it.

use estimator_core::physics::effect::{ChainStage, Effect, EncoderPeriodicError, Motion};
use estimator_core::physics::rig::{self, Reading, Rig, RigState};

use super::{contact::Contact, delay::Delay, motor::MotorState};

/// A motor in a hold keeps a speed of 1e-16 m/s from rounding, and friction must not take its sign:
/// what slides only has no force at rest.
const ROUNDING_MPS: f64 = 1e-12;

/// The effects of a rig.
pub type Effects = rig::Effects<f64>;

/// A material behind the effects of a rig.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Chain {
    rig: Rig<f64>,
    /// How late the position is read (s). What is periodic in time has its phase by the clock of the
    /// position's readings, as a fit of the log sees it.
    late_s: f64,
}

impl Chain {
    pub(super) fn new(contact: &Contact, effects: &Effects) -> Chain {
        let rig = Rig {
            environment: contact.environment(),
            effects: effects.filtered(|own| own.id().info().stage != ChainStage::PositionReading),
        };
        Chain {
            late_s: (-rig.delay_s().unwrap_or(0.0)).max(0.0),
            rig,
        }
    }

    pub(super) fn at_rest(&self) -> RigState<f64> {
        self.rig.at_rest()
    }

    /// Everything one period after `state`.
    pub(super) fn step(
        &self,
        state: &mut RigState<f64>,
        moved: Motion<f64>,
        period_s: f64,
    ) -> Reading<f64> {
        self.rig.step(state, self.timed(moved), period_s)
    }

    /// Force on the probe (N) one period after `state`, which stays as it is.
    pub(super) fn trial_n(&self, state: &RigState<f64>, moved: Motion<f64>, period_s: f64) -> f64 {
        self.rig.trial(state, &self.timed(moved), period_s).force_n
    }

    /// Whether the load cell feels accelerations.
    pub(super) fn has_inertia(&self) -> bool {
        let inertia = |own: &Effect<f64>| matches!(own, Effect::ToolInertia(_));
        self.rig.effects().any(inertia)
    }

    /// By the clock of the position's readings, and at rest in a hold.
    fn timed(&self, moved: Motion<f64>) -> Motion<f64> {
        let moves = moved.speed_mps.abs() > ROUNDING_MPS;
        Motion {
            time_s: moved.time_s + self.late_s,
            speed_mps: if moves { moved.speed_mps } else { 0.0 },
            ..moved
        }
    }

    /// Force on the probe (N) of a material that was at rest until now.
    pub(super) fn pressed_n(&self, position_m: f64, speed_mps: f64) -> f64 {
        // A play or a spring has no speed at its first step: the material alone is the stiffer one.
        let stiff = |own: &Effect<f64>| own.id().info().stage != ChainStage::Transmission;
        let rig = Rig {
            effects: self.rig.effects.filtered(stiff),
            ..self.rig
        };
        let moved = motion(
            0.0,
            MotorState {
                position_m,
                velocity_mps: speed_mps,
            },
            0.0,
        );
        rig.step(&mut rig.at_rest(), moved, 0.0).touch.force_n
    }
}

pub(super) fn motion(time_s: f64, state: MotorState, acceleration_mps2: f64) -> Motion<f64> {
    Motion {
        time_s,
        position_m: state.position_m,
        speed_mps: state.velocity_mps,
        acceleration_mps2,
    }
}

/// How far (m) the motor must go below the surface until the material, at rest until then, pushes
/// with `force_n` (N); `None` in free air or if it never does within a metre.
pub fn depth_at_m(contact: &Contact, effects: &Effects, force_n: f64) -> Option<f64> {
    let chain = Chain::new(contact, effects);
    let pushes = |depth_m: f64| chain.pressed_n(contact.surface_m + depth_m, 0.0) >= force_n;
    let (mut low, mut high) = (0.0, 1.0);
    if !pushes(high) {
        return None;
    }
    // 60 halvings of a metre: to the last bit of any depth above a picometre.
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if pushes(middle) {
            high = middle
        } else {
            low = middle
        }
    }
    let given_way_m = chain.rig.effects().map(|own| match own {
        Effect::SeriesCompliance(own) => own.deflection_m(force_n),
        Effect::Backlash(own) => 0.5 * own.width_m,
        _ => 0.0,
    });
    Some(high + given_way_m.sum::<f64>())
}

/// What the sensors' channels add before noise and steps: the encoder's error and delays.
pub(super) struct Channels {
    errors: Vec<EncoderPeriodicError<f64>>,
    position: Delay,
    force: Delay,
}

impl Channels {
    /// A late force is delayed, an early one has a late position: F(t − T_d) against x(t) either way.
    pub(super) fn new(effects: &Effects, step_s: f64) -> Channels {
        let (mut errors, mut delay_s) = (Vec::new(), 0.0);
        for effect in effects.iter() {
            match effect {
                Effect::EncoderPeriodicError(own) => errors.push(*own),
                Effect::TimeDelay(own) => delay_s += own.delay_s,
                _ => {}
            }
        }
        Channels {
            errors,
            position: Delay::new(-delay_s / step_s),
            force: Delay::new(delay_s / step_s),
        }
    }

    /// Position (m) and force (N) as they arrive at the sensors after one more sub-step.
    pub(super) fn push(&mut self, position_m: f64, force_n: f64) -> (f64, f64) {
        let position_m = self.position.push(position_m);
        let read_m = self.errors.iter().fold(position_m, |read_m, own| {
            read_m + (own.reading_m(position_m) - position_m)
        });
        (read_m, self.force.push(force_n))
    }
}

#[cfg(test)]
mod tests {
    use super::super::GEL;
    use super::*;
    use estimator_core::physics::effect::EffectId;

    #[test]
    fn the_depth_of_a_force_is_where_the_law_has_it() {
        // (F/Kδ₀)^(1/n)·δ₀
        let exact = (10.0_f64 / 1.35).powf(1.0 / 1.35) * 1e-3;
        let depth = depth_at_m(&GEL.at(2e-3), &Effects::none(), 10.0).unwrap();
        // The surface of 2 mm is added and taken away again.
        assert!((depth - exact).abs() < 1e-17, "{depth}");
        assert!(depth_at_m(&Contact::FREE, &Effects::none(), 1.0).is_none());
        // A spring of 10 N/mm behind it gives way by a millimetre.
        let spring = Effect::new(EffectId::SeriesCompliance, &[1e4, 0.0, 0.0, 0.0, 0.0]);
        let spring = Effects::from_iter([spring]);
        let behind = depth_at_m(&GEL.at(2e-3), &spring, 10.0).unwrap();
        assert!((behind - depth - 1e-3).abs() < 1e-15, "{behind}");
    }
}
