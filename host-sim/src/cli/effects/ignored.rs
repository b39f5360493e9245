//! What an effect does to the base's parameters when a fit does not know of it.
//!
//! The built-in palpation of the chapter's gel, once with the effect and once without, and the batch
//! fit of the law without the effect to the first.

use estimator_core::Config;
use estimator_core::estimate::Estimated;
use estimator_core::physics::effect::{Effect, EffectId};
use estimator_core::physics::law::{KelvinVoigt, Law};
use estimator_core::physics::rig::MOST_EFFECTS;

use crate::batch::{Family, Options, batch};
use crate::diagnostic::Diagnostic;
use crate::log::UniformLog;
use crate::motion::Motion;
use crate::plant::{Contact, GEL, Rig, Stage};

/// An effect on a simulated palpation, and what a fit without it makes of that.
#[derive(Clone, Debug)]
pub struct Ignored {
    /// Which effect.
    pub id: EffectId,
    /// Its parameters, in the order of the catalogue.
    pub row: [f64; 4],
    /// The law that was fitted.
    pub family: Family,
    /// The palpation without the effect.
    pub without: UniformLog,
    /// The same motion with it.
    pub with: UniformLog,
    /// Parameters of the base: name, unit, truth and what the fit found.
    pub base: Vec<(&'static str, &'static str, f64, Option<Estimated<f64>>)>,
    /// Depth below the fitted surface (m).
    pub depth_m: Vec<f64>,
    /// Force that the fit does not explain (N); in free air all of it but the offset.
    pub residual_n: Vec<f64>,
    /// Whether the fit has a force there.
    pub in_contact: Vec<bool>,
    /// Residual of the fit in contact over the noise of the force.
    pub misfit: Option<f64>,
}

/// The law under an effect: one of a linear law has a linear contact, any other the gel.
fn base(id: EffectId) -> (Contact, Family) {
    if !id.info().laws.are_linear() {
        return (GEL.at(0.0), Family::HUNT_CROSSLEY);
    }
    let law = KelvinVoigt {
        stiffness_n_per_m: GEL.law.stiffness_n_per_m,
        damping_ns_per_m: GEL.law.damping_ns_per_m,
    };
    let contact = Contact {
        law: Law::KelvinVoigt(law),
        surface_m: 0.0,
    };
    (contact, Family::KELVIN_VOIGT)
}

fn truth(name: &str) -> f64 {
    match name {
        "stiffness" => GEL.law.stiffness_n_per_m,
        "damping" => GEL.law.damping_ns_per_m,
        "exponent" => GEL.law.exponent,
        _ => 0.0,
    }
}

/// Simulates the effect and fits the law without it.
///
/// # Errors
/// A simulation or a fit that fails; none of the catalogue does.
pub fn ignored(id: EffectId, seed: u64) -> Result<Ignored, Diagnostic> {
    let row = id.info().example;
    let (contact, family) = base(id);
    let palpated = |effect: Option<Effect<f64>>| -> Result<UniformLog, Diagnostic> {
        let mut effects = [None; MOST_EFFECTS];
        effects[0] = effect;
        let example = |id: EffectId| Effect::new(id, &id.info().example);
        effects[1] = id.needs().map(example);
        let rig = Rig {
            effects,
            ..Rig::default()
        };
        let motion = Motion::palpation(GEL.peak_depth_m);
        let run = rig.run(&Stage::throughout(contact), &motion, seed)?;
        run.log.uniform()
    };
    let (without, with) = (palpated(None)?, palpated(Some(Effect::new(id, &row)))?);
    let options = Options {
        families: vec![family],
        ..Options::default()
    };
    let found = batch(&with, Config::default(), &options)?;
    let columns = &found.columns;
    let in_contact: Vec<bool> = columns.estimated_n.iter().map(|f| f.is_finite()).collect();
    let forces = columns.measured_n.iter().zip(&columns.estimated_n);
    let residual = |(measured, law): (&f64, &f64)| match law.is_finite() {
        true => measured - law,
        false => *measured,
    };
    Ok(Ignored {
        id,
        row,
        family,
        base: found
            .parameters
            .iter()
            .map(|own| (own.name, own.unit, truth(own.name), own.estimate))
            .collect(),
        residual_n: forces.map(residual).collect(),
        depth_m: columns.depth_m.clone(),
        in_contact,
        misfit: found.force_rmse_n.map(|rmse| rmse / found.noise_n),
        without,
        with,
    })
}

impl Ignored {
    /// How far the fit is off in this parameter, of the truth (1); `None` of one that is unknown or
    /// truly 0.
    pub fn bias(&self, name: &str) -> Option<f64> {
        let (_, _, truth, found) = self.base.iter().find(|(own, ..)| *own == name)?;
        (*truth != 0.0).then_some(())?;
        Some((*found)?.value / truth - 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SEED: u64 = 1;

    #[test]
    fn a_hidden_compliance_reads_as_a_softer_contact_and_leaves_a_residual() {
        let found = ignored(EffectId::SeriesCompliance, SEED).unwrap();
        // At 4 mm the gel has 3 N/mm beside 12: the contact reads softer by a fifth and more. Measured
        // −32 %, since the fit moves the surface up as well, and 6.9 times the noise.
        let bias = found.bias("stiffness").unwrap();
        assert!((-0.45..-0.2).contains(&bias), "{bias}");
        assert!(
            (4.0..10.0).contains(&found.misfit.unwrap()),
            "{:?}",
            found.misfit
        );
        assert_eq!(found.residual_n.len(), found.with.len());
    }
}
