//! The configuration of an estimator, as a person writes it.
//!
//! [`Config::validate`] checks it once, outside the loop, and makes [`Params`](crate::Params) of it, so
//! that a loop with parameters cannot be misconfigured.

use crate::estimate::method::Method;

/// All settings of an estimator. The defaults are for a motor controller at 1 kHz that presses
/// millimetres deep with forces of newtons.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Config {
    /// Sampling rate (Hz). Windows that are counts of samples (the margins of a touch, pools, the memory of the resting
    /// force) were tuned at 0.5 to 2 kHz: at 10 kHz they are a tenth as long, and a host averages such logs first.
    pub rate_hz: f32,
    /// Depth and force of a typical contact, with which the problem is well conditioned.
    pub reference: Reference,
    /// Filter that smooths position and force and gives the speed.
    pub filter: Filter,
    /// Detection of touch and lift-off.
    pub contact: Contact,
    /// Method of estimation.
    pub method: Method,
    /// Error-dependent forgetting (24).
    pub forgetting: Forgetting,
    /// Start values of the parameters and of their covariance.
    pub initial: Initial,
    /// Bounds within which an estimate counts as converged, or as suspect.
    pub judgement: Judgement,
    /// Conversion of the coefficients of (18) to κ₁, κ₂ and λ.
    pub inversion: Inversion,
    /// Settings of the Hammerstein cascade (39)–(42).
    pub cascade: Cascade,
}

/// Conversion of the coefficients of (18) to κ₁, κ₂ and λ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Inversion {
    /// The exact conversion for a depth that is linear between samples.
    Exact,
    /// Forward Euler, as printed in the chapter; its rate is too low by the fraction νT/2.
    ForwardEuler,
}

/// Settings of the Hammerstein cascade (39)–(42).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cascade {
    /// δ̇* (m/s): the elastic response is learned while the probe presses faster than this. `None` stands
    /// for 5 δ₀/s.
    pub loading_speed_mps: Option<f32>,
    /// Weight of the samples in Γ₁.
    pub weight: Weight,
}

/// Weight of a sample in the Hammerstein cascade, which compensates that the logarithm magnifies the
/// errors of small forces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Weight {
    /// The chapter's weight e^{y₁} = F.
    Force,
    /// The weight e^{2y₁} = F², which minimises the error of F.
    ForceSquared,
}

/// Depth and force of a typical contact. Parameters are reported at this depth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reference {
    /// Reference depth δ₀ (m).
    pub depth_m: f32,
    /// Reference force (N).
    pub force_n: f32,
}

/// The filter in front of the estimator, with the same delay for position, speed and force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Filter {
    /// The chapter's second-order state-variable filter.
    StateVariable {
        /// Corner frequency (Hz).
        cutoff_hz: f32,
        /// Damping ratio ζ: 1 is critically damped.
        damping_ratio: f32,
    },
    /// The Savitzky–Golay slope over 2·half_width + 1 samples, with the smoothing that it implies for
    /// position and force. Its delay is half_width samples at every frequency: 8 ms by default.
    SavitzkyGolay {
        /// Number of samples on either side of the centre.
        half_width: u8,
    },
}

/// Detection of touch and lift-off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Source of the position of the surface.
    pub surface: Surface,
    /// Force of a touch, in standard deviations of the raw force.
    pub touch_sigma: f32,
    /// Force of a lift-off, in standard deviations of the raw force.
    pub release_sigma: f32,
    /// Standard deviation of the noise of the raw force (N). `None` stands for that measured while
    /// settling.
    pub force_noise_n: Option<f32>,
    /// One count of the encoder (m), where the smallest step that the position makes may be less: where samples are
    /// sums of latches, interpolated or averaged. At rest and in slow motion their error is still that of a whole one.
    /// `None` stands for that step.
    pub position_step_m: Option<f32>,
    /// Time in free air at the start over which noise and resting force are measured (s).
    pub settle_s: f32,
}

/// Source of the position of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Surface {
    /// The surface is the position of impact, found anew at every touch as in the chapter.
    AtImpact,
    /// The position of the surface is known.
    Known {
        /// Position of the surface (m).
        position_m: f32,
    },
}

/// Error-dependent forgetting factor β = 1 − α₁{(1/π)·arctan[α₂(|F − F̂| − α₃)] + ½}, (24).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forgetting {
    /// α₁, with 1 − α₁ the forgetting factor for large errors. `None` stands for 0.03 in the methods for
    /// Hunt–Crossley with two stages or a bank, and 0.001 in the others. The error of Kelvin–Voigt is
    /// large on most materials: a memory of a thousand samples gives its best average, and one of thirty
    /// a tangent that turns with every stroke.
    pub alpha_1: Option<f32>,
    /// α₂ (1/N), the steepness of the transition. `None` stands for 8/α₃.
    pub alpha_2_per_n: Option<f32>,
    /// α₃ (N), the threshold between small and large errors. `None` stands for the noise of the raw
    /// force.
    pub alpha_3_n: Option<f32>,
    /// Motion of the regressor that counts as excitation, as a fraction of the regressor: a hold repeats
    /// one regressor and would let the covariance grow. At 0.03, a position that changes by one count of
    /// 1 µm at a depth of 3 mm does not count as motion.
    pub excitation_step: f32,
}

/// Start values of the parameters and of their covariance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Initial {
    /// Factor c of P(0) = c·I, in squared units of the reference scales.
    pub covariance: f32,
    /// Stiffness K at the reference depth (N/m).
    pub stiffness_n_per_m: f32,
    /// Damping λ at the reference depth (N s/m).
    pub damping_ns_per_m: f32,
    /// Exponent n (1).
    pub exponent: f32,
}

/// Bounds within which an estimate counts as converged, or as suspect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Judgement {
    /// Bound for converged estimates: every parameter has changed by less than this fraction within
    /// `window_s` of contact, and every standard error is below this fraction of its value.
    pub converged_within: f32,
    /// Time in contact over which the parameters must be steady (s).
    pub window_s: f32,
    /// Bound for a suspect law: the mean test ratio over the window is above this.
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
                position_step_m: None,
                settle_s: 0.2,
            },
            method: Method::HUNT_CROSSLEY_BANK,
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
