//! What a rig adds to a contact: the catalogue of effects, a file each.
//!
//! An effect is a law and, beside it, a row of facts ([`EffectInfo`]): id, parameters with units and
//! bounds, the stage of the rig's signal chain at which it enters ([`crate::physics::rig`]), and what
//! a fit and a board have to know of it. The same law simulates the effect, gives a fit its gradients
//! (dual numbers) and compensates the effect on the board.
//!
//! The order of the chain:
//!
//! | stage | effects |
//! |---|---|
//! | position reading | encoder_periodic_error |
//! | transmission | backlash, series_compliance |
//! | depth | surface_motion, permanent_set |
//! | elastic force | power_law_stiffness, exponential_stiffening, cyclic_softening, loading_curve, buried_layer, snap_through |
//! | relaxation | stress_relaxation |
//! | contact force | depth_dependent_damping, hysteretic_damping, adhesion |
//! | load path | coulomb_friction, stribeck_friction, viscous_drag, asymmetric_drag, tool_inertia, quadratic_drag, load_friction, drive_backlash in front of cable_stiffness, pre-sliding friction and bouc_wen, gravity_torque, cogging, periodic_disturbance, force_offset, force_drift |
//! | force reading | force_lag, time_delay, force_saturation |
//!
//! # Adding an effect
//!
//! An effect is added in three files. The worked example is `tip_magnet`, an invented effect that the
//! feature `example-effect` turns on for one test, `tests/example_effect.rs`. The test hides it in a
//! simulated log; `palpate gap` names it alone with its true numbers; the model file, the compensation
//! and the settings of a board have it as well.
//!
//! 1. `effect/tip_magnet.rs`: the law, and the row of facts beside it.
//!    ```text
//!    effect! {
//!        /// A magnet below the encoder's zero, which pulls at the tip as it passes.
//!        TipMagnet = "tip_magnet" {
//!            /// F (N), at x = 0
//!            force_n = "force", Newton, Positive, Size, FitRange::up_to(Times(1.0, Force));
//!            /// d (m): where half of the pull is left
//!            reach_m = "reach", Metre, Positive, Shape, Logarithmic(Times(0.02, Travel), Times(0.5, Travel));
//!        }
//!        stage: LoadPath, sign: OneWay, proportional: true, …
//!        example: [0.3, 5e-4, 0.0, 0.0, 0.0], starts: &[Starts::at(&[At(Times(1.0, SmallForce)), Each(&[…])])],
//!        law: "−F/(1 + (x/d)²)", …
//!    }
//!    ```
//!    Bounds, ranges, starts, sign, relatives, optional forms and physical limits are facts of the row; a
//!    row that lacks one does not compile. The file `row.rs` says what each fact means.
//! 2. This file: `mod tip_magnet`, a line `tip_magnet::TipMagnet = 50` of the catalogue with a number that
//!    never changes, and the place in the signal chain: `load_n` for the load path, the rig
//!    ([`crate::physics::rig`]) for the other stages.
//! 3. `tests/src/hidden/rig/draw/mod.rs`: the effect in the generator of hidden rigs, by its own formula
//!    (`Effect::Load`) and not by that of the row, and its id in the generator's catalogue. A memory of
//!    its own is a field of the generator's `Drive`.
//!
//! Simulation, fit, report, model file, compensation and settings need no change: they read the row.

mod adhesion;
mod asymmetric_drag;
mod backlash;
mod bouc_wen;
mod buried_layer;
mod cable_stiffness;
mod catalogue;
mod cogging;
mod coulomb_friction;
mod cyclic_softening;
mod depth_dependent_damping;
mod drive_backlash;
mod encoder_periodic_error;
mod exponential_stiffening;
mod force_drift;
mod force_lag;
mod force_offset;
mod force_saturation;
mod gravity_torque;
mod hysteretic_damping;
mod load_friction;
mod load_memory;
mod loading_curve;
mod motion;
mod periodic_disturbance;
mod permanent_set;
mod power_law_stiffness;
mod quadratic_drag;
mod row;
mod series_compliance;
mod shapes;
mod snap_through;
mod starts;
mod stress_relaxation;
mod stribeck_friction;
mod surface_motion;
mod time_delay;
#[cfg(feature = "example-effect")]
mod tip_magnet;
mod tool_inertia;
mod viscous_drag;

pub use super::parameter::{Bounds, ParameterInfo};
use crate::maths::scalar::Scalar;
use catalogue::catalogue;
pub(crate) use load_memory::{LoadPathMemory, Rubbing, beyond_play};
pub use motion::Motion;
pub use row::{
    ChainStage, EffectInfo, Family, Form, Laws, MOST_PARAMETERS, ParameterFit, Repeats, Role, Sign,
};
pub use starts::{Series, StartValues, Starts};

