//! An estimate as bytes of a frame's body.

use crate::board::wire::{FrameError, Reader, Writer};
use crate::estimate::fault::Faults;
use crate::estimate::status::{Reason, Status};
use crate::estimate::{Estimate, Estimated, Event, Innovation, PARAMETER_SLOTS, Phase};
use crate::physics::law::LawKind;

/// The codes of an estimate: law, phase, status with its reason, event.
pub(crate) type EstimateCodes = [u8; 4];

/// Returns the codes of an estimate.
pub(crate) fn codes_of(estimate: &Estimate<f32>) -> EstimateCodes {
    let event = estimate.event.map_or(0, |event| event as u8);
    // The status and, in the upper half of its byte, the reason why it is not better.
    let reason = estimate.reason.map_or(0, Reason::code);
    let (phase, status) = (estimate.phase as u8, estimate.status.code() | reason << 4);
    [estimate.law.code(), phase, status, event]
}

/// Writes everything but the time and the codes.
pub(crate) fn put_numbers(body: &mut Writer, estimate: &Estimate<f32>) {
    body.put(estimate.faults.bits().to_le_bytes());
    let known = (0u8..)
        .zip(&estimate.parameters)
        .filter(|(_, parameter)| parameter.is_some());
    let mask: u16 = known.fold(0, |mask, (slot, _)| mask | 1 << slot);
    body.put(mask.to_le_bytes());
    let slots = estimate.law.parameters().len();
    for parameter in estimate.parameters.iter().take(slots) {
        let parameter = parameter.unwrap_or_default();
        body.put(parameter.value.to_le_bytes());
        body.put(parameter.std_error.to_le_bytes());
    }
    let innovation = &estimate.innovation;
    let numbers = [
        estimate.depth_m,
        estimate.speed_mps,
        estimate.force_n,
        innovation.prediction_n,
        innovation.variance_n2,
        innovation.test_ratio,
        estimate.forgetting,
    ];
    for number in numbers {
        body.put(number.to_le_bytes());
    }
}

/// Reads what [`put_numbers`] has written, for an estimate of this time with these codes.
pub(crate) fn take_numbers(
    reader: &mut Reader,
    time_us: u64,
    [law, phase, status, event]: EstimateCodes,
) -> Result<Estimate<f32>, FrameError> {
    let faults = Faults::from_bits(u16::from_le_bytes(reader.take()?));
    let known = u16::from_le_bytes(reader.take()?);
    let law = LawKind::from_code(law).ok_or(FrameError::Content)?;
    let slots = law.parameters().len();
    let mut parameters = [None; PARAMETER_SLOTS];
    for (slot, parameter) in (0u8..).zip(parameters.iter_mut().take(slots)) {
        let read = Estimated {
            value: reader.number()?,
            std_error: reader.number()?,
        };
        *parameter = (known & (1 << slot) != 0).then_some(read);
    }
    let [depth_m, speed_mps, force_n] = [reader.number()?, reader.number()?, reader.number()?];
    let prediction_n = reader.number()?;
    let innovation = Innovation {
        observation_n: force_n,
        prediction_n,
        innovation_n: force_n - prediction_n,
        variance_n2: reader.number()?,
        test_ratio: reader.number()?,
    };
    Ok(Estimate {
        time_us,
        law,
        phase: Phase::from_code(phase).ok_or(FrameError::Content)?,
        status: Status::from_code(status & 0xf).ok_or(FrameError::Content)?,
        reason: match status >> 4 {
            0 => None,
            code => Some(Reason::from_code(code).ok_or(FrameError::Content)?),
        },
        depth_m,
        speed_mps,
        force_n,
        parameters,
        innovation,
        forgetting: reader.number()?,
        event: match event {
            0 => None,
            code => Some(Event::from_code(code).ok_or(FrameError::Content)?),
        },
        faults,
    })
}
