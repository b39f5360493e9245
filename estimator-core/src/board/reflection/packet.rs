//! What crosses the channel: a law, its parameters with their uncertainty, where the surface is, and
//! how far to trust it.

use super::{impedance::Reflected, renderable::NotRenderable, renderable::PACKET_SLOTS};
use crate::board::wire::{FrameError, Reader, Writer};
use crate::estimate::{Estimate, Estimated, Phase, fault::Faults, status::Status};
use crate::physics::law::LawKind;

/// An identified impedance on its way to the other side: kind 7 of [`crate::board::frame`], 72 bytes on the
/// wire whatever the law.
///
/// A standard error crosses in 16 bits, the upper ones of its f32, rounded up: at most 0.8 % too large,
/// never too small.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Packet {
    /// The instant that it describes, by the sender's clock (µs).
    pub time_us: u64,
    /// Counts the sender's packets.
    pub sequence: u16,
    /// The law that the parameters belong to.
    pub law: LawKind,
    /// The phase of the sender's probe: in the air or in contact.
    pub phase: Phase,
    /// The state of the sender's estimates.
    pub status: Status,
    /// The faults at the sender.
    pub faults: Faults,
    /// δ₀ (m), at which stiffness and damping are reported.
    pub reference_depth_m: f32,
    /// A bit for each slot that is observable.
    known: u8,
    /// In the order of [`LawKind::parameters`], the surface (m) last; 0 where nothing is known.
    values: [f32; PACKET_SLOTS],
    /// The upper halves of the standard errors.
    std_errors: [u16; PACKET_SLOTS],
}

/// Packets that are late by less than this (µs) were overtaken in the channel; by more, the sender's
/// clock has started anew.
const REORDERED_US: u64 = 1_000_000;

impl Packet {
    /// The packet of an estimate whose parameters are reported at a depth δ₀ (m).
    pub fn of(estimate: &Estimate<f32>, reference_depth_m: f32, sequence: u16) -> Self {
        let mut packet = Packet {
            time_us: estimate.time_us,
            sequence,
            law: estimate.law,
            phase: estimate.phase,
            status: estimate.status,
            faults: estimate.faults,
            reference_depth_m,
            known: 0,
            values: [0.0; PACKET_SLOTS],
            std_errors: [0; PACKET_SLOTS],
        };
        let places = packet.values.iter_mut().zip(&mut packet.std_errors);
        for ((slot, known), (value, std_error)) in (0..).zip(&estimate.parameters).zip(places) {
            if let Some(known) = known {
                packet.known |= 1 << slot;
                (*value, *std_error) = (known.value, upper(known.std_error));
            }
        }
        packet
    }

    /// The parameters in the order of [`LawKind::parameters`], the surface (m) last; `None` is not
    /// observable, or no slot of the law.
    pub fn parameters(&self) -> [Option<Estimated<f32>>; PACKET_SLOTS] {
        let mut slots = (0..).zip(self.values.iter().zip(&self.std_errors));
        [(); PACKET_SLOTS].map(|()| {
            let (slot, (value, std_error)) = slots.next()?;
            let std_error = f32::from_bits(u32::from(*std_error) << 16);
            let value = *value;
            (self.known & (1 << slot) != 0).then_some(Estimated { value, std_error })
        })
    }

    /// Whether the channel has let `last` overtake it.
    pub fn is_older_than(&self, last: &Packet) -> bool {
        let late_us = last.time_us.saturating_sub(self.time_us);
        0 < late_us && late_us < REORDERED_US
    }

    /// The impedance to be rendered; `None` while a parameter of the law is not observable.
    ///
    /// # Errors
    /// A parameter that no material has: a negative stiffness, an exponent beyond 0.3…5.
    #[inline(never)]
    pub fn reflected(&self) -> Result<Option<Reflected>, NotRenderable> {
        if !self.is_complete() {
            return Ok(None);
        }
        Reflected::of(self.law, &self.values, self.reference_depth_m).map(Some)
    }

