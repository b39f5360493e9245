//! The lines of a log: what repeats in one phase through all free air.

use std::ops::Range;

use crate::gap::noise::free_air::in_free_air;
use crate::gap::noise::line::Line;
use crate::gap::noise::rest;
use crate::gap::noise::spectrum::detrended;
use crate::gap::thresholds::Floor;
use crate::log::UniformLog;

/// Most lines that are looked for; some of them repeat with the motion.
pub(super) const MOST_LINES: usize = 4;

/// The lines that stay in phase through all free air, the strongest first.
pub(super) fn lines_in_free_air(log: &UniformLog, decide: &Floor) -> Vec<Line> {
    let is_free = in_free_air(log, decide);
    let mut searched = log.force_n.clone();
    let mut lines = Vec::new();
    while lines.len() < MOST_LINES {
        let Some(line) = Line::strongest(&searched, &is_free, decide.prominence) else {
            break;
        };
        line.take_out_of(&mut searched);
        lines.push(line);
    }
    lines
}

/// The forces without the lines that are there at rest: others repeat with the motion.
pub(super) fn without_lines_at_rest(
    force_n: &[f64],
    lines: &[Line],
    rests: &[Range<usize>],
) -> Vec<f64> {
    let squares = |force_n: &[f64]| -> f64 {
        let at_rest = rests.iter().map(rest::settled);
        let forces = at_rest.flat_map(|rest| detrended(&force_n[rest]));
        forces.map(|force| force * force).sum()
    };
    let mut kept = force_n.to_vec();
    let mut least = squares(&kept);
    for line in lines {
        let mut without = kept.clone();
        line.take_out_of(&mut without);
        let left = squares(&without);
        if left < least {
            (kept, least) = (without, left);
        }
    }
    kept
}
