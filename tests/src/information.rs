//! What a log can tell of a Hunt–Crossley contact: Fisher information and the Cramér–Rao bound, below which
//! no unbiased estimator gets.
//!
//! Each instant in contact adds ∇F·∇Fᵀ/R of the true law along the true motion, with the noise and the steps
//! of both sensors: R = σ² + q_F²/12 + (∂F/∂x)²·q_x²/12. The resting force is unknown too, and each instant in
//! free air adds 1/R for it.

use nalgebra::{Matrix6, Vector6};

/// The depth at which stiffness and damping hold (m).
const REFERENCE_M: f64 = 1e-3;

/// The sensors of a log.
#[derive(Clone, Copy, Debug)]
pub struct Sensors {
    /// White noise of the force (N rms).
    pub force_noise_n: f64,
    /// Step of the force sensor (N).
    pub force_step_n: f64,
    /// A count of the encoder (m).
    pub count_m: f64,
}

/// An instant in contact.
#[derive(Clone, Copy, Debug)]
pub struct Touch {
    /// Depth (m).
    pub depth_m: f64,
    /// Its rate (m/s).
    pub speed_mps: f64,
    /// By how much the force grows within a millisecond (N) where the skew of the sensors is unknown, otherwise 0.
    pub force_growth_n: f64,
}

/// The information on ln K, ln λ, ln n, surface (m), resting force (N) and skew (ms).
#[derive(Clone, Copy, Debug)]
pub struct Information {
    matrix: Matrix6<f64>,
    white_n2: f64,
    count_m2: f64,
}

impl Information {
    /// None yet.
    pub fn new(sensors: &Sensors) -> Self {
        Information {
            matrix: Matrix6::zeros(),
            white_n2: sensors.force_noise_n.powi(2) + sensors.force_step_n.powi(2) / 12.0,
            count_m2: sensors.count_m.powi(2) / 12.0,
        }
    }

    /// The surface is told, to a count of the encoder.
    pub fn knows_surface(&mut self) {
        self.matrix[(3, 3)] += 1.0 / self.count_m2;
    }

    /// An instant in free air.
    pub fn add_free_air(&mut self) {
        self.matrix[(4, 4)] += 1.0 / self.white_n2;
    }

    /// An instant in contact with a material of this K (N/m), λ (N s/m) and n.
    pub fn add(&mut self, [stiffness, damping, exponent]: [f64; 3], touch: &Touch) {
        let depth = touch.depth_m / REFERENCE_M;
        let shape = depth.powf(exponent);
        let spring = stiffness * REFERENCE_M * shape;
        let damper = damping * touch.speed_mps * shape;
        let force = spring + damper;
        let by_surface = -(exponent * force / touch.depth_m);
        let by = Vector6::new(
            spring,
            damper,
            force * depth.ln() * exponent,
            by_surface,
            1.0,
            -touch.force_growth_n,
        );
        self.matrix += by * by.transpose() / (self.white_n2 + by_surface.powi(2) * self.count_m2);
    }

    /// The smallest standard deviations of K, λ, n (relative) and of the surface (m); infinite where the log
    /// does not tell them.
    pub fn bound(&self) -> [f64; 4] {
        // Scaled to a unit diagonal: metres and logarithms differ by 10⁷.
        let scale = self
            .matrix
            .diagonal()
            .map(|d| if d > 0.0 { d.sqrt() } else { 1.0 });
        let scaled = Matrix6::from_fn(|i, j| match i == j {
            true => 1.0,
            false => self.matrix[(i, j)] / (scale[i] * scale[j]),
        });
        match scaled.try_inverse() {
            Some(inverse) => std::array::from_fn(|i| inverse[(i, i)].abs().sqrt() / scale[i]),
            None => [f64::INFINITY; 4],
        }
    }
}

/// The probability that K, λ and n of these standard deviations are all within `share` of the truth, as if
/// they were independent: λ decides.
pub fn within(share: f64, sigma: &[f64; 4]) -> f64 {
    let each = sigma.iter().take(3);
    each.map(|sigma| libm::erf(share / sigma / std::f64::consts::SQRT_2))
        .product()
}

#[cfg(all(feature = "rigs", test))]
mod tests {
    use super::*;

    #[test]
    fn four_times_the_instants_halve_the_bound() {
        let sensors = Sensors {
            force_noise_n: 0.02,
            force_step_n: 0.005,
            count_m: 1e-6,
        };
        let bound = |times: usize| {
            let mut information = Information::new(&sensors);
            for index in 0..400 * times {
                // Whole strokes, of a hundred instants.
                let angle = std::f64::consts::TAU * index as f64 / 100.0;
                information.add_free_air();
                information.add(
                    [1350.0, 36.0, 1.35],
                    &Touch {
                        depth_m: 2.1e-3 - 2e-3 * angle.cos(),
                        speed_mps: 0.015 * angle.sin(),
                        force_growth_n: 0.0,
                    },
                );
            }
            information.bound()
        };
        for (one, four) in bound(1).iter().zip(bound(4)) {
            assert!((one / four - 2.0).abs() < 0.05, "{one} {four}");
        }
    }
}
