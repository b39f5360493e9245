//! The best fit of the base model to a log: what the gap ratio of a case is measured with.
//!
//! Levenberg–Marquardt with differences for gradients, on the motor's true position (without the
//! encoder's counts), from the true values; parameters are scaled by their start.

use super::material::{Law, Material};
use super::plant::Plant;

/// A log that the base is fitted to.
#[derive(Clone, Debug)]
pub(crate) struct Target {
    /// Position (m), speed (m/s) and force (N).
    pub(crate) x: Vec<f64>,
    pub(crate) v: Vec<f64>,
    pub(crate) f: Vec<f64>,
    /// Between samples (s).
    pub(crate) dt: f64,
}

/// What the fit leaves.
#[derive(Clone, Debug)]
pub(crate) struct Fit {
    pub(crate) numbers: Vec<f64>,
    pub(crate) rmse_n: f64,
    /// ∂F/∂parameter, a column each.
    jacobian: Vec<Vec<f64>>,
}

impl Target {
    /// Every `stride`-th sample; speed by central differences of the full series.
    pub(crate) fn new(x: &[f64], f: &[f64], period_s: f64, stride: usize) -> Self {
        let speed = |k: usize| {
            let (low, high) = (k.saturating_sub(1), (k + 1).min(x.len() - 1));
            (x[high] - x[low]) / ((high - low) as f64 * period_s)
        };
        let picked = || (0..x.len()).step_by(stride);
        Target {
            x: picked().map(|k| x[k]).collect(),
            v: picked().map(speed).collect(),
            f: picked().map(|k| f[k]).collect(),
            dt: period_s * stride as f64,
        }
    }

    fn predict(&self, law: Law, numbers: &[f64]) -> Vec<f64> {
        // The base alone asks for no acceleration.
        Plant::bare(Material::from_numbers(law, numbers)).force(&self.x, &self.v, &self.v, self.dt)
    }

    /// Least squares over the base's parameters, and over factors of further `columns`.
    pub(crate) fn fit(&self, law: Law, start: &[f64], columns: &[Vec<f64>]) -> Fit {
        let mut numbers = start.to_vec();
        let mut damp = 1e-3;
        let (mut sum, mut residual) = self.residual(law, &numbers, columns);
        let mut jacobian = self.jacobian(law, &numbers);
        for _ in 0..40 {
            let free = without(&jacobian, columns);
            let (normal, right) = normal(&free, &residual);
            let step = solve_damped(&normal, &right, damp);
            let tried = bounded(law, &numbers, &step);
            let (next, next_residual) = self.residual(law, &tried, columns);
            if next < sum {
                let done = sum - next < 1e-7 * sum;
                (numbers, sum, residual) = (tried, next, next_residual);
                if done {
                    break;
                }
                jacobian = self.jacobian(law, &numbers);
                damp = f64::max(damp * 0.2, 1e-9);
            } else {
                damp *= 8.0;
                if damp > 1e8 {
                    break;
                }
            }
        }
        let rmse_n = (sum / self.f.len() as f64).sqrt();
        Fit {
            numbers,
            rmse_n,
            jacobian: without(&jacobian, columns),
        }
    }

    fn residual(&self, law: Law, numbers: &[f64], columns: &[Vec<f64>]) -> (f64, Vec<f64>) {
        let predicted = self.predict(law, numbers);
        let raw = self.f.iter().zip(&predicted).map(|(f, p)| f - p).collect();
        let residual = without(&[raw], columns).remove(0);
        (residual.iter().map(|r| r * r).sum(), residual)
    }

    fn jacobian(&self, law: Law, numbers: &[f64]) -> Vec<Vec<f64>> {
        let column = |index: usize| {
            let step = difference(law, numbers, index);
            let moved = |by: f64| {
                let mut moved = numbers.to_vec();
                moved[index] += by;
                self.predict(law, &moved)
            };
            let (high, low) = (moved(step), moved(-step));
            high.iter()
                .zip(&low)
                .map(|(h, l)| (h - l) / (2.0 * step))
                .collect()
        };
        (0..numbers.len()).map(column).collect()
    }
}

