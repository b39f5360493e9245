//! What is known about a setting.

use core::fmt;

/// The values that a setting can have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bounds {
    /// From the first to the second.
    Within(f32, f32),
    /// From the first to the second in magnitude, of either sign.
    Signed(f32, f32),
    /// Whole numbers from the first to the second.
    Whole(f32, f32),
}

impl Bounds {
    /// Whether a value is one of them; NaN never is.
    #[inline(never)]
    pub fn hold(self, value: f32) -> bool {
        match self {
            Bounds::Within(low, high) => (low..=high).contains(&value),
            Bounds::Signed(low, high) => (low..=high).contains(&value.abs()),
            Bounds::Whole(low, high) => {
                (low..=high).contains(&value) && libm::floorf(value) == value
            }
        }
    }
}

impl fmt::Display for Bounds {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Bounds::Within(low, high) => write!(f, "from {low} to {high}"),
            Bounds::Signed(low, high) => write!(f, "from {low:e} to {high} or the negative of it"),
            Bounds::Whole(low, high) => write!(f, "a whole number from {low} to {high}"),
        }
    }
}

/// What is known about a setting.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Info {
    /// `section.name`, as it stands in the TOML backup.
    pub name: &'static str,
    /// The unit.
    pub unit: &'static str,
    /// The values that it can have.
    pub bounds: Bounds,
    /// The value on a board that nobody has set: the reference wiring's data sheets.
    pub default: f32,
    /// Whether a change restarts the estimator.
    pub restarts: bool,
    /// What the setting decides, for people.
    pub about: &'static str,
}
