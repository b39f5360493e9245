//! The row of facts that every effect has beside its law.
//!
//! The simulator, the fits and the board read an effect's row; none of them lists effects by name.
//! The macro `effect` defines an effect with its row, and a row that lacks a fact does not compile.

use super::starts::Starts;
use crate::physics::{fit_range::FitRange, fit_range::Scaled, parameter::ParameterInfo};

/// The largest number of parameters that an effect has.
pub const MOST_PARAMETERS: usize = 5;

/// The stage of the rig's signal chain at which an effect enters, in the order of the chain.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ChainStage {
    /// Between the motor-side position and its reading.
    PositionReading,
    /// Between the motor and the tip of the probe.
    Transmission,
    /// Between the tip and the penetration.
    Depth,
    /// The elastic force.
    Elastic,
    /// The relaxation of the elastic force.
    Relaxation,
    /// The contact force besides the elastic one.
    Contact,
    /// Between the contact and the load cell.
    LoadPath,
    /// Between the load cell's force and its reading.
    ForceReading,
}

impl ChainStage {
    /// The stage in words.
    pub const fn name(self) -> &'static str {
        match self {
            ChainStage::PositionReading => "position reading",
            ChainStage::Transmission => "transmission",
            ChainStage::Depth => "depth",
            ChainStage::Elastic => "elastic force",
            ChainStage::Relaxation => "relaxation",
            ChainStage::Contact => "contact force",
            ChainStage::LoadPath => "load path",
            ChainStage::ForceReading => "force reading",
        }
    }

    /// Whether an effect at this stage belongs to the rig and is compensated; the others belong to
    /// the material.
    pub const fn belongs_to_rig(self) -> bool {
        matches!(
            self,
            ChainStage::PositionReading
                | ChainStage::Transmission
                | ChainStage::LoadPath
                | ChainStage::ForceReading
        )
    }

    /// Whether an effect at this stage changes the force in free air, too.
    pub const fn acts_in_free_air(self) -> bool {
        matches!(self, ChainStage::LoadPath | ChainStage::ForceReading)
    }
}

/// Whether the parameters of an effect can turn its force round.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sign {
    /// The force has the sign that the law gives it; a fit that wants the opposite one has found
    /// another effect. Waves that displace instead of push count here: a fit starts at their phase.
    OneWay,
    /// A negative coefficient or another phase gives the opposite force.
    Either,
}

/// Whether an effect is a wave.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Repeats {
    /// The effect is no wave.
    Never,
    /// The effect is a wave in time; its parameters are amplitude, frequency (Hz) and phase.
    InTime,
    /// The effect is a wave along the way; its parameters are amplitude, pitch (m) and phase at the
    /// encoder's zero.
    AlongTheWay,
    /// The effect has one period a turn, and only a machine that turns has it.
    EveryTurn,
}

impl Repeats {
    /// Whether a fit finds the period in a spectrum, and starts the effect from there.
    pub const fn has_spectrum(self) -> bool {
        matches!(self, Repeats::InTime | Repeats::AlongTheWay)
    }
}

/// Effects that are mistaken for each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// The effect has no relatives.
    Alone,
    /// A dry friction is a special case of another one.
    DryFriction,
    /// A drag is the other one in one direction.
    Drag,
    /// A constant error of the load cell's zero is a special case of one that wanders.
    ForceZero,
    /// The effects only make the force late; in slow motion they differ by less than a rig errs.
    Lateness,
    /// Each makes a loop whose width is a share of the contact's force. Without a cable they differ by that share
    /// of the contact's damping, which is often less than a rig errs.
    LoopOfLoad,
}

impl Family {
    /// Whether one member is a special case of another: no ambiguity, since the simpler one wins
    /// where it is adequate.
    pub const fn is_nested(self) -> bool {
        matches!(self, Family::DryFriction | Family::Drag | Family::ForceZero)
    }
}

/// The contact laws on which an effect means anything.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Laws {
    /// Every law.
    AnyLaw,
    /// Laws whose elastic force is proportional to the depth.
    LinearElasticity,
    /// The law whose damping is the same at every depth: Kelvin and Voigt's.
    LinearDamping,
    /// Laws whose elastic force is not exponential in the depth.
    NotExponential,
}

impl Laws {
    /// Whether the effect bends what is linear, so that Kelvin and Voigt's law shows it.
    pub const fn are_linear(self) -> bool {
        matches!(self, Laws::LinearElasticity | Laws::LinearDamping)
    }
}

/// What a fit does with an optional form of an effect, whose parameter is 0 in the plain form.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Form {
    /// A start of the fit has the form or has it not, and the fit keeps to that.
    OfTheStart,
    /// Starts have the form, and the fit drops it where it is not significant.
    Dropped,
    /// The fit takes the form on where it is significant, and drops it where it is not.
    TakenOn {
        /// The value of the parameter at which it starts.
        start: Scaled,
        /// The factor on the effect's first parameter when the form is taken on: the form's share
        /// of what the plain effect explained is the rest.
        first: f64,
    },
    /// The parameter comes and goes with the form before it, which is tried from each of these values.
    Beside(&'static [Scaled]),
}

/// What a parameter is to the force of its effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Role {
    /// The force of a proportional effect is proportional to this parameter.
    Size,
    /// A size that starts at no more than this number.
    SizeUpTo(f64),
    /// The parameter shapes the force.
    Shape,
    /// The parameter belongs to an optional form; the text says what the effect is while it is 0.
    Form(&'static str, Form),
    /// A number above 0 chooses another law, whose force is not proportional to the sizes and which
    /// takes on no optional form; the text says what the effect is while it is 0.
    Switch(&'static str),
}

/// What a fit has to know of a parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ParameterFit {
    /// What the parameter is to the force.
    pub role: Role,
    /// The range in which a fit looks for it.
    pub range: FitRange,
}

