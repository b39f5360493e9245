//! What a person can set on a board: one table of names, units and bounds, and what follows from the
//! values. The store that keeps them through a power cut is [`store`].
//!
//! Every value is one f32: a whole number up to 2²⁴ is exact in it, and that is more than the codes
//! of a 24-bit converter need. Numbers of settings are stable; they stand in frames and in flash.

pub mod compensation;
mod effects;
mod info;
mod key;
mod setup;
pub mod store;
mod values;

pub use info::{Bounds, Info};
pub use key::{COUNT, Key};
pub use setup::Setup;
pub use values::{Invalid, Settings};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::config::Config;
    use crate::estimate::fault::Fault;
    extern crate std;
    use std::string::ToString;

    #[test]
    fn the_defaults_are_the_estimators_and_can_be_used() {
        let settings = Settings::default();
        settings.check().unwrap();
        let mut config = Config::default();
        // 32 codes of 1 µm/32.
        config.contact.position_step_m = Some(1e-6);
        assert_eq!(settings.config(), config);
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
