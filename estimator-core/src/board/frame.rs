//! One versioned binary frame for telemetry, recording and replay.
//!
//! On the wire: COBS(version, kind, sequence, payload, CRC-32) and a zero byte. Zero occurs nowhere
//! else, so a reader that starts in the middle, or meets garbage, is in step again at the next zero.
//! All numbers are little-endian.

mod estimate;
mod record;

pub use record::Instant;

use crate::board::message::{Command, Health, Reply};
use crate::board::reflection::{Packet, Rendered};
use crate::board::sensing::Codes;
use crate::board::stuffing;
use crate::board::wire::{FrameError, MAX_BODY, RECORD_VERSION, Reader, VERSION, Writer};
use crate::estimate::Estimate;
use crate::estimate::fault::Faults;
use crate::estimate::record::PARAMETER_SLOTS;
use crate::estimate::sample::Sample;
use estimate::{codes_of, put_numbers, take_numbers};

/// The length of the longest frame on the wire, with its zero byte (bytes).
pub const MAX_ENCODED: usize = MAX_BODY + 2;
/// The length of a sample's frame on the wire (bytes).
pub const SAMPLE_ENCODED: usize = 4 + 18 + 4 + 2;
/// The length of the frame of an instant's codes on the wire (bytes).
pub const CODES_ENCODED: usize = 4 + 26 + 4 + 2;
/// The length of the frame of an impedance for the other side on the wire (bytes).
pub const PACKET_ENCODED: usize = 4 + 62 + 4 + 2;
/// The length of the frame of a rendered force on the wire (bytes).
pub const RENDERED_ENCODED: usize = 4 + 17 + 4 + 2;
/// The largest length of an estimate's frame on the wire (bytes): that of a law with all slots.
pub const ESTIMATE_ENCODED: usize = 4 + 8 + 8 + 8 * PARAMETER_SLOTS + 4 * 7 + 4 + 2;
/// The largest length of all frames of one instant on the wire (bytes), also of one that does not fit into
/// one frame.
pub const RECORD_ENCODED: usize =
    CODES_ENCODED + SAMPLE_ENCODED + ESTIMATE_ENCODED + PACKET_ENCODED + RENDERED_ENCODED;

const CRC: crc::Crc<u32> = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);

/// The content of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Frame {
    /// Kind 1: a sample as the estimator takes it.
    Sample(Sample<f32>),
    /// Kind 2: the estimate that it gives.
    Estimate(Estimate<f32>),
    /// Kind 3: the converters' codes that a sample was made from.
    Codes(Codes),
    /// Kind 4: the state of the board.
    Health(Health),
    /// Kind 5: a command to the board.
    Command(Command),
    /// Kind 6: the board's answer to a command.
    Reply(Reply),
    /// Kind 7: an identified impedance for the other side to render. To a board it is the command
    /// [`Command::Reflect`]: a board takes what another one sends as it is.
    Reflection(Packet),
    /// Kind 8: a rendered force.
    Rendered(Rendered),
    /// Kind 9: codes, sample and estimate of one instant. A board sends it in place of the kinds 3, 1
    /// and 2, and [`Frame::parts`] makes those three of it.
    Record(Instant),
}

impl Frame {
    /// Returns what the frame says, part by part: codes, sample and estimate of a record, and any other frame
    /// as it is.
    pub fn parts(self) -> impl Iterator<Item = Frame> {
        let parts = match self {
            Frame::Record(Instant {
                codes,
                sample,
                estimate,
            }) => [
                Some(Frame::Codes(codes)),
                Some(Frame::Sample(sample)),
                Some(Frame::Estimate(estimate)),
            ],
            other => [Some(other), None, None],
        };
        parts.into_iter().flatten()
    }
}

