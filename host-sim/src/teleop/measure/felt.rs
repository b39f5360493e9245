//! The felt against the true force, at the same depth and the same speed.

use std::ops::Range;

use crate::lsq::dense::{cholesky, solve};
use crate::stats::{highest, rms};
use crate::teleop::trace::{Row, Trace};

/// A force that counts as a contact (N): five times what the load cells' noise leaves of one.
pub const TOUCH_N: f64 = 0.1;
/// After an impedance has arrived it comes in within a tenth of a second (s).
const COMES_IN_S: f64 = 0.15;
/// What a scheme without an estimate gets from the first touch on, besides the round trip (s).
const FIRST_S: f64 = 0.5;

/// Why the felt force of a material cannot be compared with the true one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NotCompared {
    /// The scheme put out no force.
    NoForce,
    /// The scheme put out a force, and was not ready before the contact ended.
    NotReady,
    /// The hand was not within the material for a tenth of a second once the scheme was ready: there was no true
    /// force, whatever the hand felt.
    NotInside,
}

impl NotCompared {
    /// The name in files.
    pub const fn name(self) -> &'static str {
        match self {
            NotCompared::NoForce => "no_force",
            NotCompared::NotReady => "not_ready",
            NotCompared::NotInside => "not_inside",
        }
    }

    /// A word for a table.
    pub const fn word(self) -> &'static str {
        match self {
            NotCompared::NoForce => "no force",
            NotCompared::NotReady => "not ready",
            NotCompared::NotInside => "outside",
        }
    }

    /// A sentence without its full stop.
    pub const fn sentence(self) -> &'static str {
        match self {
            NotCompared::NoForce => "The scheme never became ready: it put out no force",
            NotCompared::NotReady => {
                "The felt force is not comparable: the contact ended before the scheme was ready"
            }
            NotCompared::NotInside => {
                "The felt force is not comparable: the hand did not reach the material after the scheme was ready"
            }
        }
    }
}

/// What was felt of one material.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Felt {
    /// RMS over the peak, once the scheme has what it needs.
    pub share: Option<f64>,
    /// Why there is no such share.
    pub not_compared: Option<NotCompared>,
    /// RMS over the peak, over every contact.
    pub whole: f64,
    /// Felt stiffness over the true one, minus 1.
    pub stiffness_error: Option<f64>,
    /// Felt damping over the true one, minus 1.
    pub damping_error: Option<f64>,
}

/// A damping whose force is a smaller share of the peak is none that could be compared.
const LEAST_DAMPING: f64 = 0.03;

/// Whether the operator feels something there, or should.
pub fn touches(row: &Row) -> bool {
    row.true_n > TOUCH_N || row.felt_n > TOUCH_N
}

/// The stretches of one material each, as ranges of rows.
pub fn materials(trace: &Trace) -> Vec<Range<usize>> {
    let count = trace.rows.len();
    let changed_s = trace.changed_s.unwrap_or(f64::INFINITY);
    let at = trace.rows.partition_point(|row| row.time_s < changed_s);
    let stretches = [0..at, at..count].into_iter();
    stretches
        .take(1 + usize::from(trace.changed_s.is_some()))
        .collect()
}

/// Which rows are scored: contacts in which the scheme has what it needs.
pub fn scored(trace: &Trace) -> Vec<bool> {
    let ready = ready(trace).into_iter().zip(&trace.rows);
    ready.map(|(ready, row)| ready && touches(row)).collect()
}

/// In which rows the scheme has what it needs.
fn ready(trace: &Trace) -> Vec<bool> {
    let mut is_ready = vec![false; trace.rows.len()];
    for stretch in materials(trace) {
        let mut since = None;
        for at in stretch {
            let row = &trace.rows[at];
            let ready = match trace.scheme.reflects() {
                true => row.heard,
                false => since.is_some() || touches(row),
            };
            let first = match (ready, since) {
                (false, _) => None,
                (true, None) => Some(row.time_s),
                (true, since) => since,
            };
            since = first;
            let waits_s = match trace.scheme.reflects() {
                true => COMES_IN_S,
                false => FIRST_S + trace.round_trip_s(),
            };
            is_ready[at] = since.is_some_and(|since| row.time_s >= since + waits_s);
        }
    }
    is_ready
}

