//! What a simulated board's sensors are connected to: a probe, what it touches, and who moves it.

use estimator_core::board::sensing::Codes;
use estimator_core::estimate::fault::Faults;
use estimator_core::physics::law::{ContactLaw, HuntCrossley, unilateral};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

/// Who holds the probe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Hand {
    /// Presses into the chapter's gel, 3.5 mm deep, once a second after a second of rest.
    Palpating,
    /// Holds still at a position (m), with a weight (N) on the load cell.
    Holding {
        /// m
        position_m: f64,
        /// N
        force_n: f64,
    },
    /// Does what was recorded of another rig, from this millisecond on, and rests before and after.
    Repeating {
        /// ms from the start
        from: u64,
    },
}

/// The sensors and what they are connected to.
#[derive(Clone, Debug)]
pub struct World {
    /// Who moves the probe.
    pub hand: Hand,
    /// Newtons per code of the sum of 32 conversions.
    pub n_per_code: f64,
    /// The code at 0 N.
    pub zero_code: f64,
    /// Codes that the cell is bent by at 20 N.
    pub bend_codes: f64,
    /// Noise of the sum (codes rms).
    pub noise_codes: f64,
    /// Metres per code of the encoder.
    pub m_per_code: f64,
    /// Positions (m) and forces (N), a millisecond each, for [`Hand::Repeating`].
    pub recorded: Vec<(f64, f64)>,
    noise: Pcg64,
}

impl Default for World {
    /// A cell that is not quite what its data sheet says: 3 % steeper, and its zero 400 codes off.
    fn default() -> Self {
        World {
            hand: Hand::Palpating,
            n_per_code: 100.0 / 4096.0 / 32.0 * 1.03,
            zero_code: 65_936.0,
            bend_codes: 0.0,
            noise_codes: 12.0,
            m_per_code: 1e-6 / 32.0,
            recorded: Vec::new(),
            noise: Pcg64::seed_from_u64(20_261_121),
        }
    }
}

/// A conversion of 12 bits.
const CODES: i32 = 4096;
const SUMMED: i32 = 32;

impl World {
    /// What the converters say at millisecond `tick` from the start.
    pub fn codes(&mut self, tick: u64) -> Codes {
        let (position_m, force_n) = match self.hand {
            Hand::Holding {
                position_m,
                force_n,
            } => (position_m, force_n),
            Hand::Palpating => palpated(tick),
            Hand::Repeating { from } => {
                let at = tick.saturating_sub(from) as usize;
                let then = self.recorded.get(at).or(self.recorded.last());
                then.copied().unwrap_or_default()
            }
        };
        let normal: f64 = StandardNormal.sample(&mut self.noise);
        let bend = self.bend_codes * (force_n / 20.0).powi(2);
        let code = self.zero_code + force_n / self.n_per_code + bend + self.noise_codes * normal;
        let force = (code.round() as i32).clamp(0, SUMMED * (CODES - 1));
        // The noise of a single conversion: √32 times less than that of the sum.
        let spread = (3.0 * self.noise_codes / f64::from(SUMMED).sqrt()).ceil() as i32;
        let single = force / SUMMED;
        Codes {
            time_us: tick * 1000,
            force,
            force_low: (single - spread).max(0),
            force_high: (single + spread).min(CODES - 1),
            position: (position_m / self.m_per_code).round() as i32,
            faults: Faults::NONE,
        }
    }
}

/// Position (m) and force (N) of the palpation.
fn palpated(tick: u64) -> (f64, f64) {
    let gel = HuntCrossley::new(1350.0_f64, 36.0, 1.35, 1e-3);
    let turn = std::f64::consts::TAU;
    let phase = turn * (tick.max(1000) % 1000) as f64 * 1e-3;
    let position_m = -5e-4 + 2e-3 * (1.0 - phase.cos());
    let speed_mps = 2e-3 * turn * phase.sin();
    (position_m, unilateral(gel.force_n(position_m, speed_mps)))
}
