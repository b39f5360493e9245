//! Least squares: the best fit to a log of the base, which gives the gap ratio of a case, and of the base
//! with an effect in the catalogue's form.
//!
//! Levenberg–Marquardt with differences for gradients, on the motor's true position (without the
//! encoder's counts), from the true values.

use super::material::{Law, Material};
use super::plant::Plant;

/// How far a parameter may move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Limit {
    /// By a factor of 2.5 at most, never through zero.
    Scaled,
    /// Inside a range, by `reach` at most; its derivative is a difference over ± `step`.
    Within {
        low: f64,
        high: f64,
        reach: f64,
        step: f64,
    },
}

impl Limit {
    /// Anywhere, by `reach` at most in a step.
    pub(crate) fn free(reach: f64) -> Limit {
        let (low, high) = (f64::NEG_INFINITY, f64::INFINITY);
        Limit::Within {
            low,
            high,
            reach,
            step: 1e-3 * reach,
        }
    }

    fn moved(self, from: f64, by: f64) -> f64 {
        match self {
            Limit::Scaled => (from + by).clamp(0.4 * from, 2.5 * from),
            Limit::Within {
                low, high, reach, ..
            } => (from + by.clamp(-reach, reach)).clamp(low, high),
        }
    }

    fn step(self, at: f64) -> f64 {
        match self {
            Limit::Scaled => 1e-4 * at,
            Limit::Within { step, .. } => step,
        }
    }
}

/// Force (N) at every sample, of parameters.
type Model<'a> = Box<dyn Fn(&[f64]) -> Vec<f64> + 'a>;

/// A measured force and the model that is fitted to it.
pub(crate) struct Target<'a> {
    /// The measured force (N).
    pub(crate) f: Vec<f64>,
    /// The model: force (N) at every sample as a function of the parameters.
    pub(crate) predict: Model<'a>,
    /// How far each parameter may move.
    pub(crate) limits: Vec<Limit>,
}

/// The result of a fit.
#[derive(Clone, Debug)]
pub(crate) struct Fit {
    /// What the fit leaves (N).
    pub(crate) rmse_n: f64,
    /// ∂F/∂parameter, a column each.
    jacobian: Vec<Vec<f64>>,
}

/// The speed (m/s) by central differences.
pub(crate) fn speed(x: &[f64], period_s: f64) -> Vec<f64> {
    let at = |k: usize| {
        let (low, high) = (k.saturating_sub(1), (k + 1).min(x.len() - 1));
        (x[high] - x[low]) / ((high - low) as f64 * period_s)
    };
    (0..x.len()).map(at).collect()
}

/// How far the base's parameters may move.
pub(crate) fn base_limits(law: Law) -> Vec<Limit> {
    let within = |low: f64, high: f64, reach: f64, step: f64| Limit::Within {
        low,
        high,
        reach,
        step,
    };
    let limit = |name: &&str| match *name {
        "surface" => within(-1.0, 1.0, 1e-3, 1e-6),
        // A damper may vanish.
        "damping" => within(1e-4, 1e6, 1e6, 1e-3),
        "exponent" => within(0.3, 5.0, 0.3, 1e-4),
        "relaxation_fraction_1" => within(1e-3, 0.98, 0.2, 1e-4),
        _ => Limit::Scaled,
    };
    law.parameters().iter().map(limit).collect()
}

impl<'a> Target<'a> {
    /// The base on every `stride`-th sample of a log at 1 kHz.
    pub(crate) fn base(law: Law, x: &[f64], f: &[f64], stride: usize) -> Target<'a> {
        let thin =
            |series: &[f64]| -> Vec<f64> { series.iter().copied().step_by(stride).collect() };
        let (v, x) = (thin(&speed(x, 1e-3)), thin(x));
        let dt = 1e-3 * stride as f64;
        // The base by itself needs no acceleration.
        let predict = move |numbers: &[f64]| {
            Plant::bare(Material::from_numbers(law, numbers)).force(&x, &v, &v, dt)
        };
        Target {
            f: thin(f),
            predict: Box::new(predict),
            limits: base_limits(law),
        }
    }

    /// Least squares over the parameters, and over factors of further `columns`.
    pub(crate) fn fit(&self, start: &[f64], columns: &[Vec<f64>]) -> Fit {
        let mut numbers = start.to_vec();
        let mut damp = 1e-3;
        let (mut sum, mut residual) = self.residual(&numbers, columns);
        let mut jacobian = self.jacobian(&numbers, columns);
        for _ in 0..40 {
            let (normal, right) = normal(&jacobian, &residual);
            let step = solve_damped(&normal, &right, damp);
            let moved = self.limits.iter().zip(&numbers).zip(&step);
            let tried: Vec<f64> = moved
                .map(|((limit, from), by)| limit.moved(*from, *by))
                .collect();
            let (next, next_residual) = self.residual(&tried, columns);
            if next < sum {
                let done = sum - next < 1e-7 * sum;
                (numbers, sum, residual) = (tried, next, next_residual);
                if done {
                    break;
                }
                jacobian = self.jacobian(&numbers, columns);
                damp = f64::max(damp * 0.2, 1e-9);
            } else {
                damp *= 8.0;
                if damp > 1e8 {
                    break;
                }
            }
        }
        Fit {
            rmse_n: (sum / self.f.len() as f64).sqrt(),
            jacobian,
        }
    }

    fn residual(&self, numbers: &[f64], columns: &[Vec<f64>]) -> (f64, Vec<f64>) {
        let predicted = (self.predict)(numbers);
        let raw = self.f.iter().zip(&predicted).map(|(f, p)| f - p).collect();
        let residual = without(&[raw], columns).remove(0);
        (residual.iter().map(|r| r * r).sum(), residual)
    }

    fn jacobian(&self, numbers: &[f64], columns: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let column = |(index, limit): (usize, &Limit)| -> Vec<f64> {
            let step = limit.step(numbers[index]);
            let moved = |by: f64| {
                let mut moved = numbers.to_vec();
                moved[index] += by;
                (self.predict)(&moved)
            };
            let (high, low) = (moved(step), moved(-step));
            high.iter()
                .zip(&low)
                .map(|(h, l)| (h - l) / (2.0 * step))
                .collect()
        };
        let all: Vec<Vec<f64>> = self.limits.iter().enumerate().map(column).collect();
        without(&all, columns)
    }
}

impl Fit {
    /// The root mean square (N) of the part of a force that the base and further `columns` cannot follow.
    pub(crate) fn beyond_with_n(&self, force: &[f64], columns: &[Vec<f64>]) -> f64 {
        let others = [self.jacobian.as_slice(), columns].concat();
        rms(&without(&[force.to_vec()], &others).remove(0))
    }
}

/// The root mean square.
pub fn rms(series: &[f64]) -> f64 {
    (series.iter().map(|r| r * r).sum::<f64>() / series.len() as f64).sqrt()
}

/// The columns without their projection on `others`.
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
