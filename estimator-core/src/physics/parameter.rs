//! What the tables of laws and effects say of a parameter.

use crate::maths::units::Unit;

/// The values that a parameter can have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bounds {
    /// Any number.
    Any,
    /// Zero or more.
    NotNegative,
    /// More than zero.
    Positive,
    /// Between 0 and 1, both excluded.
    Fraction,
    /// An angle: any number, the same every 2π.
    Angle,
    /// Between two numbers, both included.
    Within(f64, f64),
}

impl Bounds {
    /// Whether a value is possible.
    pub fn allow(self, value: f64) -> bool {
        value.is_finite()
            && match self {
                Bounds::Any | Bounds::Angle => true,
                Bounds::NotNegative => value >= 0.0,
                Bounds::Positive => value > 0.0,
                Bounds::Fraction => value > 0.0 && value < 1.0,
                Bounds::Within(low, high) => (low..=high).contains(&value),
            }
    }

    /// The bounds in words, without the ends of a range.
    pub const fn name(self) -> &'static str {
        match self {
            Bounds::Any => "any number",
            Bounds::NotNegative => "zero or more",
            Bounds::Positive => "more than zero",
            Bounds::Fraction => "between 0 and 1",
            Bounds::Angle => "an angle in rad",
            Bounds::Within(..) => "within its range",
        }
    }
}

/// One parameter of a law or an effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParameterInfo {
    /// The key in `model.toml`, `estimate.json` and `gap.json`.
    pub name: &'static str,
    /// The unit in which files give the value.
    pub unit: Unit,
    /// The values that it can have.
    pub bounds: Bounds,
    /// The value where a model gives none; `None` if a model must give one.
    pub default: Option<f64>,
}
