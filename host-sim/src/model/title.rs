//! The laws as people call them.

/// Name of a law for people.
pub fn law_title(name: &str) -> String {
    match name {
        "kelvin_voigt" => "Kelvin–Voigt".into(),
        "hunt_crossley" => "Hunt–Crossley".into(),
        "zener" => "Zener".into(),
        "quasi_linear" => "quasi-linear".into(),
        other => other.replace('_', " "),
    }
}
