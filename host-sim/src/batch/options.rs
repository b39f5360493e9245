//! What a whole log is fitted with.

use estimator_core::physics::law::LawId;

use crate::diagnostic::{Diagnostic, listed};

use super::{family::Family, family::Form, held::Held, modulus::Indenter, thresholds::Thresholds};

/// What to fit.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// The laws to compare, simplest first.
    pub families: Vec<Family>,
    /// How the force of a relaxing law grows with depth; `None` also tries the exponential form where no
    /// power law explains the force.
    pub elastic: Option<Form>,
    /// Parameters that are held.
    pub held: Held,
    /// δ₀ (m)
    pub reference_depth_m: Option<f64>,
    /// Position of the surface (m), if it is known.
    pub surface_m: Option<f64>,
    /// What touches, if it is known.
    pub indenter: Option<Indenter>,
    /// ν of the material; 0.5 does not change its volume.
    pub poisson: f64,
    /// What decides about the fit.
    pub thresholds: Thresholds,
}

impl Default for Options {
    fn default() -> Options {
        Options {
            families: all_families(),
            elastic: None,
            held: Held::default(),
            reference_depth_m: None,
            surface_m: None,
            indenter: None,
            poisson: 0.5,
            thresholds: Thresholds::default(),
        }
    }
}

impl Options {
    /// Refuses what no law that was asked for can hold.
    ///
    /// # Errors
    /// The parameters that are held, and what can be.
    pub fn check(&self) -> Result<(), Diagnostic> {
        let mut shaped = self.shaped();
        if self.held.fixed.is_empty() || shaped.any(|family| self.held.suits(family)) {
            return Ok(());
        }
        let names = self.held.fixed.iter().map(|(name, _)| name.as_str());
        Err(Diagnostic::new("no law that is fitted can hold these parameters")
            .at_key("estimator.fixed")
            .value(listed(names))
            .remedy(
                "hold surface, exponent, stiffening_rate or relaxation rates of a law that has them; \
                 stiffness and a damping other than 0 only together with the exponent, and the fraction of one mode only",
            ))
    }

    /// Every family in every form that may be fitted.
    fn shaped(&self) -> impl Iterator<Item = Family> {
        let forms = match self.elastic {
            Some(form) => vec![form],
            None => Form::ALL.to_vec(),
        };
        let families = self.families.iter().copied();
        families.flat_map(move |own| {
            forms
                .clone()
                .into_iter()
                .filter_map(move |form| own.shaped(form))
        })
    }

    /// The laws that have all parameters that are held, and that are not fitted because they cannot hold them.
    pub(super) fn laws_that_cannot_hold(&self) -> Vec<&'static str> {
        let mut laws: Vec<&'static str> = Vec::new();
        for family in self.shaped().filter(|family| self.held.is_of(*family)) {
            let could = self
                .shaped()
                .any(|own| own.law == family.law && self.held.suits(own));
            if !could && !laws.contains(&family.name()) {
                laws.push(family.name());
            }
        }
        laws
    }
}

/// Every law, simplest first.
pub fn all_families() -> Vec<Family> {
    let laws = LawId::ALL.iter().filter(|law| **law != LawId::Free);
    laws.flat_map(|law| Family::of(*law)).collect()
}
