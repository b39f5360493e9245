//! A bank of exact least-squares fits, one per exponent and surface position, which needs no initial
//! guess and has no local minimum.
//!
//! With n and x₀ fixed, Hunt–Crossley (3) is linear: F = K·s + λ·s·w with s = ((x − x₀)/δ₀)ⁿ and w
//! the scaled speed. Each cell of the grid keeps the five sums that its fit needs; the cell with the
//! smallest residual says where to start.

use crate::maths::scalar::Real;

/// Exponents of the grid, 0.9 to 2.3: from below the linear law to beyond the cone's 2.
const EXPONENTS: usize = 8;
const FIRST_EXPONENT: f64 = 0.9;
const EXPONENT_STEP: f64 = 0.2;
/// Number of surface positions of the grid.
const SURFACES: usize = 7;
/// Share of the spring's information that is added to that of the damping, for motions that do not
/// excite the damper.
const RIDGE: f64 = 1e-4;
/// Range of force that a start needs.
const START_RANGE: f64 = 2.0;

/// The sums of one cell. φ = s·[1, w], so that s alone differs from cell to cell.
#[derive(Clone, Copy, Debug, Default)]
struct Cell<T> {
    ss: T,
    ssw: T,
    ssww: T,
    sy: T,
    syw: T,
}

/// The parameters of the best cell of a bank.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Candidate<T> {
    /// Stiffness K, scaled.
    pub stiffness: T,
    /// Damping λ, scaled.
    pub damping: T,
    /// Exponent n.
    pub exponent: T,
    /// Position of the surface x₀/δ₀.
    pub surface: T,
    /// Mean squared residual, scaled by F₀².
    pub residual: T,
}

/// The bank of fits; all quantities are scaled.
#[derive(Clone, Debug)]
pub struct Bank<T> {
    cells: [[Cell<T>; EXPONENTS]; SURFACES],
    first_surface: T,
    /// Distance between two surfaces.
    pub(super) surface_step: T,
    columns: usize,
    yy: T,
    /// Number of samples that the sums are worth.
    pub(super) weight: T,
    /// Smallest and largest force: a fit needs a range.
    pub(super) span: (T, T),
}

impl<T: Real> Bank<T> {
    /// An empty bank over surfaces from `first_surface` on, `surface_step` apart; a step of 0 means
    /// that the surface is known.
    pub fn new(first_surface: T, surface_step: T) -> Self {
        Bank {
            cells: [[Cell::default(); EXPONENTS]; SURFACES],
            first_surface,
            surface_step,
            columns: if surface_step > T::zero() {
                SURFACES
            } else {
                1
            },
            yy: T::zero(),
            weight: T::zero(),
            span: (T::zero(), T::zero()),
        }
    }

    /// Takes a position x/δ₀, a speed and a force, with forgetting factor β.
    pub fn update(&mut self, position: T, speed: T, force: T, beta: T) {
        let speed_force = speed * force;
        let mut surface = self.first_surface;
        for column in self.cells.iter_mut().take(self.columns) {
            // dⁿ over an even grid of n: one logarithm and two exponentials a column.
            let depth = position - surface;
            let log = if depth > T::zero() {
                depth.ln()
            } else {
                T::zero()
            };
            let inside = if depth > T::zero() {
                T::one()
            } else {
                T::zero()
            };
            let mut shape = inside * (T::from_f64(FIRST_EXPONENT) * log).exp();
            let ratio = (T::from_f64(EXPONENT_STEP) * log).exp();
            for cell in column {
                let square = shape * shape;
                let square_speed = square * speed;
                cell.ss = beta * cell.ss + square;
                cell.ssw = beta * cell.ssw + square_speed;
                cell.ssww = beta * cell.ssww + square_speed * speed;
                cell.sy = beta * cell.sy + shape * force;
                cell.syw = beta * cell.syw + shape * speed_force;
                shape *= ratio;
            }
            surface += self.surface_step;
        }
        self.yy = beta * self.yy + force * force;
        self.span = if self.weight > T::zero() {
            let (low, high) = self.span;
            (low.min_of(force), high.max_of(force))
        } else {
            (force, force)
        };
        self.weight = beta * self.weight + T::one();
    }

    /// Whether the forces range widely enough to start from the best cell.
    pub(super) fn has_range(&self) -> bool {
        let (low, high) = self.span;
        high > T::from_f64(START_RANGE) * low
    }

