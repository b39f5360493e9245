use super::*;
use crate::board::cut_flash::CutFlash;
use crate::board::frame::{Frame, MAX_ENCODED, encode};
use crate::board::history::{Crash, CrashKind, History, ResetCause, Stage};
use crate::board::ram_flash::SECTOR;
use crate::board::settings::store::Store;
use crate::board::wire::FrameError;
use crate::estimate::fault::Fault;
extern crate std;
use std::vec;
use std::vec::Vec;

/// Settings in a flash that loses power after so many steps.
fn store(steps_left: u64) -> Store<CutFlash> {
    let mut flash = CutFlash::new(0xff);
    flash.steps_left = steps_left;
    Store::new(flash, 0, SECTOR)
}

fn identity() -> Identity {
    Identity {
        board: Name::new("test"),
        firmware: Name::new("1.2.3"),
        layout: 1,
        rate_hz: 1000,
        tick: 168_000,
        unsaved: false,
    }
}

fn responder() -> Responder<CutFlash> {
    Responder::new(store(u64::MAX), identity())
}

fn encoded(frame: &Frame, sequence: u16) -> Vec<u8> {
    let mut out = [0; MAX_ENCODED];
    let length = encode(frame, sequence, &mut out);
    out[..length].to_vec()
}

fn ask(responder: &mut Responder<CutFlash>, command: Command) -> Answer {
    responder.answer(1, command, false, false).reply.answer
}

fn commands() -> Vec<Command> {
    vec![
        Command::Identify,
        Command::Get(17),
        Command::Set(35, 12.0),
        Command::Save,
        Command::Reload,
        Command::Defaults,
        Command::Restart,
        Command::Discard,
        Command::Prepare(35, 12.0),
        Command::Commit,
        Command::Arm,
        Command::Disarm,
        Command::Describe(35),
    ]
}

#[test]
fn every_command_answer_and_health_comes_back_as_it_was() {
    let answers = [
        Answer::Identity(identity()),
        Answer::Value(16, -2.5e-7),
        Answer::Done,
        describe(33).unwrap(),
    ];
    let refused = Refusal::ALL.map(|reason| Answer::Refused(reason, 17));
    let health = Health {
        time_us: 1 << 45,
        samples: 1,
        dropped: 2,
        overruns: 3,
        missed: 4,
        garbled: 5,
        period: Range {
            min: 6,
            mean: 7,
            max: 8,
        },
        step: Range {
            min: 9,
            mean: 10,
            max: 11,
        },
        task: Range {
            min: 12,
            mean: 13,
            max: u32::MAX,
        },
        stack_free: 100_000,
        faults: Faults::NONE.with(Fault::EstimatorSuspect),
        concerns: Some(Key::EstimatorHalfWidth),
        clock_fallback: true,
        response: Range {
            min: 14,
            mean: 15,
            max: 16,
        },
        armed: true,
        latched: Faults::NONE.with(Fault::Overrun),
        history: History {
            reset: ResetCause::Watchdog,
            crash: Some(Crash {
                kind: CrashKind::HardFault,
                stage: Stage::Estimate,
                at: 0x0800_1234,
                from: 0x0800_4321,
            }),
        },
    };
    let replies = answers.into_iter().chain(refused);
    let frames = replies
        .map(|answer| Frame::Reply(Reply { to: 513, answer }))
        .chain(commands().into_iter().map(Frame::Command))
        .chain([Frame::Health(health)]);
    for frame in frames {
        let mut decoder = crate::board::frame::Decoder::new();
        let bytes = encoded(&frame, 77);
        let found: Vec<_> = bytes
            .iter()
            .filter_map(|byte| decoder.push(*byte))
            .collect();
        assert_eq!(found, [Ok((77, frame))]);
    }
}

/// Health as a firmware of before sent it: without what came later.
#[test]
fn health_of_an_older_firmware_is_read_and_says_nothing_of_what_it_does_not_know() {
    let health = Health {
        samples: 7,
        clock_fallback: true,
        ..Health::default()
    };
    let mut body = crate::board::wire::Writer::new();
    health.put(&mut body);
    let older = &body.written()[..72];
    let read = Health::take(&mut crate::board::wire::Reader::new(older));
    assert_eq!(read, Ok(health));
    let cut = &body.written()[..73];
    assert!(Health::take(&mut crate::board::wire::Reader::new(cut)).is_err());
}