/// The facts of an effect.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct EffectInfo {
    /// The id in `model.toml` and `gap.json`.
    pub name: &'static str,
    /// The parameters, in the order of the effect's row of values.
    pub parameters: &'static [ParameterInfo],
    /// What a fit has to know of each parameter, in the same order.
    pub fits: &'static [ParameterFit],
    /// The stage of the signal chain at which the effect enters.
    pub stage: ChainStage,
    /// Whether its parameters can turn its force round.
    pub sign: Sign,
    /// Whether its force is proportional to its sizes.
    pub proportional: bool,
    /// Whether a rig can have it several times: a spectrum is made of several.
    pub several: bool,
    /// Whether it is a wave.
    pub repeats: Repeats,
    /// Whether it depends on the time since the start of a log, of which a board that was switched
    /// on knows nothing.
    pub timed: bool,
    /// The contact laws on which it means anything.
    pub laws: Laws,
    /// Whether its plain form can be compensated only with speed, acceleration or the rate of the force.
    pub needs_derivative: bool,
    /// The effects that it is mistaken for.
    pub family: Family,
    /// The simpler effect of its family that it becomes where the difference is not significant.
    pub simpler: Option<&'static str>,
    /// Whether values within their ranges mean together what the parameters' names say.
    pub is_physical: fn(&[f64; MOST_PARAMETERS]) -> bool,
    /// Where a fit starts it; a wave starts from the spectrum of the residuals instead.
    pub starts: &'static [Starts],
    /// Parameters of a size that a palpation rig can have.
    pub example: [f64; MOST_PARAMETERS],
    /// The law, in one line.
    pub law: &'static str,
    /// What the effect shows in a log.
    pub signature: &'static str,
    /// The motion that shows it.
    pub motion: &'static str,
}

impl EffectInfo {
    /// Whether these values choose another law than the plain one.
    pub fn is_switched(&self, row: &[f64; MOST_PARAMETERS]) -> bool {
        let mut each = self.fits.iter().zip(row);
        each.any(|(fit, value)| matches!(fit.role, Role::Switch(_)) && *value > 0.0)
    }

    /// Whether the force with these values is proportional to the sizes among them.
    pub fn is_proportional(&self, row: &[f64; MOST_PARAMETERS]) -> bool {
        self.proportional && !self.is_switched(row)
    }
}

/// The names that a row is written with.
pub(super) mod words {
    pub(in super::super) use super::ChainStage::*;
    pub(in super::super) use super::Family::*;
    pub(in super::super) use super::Form::*;
    pub(in super::super) use super::Laws::*;
    pub(in super::super) use super::Repeats::*;
    pub(in super::super) use super::Role::*;
    pub(in super::super) use super::Sign::*;
    pub(in super::super) use crate::physics::effect::starts::{Series, StartValues::*, Starts};
    pub(in super::super) use crate::physics::fit_range::FitRange::{self, *};
    pub(in super::super) use crate::physics::fit_range::Scale::*;
    pub(in super::super) use crate::physics::fit_range::Scaled::*;
}

/// Defines an effect: its struct, its row of facts, and the conversion from and to a row of values.
///
/// A parameter is `field = key, unit, bounds [= default], role, range`.
macro_rules! effect {
    (
        $(#[$doc:meta])*
        $Effect:ident = $name:literal {
            $(
                $(#[$field_doc:meta])*
                $field:ident = $key:literal, $Unit:ident, $Bounds:ident $(= $default:literal)?, $role:expr, $range:expr;
            )+
        }
        $($fact:ident: $value:expr,)+
    ) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct $Effect<S> {
            $($(#[$field_doc])* pub $field: S,)+
        }

        impl<S: Copy> $Effect<S> {
            /// The facts of the effect.
            #[allow(unused_imports, reason = "no effect has facts of every kind")]
            pub const INFO: $crate::physics::effect::row::EffectInfo = {
                use $crate::physics::effect::row::words::*;
                $crate::physics::effect::row::EffectInfo {
                    name: $name,
                    parameters: &[$($crate::physics::parameter::ParameterInfo {
                        name: $key,
                        unit: $crate::maths::units::Unit::$Unit,
                        bounds: $crate::physics::parameter::Bounds::$Bounds,
                        default: $crate::physics::effect::row::effect!(@default $($default)?),
                    },)+],
                    fits: &[$($crate::physics::effect::row::ParameterFit {
                        role: $role,
                        range: $range,
                    },)+],
                    $($fact: $value,)+
                }
            };
        }

        impl<S: $crate::maths::scalar::Scalar> $Effect<S> {
            /// The effect from its values in the order of the row.
            pub(super) fn from_row(row: &[S; $crate::physics::effect::row::MOST_PARAMETERS]) -> Self {
                let mut values = row.iter().copied();
                $(let $field = values.next().unwrap_or(S::zero());)+
                Self { $($field),+ }
            }

            /// Its values in the order of the row.
            pub(super) fn row(&self) -> [S; $crate::physics::effect::row::MOST_PARAMETERS] {
                let mut row = [S::zero(); $crate::physics::effect::row::MOST_PARAMETERS];
                for (slot, value) in row.iter_mut().zip([$(self.$field),+]) {
                    *slot = value;
                }
                row
            }
        }
    };
    (@default) => { None };
    (@default $default:literal) => { Some($default) };
}
pub(super) use effect;
