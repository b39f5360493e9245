//! From a minimum to a result: parameters with names, columns, the elastic curve, the modulus.

use estimator_core::Status;
use estimator_core::estimate::Estimated;
use estimator_core::physics::law::LawId;

use super::touch;
use super::{
    blocks::Node, blocks::Use, course::Course, course::long_ago, family::Family, family::OFFSET,
    family::SURFACE, filtered::Filtered, fit::Fit, fit::Problem, natural::natural, result::Batch,
    result::Columns, result::Parameter, result::Tried, select::Candidate, select::Fixed,
};
use crate::estimate::{Lateness, NOISE_ALONE, touches::Departure};
use crate::kinematics::Kinematics;
use crate::log::UniformLog;
use crate::stats::{lowest, rms};

/// Points of the elastic curve.
const CURVE_POINTS: usize = 200;

/// A surface is tried so much farther out, of the depth; it is known if that adds this to Σ w r²: three standard errors.
const FARTHER: f64 = 0.5;
const TOLD: f64 = 9.0;

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
    /// Where the force leaves its baseline, if the log shows it.
    pub(super) departure: Option<Departure>,
    /// How late the force is, if the motion is that of so much earlier.
    pub(super) late: Option<Lateness>,
    /// Which low-pass the force went through, if the course is that of a force behind it.
    pub(super) filtered: Option<Filtered>,
}

/// Bends that hide something are at most this share of the samples: of steps under force control they were 0.5 to 3 %.
const FEW_BENDS: f64 = 0.05;

