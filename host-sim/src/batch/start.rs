//! Where the walk begins: all laws are linear in their forces once exponent, surface and rates are
//! given, so those are scanned, and the rest is solved for.
//!
//! The scan needs no initial guess: exponents from 1 to 2.5, surfaces from half of the depth before
//! the first force to nearly the deepest point, rates from half of 1/(longest touch) to a third of the sampling rate in a
//! dozen steps, of which every subset of the wanted size is tried.

use estimator_core::maths::scalar::Scalar;
use estimator_core::physics::law::{Elastic, MOST_MODES, QuasiLinear, RelaxationMode, RelaxingLaw};

use super::blocks::Node;
use super::course::Course;
use super::family::{Family, Form};
use super::natural::{damping_unit, free_of_exponent, reference_m};
use super::scales::Scales;
use crate::lsq::dense;

const EXPONENTS: [f64; 6] = [1.0, 1.2, 1.4, 1.65, 2.0, 2.5];
/// Rates of an exponential response times the deepest depth: over half of that depth its slope grows by
/// 1.4 to 55 times.
const STIFFENING: [f64; 5] = [0.7, 1.5, 3.0, 5.0, 8.0];
/// Surfaces before the first force, of the deepest depth; those behind it are for a force that rises long before the
/// contact, as the drag of a cantilever near a wall does: of a press of 2.2 µm the contact was the last 0.06 µm, and
/// Hunt and Crossley's law left 1.15 nN where 0.41 can be had.
const SURFACES: [f64; 15] = [
    -0.96, -0.9, -0.8, -0.65, -0.45, -0.25, -0.1, -0.02, 0.01, 0.04, 0.08, 0.13, 0.2, 0.32, 0.5,
];
/// Rates that are scanned.
const RATES: usize = 12;
/// Between touches, low forces are not scanned from this share of the deepest depth before the surface
/// on.
const NEAR: f64 = 0.5;
/// The scan looks at about so many nodes: every k-th of a longer course.
const SCANNED: usize = 4000;

/// A start for each family that was asked for: the best two of the scan, best first.
pub(super) struct Starts {
    found: Vec<(Family, Vec<Start>)>,
}

#[derive(Clone, Debug)]
struct Start {
    cost: f64,
    free: Vec<f64>,
}

/// What may be given instead of being scanned.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Given {
    /// Free number of the surface.
    pub(super) surface: Option<f64>,
    /// n
    pub(super) exponent: Option<f64>,
}

/// Best starts kept of each family.
const KEPT: usize = 2;

impl Starts {
    /// The free numbers to begin with.
    pub(super) fn of(&self, family: Family) -> impl Iterator<Item = Vec<f64>> + '_ {
        let scanned = family.with_probe();
        let own = self.found.iter().filter(move |(own, _)| *own == scanned);
        own.flat_map(|(_, starts)| starts.iter().map(|start| start.free.clone()))
    }

    fn offer(&mut self, family: Family, cost: f64, free: impl FnOnce() -> Vec<f64>) {
        let Some((_, starts)) = self.found.iter_mut().find(|(own, _)| *own == family) else {
            return;
        };
        let place = starts.partition_point(|start| start.cost <= cost);
        if place < KEPT {
            let free = free();
            starts.insert(place, Start { cost, free });
            starts.truncate(KEPT);
        }
    }
}

/// Scans exponents, surfaces and rates for the families.
pub(super) fn scan(families: &[Family], course: &Course, weights: &[f64], given: Given) -> Starts {
    let (nodes, scales) = (&course.nodes, &course.scales);
    let mut starts = Starts {
        found: families
            .iter()
            .map(|family| (family.with_probe(), Vec::new()))
            .collect(),
    };
    let stride = nodes.len().div_ceil(SCANNED).max(1);
    let mut thinned = Thinned::every(stride, nodes, weights);
    thinned.drop_unilateral(scales, course.thresholds.samples.released_force);
    let exponents = given.exponent.map_or(EXPONENTS.to_vec(), |n| vec![n]);
    let surfaces: Vec<f64> = match given.surface {
        Some(surface) => vec![surface],
        None => SURFACES.iter().map(|before| -before).collect(),
    };
    let deep = families.iter().any(|family| family.modes > 0);
    let has = |form| families.iter().any(|family| family.elastic == form);
    let powers = exponents.into_iter().map(|n| (Form::Power, n));
    let stiffening = STIFFENING.into_iter().map(|rate| (Form::Exponential, rate));
    let shapes = powers.chain(stiffening).filter(|(form, _)| has(*form));
    for (form, shape) in shapes {
        for surface in &surfaces {
            let place = Place {
                form,
                shape,
                surface: *surface,
            };
            if form == Form::Power {
                scan_memoryless(&mut starts, &thinned, scales, place);
            }
            if deep {
                scan_relaxing(&mut starts, &thinned, scales, place);
            }
        }
    }
    starts
}

