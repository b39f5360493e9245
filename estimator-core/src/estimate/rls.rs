//! Recursive least squares (20)–(23), with the covariance in factors so that it stays positive in f32
//! for any number of samples.

mod excitation;
mod forgetting;
mod ud;

pub use excitation::Excitation;
pub use forgetting::ForgettingParams;
pub use ud::{LastKnown, Ud, UdUpdate};

use nalgebra::SVector;

use crate::maths::scalar::Real;

/// Recursive least squares for the `N` parameters θ of y = φᵀθ + noise.
#[derive(Clone, Debug)]
pub struct Rls<T: Real, const N: usize> {
    /// The estimate θ̂.
    pub theta: SVector<T, N>,
    /// The covariance P in factors.
    pub covariance: Ud<T, N>,
}

impl<T: Real, const N: usize> Rls<T, N> {
    /// Starts from θ̂(0) = `theta` and P(0) = `covariance`·I.
    pub fn new(theta: SVector<T, N>, covariance: T) -> Self {
        Rls {
            theta,
            covariance: Ud::new(covariance),
        }
    }

    /// Predicts y as φᵀθ̂.
    pub fn predict(&self, phi: &SVector<T, N>) -> T {
        phi.dot(&self.theta)
    }

    /// Updates θ̂(h) = θ̂(h−1) + Q(h)[y(h) − φᵀ(h)θ̂(h−1)] with forgetting factor β, (20)–(23).
    pub fn update(&mut self, phi: &SVector<T, N>, y: T, beta: T) {
        self.update_weighted(phi, y, beta, T::one());
    }

    /// Updates θ̂ with a sample of weight w, whose gain is Q = Pφ[β/w + φᵀPφ]⁻¹, (40).
    pub fn update_weighted(&mut self, phi: &SVector<T, N>, y: T, beta: T, weight: T) {
        let innovation = y - self.predict(phi);
        let UdUpdate { gain, .. } = self.covariance.update(phi, beta, weight);
        self.theta += gain * innovation;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix2, Vector2};

    /// A deterministic, persistently exciting regressor.
    fn regressor(i: u32) -> Vector2<f64> {
        let t = f64::from(i) * 0.05;
        Vector2::new(1.0 + libm::sin(t), libm::cos(1.7 * t))
    }

    #[test]
    fn it_is_the_textbook_recursion() {
        let truth = Vector2::new(1.35, -0.4);
        let mut rls = Rls::new(Vector2::zeros(), 100.0);
        let (mut theta, mut p) = (Vector2::zeros(), Matrix2::identity() * 100.0);
        let beta = 0.97;
        for i in 0..300 {
            let phi = regressor(i);
            let y = phi.dot(&truth) + 0.01 * libm::sin(f64::from(i * i));
            // (21)–(23) as printed, with the transpose that is missing there.
            let q = p * phi / (beta + (phi.transpose() * p * phi)[0]);
            theta += q * (y - phi.dot(&theta));
            p = (Matrix2::identity() - q * phi.transpose()) * p / beta;
            rls.update(&phi, y, beta);
            assert!((rls.theta - theta).norm() < 1e-9, "at {i}");
        }
        assert!((rls.covariance.matrix() - p).norm() < 1e-9 * p.norm());
    }

    #[test]
    fn without_noise_the_parameters_are_exact() {
        let truth = Vector2::new(2.0, 0.3);
        let mut rls = Rls::new(Vector2::zeros(), 1e6);
        (0..200).for_each(|i| rls.update(&regressor(i), regressor(i).dot(&truth), 1.0));
        // P(0) = 1e6 leaves a prior of 1e-6 against 200 samples.
        assert!((rls.theta - truth).norm() < 1e-7);
    }
}
