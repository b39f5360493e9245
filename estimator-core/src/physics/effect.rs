//! What a rig adds to a contact: the catalogue of effects, a file each.
//!
//! An effect has an id, parameters with units and bounds, and the place in the rig's signal chain
//! where it enters ([`crate::physics::rig`]). The same code simulates it, gives a fit its gradients (dual
//! numbers) and compensates it on the board.
//!
//! The order of the chain:
//!
//! | place | effects |
//! |---|---|
//! | position reading | encoder_periodic_error |
//! | transmission | backlash, series_compliance |
//! | depth | surface_motion, permanent_set |
//! | elastic force | power_law_stiffness, exponential_stiffening, cyclic_softening, buried_layer |
//! | relaxation | stress_relaxation |
//! | contact force | depth_dependent_damping, hysteretic_damping, adhesion |
//! | load path | coulomb_friction, stribeck_friction, viscous_drag, asymmetric_drag, tool_inertia, cable_stiffness, cogging, periodic_disturbance, force_offset, force_drift |
//! | force reading | force_lag, time_delay, force_saturation |

mod adhesion;
mod asymmetric_drag;
mod backlash;
mod buried_layer;
mod cable_stiffness;
mod catalogue;
mod cogging;
mod coulomb_friction;
mod cyclic_softening;
mod depth_dependent_damping;
mod encoder_periodic_error;
mod exponential_stiffening;
mod force_drift;
mod force_lag;
mod force_offset;
mod force_saturation;
mod hysteretic_damping;
mod periodic_disturbance;
mod permanent_set;
mod power_law_stiffness;
mod presliding;
mod series_compliance;
mod stress_relaxation;
mod stribeck_friction;
mod surface_motion;
mod time_delay;
mod tool_inertia;
mod viscous_drag;

pub use adhesion::Adhesion;
pub use asymmetric_drag::AsymmetricDrag;
pub use backlash::Backlash;
pub use buried_layer::BuriedLayer;
pub use cable_stiffness::CableStiffness;
pub use catalogue::{Effect, EffectId};
pub use cogging::Cogging;
pub use coulomb_friction::CoulombFriction;
pub use cyclic_softening::CyclicSoftening;
pub use depth_dependent_damping::DepthDependentDamping;
pub use encoder_periodic_error::EncoderPeriodicError;
pub use exponential_stiffening::ExponentialStiffening;
pub use force_drift::ForceDrift;
pub use force_lag::ForceLag;
pub use force_offset::ForceOffset;
pub use force_saturation::ForceSaturation;
pub use hysteretic_damping::HystereticDamping;
pub use periodic_disturbance::PeriodicDisturbance;
pub use permanent_set::PermanentSet;
pub use power_law_stiffness::PowerLawStiffness;
pub use series_compliance::SeriesCompliance;
pub use stress_relaxation::StressRelaxation;
pub use stribeck_friction::StribeckFriction;
pub use surface_motion::SurfaceMotion;
pub use time_delay::TimeDelay;
pub use tool_inertia::ToolInertia;
pub use viscous_drag::ViscousDrag;

pub use super::parameter::{Bounds, ParameterInfo};
use crate::maths::scalar::Scalar;

/// Most parameters that an effect has.
pub const MOST_PARAMETERS: usize = 4;

/// Where in the signal chain an effect enters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Place {
    /// Between the motor-side position and its reading.
    PositionReading,
    /// Between the motor and the tip of the probe.
    Transmission,
    /// Between the tip and the penetration.
    Depth,
    /// The elastic force.
    Elastic,
    /// Its relaxation.
    Relaxation,
    /// The contact force besides the elastic one.
    Contact,
    /// Between the contact and the load cell.
    LoadPath,
    /// Between the load cell's force and its reading.
    ForceReading,
}

impl Place {
    /// In words.
    pub const fn name(self) -> &'static str {
        match self {
            Place::PositionReading => "position reading",
            Place::Transmission => "transmission",
            Place::Depth => "depth",
            Place::Elastic => "elastic force",
            Place::Relaxation => "relaxation",
            Place::Contact => "contact force",
            Place::LoadPath => "load path",
            Place::ForceReading => "force reading",
        }
    }
}

