//! The master's own speed, from its positions.

use crate::maths::scalar::seconds;

/// Time constant τ of the low pass over the differences (s). A count of 1 µm within a millisecond is
/// 1 mm/s; through 2 ms it is 0.33 mm/s, and the damping that can be rendered stably is five times what
/// it would be of the differences alone (render.rs).
pub const SPEED_TIME_S: f32 = 2e-3;

/// v = (x − x₋₁ + τv₋₁)/(T + τ): the backward difference of s/(τs + 1).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Speed {
    last: Option<(u64, f32)>,
    speed_mps: f32,
}

impl Speed {
    /// Takes one more position (m) and its time (µs), and gives the speed (m/s). A position that is no
    /// number, or a time that stands still, is passed over. After a gap of more than 10 ms the speed
    /// starts again from standstill.
    pub fn update(&mut self, time_us: u64, position_m: f32) -> f32 {
        const GAP_US: u64 = 10_000;
        if !position_m.is_finite() {
            return self.speed_mps;
        }
        let Some((last_us, last_m)) = self.last else {
            self.last = Some((time_us, position_m));
            return 0.0;
        };
        let elapsed_us = match time_us.checked_sub(last_us) {
            Some(0) => return self.speed_mps,
            elapsed => elapsed.unwrap_or(u64::MAX),
        };
        self.last = Some((time_us, position_m));
        let elapsed_s = seconds::<f32>(elapsed_us);
        let speed =
            (position_m - last_m + SPEED_TIME_S * self.speed_mps) / (elapsed_s + SPEED_TIME_S);
        let usable = elapsed_us <= GAP_US && speed.is_finite();
        self.speed_mps = if usable { speed } else { 0.0 };
        self.speed_mps
    }
}
