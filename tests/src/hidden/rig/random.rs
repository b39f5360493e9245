//! Random numbers: a seed and a stream always give the same draws.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// A stream of random numbers.
#[derive(Clone, Debug)]
pub struct Random(Pcg64);

impl Random {
    /// The stream `stream` of `seed`; streams of one seed are independent, so that a longer log or
    /// a second try of a strength moves no other draw.
    pub fn new(seed: u64, stream: u64) -> Self {
        // Pcg64 spreads a 64-bit seed over its state; the multiplier keeps (1, 0) and (0, 1) apart.
        Random(Pcg64::seed_from_u64(
            seed.wrapping_mul(0x9E37_79B9_7F4A_7C15)
                .wrapping_add(stream),
        ))
    }

    /// Uniform in 0…1.
    pub(crate) fn unit(&mut self) -> f64 {
        self.0.random()
    }

    /// Uniform between both.
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Uniform in the logarithm.
    pub(crate) fn log_between(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.unit())
    }

    /// True with this probability.
    pub(crate) fn chance(&mut self, probability: f64) -> bool {
        self.unit() < probability
    }

    /// −1 or 1.
    pub(crate) fn sign(&mut self) -> f64 {
        if self.chance(0.5) { -1.0 } else { 1.0 }
    }

    /// A phase (rad).
    pub(crate) fn phase(&mut self) -> f64 {
        self.between(-std::f64::consts::PI, std::f64::consts::PI)
    }

    /// Standard normal, Box–Muller.
    pub(crate) fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.unit()).ln()).sqrt();
        radius * (std::f64::consts::TAU * self.unit()).cos()
    }

    /// One of the elements, each as likely as another.
    pub(crate) fn pick<'a, T>(&mut self, of: &'a [T]) -> &'a T {
        &of[((self.unit() * of.len() as f64) as usize).min(of.len() - 1)]
    }
}