impl Fit {
    /// RMS (N) of what the base cannot follow of a further force.
    pub(crate) fn beyond_n(&self, force: &[f64]) -> f64 {
        let left = without(&[force.to_vec()], &self.jacobian).remove(0);
        rms(&left)
    }
}

/// Root mean square.
pub(crate) fn rms(series: &[f64]) -> f64 {
    (series.iter().map(|r| r * r).sum::<f64>() / series.len() as f64).sqrt()
}

/// Step of a central difference: 10⁻⁴ of the parameter, 1 µm of the surface.
fn difference(law: Law, numbers: &[f64], index: usize) -> f64 {
    if law.parameters()[index] == "surface" {
        1e-6
    } else {
        (1e-4 * numbers[index].abs()).max(1e-6)
    }
}

/// Inside what a material can be; no step is longer than a factor of two.
fn bounded(law: Law, numbers: &[f64], step: &[f64]) -> Vec<f64> {
    let one = |((name, old), by): ((&&str, &f64), &f64)| match *name {
        "surface" => old + by.clamp(-1e-3, 1e-3),
        "damping" => (old + by).max(1e-4),
        "exponent" => (old + by.clamp(-0.3, 0.3)).clamp(0.3, 5.0),
        "relaxation_fraction_1" => (old + by.clamp(-0.2, 0.2)).clamp(0.001, 0.98),
        _ => (old + by).clamp(0.4 * old, 2.5 * old),
    };
    law.parameters()
        .iter()
        .zip(numbers)
        .zip(step)
        .map(one)
        .collect()
}

/// Columns with their projection on `others` taken out.
fn without(columns: &[Vec<f64>], others: &[Vec<f64>]) -> Vec<Vec<f64>> {
    if others.is_empty() {
        return columns.to_vec();
    }
    columns
        .iter()
        .map(|column| {
            let (normal, right) = normal(others, column);
            let share = solve_damped(&normal, &right, 1e-12);
            let mut left = column.clone();
            for (other, share) in others.iter().zip(share) {
                for (l, o) in left.iter_mut().zip(other) {
                    *l -= share * o;
                }
            }
            left
        })
        .collect()
}

fn normal(columns: &[Vec<f64>], right: &[f64]) -> (Vec<Vec<f64>>, Vec<f64>) {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let rows = columns
        .iter()
        .map(|a| columns.iter().map(|b| dot(a, b)).collect())
        .collect();
    (rows, columns.iter().map(|a| dot(a, right)).collect())
}

/// (A + damp·diag A)⁻¹ b by elimination, scaled by the diagonal; a column of zeros gets no step.
fn solve_damped(a: &[Vec<f64>], b: &[f64], damp: f64) -> Vec<f64> {
    let n = b.len();
    let scale: Vec<f64> = (0..n)
        .map(|i| if a[i][i] > 0.0 { a[i][i].sqrt() } else { 1.0 })
        .collect();
    let mut rows: Vec<Vec<f64>> = (0..n)
        .map(|i| {
            let mut row: Vec<f64> = (0..n).map(|j| a[i][j] / (scale[i] * scale[j])).collect();
            row[i] += damp + if a[i][i] > 0.0 { 0.0 } else { 1.0 };
            row.push(b[i] / scale[i]);
            row
        })
        .collect();
    for i in 0..n {
        let pivot = (i..n)
            .max_by(|p, q| rows[*p][i].abs().total_cmp(&rows[*q][i].abs()))
            .unwrap_or(i);
        rows.swap(i, pivot);
        let top = rows[i].clone();
        for row in rows.iter_mut().skip(i + 1) {
            let factor = row[i] / top[i];
            for (r, t) in row.iter_mut().zip(&top) {
                *r -= factor * t;
            }
        }
    }
    let mut x = vec![0.0; n];
    for i in (0..n).rev() {
        let known: f64 = (i + 1..n).map(|j| rows[i][j] * x[j]).sum();
        x[i] = (rows[i][n] - known) / rows[i][i];
    }
    x.iter().zip(&scale).map(|(x, s)| x / s).collect()
}
