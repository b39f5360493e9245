//! An estimation as the report wants it: columns in double precision, time without the delay.

use std::io;
use std::path::Path;

use estimator_core::estimate::{Estimated, Parameters, Phase};
use estimator_core::physics::law::{LawKind, ParameterInfo, RelaxingLaw};
use estimator_core::{Estimate, Status};

use crate::estimate::{
    Estimation,
    explain::times,
    outcome::{Outcome, Segment, law_with},
};
use crate::log::UniformLog;
use crate::model::law_title;
use crate::report::estimate::{self as report, Column};
use crate::report::{Document, Input, Provenance, Tone};

/// Points of the elastic curve.
const CURVE_POINTS: usize = 200;

/// One estimation as the report has it, and what is said of it.
#[derive(Clone, Debug)]
pub struct Shown {
    run: report::Run<'static>,
    status: Status,
    notes: Vec<String>,
}

fn wide(estimate: Estimated<f32>) -> Estimated<f64> {
    Estimated {
        value: estimate.value.into(),
        std_error: estimate.std_error.into(),
    }
}

fn finals(
    estimation: &Estimation,
    parameters: &Parameters<f32>,
) -> Vec<report::FinalParameter<'static>> {
    let named = estimation.outcome.named(parameters);
    named
        .map(|(info, estimate)| report::FinalParameter {
            name: info.name,
            unit: info.unit.symbol(),
            estimate: estimate.map(wide),
        })
        .collect()
}

/// The last `count` readings of the force without what the load cell shows at rest.
fn measured(log: &UniformLog, rest_n: &[f32], count: usize) -> Column<'static> {
    let rest = &rest_n[rest_n.len() - count..];
    let pairs = log.force_n.iter().zip(rest);
    pairs
        .map(|(force, rest)| force - f64::from(*rest))
        .collect()
}

/// The force of the law, in contact only.
fn estimated(outcome: &Outcome, delay: usize, records: &[Estimate<f32>]) -> Column<'static> {
    let replayed = outcome.replayed_n.iter().skip(delay).zip(records);
    replayed
        .map(|(force, record)| match record.phase {
            Phase::Contact => f64::from(*force),
            _ => f64::NAN,
        })
        .collect()
}

fn trajectories(law: LawKind, records: &[Estimate<f32>]) -> Vec<report::Trajectory<'static>> {
    let slots = law.parameters().iter().enumerate();
    let trajectory = |(slot, info): (usize, &ParameterInfo)| report::Trajectory {
        name: info.name,
        unit: info.unit.symbol(),
        values: records
            .iter()
            .map(|record| record.parameters[slot].map(wide))
            .collect(),
    };
    slots.map(trajectory).collect()
}

fn segments(estimation: &Estimation) -> Vec<report::Segment<'static>> {
    let segments = estimation.outcome.segments.iter();
    let segment = |segment: &Segment| report::Segment {
        from_s: segment.from_s,
        to_s: segment.to_s,
        parameters: finals(estimation, &segment.parameters),
    };
    segments.map(segment).collect()
}

