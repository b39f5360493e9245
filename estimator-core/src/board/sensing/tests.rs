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
