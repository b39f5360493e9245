//! Raw codes to SI: the only place where a number of the board gets a unit.

use crate::board::{RawSample, Reading};
use estimator_core::Sample;

/// What the sensors of the reference wiring are worth (README, "Wiring"). The emulator does not
/// need them: its recordings are in SI.
#[cfg(feature = "f405")]
pub mod wiring {
    /// Conversions that are summed into one sample: 32 kHz down to 1 kHz. The sum is not divided:
    /// 12 bits become 17 codes' worth, and noise drops by √32.
    pub const OVERSAMPLING: u16 = 32;

    /// Position (m) per code: a 1 µm linear encoder (four edges counted), summed like the force.
    pub const POSITION_M_PER_CODE: f32 = 1e-6 / OVERSAMPLING as f32;

    /// Force (N) per code: ±50 N on an amplifier with 0…3.3 V around 1.65 V, 4096 codes at 12 bit.
    /// Positive pushes the probe out.
    pub const FORCE_N_PER_CODE: f32 = 100.0 / 4096.0 / OVERSAMPLING as f32;

    /// The sum that stands for 0 N: half the range. What is left of an offset, the estimator takes
    /// off while settling.
    pub const FORCE_ZERO_CODE: i32 = 2048 * OVERSAMPLING as i32;
}

/// The sample that the estimator sees.
pub fn sample(raw: &RawSample) -> Sample<f32> {
    Sample {
        time_us: raw.time_us,
        position_m: si(raw.position),
        force_n: si(raw.force),
        faults: raw.faults,
    }
}

fn si(reading: Reading) -> f32 {
    reading.code as f32 * reading.si_per_code
}
