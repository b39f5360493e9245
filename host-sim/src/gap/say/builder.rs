//! The finding that a decision makes.

use std::ops::Range;

use estimator_core::physics::effect::{EffectId, MOST_PARAMETERS, Role};

use crate::gap::data::fit_data::FitData;
use crate::gap::decide::decision::Decision;
use crate::gap::experiment::advise::advice;
use crate::gap::finding::{
    Candidate, Curves, Finding, Grade, MissingEffect, Pattern, Region, Support, Verdict, changes,
    regions_in_words,
};
use crate::gap::model::{
    dataset::Dataset, error::std_errors, fit::Fit, problem::Problem, shape::Free, shape::Owner,
    simulate::depths, surface_step::SurfaceStep, surface_step::off_by, weights::weights,
    zero_step::ZeroStep,
};
use crate::gap::noise::floors::largest_noise_n;
use crate::gap::options::Options;
use crate::gap::say::{
    estimates::Estimates, gone::gone, left::left, log_residuals::LogResiduals, regions::regions,
};
use crate::gap::search::{evidence::Evidence, relatives::is_another_zero};
use crate::model::{Model, Remainder};
use crate::stats::rms;

/// Builds the finding.
pub(crate) fn finding(
    model: &Model,
    dataset: &Dataset<'_>,
    decision: &Decision,
    ladder: Vec<Candidate>,
    options: &Options,
) -> Finding {
    let weights = weights(&decision.variances);
    let builder = FindingBuilder::new(dataset, decision, dataset.problem(&weights));
    let base_errors = std_errors(&builder.problem, &decision.base);
    let estimates = Estimates::of(&decision.best, &decision.std_errors);
    let remaining = builder.remaining();
    let noise_floor_n = builder.noise_floor_n();
    let base_after = estimates.of_base();
    let decide = &dataset.thresholds.changes;
    let changed = changes(model, &base_after, decide);
    let (gone, replaced) = gone(model, &builder.problem, decision, &estimates, decide.sigmas);
    let mut finding = Finding {
        verdict: decision.verdict,
        rmse_before_n: decision.rmse_n.0,
        rmse_after_n: decision.rmse_n.1,
        noise_floor_n,
        remainder_n: (decision.least_rmse_n.powi(2) - noise_floor_n.powi(2))
            .max(0.0)
            .sqrt(),
        floors: dataset.floors.to_vec(),
        ratio_before: decision.ratio.0,
        ratio_after: decision.ratio.1,
        slow_remainder: decision.slow,
        is_beside_remainder: decision.is_beside_remainder,
        nothing_new: decision.is_beside_remainder && decision.without.is_empty(),
        base_before: Estimates::of(&decision.base, &base_errors).of_base(),
        changed: changed.map(|own| own.with_gone(gone)),
        differs: None,
        base_after,
        disagreement: builder.regions(&builder.before_n, &decision.base),
        remaining,
        advice: String::new(),
        advised: None,
        ladder,
        model: Model {
            // What was allowed for stays the measure: it would grow from log to log.
            remainder: match decision.is_beside_remainder {
                true => model.remainder,
                false => Some(builder.left_or_noise(options.bandwidth_hz)),
            },
            ..estimates.refitted_model(model)
        },
        bandwidth_hz: options.bandwidth_hz,
        curves: builder.curves(),
        notes: [in_words(decision), replaced].concat(),
        surface_off: off_by(&builder.problem, &decision.best),
        episode: None,
        left_out: Vec::new(),
        mistaken: None,
        effects: builder.effects(&estimates),
    };
    (finding.advice, finding.advised) = advice(&finding, dataset, decision);
    finding
}

/// What a force that is earlier than the position may be.
const EARLY: &str = "the force is earlier than the position, which a damper in contact that the model lacks or has too large, \
     or a mount that damps, shows as well as a delay of the position does: this log does not tell them apart";

/// What a decision leaves open, a sentence each.
fn in_words(decision: &Decision) -> Vec<String> {
    let early = decision.may_be_a_damper.then(|| EARLY.into());
    let forms = forms_in_words(&decision.best).into_iter();
    forms.chain(early).collect()
}

/// The forms that effects of the model have taken on, a sentence each. One whose number is at its bound says nothing: a
/// cable that hardens over five times the travel is one that does not.
fn forms_in_words(best: &Fit) -> Vec<String> {
    let terms = best.shape.terms.iter().enumerate();
    let given = terms.filter(|(_, term)| term.given);
    let taken_on = given.flat_map(|(number, term)| {
        let info = term.id.info();
        let places = (0..MOST_PARAMETERS).filter(|at| term.open[*at] && term.free[*at]);
        places.filter_map(move |at| {
            if best.is_at(Owner::Effect(number, at), Free::is_at_bound) {
                return None;
            }
            let Role::Form(plain, _) = info.fits[at].role else {
                return None;
            };
            let (effect, name) = (info.name, info.parameters[at].name);
            Some(format!(
                "{effect} takes a {name} that the model does not give: without one {plain}, and the log says otherwise \
                 (fixed = [\"{name}\"] keeps it out)"
            ))
        })
    });
    taken_on.collect()
}

