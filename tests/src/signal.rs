//! A simulated palpation without a rig: strokes into two materials with noise, always the same samples. It
//! is for tests that compare two runs of the estimator; host-sim simulates sensors and motors.

use estimator_core::Sample;
use estimator_core::physics::law::{ContactLaw, HuntCrossley, unilateral};

/// The rate of the samples (Hz).
pub const RATE_HZ: f64 = 1000.0;
/// Free air at the start (s): the estimator settles.
const SETTLE_S: f64 = 1.0;
/// Where a stroke starts and ends (m): above the surface.
const REST_M: f64 = -0.5e-3;

/// The chapter's materials: a soft gel, then a stiff plastic layer.
fn materials() -> [HuntCrossley<f64>; 2] {
    [
        HuntCrossley::new(1350.0, 36.0, 1.35, 1e-3),
        HuntCrossley::new(11_500.0, 70.0, 1.2, 1e-3),
    ]
}

/// `count` samples: strokes of varying depth and duration, gel for the first half, plastic for the
/// second; position in steps of 1 µm, force with noise of 0.01 N.
pub fn palpation(count: usize, seed: u64) -> Vec<Sample<f32>> {
    let mut random = Random(seed);
    let mut samples = Vec::with_capacity(count);
    let mut stroke = Stroke::rest(SETTLE_S);
    let (mut start, mut material) = (0, 0);
    for tick in 0..count {
        let mut t = (tick - start) as f64 / RATE_HZ;
        if t >= stroke.duration_s {
            // The material changes between two strokes.
            material = usize::from(tick >= count / 2);
            (stroke, start, t) = (Stroke::random(&mut random, material), tick, 0.0);
        }
        let (position_m, speed_mps) = stroke.at(t);
        let force_n = unilateral(materials()[material].force_n(position_m, speed_mps));
        samples.push(Sample {
            time_us: (tick as u64 + 1) * 1000,
            position_m: ((position_m * 1e6).round() * 1e-6) as f32,
            force_n: (force_n + 0.01 * random.normal()) as f32,
            ..Sample::default()
        });
    }
    samples
}

/// A stroke down and up again, without a jump in position or speed.
struct Stroke {
    depth_m: f64,
    duration_s: f64,
}

impl Stroke {
    fn rest(duration_s: f64) -> Self {
        Stroke {
            depth_m: REST_M,
            duration_s,
        }
    }

    /// 2 to 4.5 mm into gel, 0.5 to 1 mm into plastic, in 0.4 to 1.2 s.
    fn random(random: &mut Random, material: usize) -> Self {
        let (shallow, deep) = [(2e-3, 4.5e-3), (0.5e-3, 1e-3)][material];
        Stroke {
            depth_m: shallow + (deep - shallow) * random.unit(),
            duration_s: ((400.0 + 800.0 * random.unit()).round()) / RATE_HZ,
        }
    }

    /// Position (m) and speed (m/s), `t` seconds into the stroke: 16u²(1−u)², highest at the middle.
    fn at(&self, t: f64) -> (f64, f64) {
        let u = t / self.duration_s;
        let hump = u * (1.0 - u);
        let way_m = self.depth_m - REST_M;
        let speed_mps = way_m * 32.0 * hump * (1.0 - 2.0 * u) / self.duration_s;
        (REST_M + way_m * 16.0 * hump * hump, speed_mps)
    }
}

/// A 64-bit linear congruential generator (Knuth's MMIX): enough for noise.
struct Random(u64);

impl Random {
    /// Uniform in 0…1.
    fn unit(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Close to a standard normal: twelve uniforms, less their mean.
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.unit()).sum::<f64>() - 6.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_seed_gives_the_same_samples_and_another_one_others() {
        assert_eq!(palpation(5000, 1), palpation(5000, 1));
        assert_ne!(palpation(5000, 1), palpation(5000, 2));
    }

    #[test]
    fn both_materials_are_pressed_as_hard_as_in_the_chapter() {
        let samples = palpation(100_000, 1);
        for half in samples.chunks(50_000) {
            let peak = half.iter().map(|s| s.force_n).fold(0.0, f32::max);
            assert!((9.0..15.0).contains(&peak), "{peak} N");
        }
    }
}