/// What the catalogue says of an effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EffectInfo {
    /// The id.
    pub name: &'static str,
    /// Its parameters, in the order of [`Effect::new`].
    pub parameters: &'static [ParameterInfo],
    /// Where it enters.
    pub place: Place,
    /// The law, in one line.
    pub law: &'static str,
    /// What gives it away.
    pub signature: &'static str,
    /// The motion that shows it.
    pub motion: &'static str,
}

/// What the motor side does at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion<S> {
    /// Time since the start of the log (s).
    pub time_s: S,
    /// x (m)
    pub position_m: S,
    /// v (m/s)
    pub speed_mps: S,
    /// a (m/s²)
    pub acceleration_mps2: S,
}

/// A sine and the rate of it: A sin(ωu + φ), Aω cos(ωu + φ).
fn wave<S: Scalar>(amplitude: S, angular: S, phase: S, at: S) -> (S, S) {
    let (sin, cos) = (angular * at + phase).sin_cos();
    (amplitude * sin, amplitude * angular * cos)
}

/// max(x, 0), its corner rounded over a width w: w ln(1 + e^{x/w}).
fn ramp<S: Scalar>(x: S, width: S) -> S {
    if width <= S::zero() {
        return x.max_of(S::zero());
    }
    let far = x / width;
    // Beyond this the rounding is 10⁻¹³ of its width.
    if far > S::from_f64(30.0) {
        return x;
    }
    width * (S::one() + far.exp()).ln()
}

/// 2π/`period`.
fn angular_of<S: Scalar>(period: S) -> S {
    S::from_f64(core::f64::consts::TAU) / period
}

/// Direction of a speed: the sign where `transition_mps` is 0, else tanh(v/v_t).
fn direction<S: Scalar>(speed_mps: S, transition_mps: S) -> S {
    if transition_mps > S::zero() {
        return (speed_mps / transition_mps).tanh();
    }
    if speed_mps > S::zero() {
        S::one()
    } else if speed_mps < S::zero() {
        -S::one()
    } else {
        S::zero()
    }
}

/// Defines an effect: its struct, what the catalogue says of it, and its making from a row of values.
macro_rules! effect {
    (
        $(#[$doc:meta])*
        $Effect:ident = $name:literal, $Place:ident {
            $($(#[$field_doc:meta])* $field:ident = $key:literal, $Unit:ident, $Bounds:ident $(, $usual:literal)?;)+
        }
        law: $law:literal,
        signature: $signature:literal,
        motion: $motion:literal,
    ) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct $Effect<S> {
            $($(#[$field_doc])* pub $field: S,)+
        }

        impl<S: Copy> $Effect<S> {
            /// What the catalogue says of it.
            pub const INFO: $crate::physics::effect::EffectInfo = $crate::physics::effect::EffectInfo {
                name: $name,
                parameters: &[$($crate::physics::parameter::ParameterInfo {
                    name: $key,
                    unit: $crate::maths::units::Unit::$Unit,
                    bounds: $crate::physics::parameter::Bounds::$Bounds,
                    default: $crate::physics::effect::effect!(@usual $($usual)?),
                },)+],
                place: $crate::physics::effect::Place::$Place,
                law: $law,
                signature: $signature,
                motion: $motion,
            };
        }

        impl<S: $crate::maths::scalar::Scalar> $Effect<S> {
            /// From its parameters in the order of the catalogue.
            pub(super) fn from_row(row: &[S; $crate::physics::effect::MOST_PARAMETERS]) -> Self {
                let mut values = row.iter().copied();
                $(let $field = values.next().unwrap_or(S::zero());)+
                Self { $($field),+ }
            }

            /// Its parameters in the order of the catalogue.
            pub(super) fn row(&self) -> [S; $crate::physics::effect::MOST_PARAMETERS] {
                let mut row = [S::zero(); $crate::physics::effect::MOST_PARAMETERS];
                for (own, value) in row.iter_mut().zip([$(self.$field),+]) {
                    *own = value;
                }
                row
            }
        }
    };
    (@usual) => { None };
    (@usual $usual:literal) => { Some($usual) };
}
use effect;

#[cfg(test)]
mod tests;