    /// The cell with the smallest residual; `None` while no cell has a positive stiffness.
    pub fn best(&self) -> Option<Candidate<T>> {
        let mut best: Option<Candidate<T>> = None;
        let mut surface = self.first_surface;
        for column in self.cells.iter().take(self.columns) {
            let mut exponent = T::from_f64(FIRST_EXPONENT);
            for cell in column {
                if let Some((stiffness, damping, energy)) = cell.fit(self.yy) {
                    let residual = energy / self.weight;
                    if best.is_none_or(|kept| residual < kept.residual) {
                        best = Some(Candidate {
                            stiffness,
                            damping,
                            exponent,
                            surface,
                            residual,
                        });
                    }
                }
                exponent += T::from_f64(EXPONENT_STEP);
            }
            surface += self.surface_step;
        }
        best
    }
}

impl<T: Real> Cell<T> {
    /// K, λ and Σe², if the cell has seen anything and its spring pushes.
    fn fit(&self, yy: T) -> Option<(T, T, T)> {
        let ssww = self.ssww + T::from_f64(RIDGE) * self.ss;
        let determinant = self.ss * ssww - self.ssw * self.ssw;
        if !(self.ss > T::zero() && determinant > T::zero()) {
            return None;
        }
        let stiffness = (ssww * self.sy - self.ssw * self.syw) / determinant;
        let damping = (self.ss * self.syw - self.ssw * self.sy) / determinant;
        let energy = yy - stiffness * self.sy - damping * self.syw;
        (stiffness > T::zero() && energy.is_finite())
            .then(|| (stiffness, damping, T::zero().max_of(energy)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One stroke of gel, scaled, with its surface at `surface`.
    fn stroke(bank: &mut Bank<f64>, surface: f64, exponent: f64) {
        for i in 0..400 {
            let angle = core::f64::consts::TAU * f64::from(i) / 800.0;
            let depth = 2.0 * (1.0 - libm::cos(angle)) + 0.1;
            let speed = 1.5 * libm::sin(angle);
            let force = (1.35 + 0.36 * speed) * libm::pow(depth, exponent);
            bank.update(surface + depth, speed, force, 1.0);
        }
    }

    #[test]
    fn the_cell_that_is_the_truth_has_no_residual() {
        let mut bank = Bank::new(-0.3, 0.1);
        stroke(&mut bank, 0.0, 1.3);
        let best = bank.best().unwrap();
        assert!(
            (best.exponent - 1.3).abs() < 1e-9 && best.surface.abs() < 1e-9,
            "{best:?}"
        );
        // The ridge of 1e-4 takes that much of the damping.
        assert!((best.stiffness - 1.35).abs() < 1e-3 && (best.damping - 0.36).abs() < 1e-3);
        // 1.7e-4 of a mean square of 17: the ridge again.
        assert!(best.residual < 3e-4, "{best:?}");
    }

    #[test]
    fn between_the_cells_the_nearest_wins() {
        let mut bank = Bank::new(-0.3, 0.1);
        stroke(&mut bank, 0.02, 1.35);
        let best = bank.best().unwrap();
        assert!(
            (best.exponent - 1.35).abs() <= 0.21 && best.surface.abs() <= 0.21,
            "{best:?}"
        );
    }

    #[test]
    fn an_empty_bank_and_one_that_only_pulls_have_no_best_cell() {
        let mut bank = Bank::<f64>::new(0.0, 0.1);
        assert_eq!(bank.best(), None);
        (0..100).for_each(|i| bank.update(1.0 + f64::from(i) * 0.01, 0.1, -1.0, 1.0));
        assert_eq!(bank.best(), None);
    }

    #[test]
    fn single_precision_finds_the_same_cell() {
        let (mut wide, mut narrow) = (Bank::<f64>::new(-0.3, 0.1), Bank::<f32>::new(-0.3, 0.1));
        for i in 0..5000 {
            let angle = f64::from(i) * 0.007;
            let (depth, speed) = (1.1 - libm::cos(angle), 0.8 * libm::sin(angle));
            let force = (1.35 + 0.36 * speed) * libm::pow(depth, 1.31)
                + 0.005 * libm::sin(f64::from(i * i % 1000));
            wide.update(depth, speed, force, 0.9998);
            narrow.update(depth as f32, speed as f32, force as f32, 0.9998);
        }
        let (wide, narrow) = (wide.best().unwrap(), narrow.best().unwrap());
        assert!((wide.exponent - f64::from(narrow.exponent)).abs() < 1e-6);
        assert!((wide.surface - f64::from(narrow.surface)).abs() < 1e-6);
        assert!((wide.stiffness / f64::from(narrow.stiffness) - 1.0).abs() < 1e-3);
    }
}
