//! From the codes of the converters to a [`Sample`]: scale, zero, and the faults that the codes show.
//! It is the same for every set of sensors; a board only reads codes.

mod outlier;
mod standstill;

pub use outlier::LATE;
pub use standstill::Standstill;

use crate::estimate::{fault::Fault, fault::Faults, sample::Sample};
use outlier::Recent;
use standstill::{Moving, micros};

/// The codes of the position in one count of the encoder: the sum of 32 latches, or a count times 32.
pub const CODES_PER_COUNT: i32 = 32;

/// One instant as the hardware gave it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Codes {
    /// Time since start (µs).
    pub time_us: u64,
    /// The sum of all conversions of the load cell in the instant.
    pub force: i32,
    /// The lowest single conversion of the instant.
    pub force_low: i32,
    /// The highest single conversion of the instant.
    pub force_high: i32,
    /// The code of the encoder, without the wraps of its counter.
    pub position: i32,
    /// The faults that the reader of the hardware has seen.
    pub faults: Faults,
}

/// Scale and limits, ready to use. Made by [`crate::board::settings::Settings::setup`], or of the limits
/// that a host reads off a log.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conversion {
    n_per_code: f32,
    zero_code: f32,
    m_per_code: f32,
    limits: Limits,
    /// Faults that last as long as the settings do.
    standing: Faults,
}

/// What the readings of sensors in order stay within.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// A single conversion below this is saturated.
    pub lowest: f32,
    /// A single conversion above this is saturated.
    pub highest: f32,
    /// A single conversion that is so many codes beyond these is none: a cable is off; 0: never.
    pub broken_beyond: f32,
    /// A position further from zero than this is none (m); 0: never.
    pub reach_m: f32,
    /// The same code for this long is a stuck converter; 0: never.
    pub stuck_us: u64,
    /// The same code for this long, while the position has gone `stuck_way_m`, is one as well; 0: never.
    pub stuck_moving_us: u64,
    /// See `stuck_moving_us` (m).
    pub stuck_way_m: f32,
    /// The same code for this long, and then one that is off by more than `spike_n`, was one as well; 0: never.
    pub hung_us: u64,
    /// A force that stands out of its neighbours by more is a spike (N); 0: never.
    pub spike_n: f32,
    /// A faster motion between two samples is a jump; 0: never.
    pub fastest_m_per_us: f32,
    /// A position that stands out of its neighbours by more, or a change that does, is a jump (m); 0: never.
    pub jump_m: f32,
    /// A force that rises by this much over a standing position is a stuck encoder; 0: never.
    pub stuck_n: f32,
    /// A position that stops in the midst of a motion and then jumps is one as well.
    pub standstill: Standstill,
}

impl Limits {
    /// Limits that everything stays within.
    pub const NONE: Limits = Limits {
        lowest: f32::NEG_INFINITY,
        highest: f32::INFINITY,
        broken_beyond: 0.0,
        reach_m: 0.0,
        stuck_us: 0,
        stuck_moving_us: 0,
        stuck_way_m: 0.0,
        hung_us: 0,
        spike_n: 0.0,
        fastest_m_per_us: 0.0,
        jump_m: 0.0,
        stuck_n: 0.0,
        standstill: Standstill {
            after_us: 0,
            way_m: 0.0,
        },
    };
}

/// The state of [`Conversion::sample`] from one instant to the next.
#[derive(Clone, Copy, Debug, Default)]
pub struct Watch {
    last: Option<Last>,
    force: Recent,
    position: Recent,
    moving: Moving,
}

#[derive(Clone, Copy, Debug)]
struct Last {
    time_us: u64,
    position_m: f32,
    force: i32,
    /// The time since which the force has had this code (µs), and where the position was then.
    force_since_us: u64,
    force_since_m: f32,
    position: i32,
    /// The least force since the position has had this code (N).
    least_n: f32,
}

impl Conversion {
    /// A conversion with a scale (N and m per code), the code of 0 N, and limits.
    pub const fn new(n_per_code: f32, zero_code: f32, m_per_code: f32, limits: Limits) -> Self {
        Conversion {
            n_per_code,
            zero_code,
            m_per_code,
            limits,
            standing: Faults::NONE,
        }
    }

