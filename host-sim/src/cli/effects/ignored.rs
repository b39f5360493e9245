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

/// Parameters of a size that a palpation rig can have, in the order of the catalogue.
pub fn example(id: EffectId) -> [f64; 4] {
    match id {
        EffectId::StressRelaxation => [0.2, 2.0, 0.0, 0.0],
        EffectId::PowerLawStiffness => [1.4, 0.0, 0.0, 0.0],
        EffectId::DepthDependentDamping => [0.8, 0.0, 0.0, 0.0],
        EffectId::ExponentialStiffening => [60.0, 0.0, 0.0, 0.0],
        EffectId::Adhesion => [0.3, 4e-4, 0.0, 0.0],
        EffectId::PermanentSet => [0.1, 5e-4, 0.0, 0.0],
        EffectId::BuriedLayer => [1500.0, 2.5e-3, 0.0, 0.0],
        EffectId::SurfaceMotion => [5e-5, 3.0, 0.4, 0.0],
        EffectId::HystereticDamping => [0.5, 2e-4, 0.0, 0.0],
        EffectId::CyclicSoftening => [0.2, 1e-3, 0.0, 0.0],
        EffectId::CoulombFriction => [0.4, 1e-5, 0.0, 0.0],
        EffectId::StribeckFriction => [0.3, 0.6, 2e-3, 1e-4],
        EffectId::ViscousDrag => [8.0, 0.0, 0.0, 0.0],
        EffectId::AsymmetricDrag => [5.0, 0.0, 0.0, 0.0],
        EffectId::ToolInertia => [0.4, 0.0, 0.0, 0.0],
        EffectId::ForceOffset => [0.3, 0.0, 0.0, 0.0],
        EffectId::ForceDrift => [0.03, 20.0, 0.0, 0.0],
        EffectId::CableStiffness => [100.0, 0.0, 0.0, 0.0],
        EffectId::Cogging => [0.15, 1e-3, 0.3, 0.0],
        EffectId::PeriodicDisturbance => [0.15, 12.0, 0.3, 0.0],
        EffectId::SeriesCompliance => [12_000.0, 0.0, 0.0, 0.0],
        EffectId::Backlash => [1e-4, 0.0, 0.0, 0.0],
        EffectId::ForceLag => [8e-3, 0.0, 0.0, 0.0],
        EffectId::TimeDelay => [8e-3, 0.0, 0.0, 0.0],
        EffectId::ForceSaturation => [7.0, 0.0, 0.0, 0.0],
        EffectId::EncoderPeriodicError => [4e-5, 1e-3, 0.2, 0.0],
    }
}

/// The law under an effect: one of a linear law has a linear contact, any other the gel.
fn base(id: EffectId) -> (Contact, Family) {
    match id {
        EffectId::PowerLawStiffness | EffectId::DepthDependentDamping => {
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
        _ => (GEL.at(0.0), Family::HUNT_CROSSLEY),
    }
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
    let row = example(id);
    let (contact, family) = base(id);
    let palpated = |effect: Option<Effect<f64>>| -> Result<UniformLog, Diagnostic> {
        let mut effects = [None; MOST_EFFECTS];
        effects[0] = effect;
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

    #[test]
    fn every_example_is_possible() {
        for id in EffectId::ALL {
            for (value, info) in example(*id).iter().zip(id.info().parameters) {
                assert!(info.bounds.allow(*value), "{} {}", id.name(), info.name);
            }
        }
    }
}
