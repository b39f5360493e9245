//! What a fault does to one log, in numbers.

use super::motion::Special;
use super::{COUNT_M, FORCE_STEP_N, NOISE_N, RATE_HZ};
use std::f64::consts::TAU;

/// What differs from an honest log. The default is an honest log.
#[derive(Clone, Debug, Default)]
pub struct Plan {
    /// What the probe meets.
    pub world: World,
    /// The motion.
    pub special: Special,
    /// K and λ after a swap, as factors, and when (s).
    pub swap: Option<Swap>,
    /// The load cell.
    pub force: Force,
    /// The encoder.
    pub position: Position,
    /// When samples are taken, and what their stamps say.
    pub clock: Clock,
    /// When the fault begins (s), 0 if it is there throughout.
    pub onset_s: f64,
    /// When it ends (s), if the log is honest after it.
    pub end_s: Option<f64>,
}

/// Another material from a moment on.
#[derive(Clone, Copy, Debug)]
pub struct Swap {
    /// From (s).
    pub from_s: f64,
    /// K over K before.
    pub stiffness: f64,
    /// λ over λ before.
    pub damping: f64,
}

/// What the probe meets besides the material.
#[derive(Clone, Debug)]
pub struct World {
    /// The share of the elastic force that relaxes.
    pub relaxing: f64,
    /// Its time constant (s).
    pub relaxing_s: f64,
    /// Speed of the surface (m/s), down.
    pub drift_mps: f64,
    /// Amplitude of the breathing (m), at 0.25 Hz.
    pub breath_m: f64,
    /// Phase of the breathing (rad).
    pub breath_phase: f64,
    /// Above this force (N) the surface gives way …
    pub yields_at_n: f64,
    /// … at this speed (m/s), per multiple of the force beyond it.
    pub yields_mps: f64,
    /// The pull of an adhesive material (N) …
    pub adhesion_n: f64,
    /// … which lets go at this height (m).
    pub adhesion_m: f64,
    /// Of the tool in front of the encoder (m/N).
    pub compliance_m_per_n: f64,
    /// Lost motion (m).
    pub play_m: f64,
    /// Strength (N) of a friction that sticks and slips …
    pub friction_n: f64,
    /// … after so much motion (m).
    pub bristle_m: f64,
    /// The tool behind the load cell (kg).
    pub mass_kg: f64,
}

impl Default for World {
    fn default() -> Self {
        World {
            relaxing: 0.0,
            relaxing_s: 1.0,
            drift_mps: 0.0,
            breath_m: 0.0,
            breath_phase: 0.0,
            yields_at_n: f64::INFINITY,
            yields_mps: 0.0,
            adhesion_n: 0.0,
            adhesion_m: 1e-4,
            compliance_m_per_n: 0.0,
            play_m: 0.0,
            friction_n: 0.0,
            bristle_m: 4e-5,
            mass_kg: 0.0,
        }
    }
}

/// Breaths a second.
const BREATH_HZ: f64 = 0.25;

impl World {
    /// Where the surface is (m), down from where it was.
    pub fn surface_m(&self, t: f64) -> f64 {
        self.drift_mps * t + self.breath_m * (TAU * BREATH_HZ * t + self.breath_phase).sin()
    }

    /// How fast it moves (m/s).
    pub fn surface_mps(&self, t: f64) -> f64 {
        let omega = TAU * BREATH_HZ;
        self.drift_mps + omega * self.breath_m * (omega * t + self.breath_phase).cos()
    }
}

/// Stretches of time (s).
pub type Spans = Vec<std::ops::Range<f64>>;

/// What is added to single samples: when (s) and how much (N or m).
pub type Spikes = Vec<(f64, f64)>;

/// The load cell and its converter.
#[derive(Clone, Debug)]
pub struct Force {
    /// Noise (N rms).
    pub noise_n: f64,
    /// Step of the converter (N).
    pub step_n: f64,
    /// Time constant (s).
    pub lag_s: f64,
    /// The force is read so much later than the position (s); negative if earlier.
    pub late_s: f64,
    /// Hum (N), at 50 Hz.
    pub hum_n: f64,
    /// Drift of the zero (N/s).
    pub drift_nps: f64,
    /// Step of the zero (N) at the onset.
    pub offset_n: f64,
    /// The zero is taken at the onset, whatever presses then.
    pub tared: bool,
    /// Readings over the truth; before the onset they are right.
    pub gain: f64,
    /// Largest reading (N).
    pub limit_n: f64,
    /// It repeats its last reading.
    pub stuck: Spans,
    /// What is added.
    pub spikes: Spikes,
    /// A bit of the code that is always 1.
    pub stuck_bit: Option<u32>,
    /// Bits that flip in single samples: when (s) and which.
    pub flips: Vec<(f64, u32)>,
}

impl Default for Force {
    fn default() -> Self {
        Force {
            noise_n: NOISE_N,
            step_n: FORCE_STEP_N,
            lag_s: 0.0,
            late_s: 0.0,
            hum_n: 0.0,
            drift_nps: 0.0,
            offset_n: 0.0,
            tared: false,
            gain: 1.0,
            limit_n: f64::INFINITY,
            stuck: Spans::new(),
            spikes: Spikes::new(),
            stuck_bit: None,
            flips: Vec::new(),
        }
    }
}

/// The encoder.
#[derive(Clone, Debug)]
pub struct Position {
    /// A count (m).
    pub count_m: f64,
    /// Noise before rounding, in counts.
    pub noise_counts: f64,
    /// It jumps by so much (m) at the onset.
    pub jump_m: f64,
    /// Readings over the truth; before the onset they are right.
    pub gain: f64,
    /// It counts from zero again at the onset.
    pub restarted: bool,
    /// It repeats its last reading.
    pub stuck: Spans,
    /// What is added.
    pub spikes: Spikes,
}

impl Default for Position {
    fn default() -> Self {
        Position {
            count_m: COUNT_M,
            noise_counts: 0.0,
            jump_m: 0.0,
            gain: 1.0,
            restarted: false,
            stuck: Spans::new(),
            spikes: Spikes::new(),
        }
    }
}

/// Instants and stamps.
#[derive(Clone, Debug)]
pub struct Clock {
    /// Samples a second (Hz).
    pub rate_hz: f64,
    /// Jitter of both channels (s rms), with regular stamps.
    pub both_s: f64,
    /// Jitter of the force alone (s rms), with regular stamps.
    pub force_s: f64,
    /// Jitter of the stamps (s rms), with regular samples.
    pub stamps_s: f64,
    /// The share of samples that are read late, with regular stamps …
    pub late: f64,
    /// … by up to so much (s).
    pub late_s: f64,
    /// Rows that are missing.
    pub dropped: Spans,
    /// The share of rows that are missing one by one.
    pub dropped_share: f64,
    /// Whether the stamps are numbered anew after rows went missing.
    pub renumbered: bool,
    /// Seconds of the stamps in a second.
    pub speed: f64,
}

impl Default for Clock {
    fn default() -> Self {
        Clock {
            rate_hz: RATE_HZ,
            both_s: 0.0,
            force_s: 0.0,
            stamps_s: 0.0,
            late: 0.0,
            late_s: 0.0,
            dropped: Spans::new(),
            dropped_share: 0.0,
            renumbered: false,
            speed: 1.0,
        }
    }
}
