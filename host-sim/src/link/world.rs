//! What the sensors of a simulated board are connected to: a probe, what it touches, and who moves it.

use estimator_core::board::sensing::Codes;
use estimator_core::estimate::fault::Faults;
use estimator_core::physics::law::{ContactLaw, HuntCrossley, unilateral};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

/// Who holds the probe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Hand {
    /// The hand rests for a second, and then presses 3.5 mm deep into the chapter's gel once a second.
    Palpating,
    /// The hand holds still, with a weight on the load cell.
    Holding {
        /// The position (m).
        position_m: f64,
        /// The weight (N).
        force_n: f64,
    },
    /// The hand repeats what was recorded of another rig, and rests before and after it.
    Repeating {
        /// The start of the recorded motion (ms from the start of the board).
        from: u64,
    },
}

/// The sensors and what they are connected to.
#[derive(Clone, Debug)]
pub struct World {
    /// Who moves the probe.
    pub hand: Hand,
    /// The force per code of the sum of 32 conversions (N).
    pub n_per_code: f64,
    /// The code at 0 N.
    pub zero_code: f64,
    /// The nonlinearity of the cell at 20 N (codes).
    pub bend_codes: f64,
    /// The noise of the sum (codes rms).
    pub noise_codes: f64,
    /// The way per code of the encoder (m).
    pub m_per_code: f64,
    /// The positions (m) and forces (N) of each millisecond, for [`Hand::Repeating`].
    pub recorded: Vec<(f64, f64)>,
    noise: Pcg64,
}

impl Default for World {
    /// A load cell that differs from its data sheet: it is 3 % steeper, and its zero is 400 codes off.
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

/// The range of a conversion of 12 bits.
const CODES: i32 = 4096;
const SUMMED: i32 = 32;

impl World {
    /// The codes of the converters at millisecond `tick` from the start.
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
        // The noise of a single conversion is √32 times less than that of the sum.
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

/// The position (m) and the force (N) of the palpation.
fn palpated(tick: u64) -> (f64, f64) {
    let gel = HuntCrossley::new(1350.0_f64, 36.0, 1.35, 1e-3);
    let turn = std::f64::consts::TAU;
    let phase = turn * (tick.max(1000) % 1000) as f64 * 1e-3;
    let position_m = -5e-4 + 2e-3 * (1.0 - phase.cos());
    let speed_mps = 2e-3 * turn * phase.sin();
    (position_m, unilateral(gel.force_n(position_m, speed_mps)))
}