#[test]
fn the_board_describes_every_setting_in_the_order_of_their_numbers() {
    let mut responder = responder();
    let (mut from, mut described) = (0, Vec::new());
    while let Answer::Description(next) = ask(&mut responder, Command::Describe(from)) {
        let info = Key::from_id(next.id).unwrap().info();
        assert_eq!(
            (next.name.as_str(), next.unit.as_str()),
            (info.name, info.unit)
        );
        assert_eq!((next.bounds, next.default), (info.bounds, info.default));
        assert_eq!(next.restarts, info.restarts);
        described.push(next.id);
        let Some(after) = next.id.checked_add(1) else {
            break;
        };
        from = after;
    }
    assert!(described.is_sorted());
    assert_eq!(described.len(), Key::ALL.len());
    assert!(matches!(
        ask(&mut responder, Command::Describe(from)),
        Answer::Refused(Refusal::UnknownSetting, _) | Answer::Description(_)
    ));
}

/// A responder that renders up to 5 N.
fn rendering() -> Responder<CutFlash> {
    let mut responder = responder();
    for (key, value) in [(Key::RenderDeviceNsPerM, 5.0), (Key::RenderForceN, 5.0)] {
        let answer = ask(&mut responder, Command::Set(key.id(), value));
        assert_eq!(answer, Answer::Value(key.id(), value));
    }
    responder
}

#[test]
fn nothing_is_armed_but_by_a_command_and_whatever_restarts_or_stalls_disarms() {
    let mut fresh = responder();
    let nothing = Answer::Refused(Refusal::NotRendering, Key::RenderForceN.id());
    assert_eq!(ask(&mut fresh, Command::Arm), nothing);
    for command in [
        Command::Disarm,
        Command::Save,
        Command::Reload,
        Command::Defaults,
        Command::Restart,
    ] {
        let mut responder = rendering();
        assert_eq!(responder.setup().unwrap().arming, 0);
        let armed = responder.answer(1, Command::Arm, false, false);
        assert_eq!(armed.change.unwrap().setup.arming, 1);
        // The sampling task learns of it with the answer.
        let done = responder.answer(2, command, false, false);
        assert_eq!(done.reply.answer, Answer::Done);
        assert_eq!(done.change.unwrap().setup.arming, 0, "{command:?}");
    }
    let mut responder = rendering();
    assert_eq!(ask(&mut responder, Command::Arm), Answer::Done);
    assert_eq!(ask(&mut responder, Command::Arm), Answer::Done);
    assert_eq!(responder.setup().unwrap().arming, 2, "another number");
    // A fault under the arming before ends nothing: the sampling task has not heard of this one yet.
    let mut latch = Latch::default();
    let jumped = Faults::NONE.with(Fault::PositionJump);
    latch.update(1, jumped);
    responder.heed(&latch);
    assert_eq!(responder.setup().unwrap().arming, 2);
    latch.update(2, Faults::NONE);
    responder.heed(&latch);
    assert_eq!(responder.setup().unwrap().arming, 2);
    latch.update(2, jumped);
    responder.heed(&latch);
    assert_eq!(responder.setup().unwrap().arming, 0);
}

#[test]
fn a_command_of_a_later_version_is_refused_and_not_taken_for_another() {
    let mut responder = responder();
    let bytes = encoded(&Frame::Command(Command::Unknown(200)), 5);
    let got: Vec<_> = bytes.iter().filter_map(|b| responder.push(*b)).collect();
    assert_eq!(got, [(5, Command::Unknown(200))]);
    assert_eq!(
        ask(&mut responder, Command::Unknown(200)),
        Answer::Refused(Refusal::UnknownCommand, 0)
    );
}

#[test]
fn no_flipped_bits_make_a_command_and_the_next_one_is_understood() {
    let next = encoded(&Frame::Command(Command::Identify), 9);
    for command in commands() {
        let good = encoded(&Frame::Command(command), 8);
        let bits = 8 * good.len();
        // Every bit, and every pair of bits.
        for first in 0..bits {
            for second in first..bits {
                let mut bad = good.clone();
                bad[first / 8] ^= 1 << (first % 8);
                if second != first {
                    bad[second / 8] ^= 1 << (second % 8);
                }
                let stream = [&bad[..], &[0], &next[..]].concat();
                let mut responder = responder();
                let got: Vec<_> = stream.iter().filter_map(|b| responder.push(*b)).collect();
                // A last zero that is broken is made up for by the one after it.
                let whole = bad[..bad.len() - 1] == good[..good.len() - 1];
                let expected: &[_] = match whole {
                    true => &[(8, command), (9, Command::Identify)],
                    false => &[(9, Command::Identify)],
                };
                if got != expected {
                    // The closing zero and one bit before it: a longer frame, refused as a whole.
                    assert_eq!(got, [(9, Command::Identify)], "bits {first}, {second}");
                }
            }
        }
    }
}

