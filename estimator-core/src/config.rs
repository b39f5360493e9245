//! Configuration: what a person writes down, checked once, outside the loop.
//!
//! `Config` → `validate` → `Params`. `Params` holds coefficients only; a loop that has
//! one cannot be misconfigured.

use crate::law::LawKind;

/// All settings of an estimator. The defaults are for a 1 kHz motor controller that presses
/// millimetres deep with newtons.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Config {
    /// Samples per second [Hz].
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
}

/// Scales of the contact. Parameters are reported at `depth_m`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reference {
    /// δ₀ [m].
    pub depth_m: f32,
    /// A typical force [N].
    pub force_n: f32,
}

/// The filter in front of the estimator: one delay for position, speed and force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Filter {
    /// Second-order state-variable filter, the chapter's.
    StateVariable {
        /// Corner frequency [Hz].
        cutoff_hz: f32,
        /// ζ: 1 is critically damped.
        damping_ratio: f32,
    },
    /// Least-squares quadratic over 2·half_width + 1 samples; delay half_width samples at every
    /// frequency.
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
    /// Standard deviation of the raw force [N]; `None`: measured while settling.
    pub force_noise_n: Option<f32>,
    /// Time in free air, at the start, over which noise and resting force are measured [s].
    pub settle_s: f32,
}

/// How the surface is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Surface {
    /// The position of impact is taken for the surface, anew at every touch (the chapter's way).
    AtImpact,
    /// It is known [m].
    Known {
        /// Position of the surface [m].
        position_m: f32,
    },
}

/// The estimators.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Method {
    /// Recursive least squares on Kelvin–Voigt (1), (20)–(23).
    KelvinVoigt = 1,
    /// Two recursive least squares in feedback on Hunt–Crossley (25)–(37).
    HuntCrossleyTwoStage = 2,
}

impl Method {
    /// The law that the method identifies.
    pub const fn law(self) -> LawKind {
        match self {
            Method::KelvinVoigt => LawKind::KelvinVoigt,
            Method::HuntCrossleyTwoStage => LawKind::HuntCrossley,
        }
    }
}

/// β = 1 − α₁{(1/π)·arctan[α₂(|F − F̂| − α₃)] + ½}, (24).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forgetting {
    /// α₁: 1 − α₁ is the forgetting factor for large errors.
    pub alpha_1: f32,
    /// α₂ [1/N]: steepness of the transition; `None`: STEEPNESS/α₃.
    pub alpha_2_per_n: Option<f32>,
    /// α₃ [N]: the threshold between small and large errors; `None`:
    /// THRESHOLD_SIGMAS × the noise of the raw force.
    pub alpha_3_n: Option<f32>,
    /// A sample is learned from when the regressor has moved by this fraction of its scale since
    /// the last one that was: a hold repeats itself and would wind the covariance up.
    pub excitation_step: f32,
}

/// Where the estimator starts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Initial {
    /// c of P(0) = c·I, in squared units of the reference scales.
    pub covariance: f32,
    /// K [N/m] at the reference depth.
    pub stiffness_n_per_m: f32,
    /// λ [N s/m] at the reference depth.
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
    /// Time in contact over which parameters must be steady [s].
    pub window_s: f32,
    /// Suspect: mean test ratio over the window above this.
    pub suspect_ratio: f32,
}
