//! The range in which a fit looks for a parameter, in multiples of the sizes of the log that it fits.
//!
//! A range is data: it names the sizes of a log, and the fit knows their values.

/// A size of the log that is fitted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// The range of the position (m).
    Travel,
    /// 99 % of the range of the force (N).
    Force,
    /// A twentieth of [`Scale::Force`] (N): the force with which an effect starts.
    SmallForce,
    /// The largest force (N).
    HighestForce,
    /// The smallest force (N): below 0 where the contact pulls.
    LowestForce,
    /// The range of the force over that of the position (N/m).
    Stiffness,
    /// The speed that 95 % of the moving samples stay below (m/s).
    Speed,
    /// The standard deviation of the speed (m/s).
    SpeedNoise,
    /// The acceleration that 95 % of the accelerated samples stay below (m/s²).
    Acceleration,
    /// The largest distance of the position from 0 (m).
    Reach,
    /// The length of the longest log (s).
    Duration,
    /// The time between two samples (s).
    Period,
    /// The standard deviation of the position (m).
    PositionNoise,
    /// The longest pitch of which the log shows a cycle and a quarter in contact (m).
    PitchInContact,
}

/// A number that is made of the sizes of a log: a bound of a range, or a value at which a fit starts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scaled {
    /// The number itself, in the parameter's unit.
    Number(f64),
    /// The number times a size.
    Times(f64, Scale),
    /// The number divided by a size.
    Per(f64, Scale),
    /// The number divided by the square of a size.
    PerSquare(f64, Scale),
    /// A size divided by the number.
    Part(Scale, f64),
    /// The number times the first size over the second.
    Ratio(f64, Scale, Scale),
    /// The number times the first size over the square of the second.
    RatioOfSquare(f64, Scale, Scale),
    /// The larger of two products of a number and a size.
    Largest([(f64, Scale); 2]),
}

impl Scaled {
    /// The number in the parameter's unit, for a log with these sizes.
    pub fn value(self, size: impl Fn(Scale) -> f64) -> f64 {
        match self {
            Scaled::Number(number) => number,
            Scaled::Times(number, scale) => number * size(scale),
            Scaled::Per(number, scale) => number / size(scale),
            Scaled::PerSquare(number, scale) => number / (size(scale) * size(scale)),
            Scaled::Part(scale, number) => size(scale) / number,
            Scaled::Ratio(number, over, under) => number * (size(over) / size(under)),
            Scaled::RatioOfSquare(number, over, under) => {
                number * (size(over) / (size(under) * size(under)))
            }
            Scaled::Largest([a, b]) => (a.0 * size(a.1)).max(b.0 * size(b.1)),
        }
    }
}

/// The range of a parameter, and the variable that a fit moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FitRange {
    /// The fit moves the parameter itself between two bounds.
    Linear(Scaled, Scaled),
    /// The fit moves the parameter's logarithm: the parameter has no scale of its own, as a rate.
    Logarithmic(Scaled, Scaled),
    /// The fit leaves the parameter where it is: it chooses a form of the law, and is no quantity.
    Fixed(f64),
}

impl FitRange {
    /// Every number.
    pub const ANY: FitRange = FitRange::Linear(
        Scaled::Number(f64::NEG_INFINITY),
        Scaled::Number(f64::INFINITY),
    );
    /// Zero and every number above.
    pub const NOT_NEGATIVE: FitRange = FitRange::up_to(Scaled::Number(f64::INFINITY));

    /// The parameter itself, from zero to a bound.
    pub const fn up_to(highest: Scaled) -> FitRange {
        FitRange::Linear(Scaled::Number(0.0), highest)
    }
}
