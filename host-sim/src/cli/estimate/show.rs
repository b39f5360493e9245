//! An estimation as the report wants it: columns in double precision, time without the delay.

use std::io;
use std::path::Path;

use estimator_core::estimate::{Estimated, Parameters, Phase};
use estimator_core::physics::law::{ParameterInfo, RelaxingLaw};
use estimator_core::{Estimate, Status};

use super::thin;
use crate::estimate::{
    Estimation, Reason,
    explain::multiple,
    outcome::{Outcome, Segment, law_with},
    trust_in_words,
};
use crate::log::UniformLog;
use crate::model::law_title;
use crate::replay::Replay;
use crate::report::estimate::{self as report, Column};
use crate::report::{Document, Input, Provenance, Tone};

/// Points of the elastic curve.
const CURVE_POINTS: usize = 200;

/// One estimation as the report has it, and what is said of it.
#[derive(Clone, Debug)]
pub struct Shown {
    run: report::Run<'static>,
    status: Status,
    reason: Option<Reason>,
    notes: Vec<String>,
}

pub(super) fn wide(estimate: Estimated<f32>) -> Estimated<f64> {
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
            truth: None,
        })
        .collect()
}

/// The records that are shown, each with its number; the first that describes a sample comes first.
struct Rows<'a> {
    log: &'a UniformLog,
    replay: &'a Replay,
    outcome: &'a Outcome,
    rows: Vec<(usize, Estimate<f32>)>,
    is_thinned: bool,
}

impl<'a> Rows<'a> {
    fn of(log: &'a UniformLog, estimation: &'a Estimation) -> Rows<'a> {
        let (replay, outcome) = (&estimation.replay, &estimation.outcome);
        let mut rows = Rows {
            log,
            replay,
            outcome,
            rows: Vec::new(),
            is_thinned: false,
        };
        let from = replay.delay.min(replay.records.len());
        let curves = |index: usize, record: &Estimate<f32>| {
            let parameter = |slot: usize| {
                let own = record.parameters.get(slot).copied().flatten();
                own.map_or(f64::NAN, |own| f64::from(own.value))
            };
            let (measured, estimated) = (rows.measured(index), rows.estimated(index, record));
            [
                measured,
                estimated,
                measured - estimated,
                f64::from(record.depth_m),
                f64::from(record.innovation.innovation_n),
                f64::from(record.forgetting),
                parameter(0),
                parameter(1),
                parameter(2),
                parameter(3),
            ]
        };
        rows.rows = match thin::kept(replay, from, &outcome.touches, curves) {
            Some(kept) => {
                rows.is_thinned = true;
                kept.into_iter()
                    .map(|at| (at, replay.records.at(at)))
                    .collect()
            }
            None => {
                let all = from..replay.records.len();
                all.clone().zip(replay.records.range(all)).collect()
            }
        };
        rows
    }

    /// Force (N) of the sample that a record describes, without what the load cell shows at rest.
    fn measured(&self, index: usize) -> f64 {
        let sample = index - self.replay.delay;
        self.log.force_n[sample] - f64::from(self.replay.rest_n[index])
    }

    /// Force (N) of the law, in contact only.
    fn estimated(&self, index: usize, record: &Estimate<f32>) -> f64 {
        match record.phase {
            Phase::Contact => f64::from(self.outcome.replayed_n[index]),
            _ => f64::NAN,
        }
    }

    fn column(&self, of: impl Fn(usize, &Estimate<f32>) -> f64) -> Column<'static> {
        self.rows
            .iter()
            .map(|(at, record)| of(*at, record))
            .collect()
    }

    fn trajectories(&self) -> Vec<report::Trajectory<'static>> {
        let slots = self.outcome.law.parameters().iter().enumerate();
        let trajectory = |(slot, info): (usize, &ParameterInfo)| report::Trajectory {
            name: info.name,
            unit: info.unit.symbol(),
            values: self
                .rows
                .iter()
                .map(|(_, record)| record.parameters[slot].map(wide))
                .collect(),
        };
        slots.map(trajectory).collect()
    }

    /// Of a log that is not shown whole the means of the residual over equal stretches, which the samples that are
    /// shown no longer tell: times (s) and means (N).
    fn mean_residual(&self) -> Option<(Column<'static>, Column<'static>)> {
        if !self.is_thinned {
            return None;
        }
        let (from, count) = (self.replay.delay, self.replay.records.len());
        let length = thin::stretch_len(count - from);
        let mut is_contact = vec![false; count];
        for contact in self.replay.contacts() {
            is_contact[contact].fill(true);
        }
        let means = (from..count).step_by(length).map(|start| {
            let stretch = start..(start + length).min(count);
            let (mut sum, mut samples) = (0.0, 0.0);
            for at in stretch.filter(|at| is_contact[*at]) {
                sum += self.measured(at) - f64::from(self.outcome.replayed_n[at]);
                samples += 1.0;
            }
            (self.replay.time_s(start + length / 2), sum / samples)
        });
        let (times_s, means_n): (Vec<f64>, Vec<f64>) = means.unzip();
        Some((times_s.into(), means_n.into()))
    }
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
    /// Collects the columns; of a long log those samples that the figures need. Force and depth are the raw
    /// force and the smoothed depth of the same instant.
    pub fn new(name: &'static str, log: &UniformLog, estimation: &Estimation) -> Shown {
        let (replay, outcome) = (&estimation.replay, &estimation.outcome);
        let rows = Rows::of(estimation.log(log), estimation);
        let (alpha_1, alpha_2, alpha_3) = replay.params.alphas(replay.noise_n as f32);
        let run = report::Run {
            name,
            law: outcome.law.name(),
            time_s: rows.column(|at, _| replay.time_s(at)),
            depth_m: rows.column(|_, record| record.depth_m.into()),
            speed_mps: rows.column(|_, record| record.speed_mps.into()),
            measured_n: rows.column(|at, _| rows.measured(at)),
            estimated_n: rows.column(|at, record| rows.estimated(at, record)),
            innovation_n: rows.column(|_, record| record.innovation.innovation_n.into()),
            mean_residual: rows.mean_residual(),
            forgetting: rows.column(|_, record| record.forgetting.into()),
            status: rows.rows.iter().map(|(_, record)| record.status).collect(),
            noise_n: Some(replay.noise_n),
            forgetting_law: Some(report::ForgettingLaw {
                alpha_1: alpha_1.into(),
                alpha_2_per_n: alpha_2.into(),
                alpha_3_n: alpha_3.into(),
            }),
            parameters: rows.trajectories(),
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
            reason: outcome.reason,
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

    /// Adds the true values of the parameters that a simulated rig knows, by name.
    pub fn with_truth(mut self, truths: &[(&str, f64)]) -> Shown {
        for own in &mut self.run.finals {
            let known = truths.iter().find(|(name, _)| *name == own.name);
            own.truth = known.map(|(_, truth)| *truth);
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
            (_, None) => format!("{name}the data do not determine the parameters of {law}."),
            (status, Some((rmse, noise))) => {
                let trust = trust_in_words(status, self.reason, rmse / noise);
                format!(
                    "{name}{law} {trust}; in contact the residual is {} the noise.",
                    multiple(rmse / noise)
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
