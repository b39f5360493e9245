//! What is touched.

use super::REFERENCE_M;
use crate::hidden::rig::random::Random;

/// The four materials of the table: name, K (N/m), λ (N s/m) and n at 1 mm.
pub const MATERIALS: [(&str, [f64; 3]); 4] = [
    ("gel", [1349.0, 36.0, 1.35]),
    ("plastic", [11500.0, 70.0, 1.2]),
    ("soft", [300.0, 6.0, 1.6]),
    ("stiff", [20000.0, 100.0, 1.05]),
];

/// A material: F = (K·δ₀ + λ·δ̇)(δ/δ₀)ⁿ, and never a pull.
#[derive(Clone, Copy, Debug)]
pub struct Material {
    /// K (N/m), λ (N s/m), n.
    pub numbers: [f64; 3],
}

impl Material {
    /// A material of that kind: stiffness and damping up to 10 %, the exponent up to 3 % away.
    pub fn draw(kind: usize, random: &mut Random) -> Self {
        let spread = [0.1, 0.1, 0.03];
        let (_, numbers) = MATERIALS[kind];
        let mut draw = |slot: usize| {
            let away = random.between(-spread[slot], spread[slot]);
            // Below 1 the force would leave the surface with an infinite slope.
            (numbers[slot] * (1.0 + away)).max(if slot == 2 { 1.02 } else { 0.0 })
        };
        Material {
            numbers: [draw(0), draw(1), draw(2)],
        }
    }

    /// (δ/δ₀)ⁿ, 0 out of contact.
    pub fn shape(&self, depth_m: f64) -> f64 {
        match depth_m > 0.0 {
            true => (depth_m / REFERENCE_M).powf(self.numbers[2]),
            false => 0.0,
        }
    }

    /// The force (N).
    pub fn force_n(&self, depth_m: f64, speed_mps: f64) -> f64 {
        let [stiffness, damping, _] = self.numbers;
        ((stiffness * REFERENCE_M + damping * speed_mps) * self.shape(depth_m)).max(0.0)
    }

    /// The depth (m) of a force (N) at rest.
    pub fn depth_m(&self, force_n: f64) -> f64 {
        let [stiffness, _, exponent] = self.numbers;
        REFERENCE_M * (force_n / (stiffness * REFERENCE_M)).powf(1.0 / exponent)
    }

    /// The speed (m/s) of retreat at which the damping takes the whole force away.
    pub fn speed_mps(&self) -> f64 {
        self.numbers[0] * REFERENCE_M / self.numbers[1]
    }
}
