//! What a filter does to time and to noise.

/// Delay, memory and noise gain of a filter, the same for position and force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Response<T> {
    /// Delay of position, speed and force behind the newest sample (µs).
    pub delay_us: u64,
    /// Length of the memory (samples): an output does not depend on what is older.
    pub memory_samples: u32,
    /// Variance of the filtered force over that of the raw force, for white noise.
    pub noise_gain: T,
    /// The same of the standard deviations.
    pub noise_amplitude: T,
}
