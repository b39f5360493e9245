//! The weighted least-squares problem: cost, residuals, Jacobian and normal equations.
//!
//! The Jacobian is exact: the rig itself runs over the whole log in dual numbers, eight columns at a time.

use estimator_core::maths::Dual;

use crate::gap::data::{fit_data::FitData, low_pass::LowPass};
use crate::gap::model::{basis::dot, shape::Shape, simulate::forces, simulate::run_rig};
use crate::lsq::NormalEquations;

/// Columns of the Jacobian that one run of the rig gives.
const LANES: usize = 8;

/// Logs, and the weight of each of their samples.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Problem<'a> {
    pub(crate) logs: &'a [FitData],
    /// 1/N² for each sample, log after log; 0 leaves a sample out.
    pub(crate) weights: &'a [f64],
    /// The low-pass that predictions and gradients go through, as the forces of the logs have.
    pub(crate) low_pass: Option<LowPass>,
}

/// The residuals and the Jacobian at some values of the free numbers.
pub(crate) struct Linearization {
    /// Measured minus predicted force (N), log after log.
    pub(crate) residuals: Vec<f64>,
    /// The derivatives of the predicted force, a column for each free number.
    pub(crate) columns: Vec<Vec<f64>>,
}

impl Problem<'_> {
    /// The samples with a weight.
    pub(crate) fn used(&self) -> Vec<usize> {
        let all = 0..self.weights.len();
        all.filter(|at| self.weights[*at] > 0.0).collect()
    }

    /// Σ w r².
    pub(crate) fn cost(&self, shape: &Shape, numbers: &[f64]) -> f64 {
        self.weighted_square(&self.residuals(shape, numbers))
    }

    /// Σ w r² of residuals; the largest number where that is not finite.
    pub(crate) fn weighted_square(&self, residuals: &[f64]) -> f64 {
        let cost: f64 = residuals
            .iter()
            .zip(self.weights)
            .map(|(r, w)| w * r * r)
            .sum();
        if cost.is_finite() { cost } else { f64::MAX }
    }

    /// Measured minus predicted force (N), log after log.
    pub(crate) fn residuals(&self, shape: &Shape, numbers: &[f64]) -> Vec<f64> {
        let forces = self.forces(shape, numbers).into_iter();
        let measured = self.logs.iter().flat_map(|log| &log.force_n);
        forces
            .zip(measured)
            .map(|(force, measured)| measured - force)
            .collect()
    }

    /// The predicted forces (N), log after log, through the low-pass.
    pub(crate) fn forces(&self, shape: &Shape, numbers: &[f64]) -> Vec<f64> {
        let mut forces = forces(shape, numbers, self.logs);
        self.filter(&mut forces);
        forces
    }

    fn filter(&self, channel: &mut [f64]) {
        let Some(low_pass) = self.low_pass else {
            return;
        };
        let mut from = 0;
        for log in self.logs {
            low_pass.apply(&mut channel[from..from + log.len()], log.period_s);
            from += log.len();
        }
    }

    /// Residuals and Jacobian.
    pub(crate) fn linearize(&self, shape: &Shape, numbers: &[f64]) -> Linearization {
        let count = self.weights.len();
        let mut linear = Linearization {
            residuals: vec![0.0; count],
            columns: vec![vec![0.0; count]; numbers.len()],
        };
        let mut from = 0;
        while from < numbers.len().max(1) {
            match numbers.len() - from {
                0..=4 => self.fill_columns::<4>(shape, numbers, from, &mut linear),
                _ => self.fill_columns::<LANES>(shape, numbers, from, &mut linear),
            }
            from += LANES;
        }
        if self.low_pass.is_some() {
            // The force of the logs has been filtered already, so that the prediction alone is filtered
            // here.
            linear.residuals = self.residuals(shape, numbers);
            linear
                .columns
                .iter_mut()
                .for_each(|column| self.filter(column));
        }
        linear
    }

    /// Fills the residuals and `N` columns of the Jacobian, beginning at column `from`.
    fn fill_columns<const N: usize>(
        &self,
        shape: &Shape,
        numbers: &[f64],
        from: usize,
        linear: &mut Linearization,
    ) {
        let dual: Vec<Dual<f64, N>> = numbers
            .iter()
            .enumerate()
            .map(|(at, value)| match at.checked_sub(from) {
                Some(lane) if lane < N => Dual::parameter(*value, lane),
                _ => Dual::constant(*value),
            })
            .collect();
        let mut row = 0;
        for log in self.logs {
            run_rig(shape, &dual, log, |at, reading| {
                let force = reading.force_n;
                linear.residuals[row] = log.force_n[at] - force.value;
                for (column, slope) in linear.columns[from..].iter_mut().zip(force.gradient) {
                    // At a corner of a law the slope may be infinite; it then says nothing.
                    column[row] = if slope.is_finite() { slope } else { 0.0 };
                }
                row += 1;
            });
        }
    }

    /// The normal equations of a linearization.
    pub(crate) fn normal_equations(&self, linear: &Linearization) -> NormalEquations {
        let n = linear.columns.len();
        let weigh = |column: &Vec<f64>| {
            column
                .iter()
                .zip(self.weights)
                .map(|(j, w)| j * w)
                .collect()
        };
        let weighted: Vec<Vec<f64>> = linear.columns.iter().map(weigh).collect();
        let mut curvature = vec![0.0; n * n];
        let mut downhill = vec![0.0; n];
        for row in 0..n {
            downhill[row] = dot(&weighted[row], &linear.residuals);
            for column in 0..=row {
                let entry = dot(&weighted[row], &linear.columns[column]);
                curvature[row * n + column] = entry;
                curvature[column * n + row] = entry;
            }
        }
        NormalEquations {
            cost: self.weighted_square(&linear.residuals),
            curvature,
            downhill,
        }
    }
}