/// A point of the grid.
#[derive(Clone, Copy)]
struct Place {
    form: Form,
    /// n of a power, bD of an exponential.
    shape: f64,
    /// Free number of the surface.
    surface: f64,
}

struct Thinned {
    nodes: Vec<Node>,
    weights: Vec<f64>,
}

impl Thinned {
    fn every(stride: usize, nodes: &[Node], weights: &[f64]) -> Thinned {
        let kept = || (0..nodes.len()).step_by(stride);
        let mut thinned: Vec<Node> = kept().map(|at| nodes[at]).collect();
        for at in 1..thinned.len() {
            thinned[at].period_s = thinned[at].time_s - thinned[at - 1].time_s;
        }
        Thinned {
            nodes: thinned,
            weights: kept().map(|at| weights[at]).collect(),
        }
    }

    /// Between touches, near the surface, a law that remembers may be below zero and the probe free:
    /// what is linear here does not know that.
    fn drop_unilateral(&mut self, scales: &Scales, low: f64) {
        let free_m = scales.touch_m - NEAR * scales.depth_m;
        let low_n = scales.rest_n + low * scales.force_n;
        let mut touched = false;
        for (node, weight) in self.nodes.iter().zip(&mut self.weights) {
            touched |= node.force_n > low_n;
            if touched && node.force_n <= low_n && node.position_m > free_m {
                *weight = 0.0;
            }
        }
    }
}

/// Normal equations of a linear fit, and its smallest cost for any subset of the columns.
struct Linear {
    columns: usize,
    gram: Vec<f64>,
    right: Vec<f64>,
    square: f64,
}

impl Linear {
    fn new(columns: usize) -> Linear {
        Linear {
            columns,
            gram: vec![0.0; columns * columns],
            right: vec![0.0; columns],
            square: 0.0,
        }
    }

    fn add(&mut self, row: &[f64], value: f64, weight: f64) {
        self.square += weight * value * value;
        for (i, one) in row.iter().enumerate() {
            self.right[i] += weight * one * value;
            for (j, other) in row.iter().enumerate().take(i + 1) {
                self.gram[i * self.columns + j] += weight * one * other;
            }
        }
    }

    /// Cost and coefficients with these columns alone.
    fn solve(&self, columns: &[usize]) -> Option<(f64, Vec<f64>)> {
        let n = columns.len();
        let mut gram = vec![0.0; n * n];
        for (i, one) in columns.iter().enumerate() {
            for (j, other) in columns.iter().enumerate() {
                let (row, column) = (*one.max(other), *one.min(other));
                gram[i * n + j] = self.gram[row * self.columns + column];
            }
            gram[i * n + i] *= 1.0 + 1e-12;
        }
        let right: Vec<f64> = columns.iter().map(|column| self.right[*column]).collect();
        let factor = dense::cholesky(&gram, n)?;
        let solution = dense::solve(&factor, n, &right);
        let explained: f64 = solution.iter().zip(&right).map(|(x, b)| x * b).sum();
        Some((self.square - explained, solution))
    }
}

/// [1, e, e·v] for Hunt–Crossley, [1, δ, v] for Kelvin–Voigt.
fn scan_memoryless(starts: &mut Starts, course: &Thinned, scales: &Scales, place: Place) {
    let surface_m = scales.touch_m + place.surface * scales.depth_m;
    let linear = place.shape == 1.0;
    let unit = scales.force_n / damping_unit(scales);
    let (mut kelvin_voigt, mut hunt_crossley) = (Linear::new(3), Linear::new(3));
    for (node, weight) in course.nodes.iter().zip(&course.weights) {
        if *weight <= 0.0 {
            continue;
        }
        let depth = (node.position_m - surface_m).max(0.0) / reference_m(scales);
        let (power, speed) = (depth.powf(place.shape), node.speed_mps / unit);
        let value = (node.force_n - scales.rest_n) / scales.force_n;
        hunt_crossley.add(&[1.0, power, power * speed], value, *weight);
        let touching = f64::from(u8::from(depth > 0.0));
        if linear {
            kelvin_voigt.add(&[1.0, depth, touching * speed], value, *weight);
        }
    }
    let all = [0, 1, 2];
    for (family, solved) in [
        (Family::HUNT_CROSSLEY, hunt_crossley.solve(&all)),
        (
            Family::KELVIN_VOIGT,
            kelvin_voigt.solve(&all).filter(|_| linear),
        ),
    ] {
        if let Some((cost, x)) = solved
            && x[1] > 0.0
        {
            starts.offer(family, cost, || {
                let mut free = vec![place.surface, x[0], x[1].ln(), x[2]];
                if family == Family::HUNT_CROSSLEY {
                    free.extend([free_of_exponent(place.shape), 0.0]);
                }
                free
            });
        }
    }
}