    /// The same conversion with faults that last, such as settings that could not be read.
    pub fn with_standing(self, faults: Faults) -> Self {
        Conversion {
            standing: self.standing | faults,
            ..self
        }
    }

    /// The sample that the estimator sees.
    ///
    /// The zero is taken off before the scale is applied, in f32: exact for codes up to 2²⁴.
    pub fn sample(&self, watch: &mut Watch, codes: &Codes) -> Sample<f32> {
        let force_n = (codes.force as f32 - self.zero_code) * self.n_per_code;
        let position_m = codes.position as f32 * self.m_per_code;
        let broken = self.broken(codes, position_m);
        let faults = codes.faults | self.standing | self.saturation(codes) | broken;
        let (last, seen) = self.watched(watch.last, codes, force_n, position_m);
        watch.last = Some(last);
        let seen = seen | self.outliers(watch, codes.time_us, force_n, position_m);
        Sample {
            time_us: codes.time_us,
            position_m,
            force_n,
            faults: faults | seen,
        }
    }

    /// Returns whether the encoder's counter may have gone round unseen since the last instant: instants are missing
    /// before that at `time_us` (µs), of which one comes every `period_us` (µs), and the fastest motion would have gone
    /// half of the counter's range of `counts` in that time. A range of 0 never ends.
    pub fn may_have_gone_round(
        &self,
        watch: &Watch,
        time_us: u64,
        period_us: u64,
        counts: u32,
    ) -> bool {
        let Some(last) = watch.last.as_ref().filter(|_| counts > 0) else {
            return false;
        };
        let elapsed_us = time_us.saturating_sub(last.time_us);
        // From one instant to the next the count is followed, and a jump of it shows.
        if elapsed_us < 2 * period_us {
            return false;
        }
        let half_m = (counts / 2) as f32 * CODES_PER_COUNT as f32 * self.m_per_code.abs();
        self.limits.fastest_m_per_us * micros(elapsed_us) > half_m
    }

    fn saturation(&self, codes: &Codes) -> Faults {
        let saturated = (codes.force_low as f32) < self.limits.lowest
            || codes.force_high as f32 > self.limits.highest;
        only(saturated, Fault::ForceSaturated)
    }

    /// A cable that is off: codes that no force gives, or a position where the rig cannot be.
    fn broken(&self, codes: &Codes, position_m: f32) -> Faults {
        let limits = &self.limits;
        let below = limits.lowest - codes.force_low as f32;
        let above = codes.force_high as f32 - limits.highest;
        let beyond = limits.broken_beyond;
        let force = beyond > 0.0 && below.max(above) >= beyond;
        let position = limits.reach_m > 0.0 && position_m.abs() > limits.reach_m;
        only(force, Fault::ForceUnusable) | only(position, Fault::PositionUnusable)
    }

    /// A spike of the force, a jump of the position and an encoder that was stuck, [`LATE`] samples late.
    fn outliers(&self, watch: &mut Watch, time_us: u64, force_n: f32, position_m: f32) -> Faults {
        let limits = &self.limits;
        if limits.spike_n == 0.0 && limits.jump_m == 0.0 {
            return Faults::NONE;
        }
        let full = watch.force.update(force_n) & watch.position.update(position_m);
        let moving = &mut watch.moving;
        let since_standstill = moving.update(&limits.standstill, time_us, position_m);
        let spike = full && limits.spike_n > 0.0 && watch.force.spike(limits.spike_n);
        let watched = full && limits.jump_m > 0.0;
        let jump = watched && watch.position.spike(limits.jump_m);
        let step = watched && watch.position.step(limits.jump_m);
        let stuck = step && usize::from(since_standstill) == LATE + 1;
        only(spike, Fault::ForceUnusable)
            | only(jump || step, Fault::PositionJump)
            | only(stuck, Fault::PositionStuck)
    }