/// What was felt of each material.
pub fn felt(trace: &Trace) -> Vec<Felt> {
    let (is_ready, scored) = (ready(trace), scored(trace));
    let stretches = materials(trace).into_iter().zip(trace.shaping);
    stretches
        .map(|(stretch, shaping)| {
            let rows = |chosen: &dyn Fn(usize) -> bool| -> Vec<&Row> {
                let chosen = stretch.clone().filter(|at| chosen(*at));
                chosen.map(|at| &trace.rows[at]).collect()
            };
            let ready = rows(&|at| scored[at]);
            let inside = rows(&|at| scored[at] && trace.rows[at].true_n > TOUCH_N);
            let errors = impedance_errors(&inside, shaping).unwrap_or_default();
            let share_ready = share(&ready, shaping);
            let not_compared = || why_not(&trace.rows[stretch.clone()], &is_ready[stretch.clone()]);
            Felt {
                share: share_ready,
                not_compared: share_ready.is_none().then(not_compared),
                whole: share(&rows(&|at| touches(&trace.rows[at])), shaping).unwrap_or(0.0),
                stiffness_error: errors[0],
                damping_error: errors[1],
            }
        })
        .collect()
}

/// Why a stretch has nothing to compare.
fn why_not(rows: &[Row], is_ready: &[bool]) -> NotCompared {
    let is_felt = rows.iter().any(|row| row.felt_n > TOUCH_N);
    let is_true = rows.iter().any(|row| row.true_n > TOUCH_N);
    let was_ready = is_ready.contains(&true);
    match (is_felt, is_true, was_ready) {
        (_, _, true) | (false, false, false) => NotCompared::NotInside,
        (true, _, false) => NotCompared::NotReady,
        (false, true, false) => NotCompared::NoForce,
    }
}

/// RMS of felt minus true force over the peak of the true one; `None` of less than a tenth of a second.
fn share(rows: &[&Row], shaping: f64) -> Option<f64> {
    let peak_n = highest(rows.iter().map(|row| shaping * row.true_n));
    let enough = rows.len() >= 100 && peak_n > TOUCH_N;
    enough.then(|| rms(rows.iter().map(|row| row.felt_n - shaping * row.true_n)) / peak_n)
}

/// The errors of felt stiffness and damping: both forces are fitted with a constant, the depth and the
/// speed, over the same motion.
fn impedance_errors(rows: &[&Row], shaping: f64) -> Option<[Option<f64>; 2]> {
    // Half a second of contact.
    if rows.len() < 500 {
        return None;
    }
    let felt = line(rows, |row| row.felt_n)?;
    let real = line(rows, |row| shaping * row.true_n)?;
    let peak_n = highest(rows.iter().map(|row| shaping * row.true_n));
    let damped_n = rms(rows.iter().map(|row| 10.0 * real[2] * row.master_mps));
    let error = |slot: usize| felt[slot] / real[slot] - 1.0;
    Some([
        Some(error(1)),
        (damped_n > LEAST_DAMPING * peak_n).then(|| error(2)),
    ])
}

/// Coefficients of 1, x in mm and v in 0.1 m/s.
fn line(rows: &[&Row], force: impl Fn(&Row) -> f64) -> Option<Vec<f64>> {
    let (mut matrix, mut right) = (vec![0.0; 9], vec![0.0; 3]);
    for row in rows {
        let phi = [1.0, 1e3 * row.master_m, 10.0 * row.master_mps];
        for i in 0..3 {
            right[i] += phi[i] * force(row);
            for j in 0..3 {
                matrix[3 * i + j] += phi[i] * phi[j];
            }
        }
    }
    Some(solve(&cholesky(&matrix, 3)?, 3, &right))
}
