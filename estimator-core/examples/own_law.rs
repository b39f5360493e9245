//! A contact law of your own: written once, it gives forces on the board (f32), a simulator's (f64) and
//! exact gradients for a fit (dual numbers), and is identified by the same recursion as the others.
//!
//! `cargo run -p estimator-core --example own_law`. The law is a sponge that densifies: soft cells that
//! are used up at a depth h, F = Kδ/(1 − δ/h) + λδ̇.

use estimator_core::estimate::rls::{Ud, UdUpdate};
use estimator_core::maths::Dual;
use estimator_core::physics::law::ContactLaw;
use estimator_core::{Real, Scalar};
use nalgebra::SVector;

/// F = Kδ/(1 − δ/h) + λδ̇ for 0 < δ < h.
struct Sponge<S> {
    /// K (N/m): the stiffness at the surface.
    stiffness_n_per_m: S,
    /// λ (N s/m)
    damping_ns_per_m: S,
    /// h (m): the depth at which all cells are closed.
    height_m: S,
}

impl<S: Scalar> ContactLaw<S> for Sponge<S> {
    fn force_n(&self, depth_m: S, speed_mps: S) -> S {
        if depth_m <= S::zero() {
            return S::zero();
        }
        let open = S::one() - depth_m / self.height_m;
        self.stiffness_n_per_m * depth_m / open + self.damping_ns_per_m * speed_mps
    }
}

impl<T: Scalar> Sponge<Dual<T, 3>> {
    /// The law at θ = (K, λ, h), each parameter with its own derivative.
    fn at(theta: &[T; 3]) -> Self {
        Sponge {
            stiffness_n_per_m: Dual::parameter(theta[0], 0),
            damping_ns_per_m: Dual::parameter(theta[1], 1),
            height_m: Dual::parameter(theta[2], 2),
        }
    }
}

/// Recursive Gauss–Newton on the law's own gradient. The covariance is in units of the scales, so that
/// single precision keeps it.
struct Fit<T: Real> {
    theta: [T; 3],
    scale: [T; 3],
    covariance: Ud<T, 3>,
}

impl<T: Real> Fit<T> {
    fn new(start: [T; 3]) -> Self {
        Fit {
            theta: start,
            scale: start,
            covariance: Ud::new(T::from_f64(1e3)),
        }
    }

    fn update(&mut self, depth_m: T, speed_mps: T, force_n: T) {
        let law = Sponge::at(&self.theta);
        let there = law.force_n(Dual::constant(depth_m), Dual::constant(speed_mps));
        let phi = SVector::<T, 3>::from_fn(|i, _| there.gradient[i] * self.scale[i]);
        // What the first, wrong gradients taught is forgotten within a stroke of 838 samples.
        let UdUpdate { gain, .. } = self.covariance.update(&phi, T::from_f64(0.99), T::one());
        for ((own, scale), gain) in self.theta.iter_mut().zip(self.scale).zip(gain.iter()) {
            *own += *gain * scale * (force_n - there.value);
        }
    }
}

/// Presses a sponge of 800 N/m, 5 N s/m and 6 mm, up to 4 mm deep, and gives (K, λ, h).
fn identify<T: Real>() -> [T; 3] {
    let number = T::from_f64;
    let sponge = Sponge {
        stiffness_n_per_m: number(800.0),
        damping_ns_per_m: number(5.0),
        height_m: number(6e-3),
    };
    let mut fit = Fit::new([number(500.0), number(1.0), number(9e-3)]);
    for i in 0..4000 {
        let angle = 7.5e-3 * f64::from(i);
        let depth_m = number(2e-3 * (1.0 - angle.cos()));
        let speed_mps = number(2e-3 * 7.5 * angle.sin());
        fit.update(depth_m, speed_mps, sponge.force_n(depth_m, speed_mps));
    }
    fit.theta
}

fn main() {
    let [stiffness, damping, height] = identify::<f32>();
    println!("in single precision: K {stiffness} N/m, λ {damping} N s/m, h {height} m");
    let [stiffness, damping, height] = identify::<f64>();
    println!("in double precision: K {stiffness} N/m, λ {damping} N s/m, h {height} m");
}

#[test]
fn the_sponge_is_identified_in_both_precisions() {
    let truth = [800.0, 5.0, 6e-3];
    for (found, truth) in identify::<f32>().into_iter().zip(truth) {
        // Without noise, what is left is rounding: 4 N at 2⁻²⁴ over a force of the damper of 75 mN.
        assert!(
            (f64::from(found) / truth - 1.0).abs() < 1e-3,
            "{found} {truth}"
        );
    }
    for (found, truth) in identify::<f64>().into_iter().zip(truth) {
        assert!((found / truth - 1.0).abs() < 1e-9, "{found} {truth}");
    }
}

#[test]
fn its_gradient_is_that_of_central_differences() {
    let theta = [800.0, 5.0, 6e-3];
    let (depth_m, speed_mps) = (3e-3, 0.01);
    let exact = Sponge::at(&theta).force_n(Dual::constant(depth_m), Dual::constant(speed_mps));
    for slot in 0..3 {
        let force = |share: f64| {
            let mut moved = theta;
            moved[slot] *= 1.0 + share;
            Sponge::at(&moved)
                .force_n(Dual::constant(depth_m), Dual::constant(speed_mps))
                .value
        };
        let central = (force(1e-5) - force(-1e-5)) / (2e-5 * theta[slot]);
        // Third derivatives times 1e-10.
        assert!(
            (exact.gradient[slot] / central - 1.0).abs() < 1e-8,
            "{slot}"
        );
    }
}
