//! A bank of exact least-squares fits over exponent, surface and rate, which needs no initial guess,
//! has no local minimum, and asks for no particular loading speed.
//!
//! With n, x₀ and ν fixed, the quasi-linear law is linear: F = K·s − Kc·z with s = ((x − x₀)/δ₀)ⁿ and
//! ż = ν(s − z), sampled exactly. Each cell carries its z and the five sums that its fit needs. A
//! block of history is taken one surface at a time, so that no sample pays for more than
//! [`EXPONENTS`] × [`RATES`] cells.

use nalgebra::SVector;

use super::block::Block;
use super::theta::{EXPONENT, MODES, STIFFNESS, SURFACE, Theta};
use crate::maths::scalar::Real;

/// Exponents of the grid, 1 to 2: from the linear law to the cone's.
const EXPONENTS: usize = 5;
const EXPONENT_STEP: f64 = 0.25;
/// Number of surface positions of the grid.
const SURFACES: usize = 7;
/// Rates of the grid, 0.05 to 36/s, a factor of 3 apart.
const RATES: usize = 7;
const SLOWEST: f64 = 0.05;
const RATE_RATIO: f64 = 3.0;
/// Share of the spring's information that is added to that of the relaxation, for motions that do not
/// excite it.
const RIDGE: f64 = 1e-4;
/// A block weighs no more than this many samples.
const MOST_COUNTED: f64 = 100.0;

/// The relaxation z and the sums of one cell.
#[derive(Clone, Copy, Debug, Default)]
struct Cell<T> {
    relaxed: T,
    ss: T,
    sz: T,
    zz: T,
    sy: T,
    zy: T,
}

/// The bank of fits; all quantities are scaled.
#[derive(Clone, Debug)]
pub(super) struct RelaxationBank<T> {
    cells: [[[Cell<T>; RATES]; EXPONENTS]; SURFACES],
    first_surface: T,
    /// Distance between two surfaces.
    pub(super) surface_step: T,
    columns: usize,
    /// Number of exponents in use: 1 if the exponent is known to be 1.
    rows: usize,
    yy: T,
    weight: T,
    /// Smallest and largest force.
    pub(super) span: (T, T),
    /// Number of the block that is being taken, and the surface that takes it next.
    pub(super) next: u32,
    column: usize,
    /// The effect of the block's duration on each rate.
    decays: [(T, T); RATES],
    /// The best cells of the block under way and of the last one, each over all exponents and of n =
    /// 1.
    round: [Option<Best<T>>; 2],
    best: [Option<Best<T>>; 2],
}

#[derive(Clone, Copy, Debug)]
struct Best<T> {
    energy: T,
    stiffness: T,
    relaxing: T,
    row: usize,
    column: usize,
    rate: usize,
}

impl<T: Real> RelaxationBank<T> {
    /// An empty bank over surfaces from `first_surface` on, `surface_step` apart; a step of 0 means
    /// that the surface is known. `next` is the number of the first block that it will take.
    pub(super) fn new(first_surface: T, surface_step: T, linear: bool, next: u32) -> Self {
        RelaxationBank {
            cells: [[[Cell::default(); RATES]; EXPONENTS]; SURFACES],
            first_surface,
            surface_step,
            columns: if surface_step > T::zero() {
                SURFACES
            } else {
                1
            },
            rows: if linear { 1 } else { EXPONENTS },
            yy: T::zero(),
            weight: T::zero(),
            span: (T::zero(), T::zero()),
            next,
            column: 0,
            decays: [(T::zero(), T::zero()); RATES],
            round: [None; 2],
            best: [None; 2],
        }
    }

    /// The parameters of the best cell, of all or of those with n = 1.
    pub(super) fn best(&self, linear: bool) -> Option<Theta<T>> {
        let best = self.best.get(usize::from(linear)).copied().flatten()?;
        let mut theta = SVector::repeat(T::zero());
        theta[STIFFNESS] = best.stiffness;
        theta[EXPONENT] = T::from_f64(1.0 + EXPONENT_STEP * best.row as f64);
        theta[SURFACE] = self.first_surface + self.surface_step * T::from_f64(best.column as f64);
        let (relaxing, log_rate) = MODES[0];
        theta[relaxing] = best.relaxing;
        theta[log_rate] = T::from_f64(log_rate_of(best.rate));
        theta[MODES[1].1] = theta[log_rate];
        Some(theta)
    }

    /// Takes a block for one more surface; after the last one, if it `searches`, the best cells are
    /// those that include it.
    pub(super) fn take(&mut self, block: &Block<T>, searches: bool) {
        if self.column == 0 {
            self.take_force(block);
            self.decays = decays(block.duration_s);
        }
        let column = self.column;
        let surface = self.first_surface + self.surface_step * T::from_f64(column as f64);
        let weight = weight_of(block);
        let depth = block.position - surface;
        let inside = depth > T::zero();
        let log = if inside { depth.ln() } else { T::zero() };
        let mut s = if inside { depth } else { T::zero() };
        let ratio = (T::from_f64(EXPONENT_STEP) * log).exp();
        let decays = self.decays;
        let (rows, yy) = (self.rows, self.yy);
        let Some(cells) = self.cells.get_mut(column) else {
            return;
        };
        let [all, linear] = &mut self.round;
        for (row, cells) in cells.iter_mut().take(rows).enumerate() {
            for (rate, (cell, decay)) in cells.iter_mut().zip(&decays).enumerate() {
                cell.take(s, block.force, weight, decay);
                let fit = if searches { cell.fit(yy) } else { None };
                if let Some((stiffness, relaxing, energy)) = fit {
                    let best = Best {
                        energy,
                        stiffness,
                        relaxing,
                        row,
                        column,
                        rate,
                    };
                    keep(all, best);
                    if row == 0 {
                        keep(linear, best);
                    }
                }
            }
            s *= ratio;
        }
        self.column += 1;
        if self.column >= self.columns {
            self.column = 0;
            self.next = self.next.wrapping_add(1);
            self.best = core::mem::take(&mut self.round);
        }
    }