/// How sure the name of an effect is, and what could stand in its place. At the noise floor the rivals of the
/// set decide, above it the evidence for the effect alone.
fn graded(
    verdict: Verdict,
    evidence: Option<&Evidence>,
    rivals: &[EffectId],
) -> (Grade, Vec<EffectId>) {
    match (verdict, evidence) {
        (Verdict::PartlyExplained, Some(evidence)) => {
            // A lag for a delay names the place, a friction of the drive for a loop of the material does not.
            let place = evidence.id.info().stage;
            let mut others = evidence.alternatives.iter();
            let is_elsewhere = others
                .any(|other| other.info().stage != place || is_another_zero(evidence.id, *other));
            let is_open = is_elsewhere || !evidence.is_strong && evidence.is_strong_group;
            let grade = if is_open { Grade::Open } else { Grade::Strong };
            (grade, evidence.alternatives.clone())
        }
        _ if rivals.is_empty() => (Grade::Certain, Vec::new()),
        _ => (Grade::Open, rivals.to_vec()),
    }
}

/// A decision with the forces and depths that its fits predict.
struct FindingBuilder<'a> {
    problem: Problem<'a>,
    dataset: &'a Dataset<'a>,
    decision: &'a Decision,
    /// Penetrations (m) in the model with the effects, for each log.
    depths: Vec<Vec<f64>>,
    /// Forces (N) of the base model, log after log.
    before_n: Vec<f64>,
    /// Forces (N) of the model with the effects, log after log.
    after_n: Vec<f64>,
}

