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
    /// N s²/m²
    NewtonSecondSquaredPerMetreSquared,
    /// 1/s
    PerSecond,
    /// 1/m
    PerMetre,
    /// 1/m^ν, with an exponent ν beside it
    PerMetrePower,
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
            Unit::NewtonSecondSquaredPerMetreSquared => "N s²/m²",
            Unit::PerSecond => "1/s",
            Unit::PerMetre => "1/m",
            Unit::PerMetrePower => "1/m^ν",
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

impl Unit {
    /// The symbol for a link that carries ASCII alone.
    pub const fn ascii(self) -> &'static str {
        match self {
            Unit::NewtonSecondSquaredPerMetreSquared => "N s2/m2",
            Unit::PerMetrePower => "1/m^nu",
            other => other.symbol(),
        }
    }
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.symbol())
    }
}