#[test]
fn a_setting_is_read_changed_saved_reloaded_and_set_back() {
    let mut responder = responder();
    let id = Key::EstimatorHalfWidth.id();
    assert_eq!(
        ask(&mut responder, Command::Get(id)),
        Answer::Value(id, 8.0)
    );
    assert_eq!(
        ask(&mut responder, Command::Set(id, 12.0)),
        Answer::Value(id, 12.0)
    );
    let unsaved = |responder: &mut Responder<CutFlash>| match ask(responder, Command::Identify) {
        Answer::Identity(identity) => identity.unsaved,
        other => panic!("{other:?}"),
    };
    assert!(unsaved(&mut responder));
    assert_eq!(ask(&mut responder, Command::Save), Answer::Done);
    assert!(!unsaved(&mut responder));
    assert_eq!(
        ask(&mut responder, Command::Set(id, 20.0)),
        Answer::Value(id, 20.0)
    );
    assert_eq!(ask(&mut responder, Command::Reload), Answer::Done);
    assert_eq!(
        ask(&mut responder, Command::Get(id)),
        Answer::Value(id, 12.0)
    );
    assert_eq!(ask(&mut responder, Command::Defaults), Answer::Done);
    assert_eq!(
        ask(&mut responder, Command::Get(id)),
        Answer::Value(id, 8.0)
    );
    assert!(unsaved(&mut responder));
}

/// Conditions × commands: what is refused, and why.
#[test]
fn what_is_refused_is_refused_for_its_reason_and_changes_nothing() {
    let half_width = Key::EstimatorHalfWidth.id();
    let every = Key::TelemetryEvery.id();
    let table = [
        (
            Command::Get(200),
            false,
            false,
            (Refusal::UnknownSetting, 200),
        ),
        (
            Command::Set(200, 1.0),
            false,
            false,
            (Refusal::UnknownSetting, 200),
        ),
        (
            Command::Set(half_width, 1.0),
            false,
            false,
            (Refusal::Unusable, half_width),
        ),
        (
            Command::Set(half_width, f32::NAN),
            false,
            false,
            (Refusal::Unusable, half_width),
        ),
        (
            Command::Set(every, 0.0),
            true,
            false,
            (Refusal::Unusable, every),
        ),
        (
            Command::Set(half_width, 9.0),
            true,
            false,
            (Refusal::InContact, half_width),
        ),
        (
            Command::Set(half_width, 9.0),
            false,
            true,
            (Refusal::Busy, half_width),
        ),
        (Command::Save, true, false, (Refusal::InContact, 0)),
        (Command::Reload, true, false, (Refusal::InContact, 0)),
        (Command::Defaults, true, false, (Refusal::InContact, 0)),
        (Command::Restart, false, true, (Refusal::Busy, 0)),
    ];
    for (command, in_contact, busy, (reason, id)) in table {
        let mut responder = responder();
        let before = *responder.settings();
        let answered = responder.answer(3, command, in_contact, busy);
        assert_eq!(answered.reply.to, 3);
        assert_eq!(
            answered.reply.answer,
            Answer::Refused(reason, id),
            "{command:?}"
        );
        assert_eq!(answered.change, None);
        assert_eq!(*responder.settings(), before);
    }
    // In contact, a restart is how a zero that has crept is got rid of.
    let answered = responder().answer(3, Command::Restart, true, false);
    assert!(answered.change.is_some_and(|change| change.restart));
    // And telemetry may be changed, and nothing restarts.
    let answered = responder().answer(3, Command::Set(every, 10.0), true, false);
    assert!(
        answered
            .change
            .is_some_and(|change| !change.restart && change.setup.every == 10)
    );
}

