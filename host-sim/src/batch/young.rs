//! Young's modulus of a fit, and whether it is a constant of the material.

use estimator_core::estimate::Estimated;
use estimator_core::physics::law::LawId;

use super::assemble::Given;
use super::family::{Family, Form};
use super::fit::Fit;
use super::modulus::Indenter;
use super::natural::natural;
use super::result::{Modulus, ModulusKind};
use super::select::{Candidate, Fixed, candidates};
use crate::estimate::EXPLAINED;
use crate::number::quantity;

/// An exponent is another than the indenter's beyond so many of its standard errors, and this much.
const OTHER_SIGMAS: f64 = 3.0;
const OTHER: f64 = 0.1;

impl Given<'_> {
    /// E with the indenter's own exponent, for which the law is fitted again.
    pub(super) fn modulus(
        &self,
        best: &Candidate,
        exponent: Option<Estimated<f64>>,
        indenter: Indenter,
        poisson: f64,
        fixed: &Fixed,
    ) -> Option<Modulus> {
        let own = indenter.exponent();
        let family = family_with(best.fit.family, own);
        let mut fixed = fixed.clone();
        fixed.held.fixed.retain(|(name, _)| name == "surface");
        fixed.held.fixed.push(("exponent".into(), own));
        let again = candidates(self.course, &[family], &fixed).pop()?;
        let stay = fixed.of(family, &self.course.scales);
        let problem = self.problem(&again, &stay);
        let covariance = problem.covariance(&again.fit.free);
        let values = problem.reported(&again.fit.free, &covariance, self.reference_depth_m);
        let stiffness = values.first()?;
        let value = indenter.youngs_modulus(stiffness.value, self.reference_depth_m, poisson);
        let std_error = value * stiffness.std_error / stiffness.value;
        let is_known = value.is_finite() && value > 0.0 && std_error < value;
        let law = natural(family, &again.fit.free, &self.course.scales);
        let relaxes: f64 = law.modes.iter().map(|mode| mode.fraction).sum();
        let mut why = Vec::new();
        if !is_known {
            why.push(
                "the log does not determine it: its standard error is larger than itself".into(),
            );
        }
        why.extend(indenter.limit(self.depth_m(&again.fit)));
        why.extend(self.other_growth(&again, exponent, own));
        Some(Modulus {
            value: is_known.then_some(Estimated { value, std_error }),
            kind: match family.modes {
                0 => ModulusKind::Relaxed,
                _ => ModulusKind::Instantaneous,
            },
            relaxed_pa: (is_known && family.modes > 0).then_some(value * (1.0 - relaxes)),
            why,
            indenter: indenter.name(),
            poisson,
            exponent_assumed: own,
            force_rmse_n: self.rmse(&again),
        })
    }

    /// Deepest penetration (m).
    fn depth_m(&self, fit: &Fit) -> f64 {
        let scales = &self.course.scales;
        scales.touch_m + scales.depth_m - natural(fit.family, &fit.free, scales).surface_m
    }

    /// A sentence where the force does not grow with depth as this indenter's on a half-space does.
    fn other_growth(
        &self,
        law: &Candidate,
        exponent: Option<Estimated<f64>>,
        own: f64,
    ) -> Option<String> {
        let rmse_n = self.rmse(law);
        if rmse_n > EXPLAINED * self.course.scales.noise_n {
            return Some(format!(
                "with the indenter's exponent {own} the law leaves {}, {:.1} × the noise",
                quantity(rmse_n, 3, "N"),
                rmse_n / self.course.scales.noise_n
            ));
        }
        let found = exponent?;
        let apart = (found.value - own).abs();
        (apart > OTHER.max(OTHER_SIGMAS * found.std_error)).then(|| {
            format!(
                "the force grows with the power {:.2} of the depth, and this indenter's with {own}",
                found.value
            )
        })
    }
}

/// The law that the modulus is taken from: as the best one, with an exponent to set.
fn family_with(best: Family, exponent: f64) -> Family {
    match best.law {
        LawId::KelvinVoigt if exponent != 1.0 => Family::HUNT_CROSSLEY,
        LawId::Zener if exponent != 1.0 => Family {
            recovery: best.recovery,
            ..Family::quasi_linear(1)
        },
        _ => best.shaped(Form::Power).unwrap_or(best),
    }
}
