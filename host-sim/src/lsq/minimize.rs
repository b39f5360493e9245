//! Non-linear least squares: Levenberg–Marquardt within bounds.

use super::{NormalEquations, covariance::magnitudes, dense};

/// The damping beyond which normal equations that are not positive definite are given up.
const HOPELESS: f64 = 1e12;

/// Where a number may go.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limits {
    pub(crate) lowest: f64,
    pub(crate) highest: f64,
    /// How far one step may take the number.
    pub(crate) longest_step: f64,
}

/// For each number, whether it is at a bound that the gradient pushes it against.
pub(crate) fn blocked(limits: &[Limits], numbers: &[f64], downhill: &[f64]) -> Vec<bool> {
    let each = limits.iter().zip(numbers).zip(downhill);
    each.map(|((limits, number), down)| {
        (*number <= limits.lowest && *down < 0.0) || (*number >= limits.highest && *down > 0.0)
    })
    .collect()
}

/// How the normal equations are damped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum System {
    /// As they are: a number at a bound stays in them, and its step ends at the bound.
    Plain,
    /// In units of the columns' magnitudes, and without the numbers that their bounds block.
    Scaled,
}

/// Why a minimization stopped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Stop {
    /// A step promises too little.
    Converged,
    /// No step goes down: rounding, or a jump of the law at a sample on the surface.
    NoWayDown,
    /// The budget of steps is used up.
    Budget,
}

/// How a minimum is sought.
#[derive(Clone, Debug)]
pub(crate) struct Minimizer {
    pub(crate) limits: Vec<Limits>,
    pub(crate) system: System,
    pub(crate) most_steps: usize,
    /// Converged: a step promises less than this of Σ w r²; 1 is worth one standard error.
    pub(crate) least_gain: f64,
    /// And less than this share of it.
    pub(crate) least_share: f64,
    /// The damping from which on a step that does not go down is the last.
    pub(crate) most_damping: f64,
    /// What a step that does not go down multiplies the damping by, and the least damping after it.
    pub(crate) raise: (f64, f64),
}

/// Where a minimization stopped.
pub(crate) struct Minimum {
    pub(crate) numbers: Vec<f64>,
    /// Σ w r².
    pub(crate) cost: f64,
    pub(crate) stop: Stop,
}

impl Minimizer {
    /// Walks from `numbers` towards a minimum of `cost`, whose normal equations `normal_equations` gives.
    pub(crate) fn minimum(
        &self,
        mut numbers: Vec<f64>,
        cost: impl Fn(&[f64]) -> f64,
        normal_equations: impl Fn(&[f64]) -> NormalEquations,
    ) -> Minimum {
        let mut damping = 1e-3;
        let mut normal = normal_equations(&numbers);
        let mut stop = Stop::Budget;
        for left in (0..self.most_steps).rev() {
            let (step, promised) = self.step(&numbers, &normal, damping);
            if promised <= self.least_gain.max(self.least_share * normal.cost) {
                stop = Stop::Converged;
                break;
            }
            let each = numbers.iter().zip(&step).zip(&self.limits);
            let moved: Vec<f64> = each
                .map(|((number, step), limits)| {
                    let step = step.clamp(-limits.longest_step, limits.longest_step);
                    (number + step).clamp(limits.lowest, limits.highest)
                })
                .collect();
            let cost = cost(&moved);
            if cost < normal.cost {
                if left == 0 {
                    // Nothing steps from here: the normal equations are most of a step's work.
                    (numbers, normal.cost) = (moved, cost);
                    break;
                }
                let gained = (normal.cost - cost) / promised;
                damping *= if gained > 0.75 { 0.1 } else { 0.5 };
                normal = normal_equations(&moved);
                numbers = moved;
            } else if damping > self.most_damping {
                stop = Stop::NoWayDown;
                break;
            } else {
                damping = (damping * self.raise.0).max(self.raise.1);
            }
        }
        Minimum {
            numbers,
            cost: normal.cost,
            stop,
        }
    }

