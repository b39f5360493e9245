//! The range in which a fit looks for a parameter, in multiples of the sizes of the log that it fits.
//!
//! A range is data: it names the sizes of a log, and whoever fits knows their values.

/// A size of the log that is fitted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// The range of the position (m).
    Travel,
    /// 99 % of the range of the force (N).
    Force,
    /// The largest force (N).
    HighestForce,
    /// The range of the force over that of the position (N/m).
    Stiffness,
    /// The speed that 95 % of the moving samples stay below (m/s).
    Speed,
    /// The length of the longest log (s).
    Duration,
    /// The time between two samples (s).
    Period,
    /// The standard deviation of the position (m).
    PositionNoise,
    /// The longest pitch of which the log shows a cycle and a quarter in contact (m).
    PitchInContact,
}

/// A bound of a range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Limit {
    /// The number itself, in the parameter's unit.
    Number(f64),
    /// The number times a size.
    Times(f64, Scale),
    /// The number divided by a size.
    Per(f64, Scale),
    /// A size divided by the number.
    Part(Scale, f64),
}

impl Limit {
    /// The bound in the parameter's unit, for a log with these sizes.
    pub fn value(self, size: impl Fn(Scale) -> f64) -> f64 {
        match self {
            Limit::Number(number) => number,
            Limit::Times(number, scale) => number * size(scale),
            Limit::Per(number, scale) => number / size(scale),
            Limit::Part(scale, number) => size(scale) / number,
        }
    }
}

/// The range of a parameter, and the variable that a fit moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FitRange {
    /// The fit moves the parameter itself between two bounds.
    Linear(Limit, Limit),
    /// The fit moves the parameter's logarithm: the parameter has no scale of its own, as a rate.
    Logarithmic(Limit, Limit),
    /// The fit leaves the parameter where it is: it chooses a form of the law, and is no quantity.
    Fixed(f64),
}

impl FitRange {
    /// Every number.
    pub const ANY: FitRange = FitRange::Linear(
        Limit::Number(f64::NEG_INFINITY),
        Limit::Number(f64::INFINITY),
    );
    /// Zero and every number above.
    pub const NOT_NEGATIVE: FitRange = FitRange::up_to(Limit::Number(f64::INFINITY));

    /// The parameter itself, from zero to a bound.
    pub const fn up_to(highest: Limit) -> FitRange {
        FitRange::Linear(Limit::Number(0.0), highest)
    }
}
