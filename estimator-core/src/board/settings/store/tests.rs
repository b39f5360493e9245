use super::*;
use crate::board::cut_flash::{CutFlash, PowerCut};
use crate::board::ram_flash::SECTOR;
use crate::board::settings::compensation::Parameter;
use crate::physics::{effect::EffectId, rig::MOST_EFFECTS};
use embedded_storage::nor_flash::{ErrorType, NorFlash, ReadNorFlash};
extern crate std;
use std::vec::Vec;

fn store(flash: CutFlash) -> Store<CutFlash> {
    Store::new(flash, 0, SECTOR)
}

/// The settings of save number `count`.
fn settings(count: u16) -> Settings {
    let mut settings = Settings::default();
    settings.put(Key::ForceZeroCode, f32::from(count));
    settings.put(Key::ForcePerCode, -1e-3 / f32::from(count + 1));
    settings
}

fn good(count: u16) -> Loaded {
    Loaded::Good(settings(count))
}

/// Saves 0, 1, … until the power is cut or `saves` are done; gives the number that were done.
fn save_all(store: &mut Store<CutFlash>, saves: u16) -> u16 {
    (0..saves)
        .find(|count| store.save(&settings(*count)).is_err())
        .unwrap_or(saves)
}

#[test]
fn what_was_saved_last_is_loaded_through_many_changes_of_sector() {
    let mut store = store(CutFlash::new(0xff));
    assert_eq!(store.load(), Ok(Loaded::Nothing));
    for count in 0..50 {
        store.save(&settings(count)).unwrap();
        assert_eq!(store.load(), Ok(good(count)));
        // Four slots in a sector.
        assert_eq!(store.must_erase(), Ok(count % 4 == 3));
    }
}

#[test]
fn a_power_cut_at_every_step_leaves_the_old_settings_or_the_new() {
    const SAVES: u16 = 13;
    for fill in [0xff, 0x00, 0x5a] {
        let mut counting = CutFlash::new(fill);
        counting.steps_left = u64::MAX / 2;
        let mut whole = store(counting);
        assert_eq!(save_all(&mut whole, SAVES), SAVES);
        let steps = u64::MAX / 2 - whole.release().steps_left;
        assert!(steps > u64::from(SAVES) * SLOT as u64);
        for cut in 1..=steps {
            for torn in [0x00, 0xff, 0xa5] {
                let mut flash = CutFlash::new(fill);
                (flash.steps_left, flash.torn) = (cut, torn);
                let mut cut_store = store(flash);
                let done = save_all(&mut cut_store, SAVES);
                // Power returns.
                let mut flash = cut_store.release();
                flash.steps_left = u64::MAX;
                let mut store = store(flash);
                let found = store.load().unwrap();
                let old = done.checked_sub(1).map_or(Loaded::Nothing, good);
                assert!(
                    found == old || found == good(done),
                    "cut in step {cut} of {steps}, torn {torn:#x}: {found:?} after {done} saves"
                );
                // And the board can save again, at the latest at the second attempt: a slot that
                // looks blank and is not shows when it is read back.
                let again = store
                    .save(&settings(99))
                    .or_else(|_| store.save(&settings(99)));
                assert_eq!(again, Ok(()), "cut in step {cut}");
                assert_eq!(store.load(), Ok(good(99)));
            }
        }
    }
}

#[test]
fn a_second_cut_while_the_first_is_being_repaired_does_no_harm() {
    // Six saves, so that the last repair erases a sector.
    for first in (1..2 * u64::from(SECTOR)).step_by(37) {
        for second in (1..600).step_by(7) {
            let mut flash = CutFlash::new(0xff);
            (flash.steps_left, flash.torn) = (first, 0x3c);
            let mut store_1 = store(flash);
            let done = save_all(&mut store_1, 9);
            let mut flash = store_1.release();
            flash.steps_left = u64::MAX;
            let mut store_2 = store(flash);
            let before = store_2.load().unwrap();
            let mut flash = store_2.release();
            flash.steps_left = second;
            let mut store_3 = store(flash);
            let _ = store_3.save(&settings(77));
            let mut flash = store_3.release();
            flash.steps_left = u64::MAX;
            let found = store(flash).load().unwrap();
            assert!(
                found == before || found == good(77),
                "cuts {first}, {second}: {found:?} after {done} saves"
            );
        }
    }
}

