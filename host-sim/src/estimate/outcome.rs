//! What a replay comes to: the numbers of `estimate.json`.

use std::ops::Range;

use estimator_core::estimate::{Estimated, Event, PARAMETER_SLOTS, Parameters};
use estimator_core::physics::law::ParameterInfo;
use estimator_core::{Faults, LawKind, Status};

use super::reason::{EXPLAINED, Evidence, Reason, judged};
pub(crate) use super::residual::Motions;
pub use super::residual::law_with;
use super::residual::{depth_misfit, force_rmse, named, replay_force};
use super::touches::touches;
use crate::log::UniformLog;
use crate::replay::{EventKind, EventMark, Replay, Touch};

/// Settled: every parameter within this share of its final value from then on.
const SETTLED_WITHIN: f64 = 0.05;
/// The stretch since the last change of material is judged by itself if it has so much contact (s), and
/// this share of all contact: a law that does not fit raises false changes, and fits what little follows.
const STRETCH_S: f64 = 1.0;
const STRETCH_SHARE: f64 = 0.25;
/// More changes than these are not looked at one by one. Not measured.
const MOST_CHANGES: usize = 20;
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
    /// The method's opinion of it, without what the whole log says.
    pub method_status: Status,
    /// The reason that the method itself gives for it.
    pub method_reason: Option<Reason>,
    /// Why not further; `None` of a result that has converged.
    pub reason: Option<Reason>,
    /// The parameters at the end, in the order of [`LawKind::parameters`].
    pub parameters: Parameters<f32>,
    /// Raw force against the law with the final parameters, in contact with the material that they stand
    /// for: from the last change of material on (N rms); `None` without contact or parameters.
    pub force_rmse_n: Option<f64>,
    /// The same over the contacts of the whole log, whatever has changed in between (N rms).
    pub whole_log_rmse_n: Option<f64>,
    /// Noise of the force, and what the counts of the position leave of it with these parameters (N rms): what may remain.
    pub noise_n: f64,
    /// What the noise of the force and the errors of the position leave with these parameters (N rms).
    pub allowed_n: f64,
    /// How late the force is against the position (s), where that was estimated.
    pub skew: Option<Estimated<f64>>,
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
        Outcome::along(log, replay, &Motions::of(log))
    }

    /// Draws the sum of a replay of `log`, whose motion is one of these.
    pub(crate) fn along(log: &UniformLog, replay: &Replay, motions: &Motions<'_>) -> Outcome {
        let at = decisive(replay);
        let decisive = at.and_then(|at| replay.records.get(at));
        let decisive = decisive.as_ref();
        let law = decisive.map_or(replay.params.law(), |record| record.law);
        let parameters = decisive.map_or([None; PARAMETER_SLOTS], |record| record.parameters);
        let stretch = at.map_or(0..0, |at| match each_by_itself(log, replay, motions, at) {
            true => since_change(replay, at),
            false => stretch(replay, at),
        });
        let replays = motions.each().map(|motion| {
            let replayed_n = replay_force(log, replay, motion, law, &parameters);
            let rmse_n = force_rmse(log, replay, &replayed_n, stretch.clone());
            (replayed_n, rmse_n)
        });
        let or_infinite = |rmse_n: Option<f64>| rmse_n.unwrap_or(f64::INFINITY);
        let least = replays.min_by(|a, b| or_infinite(a.1).total_cmp(&or_infinite(b.1)));
        let (replayed_n, force_rmse_n) = least.unwrap_or_default();
        let counts_n = motions
            .rounding_m
            .and_then(|rounding_m| depth_misfit(replay, law, &parameters, rounding_m));
        let noise_n = replay.noise_n.hypot(counts_n.unwrap_or(0.0));
        let evidence = Evidence {
            misfit: force_rmse_n.map(|rmse| rmse / noise_n),
            ..Evidence::default()
        };
        let method_status = decisive.map_or(Status::NoContact, |record| record.status);
        let method_reason = decisive.and_then(|record| record.reason);
        let evidence = Evidence {
            told: method_reason,
            ..evidence
        };
        let (status, reason) = judged(method_status, &evidence);
        Outcome {
            law,
            status,
            method_status,
            method_reason,
            reason,
            force_rmse_n,
            noise_n,
            allowed_n: {
                let by_position_n = depth_misfit(replay, law, &parameters, motions.error_m);
                let noise_n = replay.noise_n.max(log.force_noise_n());
                noise_n.hypot(by_position_n.unwrap_or(0.0))
            },
            whole_log_rmse_n: force_rmse(log, replay, &replayed_n, 0..replay.records.len()),
            skew: named(law, &parameters, "skew").map(|skew| Estimated {
                value: skew.value.into(),
                std_error: skew.std_error.into(),
            }),
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

    /// Adds to the error of the parameter of that name, if the law has it, another error.
    pub(super) fn widen_one(&mut self, name: &str, by: f64) {
        let mut each = self.law.parameters().iter().zip(&mut self.parameters);
        let own = each.find(|(info, _)| info.name == name);
        if let Some((_, Some(own))) = own {
            own.std_error = f64::from(own.std_error).hypot(by) as f32;
        }
    }

    /// Makes all standard errors so many times as large: those of a law that does not explain the force are of what it
    /// leaves.
    pub(super) fn widen(&mut self, times: f64) {
        let segments = self.segments.iter_mut().map(|own| &mut own.parameters);
        let all = segments.chain([&mut self.parameters]);
        for estimate in all.flat_map(|own| own.iter_mut().flatten()) {
            estimate.std_error *= times as f32;
        }
    }

    /// The value of the parameter of that name.
    pub fn value(&self, name: &str) -> Option<Estimated<f32>> {
        named(self.law, &self.parameters, name)
    }
}

/// Index of the record whose parameters stand for the log: the last one, unless the log ends before a
/// change of material has been learned; then the last one before the change.
fn decisive(replay: &Replay) -> Option<usize> {
    let last = replay.last()?;
    let learned = !matches!(last.status, Status::Changed | Status::Unobservable);
    match replay.records.last_with(Event::MaterialChange) {
        Some(change) if !learned && change > 0 => Some(change - 1),
        _ => Some(replay.records.len() - 1),
    }
}

/// Whether the material has changed, and each stretch of one material is explained by its own parameters: then the
/// changes are no sign of a law that fits nothing, and the last stretch is judged by itself, however short it is. Two
/// touches of each of three materials had all of them right, and one law left 100 times the noise of the log.
fn each_by_itself(log: &UniformLog, replay: &Replay, motions: &Motions<'_>, at: usize) -> bool {
    let until = changes(replay).into_iter().filter(|change| *change <= at);
    let bounds = bounds(replay, until, at + 1);
    let contacts = replay.contacts();
    // A change is noticed some samples into the first touch of another material.
    let before = |change: usize| {
        let mut touched = contacts.iter().filter(|own| own.contains(&change));
        touched.next().map_or(change, |own| own.start)
    };
    let explained = |from: usize, to: usize| {
        let own = replay.records.at(to - 1);
        let stretch = from..if to <= at { before(to) } else { to };
        let mut left_n = motions.each().filter_map(|motion| {
            let replayed_n = replay_force(log, replay, motion, own.law, &own.parameters);
            force_rmse(log, replay, &replayed_n, stretch.clone())
        });
        left_n.any(|left_n| left_n <= EXPLAINED * replay.noise_n)
    };
    (3..=MOST_CHANGES + 2).contains(&bounds.len())
        && bounds.windows(2).all(|pair| explained(pair[0], pair[1]))
}

/// Where stretches of one material begin, and the end: the first touch, and every change.
fn bounds(replay: &Replay, changes: impl IntoIterator<Item = usize>, end: usize) -> Vec<usize> {
    let first = replay.contacts().first().map(|contact| contact.start);
    first.into_iter().chain(changes).chain([end]).collect()
}

/// Records from the last change of material on, up to `at`.
fn since_change(replay: &Replay, at: usize) -> Range<usize> {
    let mut before = changes(replay).into_iter().rev();
    before.find(|change| *change <= at).unwrap_or(0)..at + 1
}

/// Records of the material that those of `at` stand for: from its change on, from where the zero was found that they
/// are measured from, and from the last jump of the encoder, since which its surface is elsewhere; if enough of the
/// contact comes after that to judge a law by.
fn stretch(replay: &Replay, at: usize) -> Range<usize> {
    let start = since_change(replay, at).start;
    let start = start.max(zero_found(replay, at).unwrap_or(0));
    let jumped = replay.jumps.iter().rfind(|jump| **jump <= at);
    let start = start.max(jumped.copied().unwrap_or(0));
    let contacts = replay.contacts();
    let of = |from: usize, to: usize| -> f64 {
        let within = contacts.iter().map(|contact| {
            let end = contact.end.min(to);
            end.saturating_sub(contact.start.max(from)) as f64
        });
        within.sum()
    };
    let (own, all) = (of(start, at + 1), of(0, replay.records.len()));
    match own >= (STRETCH_S / replay.period_s).max(STRETCH_SHARE * all) {
        true => start..at + 1,
        false => 0..replay.records.len(),
    }
}

/// The last record, up to `at`, at which free air has shown that the zero was wrong: the forces before it are
/// off by some newtons, and say nothing of the law.
fn zero_found(replay: &Replay, at: usize) -> Option<usize> {
    // What the resting force follows in a sample is far less than a lift-off.
    let least_n = f64::from(replay.config.contact.release_sigma) * replay.noise_n;
    let rest_n = replay.rest_n.get(..=at)?;
    let jumped = |pair: &[f32]| f64::from((pair[1] - pair[0]).abs()) > least_n;
    // The first value is that of settling.
    let settled = rest_n.iter().position(|rest_n| *rest_n != 0.0)?;
    let last = rest_n[settled..].windows(2).rposition(jumped)?;
    Some(settled + last + 1)
}

/// The records at which the material has changed.
fn changes(replay: &Replay) -> Vec<usize> {
    let stretches = replay.records.stretches();
    let changes = stretches.filter(|(_, said)| said.event == Some(Event::MaterialChange));
    changes.flat_map(|(range, _)| range).collect()
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
    let first_near = match replay.records.iter().rposition(|record| !near(&record)) {
        Some(far) => far + 1,
        None => 0,
    };
    let contact_s = replay.time_s(replay.contacts().first()?.start);
    let stayed_s = (replay.records.len() - first_near) as f64 * replay.period_s;
    let long_enough = stayed_s >= f64::from(replay.config.judgement.window_s);
    long_enough.then(|| replay.time_s(first_near) - contact_s)
}

fn segments(replay: &Replay) -> Vec<Segment> {
    let bounds = bounds(replay, changes(replay), replay.records.len());
    if replay.contacts().is_empty() {
        return Vec::new();
    }
    let first = bounds[0];
    bounds
        .windows(2)
        .map(|pair| Segment {
            from_s: match pair[0] == first {
                true => replay.raw_time_s(first),
                false => replay.time_s(pair[0]),
            },
            to_s: replay.time_s(pair[1] - 1),
            parameters: replay.records.at(pair[1] - 1).parameters,
        })
        .collect()
}

/// Contacts and changes as they come, faults when they begin. A change is one of the smoothed
/// signals; everything else happens to a raw sample.
fn events(replay: &Replay) -> Vec<EventMark> {
    let mut events = Vec::new();
    let mut before = Faults::NONE;
    // A change of what is said begins a stretch, and an event is raised at every record of its own.
    let said = replay.records.stretches().flat_map(|(range, said)| {
        let many = if said.event.is_some() { range.len() } else { 1 };
        range.take(many).map(move |index| (index, said))
    });
    for (index, record) in said {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::Motion;
    use crate::plant::{GEL, Rig, Stage};
    use crate::replay::replay;
    use estimator_core::Config;

    #[test]
    fn a_law_is_judged_since_the_encoder_last_jumped_where_enough_follows() {
        let motion = Motion::palpation(GEL.peak_depth_m);
        let stage = Stage::throughout(GEL.at(0.0));
        let log = Rig::default().run(&stage, &motion, 9).unwrap().log;
        let mut replay = replay(&log.uniform().unwrap(), &Config::default()).unwrap();
        let (last, count) = (replay.records.len() - 1, replay.records.len());
        assert_eq!(stretch(&replay, last), 0..count);
        let half = count / 2;
        replay.jumps = vec![half / 2, half];
        assert_eq!(stretch(&replay, last), half..count);
        // A few last samples judge no law.
        replay.jumps.push(count - 20);
        assert_eq!(stretch(&replay, last), 0..count);
    }
}
