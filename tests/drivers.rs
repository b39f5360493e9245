//! The drivers of the second set of sensors against the sequences of their data sheets.

// The firmware is a workspace of its own for another target; its drivers know only embedded-hal.
#[path = "../firmware/src/driver/mod.rs"]
#[allow(missing_docs, unreachable_pub)]
mod driver;

use driver::as5047p::{Diagnosis, Error, Reported, angle, diagnose};
use driver::pair::Pair;
use driver::{ads1220, as5047p};
use embedded_hal::spi::{ErrorKind, ErrorType, Operation, SpiDevice};
use embedded_hal_mock::eh1::spi::{Mock, Transaction};
use estimator_core::board::sensing::{CODES_PER_COUNT, Codes, Watch};
use estimator_core::board::settings::{Key, Settings};
use estimator_core::{Fault, Faults};

/// A frame of 16 bits out and one in, with the select line low around it.
fn frame(out: u16, back: u16) -> [Transaction<u8>; 3] {
    let (out, back) = (out.to_be_bytes().to_vec(), back.to_be_bytes().to_vec());
    [
        Transaction::transaction_start(),
        Transaction::transfer_in_place(out, back),
        Transaction::transaction_end(),
    ]
}

/// Runs a call against frames; every one of them must be used.
fn with<T>(frames: &[(u16, u16)], call: impl FnOnce(&mut Mock<u8>) -> T) -> T {
    let expected: Vec<_> = frames
        .iter()
        .flat_map(|(out, back)| frame(*out, *back))
        .collect();
    let mut spi = Mock::new(&expected);
    let result = call(&mut spi);
    spi.done();
    result
}

/// Even parity, as the data sheet counts it, written down by hand for the frames below.
const ANGLE: u16 = 0xffff;
const NOP: u16 = 0xc000;
const ERRFL: u16 = 0x4001;
const DIAAGC: u16 = 0xfffc;

#[test]
fn the_angle_is_asked_for_and_fetched_with_the_next_frame() {
    // 0x1234 has five ones: its parity bit is set.
    let read = with(&[(ANGLE, 0x0000), (NOP, 0x9234)], angle);
    assert_eq!(read, Ok(0x1234));
    // 0x3fff has fourteen.
    let read = with(&[(ANGLE, 0x0000), (NOP, 0x3fff)], angle);
    assert_eq!(read, Ok(0x3fff));
}

#[test]
fn an_answer_of_odd_parity_is_refused_whatever_bit_is_wrong() {
    for bit in 0..16 {
        let bad = 0x9234 ^ (1 << bit);
        let read = with(&[(ANGLE, 0), (NOP, bad)], angle);
        assert_eq!(read, Err(Error::Parity(bad)), "bit {bit}");
    }
}

#[test]
fn an_error_that_the_sensor_flags_is_read_and_so_cleared() {
    for (bits, reported) in [
        (
            0b001,
            Reported {
                framing: true,
                ..Reported::default()
            },
        ),
        (
            0b010,
            Reported {
                command: true,
                ..Reported::default()
            },
        ),
        (
            0b100,
            Reported {
                parity: true,
                ..Reported::default()
            },
        ),
    ] {
        // The flag (0x4000) with data 0 has odd parity without bit 15; with one more bit, even.
        let frames = [(ANGLE, 0), (NOP, 0xc000), (ERRFL, 0), (NOP, 0x4000 | bits)];
        assert_eq!(with(&frames, angle), Err(Error::Reported(reported)));
    }
    // A line that is always high, as without a sensor: even parity, and the flag set.
    let frames = [
        (ANGLE, 0xffff),
        (NOP, 0xffff),
        (ERRFL, 0xffff),
        (NOP, 0xffff),
    ];
    let all = Reported {
        framing: true,
        command: true,
        parity: true,
    };
    assert_eq!(with(&frames, angle), Err(Error::Reported(all)));
}

#[test]
fn the_magnet_is_diagnosed_bit_by_bit() {
    let of = |bits: u16| {
        let parity = (bits.count_ones() as u16 % 2) << 15;
        with(&[(DIAAGC, 0), (NOP, bits | parity)], diagnose).unwrap()
    };
    let good = Diagnosis {
        gain: 0x80,
        ready: true,
        overflow: false,
        too_strong: false,
        too_weak: false,
    };
    assert_eq!(of(0x0180), good);
    assert_eq!(
        of(0x0380),
        Diagnosis {
            overflow: true,
            ..good
        }
    );
    assert_eq!(
        of(0x0500),
        Diagnosis {
            gain: 0,
            too_strong: true,
            ..good
        }
    );
    assert_eq!(
        of(0x09ff),
        Diagnosis {
            gain: 255,
            too_weak: true,
            ..good
        }
    );
}

/// A bus that fails.
struct Broken;

impl ErrorType for Broken {
    type Error = ErrorKind;
}

