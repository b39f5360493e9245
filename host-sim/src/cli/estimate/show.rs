//! An estimation as the report wants it: columns in double precision, time without the delay.

use std::io;
use std::path::Path;

use estimator_core::estimate::{Estimated, Parameters, Phase};
use estimator_core::physics::law::{LawKind, ParameterInfo, RelaxingLaw};
use estimator_core::{Estimate, Status};

use crate::estimate::{
    Estimation,
    explain::times,
    outcome::{Outcome, law_with},
};
use crate::log::UniformLog;
use crate::model::law_title;
use crate::replay::{EventMark, Touch};
use crate::report::{Document, Input, Provenance, Tone, estimate as report};

/// Points of the elastic curve.
const CURVE_POINTS: usize = 200;

/// A parameter over time.
type Trajectory = (&'static ParameterInfo, Vec<Option<Estimated<f64>>>);

/// The columns of one estimation; what the report borrows.
#[derive(Clone, Debug)]
pub struct Shown {
    name: String,
    law: &'static str,
    status: Status,
    time_s: Vec<f64>,
    depth_m: Vec<f64>,
    speed_mps: Vec<f64>,
    measured_n: Vec<f64>,
    estimated_n: Vec<f64>,
    innovation_n: Vec<f64>,
    forgetting: Vec<f64>,
    statuses: Vec<Status>,
    trajectories: Vec<Trajectory>,
    finals: Vec<report::FinalParameter<'static>>,
    segments: Vec<(f64, f64, Vec<report::FinalParameter<'static>>)>,
    touches: Vec<Touch>,
    events: Vec<EventMark>,
    elastic: (Vec<f64>, Vec<f64>, Vec<f64>),
    forgetting_law: report::ForgettingLaw,
    force_rmse_n: Option<f64>,
    settled_at_s: Option<f64>,
    reference_depth_m: f64,
    noise_n: f64,
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
fn measured(log: &UniformLog, rest_n: &[f32], count: usize) -> Vec<f64> {
    let rest = &rest_n[rest_n.len() - count..];
    let pairs = log.force_n.iter().zip(rest);
    pairs
        .map(|(force, rest)| force - f64::from(*rest))
        .collect()
}

/// The force of the law, in contact only.
fn estimated(outcome: &Outcome, delay: usize, records: &[Estimate<f32>]) -> Vec<f64> {
    let replayed = outcome.replayed_n.iter().skip(delay).zip(records);
    replayed
        .map(|(force, record)| match record.phase {
            Phase::Contact => f64::from(*force),
            _ => f64::NAN,
        })
        .collect()
}

fn trajectories(law: LawKind, records: &[Estimate<f32>]) -> Vec<Trajectory> {
    let slots = law.parameters().iter().enumerate();
    slots
        .map(|(slot, info)| {
            let values = records
                .iter()
                .map(|record| record.parameters[slot].map(wide));
            (info, values.collect())
        })
        .collect()
}

impl Shown {
    /// Collects the columns. Force and depth are the raw force and the smoothed depth of the same
    /// instant.
    pub fn new(name: &str, log: &UniformLog, estimation: &Estimation) -> Shown {
        let (replay, outcome) = (&estimation.replay, &estimation.outcome);
        let records = &replay.records[replay.delay.min(replay.records.len())..];
        let column = |of: &dyn Fn(&Estimate<f32>) -> f32| -> Vec<f64> {
            records.iter().map(|record| f64::from(of(record))).collect()
        };
        let (alpha_1, alpha_2, alpha_3) = replay.params.alphas(replay.noise_n as f32);
        Shown {
            name: name.into(),
            law: outcome.law.name(),
            status: outcome.status,
            time_s: (0..records.len())
                .map(|i| replay.time_s(i + replay.delay))
                .collect(),
            depth_m: column(&|record| record.depth_m),
            speed_mps: column(&|record| record.speed_mps),
            measured_n: measured(log, &replay.rest_n, records.len()),
            estimated_n: estimated(outcome, replay.delay, records),
            innovation_n: column(&|record| record.innovation.innovation_n),
            forgetting: column(&|record| record.forgetting),
            statuses: records.iter().map(|record| record.status).collect(),
            trajectories: trajectories(outcome.law, records),
            finals: finals(estimation, &outcome.parameters),
            segments: outcome
                .segments
                .iter()
                .map(|s| (s.from_s, s.to_s, finals(estimation, &s.parameters)))
                .collect(),
            touches: outcome.touches.clone(),
            events: outcome.events.clone(),
            elastic: elastic(estimation),
            forgetting_law: report::ForgettingLaw {
                alpha_1: alpha_1.into(),
                alpha_2_per_n: alpha_2.into(),
                alpha_3_n: alpha_3.into(),
            },
            force_rmse_n: outcome.force_rmse_n,
            settled_at_s: outcome.settled_at_s,
            reference_depth_m: f64::from(replay.config.reference.depth_m),
            noise_n: estimation.inspection.noise_n,
            notes: estimation.notes.clone(),
        }
    }

    /// Adds the true elastic force of a simulated rig at the depths of the curve.
    pub fn with_true_elastic(mut self, force_n: impl Fn(f64) -> f64) -> Shown {
        self.elastic.2 = self.elastic.0.iter().map(|depth| force_n(*depth)).collect();
        self
    }

    /// One sentence: what was found and whether to trust it.
    pub fn verdict(&self) -> String {
        let name = if self.name.is_empty() {
            String::new()
        } else {
            format!("{}: ", self.name)
        };
        let law = law_title(self.law);
        match (self.status, self.force_rmse_n) {
            (Status::NoContact, _) => format!("{name}nothing was touched."),
            (_, None) => format!("{name}the contact does not tell the parameters of {law}."),
            (status, Some(rmse)) => {
                let multiple = rmse / self.noise_n;
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

    fn tone(&self) -> Tone {
        match self.status {
            Status::Converged => Tone::Good,
            Status::ModelSuspect => Tone::Bad,
            Status::NoContact => Tone::Neutral,
            _ => Tone::Warning,
        }
    }
}

/// Depths (m), estimated elastic forces (N), and room for the true ones.
fn elastic(estimation: &Estimation) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
    let outcome = &estimation.outcome;
    let reference = f64::from(estimation.replay.config.reference.depth_m);
    let deepest = outcome
        .touches
        .iter()
        .map(|touch| touch.peak_depth_m)
        .fold(0.0, f64::max);
    let Some(law) = law_with(outcome.law, &outcome.parameters, reference) else {
        return Default::default();
    };
    let depths = (0..=CURVE_POINTS).map(|i| deepest * i as f64 / CURVE_POINTS as f64);
    let depths: Vec<f64> = depths.collect();
    let forces = depths.iter().map(|depth| law.elastic_n(*depth)).collect();
    (depths, forces, Vec::new())
}

/// The report of one or several estimations; `inputs` are the files that they were made from.
///
/// # Errors
/// If an input cannot be read again for its hash.
pub fn document(shown: &[Shown], title: &str, inputs: &[&Path]) -> io::Result<Document> {
    let with_trajectories: Vec<Vec<report::Trajectory>> = shown
        .iter()
        .map(|one| {
            let all = one.trajectories.iter();
            all.map(|(info, values)| report::Trajectory {
                name: info.name,
                unit: info.unit.symbol(),
                values,
            })
            .collect()
        })
        .collect();
    let with_segments: Vec<Vec<report::Segment>> = shown
        .iter()
        .map(|one| {
            let all = one.segments.iter();
            all.map(|(from_s, to_s, parameters)| report::Segment {
                from_s: *from_s,
                to_s: *to_s,
                parameters,
            })
            .collect()
        })
        .collect();
    let parts = shown.iter().zip(&with_trajectories).zip(&with_segments);
    let runs: Vec<report::Run> = parts
        .map(|((one, trajectories), segments)| one.run(trajectories, segments))
        .collect();
    let verdict: Vec<String> = shown.iter().map(Shown::verdict).collect();
    let notes: Vec<String> = shown.iter().flat_map(|one| one.notes.clone()).collect();
    let badge = shown
        .first()
        .map_or("nothing", |one| one.status.name())
        .replace('_', " ");
    let report = report::EstimateReport {
        title,
        tone: shown.first().map_or(Tone::Neutral, Shown::tone),
        badge: &badge,
        verdict: &verdict.join(" "),
        runs: &runs,
        notes: &notes,
        provenance: provenance(inputs)?,
    };
    Ok(report.document())
}

fn provenance(inputs: &[&Path]) -> io::Result<Provenance> {
    let command: Vec<String> = std::env::args().skip(1).collect();
    let mut provenance = Provenance::new(format!("palpate {}", command.join(" ")).trim_end());
    for path in inputs {
        provenance = provenance.input(Input::of_file(path)?);
    }
    Ok(provenance)
}

impl Shown {
    fn run<'a>(
        &'a self,
        parameters: &'a [report::Trajectory<'a>],
        segments: &'a [report::Segment<'a>],
    ) -> report::Run<'a> {
        let (depth_m, estimated_n, true_n) = &self.elastic;
        report::Run {
            name: &self.name,
            law: self.law,
            time_s: &self.time_s,
            depth_m: &self.depth_m,
            speed_mps: &self.speed_mps,
            measured_n: &self.measured_n,
            estimated_n: &self.estimated_n,
            innovation_n: &self.innovation_n,
            forgetting: &self.forgetting,
            status: &self.statuses,
            noise_n: Some(self.noise_n),
            forgetting_law: Some(self.forgetting_law),
            parameters,
            finals: &self.finals,
            segments,
            touches: &self.touches,
            events: &self.events,
            elastic: (!depth_m.is_empty()).then_some(report::Elastic {
                depth_m,
                estimated_n,
                true_n,
            }),
            force_rmse_n: self.force_rmse_n,
            settled_at_s: self.settled_at_s,
            reference_depth_m: Some(self.reference_depth_m),
        }
    }
}
