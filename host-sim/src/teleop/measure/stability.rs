//! Whether the system comes to rest where the operator wants to: in the press at the end.

use crate::stats::rms;
use crate::teleop::trace::{Row, Trace};
use crate::teleop::{Options, System};

/// Whether a system comes to rest.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Rest {
    /// It does.
    Rests,
    /// It goes on moving, or it left the metre in which it is one.
    Moves,
    /// The run does not tell: it does not end in a press, or in one that is too short for how slowly it comes to rest.
    #[default]
    CannotTell,
}

impl Rest {
    /// What is known of two materials together.
    #[must_use]
    pub fn and(self, other: Rest) -> Rest {
        match (self, other) {
            (Rest::Moves, _) | (_, Rest::Moves) => Rest::Moves,
            (Rest::Rests, Rest::Rests) => Rest::Rests,
            _ => Rest::CannotTell,
        }
    }

    /// Whether it does; `None`: that cannot be told.
    pub const fn known(self) -> Option<bool> {
        match self {
            Rest::Rests => Some(true),
            Rest::Moves => Some(false),
            Rest::CannotTell => None,
        }
    }
}

/// A master that moves faster than this (m/s rms) is not at rest: what forces that still arrive and the
/// renderer's last packets leave is below a tenth of it.
const AT_REST_MPS: f64 = 3e-3;
/// The shortest stretch that is looked at (s).
const SHORTEST_S: f64 = 1.5;
/// A system that moves is given this much of the press, and a round trip, before it is looked at (s): the hand and the
/// master of the built-in task have come to rest after 0.3 s. Its press has 1.9 s. Not measured.
const SETTLES_S: f64 = 1.0;
/// A system that still moves at the end of the press is looked at after a press that is so much longer (s), and four
/// round trips: time-domain passivity on a spring and a damper comes to rest 20 s after a ramp at a round trip of 1 s.
const LONGER_S: f64 = 20.0;

/// How long a stretch is looked at (s): a round trip, so that a swing that goes round is not missed.
fn looked_at_s(trace: &Trace) -> f64 {
    SHORTEST_S.max(trace.round_trip_s())
}

/// The end of the last press.
fn end_of_press(trace: &Trace) -> &[Row] {
    let last_s = trace.rows.last().map_or(0.0, |row| row.time_s);
    trace.between(last_s - looked_at_s(trace), f64::INFINITY)
}

/// Whether the run went to its end, and the master rests there.
pub fn rest(trace: &Trace) -> Rest {
    if !trace.ended {
        return Rest::Moves;
    }
    let press_s = trace.press_s();
    if press_s < looked_at_s(trace) {
        return Rest::CannotTell;
    }
    let rows = end_of_press(trace);
    if rms(rows.iter().map(|row| row.master_mps)) < AT_REST_MPS {
        return Rest::Rests;
    }
    match press_s >= looked_at_s(trace) + SETTLES_S + trace.round_trip_s() {
        true => Rest::Moves,
        false => Rest::CannotTell,
    }
}

/// The same, where the press is made longer for a system that still moves at its end: one that rests then is slow, and
/// the press was too short for it.
pub fn rest_of(options: &Options, seed: u64, trace: &Trace) -> Rest {
    let rest = rest(trace);
    if rest != Rest::Moves || !trace.ended {
        return rest;
    }
    let longer = options.with_longer_press(LONGER_S + 4.0 * trace.round_trip_s());
    match self::rest(&System::new(&longer, seed).run()) {
        Rest::Rests => Rest::CannotTell,
        other => other,
    }
}

/// How fast the motion of the master decays over the end of the press (1/s).
pub fn decay_per_s(trace: &Trace) -> f64 {
    let rows = end_of_press(trace);
    let (first, second) = rows.split_at(rows.len() / 2);
    let moves = |rows: &[Row]| rms(rows.iter().map(|row| row.master_mps)).max(1e-9);
    let apart_s = second.len() as f64 * trace.period_s;
    (moves(first) / moves(second)).ln() / apart_s.max(trace.period_s)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::{Motion, Segment};
    use crate::teleop::SchemeId;
    use crate::teleop::environment::{Environment, Material};

    fn judged(options: &Options) -> Rest {
        rest_of(options, 1, &System::new(options, 1).run())
    }

    fn on(material: Material, scheme: SchemeId, delay_s: f64) -> Options {
        let mut options = Options::default().with_scheme(scheme);
        options.environment = Environment::throughout(material);
        options.with_channel(delay_s, 0.0, 0.0)
    }

    #[test]
    fn a_press_that_is_too_short_and_a_run_without_one_tell_nothing() {
        let gel = || on(Material::gel(), SchemeId::Reflection, 0.0);
        let mut short = gel();
        short.task.as_mut().unwrap().presses_s = 1.0;
        assert_eq!(judged(&short.with_task_for_delay()), Rest::CannotTell);
        let palpates = Segment::Sine {
            mean_m: 4e-3,
            amplitude_m: 10e-3,
            frequency_hz: 0.8,
            seconds: 5.0,
        };
        let back = Segment::Ramp {
            to_m: -6e-3,
            speed_mps: 0.06,
        };
        let in_air = vec![palpates.clone(), back, Segment::Hold { seconds: 4.0 }];
        for segments in [vec![palpates], in_air] {
            let mut options = gel();
            options.task = None;
            options.operator.intention = Motion::new(-6e-3, segments).unwrap();
            assert_eq!(judged(&options), Rest::CannotTell);
        }
        assert_eq!(judged(&gel().with_task_for_delay()), Rest::Rests);
    }

    #[test]
    fn a_hand_that_creeps_into_a_dashpot_is_slow_and_a_swing_goes_on() {
        let dashpot = Material::linear(1000.0, 2000.0);
        let slow = on(dashpot, SchemeId::Reflection, 0.0).with_task_for_delay();
        assert_eq!(judged(&slow), Rest::CannotTell);
        let spring = || Material::linear(1000.0, 5.0);
        let swings = |delay_s| on(spring(), SchemeId::PositionForce, delay_s).with_task_for_delay();
        // At 0.3 s round trip it dies away in 5 s, at 1 s it never does.
        assert_eq!(judged(&swings(0.15)), Rest::CannotTell);
        assert_eq!(judged(&swings(0.5)), Rest::Moves);
    }
}