/// The rates of the scan (1/s), slow to fast.
fn rates(scales: &Scales) -> Vec<f64> {
    let slowest = 0.5 / scales.longest_s;
    let fastest = (0.3 / scales.period_s).max(10.0 * slowest);
    let step = (fastest / slowest).powf(1.0 / (RATES - 1) as f64);
    (0..RATES).map(|i| slowest * step.powi(i as i32)).collect()
}

/// [1, e, w₁ − e, …]: what each mode takes away from the elastic force.
fn scan_relaxing(starts: &mut Starts, course: &Thinned, scales: &Scales, place: Place) {
    let rates = rates(scales);
    let columns = relaxed(course, scales, place, &rates);
    let mut linear = Linear::new(RATES + 2);
    let mut row = [1.0; RATES + 2];
    for (at, (node, weight)) in course.nodes.iter().zip(&course.weights).enumerate() {
        if *weight <= 0.0 {
            continue;
        }
        let elastic = columns[RATES][at];
        row[1] = elastic;
        for (mode, entry) in row[2..].iter_mut().enumerate() {
            *entry = columns[mode][at] - elastic;
        }
        let value = (node.force_n - scales.rest_n) / scales.force_n;
        linear.add(&row, value, *weight);
    }
    for modes in 1..=MOST_MODES {
        let Some(family) = Family::quasi_linear(modes).shaped(place.form) else {
            continue;
        };
        let zener = modes == 1 && place.form == Form::Power && place.shape == 1.0;
        for subset in subsets(modes) {
            let mut chosen = vec![0, 1];
            chosen.extend(subset.iter().map(|mode| mode + 2));
            let Some((cost, x)) = linear.solve(&chosen) else {
                continue;
            };
            let relaxing: f64 = x[2..].iter().sum();
            if x[2..].iter().any(|c| *c <= 0.0) || relaxing >= x[1] {
                continue;
            }
            let head = vec![place.surface, x[0], x[1].ln()];
            let pairs: Vec<f64> = subset
                .iter()
                .zip(&x[2..])
                .flat_map(|(mode, c)| [(c / (x[1] - relaxing)).ln(), rates[*mode].ln()])
                .collect();
            let shape = match place.form {
                Form::Power => free_of_exponent(place.shape),
                Form::Exponential => place.shape.ln(),
            };
            starts.offer(family, cost, || {
                [head.clone(), vec![shape], pairs.clone()].concat()
            });
            if zener {
                starts.offer(Family::ZENER, cost, || [head, pairs].concat());
            }
        }
    }
}

/// Subsets of so many of the rates, in order.
fn subsets(modes: usize) -> impl Iterator<Item = Vec<usize>> {
    (0u32..1 << RATES)
        .filter(move |bits| bits.count_ones() as usize == modes)
        .map(|bits| (0..RATES).filter(|i| bits >> i & 1 == 1).collect())
}

/// What is left of the elastic force with one mode that relaxes all of it, at every node; a column a
/// rate, and the elastic force itself at the end. In units of the force scale for K = 1.
fn relaxed(course: &Thinned, scales: &Scales, place: Place, rates: &[f64]) -> Vec<Vec<f64>> {
    let surface_m = scales.touch_m + place.surface * scales.depth_m;
    // 1 at the reference depth, which is the unit of depth here.
    let elastic = match place.form {
        Form::Power => Elastic::Power {
            stiffness_n_per_m: 1.0,
            exponent: place.shape,
            reference_depth_m: 1.0,
        },
        Form::Exponential => {
            let rate = place.shape * reference_m(scales) / scales.depth_m;
            Elastic::Exponential {
                stiffness_n_per_m: 1.0 / rate.exprel(),
                stiffening_rate_per_m: rate,
            }
        }
    };
    let depth = |node: &Node| (node.position_m - surface_m) / reference_m(scales);
    let column = |rate: &f64| {
        let law = QuasiLinear {
            elastic,
            modes: [RelaxationMode {
                fraction: 1.0,
                rate_per_s: *rate,
            }],
        };
        let mut state = law.at_rest();
        let nodes = course.nodes.iter();
        nodes
            .map(|node| law.step(&mut state, depth(node), 0.0, node.period_s))
            .collect()
    };
    let mut columns: Vec<Vec<f64>> = rates.iter().map(column).collect();
    let at_once = course.nodes.iter().map(|node| elastic.force_n(depth(node)));
    columns.push(at_once.collect());
    columns
}
