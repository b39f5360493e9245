//! Which numbers make sense under a key.

pub use estimator_core::physics::parameter::Bounds;

/// The bounds for sentences: "a number greater than 0".
pub(super) fn say(bounds: Bounds) -> String {
    match bounds {
        Bounds::Any | Bounds::Angle => "a finite number".into(),
        Bounds::Positive => "a number greater than 0".into(),
        Bounds::NotNegative => "a number of at least 0".into(),
        Bounds::Fraction => "a number between 0 and 1".into(),
        Bounds::Within(low, high) => format!("a number from {low} to {high}"),
    }
}