#[test]
fn what_was_prepared_comes_into_force_as_a_whole_or_not_at_all() {
    let friction = |parameter: &str| {
        let name = std::format!("compensation.coulomb_friction.{parameter}");
        Key::from_name(&name).unwrap().id()
    };
    let (force, width) = (friction("force"), friction("width"));
    let mut responder = responder();
    let before = *responder.settings();
    // GIVEN a width without a force, which is no friction
    let prepare = |id, value| Command::Prepare(id, value);
    assert_eq!(
        ask(&mut responder, prepare(width, 1e-5)),
        Answer::Value(width, 1e-5)
    );
    // WHEN it is to come into force, THEN it is refused by name and nothing has changed
    assert_eq!(
        ask(&mut responder, Command::Commit),
        Answer::Refused(Refusal::Unusable, force)
    );
    assert_eq!(*responder.settings(), before);
    // WHEN the force comes too, THEN it is refused in contact and while the board is busy
    ask(&mut responder, prepare(force, 0.4));
    let refused = |responder: &mut Responder<CutFlash>, in_contact, busy| {
        let answered = responder.answer(1, Command::Commit, in_contact, busy);
        assert_eq!(answered.change, None);
        answered.reply.answer
    };
    assert_eq!(
        refused(&mut responder, true, false),
        Answer::Refused(Refusal::InContact, force)
    );
    assert_eq!(
        refused(&mut responder, false, true),
        Answer::Refused(Refusal::Busy, 0)
    );
    assert_eq!(*responder.settings(), before);
    // AND in free air both come into force with one restart
    let answered = responder.answer(1, Command::Commit, false, false);
    let change = answered.change.unwrap();
    assert_eq!(answered.reply.answer, Answer::Done);
    assert!(change.restart && change.setup.compensation.is_some());
    // AND a second attempt, whose first answer was lost, changes nothing
    let answered = responder.answer(1, Command::Commit, false, false);
    assert_eq!(
        (answered.reply.answer, answered.change),
        (Answer::Done, None)
    );
    assert_eq!(
        ask(&mut responder, Command::Get(width)),
        Answer::Value(width, 1e-5)
    );
}

#[test]
fn what_an_earlier_host_prepared_can_be_discarded_and_never_slips_in() {
    let width = Key::EstimatorHalfWidth.id();
    for forgotten in [
        Command::Discard,
        Command::Set(Key::TelemetryEvery.id(), 2.0),
        Command::Reload,
        Command::Defaults,
    ] {
        let mut responder = responder();
        ask(&mut responder, Command::Prepare(width, 12.0));
        ask(&mut responder, forgotten);
        assert_eq!(ask(&mut responder, Command::Commit), Answer::Done);
        assert_eq!(
            ask(&mut responder, Command::Get(width)),
            Answer::Value(width, 8.0),
            "{forgotten:?}"
        );
    }
    assert_eq!(
        ask(&mut responder(), Command::Prepare(200, 1.0)),
        Answer::Refused(Refusal::UnknownSetting, 200)
    );
    // Telemetry alone may change in contact, and nothing restarts.
    let mut responder = responder();
    ask(
        &mut responder,
        Command::Prepare(Key::TelemetryEvery.id(), 5.0),
    );
    let answered = responder.answer(1, Command::Commit, true, false);
    assert!(answered.change.is_some_and(|change| !change.restart));
}

#[test]
fn a_flash_that_fails_is_said() {
    let mut responder = Responder::new(store(1), identity());
    assert_eq!(
        ask(&mut responder, Command::Save),
        Answer::Refused(Refusal::FlashFailed, 0)
    );
}

#[test]
fn settings_that_cannot_be_used_stand_as_a_fault_until_new_ones_are_saved() {
    // GIVEN flash whose only record holds a half-width of 77
    let mut store = store(u64::MAX);
    let mut bad = crate::board::settings::Settings::default();
    bad.put(Key::EstimatorHalfWidth, 77.0);
    store.save(&bad).unwrap();
    // WHEN the board starts
    let mut responder = Responder::new(store, identity());
    // THEN it runs on defaults, and every sample says so
    let sample = |setup: &crate::board::settings::Setup| {
        let codes = crate::board::sensing::Codes::default();
        setup.conversion.sample(&mut Default::default(), &codes)
    };
    assert_eq!(responder.concerns(), Some(Key::EstimatorHalfWidth));
    assert!(
        sample(&responder.setup().unwrap())
            .faults
            .has(Fault::SettingsInvalid)
    );
    assert_eq!(
        ask(&mut responder, Command::Reload),
        Answer::Refused(Refusal::SavedUnusable, Key::EstimatorHalfWidth.id())
    );
    // and the fault ends with the first save
    let answered = responder.answer(1, Command::Save, false, false);
    let change = answered.change.unwrap();
    assert!(!sample(&change.setup).faults.has(Fault::SettingsInvalid));
    assert_eq!(responder.concerns(), None);
}

#[test]
fn names_are_cut_and_never_break() {
    assert_eq!(Name::new("netduinoplus2-and-more").as_str(), "netduinoplus");
    assert_eq!(Name::new("a b\u{e4}").as_str(), "ab");
    assert_eq!(Text::<12>([0xff; 12]).as_str(), "?");
}

