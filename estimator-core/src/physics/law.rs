//! Forward contact laws: penetration and its rate in, force out. One file a law.
//!
//! All laws report their stiffness and damping at a reference depth δ₀ (1 mm unless configured), so
//! that the numbers of different laws can be compared and keep their units whatever the exponent:
//! see "Units" in each.

mod hunt_crossley;
mod kelvin_voigt;
mod quasi_linear;
mod relaxation;
mod zener;

pub use hunt_crossley::HuntCrossley;
pub use kelvin_voigt::KelvinVoigt;
pub use quasi_linear::{Elastic, QuasiLinear, QuasiLinearState};
pub use relaxation::RelaxationMode;
pub(crate) use relaxation::high_passed;
pub use zener::{Zener, ZenerState};

use crate::maths::scalar::Scalar;
use crate::maths::units::Unit;

/// A contact law without memory.
pub trait ContactLaw<S: Scalar> {
    /// Force on the probe (N) at penetration `depth_m` (m), which changes by `speed_mps` (m/s).
    /// Zero outside the material; not saturated, so a law that pulls while unloading does.
    fn force_n(&self, depth_m: S, speed_mps: S) -> S;
}

/// A contact law that may remember: the force depends on how the depth came about. Every
/// [`ContactLaw`] is one that does not, so that a rig or a fit can treat all laws alike.
pub trait RelaxingLaw<S: Scalar> {
    /// What it remembers from sample to sample.
    type State: Copy + core::fmt::Debug;

    /// Never touched, or long ago.
    fn at_rest(&self) -> Self::State;

    /// Force on the probe (N) one period (s) after the last step, at penetration `depth_m` (m),
    /// which changes by `speed_mps` (m/s). To be called for every sample, in free air as well: the
    /// state runs on, decaying. Zero outside the material; not saturated.
    fn step(&self, state: &mut Self::State, depth_m: S, speed_mps: S, period_s: S) -> S;

    /// Force (N) at once: the depth was just reached, from rest, and nothing moves or has relaxed.
    fn elastic_n(&self, depth_m: S) -> S;
}

/// A blanket implementation would keep every other law out: a crate downstream might make it a
/// [`ContactLaw`].
macro_rules! remembers_nothing {
    ($($law:ident),*) => {$(
        impl<S: Scalar> RelaxingLaw<S> for $law<S> {
            type State = ();

            fn at_rest(&self) {}

            fn step(&self, _state: &mut (), depth_m: S, speed_mps: S, _period_s: S) -> S {
                self.force_n(depth_m, speed_mps)
            }

            fn elastic_n(&self, depth_m: S) -> S {
                self.force_n(depth_m, S::zero())
            }
        }
    )*};
}

remembers_nothing!(KelvinVoigt, HuntCrossley);

/// What a surface that does not stick can do: push. A simulated rig applies it, estimators do not.
pub fn unilateral<S: Scalar>(force_n: S) -> S {
    S::zero().max_of(force_n)
}

/// Name and unit of one parameter of a law.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ParameterInfo {
    /// The key in `estimate.json` and in a model file.
    pub name: &'static str,
    /// Its unit.
    pub unit: Unit,
}

/// Which law; the discriminants are stable and stand in frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum LawKind {
    /// F = Kδ + λδ̇, (1)
    KelvinVoigt = 1,
    /// F = (Kδ₀ + λδ̇)(δ/δ₀)ⁿ, (3)
    HuntCrossley = 2,
    /// F + λ/(κ₁+κ₂)·Ḟ = κ₁/(κ₁+κ₂)·(κ₂δ + λδ̇), (2)
    Zener = 3,
    /// F⁽ᵉ⁾ = Kδ₀(δ/δ₀)ⁿ that relaxes in one mode, (9)–(17) with r = 1
    QuasiLinear = 4,
    /// The same with two modes, r = 2; in files it has the same name.
    QuasiLinear2 = 5,
    /// [`LawKind::HuntCrossley`] with the skew of the sensors; in files it has the same name.
    HuntCrossleySkew = 6,
}

const STIFFNESS: ParameterInfo = ParameterInfo {
    name: "stiffness",
    unit: Unit::NewtonPerMetre,
};
const DAMPING: ParameterInfo = ParameterInfo {
    name: "damping",
    unit: Unit::NewtonSecondPerMetre,
};
const EXPONENT: ParameterInfo = ParameterInfo {
    name: "exponent",
    unit: Unit::One,
};
const SECOND_STIFFNESS: ParameterInfo = ParameterInfo {
    name: "second_stiffness",
    unit: Unit::NewtonPerMetre,
};
const FRACTION_1: ParameterInfo = ParameterInfo {
    name: "relaxation_fraction_1",
    unit: Unit::One,
};
const RATE_1: ParameterInfo = ParameterInfo {
    name: "relaxation_rate_1",
    unit: Unit::PerSecond,
};
const FRACTION_2: ParameterInfo = ParameterInfo {
    name: "relaxation_fraction_2",
    unit: Unit::One,
};
const RATE_2: ParameterInfo = ParameterInfo {
    name: "relaxation_rate_2",
    unit: Unit::PerSecond,
};
const SKEW: ParameterInfo = ParameterInfo {
    name: "skew",
    unit: Unit::Second,
};
const SURFACE: ParameterInfo = ParameterInfo {
    name: "surface",
    unit: Unit::Metre,
};

impl LawKind {
    /// All laws.
    pub const ALL: [LawKind; 6] = [
        LawKind::KelvinVoigt,
        LawKind::HuntCrossley,
        LawKind::Zener,
        LawKind::QuasiLinear,
        LawKind::QuasiLinear2,
        LawKind::HuntCrossleySkew,
    ];

    /// The stable number of frames.
    pub const fn code(self) -> u8 {
        self as u8
    }

    /// The one with a number.
    pub fn from_code(code: u8) -> Option<LawKind> {
        LawKind::ALL.into_iter().find(|one| one.code() == code)
    }

    /// The name in files and on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            LawKind::KelvinVoigt => "kelvin_voigt",
            LawKind::HuntCrossley | LawKind::HuntCrossleySkew => "hunt_crossley",
            LawKind::Zener => "zener",
            LawKind::QuasiLinear | LawKind::QuasiLinear2 => "quasi_linear",
        }
    }

    /// The parameters in the order of their slots in [`crate::estimate::Parameters`].
    pub const fn parameters(self) -> &'static [ParameterInfo] {
        match self {
            LawKind::KelvinVoigt => &[STIFFNESS, DAMPING, SURFACE],
            LawKind::HuntCrossley => &[STIFFNESS, DAMPING, EXPONENT, SURFACE],
            LawKind::HuntCrossleySkew => &[STIFFNESS, DAMPING, EXPONENT, SKEW, SURFACE],
            LawKind::Zener => &[STIFFNESS, SECOND_STIFFNESS, DAMPING, SURFACE],
            LawKind::QuasiLinear => &[STIFFNESS, EXPONENT, FRACTION_1, RATE_1, SURFACE],
            LawKind::QuasiLinear2 => &[
                STIFFNESS, EXPONENT, FRACTION_1, RATE_1, FRACTION_2, RATE_2, SURFACE,
            ],
        }
    }
}
