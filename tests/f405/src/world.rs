//! The mechanics around the board: a probe that something moves into a material, with the two sensors.

use crate::chip::{Drive, UNITS_PER_SECOND};
use estimator_core::physics::law::{ContactLaw, HuntCrossley, unilateral};

/// What the board's pins see and move.
pub trait World: Send {
    /// The encoder's count at a time (units).
    fn counts(&mut self, at: u64) -> i64;
    /// The code of a conversion whose hold capacitor closes at a time, 0 to 4095.
    fn force_code(&mut self, at: u64) -> u32;
    /// The code of the bridge converter for a conversion from one time to another.
    fn bridge(&mut self, from: u64, to: u64) -> i32;
    /// The force output changes.
    fn driven(&mut self, _at: u64, _drive: Drive) {}
    /// When the world wants to go on by itself.
    fn event(&self) -> u64 {
        u64::MAX
    }
    /// The world goes on.
    fn at_event(&mut self, _at: u64) {}
}

/// The reference wiring: newtons per code of a conversion, metres per count.
pub const N_PER_CODE: f64 = 100.0 / 4096.0;
/// Metres per count of the encoder.
pub const M_PER_COUNT: f64 = 1e-6;
/// The second wiring: newtons per code of the bridge, counts per metre of the magnetic encoder.
const BRIDGE_N_PER_CODE: f64 = 6e-6;
const SPI_COUNTS_PER_M: f64 = 16_384.0 / 5e-3;

/// A linear congruential generator of 64 bits (Knuth's MMIX).
#[derive(Clone)]
pub struct Random(pub u64);

impl Random {
    /// Uniform in 0…1.
    pub fn unit(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Close to a standard normal: twelve uniforms, less their mean.
    pub fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.unit()).sum::<f64>() - 6.0
    }
}

/// A material: stiffness (N/m), damping (N s/m) and exponent at the depth of 1 mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// K (N/m).
    pub stiffness: f64,
    /// λ (N s/m).
    pub damping: f64,
    /// n.
    pub exponent: f64,
}

impl Material {
    /// The gel of the book's chapter.
    pub const GEL: Material = Material {
        stiffness: 1350.0,
        damping: 36.0,
        exponent: 1.35,
    };
    /// The plastic layer of the book's chapter.
    pub const PLASTIC: Material = Material {
        stiffness: 11_500.0,
        damping: 70.0,
        exponent: 1.2,
    };

    /// The force (N) at a depth (m) and a speed (m/s); a material does not pull.
    pub fn force_n(&self, depth_m: f64, speed_mps: f64) -> f64 {
        let law = HuntCrossley::new(self.stiffness, self.damping, self.exponent, 1e-3);
        unilateral(law.force_n(depth_m, speed_mps))
    }
}

/// Position (m) and speed (m/s) at a time (s).
pub trait Motion: Send {
    /// At a time that never goes back far.
    fn at(&mut self, t_s: f64) -> (f64, f64);
}

impl<F: FnMut(f64) -> (f64, f64) + Send> Motion for F {
    fn at(&mut self, t_s: f64) -> (f64, f64) {
        self(t_s)
    }
}

/// Strokes into a material and out again, with rests above the surface: 16u²(1−u)².
pub struct Strokes {
    /// Start (s), duration (s), lowest position (m) of each.
    strokes: Vec<(f64, f64, f64)>,
    next: usize,
}

/// Where strokes start and end (m).
pub const REST_M: f64 = -0.5e-3;

impl Strokes {
    /// Strokes from `start_s` on, as long as `seconds`, of depths from `shallow` to `deep` (m).
    pub fn random(seed: u64, start_s: f64, seconds: f64, (shallow, deep): (f64, f64)) -> Self {
        let mut random = Random(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x5bd1);
        random.unit();
        let (mut strokes, mut t) = (Vec::new(), start_s);
        while t < start_s + seconds {
            let duration = 0.4 + 0.8 * random.unit();
            strokes.push((t, duration, shallow + (deep - shallow) * random.unit()));
            t += duration;
        }
        Strokes { strokes, next: 0 }
    }

    /// Depths for the gel and for the plastic, 9 to 15 N.
    pub fn depths(material: Material) -> (f64, f64) {
        match material == Material::GEL {
            true => (2e-3, 4.5e-3),
            false => (0.5e-3, 1e-3),
        }
    }
}

