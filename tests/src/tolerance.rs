//! Every tolerance of the acceptance tests, with its reason.

/// Relative error of K, λ and n on the simulated rig with the surface known: the bar of E1, E3 and
/// E4. Measured over 100 seeds, at most: gel 1.41, 1.82, 0.81 %, plastic 0.17, 0.99, 0.51 %.
pub const CHAPTER: f64 = 0.02;

/// Bank and refiner, surface unknown, 36 cases: share within 5 % and within 1 %. The table over 1000
/// seeds a setting says 99–100 and 95–100 %; two of 36 may miss 1 %.
pub const FOUND_5: f64 = 0.97;
/// See [`FOUND_5`].
pub const FOUND_1: f64 = 0.94;
/// Median time (s) until K, λ and n stay within 5 %, all settings together.
pub const SETTLES_S: f64 = 1.0;
/// 95 % of the surfaces are found better than this (m).
pub const SURFACE_M: f64 = 10e-6;
