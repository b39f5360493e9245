//! Configuration: what a person writes down.
//!
//! [`Config`] → [`Config::validate`] → [`Params`](crate::Params): checked once, outside the loop. A loop
//! that has parameters cannot be misconfigured.

use crate::estimate::method::Method;

/// All settings of an estimator. The defaults are for a 1 kHz motor controller that presses
/// millimetres deep with newtons.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Config {
    /// Samples per second (Hz).
    pub rate_hz: f32,
    /// Scales at which the problem is well conditioned and the parameters are reported.
    pub reference: Reference,
    /// How position and force are smoothed and the speed is found.
    pub filter: Filter,
    /// How touch and lift-off are found.
    pub contact: Contact,
    /// Which estimator runs.
    pub method: Method,
    /// Error-dependent forgetting (24).
    pub forgetting: Forgetting,
    /// Where the estimator starts.
    pub initial: Initial,
    /// When an estimate counts as converged, changed or suspect.
    pub judgement: Judgement,
    /// How the coefficients of (18) become κ₁, κ₂ and λ.
    pub inversion: Inversion,
    /// Settings of the Hammerstein cascade (39)–(42).
    pub cascade: Cascade,
}

/// How the coefficients of (18) become κ₁, κ₂ and λ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Inversion {
    /// Exact for a depth that is linear between samples.
    Exact,
    /// Forward Euler, as printed in the chapter: low by νT/2 in the rate.
    ForwardEuler,
}

/// Settings of the Hammerstein cascade (39)–(42).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cascade {
    /// δ̇* (m/s): the elastic response is learned while pressing faster than this; `None`: 5 δ₀/s.
    pub loading_speed_mps: Option<f32>,
    /// The weight of Γ₁.
    pub weight: Weight,
}

/// The weight that undoes what the logarithm does to small forces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Weight {
    /// e^{y₁} = F, the chapter's.
    Force,
    /// e^{2y₁} = F²: minimises the error of F itself.
    ForceSquared,
}

/// Scales of the contact. Parameters are reported at `depth_m`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reference {
    /// δ₀ (m).
    pub depth_m: f32,
    /// A typical force (N).
    pub force_n: f32,
}

/// The filter in front of the estimator: one delay for position, speed and force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Filter {
    /// Second-order state-variable filter, the chapter's.
    StateVariable {
        /// Corner frequency (Hz).
        cutoff_hz: f32,
        /// ζ: 1 is critically damped.
        damping_ratio: f32,
    },
    /// Savitzky–Golay slope over 2·half_width + 1 samples, with the smoothing that it implies on
    /// position and force; delay half_width samples at every frequency.
    SavitzkyGolay {
        /// Samples on either side of the centre.
        half_width: u8,
    },
}

/// Touch and lift-off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Where the surface is.
    pub surface: Surface,
    /// Touch at this many standard deviations of the filtered force.
    pub touch_sigma: f32,
    /// Lift-off below this many.
    pub release_sigma: f32,
    /// Standard deviation of the raw force (N); `None`: measured while settling.
    pub force_noise_n: Option<f32>,
    /// Time in free air, at the start, over which noise and resting force are measured (s).
    pub settle_s: f32,
}

/// How the surface is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Surface {
    /// The position of impact is taken for the surface, anew at every touch (the chapter's way).
    AtImpact,
    /// It is known (m).
    Known {
        /// Position of the surface (m).
        position_m: f32,
    },
}

/// β = 1 − α₁{(1/π)·arctan[α₂(|F − F̂| − α₃)] + ½}, (24).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forgetting {
    /// α₁: 1 − α₁ is the forgetting factor for large errors; `None`: 0.03 for the two stages, 0.001
    /// for Kelvin–Voigt, which on most materials never gets its error small: a memory of a thousand
    /// samples gives its best average, one of thirty a tangent that turns with every stroke.
    pub alpha_1: Option<f32>,
    /// α₂ (1/N): steepness of the transition; `None`: 8/α₃.
    pub alpha_2_per_n: Option<f32>,
    /// α₃ (N): the threshold between small and large errors; `None`: the noise of
    /// the raw force.
    pub alpha_3_n: Option<f32>,
    /// A sample is learned from when the regressor has moved by this fraction of its scale since
    /// the last one that was: a hold repeats itself and would wind the covariance up. At 0.03 a
    /// position that jitters by a count of 1 µm at 3 mm does not pass for motion.
    pub excitation_step: f32,
}

/// Where the estimator starts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Initial {
    /// c of P(0) = c·I, in squared units of the reference scales.
    pub covariance: f32,
    /// K (N/m) at the reference depth.
    pub stiffness_n_per_m: f32,
    /// λ (N s/m) at the reference depth.
    pub damping_ns_per_m: f32,
    /// n.
    pub exponent: f32,
}

/// When an estimate counts as converged, changed or suspect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Judgement {
    /// Converged: every parameter within this fraction of where it was `window_s` of contact ago,
    /// and every standard error below this fraction of its value.
    pub converged_within: f32,
    /// Time in contact over which parameters must be steady (s).
    pub window_s: f32,
    /// Suspect: mean test ratio over the window above this.
    pub suspect_ratio: f32,
}

impl Default for Config {
    fn default() -> Self {
        Config {
            rate_hz: 1000.0,
            reference: Reference {
                depth_m: 1e-3,
                force_n: 1.0,
            },
            filter: Filter::SavitzkyGolay { half_width: 8 },
            contact: Contact {
                surface: Surface::AtImpact,
                touch_sigma: 6.0,
                release_sigma: 3.0,
                force_noise_n: None,
                settle_s: 0.2,
            },
            method: Method::HuntCrossleyBank,
            forgetting: Forgetting {
                alpha_1: None,
                alpha_2_per_n: None,
                alpha_3_n: None,
                excitation_step: 0.03,
            },
            initial: Initial {
                covariance: 1e4,
                stiffness_n_per_m: 1000.0,
                damping_ns_per_m: 0.0,
                exponent: 1.3,
            },
            judgement: Judgement {
                converged_within: 0.05,
                window_s: 0.5,
                suspect_ratio: 25.0,
            },
            inversion: Inversion::Exact,
            cascade: Cascade {
                loading_speed_mps: None,
                weight: Weight::Force,
            },
        }
    }
}
