//! What a replay comes to: the numbers of `estimate.json`.

use std::ops::Range;

use estimator_core::estimate::identify::method_info;
use estimator_core::estimate::{Estimated, Event, PARAMETER_SLOTS, Parameters, Phase};
use estimator_core::physics::law::{Law, ParameterInfo, RelaxingLaw, unilateral};
use estimator_core::{Faults, LawKind, Status};

use crate::log::UniformLog;
use crate::replay::{EventKind, EventMark, Replay, Touch};
use crate::signal;
use crate::stats::{highest, rms};

/// Settled: every parameter within this share of its final value from then on.
const SETTLED_WITHIN: f64 = 0.05;
/// Samples on either side over which the replay smooths the position: a count of 1 µm then makes a
/// speed of 30 µm/s at 1 kHz, and a touch is over after 5 ms.
const FINE_HALF_WIDTH: usize = 5;

/// A filter that looks further to either side (s) than the board's 8 ms rounds peaks off: then a peak is that of the
/// samples themselves.
const LONGEST_S: f64 = 8.1e-3;

type Record = estimator_core::Estimate<f32>;

/// A stretch of one material.
#[derive(Clone, Debug, PartialEq)]
pub struct Segment {
    /// From its first touch (s).
    pub from_s: f64,
    /// To the change to the next material, or the end (s).
    pub to_s: f64,
    /// The parameters at its end.
    pub parameters: Parameters<f32>,
}

/// What a replay comes to.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// The law.
    pub law: LawKind,
    /// How far the parameters can be trusted at the end.
    pub status: Status,
    /// The parameters at the end, in the order of [`LawKind::parameters`].
    pub parameters: Parameters<f32>,
    /// Raw force against the law with the final parameters, in contact (N rms); `None` without
    /// contact or parameters.
    pub force_rmse_n: Option<f64>,
    /// From first contact until the parameters had settled (s); `None` if they never did, or only for
    /// the last moments of the log (less than the judgement's window).
    pub settled_at_s: Option<f64>,
    /// A stretch per material.
    pub segments: Vec<Segment>,
    /// All touches.
    pub touches: Vec<Touch>,
    /// All events, in order.
    pub events: Vec<EventMark>,
    /// Force of the law with the final parameters at every record (N); 0 in free air.
    pub replayed_n: Vec<f32>,
}

impl Outcome {
    /// Draws the sum of a replay of `log`.
    pub fn of(log: &UniformLog, replay: &Replay) -> Outcome {
        let decisive = decisive(replay);
        let law = decisive.map_or(replay.params.law(), |record| record.law);
        let parameters = decisive.map_or([None; PARAMETER_SLOTS], |record| record.parameters);
        let replayed_n = replay_force(log, replay, law, &parameters);
        Outcome {
            law,
            status: decisive.map_or(Status::NoContact, |record| record.status),
            force_rmse_n: force_rmse(log, replay, &replayed_n),
            settled_at_s: settled_at(replay, law, &parameters),
            segments: segments(replay),
            touches: touches(log, replay),
            events: events(replay),
            parameters,
            replayed_n,
        }
    }

    /// Name, unit and estimate of every parameter of the law.
    pub fn named<'a>(
        &'a self,
        parameters: &'a Parameters<f32>,
    ) -> impl Iterator<Item = (&'static ParameterInfo, Option<Estimated<f32>>)> + 'a {
        self.law.parameters().iter().zip(parameters.iter().copied())
    }

    /// The value of the parameter of that name.
    pub fn value(&self, name: &str) -> Option<Estimated<f32>> {
        self.named(&self.parameters)
            .find(|(info, _)| info.name == name)?
            .1
    }
}

/// The law with a set of parameters, in double precision; `None` while one of them is not known.
pub fn law_with(
    kind: LawKind,
    parameters: &Parameters<f32>,
    reference_depth_m: f64,
) -> Option<Law<f64>> {
    let value = |name: &str| {
        let mut infos = kind.parameters().iter();
        let slot = infos.position(|info| info.name == name)?;
        parameters[slot].map(|p| f64::from(p.value))
    };
    Law::from_values(kind.law(), kind.modes(), value, reference_depth_m)
}

