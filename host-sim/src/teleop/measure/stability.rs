//! Whether the system comes to rest where the operator wants to: in the press at the end.

use crate::stats::rms;
use crate::teleop::trace::{Row, Trace};

/// A master that moves faster than this (m/s rms) is not at rest: what forces that still arrive and the
/// renderer's last packets leave is below a tenth of it.
const AT_REST_MPS: f64 = 3e-3;
/// The shortest stretch that is looked at (s).
const SHORTEST_S: f64 = 1.5;

/// The end of the last press: as long as a round trip, so that a swing that goes round is not missed.
fn end_of_press(trace: &Trace) -> &[Row] {
    let last_s = trace.rows.last().map_or(0.0, |row| row.time_s);
    trace.between(last_s - SHORTEST_S.max(trace.round_trip_s()), f64::INFINITY)
}

/// Whether the run went to its end, and the master rests there.
pub fn is_stable(trace: &Trace) -> bool {
    trace.ended && rms(end_of_press(trace).iter().map(|row| row.master_mps)) < AT_REST_MPS
}

/// How fast the motion of the master decays over the end of the press (1/s).
pub fn decay_per_s(trace: &Trace) -> f64 {
    let rows = end_of_press(trace);
    let (first, second) = rows.split_at(rows.len() / 2);
    let moves = |rows: &[Row]| rms(rows.iter().map(|row| row.master_mps)).max(1e-9);
    let apart_s = second.len() as f64 * trace.period_s;
    (moves(first) / moves(second)).ln() / apart_s.max(trace.period_s)
}