/// Writes a frame and gives its length, zero byte included.
pub fn encode(frame: &Frame, sequence: u16, out: &mut [u8; MAX_ENCODED]) -> usize {
    let mut body = Writer::new();
    let kind = match frame {
        Frame::Sample(_) => 1,
        Frame::Estimate(_) => 2,
        Frame::Codes(_) => 3,
        Frame::Health(_) => 4,
        Frame::Reflection(_) | Frame::Command(Command::Reflect(_)) => 7,
        Frame::Command(_) => 5,
        Frame::Reply(_) => 6,
        Frame::Rendered(_) => 8,
        Frame::Record(_) => 9,
    };
    body.put([version_of(kind), kind]);
    body.put(sequence.to_le_bytes());
    match frame {
        Frame::Sample(sample) => put_sample(&mut body, sample),
        Frame::Estimate(estimate) => put_estimate(&mut body, estimate),
        Frame::Codes(codes) => put_codes(&mut body, codes),
        Frame::Health(health) => health.put(&mut body),
        Frame::Reflection(packet) | Frame::Command(Command::Reflect(packet)) => {
            packet.put(&mut body);
        }
        Frame::Command(command) => command.put(&mut body),
        Frame::Reply(reply) => reply.put(&mut body),
        Frame::Rendered(rendered) => put_rendered(&mut body, rendered),
        Frame::Record(instant) => instant.put(&mut body),
    }
    body.put(CRC.checksum(body.written()).to_le_bytes());
    stuffing::encode(body.written(), out)
}

// MAX_ENCODED leaves room for the one byte of the code, and for the zero.
const _: () = assert!(MAX_BODY <= stuffing::LONGEST);

/// Returns the version of a kind's layout. A reader of an older version refuses the kinds that are newer
/// than it is, and says so; all others it reads.
fn version_of(kind: u8) -> u8 {
    match kind {
        9 => RECORD_VERSION,
        _ => VERSION,
    }
}

fn put_sample(body: &mut Writer, sample: &Sample<f32>) {
    body.put(sample.time_us.to_le_bytes());
    body.put(sample.faults.bits().to_le_bytes());
    body.put(sample.position_m.to_le_bytes());
    body.put(sample.force_n.to_le_bytes());
}

fn put_codes(body: &mut Writer, codes: &Codes) {
    body.put(codes.time_us.to_le_bytes());
    body.put(codes.faults.bits().to_le_bytes());
    for code in [
        codes.force,
        codes.force_low,
        codes.force_high,
        codes.position,
    ] {
        body.put(code.to_le_bytes());
    }
}

fn put_rendered(body: &mut Writer, rendered: &Rendered) {
    body.put(rendered.time_us.to_le_bytes());
    body.put(rendered.force_n.to_le_bytes());
    body.put(rendered.sequence.to_le_bytes());
    body.put([rendered.limits]);
    body.put(rendered.faults.bits().to_le_bytes());
}

fn put_estimate(body: &mut Writer, estimate: &Estimate<f32>) {
    body.put(estimate.time_us.to_le_bytes());
    body.put(codes_of(estimate));
    put_numbers(body, estimate);
}

/// Finds frames in a stream of bytes.
#[derive(Clone, Debug)]
pub struct Decoder {
    bytes: [u8; MAX_ENCODED],
    length: usize,
}

impl Default for Decoder {
    fn default() -> Self {
        Decoder::new()
    }
}

impl Decoder {
    /// The decoder of a stream that is about to start.
    pub const fn new() -> Self {
        Decoder {
            bytes: [0; MAX_ENCODED],
            length: 0,
        }
    }

    /// Takes one byte, and at the end of a frame gives its sequence number and content, or why the
    /// bytes are no frame; the next frame is then read afresh.
    pub fn push(&mut self, byte: u8) -> Option<Result<(u16, Frame), FrameError>> {
        if byte != 0 {
            if let Some(slot) = self.bytes.get_mut(self.length) {
                *slot = byte;
            }
            self.length = self.length.saturating_add(1);
            return None;
        }
        let length = core::mem::replace(&mut self.length, 0);
        // Two zeros in a row are an idle line, not a broken frame.
        (length > 0).then(|| match self.bytes.get_mut(..length) {
            Some(encoded) => decode(encoded),
            None => Err(FrameError::Framing),
        })
    }
}