    fn watched(
        &self,
        last: Option<Last>,
        codes: &Codes,
        force_n: f32,
        position_m: f32,
    ) -> (Last, Faults) {
        let first = Last {
            time_us: codes.time_us,
            position_m,
            force: codes.force,
            force_since_us: codes.time_us,
            force_since_m: position_m,
            position: codes.position,
            least_n: force_n,
        };
        let Some(last) = last else {
            return (first, Faults::NONE);
        };
        let elapsed_us = codes.time_us.saturating_sub(last.time_us);
        let way_m = (position_m - last.position_m).abs();
        let fastest = self.limits.fastest_m_per_us;
        let jumped = fastest > 0.0 && way_m > fastest * micros(elapsed_us);
        let (force_since_us, force_since_m) = match codes.force == last.force {
            true => (last.force_since_us, last.force_since_m),
            false => (codes.time_us, position_m),
        };
        let now = Last {
            force_since_us,
            force_since_m,
            least_n: match codes.position == last.position {
                true => force_n.min(last.least_n),
                false => force_n,
            },
            ..first
        };
        // A force that falls over a standing probe is relaxation; one that rises is not.
        let stuck_n = self.limits.stuck_n;
        let position_stuck = stuck_n > 0.0 && force_n - now.least_n > stuck_n;
        // At the end of its range a converter repeats its code without hanging.
        let force_stuck = (self.force_stuck(&now) || self.force_hung(&last, &now))
            && self.saturation(codes) == Faults::NONE;
        let faults = only(jumped, Fault::PositionJump)
            | only(force_stuck, Fault::ForceStuck)
            | only(position_stuck, Fault::PositionStuck);
        (now, faults)
    }

    fn force_stuck(&self, now: &Last) -> bool {
        let limits = &self.limits;
        let still_us = now.time_us.saturating_sub(now.force_since_us);
        let way_m = (now.position_m - now.force_since_m).abs();
        let stuck = limits.stuck_us > 0 && still_us >= limits.stuck_us;
        let moving = limits.stuck_moving_us > 0 && still_us >= limits.stuck_moving_us;
        stuck || (moving && way_m >= limits.stuck_way_m)
    }

    /// Whether the force goes on after it hung: noise repeats a code as often, but does not leap then.
    fn force_hung(&self, last: &Last, now: &Last) -> bool {
        let limits = &self.limits;
        let held_us = now.time_us.saturating_sub(last.force_since_us);
        let leap_n = (now.force as f32 - last.force as f32).abs() * self.n_per_code.abs();
        limits.hung_us > 0 && held_us >= limits.hung_us && leap_n > limits.spike_n
    }
}

