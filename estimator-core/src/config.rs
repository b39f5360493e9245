//! Configuration: what a person writes down, checked once, outside the loop.
//!
//! [`Config`] → [`Config::validate`] → [`Params`]. `Params` holds coefficients only; a loop that has
//! one cannot be misconfigured.

use crate::contact::ContactParams;
use crate::error::{ConfigError, require};
use crate::filter::FilterParams;
use crate::identify::{Scale, Start};
use crate::law::LawKind;
use crate::rls::ForgettingParams;
use crate::scalar::Real;
use crate::status::StatusParams;

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

/// The estimators.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Method {
    /// Recursive least squares on Kelvin–Voigt (1), (20)–(23).
    KelvinVoigt = 1,
    /// Two recursive least squares in feedback on Hunt–Crossley (25)–(37).
    HuntCrossleyTwoStage = 2,
    /// One recursive least squares on the logarithm of Hunt–Crossley (Haddadi & Hashtrudi-Zaad 2012).
    HuntCrossleyLogLinear = 9,
    /// Recursive least squares on Zener as ARX (18).
    ZenerArx = 3,
    /// Two recursive least squares in cascade on the quasi-linear law, one mode (39)–(42).
    HammersteinCascade = 4,
    /// The same with two modes.
    HammersteinCascade2 = 7,
    /// Hunt–Crossley by a bank of exact fits and a recursive Gauss–Newton refiner, the surface among
    /// the parameters.
    HuntCrossleyBank = 5,
    /// The same with the skew, by how much the force is read later than the position.
    HuntCrossleyBankSkew = 8,
    /// Kelvin–Voigt by recursive least squares, the surface among the parameters.
    KelvinVoigtSurface = 6,
    /// Zener by a bank of exact fits over surface and rate, refined over a history; the surface
    /// among the parameters.
    ZenerBank = 10,
    /// The quasi-linear law with one mode by a bank over exponent, surface and rate, refined over a
    /// history; the surface among the parameters.
    QuasiLinearBank = 11,
    /// The same with two modes, once the force speaks for the second.
    QuasiLinearBank2 = 12,
    /// Kelvin–Voigt, Hunt–Crossley, Zener and quasi-linear with one mode side by side over the same
    /// history; the records say which law they are of.
    Selection = 13,
}

impl Method {
    /// The law that the method identifies.
    pub const fn law(self) -> LawKind {
        match self {
            // The law that a selection starts with.
            Method::KelvinVoigt | Method::KelvinVoigtSurface | Method::Selection => {
                LawKind::KelvinVoigt
            }
            Method::HuntCrossleyTwoStage
            | Method::HuntCrossleyBank
            | Method::HuntCrossleyLogLinear => LawKind::HuntCrossley,
            Method::HuntCrossleyBankSkew => LawKind::HuntCrossleySkew,
            Method::ZenerArx | Method::ZenerBank => LawKind::Zener,
            Method::HammersteinCascade | Method::QuasiLinearBank => LawKind::QuasiLinear,
            Method::HammersteinCascade2 | Method::QuasiLinearBank2 => LawKind::QuasiLinear2,
        }
    }
}

impl Method {
    /// Whether the method is one over a history, which a build for the board leaves out.
    pub const fn has_history(self) -> bool {
        matches!(
            self,
            Method::ZenerBank
                | Method::QuasiLinearBank
                | Method::QuasiLinearBank2
                | Method::Selection
        )
    }

    /// Whether the surface is among the parameters, rather than taken from the impact.
    pub const fn finds_surface(self) -> bool {
        matches!(
            self,
            Method::HuntCrossleyBank
                | Method::HuntCrossleyBankSkew
                | Method::KelvinVoigtSurface
                | Method::ZenerBank
                | Method::QuasiLinearBank
                | Method::QuasiLinearBank2
                | Method::Selection
        )
    }
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

/// Coefficients of the loop, ready to use. Made by [`Config::validate`] only.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Params<T> {
    pub(crate) period_us: u64,
    pub(crate) period_s: T,
    pub(crate) method: Method,
    pub(crate) scale: Scale<T>,
    pub(crate) filter: FilterParams<T>,
    pub(crate) contact: ContactParams<T>,
    pub(crate) forgetting: ForgettingParams<T>,
    pub(crate) excitation_step: T,
    pub(crate) start: Start<T>,
    pub(crate) status: StatusParams<T>,
    pub(crate) inversion: Inversion,
    pub(crate) cascade: CascadeParams<T>,
}

/// δ̇* in the scale of the estimators, and the weight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CascadeParams<T> {
    pub(crate) loading_speed: T,
    pub(crate) weight: Weight,
}

/// δ̇* over the reference speed where it is left open: 5 δ₀/s. The chapter's ramp is 30 mm/s.
const LOADING_SPEED: f64 = 0.5;

impl<T: Real> Params<T> {
    /// Delay of every record behind the newest sample (µs).
    pub fn delay_us(&self) -> u64 {
        self.filter.delay_us()
    }

    /// The law that is identified.
    pub fn law(&self) -> LawKind {
        self.method.law()
    }

    /// (α₁, α₂ (1/N), α₃ (N)) of (24) at a noise of the raw force (N).
    pub fn alphas(&self, noise_n: T) -> (T, T, T) {
        self.forgetting.alphas(noise_n)
    }
}

