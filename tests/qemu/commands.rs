//! Commands to a board that runs, and its answers.

use crate::SAMPLES;
use crate::frames::{codes, every_frame_is_numbered, replies, with_pauses};
use estimator_core::board::frame::Frame;
use estimator_core::board::link::{Answer, Command, Identity, Name, Refusal};
use estimator_core::board::settings::store::LAYOUT;
use estimator_core::board::settings::{Key, Settings};
use palpate::link::Device;
use palpate::link::port::Files;
use palpate::link::record::{convert, record};
use std::fs;
use tests::emulator::Emulator;
use tests::signal::palpation;

/// Runs the firmware while commands come, after bytes that are no frame, and gives its answers.
pub(crate) fn answers(
    emulator: &Emulator,
    commands: &[(usize, Command)],
    garbage: &[u8],
) -> Vec<Answer> {
    let bytes = [garbage, &with_pauses(commands)[..]].concat();
    fs::write(emulator.directory.join("commands.frames"), bytes).expect("commands");
    let run = emulator.run(&palpation(8_000, 3), |_| {}).expect("run");
    every_frame_is_numbered(&run.frames);
    let numbered = replies(&run).into_iter().zip(0..);
    let answers = numbered.map(|((to, answer), number)| {
        assert_eq!(to, number);
        answer
    });
    answers.collect()
}

#[test]
fn commands_are_answered_refused_with_a_reason_and_settings_outlive_the_run() {
    let emulator = Emulator::from_env("commands").expect("set-up");
    let _ = fs::remove_file(emulator.directory.join("settings.flash"));
    let width = Key::EstimatorHalfWidth.id();
    let identity = Identity {
        board: Name::new("qemu"),
        firmware: Name::new("0.1.0"),
        layout: LAYOUT,
        rate_hz: 1000,
        tick: 1_000_000,
        unsaved: false,
    };
    let first = answers(
        &emulator,
        &[
            (0, Command::Identify),
            (0, Command::Get(width)),
            (0, Command::Set(width, 12.0)),
            (50, Command::Set(width, 99.0)),
            (50, Command::Set(200, 1.0)),
            (50, Command::Unknown(77)),
            (50, Command::Save),
            (50, Command::Set(width, 16.0)),
            (1000, Command::Get(width)),
            (0, Command::Identify),
        ],
        &[1, 2, 3, 0],
    );
    let value = |value| Answer::Value(width, value);
    assert_eq!(
        first[..8],
        [
            Answer::Identity(identity),
            value(8.0),
            value(12.0),
            Answer::Refused(Refusal::Unusable, width),
            Answer::Refused(Refusal::UnknownSetting, 200),
            Answer::Refused(Refusal::UnknownCommand, 0),
            Answer::Done,
            value(16.0),
        ]
    );
    let unsaved = Identity {
        unsaved: true,
        ..identity
    };
    assert_eq!(first[8..], [value(16.0), Answer::Identity(unsaved)]);
    // The next run has what was saved, not what was changed after it.
    let many: Vec<_> = (0..40).map(|_| (50, Command::Save)).collect();
    let second = answers(
        &emulator,
        &[
            &[(0, Command::Get(width)), (1500, Command::Identify)],
            &many[..],
        ]
        .concat(),
        &[],
    );
    assert_eq!(second[..2], [value(12.0), Answer::Identity(identity)]);
    let count = |answer| second.iter().filter(|a| **a == answer).count();
    let (done, refused) = (
        count(Answer::Done),
        count(Answer::Refused(Refusal::InContact, 0)),
    );
    assert_eq!(done + refused, 40, "{second:?}");
    assert!(done > 0 && refused > 0, "{second:?}");
}

/// The host reaches the emulator over the files that the firmware reads and writes while it runs.
#[test]
fn the_hosts_verbs_reach_the_emulator_while_it_runs() {
    let emulator = Emulator::from_env("live").expect("set-up");
    let directory = emulator.directory.clone();
    for name in ["commands.frames", "telemetry.frames"] {
        fs::write(directory.join(name), []).expect("empty files");
    }
    let _ = fs::remove_file(directory.join("settings.flash"));
    let out = directory.join("recorded");
    let _ = fs::remove_dir_all(&out);
    let codes = codes(&palpation(SAMPLES, 4));
    let frames: Vec<Frame> = codes.into_iter().map(Frame::Codes).collect();
    let running = std::thread::spawn(move || emulator.run_frames(&frames, |_| {}));
    let mut device = Device::new(Files::open(&directory).expect("the emulator's directory"));
    // It takes a moment to start.
    let identity = (0..20)
        .find_map(|_| device.identity().ok())
        .expect("an answer");
    assert_eq!(identity.board.as_str(), "qemu");
    assert_eq!(device.settings().expect("settings"), Settings::default());
    let unusable = device.set(Key::TelemetryEvery, 0.0).expect_err("refused");
    assert!(
        unusable.to_string().contains("telemetry.every"),
        "{unusable}"
    );
    let statistics = record(&mut device, &out, Some(2_000_000)).expect("a recording");
    assert_eq!((statistics.lost, statistics.garbled), (0, 0));
    let said = convert(&out, palpate::kind::Kind::Linear).expect("a log");
    assert!(said.contains("0 samples missing"), "{said}");
    let run = running.join().expect("no panic").expect("run");
    every_frame_is_numbered(&run.frames);
}