#[test]
fn a_slot_that_cannot_be_written_is_an_error_and_the_old_settings_stay() {
    /// The second slot has a bit that is stuck low, unseen while it reads blank.
    struct Worn(CutFlash);
    impl ErrorType for Worn {
        type Error = PowerCut;
    }
    impl ReadNorFlash for Worn {
        const READ_SIZE: usize = 1;
        fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), PowerCut> {
            self.0.read(offset, bytes)
        }
        fn capacity(&self) -> usize {
            self.0.capacity()
        }
    }
    impl NorFlash for Worn {
        const WRITE_SIZE: usize = 1;
        const ERASE_SIZE: usize = SECTOR as usize;
        fn erase(&mut self, from: u32, to: u32) -> Result<(), PowerCut> {
            self.0.erase(from, to)
        }
        fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), PowerCut> {
            self.0.write(offset, bytes)?;
            if offset == SLOT as u32 {
                self.0.bytes[SLOT + 11] &= !1;
                self.0.bytes[SLOT + 20] ^= 0x40;
            }
            Ok(())
        }
    }
    let mut store = Store::new(Worn(CutFlash::new(0xff)), 0, SECTOR);
    store.save(&settings(1)).unwrap();
    assert_eq!(store.save(&settings(2)), Err(StoreError::Verify));
    assert_eq!(store.load(), Ok(good(1)));
    store.save(&settings(3)).unwrap();
    assert_eq!(store.load(), Ok(good(3)));
}

/// A record with other values than this firmware's.
fn record(layout: u8, pairs: &[(u8, f32)]) -> [u8; SLOT] {
    let mut record = [0; SLOT];
    record[..2].copy_from_slice(&MAGIC);
    record[2] = layout;
    record[3] = pairs.len() as u8;
    for (place, (id, value)) in record[HEAD..].chunks_exact_mut(5).zip(pairs) {
        place[0] = *id;
        place[1..].copy_from_slice(&value.to_le_bytes());
    }
    let sum = CRC.checksum(&record[..SLOT - 4]);
    record[SLOT - 4..].copy_from_slice(&sum.to_le_bytes());
    record
}

fn loaded(record: [u8; SLOT]) -> Loaded {
    let mut flash = CutFlash::new(0xff);
    flash.bytes[..SLOT].copy_from_slice(&record);
    store(flash).load().unwrap()
}

#[test]
fn a_record_of_an_older_firmware_keeps_its_values_and_gets_defaults_for_the_rest() {
    // GIVEN a record with two values of today and one that is no longer a setting
    let older = record(LAYOUT, &[(1, 2.5e-4), (200, 7.0), (2, 777.0)]);
    // WHEN today's firmware loads it
    let Loaded::Good(settings) = loaded(older) else {
        panic!("not loaded");
    };
    // THEN both are there, and all others have their defaults
    let mut expected = Settings::default();
    expected.put(Key::ForcePerCode, 2.5e-4);
    expected.put(Key::ForceZeroCode, 777.0);
    assert_eq!(settings, expected);
}

