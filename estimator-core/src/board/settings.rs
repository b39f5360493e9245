//! What a person can set on a board: one table of names, units and bounds, and what follows from the
//! values. The store that keeps them through a power cut is [`store`].
//!
//! Every value is one f32: a whole number up to 2²⁴ is exact in it, and that is more than the codes
//! of a 24-bit converter need. Numbers of settings are stable; they stand in frames and in flash.

pub mod compensation;
mod key;
pub mod store;

pub use key::{Bounds, COUNT, Info, Key};

use crate::board::reflection::{Output, RenderConfig, RenderParams};
use crate::board::sensing::Conversion;
use crate::estimate::compensation::Compensation;
use crate::estimate::config::{Config, Filter};
use crate::estimate::error::ConfigError;
use crate::estimate::fault::{Fault, Faults};
use crate::estimate::method::Method;
use crate::estimate::params::Params;
use core::fmt;

/// A value for every setting.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    values: [f32; COUNT],
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            values: key::TABLE.map(|key| key.info().default),
        }
    }
}

/// A value that cannot be used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Invalid {
    /// Of which setting.
    pub key: Key,
    /// The value.
    pub value: f32,
    /// What would be right, where that is not [`Info::bounds`].
    pub expected: Option<&'static str>,
}

impl fmt::Display for Invalid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let info = self.key.info();
        write!(f, "{} = {}: must be ", info.name, self.value)?;
        match self.expected {
            // The estimator's own errors begin with it.
            Some(expected) => f.write_str(expected.strip_prefix("must be ").unwrap_or(expected)),
            None => write!(f, "{}", info.bounds),
        }
    }
}

impl core::error::Error for Invalid {}

impl Settings {
    /// The value of a setting. Never inlined, as all that runs once in a while: it is in 128 KiB.
    #[inline(never)]
    pub fn get(&self, key: Key) -> f32 {
        self.values
            .get(key.slot())
            .copied()
            .unwrap_or(key.info().default)
    }

    /// Gives a setting a value, whatever it is; [`Settings::check`] judges.
    pub fn put(&mut self, key: Key, value: f32) {
        if let Some(slot) = self.values.get_mut(key.slot()) {
            *slot = value;
        }
    }

    /// Whether every value can be used, alone and together with the others.
    ///
    /// # Errors
    /// The first that cannot.
    pub fn check(&self) -> Result<(), Invalid> {
        self.setup().map(|_| ())
    }

    /// What the sampling task needs.
    ///
    /// # Errors
    /// The first value that cannot be used.
    pub fn setup(&self) -> Result<Setup, Invalid> {
        for key in key::TABLE.iter().copied() {
            let value = self.get(key);
            if !key.info().bounds.hold(value) {
                return Err(Invalid {
                    key,
                    value,
                    expected: None,
                });
            }
        }
        self.check_pairs()?;
        let params = self.config().validate::<f32>().map_err(named)?;
        let compensation = self.compensation()?;
        Ok(Setup {
            params,
            conversion: Conversion::new(self),
            late_us: compensation.map_or(0, |own| (own.delay_s() * 1e6) as u64),
            compensation,
            every: self.get(Key::TelemetryEvery) as u16,
            reflect_every: self.get(Key::ReflectionEvery) as u16,
            reference_depth_m: self.get(Key::EstimatorDepthM),
            render: self.render()?,
            output: self.output(),
        })
    }

    /// How a force is put out.
    pub fn output(&self) -> Output {
        Output {
            zero: self.get(Key::RenderZero),
            full_n: self.get(Key::RenderFullN),
        }
    }

    /// How an impedance is rendered; `None` while the largest force is 0.
    #[inline(never)]
    fn render(&self) -> Result<Option<RenderParams>, Invalid> {
        let force_n = self.get(Key::RenderForceN);
        if force_n == 0.0 {
            return Ok(None);
        }
        if !self.output().carries(force_n) {
            return Err(Invalid {
                key: Key::RenderForceN,
                value: force_n,
                expected: Some("no more than the output carries: render.full_n, render.zero"),
            });
        }
        let config = RenderConfig {
            rate_hz: Config::default().rate_hz,
            force_n,
            device_ns_per_m: self.get(Key::RenderDeviceNsPerM),
            slew_n_per_s: self.get(Key::RenderSlewNps),
            timeout_s: self.get(Key::RenderTimeoutS),
            fade_s: self.get(Key::RenderFadeS),
            shaping: self.get(Key::RenderShaping),
        };
        // Of the bounds of the settings, only the damping's reaches down to what cannot be used: 0.
        match config.device_ns_per_m > 0.0 {
            true => Ok(Some(config.unchecked())),
            false => Err(Invalid {
                key: Key::RenderDeviceNsPerM,
                value: config.device_ns_per_m,
                expected: Some("the master's own damping: it bounds what is rendered"),
            }),
        }
    }

    fn check_pairs(&self) -> Result<(), Invalid> {
        let value = self.get(Key::ForceLowestCode);
        if value >= self.get(Key::ForceHighestCode) {
            return Err(Invalid {
                key: Key::ForceLowestCode,
                value,
                expected: Some("below force.highest_code"),
            });
        }
        Ok(())
    }

