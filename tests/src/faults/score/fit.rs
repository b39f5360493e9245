//! The offline fit of the law to a log, with nothing of the estimator in it: K, λ, n and the surface by
//! Levenberg–Marquardt on all rows. It says what the data can tell at most.

use crate::faults::rig::REFERENCE_M;
use crate::faults::rig::sensors::Rows;
use nalgebra::{Matrix4, Vector4};

/// Rows on either side that a cubic for position and speed takes.
const HALF: usize = 6;
/// Times between those rows that are too long for a cubic (s).
const LONGEST_S: f64 = 0.03;
/// Steps of the minimum search at most.
const STEPS: usize = 40;
/// The step that ends it, relative.
const SMALL: f64 = 1e-7;
/// Lags of the autocorrelation.
pub const LAGS: usize = 20;

/// A fit.
#[derive(Clone, Copy, Debug)]
pub struct Fit {
    /// K (N/m), λ (N s/m), n.
    pub values: [f64; 3],
    /// Their standard errors.
    pub std_errors: [f64; 3],
    /// What it leaves (N rms), away from the instants of touch.
    pub rmse_n: f64,
    /// Number of rows in it.
    pub rows: usize,
    /// N Σ ρ², which is χ² with 20 degrees of freedom for white noise.
    pub portmanteau: f64,
}

/// A row as the fit sees it.
struct Row {
    x: f64,
    v: f64,
    f: f64,
    /// The smallest and largest position in its window.
    low: f64,
    high: f64,
}

/// Position and speed of every row by a cubic through its neighbours at their stamps. A parabola is
/// wrong by 60 mN of damping where a ramp gathers its speed.
fn smooth(rows: &Rows) -> Vec<Row> {
    let number = rows.time_s.len();
    let places = HALF..number.saturating_sub(HALF);
    places.filter_map(|at| smooth_at(rows, at)).collect()
}

fn smooth_at(rows: &Rows, at: usize) -> Option<Row> {
    let length_s = rows.time_s[at + HALF] - rows.time_s[at - HALF];
    if length_s > LONGEST_S {
        return None;
    }
    let (mut matrix, mut right) = (Matrix4::zeros(), Vector4::zeros());
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for k in at - HALF..=at + HALF {
        // In units of the window: cubes of seconds would be small.
        let u = (rows.time_s[k] - rows.time_s[at]) / length_s;
        let powers = Vector4::new(1.0, u, u * u, u * u * u);
        matrix += powers * powers.transpose();
        right += powers * (rows.position_m[k] - rows.position_m[at]);
        low = low.min(rows.position_m[k]);
        high = high.max(rows.position_m[k]);
    }
    let solved = matrix.cholesky()?.solve(&right);
    Some(Row {
        x: rows.position_m[at] + solved[0],
        v: solved[1] / length_s,
        f: rows.force_n[at],
        low,
        high,
    })
}

/// K·δ₀ (N), λ (N s/m), n, surface (mm): numbers of similar size.
type Numbers = Vector4<f64>;

/// The force (N) and its gradient.
fn model(p: &Numbers, row: &Row) -> (f64, Vector4<f64>) {
    let depth = row.x - 1e-3 * p[3];
    if depth <= 0.0 {
        return (0.0, Vector4::zeros());
    }
    let log = (depth / REFERENCE_M).ln();
    let shape = (p[2] * log).exp();
    let inner = p[0] + p[1] * row.v;
    if inner <= 0.0 {
        return (0.0, Vector4::zeros());
    }
    let force = inner * shape;
    let slope = -1e-3 * p[2] * force / depth;
    (
        force,
        Vector4::new(shape, row.v * shape, force * log, slope),
    )
}

fn normal(p: &Numbers, rows: &[Row]) -> (f64, Matrix4<f64>, Vector4<f64>) {
    let (mut cost, mut matrix, mut down) = (0.0, Matrix4::zeros(), Vector4::zeros());
    for row in rows {
        let (force, gradient) = model(p, row);
        let error = row.f - force;
        cost += error * error;
        if force > 0.0 {
            matrix += gradient * gradient.transpose();
            down += gradient * error;
        }
    }
    (cost, matrix, down)
}

/// Fits the law to a log, from the given numbers and surface (m) on; `None` where the data do not
/// determine it.
pub fn fit(rows: &Rows, start: [f64; 3], surface_m: f64) -> Option<Fit> {
    let rows = smooth(rows);
    let mut p = Numbers::new(start[0] * REFERENCE_M, start[1], start[2], 1e3 * surface_m);
    let (mut cost, mut matrix, mut down) = normal(&p, &rows);
    let mut damp = 1e-4;
    for _ in 0..STEPS {
        let mut damped = matrix;
        for slot in 0..4 {
            damped[(slot, slot)] *= 1.0 + damp;
        }
        let step = damped.cholesky()?.solve(&down);
        let mut next = p + step;
        next[0] = next[0].clamp(0.2 * p[0], 5.0 * p[0]);
        next[2] = next[2].clamp(0.3, 4.0);
        let tried = normal(&next, &rows);
        if tried.0 > cost {
            damp *= 10.0;
            if damp > 1e8 {
                break;
            }
            continue;
        }
        let moved = (0..4).all(|slot| step[slot].abs() < SMALL * p[slot].abs().max(1e-2));
        p = next;
        (cost, matrix, down) = tried;
        damp = (0.1 * damp).max(1e-9);
        if moved {
            break;
        }
    }
    Some(result(&p, &rows, matrix.try_inverse()?))
}

fn result(p: &Numbers, rows: &[Row], inverse: Matrix4<f64>) -> Fit {
    let surface = 1e-3 * p[3];
    let errors: Vec<Option<f64>> = rows
        .iter()
        .map(|row| {
            // What smoothing rounds off at a touch is no misfit.
            let touches = row.low < surface && row.high > surface;
            (!touches).then(|| row.f - model(p, row).0)
        })
        .collect();
    let kept: Vec<f64> = errors.iter().flatten().copied().collect();
    let number = kept.len().max(1) as f64;
    let power = kept.iter().map(|e| e * e).sum::<f64>() / number;
    let portmanteau: f64 = (1..=LAGS)
        .map(|lag| {
            let pairs = errors.iter().zip(&errors[lag.min(errors.len())..]);
            let products = pairs.filter_map(|(a, b)| Some((*a)? * (*b)?));
            (products.sum::<f64>() / number / power).powi(2)
        })
        .sum();
    let error = |slot: usize| (power * inverse[(slot, slot)].max(0.0)).sqrt();
    Fit {
        values: [p[0] / REFERENCE_M, p[1], p[2]],
        std_errors: [error(0) / REFERENCE_M, error(1), error(2)],
        rmse_n: power.sqrt(),
        rows: kept.len(),
        portmanteau: number * portmanteau,
    }
}
