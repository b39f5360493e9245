//! The units that parameters are reported in, in one table.

use core::fmt;

/// The SI unit of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Unit {
    /// 1, of a number without unit.
    One,
    /// m
    Metre,
    /// N/m
    NewtonPerMetre,
    /// N s/m
    NewtonSecondPerMetre,
    /// 1/s
    PerSecond,
    /// 1/m
    PerMetre,
    /// m/s
    MetrePerSecond,
    /// N
    Newton,
    /// N/s
    NewtonPerSecond,
    /// kg
    Kilogram,
    /// s
    Second,
    /// Hz
    Hertz,
    /// rad
    Radian,
}

impl Unit {
    /// The symbol of the unit in `estimate.json`.
    pub const fn symbol(self) -> &'static str {
        match self {
            Unit::One => "1",
            Unit::Metre => "m",
            Unit::NewtonPerMetre => "N/m",
            Unit::NewtonSecondPerMetre => "N s/m",
            Unit::PerSecond => "1/s",
            Unit::PerMetre => "1/m",
            Unit::MetrePerSecond => "m/s",
            Unit::Newton => "N",
            Unit::NewtonPerSecond => "N/s",
            Unit::Kilogram => "kg",
            Unit::Second => "s",
            Unit::Hertz => "Hz",
            Unit::Radian => "rad",
        }
    }
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.symbol())
    }
}
