//! Helpers for reading sensors that need no hardware: sums of oversampled conversions, counters without
//! their wraps, and the time of an instant from a stopwatch that wraps.

/// The count behind a 16-bit counter that wraps.
#[derive(Clone, Copy, Debug, Default)]
pub struct Counter {
    last: u16,
    count: i32,
}

impl Counter {
    /// Starts at 0.
    pub const fn new() -> Self {
        Counter { last: 0, count: 0 }
    }

    /// Returns the count for the reading `counter`, which is right as long as the counter moves by less than
    /// 32 768 between two calls.
    pub fn follow(&mut self, counter: u16) -> i32 {
        let moved = counter.wrapping_sub(self.last) as i16;
        self.last = counter;
        self.count = self.count.wrapping_add(i32::from(moved));
        self.count
    }
}

/// Returns the sum of conversions, the lowest and the highest of them: a conversion at a rail does not
/// show in the sum.
pub fn summed(conversions: impl Iterator<Item = u16>) -> (i32, i32, i32) {
    conversions
        .map(i32::from)
        .fold((0_i32, i32::MAX, i32::MIN), |(sum, low, high), code| {
            (sum.wrapping_add(code), low.min(code), high.max(code))
        })
}

/// The number of ticks that have passed, by a stopwatch that runs from the same clock as the ticks.
#[derive(Clone, Copy, Debug)]
pub struct Ticks {
    /// Length of a tick on the stopwatch.
    length: u32,
    count: u64,
    /// The reading of the stopwatch at the last tick, for a call on time.
    on_time: Option<u32>,
}

impl Ticks {
    /// Starts before the first tick. A tick is `length` on the stopwatch, greater than 0.
    pub const fn new(length: u32) -> Self {
        Ticks {
            length,
            count: 0,
            on_time: None,
        }
    }

    /// Returns the number of this tick, from 1, and whether ticks were missed before it; or `None` for a
    /// spurious call.
    ///
    /// All ticks are counted from the first call; a slack of a sixteenth of a tick allows for a first call
    /// that was late. The number is right for calls less than 2³² of the stopwatch apart.
    pub fn at(&mut self, now: u32) -> Option<(u64, bool)> {
        let on_time = *self.on_time.get_or_insert(now.wrapping_sub(self.length));
        let elapsed = u64::from(now.wrapping_sub(on_time)) + u64::from(self.length / 16);
        let passed = elapsed.checked_div(u64::from(self.length)).unwrap_or(0);
        // For a call a little before its tick, the difference to on_time wraps round.
        if passed == 0 || now.wrapping_sub(on_time) > u32::MAX - self.length / 16 {
            return None;
        }
        self.on_time = Some(on_time.wrapping_add((passed as u32).wrapping_mul(self.length)));
        self.count = self.count.wrapping_add(passed);
        Some((self.count, passed > 1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_counter_goes_on_through_its_wraps_in_both_directions() {
        let mut counter = Counter::new();
        let mut truth = 0_i32;
        for step in [0, 30_000, 30_000, 30_000, 32_767, -32_768, 1, -1] {
            truth += step;
            assert_eq!(counter.follow(truth as u16), truth);
        }
        for _ in 0..1000 {
            truth -= 20_011;
            assert_eq!(counter.follow(truth as u16), truth);
        }
        assert_eq!(truth, 90_000 - 1 - 20_011_000);
    }

    #[test]
    fn a_sum_has_its_lowest_and_its_highest_conversion() {
        let conversions = [2048_u16, 2050, 4095, 2047];
        assert_eq!(summed(conversions.into_iter()), (10_240, 2047, 4095));
        let full = core::iter::repeat_n(4095_u16, 32);
        assert_eq!(summed(full), (131_040, 4095, 4095));
    }

    const TICK: u32 = 168_000;

    #[test]
    fn ticks_are_counted_through_the_stopwatchs_wrap_whatever_the_jitter() {
        let mut ticks = Ticks::new(TICK);
        let mut now = u32::MAX - 5 * TICK;
        for count in 1..=20 {
            // Up to 59 µs late or early: a sixteenth of a tick is 62.
            let jitter = [0, 9_900, 100, 5_000][count as usize % 4];
            assert_eq!(ticks.at(now.wrapping_add(jitter)), Some((count, false)));
            now = now.wrapping_add(TICK);
        }
    }

    #[test]
    fn missed_ticks_are_counted_and_reported_and_a_spurious_call_has_no_number() {
        let mut ticks = Ticks::new(TICK);
        assert_eq!(ticks.at(1000), Some((1, false)));
        assert_eq!(ticks.at(1000 + TICK / 2), None);
        assert_eq!(ticks.at(1000 + TICK), Some((2, false)));
        // An erase of the flash: four seconds.
        assert_eq!(ticks.at(1000 + 4001 * TICK), Some((4002, true)));
        assert_eq!(ticks.at(1000 + 4002 * TICK - 500), Some((4003, false)));
        assert_eq!(ticks.at(1000 + 4002 * TICK + 600), None);
        assert_eq!(ticks.at(1000 + 4003 * TICK), Some((4004, false)));
    }
}
