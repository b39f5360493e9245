//! Which numbers make sense under a key.

/// Which numbers a key may hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bounds {
    /// Any finite number.
    Any,
    /// > 0
    Positive,
    /// ≥ 0
    NotNegative,
    /// 0 < value < 1
    Fraction,
    /// From the first to the second, both allowed.
    Within(f64, f64),
}

impl Bounds {
    /// Whether a key may hold `value`.
    pub(super) fn hold(self, value: f64) -> bool {
        value.is_finite()
            && match self {
                Bounds::Any => true,
                Bounds::Positive => value > 0.0,
                Bounds::NotNegative => value >= 0.0,
                Bounds::Fraction => value > 0.0 && value < 1.0,
                Bounds::Within(low, high) => (low..=high).contains(&value),
            }
    }

    /// For sentences: "a number greater than 0".
    pub(super) fn say(self) -> String {
        match self {
            Bounds::Any => "a finite number".into(),
            Bounds::Positive => "a number greater than 0".into(),
            Bounds::NotNegative => "a number of at least 0".into(),
            Bounds::Fraction => "a number between 0 and 1".into(),
            Bounds::Within(low, high) => format!("a number from {low} to {high}"),
        }
    }
}
