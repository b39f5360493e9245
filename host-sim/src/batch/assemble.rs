//! From a minimum to a result: parameters with names, columns, the elastic curve, the modulus.

use estimator_core::Status;
use estimator_core::estimate::Estimated;

use super::touch;
use super::{
    course::Course, course::Node, course::Use, family::Family, family::natural, fit::Fit,
    fit::Problem, modulus::Indenter, result::Batch, result::Columns, result::Modulus,
    result::Parameter, result::Tried, select::Candidate, select::Fixed, select::candidates,
};
use crate::kinematics::Kinematics;
use crate::log::UniformLog;
use crate::stats::rms;

/// Points of the elastic curve.
const CURVE_POINTS: usize = 200;

/// Parameters, misfit, offset, skew.
type Estimates = (
    Vec<Parameter>,
    f64,
    Option<Estimated<f64>>,
    Option<Estimated<f64>>,
);

/// A log, and what the fit needs to know of it besides the samples.
pub(super) struct Given<'a> {
    pub(super) log: &'a UniformLog,
    pub(super) motion: &'a Kinematics,
    pub(super) course: &'a Course,
    pub(super) reference_depth_m: f64,
}

impl Given<'_> {
    fn problem<'a>(&'a self, candidate: &'a Candidate, fixed: &'a [usize]) -> Problem<'a> {
        Problem {
            family: candidate.fit.family,
            nodes: &self.course.nodes,
            weights: &candidate.weights,
            scales: &self.course.scales,
            fixed,
        }
    }

    /// The smallest score among the laws of which the log tells every relaxation mode: one that is
    /// not known to be there is not taken, whatever it takes off the residuals.
    pub(super) fn best<'a>(&self, tried: &'a [Candidate], fixed: Fixed) -> Option<&'a Candidate> {
        let mut order: Vec<&Candidate> = tried.iter().collect();
        order.sort_by(|a, b| a.score.total_cmp(&b.score));
        let told = |candidate: &&&Candidate| {
            let (parameters, ..) = self.estimated(candidate, fixed);
            let mut modes = parameters
                .iter()
                .filter(|p| p.name.starts_with("relaxation"));
            modes.all(|mode| mode.estimate.is_some())
        };
        order.iter().find(told).or(order.first()).copied()
    }

    /// The parameters of a candidate, its misfit, its offset and its skew.
    fn estimated(&self, candidate: &Candidate, fixed: Fixed) -> Estimates {
        let family = candidate.fit.family;
        let stay = fixed.of(family);
        let problem = self.problem(candidate, &stay);
        let covariance = problem.covariance(&candidate.fit.free);
        let mut values = problem.reported(&candidate.fit.free, &covariance, self.reference_depth_m);
        let (skew, offset) = (values.pop(), values.pop());
        let skew = skew.filter(|_| family.skew().is_some());
        (self.named(family, &values), covariance.misfit, offset, skew)
    }

    pub(super) fn result(
        &self,
        empty: Batch,
        best: &Candidate,
        tried: &[Candidate],
        fixed: Fixed,
    ) -> Batch {
        let (parameters, misfit, offset, skew) = self.estimated(best, fixed);
        let columns = self.columns(&best.fit);
        let rmse = self.rmse(&best.fit);
        let selection = tried.iter().map(|candidate| Tried {
            family: candidate.fit.family,
            parameters: candidate.fit.free.len(),
            force_rmse_n: self.rmse(&candidate.fit),
            score: candidate.score,
        });
        Batch {
            family: best.fit.family,
            status: self.status(&best.fit, &parameters, rmse, empty.noise_n),
            parameters: sorted(best.fit.family, parameters),
            offset,
            skew,
            force_rmse_n: Some(rmse),
            misfit,
            selection: selection.collect(),
            per_touch: touch::touches(self.course, self.log, best, self.reference_depth_m),
            columns,
            elastic: self.elastic(&best.fit),
            ..empty
        }
    }

    fn status(&self, fit: &Fit, parameters: &[Parameter], rmse: f64, noise_n: f64) -> Status {
        if parameters
            .iter()
            .any(|parameter| parameter.estimate.is_none())
        {
            Status::Unobservable
        } else if rmse > self.course.thresholds.report.explained * noise_n {
            Status::ModelSuspect
        } else if fit.converged {
            Status::Converged
        } else {
            Status::Converging
        }
    }

    /// Names to values; none to what the log does not tell.
    fn named(&self, family: Family, values: &[Estimated<f64>]) -> Vec<Parameter> {
        let known = |name: &str, estimate: &Estimated<f64>| {
            let far = match name {
                "surface" => self.course.scales.depth_m,
                "damping" if family != Family::ZENER => f64::INFINITY,
                _ => self.course.thresholds.report.unknown_share * estimate.value.abs(),
            };
            estimate.value.is_finite() && estimate.std_error < far
        };
        let parameters = family.parameters().zip(values);
        parameters
            .map(|(info, value)| Parameter::new(info, known(info.name, value).then_some(*value)))
            .collect()
    }

    /// The force of a fit at every sample (N), offset included, whatever it was fitted to.
    fn forces(&self, fit: &Fit) -> Vec<f64> {
        let period_s = self.log.period_s();
        let nodes: Vec<Node> = (0..self.log.len())
            .map(|at| Node {
                time_s: self.log.time_s[at],
                period_s,
                position_m: self.motion.position_m[at],
                speed_mps: self.motion.speed_mps[at],
                acceleration_mps2: self.motion.acceleration_mps2[at],
                force_n: self.log.force_n[at],
                count: 1.0,
                held: 1.0,
                used: self.course.uses[at],
            })
            .collect();
        let mut forces = Vec::with_capacity(nodes.len());
        let law = natural(fit.family, &fit.free, &self.course.scales);
        law.along(fit.family, &nodes, |_, force| forces.push(force));
        forces
    }

    /// Whether a sample of the log was fitted to in contact.
    fn is_fitted(&self, at: usize) -> bool {
        matches!(self.course.uses[at], Use::Contact(_)) && !self.log.in_gap[at]
    }

    fn rmse(&self, fit: &Fit) -> f64 {
        let errors = self.forces(fit).into_iter().enumerate();
        let fitted = errors.filter(|(at, _)| self.is_fitted(*at));
        rms(fitted.map(|(at, force)| self.log.force_n[at] - force))
    }

    fn columns(&self, fit: &Fit) -> Columns {
        let law = natural(fit.family, &fit.free, &self.course.scales);
        let mut touched = vec![false; self.log.len()];
        for touch in &self.course.touches {
            touched[touch.clone()].fill(true);
        }
        let forces = self.forces(fit).into_iter().zip(&touched);
        let positions = self.motion.position_m.iter();
        Columns {
            depth_m: positions.map(|x| x - law.surface_m).collect(),
            speed_mps: self.motion.speed_mps.clone(),
            measured_n: self.log.force_n.iter().map(|f| f - law.offset_n).collect(),
            estimated_n: forces
                .map(|(force, touched)| {
                    if *touched {
                        force - law.offset_n
                    } else {
                        f64::NAN
                    }
                })
                .collect(),
            used: (0..self.log.len()).map(|at| self.is_fitted(at)).collect(),
        }
    }

    fn elastic(&self, fit: &Fit) -> (Vec<f64>, Vec<f64>) {
        let law = natural(fit.family, &fit.free, &self.course.scales);
        let deepest = self.course.scales.touch_m + self.course.scales.depth_m - law.surface_m;
        let depths = (0..=CURVE_POINTS).map(|i| deepest * i as f64 / CURVE_POINTS as f64);
        let depths: Vec<f64> = depths.collect();
        let forces = depths.iter().map(|depth| law.elastic_n(*depth)).collect();
        (depths, forces)
    }

    /// E with the indenter's own exponent: fitted again unless the law has that one anyway.
    pub(super) fn modulus(
        &self,
        best: &Candidate,
        indenter: Indenter,
        poisson: f64,
        fixed: Fixed,
    ) -> Option<Modulus> {
        let exponent = indenter.exponent();
        let family = match best.fit.family {
            Family::KELVIN_VOIGT if exponent != 1.0 => Family::HUNT_CROSSLEY,
            Family::ZENER if exponent != 1.0 => Family::quasi_linear(1),
            family => family,
        };
        let fixed = Fixed {
            exponent: Some(exponent),
            ..fixed
        };
        let again = candidates(self.course, &[family], fixed).pop()?;
        let stay = fixed.of(family);
        let problem = self.problem(&again, &stay);
        let covariance = problem.covariance(&again.fit.free);
        let values = problem.reported(&again.fit.free, &covariance, self.reference_depth_m);
        let stiffness = values.first()?;
        let value = indenter.youngs_modulus(stiffness.value, self.reference_depth_m, poisson);
        let law = natural(family, &again.fit.free, &self.course.scales);
        let relaxes: f64 = law.modes.iter().map(|mode| mode.fraction).sum();
        Some(Modulus {
            value: Estimated {
                value,
                std_error: value * stiffness.std_error / stiffness.value,
            },
            relaxed_pa: (family.modes > 0).then_some(value * (1.0 - relaxes)),
            indenter: indenter.name(),
            poisson,
            exponent_assumed: exponent,
            force_rmse_n: self.rmse(&again.fit),
        })
    }
}

/// Modes fast to slow, as everywhere.
fn sorted(family: Family, mut parameters: Vec<Parameter>) -> Vec<Parameter> {
    let modes = family.listed_modes();
    let rate = |pair: &[Parameter]| pair[1].estimate.map_or(0.0, |rate| rate.value);
    let first = family.law.info().parameters.len();
    let of_modes = first..first + 2 * modes;
    let mut pairs: Vec<Vec<Parameter>> = parameters[of_modes.clone()]
        .chunks(2)
        .map(<[Parameter]>::to_vec)
        .collect();
    pairs.sort_by(|a, b| rate(b).total_cmp(&rate(a)));
    for (parameter, value) in parameters[of_modes].iter_mut().zip(pairs.concat()) {
        parameter.estimate = value.estimate;
    }
    parameters
}