    fn take_force(&mut self, block: &Block<T>) {
        let weight = weight_of(block);
        if weight <= T::zero() {
            return;
        }
        let force = block.force;
        self.yy += weight * force * force;
        self.span = if self.weight > T::zero() {
            let (low, high) = self.span;
            (low.min_of(force), high.max_of(force))
        } else {
            (force, force)
        };
        self.weight += weight;
    }
}

fn keep<T: Real>(kept: &mut Option<Best<T>>, best: Best<T>) {
    if kept.is_none_or(|kept| best.energy < kept.energy) {
        *kept = Some(best);
    }
}

fn weight_of<T: Real>(block: &Block<T>) -> T {
    block.count.min_of(T::from_f64(MOST_COUNTED))
}

fn log_rate_of(rate: usize) -> f64 {
    libm::log(SLOWEST) + rate as f64 * libm::log(RATE_RATIO)
}

/// For each rate: e^{−x} and (1 − e^{−x})/x at x = ν·duration.
fn decays<T: Real>(duration_s: T) -> [(T, T); RATES] {
    let mut decays = [(T::zero(), T::zero()); RATES];
    let mut x = duration_s * T::from_f64(SLOWEST);
    for decay in &mut decays {
        let mean = (-x).exprel();
        *decay = ((-x).exp(), mean);
        x *= T::from_f64(RATE_RATIO);
    }
    decays
}

impl<T: Real> Cell<T> {
    fn take(&mut self, s: T, force: T, weight: T, (decayed, growth): &(T, T)) {
        let away = self.relaxed - s;
        let z = s + away * *growth;
        self.relaxed = s + away * *decayed;
        let (s_weighted, z_weighted) = (s * weight, z * weight);
        self.ss += s_weighted * s;
        self.sz += s_weighted * z;
        self.zz += z_weighted * z;
        self.sy += s_weighted * force;
        self.zy += z_weighted * force;
    }

    /// K, Kc and Σe², if the cell has seen anything and its spring pushes; 0 ≤ c < 1.
    fn fit(&self, yy: T) -> Option<(T, T, T)> {
        let zz = self.zz + T::from_f64(RIDGE) * self.ss;
        let determinant = self.ss * zz - self.sz * self.sz;
        if !(self.ss > T::zero() && determinant > T::zero()) {
            return None;
        }
        let stiffness = (zz * self.sy - self.sz * self.zy) / determinant;
        let relaxing = (self.sz * self.sy - self.ss * self.zy) / determinant;
        let (stiffness, relaxing) = if relaxing > T::zero() {
            (stiffness, relaxing)
        } else {
            (self.sy / self.ss, T::zero())
        };
        let energy = yy - stiffness * self.sy + relaxing * self.zy;
        let is_one = stiffness > relaxing && energy.is_finite();
        is_one.then(|| (stiffness, relaxing, T::zero().max_of(energy)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A press of 60 ms and a hold of 4 s.
    fn press(bank: &mut RelaxationBank<f64>, surface: f64, exponent: f64, rate: f64) {
        let mut z = 0.0;
        for i in 0..500 {
            let depth = 0.5 * f64::from(i).min(7.0);
            let s = libm::pow(depth, exponent);
            let x = rate * 8e-3;
            let mean = s + (z - s) * (1.0 - libm::exp(-x)) / x;
            z = s + (z - s) * libm::exp(-x);
            let block = Block {
                position: surface + depth,
                force: 2.0 * (s - 0.3 * mean),
                duration_s: 8e-3,
                count: 8.0,
                ..Block::default()
            };
            (0..bank.columns).for_each(|_| bank.take(&block, true));
        }
    }

    #[test]
    fn the_cell_that_is_the_truth_is_found() {
        let mut bank = RelaxationBank::new(-0.3, 0.1, false, 0);
        press(&mut bank, 0.0, 1.5, 1.35);
        let theta = bank.best(false).unwrap();
        assert!((theta[EXPONENT] - 1.5).abs() < 1e-9 && theta[SURFACE].abs() < 1e-9);
        // The ridge takes 1e-4 of the information.
        assert!((theta[STIFFNESS] - 2.0).abs() < 1e-2, "{theta}");
        assert!((theta[MODES[0].0] - 0.6).abs() < 2e-2, "{theta}");
        assert!((theta[MODES[0].1] - libm::log(1.35)).abs() < 1e-9);
    }

    #[test]
    fn of_the_linear_cells_the_best_is_linear() {
        let mut bank = RelaxationBank::new(-0.3, 0.1, false, 0);
        press(&mut bank, 0.0, 1.5, 1.35);
        assert_eq!(bank.best(true).unwrap()[EXPONENT], 1.0);
    }

    #[test]
    fn an_empty_bank_has_no_best_cell() {
        assert!(
            RelaxationBank::<f64>::new(0.0, 0.1, false, 0)
                .best(false)
                .is_none()
        );
    }
}
