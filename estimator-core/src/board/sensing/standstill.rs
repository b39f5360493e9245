//! A position that stops at once in the midst of a motion and later leaps to where the probe is: an encoder
//! that was stuck. It shows when it goes on.
//!
//! Neither half of it is a fault by itself. A motion may end within a sample, a force may change over a probe
//! that stands, and friction holds a probe until it slips.

/// Share of a reading in the average of the speed: about eight readings.
const SHARE: f32 = 0.125;

/// What counts as standing; `after_us` 0: nothing does.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Standstill {
    /// Standing for at least so long (µs).
    pub after_us: u64,
    /// At the speed before, it would have gone at least so far (m).
    pub way_m: f32,
}

/// The speed up to the last change of the position.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Moving {
    since_us: u64,
    position_m: f32,
    speed_m_per_us: f32,
    started: bool,
    /// Readings since the last standstill in the midst of a motion ended.
    readings_since_standstill: u8,
}

/// A time difference (µs) as a number, 4294 s at most: a `u64` would cost the board 60 instructions.
pub(super) fn micros(elapsed_us: u64) -> f32 {
    u32::try_from(elapsed_us).unwrap_or(u32::MAX) as f32
}

impl Moving {
    /// Takes a reading; gives how many have come since the last standstill ended, this one included.
    pub(super) fn update(&mut self, limits: &Standstill, time_us: u64, position_m: f32) -> u8 {
        self.readings_since_standstill = self.readings_since_standstill.saturating_add(1);
        if self.started && position_m == self.position_m {
            return self.readings_since_standstill;
        }
        let elapsed_us = time_us.saturating_sub(self.since_us);
        if self.started && elapsed_us > 0 {
            let elapsed = micros(elapsed_us);
            let far = self.speed_m_per_us.abs() * elapsed > limits.way_m;
            if limits.after_us > 0 && elapsed_us >= limits.after_us && far {
                self.readings_since_standstill = 1;
            }
            let speed = (position_m - self.position_m) / elapsed;
            self.speed_m_per_us += SHARE * (speed - self.speed_m_per_us);
        } else if !self.started {
            // None has ended yet.
            self.readings_since_standstill = u8::MAX;
        }
        (self.since_us, self.position_m) = (time_us, position_m);
        self.started = true;
        self.readings_since_standstill
    }
}
