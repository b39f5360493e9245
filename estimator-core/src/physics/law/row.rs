//! What a law's file tells the table of laws, and the parameters that laws share.

use super::{contact_law::RelaxingLaw, environment::Environment, relaxation::MOST_MODES};
use crate::maths::{scalar::Scalar, units::Unit};
use crate::physics::parameter::{Bounds, ParameterInfo};

/// What a law must have to stand in the table.
pub(super) trait LawRow<S: Scalar>: RelaxingLaw<S> + Sized {
    /// The facts about the law that files and the command line need.
    const INFO: LawInfo;

    /// The law from its values by name, with this many of the relaxation modes that files list. Its
    /// stiffness and damping hold at a depth (m). `None` if a value is missing or there are more modes
    /// than the law can have.
    fn from_values(
        modes: usize,
        value: &impl Fn(&str) -> Option<S>,
        reference_depth_m: S,
    ) -> Option<Self>;

    /// The law in the parts that effects act on. The depth (m) is for a law without a reference depth:
    /// it changes nothing until an effect gives a part an exponent.
    fn parts(&self, reference_depth_m: S) -> Environment<S>;
}

/// The reference depth δ₀ (m) unless a model says otherwise: that of the chapter's numbers.
pub const DEFAULT_REFERENCE_DEPTH_M: f64 = 1e-3;

/// The facts about a law that files and the command line need.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LawInfo {
    /// The name in files and on the command line.
    pub name: &'static str,
    /// Another name under which files may have it.
    pub alias: Option<&'static str>,
    /// The name for people.
    pub title: &'static str,
    /// Whether the force depends on how the depth came about: it relaxes in a hold.
    pub relaxes: bool,
    /// The law in one line.
    pub summary: &'static str,
    /// The parameters that it always has, in the order of files and estimates.
    pub parameters: &'static [ParameterInfo],
    /// Parameters that a model may give besides, or in place of one of [`LawInfo::parameters`].
    pub optional: &'static [ParameterInfo],
    /// Most relaxation modes that a file can list; each has the two parameters of [`RELAXATION`].
    pub most_modes: usize,
}

/// K (N/m)
pub(super) const STIFFNESS: ParameterInfo =
    required("stiffness", Unit::NewtonPerMetre, Bounds::Positive);
/// κ₂ (N/m)
pub(super) const SECOND_STIFFNESS: ParameterInfo =
    required("second_stiffness", Unit::NewtonPerMetre, Bounds::Positive);
/// λ (N s/m)
pub(super) const DAMPING: ParameterInfo =
    required("damping", Unit::NewtonSecondPerMetre, Bounds::NotNegative);
/// n: 1 a layer, 3/2 a sphere, 2 a cone; fits wander further.
pub(super) const EXPONENT: ParameterInfo =
    required("exponent", Unit::One, Bounds::Within(0.1, 10.0));
/// q
pub(super) const DAMPING_EXPONENT: ParameterInfo =
    required("damping_exponent", Unit::One, Bounds::Within(0.0, 10.0));
/// The rate b (1/m) at which an exponential response stiffens.
pub const STIFFENING_RATE: ParameterInfo =
    required("stiffening_rate", Unit::PerMetre, Bounds::Positive);
/// The fraction cᵢ and the rate νᵢ (1/s) of each relaxation mode.
pub const RELAXATION: &[[ParameterInfo; 2]; MOST_MODES] = &[
    mode("relaxation_fraction_1", "relaxation_rate_1"),
    mode("relaxation_fraction_2", "relaxation_rate_2"),
    mode("relaxation_fraction_3", "relaxation_rate_3"),
    mode("relaxation_fraction_4", "relaxation_rate_4"),
];
/// How much later the force is read than the position (s).
pub(super) const SKEW: ParameterInfo = required("skew", Unit::Second, Bounds::Any);
/// The position of the surface (m).
pub const SURFACE: ParameterInfo = required("surface", Unit::Metre, Bounds::Any);

const fn required(name: &'static str, unit: Unit, bounds: Bounds) -> ParameterInfo {
    ParameterInfo {
        name,
        unit,
        bounds,
        default: None,
    }
}

const fn mode(fraction: &'static str, rate: &'static str) -> [ParameterInfo; 2] {
    [
        required(fraction, Unit::One, Bounds::Fraction),
        required(rate, Unit::PerSecond, Bounds::Positive),
    ]
}
