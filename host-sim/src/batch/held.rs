//! Parameters that a person holds, as free numbers of a family.

use super::family::{Family, Form, STIFFNESS, SURFACE};
use super::natural::{damping_unit, free_of_exponent, reference_m};
use super::scales::Scales;

/// Values that are held, or begun with, by the names of files.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Held {
    /// Parameters that stay at their values.
    pub fixed: Vec<(String, f64)>,
    /// Parameters that begin at these values.
    pub initial: Vec<(String, f64)>,
}

impl Held {
    /// The value of a parameter that is held.
    pub fn value(&self, name: &str) -> Option<f64> {
        let mut fixed = self.fixed.iter();
        fixed
            .find(|(held, _)| held == name)
            .map(|(_, value)| *value)
    }

    /// Whether a family has every parameter that is held.
    pub(super) fn is_of(&self, family: Family) -> bool {
        let has = |name: &str| family.parameters().any(|info| info.name == name);
        self.fixed.iter().all(|(name, _)| has(name))
    }

    /// Whether a family has every parameter that is held, in a form that can be.
    pub(super) fn suits(&self, family: Family) -> bool {
        let has = |name: &str| family.parameters().any(|info| info.name == name);
        self.fixed.iter().all(|(name, value)| {
            // No damping is none at any depth, and a law without one has none.
            if name == "damping" && *value == 0.0 {
                return true;
            }
            let needs_exponent = ["stiffness", "damping"].contains(&name.as_str());
            let shape_is_held = family.exponent().is_none() || self.value("exponent").is_some();
            let is_listed = !name.starts_with("relaxation_fraction") || family.modes == 1;
            has(name)
                && is_listed
                && (!needs_exponent || (shape_is_held && family.elastic == Form::Power))
        })
    }

    /// Places and values of the free numbers that stay.
    pub(super) fn fixed(&self, family: Family, scales: &Scales, depth_m: f64) -> Vec<(usize, f64)> {
        let all = self.fixed.iter();
        all.filter_map(|(name, value)| self.free(name, *value, family, scales, depth_m))
            .collect()
    }

    /// Places and values of the free numbers that a walk begins with.
    pub(super) fn initial(
        &self,
        family: Family,
        scales: &Scales,
        depth_m: f64,
    ) -> Vec<(usize, f64)> {
        let all = self.initial.iter();
        all.filter_map(|(name, value)| self.free(name, *value, family, scales, depth_m))
            .collect()
    }

    /// Place and value of the free number that a parameter at the reference depth (m) is.
    fn free(
        &self,
        name: &str,
        value: f64,
        family: Family,
        scales: &Scales,
        depth_m: f64,
    ) -> Option<(usize, f64)> {
        // K(D) = K(δ₀)(D/δ₀)^(n−1), λ(D) = λ(δ₀)(D/δ₀)^n.
        let exponent = family
            .exponent()
            .map(|_| self.value("exponent").unwrap_or(1.0));
        let ratio = reference_m(scales) / depth_m;
        let first_mode = family.first_mode();
        Some(match name {
            "surface" => (SURFACE, (value - scales.touch_m) / scales.depth_m),
            "exponent" => (family.exponent()?, free_of_exponent(value)),
            "stiffening_rate" => (family.stiffening_rate()?, (value * scales.depth_m).ln()),
            "stiffness" => {
                let here = value * ratio.powf(exponent.unwrap_or(1.0) - 1.0);
                (
                    STIFFNESS,
                    (here * reference_m(scales) / scales.force_n).ln(),
                )
            }
            "damping" => {
                let here = value * ratio.powf(exponent.unwrap_or(0.0));
                (family.damping()?, here / damping_unit(scales))
            }
            _ => {
                let (what, mode) = name.rsplit_once('_')?;
                let mode = mode.parse::<usize>().ok()?.checked_sub(1)?;
                if mode >= family.listed_modes() {
                    return None;
                }
                match what {
                    "relaxation_rate" => (first_mode + 2 * mode + 1, value.ln()),
                    // One mode: c = e^θ/(1 + e^θ).
                    "relaxation_fraction" => (first_mode + 2 * mode, (value / (1.0 - value)).ln()),
                    _ => return None,
                }
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use estimator_core::physics::law::LawId;

    #[test]
    fn no_damping_is_held_without_an_exponent_and_another_one_is_not() {
        let holds = |value: f64, law: LawId| {
            let held = Held {
                fixed: vec![("damping".into(), value)],
                initial: Vec::new(),
            };
            Family::of(law).all(|family| held.suits(family))
        };
        // GIVEN a law whose damping at a depth depends on its exponent
        assert!(holds(0.0, LawId::HuntCrossley) && !holds(5.0, LawId::HuntCrossley));
        // AND one that has no exponent, and one that has no damping.
        assert!(holds(5.0, LawId::KelvinVoigt));
        assert!(holds(0.0, LawId::QuasiLinear) && !holds(5.0, LawId::QuasiLinear));
    }
}