fn decode(encoded: &mut [u8]) -> Result<(u16, Frame), FrameError> {
    let length = stuffing::decode(encoded).ok_or(FrameError::Framing)?;
    let body = encoded.get(..length).ok_or(FrameError::Framing)?;
    let (content, sum) = body.split_last_chunk::<4>().ok_or(FrameError::Framing)?;
    if CRC.checksum(content) != u32::from_le_bytes(*sum) {
        return Err(FrameError::Checksum);
    }
    let mut reader = Reader::new(content);
    let [version, kind] = reader.take()?;
    if version != version_of(kind) {
        return Err(FrameError::Version(version));
    }
    let sequence = u16::from_le_bytes(reader.take()?);
    let frame = match kind {
        1 => Frame::Sample(take_sample(&mut reader)?),
        2 => Frame::Estimate(take_estimate(&mut reader)?),
        3 => Frame::Codes(take_codes(&mut reader)?),
        4 => Frame::Health(Health::take(&mut reader)?),
        5 => Frame::Command(Command::take(&mut reader)?),
        6 => Frame::Reply(Reply::take(&mut reader)?),
        7 => Frame::Reflection(Packet::take(&mut reader)?),
        8 => Frame::Rendered(take_rendered(&mut reader)?),
        9 => Frame::Record(Instant::take(&mut reader)?),
        _ => return Err(FrameError::Content),
    };
    if reader.is_empty() {
        Ok((sequence, frame))
    } else {
        Err(FrameError::Content)
    }
}

fn take_sample(reader: &mut Reader) -> Result<Sample<f32>, FrameError> {
    Ok(Sample {
        time_us: u64::from_le_bytes(reader.take()?),
        faults: Faults::from_bits(u16::from_le_bytes(reader.take()?)),
        position_m: reader.number()?,
        force_n: reader.number()?,
    })
}

fn take_codes(reader: &mut Reader) -> Result<Codes, FrameError> {
    Ok(Codes {
        time_us: u64::from_le_bytes(reader.take()?),
        faults: Faults::from_bits(u16::from_le_bytes(reader.take()?)),
        force: i32::from_le_bytes(reader.take()?),
        force_low: i32::from_le_bytes(reader.take()?),
        force_high: i32::from_le_bytes(reader.take()?),
        position: i32::from_le_bytes(reader.take()?),
    })
}

fn take_rendered(reader: &mut Reader) -> Result<Rendered, FrameError> {
    let time_us = u64::from_le_bytes(reader.take()?);
    let force_n = reader.number()?;
    let sequence = u16::from_le_bytes(reader.take()?);
    let [limits] = reader.take()?;
    Ok(Rendered {
        time_us,
        force_n,
        sequence,
        limits,
        faults: Faults::from_bits(u16::from_le_bytes(reader.take()?)),
    })
}

