//! Peaks at a touch, and how much contact it takes until the felt force is right.

use crate::stats::highest;
use crate::teleop::measure::felt::{TOUCH_N, materials, touches};
use crate::teleop::trace::{Row, Trace};

/// How long after the first contact a force belongs to the touch (s).
const TOUCH_S: f64 = 0.3;
/// The felt force is right from where on it stays within this share of the peak …
const WITHIN: f64 = 0.05;
/// … over this much contact (s).
const STAYS_S: f64 = 0.5;

/// The largest force on the material within 0.3 s of the slave's first touch from a time on (s).
pub fn peak_touch_n(trace: &Trace, from_s: f64) -> Option<f64> {
    let first_s = first_touch_s(trace.between(from_s, f64::INFINITY))?;
    let touch = trace.between(first_s, first_s + TOUCH_S);
    Some(highest(touch.iter().map(|row| row.contact_n)))
}

fn first_touch_s(rows: &[Row]) -> Option<f64> {
    rows.iter()
        .find(|row| row.contact_n > TOUCH_N)
        .map(|row| row.time_s)
}

/// Contact of the slave, and the way back, until the felt force of the first material is right (s).
pub fn settled_s(trace: &Trace) -> Option<f64> {
    settled_in(trace, 0)
}

/// The same of the second material, from where the slave touches it (s).
pub fn resettled_s(trace: &Trace) -> Option<f64> {
    settled_in(trace, 1)
}

fn settled_in(trace: &Trace, which: usize) -> Option<f64> {
    let stretch = materials(trace).get(which)?.clone();
    let rows = &trace.rows[stretch];
    let first_s = first_touch_s(rows)?;
    let right_s = right_from_s(rows, trace, first_s, trace.shaping[which])?;
    let back_s = trace.delays_s[1];
    let touched = rows
        .iter()
        .filter(|row| row.contact_n > TOUCH_N)
        .filter(|row| (first_s..right_s - back_s).contains(&row.time_s));
    Some(back_s + touched.count() as f64 * trace.period_s)
}

/// The time from which on the felt force stays right over half a second of contact (s).
fn right_from_s(rows: &[Row], trace: &Trace, first_s: f64, shaping: f64) -> Option<f64> {
    let after = rows.partition_point(|row| row.time_s < first_s);
    let contact: Vec<&Row> = rows[after..].iter().filter(|row| touches(row)).collect();
    let peak_n = highest(contact.iter().map(|row| shaping * row.true_n));
    let wanted = (STAYS_S / trace.period_s).round() as usize;
    let mut square = 0.0;
    let error = |row: &Row| (row.felt_n - shaping * row.true_n).powi(2);
    for (at, row) in contact.iter().enumerate() {
        square += error(row);
        if at >= wanted {
            square -= error(contact[at - wanted]);
        }
        if at + 1 >= wanted && square.max(0.0) / wanted as f64 <= (WITHIN * peak_n).powi(2) {
            return Some(contact[at + 1 - wanted].time_s);
        }
    }
    None
}