impl<'a> FindingBuilder<'a> {
    fn new(
        dataset: &'a Dataset<'a>,
        decision: &'a Decision,
        problem: Problem<'a>,
    ) -> FindingBuilder<'a> {
        FindingBuilder {
            problem,
            dataset,
            decision,
            depths: depths(&decision.best.shape, &decision.best.numbers, dataset.logs),
            before_n: problem.forces(&decision.base.shape, &decision.base.numbers),
            after_n: problem.forces(&decision.best.shape, &decision.best.numbers),
        }
    }

    /// The rows of each log in what is stored log after log.
    fn rows(&self) -> Vec<Range<usize>> {
        let mut from = 0;
        let each = self.dataset.logs.iter().map(FitData::len);
        each.map(|len| {
            from += len;
            from - len..from
        })
        .collect()
    }

    /// The missing effects, those that the held-out part needs most first.
    fn effects(&self, estimates: &Estimates<'_>) -> Vec<MissingEffect> {
        let decision = self.decision;
        let added = decision.best.added().into_iter();
        let evaluated = decision
            .alternatives
            .iter()
            .zip(&decision.gains)
            .zip(&decision.without);
        let mut effects: Vec<MissingEffect> = added
            .zip(evaluated)
            .enumerate()
            .map(|(at, (number, ((alternatives, gain), without)))| {
                let forces = self.problem.forces(&without.shape, &without.numbers);
                let id = decision.best.shape.terms[number].id;
                let evidence = decision.evidence_for(number);
                let (grade, alternatives) = match decision.is_spoken_against(at) {
                    // What the rest of the log is foretold worse with is not sure, whatever takes off most.
                    true => (
                        Grade::Open,
                        evidence.map_or(Vec::new(), |own| own.alternatives.clone()),
                    ),
                    false => graded(decision.verdict, evidence, alternatives),
                };
                MissingEffect {
                    id,
                    parameters: estimates.of_effect(number),
                    grade,
                    support: evidence.map_or(Support::default(), |evidence| evidence.support),
                    alternatives,
                    place: self.place(&forces),
                    held_out_gain: *gain,
                }
            })
            .collect();
        effects.sort_by(|a, b| b.held_out_gain.total_cmp(&a.held_out_gain));
        effects
    }

    /// Where the residuals without an effect exceed those with it, in words.
    fn place(&self, without_n: &[f64]) -> String {
        let residuals = self.problem.residuals_of(without_n);
        // What is left with the effect stands for what would be there anyway.
        let with = self.problem.residuals_of(&self.after_n);
        let allowed: Vec<f64> = with
            .iter()
            .zip(&self.decision.variances)
            .map(|(residual, v)| match *v > 0.0 {
                true => v.max(residual.powi(2)),
                false => 0.0,
            })
            .collect();
        regions_in_words(&self.regions_of(&residuals, &allowed))
    }

    /// Where the model with the effects and the log disagree. What is left within the noise is not in
    /// any region.
    fn remaining(&self) -> Vec<Region> {
        match self.decision.verdict.leaves_a_remainder() {
            true => self.regions(&self.after_n, &self.decision.best),
            false => Vec::new(),
        }
    }

    /// Where the forces (N) of a fit disagree with the logs.
    fn regions(&self, forces: &[f64], fit: &Fit) -> Vec<Region> {
        let residuals = self.problem.residuals_of(forces);
        let mut regions = self.regions_of(&residuals, &self.decision.variances);
        if !regions.is_empty() {
            regions.extend(self.steps(fit));
        }
        regions
    }

    /// The steps of the zero and of the surface of the first log that a fit leaves, if they are a good part of it.
    fn steps(&self, fit: &Fit) -> Vec<Region> {
        let log = &self.dataset.logs[0];
        let after = |at: usize| 1.0 - at as f64 / log.len() as f64;
        let region = |id, share, rms_n, samples, pattern| Region {
            id,
            share,
            rms_n,
            samples,
            pattern: Some(pattern),
        };
        let of_zero = ZeroStep::all(&self.problem, fit).into_iter().map(|own| {
            let (s, n, after) = (log.time_s[own.at], own.force_n, after(own.at));
            let pattern = Pattern::Step { s, n };
            region("step", own.share, n.abs() * after.sqrt(), after, pattern)
        });
        let left_n = rms(self.problem.residuals(&fit.shape, &fit.numbers));
        let surface = SurfaceStep::all(&self.problem, fit).into_iter();
        let of_surface = surface.map(|own| {
            let (s, m) = (log.time_s[own.at], own.by_m);
            let pattern = Pattern::SurfaceStep { s, m };
            let made_n = left_n * own.share.sqrt();
            region("surface_step", own.share, made_n, after(own.at), pattern)
        });
        let together = |own: &Vec<Region>| own.iter().map(|own| own.share).sum::<f64>();
        let least = self.decision.thresholds.regions.step_share;
        let both: [Vec<Region>; 2] = [of_zero.collect(), of_surface.collect()];
        let large = both.into_iter().filter(|own| together(own) > least);
        large.flatten().collect()
    }

    fn regions_of(&self, residuals: &[f64], variances: &[f64]) -> Vec<Region> {
        let logs = self.log_residuals(residuals, variances);
        let decide = &self.decision.thresholds.regions;
        regions(&logs, self.decision.correlation, decide)
    }

    /// Residuals (N) and variances (N²) that are stored log after log, for each log.
    fn log_residuals<'b>(
        &'b self,
        residuals: &'b [f64],
        variances: &'b [f64],
    ) -> Vec<LogResiduals<'b>> {
        let rows = self.rows().into_iter();
        let each = rows.zip(self.dataset.logs).zip(&self.depths);
        each.map(|((rows, log), depth_m)| LogResiduals {
            log,
            depth_m,
            residuals: &residuals[rows.clone()],
            variances: &variances[rows],
        })
        .collect()
    }

    /// The noise (N) of the force that was fitted, all logs together.
    fn noise_floor_n(&self) -> f64 {
        let (mut sum, mut count) = (0.0, 0.0);
        for (log, floor) in self.dataset.logs.iter().zip(self.dataset.floors) {
            sum += log.len() as f64 * floor.noise_n().powi(2);
            count += log.len() as f64;
        }
        (sum / count).sqrt()
    }

    /// What the model with the effects leaves beside the noise, or the noise.
    fn left_or_noise(&self, bandwidth_hz: Option<f64>) -> Remainder {
        let left = self.left(bandwidth_hz);
        left.unwrap_or_else(|| self.noise_alone(bandwidth_hz))
    }

    /// What the model with the effects leaves, where that is no noise. A log may be explained and leave some: errors of a
    /// form, which a later log has as well.
    fn left(&self, bandwidth_hz: Option<f64>) -> Option<Remainder> {
        let decision = self.decision;
        let is_noise = decision.is_noise(decision.ratio.1);
        if is_noise && !decision.verdict.leaves_a_remainder() {
            return None;
        }
        let residuals = self.problem.residuals_of(&self.after_n);
        let logs = self.log_residuals(&residuals, &decision.variances);
        let left = left(&logs, self.dataset.floors, decision.correlation)?;
        Some(Remainder {
            bandwidth_hz,
            ..left
        })
    }

    /// The noise, where nothing is left beside it: a later log says that it has grown.
    fn noise_alone(&self, bandwidth_hz: Option<f64>) -> Remainder {
        Remainder {
            rms_n: 0.0,
            by_phase_n: Default::default(),
            noise_n: Some(largest_noise_n(self.dataset.floors)),
            correlation_s: self.dataset.logs[0].period_s,
            bandwidth_hz,
        }
    }

    fn curves(&self) -> Vec<Curves> {
        let rows = self.rows().into_iter();
        let each = rows.zip(self.dataset.logs).zip(&self.depths);
        each.map(|((rows, log), depth_m)| Curves {
            time_s: log.time_s.clone(),
            position_m: log.position_m.clone(),
            speed_mps: log.speed_mps.clone(),
            depth_m: depth_m.clone(),
            measured_n: log.force_n.clone(),
            before_n: self.before_n[rows.clone()].to_vec(),
            after_n: self.after_n[rows.clone()].to_vec(),
            allowed_n: self.decision.variances[rows.clone()]
                .iter()
                .map(|v| v.sqrt())
                .collect(),
            held_out: self.decision.held_out[rows].to_vec(),
        })
        .collect()
    }
}