catalogue! {
    stress_relaxation::StressRelaxation = 1,
    power_law_stiffness::PowerLawStiffness = 2,
    depth_dependent_damping::DepthDependentDamping = 3,
    exponential_stiffening::ExponentialStiffening = 4,
    adhesion::Adhesion = 5,
    permanent_set::PermanentSet = 6,
    buried_layer::BuriedLayer = 7,
    surface_motion::SurfaceMotion = 8,
    hysteretic_damping::HystereticDamping = 9,
    cyclic_softening::CyclicSoftening = 10,
    coulomb_friction::CoulombFriction = 11,
    stribeck_friction::StribeckFriction = 12,
    viscous_drag::ViscousDrag = 13,
    asymmetric_drag::AsymmetricDrag = 14,
    tool_inertia::ToolInertia = 15,
    force_offset::ForceOffset = 16,
    force_drift::ForceDrift = 17,
    cable_stiffness::CableStiffness = 18,
    cogging::Cogging = 19,
    periodic_disturbance::PeriodicDisturbance = 20,
    series_compliance::SeriesCompliance = 21,
    backlash::Backlash = 22,
    force_lag::ForceLag = 23,
    time_delay::TimeDelay = 24,
    force_saturation::ForceSaturation = 25,
    encoder_periodic_error::EncoderPeriodicError = 26,
    drive_backlash::DriveBacklash = 27,
    bouc_wen::BoucWen = 28,
    load_friction::LoadFriction = 29,
    quadratic_drag::QuadraticDrag = 30,
    gravity_torque::GravityTorque = 31,
    loading_curve::LoadingCurve = 32,
    snap_through::SnapThrough = 33,
    // The last number that a board has settings for: it stays out of the way of real effects.
    #[cfg(feature = "example-effect")]
    tip_magnet::TipMagnet = 50,
}

impl EffectId {
    /// The id in files.
    pub const fn name(self) -> &'static str {
        self.info().name
    }

    /// What an effect needs beside it to change anything in free air: a play changes what restores, a
    /// friction that grows with the load rubs under one.
    pub const fn needs(self) -> Option<EffectId> {
        match self {
            EffectId::DriveBacklash => Some(EffectId::BoucWen),
            EffectId::LoadFriction => Some(EffectId::CableStiffness),
            _ => None,
        }
    }

    /// The effect with an id of files.
    pub fn from_name(name: &str) -> Option<EffectId> {
        EffectId::ALL.iter().copied().find(|id| id.name() == name)
    }
}

impl<S: Scalar> Effect<S> {
    /// What the effect adds to the force between contact and load cell (N) after the motor side has
    /// gone `change_m` since the last sample, with a play of `play_m` in front of what restores; 0 where
    /// the effect enters elsewhere. A friction that grows with the load comes after all others
    /// (`physics::load_path`).
    pub(crate) fn load_n(
        &self,
        memory: &mut LoadPathMemory<S>,
        motor: &Motion<S>,
        change_m: S,
        play_m: S,
    ) -> S {
        let rubbing = Rubbing {
            speed_mps: motor.speed_mps,
            change_m,
            play_m,
        };
        match self {
            Effect::CoulombFriction(effect) => effect.force_n(memory, &rubbing),
            Effect::StribeckFriction(effect) => effect.force_n(memory, &rubbing),
            Effect::ViscousDrag(effect) => effect.force_n(motor.speed_mps),
            Effect::AsymmetricDrag(effect) => effect.force_n(motor.speed_mps),
            Effect::QuadraticDrag(effect) => effect.force_n(motor.speed_mps),
            Effect::ToolInertia(effect) => effect.force_n(motor.acceleration_mps2),
            Effect::CableStiffness(effect) => effect.force_n(beyond_play(motor.position_m, play_m)),
            Effect::BoucWen(effect) => effect.force_n(memory, change_m, play_m),
            Effect::GravityTorque(effect) => effect.torque_nm(motor.position_m),
            Effect::Cogging(effect) => effect.force_n(motor.position_m),
            Effect::PeriodicDisturbance(effect) => effect.force_n(motor.time_s),
            Effect::ForceOffset(effect) => effect.force_n(),
            Effect::ForceDrift(effect) => effect.force_n(motor.time_s),
            #[cfg(feature = "example-effect")]
            Effect::TipMagnet(effect) => effect.force_n(motor.position_m),
            _ => S::zero(),
        }
    }

    /// Whether the force depends on the way since the last reversal.
    pub(crate) fn depends_on_travel(&self) -> bool {
        match self {
            Effect::CoulombFriction(friction) => friction.width_m > S::zero(),
            Effect::StribeckFriction(friction) => friction.width_m > S::zero(),
            Effect::LoadFriction(friction) => friction.width_m > S::zero(),
            Effect::BoucWen(_) => true,
            _ => false,
        }
    }

    /// Whether these values can be compensated only with speed, acceleration or the rate of the force: those whose
    /// force depends on the way alone need none.
    pub(crate) fn needs_derivative(&self) -> bool {
        let by_way_alone = match self {
            Effect::StribeckFriction(_) => false,
            Effect::LoadFriction(friction) => friction.excess == S::zero(),
            _ => true,
        };
        self.id().needs_derivative() && !(by_way_alone && self.depends_on_travel())
    }
}

#[cfg(test)]
mod tests;
