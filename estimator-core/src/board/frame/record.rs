//! Codes, sample and estimate of one instant in one frame with one time stamp.

use super::estimate::{codes_of, put_numbers, take_numbers};
use crate::board::sensing::Codes;
use crate::board::wire::{FrameError, Reader, Writer};
use crate::estimate::fault::Faults;
use crate::estimate::{Estimate, sample::Sample};

/// The highest time (µs) and the longest delay of an estimate (µs) that the frame has room for: nine years
/// and 16 s.
const LATEST_US: u64 = (1 << 48) - 1;
const LONGEST_DELAY_US: u64 = (1 << 24) - 1;
/// The bit of the event's byte that says that one conversion made the instant: its lowest and highest
/// conversion are the code itself and take no bytes.
const SINGLE: u8 = 1 << 7;

/// What one instant gave, of which the parts fit together: one time, one conversion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instant {
    /// The codes of the converters.
    pub codes: Codes,
    /// The sample that was made of them.
    pub sample: Sample<f32>,
    /// The estimate that followed.
    pub estimate: Estimate<f32>,
}

impl Instant {
    /// Returns whether the frame has room for all of it; otherwise it goes out in three frames.
    pub fn fits(&self) -> bool {
        let Instant {
            codes,
            sample,
            estimate,
        } = self;
        let delay_us = sample.time_us.checked_sub(estimate.time_us);
        let narrow =
            i16::try_from(codes.force_low).is_ok() && i16::try_from(codes.force_high).is_ok();
        codes.time_us == sample.time_us
            && sample.time_us <= LATEST_US
            && delay_us.is_some_and(|delay_us| delay_us <= LONGEST_DELAY_US)
            && (narrow || is_single(codes))
    }

    /// Writes an instant that fits.
    pub(crate) fn put(&self, body: &mut Writer) {
        let Instant {
            codes,
            sample,
            estimate,
        } = self;
        let [a, b, c, d, e, f, ..] = sample.time_us.to_le_bytes();
        body.put([a, b, c, d, e, f]);
        let delay_us = sample.time_us.wrapping_sub(estimate.time_us) as u32;
        let [low, middle, high, _] = delay_us.to_le_bytes();
        body.put([low, middle, high]);
        let [law, phase, status, event] = codes_of(estimate);
        let single = is_single(codes);
        let kind = event | if single { SINGLE } else { 0 };
        body.put([law, phase, status, kind]);
        body.put(codes.force.to_le_bytes());
        body.put(codes.position.to_le_bytes());
        if !single {
            body.put((codes.force_low as i16).to_le_bytes());
            body.put((codes.force_high as i16).to_le_bytes());
        }
        body.put(codes.faults.bits().to_le_bytes());
        body.put(sample.faults.bits().to_le_bytes());
        body.put(sample.position_m.to_le_bytes());
        body.put(sample.force_n.to_le_bytes());
        put_numbers(body, estimate);
    }

    pub(crate) fn take(reader: &mut Reader) -> Result<Instant, FrameError> {
        let [a, b, c, d, e, f] = reader.take()?;
        let time_us = u64::from_le_bytes([a, b, c, d, e, f, 0, 0]);
        let [low, middle, high] = reader.take()?;
        let delay_us = u64::from(u32::from_le_bytes([low, middle, high, 0]));
        let [law, phase, status, kind] = reader.take()?;
        let force = i32::from_le_bytes(reader.take()?);
        let position = i32::from_le_bytes(reader.take()?);
        let [force_low, force_high] = match kind & SINGLE {
            0 => [
                i16::from_le_bytes(reader.take()?).into(),
                i16::from_le_bytes(reader.take()?).into(),
            ],
            _ => [force; 2],
        };
        let codes = Codes {
            time_us,
            force,
            force_low,
            force_high,
            position,
            faults: Faults::from_bits(u16::from_le_bytes(reader.take()?)),
        };
        let sample = Sample {
            time_us,
            faults: Faults::from_bits(u16::from_le_bytes(reader.take()?)),
            position_m: reader.number()?,
            force_n: reader.number()?,
        };
        let estimated_us = time_us.checked_sub(delay_us).ok_or(FrameError::Content)?;
        let codes_of_it = [law, phase, status, kind & !SINGLE];
        let estimate = take_numbers(reader, estimated_us, codes_of_it)?;
        Ok(Instant {
            codes,
            sample,
            estimate,
        })
    }
}

fn is_single(codes: &Codes) -> bool {
    codes.force_low == codes.force && codes.force_high == codes.force
}
