//! Energy that the coupling gives to the operator without having got it.
//!
//! From rest, a passive coupling with a passive material behind it has at every instant got at least as
//! much work from the operator as it has given back: ∫F_h·v dt less the kinetic energy is never negative.
//! And in a press that only lasts, nothing comes out but what was stored. An exchange of impedances under
//! the hand adds V_new − V_old, which is declared and not counted here.

use crate::stats::highest;
use crate::teleop::trace::{Row, Trace};

/// The energy created (J).
pub fn created_j(trace: &Trace) -> f64 {
    from_rest_j(trace).max(in_the_press_j(trace)).max(0.0)
}

/// What more than everything that went in came out (J), the master's own losses counted as coming out.
fn from_rest_j(trace: &Trace) -> f64 {
    let excess = |row: &Row| -(row.felt_j + row.lost_j) - row.exchanged_j.max(0.0);
    highest(trace.rows.iter().map(excess))
}

/// What more than the stored energy came out in the last press (J). F·δ bounds what a material stores
/// whose force rises with the depth.
fn in_the_press_j(trace: &Trace) -> f64 {
    let last_s = trace.rows.last().map_or(0.0, |row| row.time_s);
    let press = trace.between(last_s - 2.5_f64.max(trace.round_trip_s()), f64::INFINITY);
    let Some(first) = press.first() else {
        return 0.0;
    };
    let stored_j = first.true_n.max(first.felt_n) * first.master_m.max(0.0);
    let given = |row: &Row| {
        let exchanged_j = (row.exchanged_j - first.exchanged_j).max(0.0);
        first.felt_j + first.lost_j - row.felt_j - row.lost_j - stored_j - exchanged_j
    };
    highest(press.iter().map(given))
}