fn take_estimate(reader: &mut Reader) -> Result<Estimate<f32>, FrameError> {
    let time_us = u64::from_le_bytes(reader.take()?);
    let codes = reader.take()?;
    take_numbers(reader, time_us, codes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::status::{Reason, Status};
    use crate::estimate::{Estimated, Event, Innovation, Phase};
    use crate::physics::law::LawKind;
    extern crate std;
    use std::vec::Vec;

    fn estimate() -> Estimate<f32> {
        let mut parameters = [None; PARAMETER_SLOTS];
        parameters[0] = Some(Estimated {
            value: 1350.0,
            std_error: 1.5,
        });
        parameters[3] = Some(Estimated {
            value: 2.5e-5,
            std_error: 1e-6,
        });
        Estimate {
            time_us: u64::from(u32::MAX) * 7,
            law: LawKind::HuntCrossley,
            phase: Phase::Contact,
            status: Status::ModelSuspect,
            reason: Some(Reason::Skew),
            depth_m: 1e-3,
            speed_mps: -0.02,
            force_n: 3.5,
            parameters,
            innovation: Innovation {
                observation_n: 3.5,
                prediction_n: 3.25,
                innovation_n: 0.25,
                variance_n2: 1e-4,
                test_ratio: 625.0,
            },
            forgetting: 0.9999,
            event: Some(Event::MaterialChange),
            faults: Faults::from_bits(5),
        }
    }

    fn sample() -> Sample<f32> {
        Sample {
            time_us: 1000,
            position_m: 0.0,
            force_n: -0.5,
            faults: Faults::NONE,
        }
    }

    fn encoded(frame: &Frame, sequence: u16) -> Vec<u8> {
        let mut out = [0; MAX_ENCODED];
        let length = encode(frame, sequence, &mut out);
        out[..length].to_vec()
    }

    fn frames(bytes: &[u8]) -> Vec<Result<(u16, Frame), FrameError>> {
        let mut decoder = Decoder::new();
        bytes
            .iter()
            .filter_map(|byte| decoder.push(*byte))
            .collect()
    }

    #[test]
    fn what_goes_in_comes_out() {
        let codes = Codes {
            time_us: 1 << 40,
            force: -123_456,
            force_low: -9000,
            force_high: 8_388_607,
            position: i32::MIN,
            faults: Faults::from_bits(9),
        };
        assert_eq!(encoded(&Frame::Codes(codes), 1).len(), CODES_ENCODED);
        for frame in [
            Frame::Estimate(estimate()),
            Frame::Sample(sample()),
            Frame::Codes(codes),
        ] {
            assert_eq!(frames(&encoded(&frame, 65_535)), [Ok((65_535, frame))]);
        }
    }

    /// An instant whose estimate is 8 ms older than its sample.
    fn instant() -> Instant {
        let time_us = 1 << 40;
        Instant {
            codes: Codes {
                time_us,
                force: 123_456,
                force_low: -20,
                force_high: 4095,
                position: i32::MIN,
                faults: Faults::from_bits(9),
            },
            sample: Sample {
                time_us,
                ..sample()
            },
            estimate: Estimate {
                time_us: time_us - 8000,
                ..estimate()
            },
        }
    }

    #[test]
    fn a_record_takes_a_quarter_fewer_bytes_than_its_parts_and_gives_them_back() {
        let whole = instant();
        assert!(whole.fits());
        let bytes = encoded(&Frame::Record(whole), 7);
        let parts: Vec<Frame> = Frame::Record(whole).parts().collect();
        let apart: usize = parts.iter().map(|part| encoded(part, 0).len()).sum();
        assert_eq!((bytes.len(), apart), (111, 150));
        assert_eq!(frames(&bytes), [Ok((7, Frame::Record(whole)))]);
        assert_eq!(
            parts,
            [
                Frame::Codes(whole.codes),
                Frame::Sample(whole.sample),
                Frame::Estimate(whole.estimate)
            ]
        );
        assert_eq!(Frame::Sample(sample()).parts().count(), 1);
    }

    /// A converter that gives one code a tick has 24 bits; its record is shorter still.
    #[test]
    fn a_single_conversion_has_no_lowest_and_highest_of_its_own() {
        let mut single = instant();
        (single.codes.force_low, single.codes.force_high) = (123_456, 123_456);
        assert!(single.fits());
        let bytes = encoded(&Frame::Record(single), 7);
        assert_eq!(bytes.len(), 107);
        assert_eq!(frames(&bytes), [Ok((7, Frame::Record(single)))]);
    }

    #[test]
    fn what_one_stamp_cannot_say_goes_out_in_three_frames() {
        let change: [fn(&mut Instant); 5] = [
            |instant| instant.codes.time_us += 1,
            |instant| instant.estimate.time_us += 8001,
            |instant| instant.estimate.time_us -= 1 << 24,
            |instant| instant.codes.force_low = -40_000,
            |instant| {
                instant.codes.time_us = 1 << 48;
                instant.sample.time_us = 1 << 48;
                instant.estimate.time_us = (1 << 48) - 8000;
            },
        ];
        for change in change {
            let mut other = instant();
            change(&mut other);
            assert!(!other.fits(), "{other:?}");
        }
    }

    /// A reader that knows no records says which version they have; it reads every other frame.
    #[test]
    fn a_record_has_a_version_of_its_own() {
        let bytes = encoded(&Frame::Record(instant()), 1);
        let mut plain = bytes.clone();
        let length = stuffing::decode(&mut plain[..bytes.len() - 1]).unwrap();
        assert_eq!((plain[0], plain[1]), (RECORD_VERSION, 9));
        // The same content under the other version, with its check sum.
        plain[0] = VERSION;
        let sum = CRC.checksum(&plain[..length - 4]).to_le_bytes();
        plain[length - 4..length].copy_from_slice(&sum);
        let mut other = std::vec![0; MAX_ENCODED];
        let coded = cobs::encode(&plain[..length], &mut other);
        other[coded] = 0;
        assert_eq!(
            frames(&other[..=coded]),
            [Err(FrameError::Version(VERSION))]
        );
    }

    #[test]
    fn two_estimates_and_a_sample_fit_two_megabaud_at_a_kilohertz() {
        // 2 Mbaud carries 200 bytes a millisecond, ten bits each.
        let length = encoded(&Frame::Estimate(estimate()), 0).len();
        assert!((80..=86).contains(&length), "{length}");
        let sample = encoded(&Frame::Sample(sample()), 0).len();
        assert_eq!(sample, SAMPLE_ENCODED);
        assert!(2 * length + sample <= 200);
    }

    #[test]
    fn the_longest_law_fits_with_its_sample_and_every_law_comes_back() {
        for law in LawKind::ALL {
            let slots = law.parameters().len();
            let mut parameters = [None; PARAMETER_SLOTS];
            for (slot, parameter) in parameters.iter_mut().take(slots).enumerate() {
                *parameter = Some(Estimated {
                    value: slot as f32,
                    std_error: 0.5,
                });
            }
            let frame = Frame::Estimate(Estimate {
                law,
                parameters,
                ..estimate()
            });
            let bytes = encoded(&frame, 3);
            assert_eq!(bytes.len(), 54 + 8 * slots);
            assert!(bytes.len() <= MAX_ENCODED);
            // 2 Mbaud carry 200 bytes a millisecond; a tenth of it is margin.
            let record = bytes.len() + SAMPLE_ENCODED + CODES_ENCODED;
            assert!(record <= 180, "{law:?}: {record}");
            assert_eq!(frames(&bytes), [Ok((3, frame))]);
        }
    }

    #[test]
    fn every_flipped_bit_is_refused_and_the_next_frame_is_read() {
        let good = encoded(&Frame::Estimate(estimate()), 1);
        let next = encoded(&Frame::Sample(sample()), 2);
        for bit in 0..8 * (good.len() - 1) {
            let mut stream = good.clone();
            stream[bit / 8] ^= 1 << (bit % 8);
            stream.extend_from_slice(&next);
            let found = frames(&stream);
            assert_eq!(
                found.last(),
                Some(&Ok((2, Frame::Sample(sample())))),
                "bit {bit}"
            );
            assert!(
                found[..found.len() - 1].iter().all(Result::is_err),
                "bit {bit}"
            );
        }
    }

    #[test]
    fn a_reader_that_starts_in_the_middle_finds_the_next_frame() {
        let good = encoded(&Frame::Estimate(estimate()), 1);
        for cut in 1..good.len() - 1 {
            let stream = [&good[cut..], &good[..]].concat();
            assert_eq!(
                frames(&stream).last(),
                Some(&Ok((1, Frame::Estimate(estimate()))))
            );
        }
    }

    #[test]
    fn garbage_of_any_length_is_refused() {
        let mut stream: Vec<u8> = (0..500u32).map(|i| (i * 37 % 255 + 1) as u8).collect();
        stream.push(0);
        assert_eq!(frames(&stream), [Err(FrameError::Framing)]);
        assert_eq!(frames(&[0, 0, 0]), []);
    }
}