/// The record whose parameters stand for the log: the last one, unless the log ends before a change
/// of material has been learned; then the last one before the change.
fn decisive(replay: &Replay) -> Option<&Record> {
    let last = replay.last()?;
    let learned = !matches!(last.status, Status::Changed | Status::Unobservable);
    let change = replay
        .records
        .iter()
        .rposition(|r| r.event == Some(Event::MaterialChange));
    match change {
        Some(change) if !learned && change > 0 => replay.records.get(change - 1),
        _ => Some(last),
    }
}

/// The law over the log's own motion at the resolution of a few samples: the estimator's window
/// would round off what happens within it. What a law remembers runs on between the touches; a
/// force is due in contact only.
fn replay_force(
    log: &UniformLog,
    replay: &Replay,
    kind: LawKind,
    parameters: &Parameters<f32>,
) -> Vec<f32> {
    let reference_depth_m = f64::from(replay.config.reference.depth_m);
    let mut forces = vec![0.0; replay.records.len()];
    let Some(law) = law_with(kind, parameters, reference_depth_m) else {
        return forces;
    };
    let finds_surface = method_info(replay.config.method).is_some_and(|info| info.finds_surface);
    let found = match finds_surface {
        true => parameters[kind.parameters().len() - 1],
        false => None,
    };
    let mut state = law.at_rest();
    let touched = replay.contacts().first().map_or(usize::MAX, |c| c.start);
    for (index, record) in replay.records.iter().enumerate().skip(touched) {
        let Some(sample) = replay.sample_of(index) else {
            continue;
        };
        let (position_m, speed_mps) =
            signal::parabola(&log.position_m, sample, FINE_HALF_WIDTH, log.period_s());
        let surface_m = found.map_or(replay.surface_m[index], |surface| surface.value);
        let depth_m = position_m - f64::from(surface_m);
        let force_n = law.step(&mut state, depth_m, speed_mps, log.period_s());
        // A material that lags behind its depth lets go of the probe; the chapter saturates the
        // force of its Hammerstein model, and lets its linear one show that it pulls (E2).
        let force_n = match kind.law().info().relaxes {
            true => unilateral(force_n),
            false => force_n,
        };
        if record.phase == Phase::Contact {
            forces[index] = force_n as f32;
        }
    }
    forces
}

/// Over the instants whose whole filter window lies in contact: there the smoothed depth and speed
/// are those of the raw force. Samples with a fault are no measurements.
fn force_rmse(log: &UniformLog, replay: &Replay, replayed_n: &[f32]) -> Option<f64> {
    let memory = 2 * replay.delay + 1;
    let errors = replay.contacts().into_iter().flat_map(|contact| {
        contact.skip(memory).filter_map(|index| {
            let sample = replay.sample_of(index)?;
            let raw = log.force_n[sample] - f64::from(replay.rest_n[index]);
            let measured = replay.records[sample].faults == Faults::NONE;
            measured.then_some(raw - f64::from(replayed_n[index]))
        })
    });
    let errors: Vec<f64> = errors.collect();
    let known = replayed_n.iter().any(|force| *force != 0.0);
    (known && !errors.is_empty()).then(|| rms(errors))
}

