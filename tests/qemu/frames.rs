//! What goes into the emulator and what comes back.

use estimator_core::board::frame::{Frame, MAX_ENCODED, encode};
use estimator_core::board::link::{Answer, Command};
use estimator_core::board::sensing::Codes;
use estimator_core::board::settings::Key;
use estimator_core::{Faults, Sample};
use tests::emulator::{Budget, Emulator, Run};

/// Runs the firmware over recorded frames, and reads the counters that it logs.
pub(crate) fn measured(emulator: &Emulator, frames: &[Frame]) -> (Run, Budget) {
    let run = emulator.run_frames(frames, |_| {}).expect("run");
    let budget = Budget::from_log(&run.log).expect("budget");
    println!("{budget:?}");
    (run, budget)
}

/// The same over codes.
pub(crate) fn measured_codes(emulator: &Emulator, codes: &[Codes]) -> (Run, Budget) {
    let frames: Vec<Frame> = codes.iter().copied().map(Frame::Codes).collect();
    measured(emulator, &frames)
}

/// Asserts that no frame is missing and none comes twice: their sequence numbers count them in 16 bits. The
/// sample and the estimate of a record have the number of its codes.
pub(crate) fn every_frame_is_numbered(frames: &[(u16, Frame)]) {
    let (mut next, mut last) = (0_u16, None);
    for (sequence, frame) in frames {
        let goes_on = matches!(
            (&last, frame),
            (Some(Frame::Codes(_)), Frame::Sample(_))
                | (Some(Frame::Sample(_)), Frame::Estimate(_))
        );
        if !goes_on || *sequence == next {
            assert_eq!(*sequence, next, "{frame:?}");
            next = next.wrapping_add(1);
        }
        assert_eq!(*sequence, next.wrapping_sub(1), "{frame:?}");
        last = Some(*frame);
    }
}

/// The records: the frames without what comes once a second and what answers a command.
pub(crate) fn records(frames: &[(u16, Frame)]) -> Vec<Frame> {
    let records = frames.iter().map(|(_, frame)| *frame);
    records
        .filter(|frame| !matches!(frame, Frame::Health(_) | Frame::Reply(_)))
        .collect()
}

/// The answers to commands, each with the number of the command.
pub(crate) fn replies(run: &Run) -> Vec<(u16, Answer)> {
    let replies = run.frames.iter().filter_map(|(_, frame)| match frame {
        Frame::Reply(reply) => Some((reply.to, reply.answer)),
        _ => None,
    });
    replies.collect()
}

/// The codes that the converters of the reference wiring would give on a palpation.
pub(crate) fn codes(samples: &[Sample<f32>]) -> Vec<Codes> {
    let scale = |key: Key| f64::from(key.info().default);
    let code = |value: f32, per_code: Key| (f64::from(value) / scale(per_code)).round() as i32;
    let zero = scale(Key::ForceZeroCode) as i32;
    samples
        .iter()
        .map(|sample| {
            let force = zero + code(sample.force_n, Key::ForcePerCode);
            Codes {
                time_us: sample.time_us,
                force,
                force_low: force / 32 - 3,
                force_high: force / 32 + 3,
                position: code(sample.position_m, Key::PositionPerCode),
                faults: Faults::NONE,
            }
        })
        .collect()
}

/// Commands as a host would send them, each after a quiet time (ms). Zeros are an idle line, of which the
/// emulator takes 64 in 32 ms.
pub(crate) fn with_pauses(commands: &[(usize, Command)]) -> Vec<u8> {
    let frames: Vec<Frame> = commands.iter().map(|(_, c)| Frame::Command(*c)).collect();
    let mut bytes = Vec::new();
    for (sequence, ((quiet_ms, _), frame)) in commands.iter().zip(frames).enumerate() {
        bytes.extend(std::iter::repeat_n(0, 2 * quiet_ms));
        let mut out = [0; MAX_ENCODED];
        let length = encode(&frame, sequence as u16, &mut out);
        bytes.extend_from_slice(&out[..length]);
    }
    bytes
}
