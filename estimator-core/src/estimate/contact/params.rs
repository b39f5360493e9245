//! Checked parameters of the contact detector.

use super::resting_force::follow_gain;
use crate::estimate::{config, config::Config, error::ConfigError, error::require_each};
use crate::maths::scalar::Real;

/// Smallest noise that is assumed, as a fraction of the reference force: in a log without noise the
/// first rounding error would otherwise be a touch.
pub const NOISE_FLOOR: f64 = 1e-4;

/// Checked parameters of the contact detector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactParams<T> {
    pub(super) surface: Option<T>,
    pub(super) touch_sigma: T,
    pub(super) release_sigma: T,
    pub(super) configured_noise_n: Option<T>,
    pub(super) noise_floor_n: T,
    pub(super) count_m: Option<T>,
    pub(super) settle_samples: u32,
    pub(super) rest_gain: T,
}

impl<T: Real> ContactParams<T> {
    pub(crate) fn validate(config: &Config) -> Result<Self, ConfigError> {
        let contact = config.contact;
        let (touch, release) = (contact.touch_sigma, contact.release_sigma);
        let noise = contact.force_noise_n.unwrap_or(0.0);
        let step = contact.position_step_m.unwrap_or(0.0);
        let settle_samples = contact.settle_s * config.rate_hz;
        require_each! {
            (1.0..=100.0).contains(&release), "contact.release_sigma", release,
                "must lie between 1 and 100 standard deviations";
            touch >= release && touch <= 1000.0, "contact.touch_sigma", touch,
                "must lie between release_sigma and 1000 standard deviations";
            (0.0..=1e6).contains(&noise), "contact.force_noise_n", noise,
                "must be a standard deviation in newtons, or absent";
            (0.0..=1e3).contains(&step), "contact.position_step_m", step,
                "must be one count in metres, or absent";
            (10.0..=1e6).contains(&settle_samples), "contact.settle_s", contact.settle_s,
                "must cover 10 to 1 000 000 samples in free air";
        }
        let surface = match contact.surface {
            config::Surface::AtImpact => None,
            config::Surface::Known { position_m } => {
                require_each! {
                    position_m.is_finite(), "contact.surface.position_m", position_m,
                        "must be a position in metres";
                }
                Some(T::from_f64(f64::from(position_m)))
            }
        };
        let from = |value: f32| T::from_f64(f64::from(value));
        Ok(ContactParams {
            surface,
            touch_sigma: from(contact.touch_sigma),
            release_sigma: from(contact.release_sigma),
            configured_noise_n: contact.force_noise_n.map(from),
            count_m: contact.position_step_m.map(from),
            noise_floor_n: T::from_f64(NOISE_FLOOR * f64::from(config.reference.force_n)),
            settle_samples: settle_samples as u32,
            rest_gain: follow_gain(config.rate_hz),
        })
    }

    /// Whether the configuration gives the position of the surface.
    pub fn surface_known(&self) -> bool {
        self.surface.is_some()
    }
}
