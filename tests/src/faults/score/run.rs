//! What `palpate estimate --law hunt_crossley` says of a log, sample by sample.

use crate::faults::rig::case::Case;
use crate::faults::rig::sensors::Rows;
use estimator_core::estimate::{Event, method::Method};
use estimator_core::{Config, Estimate, Status};
use palpate::estimate::{Choices, Estimation, estimate};
use palpate::log::Log;
use palpate::replay::EventKind;

/// Parameters that are judged: stiffness, damping, exponent.
pub const JUDGED: usize = 3;

/// What is said at one moment.
#[derive(Clone, Copy, Debug)]
pub struct Said {
    /// The instant that it describes (s).
    pub time_s: f64,
    /// Whether the estimate calls itself converged.
    pub converged: bool,
    /// The depth (m) at which K and λ hold: shallow logs are estimated at one that they reach.
    pub depth_m: f64,
    /// K (N/m), λ (N s/m), n, each with its standard error; `None` while one is not known.
    pub parameters: Option<[(f64, f64); JUDGED]>,
}

/// A remark that something is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Flag {
    /// The status `model_suspect`.
    Suspect,
    /// The event `material_change`.
    Change,
    /// An event `fault`.
    Fault,
}

/// The answer to a log.
#[derive(Clone, Debug)]
pub struct Answer {
    /// Sample by sample.
    pub said: Vec<Said>,
    /// All remarks, with their times (s).
    pub flags: Vec<(f64, Flag)>,
    /// The status in `estimate.json`.
    pub status: Status,
}

/// The answer of the library to a case, by the way of the verb `estimate`; the error of a log that is
/// refused.
pub fn answer(case: &Case) -> Result<Answer, String> {
    let uniform = log(&case.rows).uniform().map_err(|e| e.to_string())?;
    let methods = [Method::HUNT_CROSSLEY_BANK];
    let estimation = estimate(&uniform, Config::default(), &methods, Choices::default());
    Ok(Answer::of(&estimation.map_err(|e| e.to_string())?))
}

pub(super) fn log(rows: &Rows) -> Log {
    let Rows {
        time_s,
        position_m,
        force_n,
    } = rows.clone();
    Log::from_channels(time_s, position_m, force_n)
}

impl Answer {
    fn of(estimation: &Estimation) -> Answer {
        let replay = &estimation.replay;
        let records = replay.records.iter().enumerate();
        let depth_m = f64::from(replay.config.reference.depth_m);
        let said = records
            .clone()
            .map(|(index, record)| said(replay.time_s(index), &record, depth_m));
        let mut flags: Vec<(f64, Flag)> = Vec::new();
        let mut before = Status::NoContact;
        for (index, record) in records {
            let entered = record.status == Status::ModelSuspect && before != Status::ModelSuspect;
            before = record.status;
            if entered {
                flags.push((replay.raw_time_s(index), Flag::Suspect));
            }
            if record.event == Some(Event::MaterialChange) {
                flags.push((replay.raw_time_s(index), Flag::Change));
            }
        }
        let events = estimation.outcome.events.iter();
        let faults = events.filter(|event| matches!(event.kind, EventKind::Fault { .. }));
        flags.extend(faults.map(|event| (event.time_s, Flag::Fault)));
        flags.sort_by(|a, b| a.0.total_cmp(&b.0));
        Answer {
            said: said.collect(),
            flags,
            status: estimation.outcome.status,
        }
    }
}

fn said(time_s: f64, record: &Estimate<f32>, depth_m: f64) -> Said {
    let parameter = |slot: usize| {
        let parameter = record.parameters[slot]?;
        Some((f64::from(parameter.value), f64::from(parameter.std_error)))
    };
    let parameters = || Some([parameter(0)?, parameter(1)?, parameter(2)?]);
    Said {
        time_s,
        converged: record.status == Status::Converged,
        depth_m,
        parameters: parameters(),
    }
}