/// The second record of a flash as the firmware wrote it before effects could have numbers above 26.
#[rustfmt::skip]
const BEFORE_EFFECT_27: [u8; SLOT] = [
    0x50, 0xa1, 0x01, 0x28, 0x01, 0x00, 0x00, 0x00, 0x01, 0x6f, 0x12, 0x83, 0xb9, 0x02, 0x00, 0xe8,
    0x7d, 0x47, 0x03, 0x00, 0x00, 0x80, 0x41, 0x04, 0x00, 0xf0, 0x7e, 0x45, 0x05, 0x00, 0x00, 0x80,
    0x3f, 0x06, 0x00, 0x00, 0x80, 0x3f, 0x07, 0xcd, 0xcc, 0x4c, 0x3c, 0x10, 0xbd, 0x37, 0x06, 0x33,
    0x11, 0x00, 0x00, 0xa0, 0x40, 0x12, 0x00, 0x00, 0xa0, 0x40, 0x13, 0x00, 0x00, 0x80, 0x3f, 0x20,
    0x00, 0x00, 0x00, 0x40, 0x21, 0x6f, 0x12, 0x03, 0x3b, 0x22, 0x00, 0x00, 0x80, 0x3f, 0x23, 0x00,
    0x00, 0x40, 0x41, 0x24, 0x00, 0x00, 0xc0, 0x40, 0x25, 0x00, 0x00, 0x40, 0x40, 0x26, 0xcd, 0xcc,
    0x4c, 0x3e, 0x30, 0x00, 0x00, 0x80, 0x40, 0x40, 0x00, 0x00, 0xc0, 0x3e, 0x42, 0x6f, 0x12, 0x03,
    0x3a, 0x44, 0x00, 0x00, 0x00, 0x3e, 0x45, 0x00, 0x00, 0x80, 0x3e, 0x46, 0x6f, 0x12, 0x03, 0x3b,
    0x50, 0x00, 0x00, 0x60, 0x3e, 0x68, 0x00, 0x80, 0x3b, 0x46, 0x69, 0x00, 0x00, 0x20, 0x42, 0x74,
    0xa6, 0x9b, 0x44, 0xbb, 0x7c, 0xbd, 0x37, 0x06, 0x36, 0x7d, 0x6f, 0x12, 0x83, 0x3a, 0x7e, 0x00,
    0x00, 0xa0, 0xbf, 0x80, 0x00, 0x00, 0x20, 0x41, 0x90, 0x00, 0x00, 0x00, 0x41, 0x91, 0x00, 0x00,
    0x20, 0x41, 0x92, 0x00, 0x00, 0x00, 0x00, 0x93, 0x00, 0x00, 0xc0, 0x3f, 0x94, 0x00, 0x40, 0x9c,
    0x45, 0x95, 0xcd, 0xcc, 0xcc, 0x3d, 0x96, 0xcd, 0xcc, 0x4c, 0x3d, 0x97, 0x00, 0x00, 0x00, 0x3f,
    0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
    0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
    0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x10, 0xa4, 0xdc, 0xe5,
];

#[test]
fn a_flash_written_before_there_was_room_for_more_effects_loads_with_the_same_values() {
    // GIVEN the record of settings with six effects of the rig, and the values that were set
    let set = [
        (1, "force.n_per_code", -0.00025),
        (2, "force.zero_code", 65000.0),
        (6, "force.calibrated", 1.0),
        (7, "force.residual_n", 0.0125),
        (16, "position.m_per_code", 3.125e-8),
        (19, "position.calibrated", 1.0),
        (32, "estimator.method", 2.0),
        (33, "estimator.depth_m", 0.002),
        (35, "estimator.half_width", 12.0),
        (48, "telemetry.every", 4.0),
        (64, "compensation.coulomb_friction.force", 0.375),
        (66, "compensation.coulomb_friction.transition_speed", 0.0005),
        (68, "compensation.stribeck_friction.kinetic_force", 0.125),
        (69, "compensation.stribeck_friction.static_force", 0.25),
        (70, "compensation.stribeck_friction.speed", 0.002),
        (80, "compensation.tool_inertia.mass", 0.21875),
        (104, "compensation.series_compliance.stiffness", 12000.0),
        (105, "compensation.series_compliance.hardening_force", 40.0),
        (116, "compensation.time_delay.delay", -0.003),
        (124, "compensation.encoder_periodic_error.amplitude", 2e-6),
        (125, "compensation.encoder_periodic_error.pitch", 0.001),
        (126, "compensation.encoder_periodic_error.phase", -1.25),
        (128, "reflection.every", 10.0),
        (144, "render.force_n", 8.0),
        (147, "render.device_ns_per_m", 1.5),
        (151, "render.shaping", 0.5),
    ];
    let mut expected = Settings::default();
    for (id, name, value) in set {
        let key = Key::from_id(id).unwrap();
        assert_eq!(key.info().name, name);
        expected.put(key, value);
    }
    // WHEN this firmware loads it
    let found = loaded(BEFORE_EFFECT_27);
    // THEN every value is as it was, and the next save keeps them all
    assert_eq!(found, Loaded::Good(expected));
    assert_eq!(loaded(encode(&expected, 2)), Loaded::Good(expected));
}

