//! Checked parameters, which [`Config::validate`] makes of a configuration once, outside the loop.

use crate::estimate::{
    config::Config, contact::ContactParams, error::ConfigError, error::require_each,
    filter::FilterParams, identify, identify::IdentifyParams, monitor::MonitorParams,
};
use crate::maths::scalar::Real;
use crate::physics::law::LawKind;

/// Checked parameters of the loop, which only [`Config::validate`] makes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Params<T> {
    pub(crate) period_us: u64,
    pub(crate) period_s: T,
    pub(crate) filter: FilterParams<T>,
    pub(crate) contact: ContactParams<T>,
    pub(crate) identify: IdentifyParams<T>,
    pub(crate) monitor: MonitorParams<T>,
}

impl<T: Real> Params<T> {
    /// Delay of every estimate behind the newest sample (µs).
    pub fn delay_us(&self) -> u64 {
        self.filter.response().delay_us
    }

    /// The law that the configured method identifies.
    pub fn law(&self) -> LawKind {
        self.identify.law
    }

    /// The coefficients α₁, α₂ (1/N) and α₃ (N) of (24) for a raw force with this noise (N).
    pub fn alphas(&self, noise_n: T) -> (T, T, T) {
        self.identify.forgetting.alphas(noise_n)
    }
}

impl Config {
    /// Checks every field and makes the parameters of the loop.
    ///
    /// # Errors
    /// The error names the first field that cannot be used, its value and what would be right.
    pub fn validate<T: Real>(&self) -> Result<Params<T>, ConfigError> {
        let rate = self.rate_hz;
        require_each! {
            (1.0..=1e6).contains(&rate), "rate_hz", rate, "must lie between 1 Hz and 1 MHz";
        }
        let filter = FilterParams::validate(self.filter, rate)?;
        let contact = ContactParams::validate(self)?;
        Ok(Params {
            period_us: libm::round(1e6 / f64::from(rate)) as u64,
            period_s: T::from_f64(1.0 / f64::from(rate)),
            identify: identify::validate(self, &filter, &contact)?,
            monitor: MonitorParams::validate(self, filter.response().noise_gain)?,
            filter,
            contact,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::config::{Filter, Surface};
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
        let changes: [(&str, Change); 17] = [
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
            ("contact.position_step_m", |c| {
                c.contact.position_step_m = Some(-1e-6)
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