    /// The estimator's part of it; what is no setting of a board has its default. Inlined, so that a
    /// board has no code for filters and methods that no setting chooses: 7 KiB.
    #[inline(always)]
    pub fn config(&self) -> Config {
        let mut config = Config {
            method: Method::from_code(self.get(Key::EstimatorMethod) as u8),
            filter: Filter::SavitzkyGolay {
                half_width: self.get(Key::EstimatorHalfWidth) as u8,
            },
            ..Config::default()
        };
        config.reference.depth_m = self.get(Key::EstimatorDepthM);
        config.reference.force_n = self.get(Key::EstimatorForceN);
        config.contact.touch_sigma = self.get(Key::EstimatorTouchSigma);
        config.contact.release_sigma = self.get(Key::EstimatorReleaseSigma);
        config.contact.settle_s = self.get(Key::EstimatorSettleS);
        config
    }

    /// Faults that last as long as these settings do.
    pub fn standing(&self) -> Faults {
        let calibrated =
            self.get(Key::ForceCalibrated) == 1.0 && self.get(Key::PositionCalibrated) == 1.0;
        match calibrated {
            true => Faults::NONE,
            false => Faults::NONE.with(Fault::NotCalibrated),
        }
    }
}

/// What the sampling task needs, checked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setup {
    /// The estimator's coefficients.
    pub params: Params<f32>,
    /// Codes to SI.
    pub conversion: Conversion,
    /// What is taken off the sample before the estimator; `None`: nothing.
    pub compensation: Option<Compensation<f32>>,
    /// How much later that makes the estimates (µs).
    pub late_us: u64,
    /// Every how many samples are sent.
    pub every: u16,
    /// Every how many samples the identified impedance is; 0: never.
    pub reflect_every: u16,
    /// δ₀ (m), that it is reported at.
    pub reference_depth_m: f32,
    /// How a received one is rendered; `None`: it is not.
    pub render: Option<RenderParams>,
    /// How the force of that is put out.
    pub output: Output,
}

/// The setting behind a field of [`Config`]. Bounds above are those of the fields, so what is left
/// is a field that is no setting: none today.
fn named(error: ConfigError) -> Invalid {
    let fields = [
        ("method", Key::EstimatorMethod),
        ("reference.depth_m", Key::EstimatorDepthM),
        ("reference.force_n", Key::EstimatorForceN),
        ("filter.half_width", Key::EstimatorHalfWidth),
        ("contact.touch_sigma", Key::EstimatorTouchSigma),
        ("contact.release_sigma", Key::EstimatorReleaseSigma),
        ("contact.settle_s", Key::EstimatorSettleS),
    ];
    let known = fields.into_iter().find(|(field, _)| *field == error.field);
    Invalid {
        key: known.map_or(Key::EstimatorMethod, |(_, key)| key),
        value: error.value,
        expected: Some(error.expected),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    extern crate std;
    use std::string::ToString;

    #[test]
    fn the_defaults_are_the_estimators_and_can_be_used() {
        let settings = Settings::default();
        settings.check().unwrap();
        assert_eq!(settings.config(), Config::default());
        assert!(settings.standing().has(Fault::NotCalibrated));
    }

    #[test]
    fn a_value_at_either_bound_can_be_used_and_one_beyond_cannot() {
        for key in Key::ALL {
            let (low, high) = match key.info().bounds {
                Bounds::Within(low, high)
                | Bounds::Signed(low, high)
                | Bounds::Whole(low, high) => (low, high),
            };
            let bad = [
                low - 1.0 - 0.01 * low.abs(),
                high * 1.01 + 1.0,
                f32::NAN,
                f32::INFINITY,
            ];
            for value in bad.into_iter().filter(|value| {
                !matches!(key.info().bounds, Bounds::Signed(..)) || value.abs() > high
            }) {
                let mut settings = Settings::default();
                settings.put(key, value);
                assert_eq!(settings.check().unwrap_err().key, key, "{key:?} = {value}");
            }
            assert!(key.info().bounds.hold(low) && key.info().bounds.hold(high));
            assert!(key.info().bounds.hold(key.info().default), "{key:?}");
        }
    }

    /// Within its bounds, no setting is refused by the estimator's own validation.
    #[test]
    fn the_bounds_of_the_estimators_settings_are_its_own() {
        let own = |key: &Key| (32..48).contains(&key.id());
        for key in Key::ALL.into_iter().filter(own) {
            let (Bounds::Within(low, high) | Bounds::Signed(low, high) | Bounds::Whole(low, high)) =
                key.info().bounds;
            for value in [low, high] {
                let mut settings = Settings::default();
                // The pair: lift-off must stay below touch.
                match key {
                    Key::EstimatorTouchSigma => settings.put(Key::EstimatorReleaseSigma, 1.0),
                    Key::EstimatorReleaseSigma => settings.put(Key::EstimatorTouchSigma, 1000.0),
                    _ => {}
                }
                settings.put(key, value);
                assert_eq!(settings.check(), Ok(()), "{key:?} = {value}");
            }
        }
    }

    #[test]
    fn an_error_names_setting_value_and_what_would_be_right() {
        let mut settings = Settings::default();
        settings.put(Key::EstimatorHalfWidth, 8.5);
        assert_eq!(
            settings.check().unwrap_err().to_string(),
            "estimator.half_width = 8.5: must be a whole number from 2 to 32"
        );
        let mut settings = Settings::default();
        settings.put(Key::ForceLowestCode, 5000.0);
        assert_eq!(
            settings.check().unwrap_err().to_string(),
            "force.lowest_code = 5000: must be below force.highest_code"
        );
    }
}