    /// Whether every parameter of the law is observable.
    pub fn is_complete(&self) -> bool {
        self.known & self.slots() == self.slots()
    }

    /// The same report with the law and the parameters of another one, such as the last complete one.
    #[must_use]
    pub fn with_parameters_of(&self, other: &Packet) -> Packet {
        Packet {
            time_us: self.time_us,
            sequence: self.sequence,
            phase: self.phase,
            status: self.status,
            faults: self.faults,
            ..*other
        }
    }

    /// The same report of a material of the same shape whose force is so many times as large: stiffnesses and damping
    /// with their standard errors change by the factor, exponents, rates and the surface stay.
    #[must_use]
    pub fn scaled(&self, factor: f32) -> Packet {
        let mut scaled = *self;
        let places = scaled.values.iter_mut().zip(&mut scaled.std_errors);
        for ((value, std_error), info) in places.zip(self.law.parameters()) {
            if matches!(info.name, "stiffness" | "second_stiffness" | "damping") {
                *value *= factor;
                *std_error = upper(f32::from_bits(u32::from(*std_error) << 16) * factor);
            }
        }
        scaled
    }

    /// A bit for each slot of the law.
    fn slots(&self) -> u8 {
        ((1_u16 << self.law.parameters().len()) - 1) as u8
    }

    pub(crate) fn put(&self, body: &mut Writer) {
        body.put(self.time_us.to_le_bytes());
        body.put(self.sequence.to_le_bytes());
        let (law, phase, status) = (self.law.code(), self.phase as u8, self.status.code());
        body.put([law, phase, status, self.known]);
        body.put(self.faults.bits().to_le_bytes());
        body.put(self.reference_depth_m.to_le_bytes());
        for value in &self.values {
            body.put(value.to_le_bytes());
        }
        for std_error in &self.std_errors {
            body.put(std_error.to_le_bytes());
        }
    }

    #[inline(never)]
    pub(crate) fn take(reader: &mut Reader) -> Result<Packet, FrameError> {
        let time_us = u64::from_le_bytes(reader.take()?);
        let sequence = u16::from_le_bytes(reader.take()?);
        let [law, phase, status, known] = reader.take()?;
        let faults = Faults::from_bits(u16::from_le_bytes(reader.take()?));
        let mut packet = Packet {
            time_us,
            sequence,
            law: LawKind::from_code(law).ok_or(FrameError::Content)?,
            phase: Phase::from_code(phase).ok_or(FrameError::Content)?,
            status: Status::from_code(status).ok_or(FrameError::Content)?,
            faults,
            reference_depth_m: reader.number()?,
            known,
            values: [0.0; PACKET_SLOTS],
            std_errors: [0; PACKET_SLOTS],
        };
        for value in &mut packet.values {
            *value = reader.number()?;
        }
        for std_error in &mut packet.std_errors {
            *std_error = u16::from_le_bytes(reader.take()?);
        }
        let good = known & !packet.slots() == 0 && packet.is_sound();
        good.then_some(packet).ok_or(FrameError::Content)
    }

    /// Whether all numbers are finite, and the depth is one that parameters can be reported at (that
    /// of [`crate::estimate::config::Reference`]).
    pub fn is_sound(&self) -> bool {
        // The exponent of NaN and of an infinite number is all ones.
        let errors = self.std_errors.iter().all(|half| half & 0x7f80 != 0x7f80);
        (1e-10..=1.0).contains(&self.reference_depth_m)
            && self.values.iter().all(|value| value.is_finite())
            && errors
    }
}

/// The upper half of a number's bits, rounded away from zero; at most the largest number's.
fn upper(value: f32) -> u16 {
    const LARGEST: u16 = 0x7f7f;
    let bits = value.to_bits();
    let half = (bits >> 16) as u16;
    match bits as u16 == 0 || half & 0x7fff >= LARGEST {
        true => half,
        false => half + 1,
    }
}
