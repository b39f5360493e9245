//! Teleoperation: theory, and the small version of the bar; `cargo run --release -p tests --example teleop`
//! prints the whole one.

mod theory;

use palpate::teleop::environment::Environment;
use palpate::teleop::{Cell, SchemeId};
use std::sync::LazyLock;
use tests::teleop::bar::{self, Row};
use tests::teleop::hand;

/// Gel and plastic, without delay and with 0.3 s round trip, 30 % of jitter and 20 % loss.
static CELLS: LazyLock<Vec<Cell>> = LazyLock::new(|| bar::cells(&bar::grid(1, true), &|_, _| {}));

fn reached(rows: impl IntoIterator<Item = Row>) {
    let missed: Vec<Row> = rows.into_iter().filter(|row| !row.reached).collect();
    assert!(missed.is_empty(), "{missed:#?}");
}

#[test]
fn the_felt_force_is_the_true_one_once_the_estimate_has_arrived() {
    let rows = bar::felt(&CELLS).into_iter();
    reached(rows.filter(|row| !row.asked.contains("foam")));
}

#[test]
fn another_material_is_felt_again_in_time() {
    reached(bar::resettled(&CELLS));
}

/// The worst run of 48 was off by 21 %, the one that let the operator fall in by 45 %.
const FALLS_IN: f64 = 0.3;

/// A round trip of 2 s, at which a change of material that was none once let the operator fall in: 45 % of the peak.
/// Of 48 runs a cell the middle one is off by 6 and 7.5 %, one of eight by more than 10 %: two seeds alone say little.
#[test]
fn a_foam_that_the_law_does_not_explain_is_felt_as_well_as_the_law_can() {
    let mut grid = bar::grid(16, true);
    grid.environments = Environment::compared();
    grid.environments.retain(|own| own.first.name == "foam");
    grid.schemes = vec![SchemeId::Reflection];
    (grid.round_trips_s, grid.jitters) = (vec![2.0], vec![0.0, 0.3]);
    let cells = bar::cells(&grid, &|_, _| {});
    let rows = bar::felt(&cells).into_iter();
    reached(rows.filter(|row| row.asked.contains("foam")));
    assert_eq!(cells.len(), 2);
    let runs = cells.iter().flat_map(|cell| &cell.runs);
    for run in runs {
        let share = run.felt_force_rmse_share;
        assert!(share.is_some_and(|share| share < FALLS_IN), "{share:?}");
    }
}

#[test]
fn reflection_creates_no_energy_touches_gently_and_is_ahead_from_30_ms_on() {
    reached([bar::energy(&CELLS), bar::packets(&CELLS)]);
    reached(bar::touch(&CELLS).into_iter().chain(bar::ahead(&CELLS)));
}

#[test]
fn a_link_that_is_cut_fades_the_force_out() {
    reached([bar::outage()]);
}

#[test]
fn the_hand_is_identified_with_and_without_a_known_force() {
    reached(hand::hand(2));
}

#[test]
fn position_force_does_not_rest_with_delay_and_says_so() {
    let own = CELLS
        .iter()
        .filter(|cell| cell.scheme == SchemeId::PositionForce);
    let unstable: Vec<bool> = own.map(|cell| !cell.is_stable()).collect();
    assert_eq!(unstable, [false, true, false, true]);
}