#[test]
fn garbage_is_counted_and_a_frame_that_is_no_command_too() {
    let mut responder = responder();
    for byte in [7, 7, 7, 0] {
        assert_eq!(responder.push(byte), None);
    }
    for byte in encoded(&Frame::Sample(Default::default()), 1) {
        assert_eq!(responder.push(byte), None);
    }
    assert_eq!(responder.garbled(), 2);
    let _ = FrameError::Content;
}

fn impedance(time_us: u64, stiffness: f32) -> Packet {
    let params = crate::Config::default().validate::<f32>().unwrap();
    let mut estimate = crate::step(&params, &mut crate::State::new(&params), Default::default());
    let values = [stiffness, 36.0, 1.35, 2e-4];
    for (slot, value) in estimate.parameters.iter_mut().zip(values) {
        *slot = Some(crate::estimate::Estimated {
            value,
            std_error: 0.01,
        });
    }
    estimate.time_us = time_us;
    Packet::of(&estimate, 1e-3, time_us as u16)
}

/// What a master is set to.
fn master() -> Responder<CutFlash> {
    let mut responder = responder();
    for (key, value) in [(Key::RenderForceN, 5.0), (Key::RenderDeviceNsPerM, 5.0)] {
        ask(&mut responder, Command::Prepare(key.id(), value));
    }
    let answered = responder.answer(1, Command::Commit, true, false);
    // In contact, and the estimator goes on.
    assert!(answered.change.is_some_and(|change| !change.restart));
    let unarmed = Answer::Refused(Refusal::NotArmed, 0);
    let packet = Command::Reflect(impedance(5_000_000, 1350.0));
    assert_eq!(ask(&mut responder, packet), unarmed);
    assert_eq!(ask(&mut responder, Command::Arm), Answer::Done);
    responder
}

#[test]
fn the_frame_that_a_slave_sends_is_a_command_to_a_master() {
    let packet = impedance(5_000_000, 1350.0);
    for frame in [
        Frame::Reflection(packet),
        Frame::Command(Command::Reflect(packet)),
    ] {
        let mut responder = master();
        let bytes = encoded(&frame, 11);
        let got: Vec<_> = bytes.iter().filter_map(|b| responder.push(*b)).collect();
        assert_eq!(got, [(11, Command::Reflect(packet))]);
        let answered = responder.answer(11, Command::Reflect(packet), true, true);
        assert_eq!(
            answered.reply,
            Reply {
                to: 11,
                answer: Answer::Done
            }
        );
        assert_eq!((answered.packet, answered.change), (Some(packet), None));
        assert_eq!(responder.garbled(), 0);
    }
}

#[test]
fn an_impedance_that_is_not_rendered_is_refused_for_its_reason() {
    let refused = |responder: &mut Responder<CutFlash>, packet| {
        let answered = responder.answer(1, Command::Reflect(packet), false, false);
        assert_eq!(answered.packet, None);
        answered.reply.answer
    };
    let good = impedance(5_000_000, 1350.0);
    let off = Answer::Refused(Refusal::NotRendering, Key::RenderForceN.id());
    assert_eq!(refused(&mut responder(), good), off);
    let mut responder = master();
    let none = Answer::Refused(Refusal::NotRenderable, 0);
    assert_eq!(refused(&mut responder, impedance(5_000_000, -1.0)), none);
    assert_eq!(
        refused(&mut responder, impedance(5_000_000, f32::NAN)),
        none
    );
    assert_eq!(ask(&mut responder, Command::Reflect(good)), Answer::Done);
    // The same again, since the answer was lost: done, and not taken twice.
    assert_eq!(refused(&mut responder, good), Answer::Done);
    let late = Answer::Refused(Refusal::Overtaken, 0);
    assert_eq!(refused(&mut responder, impedance(4_999_000, 1350.0)), late);
    // A slave that was switched off and on.
    let again = Command::Reflect(impedance(3000, 1350.0));
    assert!(responder.answer(1, again, false, false).packet.is_some());
}

#[test]
fn a_master_without_its_own_damping_or_with_more_force_than_its_output_carries_is_none() {
    for (key, value, about) in [
        (Key::RenderForceN, 5.0, Key::RenderDeviceNsPerM),
        (Key::RenderForceN, 10.5, Key::RenderForceN),
    ] {
        assert_eq!(
            ask(&mut responder(), Command::Set(key.id(), value)),
            Answer::Refused(Refusal::Unusable, about.id())
        );
    }
    assert_eq!(
        crate::board::settings::Settings::default()
            .setup()
            .unwrap()
            .render,
        None
    );
}
