//! The weighted least-squares problem: cost, residuals, Jacobian and normal equations.
//!
//! The Jacobian is exact: the rig itself runs over the whole log in dual numbers, up to twelve columns at a time.

use estimator_core::maths::Dual;
use estimator_core::physics::rig::Rig;
use rayon::prelude::*;

use crate::gap::data::{fit_data::FitData, low_pass::LowPass};
use crate::gap::model::{
    known::Known, known::Reading, shape::Shape, simulate::forces_of, simulate::run_rig,
};
use crate::lsq::{NormalEquations, basis::dot};

/// Most columns of the Jacobian that one run of the rig gives. A run with four to eight took 2.2 times as long as one
/// without: values are half of it, and two runs compute them twice.
const MOST_LANES: usize = 12;

/// Logs, and the weight of each of their samples.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Problem<'a> {
    pub(crate) logs: &'a [FitData],
    /// 1/N² for each sample, log after log; 0 leaves a sample out.
    pub(crate) weights: &'a [f64],
    /// The low-pass that predictions and gradients go through, as the forces of the logs have.
    pub(crate) low_pass: Option<LowPass>,
    /// What is known of the numbers beside the logs.
    pub(crate) known: Option<&'a Known>,
}

/// The residuals and the Jacobian at some values of the free numbers.
pub(crate) struct Linearization {
    /// Measured minus predicted force (N), log after log.
    pub(crate) residuals: Vec<f64>,
    /// The derivatives of the predicted force, a column for each free number.
    pub(crate) columns: Vec<Vec<f64>>,
    /// What is known of the free numbers beside the logs.
    pub(crate) readings: Vec<Reading>,
}

impl Problem<'_> {
    /// The same with this known beside the logs.
    pub(crate) fn knowing<'b>(&'b self, known: &'b Known) -> Problem<'b> {
        Problem {
            known: Some(known),
            ..*self
        }
    }

    /// The samples with a weight.
    pub(crate) fn used(&self) -> Vec<usize> {
        let all = 0..self.weights.len();
        all.filter(|at| self.weights[*at] > 0.0).collect()
    }

    /// Σ w r², with what is known beside the logs.
    pub(crate) fn cost(&self, shape: &Shape, numbers: &[f64]) -> f64 {
        let readings = self.readings(shape, numbers);
        self.weighted_square(&self.residuals(shape, numbers)) + squares(&readings)
    }

    fn readings(&self, shape: &Shape, numbers: &[f64]) -> Vec<Reading> {
        let known = self.known.map(|known| known.readings(shape, numbers));
        known.unwrap_or_default()
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
        self.residuals_of(&self.forces(shape, numbers))
    }

    /// Measured minus these forces (N), log after log.
    pub(crate) fn residuals_of(&self, forces: &[f64]) -> Vec<f64> {
        let measured = self.logs.iter().flat_map(|log| &log.force_n);
        let each = forces.iter().zip(measured);
        let mut residuals: Vec<f64> = each.map(|(force, measured)| measured - force).collect();
        self.without_steps(&mut residuals);
        residuals
    }

    /// Residuals over their standard deviations, of the samples with a weight.
    pub(crate) fn white(&self, residuals: &[f64]) -> Vec<f64> {
        let each = residuals.iter().zip(self.weights);
        let weighted = each.filter(|(_, weight)| **weight > 0.0);
        weighted.map(|(r, weight)| r * weight.sqrt()).collect()
    }

    /// Takes off a channel what steps of the zero make of it: its weighted mean between each and the next.
    pub(crate) fn without_steps(&self, channel: &mut [f64]) {
        let mut from = 0;
        for log in self.logs {
            for rows in log.after_steps() {
                let rows = from + rows.start..from + rows.end;
                let weights = &self.weights[rows.clone()];
                let each = channel[rows.clone()].iter().zip(weights);
                let (sum, weight) = each.fold((0.0, 0.0), |(sum, weight), (value, own)| {
                    (sum + own * value, weight + own)
                });
                if weight > 0.0 {
                    let mean = sum / weight;
                    channel[rows].iter_mut().for_each(|value| *value -= mean);
                }
            }
            from += log.len();
        }
    }

    /// The predicted forces (N), log after log, through the low-pass.
    pub(crate) fn forces(&self, shape: &Shape, numbers: &[f64]) -> Vec<f64> {
        self.forces_of(&shape.rig(numbers))
    }

    /// The forces (N) that a rig predicts, log after log, through the low-pass.
    pub(crate) fn forces_of(&self, rig: &Rig<f64>) -> Vec<f64> {
        let mut forces = forces_of(rig, self.logs);
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
        let mut columns = vec![vec![0.0; self.weights.len()]; numbers.len()];
        let fill = |(run, columns): (usize, &mut [Vec<f64>])| {
            let from = run * MOST_LANES;
            match columns.len() {
                0..=4 => self.fill_columns::<4>(shape, numbers, from, columns),
                5..=8 => self.fill_columns::<8>(shape, numbers, from, columns),
                _ => self.fill_columns::<MOST_LANES>(shape, numbers, from, columns),
            }
        };
        let runs = columns.par_chunks_mut(MOST_LANES).enumerate();
        let residuals: Vec<Vec<f64>> = runs.map(fill).collect();
        for column in &mut columns {
            self.filter(column);
            self.without_steps(column);
        }
        let residuals = match residuals.into_iter().next() {
            // The force of the logs has been filtered already, and not that of these runs.
            Some(mut residuals) if self.low_pass.is_none() => {
                self.without_steps(&mut residuals);
                residuals
            }
            _ => self.residuals(shape, numbers),
        };
        Linearization {
            residuals,
            columns,
            readings: self.readings(shape, numbers),
        }
    }

    /// Fills at most `N` columns of the Jacobian, of which the first is column `from`. Returns the residuals.
    fn fill_columns<const N: usize>(
        &self,
        shape: &Shape,
        numbers: &[f64],
        from: usize,
        columns: &mut [Vec<f64>],
    ) -> Vec<f64> {
        let dual: Vec<Dual<f64, N>> = numbers
            .iter()
            .enumerate()
            .map(|(at, value)| match at.checked_sub(from) {
                Some(lane) if lane < N => Dual::parameter(*value, lane),
                _ => Dual::constant(*value),
            })
            .collect();
        let rig = shape.rig(&dual);
        let mut residuals = Vec::with_capacity(self.weights.len());
        for log in self.logs {
            run_rig(&rig, log, |at, reading| {
                let force = reading.force_n;
                for (column, slope) in columns.iter_mut().zip(force.gradient) {
                    // At a corner of a law the slope may be infinite; it then says nothing.
                    column[residuals.len()] = if slope.is_finite() { slope } else { 0.0 };
                }
                residuals.push(log.force_n[at] - force.value);
            });
        }
        residuals
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
        for reading in &linear.readings {
            let at = reading.number;
            curvature[at * n + at] += reading.slope.powi(2);
            downhill[at] += reading.slope * reading.residual;
        }
        NormalEquations {
            cost: self.weighted_square(&linear.residuals) + squares(&linear.readings),
            curvature,
            downhill,
        }
    }
}

fn squares(readings: &[Reading]) -> f64 {
    readings.iter().map(|own| own.residual.powi(2)).sum()
}