    /// The step of the damped normal equations, and what it promises to take from the cost.
    fn step(&self, numbers: &[f64], normal: &NormalEquations, mut damping: f64) -> (Vec<f64>, f64) {
        let (n, curvature) = (numbers.len(), &normal.curvature);
        let own: Vec<f64> = (0..n).map(|i| curvature[i * n + i]).collect();
        // One damping suits all columns if it is a share of the diagonal; the floor beside it keeps a number
        // that changes nothing where it is.
        let (size, diagonal, floor, blocked) = match self.system {
            System::Plain => {
                let floor = 1e-13 * own.iter().copied().fold(0.0, f64::max) + f64::MIN_POSITIVE;
                (vec![1.0; n], own.clone(), floor, vec![false; n])
            }
            System::Scaled => {
                let blocked = blocked(&self.limits, numbers, &normal.downhill);
                (magnitudes(curvature, n), vec![1.0; n], 1e-12, blocked)
            }
        };
        let entry = |row: usize, column: usize| match blocked[row] || blocked[column] {
            true => 0.0,
            false => curvature[row * n + column] / (size[row] * size[column]),
        };
        let mut system: Vec<f64> = (0..n * n).map(|at| entry(at / n, at % n)).collect();
        while damping <= HOPELESS {
            for i in 0..n {
                system[i * n + i] = diagonal[i] * (1.0 + damping) + floor;
            }
            if let Some(factor) = dense::cholesky(&system, n) {
                let right: Vec<f64> = (0..n).map(|at| normal.downhill[at] / size[at]).collect();
                let mut step = dense::solve(&factor, n, &right);
                for (at, step) in step.iter_mut().enumerate() {
                    let stays = blocked[at] || own[at] <= 0.0;
                    *step = if stays { 0.0 } else { *step / size[at] };
                }
                let along: f64 = step.iter().zip(&normal.downhill).map(|(s, g)| s * g).sum();
                let promised = 2.0 * along - dense::quadratic(curvature, &step);
                return (step, promised.max(0.0));
            }
            damping = (damping * 10.0).max(1e-9);
        }
        (vec![0.0; n], 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The minimum of (x − 1)²·100 + (y − 3)² from the origin, where x does not exceed `highest`.
    fn minimum(system: System, highest: f64, most_steps: usize) -> Minimum {
        let limits = |highest: f64| Limits {
            lowest: -10.0,
            highest,
            longest_step: 2.0,
        };
        let minimizer = Minimizer {
            limits: vec![limits(highest), limits(10.0)],
            system,
            most_steps,
            least_gain: 1e-12,
            least_share: 1e-12,
            most_damping: 1e6,
            raise: (10.0, 1e-5),
        };
        let cost = |at: &[f64]| 100.0 * (at[0] - 1.0).powi(2) + (at[1] - 3.0).powi(2);
        minimizer.minimum(vec![0.0; 2], cost, |at| NormalEquations {
            cost: cost(at),
            downhill: vec![100.0 * (1.0 - at[0]), 3.0 - at[1]],
            curvature: vec![100.0, 0.0, 0.0, 1.0],
        })
    }

    #[test]
    fn both_systems_find_the_minimum() {
        for system in [System::Plain, System::Scaled] {
            let found = minimum(system, 10.0, 20);
            assert_eq!(found.stop, Stop::Converged);
            assert!((found.numbers[0] - 1.0).abs() < 1e-6, "{:?}", found.numbers);
            assert!((found.numbers[1] - 3.0).abs() < 1e-5, "{:?}", found.numbers);
        }
    }

    #[test]
    fn a_number_stops_at_its_bound_and_the_others_go_on() {
        let found = minimum(System::Scaled, 0.5, 20);
        assert_eq!((found.stop, found.numbers[0]), (Stop::Converged, 0.5));
        assert!((found.numbers[1] - 3.0).abs() < 1e-5, "{:?}", found.numbers);
    }

    #[test]
    fn a_step_is_no_longer_than_its_limit_and_a_budget_that_is_used_up_is_said() {
        let found = minimum(System::Scaled, 10.0, 1);
        assert_eq!((found.stop, found.numbers[1]), (Stop::Budget, 2.0));
    }

    #[test]
    fn a_cost_that_nothing_lowers_ends_without_a_way_down() {
        let minimizer = Minimizer {
            limits: vec![Limits {
                lowest: -1.0,
                highest: 1.0,
                longest_step: 1.0,
            }],
            system: System::Plain,
            most_steps: 60,
            least_gain: 1e-12,
            least_share: 0.0,
            most_damping: 1e6,
            raise: (10.0, 1e-5),
        };
        let normal = |_: &[f64]| NormalEquations {
            cost: 1.0,
            downhill: vec![1.0],
            curvature: vec![1.0],
        };
        let found = minimizer.minimum(vec![0.0], |_| 1.0, normal);
        assert_eq!((found.stop, found.numbers[0]), (Stop::NoWayDown, 0.0));
    }
}
