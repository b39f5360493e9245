//! What each block mean weighs in a fit.
//!
//! **Weights.** A block mean of m samples has the variance σ²/m of the noise; that of the position,
//! ξ², times the local stiffness k squared, over m/h, if h samples in a row have the same error (a
//! hold on one count of an encoder does not average it); and the variance s² of what even the best
//! candidate misses, which no mean removes: w = 1/((σ² + k²ξ²h)/m + s²). Where a law fits, s = 0 and
//! every sample counts; where none fits, a block counts as one however long, and a hold weighs by
//! its logarithm: 15 s at 5 kHz do not drown the approach. k and s are those of the best candidate of
//! a first round with σ alone; s makes χ² = N there. The second round is the result.
//!
//! **What was before.** A law that relaxes and whose log begins in contact remembers what nobody saw: it may have been touched
//! long ago, as is assumed, or just now. Blocks for which that makes a difference weigh nothing, and what is left of it is in
//! the standard errors (`error`).

use super::blocks::{Node, Use};
use super::course::Course;
use super::fit::Fit;
use super::natural::natural;
use super::scales::Scales;
use crate::stats::highest;

/// What was before a log that begins in contact has told once this share of it is over, or, if nothing as hard comes later, of
/// its first touch: that is what a first fit counts from, before it is known how fast the material forgets.
const FORGOTTEN: f64 = 1.0 / 3.0;
/// What comes later is enough if it is this hard, of the hardest.
const ENOUGH: f64 = 0.5;

impl Course {
    /// The weights of the nodes by the noise of the force alone, of a first fit.
    pub(super) fn noise_weights(&self) -> Vec<f64> {
        let from = self.forgotten();
        let nodes = self.nodes.iter().enumerate();
        nodes
            .map(|(at, node)| match at < from {
                true => 0.0,
                false => weight(node, &self.scales, 0.0, 0.0),
            })
            .collect()
    }

    /// The first node of which what was before the log is forgotten, roughly; 0 of a log that begins in free air.
    fn forgotten(&self) -> usize {
        let Some(first) = self.touches.first().filter(|first| first.start == 0) else {
            return 0;
        };
        let until = |samples: usize| {
            let begins_s = self.nodes.first().map_or(0.0, |node| node.time_s);
            let until_s = begins_s + FORGOTTEN * samples as f64 * self.scales.period_s;
            self.nodes.partition_point(|node| node.time_s < until_s)
        };
        let hardest_n = |nodes: &[Node]| {
            let pressed = nodes
                .iter()
                .filter(|node| matches!(node.used, Use::Contact(_)));
            highest(pressed.map(|node| node.force_n)) - self.scales.rest_n
        };
        let from = until(self.uses.len());
        match hardest_n(&self.nodes[from..]) > ENOUGH * hardest_n(&self.nodes) {
            true => from,
            false => until(first.len()),
        }
    }

    /// The nodes of a log whose first touch, if it begins in one, has begun with it.
    pub(super) fn begun_just_now(&self) -> Vec<Node> {
        let mut nodes = self.nodes.clone();
        if let Some(first) = nodes.first_mut() {
            first.period_s = self.scales.period_s;
        }
        nodes
    }

    /// The variances (N²) of what a law remembers from before the log: anything between a touch of long ago, as the course
    /// has it, and one of this instant is as likely.
    fn remembered_n2(&self, fit: &Fit, long_ago_n: &[f64]) -> Vec<f64> {
        if !self.begins_in_contact() {
            return vec![0.0; long_ago_n.len()];
        }
        let just_now_n = forces(self, fit, &self.begun_just_now(), 0.0);
        let each = long_ago_n.iter().zip(just_now_n);
        each.map(|(a, b)| (a - b).powi(2) / 12.0).collect()
    }

    /// What a fit's force moves by (N) at every node for a depth that is so much (m) larger.
    pub(super) fn moved_n(&self, fit: &Fit, shift_m: f64) -> Vec<f64> {
        let force = |shift_m: f64| forces(self, fit, &self.nodes, shift_m);
        let both = force(shift_m).into_iter().zip(force(-shift_m));
        both.map(|(a, b)| 0.5 * (a - b)).collect()
    }