impl Given<'_> {
    pub(super) fn problem<'a>(
        &'a self,
        candidate: &'a Candidate,
        fixed: &'a [usize],
    ) -> Problem<'a> {
        Problem {
            family: candidate.fit.family,
            nodes: &self.course.nodes,
            weights: &candidate.weights,
            scales: &self.course.scales,
            fixed,
        }
    }

    /// The smallest score among the laws that leave no more than the rivals of the one that leaves least,
    /// and of which the log tells every relaxation mode: one that is not known to be there is not taken,
    /// unless nothing else comes near.
    pub(super) fn best<'a>(&self, tried: &'a [Candidate], fixed: &Fixed) -> Option<&'a Candidate> {
        let rmses_n: Vec<f64> = tried.iter().map(|own| self.rmse(own)).collect();
        let least = lowest(rmses_n.iter().copied());
        let is_near = |rmse_n: f64| rmse_n <= self.course.thresholds.selection.rival * least;
        let near = tried
            .iter()
            .zip(rmses_n)
            .filter(|(_, rmse_n)| is_near(*rmse_n));
        let mut order: Vec<&Candidate> = near.map(|(own, _)| own).collect();
        order.sort_by(|a, b| a.score.total_cmp(&b.score));
        let told = |candidate: &&&Candidate| {
            let (parameters, ..) = self.estimated(candidate, fixed, 0.0);
            let mut modes = parameters
                .iter()
                .filter(|p| p.name.starts_with("relaxation"));
            modes.all(|mode| mode.estimate.is_some())
        };
        order.iter().find(told).or(order.first()).copied()
    }

    /// The parameters of a candidate.
    pub(super) fn parameters(&self, candidate: &Candidate, fixed: &Fixed) -> Vec<Parameter> {
        let (parameters, ..) = self.estimated(candidate, fixed, 0.0);
        sorted(candidate.fit.family, parameters)
    }

    /// The parameters of a candidate, its misfit, its offset and its skew.
    fn estimated(&self, candidate: &Candidate, fixed: &Fixed, spread_m: f64) -> Estimates {
        let family = candidate.fit.family;
        let stay = fixed.of(family, &self.course.scales);
        let problem = self.problem(candidate, &stay);
        let spread = spread_m / self.course.scales.depth_m;
        let covariance = problem.covariance(&candidate.fit.free);
        let covariance = match stay.contains(&SURFACE) {
            true => covariance,
            false => covariance.widened(SURFACE, spread),
        };
        let covariance = match self.course.begins_in_contact() {
            true => covariance.opened(&problem, &candidate.fit.free, &self.course.begun_just_now()),
            false => covariance,
        };
        let covariance = match self.filtered {
            Some(filtered) => {
                let scales = filtered.moved(&self.course.scales);
                let other = Problem {
                    scales: &scales,
                    ..problem
                };
                covariance.opened_by(&problem, &candidate.fit.free, &other, 1.0)
            }
            None => covariance,
        };
        let mut values = problem.reported(&candidate.fit.free, &covariance, self.reference_depth_m);
        let (skew, offset) = (values.pop(), values.pop());
        let skew = skew.filter(|_| family.skew().is_some() && self.filtered.is_none());
        let mut parameters = self.named(family, &values);
        if !self.shows_surface(&problem, &candidate.fit) {
            let surface = parameters.iter_mut().find(|own| own.name == "surface");
            surface.into_iter().for_each(|own| own.estimate = None);
        }
        (parameters, covariance.misfit, offset, skew)
    }

    pub(super) fn result(
        &self,
        empty: Batch,
        best: &Candidate,
        tried: &[Candidate],
        fixed: &Fixed,
    ) -> Batch {
        let spread_m = self.surface_spread_m(best, tried, empty.noise_n);
        let (parameters, misfit, offset, skew) = self.estimated(best, fixed, spread_m);
        let skew = match (self.late.map(|late| late.late_s), skew) {
            // The error of what the fit adds is that of its prior where the motion tells less.
            (Some(late_s), Some(more)) => Some(Estimated {
                value: late_s.value + more.value,
                std_error: late_s.std_error.max(more.std_error),
            }),
            (late_s, more) => late_s.or(more),
        };
        let columns = self.columns(best);
        let rmse = self.rmse(best);
        let selection = tried.iter().map(|candidate| Tried {
            family: candidate.fit.family,
            parameters: candidate.fit.free.len(),
            force_rmse_n: self.rmse(candidate),
            score: candidate.score,
        });
        let mut batch = Batch {
            family: best.fit.family,
            status: method_status(&best.fit, &parameters),
            parameters: sorted(best.fit.family, parameters),
            offset,
            skew,
            low_pass: self.filtered.map(|own| own.told()),
            force_rmse_n: Some(rmse),
            misfit,
            selection: selection.collect(),
            per_touch: touch::touches(self.course, self.log, best, self.reference_depth_m),
            columns,
            elastic: self.elastic(&best.fit),
            ..empty
        };
        batch.widen_by_faster_modes();
        batch
    }

    /// How far the surface may be off (m) besides what the data of one law say, where the law leaves
    /// more than noise: by as much as its rivals put it elsewhere, and by as much as the law leaves its baseline
    /// elsewhere than the force does.
    fn surface_spread_m(&self, best: &Candidate, tried: &[Candidate], noise_n: f64) -> f64 {
        let least = self.rmse(best);
        if least <= NOISE_ALONE * noise_n {
            return 0.0;
        }
        let at =
            |other: &Candidate| natural(other.fit.family, &other.fit.free, &self.course.scales);
        let own_m = at(best).surface_m;
        let is_rival =
            |other: &&Candidate| self.rmse(other) < self.course.thresholds.selection.rival * least;
        let rivals = tried.iter().filter(is_rival);
        let apart = rivals.map(|other| (at(other).surface_m - own_m).abs());
        apart.fold(self.misplaced_m(&best.fit), f64::max)
    }

    /// Between where the force leaves its baseline and where that of the law does (m).
    fn misplaced_m(&self, fit: &Fit) -> f64 {
        let Some(left) = self.departure else {
            return 0.0;
        };
        let rest_n = natural(fit.family, &fit.free, &self.course.scales).offset_n;
        let forces = self.forces(fit);
        let is_within = |at: &usize| forces[*at] - rest_n <= left.over_n;
        let end = self.course.touches.iter().map(|touch| touch.end);
        let end = end.filter(|end| *end > left.at).min().unwrap_or(left.at);
        let position = |at: usize| self.motion.position_m[at];
        // On the way in the law leaves its baseline once.
        let before = (0..left.at).rev().find(is_within);
        let after = (left.at..end).find(|at| !is_within(at));
        match (is_within(&left.at), before, after) {
            (true, _, Some(after)) => (position(after) - left.to_m).max(0.0),
            (false, Some(before), _) => (left.from_m - position(before)).max(0.0),
            _ => 0.0,
        }
    }

    /// Whether a log in which nothing moves through free air shows where the surface is. That of a force that is linear in
    /// the depth could as well be farther out, with another resting force; samples that were fitted beyond it tell the
    /// difference.
    fn shows_surface(&self, problem: &Problem, fit: &Fit) -> bool {
        let scales = &self.course.scales;
        let is_linear = matches!(fit.family.law, LawId::KelvinVoigt | LawId::Zener);
        if !is_linear || self.course.approaches() || problem.fixed.contains(&SURFACE) {
            return true;
        }
        let law = natural(fit.family, &fit.free, scales);
        let mut farther = fit.free.clone();
        farther[SURFACE] -= FARTHER;
        farther[OFFSET] -= FARTHER * law.stiffness * scales.depth_m / scales.force_n;
        let mut nodes = self.course.nodes.clone();
        long_ago(&mut nodes);
        let problem = Problem {
            nodes: &nodes,
            ..*problem
        };
        problem.cost(&farther) - problem.cost(&fit.free) > TOLD
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
    pub(super) fn forces(&self, fit: &Fit) -> Vec<f64> {
        self.forces_with(fit, &self.motion.speed_mps)
    }

    /// The same at other speeds (m/s).
    fn forces_with(&self, fit: &Fit, speed_mps: &[f64]) -> Vec<f64> {
        let period_s = self.log.period_s();
        let mut nodes: Vec<Node> = (0..self.log.len())
            .map(|at| Node {
                time_s: self.log.time_s[at],
                period_s,
                position_m: self.motion.position_m[at],
                speed_mps: speed_mps[at],
                acceleration_mps2: self.motion.acceleration_mps2[at],
                force_n: self.log.force_n[at],
                count: 1.0,
                held: 1.0,
                used: self.course.uses[at],
            })
            .collect();
        if let Some((first, begun)) = nodes.first_mut().zip(self.course.nodes.first()) {
            first.period_s = begun.period_s;
        }
        let mut forces = Vec::with_capacity(nodes.len());
        let law = natural(fit.family, &fit.free, &self.course.scales);
        law.along(fit.family, &nodes, |_, force| forces.push(force));
        forces
    }

    /// Whether a sample of the log was fitted to in contact, from a time on (s).
    fn is_fitted(&self, at: usize, from_s: f64) -> bool {
        let in_contact = matches!(self.course.uses[at], Use::Contact(_));
        in_contact && self.log.has_force(at) && self.log.time_s[at] >= from_s
    }

    /// What a fit leaves of the raw force where it was fitted (N rms), besides what a few bends hide: a probe that was let
    /// go of within a sample at 100 Hz had half of its speed there, and that one of 1304 samples made 20 mN of 5 mN. Where
    /// bends are many they say something of the law: 35 ± 1.3 N s/m of 30 at 20 Hz.
    pub(super) fn rmse(&self, own: &Candidate) -> f64 {
        let from_s = self.course.counts_from_s(&own.weights);
        let forces = self.forces(&own.fit);
        let fitted: Vec<usize> = (0..self.log.len())
            .filter(|at| self.is_fitted(*at, from_s))
            .collect();
        let hides = |own: &Vec<f64>| {
            let bends = fitted
                .iter()
                .filter(|at| own[**at] > self.course.scales.noise_n);
            bends.count() as f64 <= FEW_BENDS * fitted.len() as f64
        };
        let hidden = self.hidden_n(&own.fit, &forces).filter(hides);
        rms(fitted.into_iter().map(|at| {
            let left = (self.log.force_n[at] - forces[at]).abs();
            (left - hidden.as_ref().map_or(0.0, |own| own[at])).max(0.0)
        }))
    }

    /// By how much a damper's force may be off at every sample (N) for a speed that three samples do not resolve; `None`
    /// where they resolve it everywhere.
    fn hidden_n(&self, fit: &Fit, forces: &[f64]) -> Option<Vec<f64>> {
        let unresolved = &self.motion.unresolved_mps;
        unresolved.iter().find(|speed| **speed != 0.0)?;
        let both = std::iter::zip(&self.motion.speed_mps, unresolved);
        let faster: Vec<f64> = both.map(|(speed, more)| speed + more).collect();
        let faster = self.forces_with(fit, &faster);
        let off = std::iter::zip(faster, forces).map(|(more, own)| (more - own).abs());
        Some(off.collect())
    }

    fn columns(&self, own: &Candidate) -> Columns {
        let (fit, from_s) = (&own.fit, self.course.counts_from_s(&own.weights));
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
            used: (0..self.log.len())
                .map(|at| self.is_fitted(at, from_s))
                .collect(),
        }
    }

    fn elastic(&self, fit: &Fit) -> (Vec<f64>, Vec<f64>) {
        let law = natural(fit.family, &fit.free, &self.course.scales);
        let deepest = self.course.scales.touch_m + self.course.scales.depth_m - law.surface_m;
        let depths = (0..=CURVE_POINTS).map(|i| deepest * i as f64 / CURVE_POINTS as f64);
        let depths: Vec<f64> = depths.collect();
        let forces = depths
            .iter()
            .map(|depth| law.elastic_n(fit.family, *depth))
            .collect();
        (depths, forces)
    }
}

/// Whether the fit itself has come to an end, and with which parameters.
fn method_status(fit: &Fit, parameters: &[Parameter]) -> Status {
    if parameters.iter().any(|own| own.estimate.is_none()) {
        Status::Unobservable
    } else if fit.converged {
        Status::Converged
    } else {
        Status::Converging
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
