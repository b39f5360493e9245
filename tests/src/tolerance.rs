//! Every tolerance of the acceptance tests, with its reason.

/// Relative error of K, λ and n on the simulated rig with the surface known: the bar of E1, E3 and
/// E4. Measured over 100 seeds, at most: gel 1.41, 1.82, 0.81 %, plastic 0.17, 0.99, 0.51 %.
pub const CHAPTER: f64 = 0.02;

/// Bank and refiner, surface unknown, 36 cases: share within 5 % and within 1 %. The table says 100 and
/// 91–100 %, where an estimator at the Cramér–Rao bound has 95–100 %; two of 36 may miss 1 %.
pub const FOUND_5: f64 = 0.97;
/// See [`FOUND_5`].
pub const FOUND_1: f64 = 0.94;
/// Time (s) until K, λ and n stay within 5 %, all settings together: median, measured 0.2.
pub const SETTLES_S: Bound = 0.05..0.5;
/// The same, 95 % of the runs: measured 0.5; a ramp at constant speed tells nothing of damping.
pub const SETTLES_95_S: Bound = 0.1..1.0;
/// 95 % of the surfaces are found better than this (m).
pub const SURFACE_M: f64 = 10e-6;
/// Error of K, λ, n over the Cramér–Rao bound, root mean square over 36 cases: 1.0 to 1.3 measured; one
/// standard deviation of such a mean is 12 %.
pub const OVER_FLOOR: Bound = 0.7..1.7;
/// Share of 36 true values in 95 % intervals: two standard deviations of it are 7 %.
pub const COVERAGE: Bound = 0.86..1.001;
/// λ of plastic at skews up to 2 ms, 95 %: measured 1.4 % over these seeds, 3.0 % over 100 (rms 1.6
/// times the Cramér–Rao bound with the skew unknown).
pub const SKEWED_DAMPING: Bound = 0.002..0.03;
/// The skew (s), 95 %: measured 20–48 µs.
pub const SKEW_S: Bound = 1e-6..60e-6;
/// Median time (s) after a swap: measured 0.24.
pub const SWAP_S: Bound = 0.05..0.35;

/// From a value that would be suspiciously good to one that is too bad.
pub type Bound = std::ops::Range<f64>;

/// Largest relative errors of K, n, c, ν of E5 over 10 seeds: measured 0.90, 0.56, 0.62, 1.15 %. Of
/// it 0.2 % relax on the way, and the mean over the filter's window is worth 0.5 % at most.
pub const E5: [Bound; 4] = [0.002..0.013, 0.001..0.008, 0.001..0.01, 0.002..0.02];
/// Residual of E5 over the noise of the force: measured 1.05 to 1.12; 20 mN and a step of 5 mN alone
/// are 1.003.
pub const E5_RESIDUAL: Bound = 1.0..1.2;
/// E5: seconds from the touch until c and ν stay within 5 % of their last values; measured 8 and 8.
pub const E5_MODE_SETTLES_S: Bound = 2.0..12.0;
/// E6: the estimated elastic response off the real one of 0–12 N (N); measured 0.010 to 0.022.
pub const E6_N: Bound = 0.004..0.04;
/// Largest relative errors of κ₁, κ₂, λ over 10 seeds: measured 0.07, 0.09, 0.37 %.
pub const ZENER: [Bound; 3] = [1e-4..1e-3, 1e-4..1.5e-3, 5e-4..6e-3];
/// Residual of Zener over the noise of the force: 1.003 is the noise and the step.
pub const ZENER_RESIDUAL: Bound = 0.97..1.03;
/// The fast one of two modes, true 1/s: measured 1.27. The cascade takes what relaxes on the way down
/// off the elastic response, and makes up for it by a faster mode.
pub const TWO_MODES_RATE: Bound = 1.1..1.5;
/// Single against double precision, relative: 2.9e-6 for the same equations; 1.3e-3 measured where
/// rounding ends the learning from a relaxed hold a period earlier, a tenth of the standard error.
pub const SINGLE_PRECISION: f64 = 3e-3;
