//! How an impedance is rendered, and what a sampled master can render without generating energy.
//!
//! **How stiff.** A spring K and a damper B that are rendered every T on a device whose own damping is
//! b are passive while b > KT/2 + |B| (J. E. Colgate, G. Schenkel, "Passivity of a class of
//! sampled-data systems: application to haptic interfaces", J. Robotic Systems 14(1), 1997). Two things
//! differ here. Speeds come through a low pass of time constant τ, backward differences as theirs: the
//! condition that belongs to B > 0 is then b > KT/2 + BT/(T + 2τ) (J. M. Brown, J. E. Colgate, "Factors
//! affecting the Z-width of a haptic display", ICRA 1994). And a position is the mean of the tick
//! before, T/2 old; a delay t_d counts like as much more of the hold, K(T/2 + t_d) (J. J. Gil et al.,
//! "Stability boundary for haptic rendering: influence of damping and delay", J. Comput. Inf. Sci. Eng.
//! 9, 2009). Half of b is given to each: K ≤ b/2T and B ≤ b(T + 2τ)/2T. Stiffness is the slope of the
//! elastic part, damping the factor of the speed, both at the depth where the master is.

use super::speed::SPEED_TIME_S;
use crate::estimate::error::{ConfigError, require_each};

/// How an impedance is rendered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RenderConfig {
    /// Samples per second (Hz).
    pub rate_hz: f32,
    /// Largest force (N).
    pub force_n: f32,
    /// Damping of the master itself, b (N s/m), which bounds the stiffness and damping that it renders.
    pub device_ns_per_m: f32,
    /// Fastest change of the force (N/s), other than to zero on a fault.
    pub slew_n_per_s: f32,
    /// Time without a packet after which the force fades out (s).
    pub timeout_s: f32,
    /// Time in which the force fades out, and in which a new packet's force comes in (s).
    pub fade_s: f32,
    /// Factor on the impedance; 1 renders it as it is.
    pub shaping: f32,
}

/// A checked [`RenderConfig`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RenderParams {
    pub(super) period_s: f32,
    pub(super) most_n: f32,
    stiffest: f32,
    most_damping: f32,
    pub(super) slew_n_per_s: f32,
    pub(super) timeout_us: u64,
    pub(super) fade_s: f32,
    pub(super) shaping: f32,
}

impl RenderConfig {
    /// Checks every field.
    ///
    /// # Errors
    /// The first that cannot be used, with its value and what would be right.
    pub fn validate(&self) -> Result<RenderParams, ConfigError> {
        let (rate, force, device) = (self.rate_hz, self.force_n, self.device_ns_per_m);
        let (slew, timeout, fade) = (self.slew_n_per_s, self.timeout_s, self.fade_s);
        require_each! {
            (1.0..=1e6).contains(&rate), "rate_hz", rate, "must lie between 1 Hz and 1 MHz";
            (1e-6..=1e6).contains(&force), "force_n", force, "must lie between 1e-6 and 1e6 N";
            (1e-6..=1e6).contains(&device), "device_ns_per_m", device,
                "must be the damping of the master itself, above 0 N s/m: it bounds what is rendered";
            (1e-3..=1e9).contains(&slew), "slew_n_per_s", slew, "must lie between 1e-3 and 1e9 N/s";
            (1e-3..=1e3).contains(&timeout), "timeout_s", timeout, "must lie between 1e-3 and 1e3 s";
            (1e-3..=1e3).contains(&fade), "fade_s", fade, "must lie between 1e-3 and 1e3 s";
            (0.0..=1e3).contains(&self.shaping), "shaping", self.shaping, "must lie between 0 and 1e3";
        }
        Ok(self.unchecked())
    }

    /// The parameters without a check: the settings of a board have bounds of their own.
    pub(crate) fn unchecked(&self) -> RenderParams {
        let period_s = 1.0 / self.rate_hz;
        let half = 0.5 * self.device_ns_per_m;
        RenderParams {
            period_s,
            most_n: self.force_n,
            stiffest: half / period_s,
            most_damping: half * (period_s + 2.0 * SPEED_TIME_S) / period_s,
            slew_n_per_s: self.slew_n_per_s,
            timeout_us: (1e6 * self.timeout_s) as u64,
            fade_s: self.fade_s,
            shaping: self.shaping,
        }
    }
}

impl RenderParams {
    /// The largest stiffness (N/m) and damping (N s/m) that are rendered.
    pub fn most(&self) -> (f32, f32) {
        (self.stiffest, self.most_damping)
    }
}
