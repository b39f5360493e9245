//! What follows from the settings: the parts of the sampling task, checked.

use super::{key::Key, values::Invalid, values::Settings};
use crate::board::protection::Arming;
use crate::board::reflection::{Output, RenderConfig, RenderParams};
use crate::board::sensing::{CODES_PER_COUNT, Conversion, Limits};
use crate::estimate::{
    compensation::Compensation, config::Config, config::Filter, error::ConfigError, fault::Fault,
    fault::Faults, method::Method, params::Params,
};

/// What the sampling task needs, checked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setup {
    /// The estimator's coefficients.
    pub params: Params<f32>,
    /// Codes to SI.
    pub conversion: Conversion,
    /// The compensation of the samples before the estimator; `None`: they go in as they are.
    pub compensation: Option<Compensation<f32>>,
    /// The delay of the estimates that the compensation makes (µs).
    pub late_us: u64,
    /// The number of samples of which one is sent.
    pub every: u16,
    /// The number of samples after which the identified impedance is sent; 0: never.
    pub reflect_every: u16,
    /// δ₀, the depth at which it is reported (m).
    pub reference_depth_m: f32,
    /// How a received impedance is rendered; `None`: it is not.
    pub render: Option<RenderParams>,
    /// How the rendered force is put out.
    pub output: Output,
    /// The arming of the force output. Settings never arm: they are read after a reset.
    pub arming: Arming,
}

impl Settings {
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
        self.out_of_bounds().map_or(Ok(()), Err)?;
        self.check_pairs()?;
        let params = self.config().validate::<f32>().map_err(named)?;
        let compensation = self.compensation()?;
        Ok(Setup {
            params,
            conversion: self.conversion(),
            late_us: compensation.map_or(0, |taken_off| (taken_off.delay_s() * 1e6) as u64),
            compensation,
            every: self.get(Key::TelemetryEvery) as u16,
            reflect_every: self.get(Key::ReflectionEvery) as u16,
            reference_depth_m: self.get(Key::EstimatorDepthM),
            render: self.render()?,
            output: self.output(),
            arming: 0,
        })
    }

    /// Scale and limits of the sensors' codes.
    fn conversion(&self) -> Conversion {
        let limits = Limits {
            lowest: self.get(Key::ForceLowestCode),
            highest: self.get(Key::ForceHighestCode),
            broken_beyond: self.get(Key::ForceBrokenBeyond),
            reach_m: self.get(Key::PositionReachM),
            stuck_us: (self.get(Key::ForceStuckS) * 1e6) as u64,
            fastest_m_per_us: self.get(Key::PositionFastestMps) * 1e-6,
            stuck_n: self.get(Key::PositionStuckN),
            ..Limits::NONE
        };
        let conversion = Conversion::new(
            self.get(Key::ForcePerCode),
            self.get(Key::ForceZeroCode),
            self.get(Key::PositionPerCode),
            limits,
        );
        conversion.with_standing(self.standing())
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

    /// The estimator's configuration; fields that are no setting of a board have their defaults.
    /// Inlined, so that a board has no code for filters and methods that no setting chooses: 7 KiB.
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
        config.contact.position_step_m = Some(self.count_m());
        config
    }

    /// One count of the encoder (m).
    pub(super) fn count_m(&self) -> f32 {
        self.get(Key::PositionPerCode).abs() * CODES_PER_COUNT as f32
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

/// The error of a field of [`Config`] as that of its setting. A field that is no setting keeps its
/// default, and cannot be wrong.
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