impl Motion for Strokes {
    fn at(&mut self, t_s: f64) -> (f64, f64) {
        // Samples of both sensors may look back by some microseconds.
        while self.next > 0 && self.strokes.get(self.next).is_none_or(|s| t_s < s.0) {
            self.next -= 1;
        }
        while self
            .strokes
            .get(self.next)
            .is_some_and(|s| t_s >= s.0 + s.1)
        {
            self.next += 1;
        }
        let Some((start, duration, depth)) = self.strokes.get(self.next).copied() else {
            return (REST_M, 0.0);
        };
        if t_s < start {
            return (REST_M, 0.0);
        }
        let u = (t_s - start) / duration;
        let (hump, way) = (u * (1.0 - u), depth - REST_M);
        let speed = way * 32.0 * hump * (1.0 - 2.0 * u) / duration;
        (REST_M + way * 16.0 * hump * hump, speed)
    }
}

/// A probe on a motion, over a material whose surface is at 0.
pub struct Press<M> {
    motion: M,
    material: Material,
    random: Random,
    /// Noise of a conversion (codes).
    noise: f64,
}

impl<M: Motion> Press<M> {
    /// A press; the seed is that of the noise, 2 codes (0.05 N) in a conversion.
    pub fn new(motion: M, material: Material, seed: u64) -> Self {
        Press {
            motion,
            material,
            random: Random(seed.wrapping_mul(0x2545_f491_4f6c_dd1d) ^ 0xa5a5),
            noise: 2.0,
        }
    }

    fn force_at(&mut self, at: u64) -> f64 {
        let (position, speed) = self.motion.at(seconds(at));
        self.material.force_n(position, speed)
    }
}

pub(crate) fn seconds(at: u64) -> f64 {
    at as f64 / UNITS_PER_SECOND as f64
}

/// The code of a force, with noise.
pub fn code(force_n: f64, noise: f64) -> u32 {
    (2048.5 + force_n / N_PER_CODE + noise).clamp(0.0, 4095.0) as u32
}

impl<M: Motion> World for Press<M> {
    fn counts(&mut self, at: u64) -> i64 {
        let (position, _) = self.motion.at(seconds(at));
        (position / M_PER_COUNT).floor() as i64
    }

    fn force_code(&mut self, at: u64) -> u32 {
        let force = self.force_at(at);
        code(force, self.noise * self.random.normal())
    }

    fn bridge(&mut self, from: u64, to: u64) -> i32 {
        const POINTS: u64 = 16;
        let sum: f64 = (0..POINTS)
            .map(|i| self.force_at(from + (to - from) * (2 * i + 1) / (2 * POINTS)))
            .sum();
        let noise = 0.009 * self.random.normal();
        ((sum / POINTS as f64 + noise) / BRIDGE_N_PER_CODE) as i32
    }
}

/// The same press before the second set of sensors: the magnetic encoder has other counts.
pub struct OnSpi<M>(pub Press<M>);

impl<M: Motion> World for OnSpi<M> {
    fn counts(&mut self, at: u64) -> i64 {
        let (position, _) = self.0.motion.at(seconds(at));
        (position * SPI_COUNTS_PER_M).floor() as i64
    }

    fn force_code(&mut self, at: u64) -> u32 {
        self.0.force_code(at)
    }

    fn bridge(&mut self, from: u64, to: u64) -> i32 {
        self.0.bridge(from, to)
    }
}

/// A world whose cables come off for a time: from one second to another, each.
pub struct Loose<W> {
    /// What is at the other end.
    pub world: W,
    /// When the load cell's cable is off: the amplifier's output falls to 0 V.
    pub force: (f64, f64),
    /// When the encoder's cable is off: the open inputs count 100 edges a millisecond, away from the material.
    pub position: (f64, f64),
}

impl<W: World> World for Loose<W> {
    fn counts(&mut self, at: u64) -> i64 {
        const EDGES_PER_S: f64 = 1e5;
        let off_s = (seconds(at).min(self.position.1) - self.position.0).max(0.0);
        self.world.counts(at) - (off_s * EDGES_PER_S) as i64
    }

    fn force_code(&mut self, at: u64) -> u32 {
        let code = self.world.force_code(at);
        match seconds(at) {
            t if t >= self.force.0 && t < self.force.1 => 0,
            _ => code,
        }
    }

    fn bridge(&mut self, from: u64, to: u64) -> i32 {
        self.world.bridge(from, to)
    }
}