impl Config {
    /// Checks every field and makes the coefficients.
    ///
    /// # Errors
    /// The first field that cannot be used, with its value and what would be right.
    pub fn validate<T: Real>(&self) -> Result<Params<T>, ConfigError> {
        let rate = self.rate_hz;
        require(
            (1.0..=1e6).contains(&rate),
            "rate_hz",
            rate,
            "must lie between 1 Hz and 1 MHz",
        )?;
        require(
            cfg!(feature = "relaxing") || !self.method.has_history(),
            "method",
            f32::from(self.method as u8),
            "must be below 10: this build has no method over a history",
        )?;
        self.reference.check()?;
        self.initial.check()?;
        let step = self.forgetting.excitation_step;
        require(
            (0.0..=1.0).contains(&step),
            "forgetting.excitation_step",
            step,
            "must lie between 0 (always learn) and 1",
        )?;
        let scale = Scale::new(self.reference);
        Ok(Params {
            period_us: libm::round(1e6 / f64::from(rate)) as u64,
            period_s: T::from_f64(1.0 / f64::from(rate)),
            method: self.method,
            scale,
            filter: FilterParams::validate(self.filter, rate)?,
            contact: ContactParams::validate(self)?,
            forgetting: ForgettingParams::validate(self)?,
            excitation_step: T::from_f64(f64::from(step)),
            start: Start::new(self.initial, self.reference),
            status: StatusParams::validate(self)?,
            inversion: self.inversion,
            cascade: self.cascade.validate(&scale)?,
        })
    }
}

impl Cascade {
    fn validate<T: Real>(&self, scale: &Scale<T>) -> Result<CascadeParams<T>, ConfigError> {
        let speed = self.loading_speed_mps.unwrap_or(1.0);
        require(
            speed > 0.0 && speed.finite(),
            "cascade.loading_speed_mps",
            speed,
            "must be positive, in m/s, or absent",
        )?;
        let loading_speed = match self.loading_speed_mps {
            Some(speed) => T::from_f64(f64::from(speed)) / scale.speed_mps,
            None => T::from_f64(LOADING_SPEED),
        };
        Ok(CascadeParams {
            loading_speed,
            weight: self.weight,
        })
    }
}

impl Reference {
    fn check(&self) -> Result<(), ConfigError> {
        let depth = self.depth_m;
        let good = (1e-10..=1.0).contains(&depth);
        require(
            good,
            "reference.depth_m",
            depth,
            "must lie between 1e-10 and 1 m",
        )?;
        let force = self.force_n;
        let good = (1e-12..=1e6).contains(&force);
        require(
            good,
            "reference.force_n",
            force,
            "must lie between 1e-12 and 1e6 N",
        )
    }
}

impl Initial {
    fn check(&self) -> Result<(), ConfigError> {
        let c = self.covariance;
        let good = (1e-3..=1e8).contains(&c);
        require(
            good,
            "initial.covariance",
            c,
            "must lie between 1e-3 and 1e8",
        )?;
        let k = self.stiffness_n_per_m;
        let good = (0.0..=1e9).contains(&k);
        require(
            good,
            "initial.stiffness_n_per_m",
            k,
            "must lie between 0 and 1e9 N/m",
        )?;
        let b = self.damping_ns_per_m;
        let good = (0.0..=1e9).contains(&b);
        require(
            good,
            "initial.damping_ns_per_m",
            b,
            "must lie between 0 and 1e9 N s/m",
        )?;
        let n = self.exponent;
        let good = (0.5..=3.0).contains(&n);
        require(good, "initial.exponent", n, "must lie between 0.5 and 3")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    extern crate std;
    use std::string::ToString;

    fn error_of(change: impl Fn(&mut Config)) -> ConfigError {
        let mut config = Config::default();
        change(&mut config);
        config.validate::<f32>().unwrap_err()
    }

    #[test]
    fn an_error_names_the_field_its_value_and_what_would_be_right() {
        let error = error_of(|c| c.forgetting.alpha_1 = Some(1.7));
        let text = error.to_string();
        assert_eq!(
            text,
            "forgetting.alpha_1 = 1.7: must lie between 0 (never forget) and 0.5"
        );
    }

    #[test]
    fn every_field_is_checked_and_not_a_number_is_never_valid() {
        type Change = fn(&mut Config);
        let changes: [(&str, Change); 16] = [
            ("rate_hz", |c| c.rate_hz = f32::NAN),
            ("reference.depth_m", |c| c.reference.depth_m = f32::NAN),
            ("reference.force_n", |c| c.reference.force_n = 0.0),
            ("filter.half_width", |c| {
                c.filter = Filter::SavitzkyGolay { half_width: 33 }
            }),
            ("filter.cutoff_hz", |c| {
                c.filter = Filter::StateVariable {
                    cutoff_hz: f32::NAN,
                    damping_ratio: 1.0,
                };
            }),
            ("filter.damping_ratio", |c| {
                c.filter = Filter::StateVariable {
                    cutoff_hz: 40.0,
                    damping_ratio: 0.0,
                };
            }),
            ("contact.touch_sigma", |c| c.contact.touch_sigma = 2.0),
            ("contact.release_sigma", |c| {
                c.contact.release_sigma = f32::NAN
            }),
            ("contact.force_noise_n", |c| {
                c.contact.force_noise_n = Some(f32::INFINITY)
            }),
            ("contact.settle_s", |c| c.contact.settle_s = 0.0),
            ("contact.surface.position_m", |c| {
                c.contact.surface = Surface::Known {
                    position_m: f32::NAN,
                };
            }),
            ("forgetting.alpha_2_per_n", |c| {
                c.forgetting.alpha_2_per_n = Some(-1.0)
            }),
            ("forgetting.alpha_3_n", |c| {
                c.forgetting.alpha_3_n = Some(f32::NAN)
            }),
            ("initial.exponent", |c| c.initial.exponent = f32::NAN),
            ("judgement.window_s", |c| c.judgement.window_s = f32::NAN),
            ("cascade.loading_speed_mps", |c| {
                c.cascade.loading_speed_mps = Some(f32::NAN)
            }),
        ];
        for (field, change) in changes {
            assert_eq!(error_of(change).field, field);
        }
    }
}