#[test]
fn a_setting_of_an_effect_that_this_firmware_does_not_know_is_left_out() {
    let newer = record(LAYOUT, &[(2, 777.0), (255, 0.5), (128, 3.0)]);
    assert_eq!(Key::from_id(255), None);
    let mut expected = Settings::default();
    expected.put(Key::ForceZeroCode, 777.0);
    expected.put(Key::ReflectionEvery, 3.0);
    assert_eq!(loaded(newer), Loaded::Good(expected));
}

#[test]
fn a_record_of_a_newer_layout_is_refused_by_its_number() {
    let newer = record(LAYOUT + 1, &[(1, 2.5e-4)]);
    assert_eq!(loaded(newer), Loaded::Newer(LAYOUT + 1));
}

#[test]
fn a_value_out_of_bounds_is_named() {
    let bad = record(LAYOUT, &[(Key::EstimatorHalfWidth.id(), 77.0)]);
    let Loaded::Bad(invalid) = loaded(bad) else {
        panic!("accepted");
    };
    assert_eq!(
        (invalid.key, invalid.value),
        (Key::EstimatorHalfWidth, 77.0)
    );
}

#[test]
fn the_record_of_a_firmware_without_compensation_loads_and_nothing_is_taken_off() {
    // GIVEN all settings that there were before the section `compensation`
    let newer = [Key::ForceBrokenBeyond, Key::PositionReachM];
    let before = Key::ALL.into_iter().filter(|key| key.id() < 64);
    let before = before.filter(|key| !newer.contains(key));
    let values: Vec<(u8, f32)> = before.map(|key| (key.id(), settings(5).get(key))).collect();
    assert_eq!(values.len(), 19);
    // WHEN today's firmware loads their record
    let Loaded::Good(found) = loaded(record(1, &values)) else {
        panic!("not loaded");
    };
    // THEN they are as they were, and samples stay as they are read
    let mut expected = settings(5);
    for key in newer {
        expected.put(key, key.info().default);
    }
    assert_eq!(found, expected);
    assert_eq!(found.setup().unwrap().compensation, None);
}

#[test]
fn every_value_of_every_setting_survives() {
    let mut settings = Settings::default();
    for key in Key::ALL {
        let (super::super::Bounds::Within(_, high)
        | super::super::Bounds::Signed(_, high)
        | super::super::Bounds::Whole(_, high)) = key.info().bounds;
        settings.put(key, high);
    }
    // Three pairs must be in order.
    settings.put(Key::ForceLowestCode, -5.0);
    settings.put(Key::RenderZero, 0.5);
    // No more than eight effects at once.
    let effects: Vec<EffectId> = Parameter::effects().collect();
    assert!(effects.contains(&EffectId::TimeDelay));
    for at_once in effects.chunks(MOST_EFFECTS) {
        let mut settings = settings;
        for parameter in Parameter::ALL {
            if !at_once.contains(&parameter.effect()) {
                settings.put(Key::Compensation(parameter), 0.0);
            }
        }
        // As late as a compensation can be.
        if at_once.contains(&EffectId::TimeDelay) {
            settings.put(Key::from_id(116).unwrap(), 0.064);
        }
        let mut store = store(CutFlash::new(0xff));
        store.save(&settings).unwrap();
        assert_eq!(store.load(), Ok(Loaded::Good(settings)));
    }
}