impl Shown {
    /// Collects the columns. Force and depth are the raw force and the smoothed depth of the same
    /// instant.
    pub fn new(name: &'static str, log: &UniformLog, estimation: &Estimation) -> Shown {
        let (replay, outcome) = (&estimation.replay, &estimation.outcome);
        let log = estimation.log(log);
        let records = &replay.records[replay.delay.min(replay.records.len())..];
        let column = |of: &dyn Fn(&Estimate<f32>) -> f32| -> Column<'static> {
            records.iter().map(|record| f64::from(of(record))).collect()
        };
        let (alpha_1, alpha_2, alpha_3) = replay.params.alphas(replay.noise_n as f32);
        let run = report::Run {
            name,
            law: outcome.law.name(),
            time_s: (0..records.len())
                .map(|i| replay.time_s(i + replay.delay))
                .collect(),
            depth_m: column(&|record| record.depth_m),
            speed_mps: column(&|record| record.speed_mps),
            measured_n: measured(log, &replay.rest_n, records.len()),
            estimated_n: estimated(outcome, replay.delay, records),
            innovation_n: column(&|record| record.innovation.innovation_n),
            forgetting: column(&|record| record.forgetting),
            status: records.iter().map(|record| record.status).collect(),
            noise_n: Some(estimation.inspection.noise_n),
            forgetting_law: Some(report::ForgettingLaw {
                alpha_1: alpha_1.into(),
                alpha_2_per_n: alpha_2.into(),
                alpha_3_n: alpha_3.into(),
            }),
            parameters: trajectories(outcome.law, records),
            finals: finals(estimation, &outcome.parameters),
            segments: segments(estimation),
            touches: outcome.touches.clone().into(),
            events: outcome.events.clone().into(),
            elastic: elastic(estimation),
            force_rmse_n: outcome.force_rmse_n,
            settled_at_s: outcome.settled_at_s,
            reference_depth_m: Some(f64::from(replay.config.reference.depth_m)),
        };
        Shown {
            run,
            status: outcome.status,
            notes: estimation.notes.clone(),
        }
    }

    /// Adds the true elastic force of a simulated rig at the depths of the curve.
    pub fn with_true_elastic(mut self, force_n: impl Fn(f64) -> f64) -> Shown {
        if let Some(elastic) = &mut self.run.elastic {
            elastic.true_n = elastic
                .depth_m
                .iter()
                .map(|depth| force_n(*depth))
                .collect();
        }
        self
    }

    /// One sentence: what was found and whether to trust it.
    pub fn verdict(&self) -> String {
        let name = match self.run.name {
            "" => String::new(),
            name => format!("{name}: "),
        };
        let law = law_title(self.run.law);
        match (self.status, self.run.force_rmse_n.zip(self.run.noise_n)) {
            (Status::NoContact, _) => format!("{name}nothing was touched."),
            (_, None) => format!("{name}the contact does not tell the parameters of {law}."),
            (status, Some((rmse, noise))) => {
                let multiple = rmse / noise;
                let trust = match status {
                    Status::Converged if multiple < 3.0 => "explains the force",
                    Status::Converged => "has settled, but leaves a misfit",
                    Status::ModelSuspect => "does not explain the force",
                    _ => "has not settled",
                };
                format!(
                    "{name}{law} {trust}: {} the noise remain in contact.",
                    times(multiple)
                )
            }
        }
    }
}

/// How good the news of a status is.
pub(super) fn tone(status: Status) -> Tone {
    match status {
        Status::Converged => Tone::Good,
        Status::ModelSuspect => Tone::Bad,
        Status::NoContact => Tone::Neutral,
        _ => Tone::Warning,
    }
}

/// The estimated elastic force down to the deepest press, if there is one.
fn elastic(estimation: &Estimation) -> Option<report::Elastic<'static>> {
    let outcome = &estimation.outcome;
    let reference = f64::from(estimation.replay.config.reference.depth_m);
    let peaks = outcome.touches.iter().map(|touch| touch.peak_depth_m);
    let deepest = peaks.fold(0.0, f64::max);
    let law = law_with(outcome.law, &outcome.parameters, reference)?;
    let depths = (0..=CURVE_POINTS).map(|i| deepest * i as f64 / CURVE_POINTS as f64);
    let depth_m: Column = depths.collect();
    Some(report::Elastic {
        estimated_n: depth_m.iter().map(|depth| law.elastic_n(*depth)).collect(),
        depth_m,
        true_n: Column::default(),
    })
}

/// The report of one or several estimations; `inputs` are the files that they were made from.
///
/// # Errors
/// If an input cannot be read again for its hash.
pub fn document(shown: Vec<Shown>, title: &str, inputs: &[&Path]) -> io::Result<Document> {
    let verdict: Vec<String> = shown.iter().map(Shown::verdict).collect();
    let notes: Vec<String> = shown.iter().flat_map(|one| one.notes.clone()).collect();
    let first = shown.first().map(|one| one.status);
    let badge = first.map_or("nothing", Status::name).replace('_', " ");
    let runs: Vec<report::Run> = shown.into_iter().map(|one| one.run).collect();
    let report = report::EstimateReport {
        title,
        tone: first.map_or(Tone::Neutral, tone),
        badge: &badge,
        verdict: &verdict.join(" "),
        runs: &runs,
        notes: &notes,
        provenance: provenance(inputs)?,
    };
    Ok(report.document())
}

fn provenance(inputs: &[&Path]) -> io::Result<Provenance> {
    let mut provenance = Provenance::of_this_process();
    for path in inputs {
        provenance = provenance.input(Input::of_file(path)?);
    }
    Ok(provenance)
}
