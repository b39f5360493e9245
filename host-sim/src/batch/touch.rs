//! Each touch by itself: stiffness, damping and exponent fitted again, with the surface, the offset
//! and the relaxation modes of the whole log.
//!
//! A material that stiffens from touch to touch, or slips, shows here. What earlier touches have left
//! in the memory of the law is taken off first, as the whole log's parameters have it.

use std::ops::Range;

use estimator_core::physics::law::LawId;

use super::blocks::{Node, Use};
use super::course::Course;
use super::family::{Family, OFFSET, SURFACE};
use super::fit::{Fit, Problem, STILL};
use super::natural::natural;
use super::result::{Parameter, TouchFit};
use super::scales::Scales;
use super::select::Candidate;
use crate::log::UniformLog;
use crate::stats::lowest;

/// Time constants of the slowest mode that the memory reaches back: e^−10 of it is left.
const REMEMBERED: f64 = 10.0;
/// Parameters that a touch has of its own.
const OWN: [&str; 4] = ["stiffness", "damping", "exponent", "stiffening_rate"];

/// Fits every touch that has enough samples.
pub(super) fn touches(
    course: &Course,
    log: &UniformLog,
    best: &Candidate,
    depth_m: f64,
) -> Vec<TouchFit> {
    let ranges = ranges(course);
    let law = natural(best.fit.family, &best.fit.free, &course.scales);
    let rates = law.modes[..best.fit.family.modes]
        .iter()
        .map(|mode| mode.rate_per_s);
    let memory_s = REMEMBERED / lowest(rates);
    let fits = ranges.iter().enumerate().map(|(number, range)| {
        let start_s = course
            .nodes
            .get(range.start)
            .map_or(0.0, |node| node.time_s);
        let reach = course
            .nodes
            .partition_point(|node| node.time_s < start_s - memory_s);
        let one = OneTouch {
            course,
            best,
            depth_m,
            range: range.clone(),
            reach,
        };
        let times = &course.touches[number];
        one.fit((log.time_s[times.start], log.time_s[times.end - 1]))
    });
    fits.flatten().collect()
}

/// Nodes from the way in to the end of each touch.
fn ranges(course: &Course) -> Vec<Range<usize>> {
    let mut ranges: Vec<Range<usize>> = Vec::new();
    for number in 0..course.touches.len() {
        let own = |node: &Node| node.used == Use::Contact(number);
        let start = course.nodes.iter().position(own);
        let end = course.nodes.iter().rposition(own);
        ranges.push(match (start, end) {
            (Some(start), Some(end)) => start.saturating_sub(1)..end + 1,
            _ => 0..0,
        });
    }
    ranges
}

struct OneTouch<'a> {
    course: &'a Course,
    best: &'a Candidate,
    depth_m: f64,
    range: Range<usize>,
    /// First node that the memory reaches back to.
    reach: usize,
}

impl OneTouch<'_> {
    fn fit(&self, (from_s, to_s): (f64, f64)) -> Option<TouchFit> {
        let family = self.best.fit.family;
        let scales = &self.course.scales;
        let nodes = self.without_memory(scales);
        let mut weights = self.best.weights[self.range.clone()].to_vec();
        let decide = self.course.thresholds;
        // Below it a law that remembers may be saturated.
        let low_n = scales.rest_n + decide.samples.released_force * scales.force_n;
        let measured = &self.course.nodes[self.range.clone()];
        for (weight, node) in weights.iter_mut().zip(measured) {
            // Free of a material that has not recovered yet, perhaps: not the law's force.
            if family.modes > 0 && node.force_n < low_n {
                *weight = 0.0;
            }
        }
        let fitted = weights.iter().filter(|weight| **weight > 0.0).count();
        if (fitted as f64) < decide.report.fewest_of_a_touch {
            return None;
        }
        let fixed = fixed(family);
        let problem = Problem {
            family,
            nodes: &nodes,
            weights: &weights,
            scales,
            fixed: &fixed,
        };
        let fit = problem.fit(self.best.fit.free.clone(), STILL);
        let own = problem.covariance(&fit.free);
        let values = problem.reported(&fit.free, &own, self.depth_m);
        let parameters = family.parameters().zip(values);
        let parameters =
            parameters
                .filter(|(info, _)| OWN.contains(&info.name))
                .map(|(info, value)| {
                    let known =
                        value.value.is_finite() && value.std_error.is_finite() && fit.converged;
                    Parameter::new(info, known.then_some(value))
                });
        let parameters: Vec<Parameter> = parameters.collect();
        Some(TouchFit {
            from_s,
            to_s,
            parameters,
            block_rmse_n: rmse(&nodes, &fit, scales),
        })
    }

    /// The touch's nodes, less the force that the law remembers from before: what it would answer if
    /// the probe had only just reached the surface.
    fn without_memory(&self, scales: &Scales) -> Vec<Node> {
        let mut nodes = self.course.nodes[self.range.clone()].to_vec();
        if self.best.fit.family.modes == 0 || self.reach >= self.range.start {
            return nodes;
        }
        let law = natural(self.best.fit.family, &self.best.fit.free, scales);
        let mut before = self.course.nodes[self.reach..self.range.end].to_vec();
        for node in &mut before[self.range.start - self.reach..] {
            // In the material, or there would be no force, but not worth one.
            node.position_m = law.surface_m + 1e-9 * scales.depth_m;
        }
        let mut remembered = Vec::with_capacity(before.len());
        let touched_s = nodes.first().map_or(0.0, |node| node.time_s);
        law.unsaturated(self.best.fit.family, &before, touched_s, |_, force| {
            remembered.push(force)
        });
        let own = &remembered[self.range.start - self.reach..];
        for (node, remembered) in nodes.iter_mut().zip(own) {
            node.force_n -= remembered;
        }
        nodes
    }
}

/// All but stiffness, damping and exponent.
fn fixed(family: Family) -> Vec<usize> {
    let mut fixed = vec![SURFACE, OFFSET];
    match family.law {
        // The rate of its mode is its damping.
        LawId::Zener => fixed.push(family.first_mode()),
        _ => fixed.extend(family.first_mode()..family.free()),
    }
    fixed
}

/// Over the block means, each by its samples.
fn rmse(nodes: &[Node], fit: &Fit, scales: &Scales) -> f64 {
    let (mut squares, mut count) = (0.0, 0.0);
    let law = natural(fit.family, &fit.free, scales);
    law.along(fit.family, nodes, |node, force| {
        if matches!(node.used, Use::Contact(_)) {
            squares += node.count * (node.force_n - force).powi(2);
            count += node.count;
        }
    });
    (squares / f64::max(count, 1.0)).sqrt()
}
