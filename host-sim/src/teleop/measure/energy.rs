//! Energy that the coupling gives to the operator without having got it.
//!
//! From rest, a passive coupling with a passive material behind it has at every instant got at least as
//! much work from the operator as it has given back: ∫F_h·v dt less the kinetic energy is never negative.
//! And in a press that only lasts, nothing comes out but what was stored. An exchange of impedances under
//! the hand adds V_new − V_old, which is declared and not counted here.
//!
//! It is counted at two places: at the hand, behind the master's own damping, of which a renderer may use up what it
//! creates itself; and before it, at the coupling alone, as the figure of a report shows it.

use crate::stats::highest;
use crate::teleop::trace::{Row, Trace};

/// The energy that coupling and master have given to the hand (J).
pub fn created_j(trace: &Trace) -> f64 {
    given_j(trace, |row| row.felt_j + row.lost_j)
}

/// The energy that the coupling has given to master and hand (J).
pub fn of_the_coupling_j(trace: &Trace) -> f64 {
    given_j(trace, |row| row.felt_j)
}

/// What came out beyond what went in (J), by the work that went in so far.
fn given_j(trace: &Trace, work_j: impl Fn(&Row) -> f64) -> f64 {
    let from_rest_j = from_rest_j(trace, &work_j);
    from_rest_j.max(in_the_press_j(trace, &work_j)).max(0.0)
}

/// What more than everything that went in came out (J).
fn from_rest_j(trace: &Trace, work_j: impl Fn(&Row) -> f64) -> f64 {
    let excess = |row: &Row| -work_j(row) - row.exchanged_j.max(0.0);
    highest(trace.rows.iter().map(excess))
}

/// What more than the stored energy came out in the last press (J). F·δ bounds what a material stores
/// whose force rises with the depth.
fn in_the_press_j(trace: &Trace, work_j: impl Fn(&Row) -> f64) -> f64 {
    let last_s = trace.rows.last().map_or(0.0, |row| row.time_s);
    let press = trace.between(last_s - 2.5_f64.max(trace.round_trip_s()), f64::INFINITY);
    let Some(first) = press.first() else {
        return 0.0;
    };
    let stored_j = first.true_n.max(first.felt_n) * first.master_m.max(0.0);
    let given = |row: &Row| {
        let exchanged_j = (row.exchanged_j - first.exchanged_j).max(0.0);
        work_j(first) - work_j(row) - stored_j - exchanged_j
    };
    highest(press.iter().map(given))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::teleop::environment::{Environment, Material};
    use crate::teleop::{Options, SchemeId, System};

    /// A spring and a damper by position–force across 0.3 s: the hand is still, and the coupling drives the swing that
    /// the master's damping takes up.
    #[test]
    fn a_swing_that_goes_on_has_its_energy_from_the_coupling() {
        let mut options = Options::default().with_scheme(SchemeId::PositionForce);
        options.environment = Environment::throughout(Material::linear(1000.0, 5.0));
        let options = options.with_channel(0.15, 0.0, 0.0).with_task_for_delay();
        let trace = System::new(&options, 1).run();
        let end_j = trace.rows.last().unwrap().felt_j;
        assert!(end_j < -1.0, "{end_j}");
        assert!(of_the_coupling_j(&trace) >= -end_j);
        assert!(created_j(&trace) < 0.1);
    }

    #[test]
    fn a_coupling_of_no_delay_gives_nothing_out() {
        let mut options = Options::default().with_scheme(SchemeId::Reflection);
        options.environment = Environment::throughout(Material::gel());
        let trace = System::new(&options.with_task_for_delay(), 1).run();
        assert!(of_the_coupling_j(&trace) < 1e-3);
    }
}