impl SpiDevice for Broken {
    fn transaction(&mut self, _: &mut [Operation<'_, u8>]) -> Result<(), ErrorKind> {
        Err(ErrorKind::Overrun)
    }
}

#[test]
fn a_bus_that_fails_is_no_reading() {
    let failed = ErrorKind::Overrun;
    assert_eq!(as5047p::angle(&mut Broken), Err(Error::Spi(failed)));
    let read = ads1220::fetch_and_start(&mut Broken);
    assert_eq!(read, Err(ads1220::Error::Spi(failed)));
    let mut pair = Pair::default();
    assert_eq!(pair.sample(0, true, None, None), None);
    let codes = pair.sample(1000, true, None, None).unwrap();
    assert!(codes.faults.has(Fault::PositionUnusable) && codes.faults.has(Fault::ForceUnusable));
}

/// RESET, wait, WREG of all four, RREG of all four, which gives `back`.
fn set_up(back: [u8; 4]) -> Vec<Transaction<u8>> {
    let [a, b, c, d] = ads1220::REGISTERS;
    vec![
        Transaction::transaction_start(),
        Transaction::write(0x06),
        Transaction::delay(60_000),
        Transaction::transaction_end(),
        Transaction::transaction_start(),
        Transaction::write_vec(vec![0x43, a, b, c, d]),
        Transaction::transaction_end(),
        Transaction::transaction_start(),
        Transaction::transfer_in_place(
            vec![0x23, 0, 0, 0, 0],
            vec![0, back[0], back[1], back[2], back[3]],
        ),
        Transaction::transaction_end(),
    ]
}

#[test]
fn the_converter_is_reset_written_and_read_back() {
    let mut spi = Mock::new(&set_up(ads1220::REGISTERS));
    assert_eq!(ads1220::set_up(&mut spi), Ok(()));
    spi.done();
    for back in [[0; 4], [0xff; 4], [0x3e, 0xd0, 0x40, 0x02]] {
        let mut spi = Mock::new(&set_up(back));
        assert_eq!(
            ads1220::set_up(&mut spi),
            Err(ads1220::Error::Readback(back))
        );
        spi.done();
    }
}

/// A converter that has lost its registers: they are written after 0.1 s without a conversion and every 0.1 s from
/// then on, and one conversion in between puts that off.
#[test]
fn a_converter_that_is_silent_for_long_gets_its_registers_again() {
    let [a, b, c, d] = ads1220::REGISTERS;
    let mut spi = Mock::new(&[
        Transaction::transaction_start(),
        Transaction::write_vec(vec![0x43, a, b, c, d]),
        Transaction::transaction_end(),
    ]);
    assert_eq!(ads1220::write_registers(&mut spi), Ok(()));
    spi.done();
    let mut silence = ads1220::Silence::default();
    let written: Vec<u32> = (1..=400)
        .filter(|tick| silence.lasts(*tick == 90))
        .collect();
    assert_eq!(written, [190, 290, 390]);
}

#[test]
fn the_registers_say_what_their_comment_says() {
    let [mux_gain, rate, reference, currents] = ads1220::REGISTERS;
    assert_eq!(mux_gain >> 4, 0b0011, "AIN1 against AIN2");
    assert_eq!(mux_gain >> 1 & 0b111, 0b111, "gain 128");
    assert_eq!(rate >> 5, 0b110, "2000 a second in turbo mode");
    assert_eq!(rate >> 3 & 0b11, 0b10, "turbo mode");
    assert_eq!(rate >> 2 & 1, 0, "one at a time");
    assert_eq!(reference >> 6, 0b01, "REFP0 and REFN0");
    assert_eq!(reference & 0b111, 0, "no current source");
    assert_eq!(currents, 0, "DRDY on its own pin");
}

/// RDATA, 24 bits with DIN low, START.
fn conversion(code: i32) -> Vec<Transaction<u8>> {
    vec![
        Transaction::transaction_start(),
        Transaction::write(0x10),
        Transaction::transfer_in_place(vec![0, 0, 0], code.to_be_bytes()[1..].to_vec()),
        Transaction::write(0x08),
        Transaction::transaction_end(),
    ]
}

#[test]
fn a_conversion_is_fetched_with_its_sign_and_the_next_one_started() {
    for code in [0, 1, -1, 8_388_607, -8_388_608, 1_234_567, -7_654_321] {
        let mut spi = Mock::new(&conversion(code));
        assert_eq!(ads1220::fetch_and_start(&mut spi), Ok(code));
        spi.done();
    }
}

/// A tick: the encoder's angle, or none, and the converter's code.
fn tick(
    pair: &mut Pair,
    time_us: u64,
    ready: bool,
    angle: Option<u16>,
    force: i32,
) -> Option<Codes> {
    let answer = angle.map_or(0x0001, |angle| {
        angle | (angle.count_ones() as u16 % 2) << 15
    });
    let frames: Vec<_> = [frame(ANGLE, 0), frame(NOP, answer)].concat();
    let (mut encoder, mut bridge) = (Mock::new(&frames), Mock::new(&conversion(force)));
    let angle = as5047p::angle(&mut encoder).ok();
    let force = ads1220::fetch_and_start(&mut bridge).ok();
    let codes = pair.sample(time_us, ready, angle, force);
    encoder.done();
    bridge.done();
    codes
}

#[test]
fn force_and_position_belong_to_the_same_instant_through_wraps_of_the_encoder() {
    // GIVEN an encoder that turns by 1000 counts a tick, and a force that rises with it
    let mut pair = Pair::default();
    let angle = |i: i64| Some((i * 1000).rem_euclid(16_384) as u16);
    assert_eq!(tick(&mut pair, 0, true, angle(0), 99), None);
    for i in 1..100_i64 {
        // The conversion that is fetched was started a tick ago.
        let codes = tick(&mut pair, i as u64 * 1000, true, angle(i), i as i32).unwrap();
        assert_eq!(codes.time_us, (i as u64 - 1) * 1000);
        assert_eq!(codes.force, i as i32);
        // THEN the position is that of the conversion's middle: 9/32 of a tick after its start
        let expected = CODES_PER_COUNT * 1000 * (i as i32 - 1) + 9 * 1000;
        assert_eq!(codes.position, expected);
        assert_eq!(codes.faults, Faults::NONE);
    }
    // and the same backwards
    for i in (0..99_i64).rev() {
        let time_us = (198 - i) as u64 * 1000;
        let codes = tick(&mut pair, time_us, true, angle(i), 0).unwrap();
        assert_eq!(
            codes.position,
            CODES_PER_COUNT * 1000 * (i as i32 + 1) - 9 * 1000
        );
    }
}

/// An encoder that turns by 300 counts a tick, and four ticks of which two are missed. THEN the conversion of the last
/// tick before them has the position of its own middle, 9/32 of one tick after its start.
#[test]
fn after_missed_ticks_the_position_is_still_that_of_the_conversions_middle() {
    let mut pair = Pair::default();
    for (i, before) in [(1_i32, 0_i32), (2, 1), (5, 2), (6, 5)] {
        if i == 1 {
            assert_eq!(tick(&mut pair, 0, true, Some(0), 0), None);
        }
        let angle = Some((300 * i) as u16);
        let codes = tick(&mut pair, 1000 * i as u64, true, angle, 0).unwrap();
        assert_eq!(codes.time_us, 1000 * before as u64);
        assert_eq!(
            codes.position,
            CODES_PER_COUNT * 300 * before + 9 * 300,
            "{i}"
        );
    }
}

#[test]
fn a_reading_that_fails_is_a_fault_of_its_instants_and_the_count_goes_on() {
    let mut pair = Pair::default();
    let has = |codes: Option<Codes>, fault| codes.unwrap().faults.has(fault);
    tick(&mut pair, 0, true, Some(100), 5);
    assert!(has(
        tick(&mut pair, 1000, true, None, 5),
        Fault::PositionUnusable
    ));
    // The tick before was none: what lies between is not known either.
    assert!(has(
        tick(&mut pair, 2000, true, Some(120), 5),
        Fault::PositionUnusable
    ));
    let good = tick(&mut pair, 3000, true, Some(120), 5).unwrap();
    assert_eq!(
        (good.faults, good.position),
        (Faults::NONE, 20 * CODES_PER_COUNT)
    );
    assert!(has(
        tick(&mut pair, 4000, false, Some(120), 5),
        Fault::ForceUnusable
    ));
}

#[test]
fn behind_either_set_of_sensors_there_is_the_same_sample() {
    // GIVEN settings for this set: a lead of 5 mm a turn, a bridge of 1 µN a code
    let mut settings = Settings::default();
    for (key, value) in [
        (Key::ForcePerCode, 1e-6),
        (Key::ForceZeroCode, 1000.0),
        (Key::ForceLowestCode, -8_388_600.0),
        (Key::ForceHighestCode, 8_388_600.0),
        (Key::PositionPerCode, 5e-3 / 16_384.0 / 32.0),
        (Key::ForceCalibrated, 1.0),
        (Key::PositionCalibrated, 1.0),
    ] {
        settings.put(key, value);
    }
    let conversion = settings.setup().unwrap().conversion;
    let mut watch = Watch::default();
    let mut pair = Pair::default();
    tick(&mut pair, 0, true, Some(0), 0);
    // WHEN the encoder stands a quarter turn on and 2 N lie on the cell
    tick(&mut pair, 1000, true, Some(4096), 2_001_000);
    let codes = tick(&mut pair, 2000, true, Some(4096), 2_001_000).unwrap();
    let sample = conversion.sample(&mut watch, &codes);
    // THEN a quarter of 5 mm and 2 N are in the sample
    assert!((sample.position_m - 1.25e-3).abs() < 1e-9);
    assert!((sample.force_n - 2.0).abs() < 1e-6);
    assert_eq!(sample.faults, Faults::NONE);
    // and a converter at its end is saturated
    let codes = tick(&mut pair, 3000, true, Some(4096), 8_388_607).unwrap();
    assert!(
        conversion
            .sample(&mut watch, &codes)
            .faults
            .has(Fault::ForceSaturated)
    );
}
