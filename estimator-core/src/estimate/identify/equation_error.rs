//! Recursive least squares on an equation with past outputs, and the errors of its parameters.

use nalgebra::{SMatrix, SVector};

use crate::estimate::rls::Rls;
use crate::maths::scalar::Real;

/// One equation y = φᵀθ + ε.
#[derive(Clone, Copy, Debug)]
pub(super) struct Equation<T: Real, const N: usize, const C: usize> {
    /// The regressor φ.
    pub(super) phi: SVector<T, N>,
    /// The output y.
    pub(super) y: T,
    /// By how much one unit of noise in the oldest force of this equation changes ε of this equation,
    /// and of the one and the two equations before.
    pub(super) by_noise: [T; 3],
    /// Derivatives of ε by each of `C` quantities that are wrong in every sample alike.
    pub(super) by_considered: SVector<T, C>,
}

/// Recursive least squares that takes into account how the noise enters its equations.
///
/// In an ARX model the noise n of the output enters as ε = n(h) + a₁n(h−1) + …, which is hardly
/// anything at low frequency: the textbook's P·σ² is wrong by orders of magnitude. For white n the
/// covariance is P·Σ(ψψᵀ)σ²·P, with ψ what one sample of n does to the normal equations. What is
/// wrong in every sample alike (`C` considered quantities, Schmidt 1966) moves θ̂ by P·Σ w·φ·∂ε.
#[derive(Clone, Debug)]
pub(super) struct EquationError<T: Real, const N: usize, const C: usize> {
    /// The estimate θ̂ and P.
    pub(super) rls: Rls<T, N>,
    spread: SMatrix<T, N, N>,
    moment: SMatrix<T, N, C>,
    /// w·φ of the last two equations, if they belong to the same run of samples.
    past: [SVector<T, N>; 2],
    by_noise: [T; 3],
}

impl<T: Real, const N: usize, const C: usize> EquationError<T, N, C> {
    pub(super) fn new(theta: SVector<T, N>, covariance: T) -> Self {
        let nothing = SVector::repeat(T::zero());
        EquationError {
            rls: Rls::new(theta, covariance),
            spread: SMatrix::repeat(T::zero()),
            moment: SMatrix::repeat(T::zero()),
            past: [nothing; 2],
            by_noise: [T::zero(); 3],
        }
    }

    /// Takes one equation with forgetting factor β and weight w.
    pub(super) fn update(&mut self, equation: &Equation<T, N, C>, beta: T, weight: T) {
        let phi = equation.phi * weight;
        self.rls
            .update_weighted(&equation.phi, equation.y, beta, weight);
        self.moment = self.moment * beta + phi * equation.by_considered.transpose();
        self.spread *= beta * beta;
        self.by_noise = equation.by_noise;
        self.spread_by(phi);
    }

    /// Ends a run of samples: the next equation shares none of them.
    pub(super) fn break_off(&mut self) {
        for _ in 0..self.past.len() {
            self.spread_by(SVector::repeat(T::zero()));
        }
    }

    fn spread_by(&mut self, phi: SVector<T, N>) {
        let [now, before, earlier] = self.by_noise;
        let [last, last_but_one] = self.past;
        let psi = phi * now + last * before + last_but_one * earlier;
        self.spread += psi * psi.transpose();
        self.past = [phi, last];
    }

    /// Covariance of θ̂ by a white noise of variance `variance`.
    pub(super) fn covariance(&self, variance: T) -> SMatrix<T, N, N> {
        let p = self.rls.covariance.matrix();
        p * self.spread * p * variance
    }

    /// Derivatives of θ̂ by each considered quantity.
    pub(super) fn shift(&self) -> SMatrix<T, N, C> {
        self.rls.covariance.matrix() * self.moment
    }

    /// The sum over the parameters of the share of the initial variance that is left: `N` before the
    /// first equation, towards 0 as data replace the initial values.
    pub(super) fn ignorance(&self) -> T {
        let ceiling = self.rls.covariance.start();
        let mut sum = T::zero();
        for variance in self.rls.covariance.variances().iter() {
            sum += *variance / ceiling;
        }
        sum
    }

    /// Forgets how certain θ̂ is and keeps its values.
    pub(super) fn reset_covariance(&mut self, covariance: T) {
        *self = Self::new(self.rls.theta, covariance);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Vector1, Vector2};

    /// Numbers between −1 and 1 of variance ⅓: enough for noise. Knuth's MMIX generator.
    fn noise(state: &mut u64) -> f64 {
        *state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (*state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    const SEED: u64 = 41;

    #[test]
    fn the_standard_error_of_an_arx_pole_is_the_scatter_of_its_estimates() {
        // x(h) = p·x(h−1) + u, u = 1 for the first half of every 400 samples; y = x + noise of 0.1.
        // The textbook's P·σ² would claim three times the scatter that there is.
        let (pole, runs) = (0.98, 200);
        let mut random = SEED;
        let (mut scatter, mut claimed) = (0.0, 0.0);
        for _ in 0..runs {
            let mut fit = EquationError::<f64, 2, 1>::new(Vector2::zeros(), 1e6);
            let (mut x, mut last) = (0.0, None);
            for i in 0..400 {
                let u = if i < 200 { 1.0 } else { 0.0 };
                let y = x + 0.1 * noise(&mut random);
                if let Some((y_before, u_before)) = last {
                    let equation = Equation {
                        phi: Vector2::new(y_before, u_before),
                        y,
                        by_noise: [-pole, 1.0, 0.0],
                        by_considered: Vector1::new(0.0),
                    };
                    fit.update(&equation, 1.0, 1.0);
                }
                last = Some((y, u));
                x = pole * x + u;
            }
            fit.break_off();
            let error: f64 = fit.rls.theta.x - pole;
            scatter += error * error;
            claimed += fit.covariance(0.01 / 3.0)[(0, 0)];
        }
        let ratio = claimed / scatter;
        // 200 squares are good to 10 %.
        assert!((0.75..1.35).contains(&ratio), "{ratio}");
    }

    #[test]
    fn a_quantity_that_is_wrong_everywhere_moves_the_estimate_by_its_shift() {
        // y = θ·(x + e) fitted as θ·x: e is the considered quantity, ∂ε/∂e = θ.
        let (theta, e) = (3.0_f64, 0.01);
        let mut fit = EquationError::<f64, 1, 1>::new(Vector1::zeros(), 1e9);
        for i in 1..50 {
            let x = f64::from(i) * 0.1;
            let equation = Equation {
                phi: Vector1::new(x),
                y: theta * (x + e),
                by_noise: [1.0, 0.0, 0.0],
                by_considered: Vector1::new(theta),
            };
            fit.update(&equation, 1.0, 1.0);
        }
        assert!((fit.rls.theta.x - theta - fit.shift()[(0, 0)] * e).abs() < 1e-9);
    }
}
