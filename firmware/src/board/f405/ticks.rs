//! How many ticks have passed: the time of samples, and whether one came late.

use super::F405;
use crate::board::{Board, RATE_HZ};
use estimator_core::{Fault, Faults};

/// Ticks since start.
pub struct Ticks {
    count: u64,
    /// [`F405::now`] of the last tick, had it been on time.
    on_time: Option<u32>,
}

impl Ticks {
    /// Before the first.
    pub const fn new() -> Self {
        Ticks {
            count: 0,
            on_time: None,
        }
    }

    /// The time of this tick (µs), and [`Fault::Overrun`] if ticks were missed before it; `None` of a
    /// spurious call.
    ///
    /// Core and events run from one clock, so ticks stay where the first one was; a sixteenth of
    /// slack is for a first call that came later than usual.
    pub fn next(&mut self) -> Option<(u64, Faults)> {
        let now = F405::now();
        let on_time = *self.on_time.get_or_insert(now.wrapping_sub(F405::TICK));
        let passed = (now.wrapping_sub(on_time) + F405::TICK / 16) / F405::TICK;
        if passed == 0 {
            return None;
        }
        self.on_time = Some(on_time.wrapping_add(passed * F405::TICK));
        self.count += u64::from(passed);
        let faults = match passed {
            1 => Faults::NONE,
            _ => Faults::NONE.with(Fault::Overrun),
        };
        Some((self.count * u64::from(1_000_000 / RATE_HZ), faults))
    }
}
