//! Young's modulus from stiffness and exponent, when the indenter is known.
//!
//! | indenter | n | F |
//! |---|---|---|
//! | sphere of radius R (Hertz) | 3/2 | ⁴⁄₃ E*·√R·δ^{3/2} |
//! | cone of half-angle α (Sneddon) | 2 | (2/π) E*·tan α·δ² |
//! | flat punch of radius R | 1 | 2 E*·R·δ |
//!
//! E* = E/(1 − ν²): half-space, small strain, no friction, rigid indenter. For a law that relaxes it
//! is the modulus at once; that in the end is smaller by 1 − Σcᵢ.
//!
//! **Where they end.** The parabola that stands for the sphere is 3 % too stiff at δ = 0.3 R (Sneddon's
//! exact sphere: a = R/2, δ = 0.275 R, F = 0.187 E*R² against 0.192), and 10 % at 0.9 R. A cone's surface is
//! taken as flat: its force is some 10 % off at a half-angle of 60 degrees, and 20 to 30 % at 42 (Hay, Bolshakov
//! and Pharr 1999). A punch is taken to strain by δ/R.

use std::f64::consts::PI;
use std::str::FromStr;

use crate::number::quantity;

/// Deepest indentation that the closed forms of a sphere and a punch hold for, of the radius.
const DEEPEST: f64 = 0.3;
/// Smallest half-angle (degrees) that the closed form of a cone holds for.
const BLUNT_DEGREES: f64 = 60.0;

/// The shape that touches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Indenter {
    /// A sphere of this radius (m).
    Sphere(f64),
    /// A cone of this half-angle (degrees).
    Cone(f64),
    /// A flat punch of this radius (m).
    Flat(f64),
}

impl FromStr for Indenter {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || {
            format!(
                "`{text}` is not an indenter: sphere:RADIUS in metres, cone:HALF_ANGLE in degrees or \
                 flat:RADIUS in metres, such as sphere:0.003"
            )
        };
        let (shape, size) = text.split_once(':').ok_or_else(wrong)?;
        let size: f64 = size.trim().parse().map_err(|_| wrong())?;
        if !(size.is_finite() && size > 0.0) {
            return Err(format!(
                "the size of the indenter must be positive, not {size}"
            ));
        }
        match shape.trim() {
            "sphere" => Ok(Indenter::Sphere(size)),
            "cone" if size < 90.0 => Ok(Indenter::Cone(size)),
            "cone" => Err(format!(
                "a cone's half-angle is less than 90 degrees, not {size}"
            )),
            "flat" => Ok(Indenter::Flat(size)),
            _ => Err(wrong()),
        }
    }
}

impl Indenter {
    /// n of F ∝ δⁿ.
    pub fn exponent(self) -> f64 {
        match self {
            Indenter::Sphere(_) => 1.5,
            Indenter::Cone(_) => 2.0,
            Indenter::Flat(_) => 1.0,
        }
    }

    /// F/(E*·δⁿ), (m^(2−n)).
    fn factor(self) -> f64 {
        match self {
            Indenter::Sphere(radius_m) => 4.0 / 3.0 * radius_m.sqrt(),
            Indenter::Cone(degrees) => 2.0 / PI * degrees.to_radians().tan(),
            Indenter::Flat(radius_m) => 2.0 * radius_m,
        }
    }

    /// E (Pa) of a contact with F = Kδ₀(δ/δ₀)ⁿ, n this indenter's own, on a material with Poisson's
    /// ratio `poisson`.
    pub fn youngs_modulus(self, stiffness_n_per_m: f64, depth_m: f64, poisson: f64) -> f64 {
        let raw = stiffness_n_per_m * depth_m.powf(1.0 - self.exponent());
        raw / self.factor() * (1.0 - poisson * poisson)
    }

    /// A sentence where a depth (m) is beyond what the closed form holds for.
    pub(super) fn limit(self, depth_m: f64) -> Option<String> {
        let deep = |radius_m: f64| {
            (depth_m > DEEPEST * radius_m).then(|| {
                format!(
                    "the depth of {} is {:.2} of the radius of {}: small strain ends at {DEEPEST}",
                    quantity(depth_m, 3, "m"),
                    depth_m / radius_m,
                    quantity(radius_m, 3, "m")
                )
            })
        };
        match self {
            Indenter::Sphere(radius_m) | Indenter::Flat(radius_m) => deep(radius_m),
            Indenter::Cone(degrees) => (degrees < BLUNT_DEGREES).then(|| {
                format!(
                    "a cone of {degrees} degrees is too sharp for a flat half-space: the closed form \
                     holds from {BLUNT_DEGREES} on"
                )
            }),
        }
    }

    /// As on the command line.
    pub fn name(self) -> String {
        match self {
            Indenter::Sphere(radius_m) => format!("sphere:{radius_m}"),
            Indenter::Cone(degrees) => format!("cone:{degrees}"),
            Indenter::Flat(radius_m) => format!("flat:{radius_m}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_modulus_of_the_closed_forms_comes_back() {
        // GIVEN 20 kPa, ν = 0.5: E* = 26 667 Pa
        let (modulus, poisson, depth): (f64, f64, f64) = (20e3, 0.5, 1e-3);
        let reduced = modulus / (1.0 - poisson * poisson);
        for (text, force) in [
            (
                "sphere:0.003",
                4.0 / 3.0 * reduced * 0.003_f64.sqrt() * depth.powf(1.5),
            ),
            ("cone:45", 2.0 / PI * reduced * depth * depth),
            ("flat:0.002", 2.0 * reduced * 0.002 * depth),
        ] {
            let indenter: Indenter = text.parse().unwrap();
            // K is the secant stiffness at the reference depth, whatever n.
            let found = indenter.youngs_modulus(force / depth, depth, poisson);
            assert!((found / modulus - 1.0).abs() < 1e-12, "{text}: {found}");
            assert_eq!(indenter.name(), text);
        }
    }

    #[test]
    fn the_reference_depth_does_not_matter() {
        let sphere = Indenter::Sphere(0.003);
        // K(δ₀) ∝ δ₀^(n−1).
        let (one, two) = (1000.0, 1000.0 * 2.0_f64.sqrt());
        let ratio = sphere.youngs_modulus(one, 1e-3, 0.3) / sphere.youngs_modulus(two, 2e-3, 0.3);
        assert!((ratio - 1.0).abs() < 1e-12);
    }

    #[test]
    fn what_is_no_indenter_is_refused_with_what_would_be_one() {
        for text in ["sphere", "ball:1", "sphere:-1", "cone:95", "flat:nan"] {
            assert!(text.parse::<Indenter>().is_err(), "{text}");
        }
        let error = "ball:1".parse::<Indenter>().unwrap_err();
        assert!(error.contains("such as sphere:0.003"), "{error}");
    }
}
