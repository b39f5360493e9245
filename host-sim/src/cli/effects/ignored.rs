//! What an effect does to the base's parameters when a fit does not know of it.
//!
//! The built-in palpation of the chapter's gel, once with the effect and once without, and the batch
//! fit of the law without the effect to the first.

use estimator_core::Config;
use estimator_core::estimate::Estimated;
use estimator_core::physics::effect::{Effect, EffectId, MOST_PARAMETERS};
use estimator_core::physics::law::{KelvinVoigt, Law};

use crate::batch::{Family, Options, batch};
use crate::diagnostic::Diagnostic;
use crate::kind::Kind;
use crate::log::UniformLog;
use crate::motion::Motion;
use crate::plant::{Contact, GEL, Rig, Stage};

/// An effect on a simulated palpation, and what a fit without it makes of that.
#[derive(Clone, Debug)]
pub struct Ignored {
    /// Which effect.
    pub id: EffectId,
    /// Its parameters, in the order of the catalogue.
    pub row: [f64; MOST_PARAMETERS],
    /// What was touched, and by which kind of machine.
    pub touched: Touched,
    /// The law that was fitted.
    pub family: Family,
    /// The palpation without the effect.
    pub without: UniformLog,
    /// The same motion with it.
    pub with: UniformLog,
    /// Parameters of the base, then the constant force and the delay that a fit allows for without being asked:
    /// name, unit, truth and what the fit found.
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

/// What is touched under an effect.
#[derive(Clone, Copy, Debug)]
pub struct Touched {
    /// Its name in sentences.
    pub name: &'static str,
    /// Whether the machine that touches it turns.
    pub kind: Kind,
    contact: Contact,
    family: Family,
    peak_m: f64,
}

/// A torsion spring for effects of machines that turn: 9.6 N m at its deepest, as the gel has 9.4 N, over an
/// angle in which a turn shows.
const TORSION_SPRING: KelvinVoigt<f64> = KelvinVoigt {
    stiffness_n_per_m: 8.0,
    damping_ns_per_m: 0.2,
};
const TORSION_PEAK_RAD: f64 = 1.2;

/// What is touched: for an effect of machines that turn a torsion spring, for one of a linear law a linear
/// contact, for any other the gel.
fn touched(id: EffectId) -> Touched {
    let linear = |law| Contact {
        law: Law::KelvinVoigt(law),
        surface_m: 0.0,
        ..Contact::FREE
    };
    if !Kind::Linear.can_have(id) {
        return Touched {
            name: "a torsion spring (8 N m/rad, 0.2 N m s/rad, pressed by 1.2 rad)",
            kind: Kind::Rotary,
            contact: linear(TORSION_SPRING),
            family: Family::KELVIN_VOIGT,
            peak_m: TORSION_PEAK_RAD,
        };
    }
    let is_linear = id.info().laws.are_linear();
    let spring = KelvinVoigt {
        stiffness_n_per_m: GEL.law.stiffness_n_per_m,
        damping_ns_per_m: GEL.law.damping_ns_per_m,
    };
    let (contact, family) = match is_linear {
        true => (linear(spring), Family::KELVIN_VOIGT),
        false => (GEL.at(0.0), Family::HUNT_CROSSLEY),
    };
    Touched {
        name: match is_linear {
            true => "a linear contact (1350 N/m, 36 N s/m)",
            false => "the gel of the chapter",
        },
        kind: Kind::Linear,
        contact,
        family,
        peak_m: GEL.peak_depth_m,
    }
}

fn truth(contact: &Contact, name: &str) -> f64 {
    let (stiffness, damping, exponent) = match contact.law {
        Law::KelvinVoigt(own) => (own.stiffness_n_per_m, own.damping_ns_per_m, 1.0),
        _ => (
            GEL.law.stiffness_n_per_m,
            GEL.law.damping_ns_per_m,
            GEL.law.exponent,
        ),
    };
    match name {
        "stiffness" => stiffness,
        "damping" => damping,
        "exponent" => exponent,
        _ => 0.0,
    }
}

/// Simulates the effect and fits the law without it.
///
/// # Errors
/// A simulation or a fit that fails; none of the catalogue does.
pub fn ignored(id: EffectId, seed: u64) -> Result<Ignored, Diagnostic> {
    let row = id.info().example;
    let touched = touched(id);
    let (contact, family) = (touched.contact, touched.family);
    let palpated = |effect: Option<Effect<f64>>| -> Result<UniformLog, Diagnostic> {
        let example = |id: EffectId| Effect::new(id, &id.info().example);
        let rig = Rig {
            effects: effect.into_iter().chain(id.needs().map(example)).collect(),
            ..Rig::default()
        };
        let motion = Motion::palpation(touched.peak_m);
        let run = rig.run(&Stage::throughout(contact), &motion, seed)?;
        let log = run.log.uniform()?;
        Ok(UniformLog {
            kind: Some(touched.kind),
            ..log
        })
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
    // What a fit takes off by itself is why an offset or a delay leaves the law as it is.
    let beside = [("offset", "N", found.offset), ("skew", "s", found.skew)];
    let beside = beside.into_iter().filter(|(.., found)| found.is_some());
    Ok(Ignored {
        id,
        row,
        touched,
        family,
        base: found
            .parameters
            .iter()
            .map(|own| (own.name, own.unit, truth(&contact, own.name), own.estimate))
            .chain(beside.map(|(name, unit, found)| (name, unit, 0.0, found)))
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
    fn a_fit_takes_an_offset_and_a_delay_off_by_itself_and_the_page_shows_it() {
        for (id, name) in [
            (EffectId::ForceOffset, "offset"),
            (EffectId::TimeDelay, "skew"),
        ] {
            let found = ignored(id, SEED).unwrap();
            let row = found.base.iter().find(|(own, ..)| *own == name).unwrap();
            let fitted = row.3.unwrap();
            // Truly 0 in the law that was fitted: all of it is the effect.
            assert_eq!(row.2, 0.0);
            let off = fitted.value - found.row[0];
            assert!(off.abs() < 4.0 * fitted.std_error, "{name}: {fitted:?}");
        }
    }
}