    /// From when on (s) a fit with these weights counts: always, of a log that begins in free air.
    pub(super) fn counts_from_s(&self, weights: &[f64]) -> f64 {
        let counts =
            |(node, weight): &(&Node, &f64)| matches!(node.used, Use::Contact(_)) && **weight > 0.0;
        let first = std::iter::zip(&self.nodes, weights).find(counts);
        match first {
            Some((node, _)) if self.begins_in_contact() => node.time_s,
            _ => f64::NEG_INFINITY,
        }
    }
}

/// 1/((σ² + k²ξ²h)/m + s²) for what is used: slope k (N/m), s² in N².
fn weight(node: &Node, scales: &Scales, slope: f64, missed_n2: f64) -> f64 {
    if node.used == Use::Out || node.count == 0.0 {
        return 0.0;
    }
    let by_position = (slope * scales.position_noise_m).powi(2) * node.held;
    1.0 / ((scales.noise_n.powi(2) + by_position) / node.count + missed_n2)
}

/// The weights of the second round, from the best fit of the first.
pub(super) fn second_weights(course: &Course, best: &Fit) -> Vec<f64> {
    let scales = &course.scales;
    let shift_m = 1e-3 * scales.depth_m;
    let force = |shift_m: f64| forces(course, best, &course.nodes, shift_m);
    let moved = force(shift_m).into_iter().zip(force(-shift_m));
    let slopes: Vec<f64> = moved.map(|(a, b)| (a - b) / (2.0 * shift_m)).collect();
    let now_n = force(0.0);
    let remembered_n2 = course.remembered_n2(best, &now_n);
    let weights = |missed_n2: f64| -> Vec<f64> {
        let nodes = course.nodes.iter().zip(&slopes).zip(&remembered_n2);
        nodes
            .map(|((node, slope), remembered_n2)| {
                let weight = weight(node, scales, *slope, missed_n2);
                if weight * remembered_n2 > 1.0 {
                    0.0
                } else {
                    weight
                }
            })
            .collect()
    };
    let errors: Vec<f64> = std::iter::zip(&now_n, &course.nodes)
        .map(|(force, node)| node.force_n - force)
        .collect();
    let chi_2 = |missed_n2: f64| {
        let (mut sum, mut count) = (0.0, 0.0);
        for (weight, error) in weights(missed_n2).iter().zip(&errors) {
            sum += weight * error * error;
            count += f64::from(u8::from(*weight > 0.0));
        }
        (sum / f64::max(count, 1.0), count)
    };
    let sigmas = course.thresholds.selection.misfit_sigmas;
    weights(missed_n2(chi_2, scales.noise_n.powi(2), sigmas))
}

/// The forces (N) of a fit along nodes of the course, with its surface so much (m) further out.
fn forces(course: &Course, fit: &Fit, nodes: &[Node], shift_m: f64) -> Vec<f64> {
    let mut law = natural(fit.family, &fit.free, &course.scales);
    law.surface_m -= shift_m;
    let mut forces = Vec::with_capacity(nodes.len());
    law.along(fit.family, nodes, |_, force| forces.push(force));
    forces
}

/// s² (N²) with which the mean of χ² is 1; 0 if the noise alone explains it.
fn missed_n2(chi_2: impl Fn(f64) -> (f64, f64), noise_n2: f64, sigmas: f64) -> f64 {
    let (mean, count) = chi_2(0.0);
    // χ²/N of pure noise scatters by √(2/N).
    if mean < 1.0 + sigmas * (2.0 / f64::max(count, 1.0)).sqrt() {
        return 0.0;
    }
    let (mut low, mut high) = (1e-6 * noise_n2, noise_n2);
    while chi_2(high).0 > 1.0 {
        high *= 4.0;
    }
    for _ in 0..30 {
        let middle = (low * high).sqrt();
        if chi_2(middle).0 > 1.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}

/// At the surface the force of (1) jumps by λδ̇: on which side a sample is, its rounding decides.
pub(super) fn mask_surface(weights: &mut [f64], course: &Course, fit: &Fit) {
    let scales = &course.scales;
    let surface_m = natural(fit.family, &fit.free, scales).surface_m;
    for (weight, node) in weights.iter_mut().zip(&course.nodes) {
        let travel_m =
            course.thresholds.samples.surface_travel * node.speed_mps.abs() * scales.period_s;
        if (node.position_m - surface_m).abs() <= travel_m + 2.0 * scales.position_noise_m {
            *weight = 0.0;
        }
    }
}