fn only(is: bool, fault: Fault) -> Faults {
    match is {
        true => Faults::NONE.with(fault),
        false => Faults::NONE,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::board::settings::{Key, Settings};

    fn conversion(change: impl Fn(&mut Settings)) -> Conversion {
        let mut settings = Settings::default();
        settings.put(Key::ForceCalibrated, 1.0);
        settings.put(Key::PositionCalibrated, 1.0);
        change(&mut settings);
        settings.setup().unwrap().conversion
    }

    /// Instant number `i`: codes that move, well inside their range.
    fn codes(i: i32) -> Codes {
        Codes {
            time_us: (i as u64 + 1) * 1000,
            force: 65_536 + i % 7,
            force_low: 2040,
            force_high: 2060,
            position: 32 * (i % 5),
            faults: Faults::NONE,
        }
    }

    #[test]
    fn codes_become_newtons_and_metres_of_either_sign() {
        let conversion = conversion(|settings| {
            settings.put(Key::ForcePerCode, -0.001);
            settings.put(Key::ForceZeroCode, 65_000.0);
            settings.put(Key::PositionPerCode, 1e-6);
        });
        let sample = conversion.sample(
            &mut Watch::default(),
            &Codes {
                force: 64_000,
                position: -2500,
                ..codes(3)
            },
        );
        assert_eq!(sample.force_n, 1.0);
        assert_eq!(sample.position_m, -2500.0 * 1e-6);
        assert_eq!(sample.time_us, 4000);
        assert_eq!(sample.faults, Faults::NONE);
    }

    /// Conditions × fault: the first instant at which it shows, and that it ends.
    #[test]
    fn every_fault_of_a_sensor_shows_when_its_condition_holds_and_only_then() {
        type Bend = fn(i32) -> Codes;
        let table: [(Fault, Bend, core::ops::Range<i32>); 5] = [
            (
                Fault::ForceSaturated,
                |i| Codes {
                    force_high: if (200..300).contains(&i) { 4080 } else { 2060 },
                    ..codes(i)
                },
                200..300,
            ),
            (
                Fault::ForceSaturated,
                |i| Codes {
                    force_low: if (200..300).contains(&i) { 15 } else { 2040 },
                    ..codes(i)
                },
                200..300,
            ),
            (
                Fault::ForceStuck,
                |i| Codes {
                    // The code of instant 200, for 1.2 s: shows after 1 s.
                    force: if (200..1400).contains(&i) {
                        65_540
                    } else {
                        65_536 + i % 3
                    },
                    ..codes(i)
                },
                1200..1400,
            ),
            (
                Fault::PositionJump,
                |i| Codes {
                    // 6 mm at once, and back: 6 m/s against the 5 that are allowed.
                    position: if (200..300).contains(&i) {
                        32 * 6000
                    } else {
                        0
                    },
                    ..codes(i)
                },
                200..201,
            ),
            (
                Fault::PositionStuck,
                |i| Codes {
                    // Force rises by 0.1 N an instant over a standing position: 5 N after 51.
                    force: if (200..300).contains(&i) {
                        65_536 + (i - 199) * 131
                    } else {
                        codes(i).force
                    },
                    position: if (190..300).contains(&i) {
                        64
                    } else {
                        32 * (i % 5)
                    },
                    ..codes(i)
                },
                250..300,
            ),
        ];
        for (fault, bend, expected) in table {
            let conversion = conversion(|_| {});
            let mut watch = Watch::default();
            for i in 0..1600 {
                let faults = conversion.sample(&mut watch, &bend(i)).faults;
                let back = fault == Fault::PositionJump && i == 300;
                let shown = expected.contains(&i) || back;
                assert_eq!(faults.has(fault), shown, "{fault:?} at {i}");
                assert!(faults.iter().all(|one| one == fault), "{faults:?} at {i}");
            }
        }
    }

    /// GIVEN a live zero, whose tenth of the range a force never leaves, and a rig of 20 mm. WHEN a cable comes off,
    /// THEN its sensor is not believed at that instant, and what is only saturated stays a force.
    #[test]
    fn a_cable_that_is_off_gives_no_number_and_a_saturated_force_is_one() {
        let conversion = conversion(|settings| {
            settings.put(Key::ForceLowestCode, 410.0);
            settings.put(Key::ForceHighestCode, 3686.0);
            settings.put(Key::ForceBrokenBeyond, 205.0);
            settings.put(Key::PositionReachM, 0.02);
        });
        let saturated = Faults::NONE.with(Fault::ForceSaturated);
        let broken = saturated.with(Fault::ForceUnusable);
        let away = Faults::NONE
            .with(Fault::PositionUnusable)
            .with(Fault::PositionJump);
        for (low, high, counts, expected) in [
            (410, 3686, 0, Faults::NONE),
            (206, 3686, 0, saturated),
            (205, 3686, 0, broken),
            (410, 3890, 0, saturated),
            (410, 3891, 0, broken),
            (410, 3686, 19_999, Faults::NONE.with(Fault::PositionJump)),
            (410, 3686, 20_001, away),
            (410, 3686, -20_001, away),
        ] {
            let mut watch = Watch::default();
            let read = Codes {
                force_low: low,
                force_high: high,
                position: 32 * counts,
                ..codes(1)
            };
            conversion.sample(
                &mut watch,
                &Codes {
                    position: 0,
                    ..codes(0)
                },
            );
            let faults = conversion.sample(&mut watch, &read).faults;
            assert_eq!(faults, expected, "{low} {high} {counts}");
        }
    }

    /// GIVEN an encoder of 1 µm a count, 65 536 counts, and at most 5 m/s: half of the range takes 6.55 ms. WHEN
    /// instants are missing for longer, THEN the position may be another one, and nobody could tell; not before.
    #[test]
    fn a_counter_may_have_gone_round_only_where_the_fastest_motion_takes_it_there_unseen() {
        let within = |fastest: f32, per_code: f32, elapsed_ms: i32, counts: u32| {
            let conversion = conversion(|settings| {
                settings.put(Key::PositionFastestMps, fastest);
                settings.put(Key::PositionPerCode, per_code);
            });
            let mut watch = Watch::default();
            let at = |ms: i32| Codes {
                time_us: 1000 * ms as u64,
                ..codes(ms)
            };
            assert!(!conversion.may_have_gone_round(&watch, 9_000_000, 1000, counts));
            conversion.sample(&mut watch, &at(10));
            let time_us = at(10 + elapsed_ms).time_us;
            !conversion.may_have_gone_round(&watch, time_us, 1000, counts)
        };
        let micron = 1e-6 / 32.0;
        for (fastest, per_code, elapsed_ms, counts, expected) in [
            (5.0, micron, 6, 65_536, true),
            (5.0, micron, 7, 65_536, false),
            (5.0, -micron, 7, 65_536, false),
            (5.0, micron, 4000, 65_536, false),
            // A slower rig: half of the range takes 33 ms.
            (1.0, micron, 32, 65_536, true),
            (1.0, micron, 33, 65_536, false),
            // Half a turn of 16 384 counts takes 1.6 ms, but from one instant to the next a jump shows.
            (5.0, micron, 1, 16_384, true),
            (5.0, micron, 2, 16_384, false),
            // No counter that begins again, and no watch on the speed.
            (5.0, micron, 4000, 0, true),
            (0.0, micron, 4000, 65_536, true),
        ] {
            let shown = within(fastest, per_code, elapsed_ms, counts);
            assert_eq!(
                shown, expected,
                "{fastest} {per_code} {elapsed_ms} {counts}"
            );
        }
    }

    #[test]
    fn a_force_that_relaxes_over_a_standing_probe_is_no_fault() {
        let conversion = conversion(|_| {});
        let mut watch = Watch::default();
        for i in 0..20_000 {
            let relaxed = Codes {
                force: 65_536 + 26_000 - i,
                position: 32_000,
                ..codes(i)
            };
            assert_eq!(conversion.sample(&mut watch, &relaxed).faults, Faults::NONE);
        }
    }

    #[test]
    fn each_watch_can_be_turned_off() {
        let conversion = conversion(|settings| {
            settings.put(Key::ForceStuckS, 0.0);
            settings.put(Key::PositionFastestMps, 0.0);
            settings.put(Key::PositionStuckN, 0.0);
        });
        let mut watch = Watch::default();
        for i in 0..5000 {
            let stuck = Codes {
                force: 65_536,
                position: if i == 2000 { 10_000_000 } else { 0 },
                ..codes(i)
            };
            assert_eq!(conversion.sample(&mut watch, &stuck).faults, Faults::NONE);
        }
    }

    #[test]
    fn a_board_that_is_not_calibrated_says_so_with_every_sample() {
        for key in [Key::ForceCalibrated, Key::PositionCalibrated] {
            let conversion = conversion(|settings| settings.put(key, 0.0));
            let sample = conversion.sample(&mut Watch::default(), &codes(1));
            assert_eq!(sample.faults, Faults::NONE.with(Fault::NotCalibrated));
        }
    }

    /// A press and a retreat at 5 mm/s on 2 N/mm, with 20 mN of noise in 5 mN codes.
    fn pressed(i: i32) -> Codes {
        let way = 500 - (i - 500).abs();
        let noise = (i * 7919 % 17 - 8) / 2;
        Codes {
            force: 2 * way + noise,
            force_low: 0,
            force_high: 0,
            position: 5 * way,
            ..codes(i)
        }
    }

    fn limits() -> Limits {
        Limits {
            stuck_moving_us: 9_000,
            stuck_way_m: 8e-6,
            spike_n: 0.15,
            jump_m: 6e-6,
            standstill: Standstill {
                after_us: 16_000,
                way_m: 8e-6,
            },
            ..Limits::NONE
        }
    }

    #[test]
    fn spikes_jumps_and_stops_within_a_motion_show_and_the_motion_itself_does_not() {
        type Bend = fn(i32, Codes) -> Codes;
        let table: [(&str, Option<Fault>, Bend, core::ops::Range<i32>); 6] = [
            ("a press", None, |_, read| read, 0..0),
            (
                "a spike of 0.2 N",
                Some(Fault::ForceUnusable),
                |i, read| Codes {
                    force: read.force + if i == 300 { 40 } else { 0 },
                    ..read
                },
                302..303,
            ),
            (
                "twenty counts lost",
                Some(Fault::PositionJump),
                |i, read| Codes {
                    position: read.position + if i >= 300 { 20 } else { 0 },
                    ..read
                },
                302..303,
            ),
            (
                "a position off by 20 counts once",
                Some(Fault::PositionJump),
                |i, read| Codes {
                    position: read.position + if i == 300 { 20 } else { 0 },
                    ..read
                },
                302..303,
            ),
            (
                "a converter that hangs",
                Some(Fault::ForceStuck),
                |i, read| match (300..340).contains(&i) {
                    true => Codes {
                        force: pressed(299).force,
                        ..read
                    },
                    false => read,
                },
                308..340,
            ),
            (
                "an encoder that hangs during the retreat",
                Some(Fault::PositionStuck),
                |i, read| match (700..760).contains(&i) {
                    true => Codes {
                        position: pressed(699).position,
                        ..read
                    },
                    false => read,
                },
                762..763,
            ),
        ];
        let conversion = Conversion::new(0.005, 0.0, 1e-6, limits());
        for (what, fault, bend, expected) in table {
            let mut watch = Watch::default();
            for i in 0..1000 {
                let faults = conversion.sample(&mut watch, &bend(i, pressed(i))).faults;
                let shown = fault.is_some_and(|fault| faults.has(fault));
                assert!(faults == Faults::NONE || shown, "{what}: {faults:?} at {i}");
                let tolerated = (expected.start - 2..expected.start + 8).contains(&i);
                assert!(
                    shown == expected.contains(&i) || tolerated,
                    "{what} at {i}: {shown}"
                );
            }
        }
    }

    #[test]
    fn a_converter_that_hung_too_shortly_to_be_stuck_shows_by_its_leap() {
        let hung_us = 4_500;
        let conversion = Conversion::new(
            0.005,
            0.0,
            1e-6,
            Limits {
                hung_us,
                ..limits()
            },
        );
        // GIVEN presses of which the converter misses some readings, at 10 mN and at 345 mN a sample
        let shown_at = |held: core::ops::Range<i32>, steep: i32| {
            let mut watch = Watch::default();
            let mut shown = heapless::Vec::<i32, 8>::new();
            for i in 0..480 {
                let at = if held.contains(&i) { held.start - 1 } else { i };
                let force = pressed(at).force + steep * (at - 300).max(0);
                let read = Codes {
                    force,
                    ..pressed(i)
                };
                let faults = conversion.sample(&mut watch, &read).faults;
                if faults.has(Fault::ForceStuck) {
                    shown.push(i).unwrap();
                }
            }
            shown
        };
        // THEN five show with the next one where it leaps, three do not, and nothing does where it goes on as before.
        assert_eq!(shown_at(310..315, 69), [315]);
        assert!(shown_at(310..313, 69).is_empty());
        assert!(shown_at(310..315, 0).is_empty());
    }

    #[test]
    fn a_touch_a_stop_and_a_force_that_relaxes_after_it_are_no_faults() {
        let conversion = Conversion::new(0.005, 0.0, 1e-6, limits());
        let mut watch = Watch::default();
        for i in 0..1000 {
            // 30 mm/s through air, 345 N/s from sample 300 on, a stop at 350 from which the force falls.
            let way = i.min(350);
            let relaxed = 10 * (i - 350).clamp(0, 60);
            let read = Codes {
                force: 69 * (way - 300).max(0) - relaxed + i % 3,
                position: 30 * way,
                ..codes(i)
            };
            let faults = conversion.sample(&mut watch, &read).faults;
            assert_eq!(faults, Faults::NONE, "{i}");
        }
    }
}
