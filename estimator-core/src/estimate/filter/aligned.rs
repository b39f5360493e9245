//! What every filter gives: position, speed and force of one instant.

/// Position, speed and force of one instant, which lies the filter's delay before the newest sample.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Aligned<T> {
    /// Filtered position (m).
    pub position_m: T,
    /// Rate of the filtered position (m/s).
    pub speed_mps: T,
    /// Filtered force (N).
    pub force_n: T,
    /// Rate of the filtered force (N/s).
    pub force_rate_nps: T,
    /// Variance of the position within the window (m²); 0 from a filter that does not measure it.
    pub position_variance_m2: T,
    /// Covariance of position and speed within the window (m²/s); 0 from a filter that does not
    /// measure it.
    pub position_velocity_cov_m2ps: T,
}