/// From the end backward to the last record that is further than 5 % from the end's parameters.
fn settled_at(replay: &Replay, law: LawKind, parameters: &Parameters<f32>) -> Option<f64> {
    // The surface is a place, not a property: a percentage of it means nothing.
    let own = law.parameters().len() - 1;
    let last = parameters[..own]
        .iter()
        .copied()
        .collect::<Option<Vec<_>>>()?;
    let near = |record: &Record| {
        let values = record.parameters[..own].iter().zip(&last);
        record.law == law
            && values.into_iter().all(|(then, end)| {
                then.is_some_and(|then| {
                    f64::from((then.value - end.value).abs())
                        <= SETTLED_WITHIN * f64::from(end.value.abs())
                })
            })
    };
    let first_near = match replay.records.iter().rposition(|record| !near(record)) {
        Some(far) => far + 1,
        None => 0,
    };
    let contact_s = replay.time_s(replay.contacts().first()?.start);
    let stayed_s = (replay.records.len() - first_near) as f64 * replay.period_s;
    let long_enough = stayed_s >= f64::from(replay.config.judgement.window_s);
    long_enough.then(|| replay.time_s(first_near) - contact_s)
}

/// The measured samples of a channel in a contact.
fn measured<'a>(
    log: &'a UniformLog,
    replay: &'a Replay,
    contact: &Range<usize>,
    channel: &'a [f64],
) -> impl Iterator<Item = f64> + 'a {
    let samples = contact.clone();
    let kept = samples.filter(|at| replay.records[*at].faults == Faults::NONE && !log.in_gap[*at]);
    kept.map(|at| channel[at])
}

fn touches(log: &UniformLog, replay: &Replay) -> Vec<Touch> {
    let contacts = replay.contacts().into_iter();
    contacts
        .map(|contact| {
            let records = &replay.records[contact.clone()];
            let peak =
                |of: fn(&Record) -> f32| f64::from(records.iter().map(of).fold(0.0, f32::max));
            let filtered = Touch {
                from_s: replay.raw_time_s(contact.start),
                to_s: replay.raw_time_s(contact.end - 1),
                peak_force_n: peak(|record| record.force_n),
                peak_depth_m: peak(|record| record.depth_m),
            };
            match replay.delay as f64 * replay.period_s > LONGEST_S {
                true => Touch {
                    peak_force_n: highest(measured(log, replay, &contact, &log.force_n))
                        - f64::from(replay.rest_n[contact.start]),
                    peak_depth_m: highest(measured(log, replay, &contact, &log.position_m))
                        - f64::from(replay.surface_m[contact.start]),
                    ..filtered
                },
                false => filtered,
            }
        })
        .collect()
}

fn segments(replay: &Replay) -> Vec<Segment> {
    let Some(first) = replay.contacts().first().map(|contact| contact.start) else {
        return Vec::new();
    };
    let changes = replay.records.iter().enumerate();
    let changes = changes
        .filter(|(_, r)| r.event == Some(Event::MaterialChange))
        .map(|(i, _)| i);
    let mut bounds: Vec<usize> = std::iter::once(first).chain(changes).collect();
    bounds.push(replay.records.len());
    bounds
        .windows(2)
        .map(|pair| Segment {
            from_s: match pair[0] == first {
                true => replay.raw_time_s(first),
                false => replay.time_s(pair[0]),
            },
            to_s: replay.time_s(pair[1] - 1),
            parameters: replay.records[pair[1] - 1].parameters,
        })
        .collect()
}

/// Contacts and changes as they come, faults when they begin. A change is one of the smoothed
/// signals; everything else happens to a raw sample.
fn events(replay: &Replay) -> Vec<EventMark> {
    let mut events = Vec::new();
    let mut before = Faults::NONE;
    for (index, record) in replay.records.iter().enumerate() {
        let time_s = replay.raw_time_s(index);
        for fault in record.faults.iter().filter(|fault| !before.has(*fault)) {
            let description = fault.describe().into();
            let kind = EventKind::Fault {
                code: fault.code(),
                description,
            };
            events.push(EventMark { time_s, kind });
        }
        before = record.faults;
        if let Some(event) = record.event {
            let time_s = match event {
                Event::MaterialChange => replay.time_s(index),
                Event::Contact | Event::Release => time_s,
            };
            let kind = EventKind::Estimator(event);
            events.push(EventMark { time_s, kind });
        }
    }
    events
}
