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

/// A tick that a stopwatch has told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ToldTick {
    /// The number of the tick, from 1.
    pub number: u64,
    /// Ticks were missed before it.
    pub missed: bool,
    /// The reading of the stopwatch for which the tick was due.
    pub due: u32,
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

    /// Takes note that the ticks start at the reading `now`, or start again: the next one is due a tick later.
    /// Ticks that were missed since the last one are counted, to the nearest.
    pub fn start(&mut self, now: u32) {
        if let Some(on_time) = self.on_time {
            let elapsed = now.wrapping_sub(on_time);
            let passed = elapsed
                .saturating_add(self.length / 2)
                .checked_div(self.length);
            self.count = self.count.wrapping_add(u64::from(passed.unwrap_or(0)));
        }
        self.on_time = Some(now);
    }

    /// Returns whether a tick should have come long ago: one and a half since the last one.
    pub fn is_overdue(&self, now: u32) -> bool {
        let since = |on_time| now.wrapping_sub(on_time);
        let elapsed = self.on_time.map_or(0, since);
        elapsed > self.length.saturating_add(self.length / 2) && elapsed < u32::MAX / 2
    }

    /// Returns this tick, or `None` for a spurious call.
    ///
    /// All ticks are counted from the first call. A call that comes earlier than all before it, by at most a
    /// sixteenth of a tick, shows that those were late, and from then on ticks are due as early. The number
    /// is right for calls less than 2³² of the stopwatch apart. In 32 bits: a division of 64 costs 100
    /// instructions.
    pub fn at(&mut self, now: u32) -> Option<ToldTick> {
        let slack = self.length / 16;
        let on_time = *self.on_time.get_or_insert(now.wrapping_sub(self.length));
        let elapsed = now.wrapping_sub(on_time);
        // For a call a little before its tick, the difference to on_time wraps round.
        if elapsed > u32::MAX - slack {
            return None;
        }
        let passed = (elapsed + slack).checked_div(self.length).unwrap_or(0);
        if passed == 0 {
            return None;
        }
        let expected = on_time.wrapping_add(passed.wrapping_mul(self.length));
        let early = expected.wrapping_sub(now);
        let due = if early <= slack { now } else { expected };
        self.on_time = Some(due);
        self.count = self.count.wrapping_add(u64::from(passed));
        Some(ToldTick {
            number: self.count,
            missed: passed > 1,
            due,
        })
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

    const TICK: u32 = 84_000;

    fn number(told: Option<ToldTick>) -> Option<(u64, bool)> {
        told.map(|told| (told.number, told.missed))
    }

    #[test]
    fn ticks_are_counted_through_the_stopwatchs_wrap_whatever_the_jitter() {
        let mut ticks = Ticks::new(TICK);
        let mut now = u32::MAX - 5 * TICK;
        for count in 1..=20 {
            // Up to 59 µs late or early: a sixteenth of a tick is 62.
            let jitter = [0, 4_950, 50, 2_500][count as usize % 4];
            let told = ticks.at(now.wrapping_add(jitter));
            assert_eq!(number(told), Some((count, false)));
            now = now.wrapping_add(TICK);
        }
    }

    #[test]
    fn missed_ticks_are_counted_and_reported_and_a_spurious_call_has_no_number() {
        let mut ticks = Ticks::new(TICK);
        let mut at = |now| number(ticks.at(now));
        assert_eq!(at(1000), Some((1, false)));
        assert_eq!(at(1000 + TICK / 2), None);
        assert_eq!(at(1000 + TICK), Some((2, false)));
        // An erase of the flash: four seconds.
        assert_eq!(at(1000 + 4001 * TICK), Some((4002, true)));
        assert_eq!(at(1000 + 4002 * TICK - 500), Some((4003, false)));
        assert_eq!(at(1000 + 4002 * TICK + 600), None);
        assert_eq!(at(1000 + 4003 * TICK), Some((4004, false)));
    }

    /// A stream of the sensors stops and is started again 2.4 ticks later: two ticks are missing, and the ticks
    /// after it are due in their new phase.
    #[test]
    fn ticks_that_start_again_go_on_counting_in_their_new_phase() {
        let mut ticks = Ticks::new(TICK);
        ticks.start(500);
        assert!(!ticks.is_overdue(500 + TICK * 3 / 2));
        assert_eq!(number(ticks.at(500 + TICK)), Some((1, false)));
        let now = 500 + TICK + TICK * 12 / 5;
        assert!(ticks.is_overdue(now));
        ticks.start(now);
        assert!(!ticks.is_overdue(now));
        let told = ticks.at(now + TICK).unwrap();
        assert_eq!((told.number, told.missed, told.due), (4, false, now + TICK));
    }

    /// A first call that is late by 50 µs. WHEN a later call is on time, THEN ticks are due as early from then on,
    /// and how late a call is shows in its difference.
    #[test]
    fn a_late_call_shows_how_late_it_is_and_a_late_first_one_shifts_nothing_for_ever() {
        let mut ticks = Ticks::new(TICK);
        let late = |told: Option<ToldTick>, now: u32| now.wrapping_sub(told.unwrap().due);
        assert_eq!(late(ticks.at(4200), 4200), 0);
        assert_eq!(late(ticks.at(TICK), TICK), 0);
        let now = 2 * TICK + 25_200;
        assert_eq!(late(ticks.at(now), now), 25_200, "300 µs");
        // 0.7 ms late is late, and no missed tick.
        let now = 3 * TICK + 58_800;
        let told = ticks.at(now);
        assert_eq!((number(told), late(told, now)), (Some((4, false)), 58_800));
        assert_eq!(number(ticks.at(4 * TICK)), Some((5, false)));
    }
}
