//! Every tolerance of the acceptance tests, with its reason.

/// Relative error of K, λ and n on the simulated rig with the surface known: the bar of E1, E3 and
/// E4. Measured over 16 seeds: 1.3 % at most (λ of the plastic; 0.6 % rms).
pub const CHAPTER: f64 = 0.02;
