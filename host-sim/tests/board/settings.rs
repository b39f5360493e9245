//! Settings go to the board and come back; in contact it refuses what would disturb it.

use crate::{HELD, device, world};
use estimator_core::board::history::{Crash, CrashKind, History, ResetCause, Stage};
use estimator_core::board::link::{Answer, BYTES_PER_MS, Command, Description, Refusal, Text};
use estimator_core::board::reflection::Packet;
use estimator_core::board::settings::{Bounds, Key, Settings};
use estimator_core::estimate::Estimated;
use estimator_core::{Config, Fault, Faults, Params, Sample, State, step};
use palpate::cli::config;
use palpate::link::port::Simulated;
use palpate::link::world::Hand;
use palpate::link::{Device, SimulatedBoard};

#[test]
fn settings_go_to_the_board_are_saved_and_come_back() {
    let mut device = device(&world(HELD), BYTES_PER_MS);
    assert_eq!(device.identity().unwrap().board.as_str(), "simulated");
    assert_eq!(device.settings().unwrap(), Settings::default());
    device.set(Key::EstimatorDepthM, 0.002).unwrap();
    device.order(Command::Save).unwrap();
    device.set(Key::EstimatorDepthM, 0.005).unwrap();
    assert!(device.identity().unwrap().unsaved);
    device.order(Command::Reload).unwrap();
    assert_eq!(device.get(Key::EstimatorDepthM).unwrap(), 0.002);
    let error = device
        .set(Key::EstimatorDepthM, -1.0)
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("estimator.depth_m") && error.contains("-1"),
        "{error}"
    );
    assert_eq!(device.get(Key::EstimatorDepthM).unwrap(), 0.002);
}

#[test]
fn in_contact_the_board_refuses_what_would_disturb_it_and_takes_the_rest() {
    let mut device = device(&world(Hand::Palpating), BYTES_PER_MS);
    let (mut refused, mut done) = (0, 0);
    // A question is answered 10 ms later: three seconds, of them two strokes.
    for _ in 0..300 {
        match device.ask(Command::Save).unwrap() {
            Answer::Done => done += 1,
            Answer::Refused(Refusal::InContact, 0) => refused += 1,
            other => panic!("{other:?}"),
        }
        device.set(Key::TelemetryEvery, 1.0).unwrap();
    }
    assert!(done > 10 && refused > 10, "{done} done, {refused} refused");
}

/// A board whose firmware is newer than this host: it has a setting of which the host knows nothing. THEN the host
/// shows its name, unit, value and bounds, and sets it by name.
#[test]
fn a_setting_that_only_the_board_knows_is_shown_as_the_board_describes_it() {
    let setting = Description {
        id: 255,
        name: Text::new("force.later_than_this"),
        unit: Text::spaced("N s/m"),
        bounds: Bounds::Within(0.5, 20.0),
        default: 2.5,
        restarts: false,
    };
    assert_eq!(Key::from_id(setting.id), None);
    let board = SimulatedBoard::new(world(HELD), BYTES_PER_MS).with(setting);
    let mut device = Device::new(Simulated::at_once(board));
    assert_eq!(device.newer_settings().unwrap(), [(setting, 2.5)]);
    let shown = config::show(&mut device).unwrap();
    let line = shown
        .lines()
        .find(|line| line.starts_with("force.later_than_this"))
        .expect("a line");
    assert!(
        line.contains("2.5 N s/m") && line.contains("from 0.5 to 20"),
        "{line}"
    );
    device.order(Command::Set(setting.id, 7.0)).unwrap();
    assert_eq!(device.newer_settings().unwrap()[0].1, 7.0);
    // A board of the same age has none.
    let mut same = self::device(&world(HELD), BYTES_PER_MS);
    assert_eq!(same.newer_settings().unwrap(), []);
}

/// WHEN the run before ended with a crash, THEN `config show` says so, with the cause of the reset.
#[test]
fn what_ended_the_run_before_is_shown_with_the_settings() {
    let history = History {
        reset: ResetCause::Watchdog,
        crash: Some(Crash {
            kind: CrashKind::Hang,
            stage: Stage::Save,
            at: 0,
            from: 0,
        }),
    };
    let board = SimulatedBoard::new(world(HELD), BYTES_PER_MS).after(history);
    let mut device = Device::new(Simulated::at_once(board));
    let shown = config::show(&mut device).unwrap();
    assert!(
        shown.ends_with(
            "last reset: watchdog\nthe run before it ended with a hang while saving settings\n"
        ),
        "{shown}"
    );
}

/// A board is never armed by its settings: WHEN they say that it renders, THEN it rests until it is armed, and a save
/// puts it to rest again.
#[test]
fn a_force_is_put_out_only_between_an_arming_and_the_next_save() {
    let mut device = device(&world(HELD), BYTES_PER_MS);
    let nothing = device.order(Command::Arm).unwrap_err().to_string();
    assert!(nothing.contains("render.force_n"), "{nothing}");
    for (key, value) in [(Key::RenderForceN, 5.0), (Key::RenderDeviceNsPerM, 5.0)] {
        device.prepare(key, value).unwrap();
    }
    device.order(Command::Commit).unwrap();
    assert!(!device.health().unwrap().unwrap().armed);
    device.order(Command::Arm).unwrap();
    assert!(device.health().unwrap().unwrap().armed);
    device.order(Command::Save).unwrap();
    assert!(!device.health().unwrap().unwrap().armed);
    device.order(Command::Arm).unwrap();
    device.order(Command::Disarm).unwrap();
    assert!(!device.health().unwrap().unwrap().armed);
}

/// GIVEN a master whose encoder jumped while it was armed, which holds the output at rest. WHEN it is armed once, THEN
/// it is armed, and takes a packet.
#[test]
fn one_arming_is_enough_after_a_fault_that_latched() {
    let world = world(HELD);
    let mut device = device(&world, BYTES_PER_MS);
    for (key, value) in [(Key::RenderForceN, 5.0), (Key::RenderDeviceNsPerM, 5.0)] {
        device.prepare(key, value).unwrap();
    }
    device.order(Command::Commit).unwrap();
    device.order(Command::Arm).unwrap();
    // 50 mm within a millisecond.
    world.lock().unwrap().hand = Hand::Holding {
        position_m: 0.05,
        force_n: 0.0,
    };
    let refused = Answer::Refused(Refusal::NotArmed, 0);
    let packet = Command::Reflect(packet());
    for _ in 0..3 {
        device.ask(Command::Identify).unwrap();
    }
    assert_eq!(device.ask(packet).unwrap(), refused);
    let latched = device.health().unwrap().unwrap();
    assert!(!latched.armed && latched.latched.has(Fault::PositionJump));
    device.order(Command::Arm).unwrap();
    assert_eq!(device.ask(packet).unwrap(), Answer::Done);
    let health = device.health().unwrap().unwrap();
    assert!(health.armed && health.latched == Faults::NONE, "{health:?}");
}

/// A packet with all parameters of gel.
fn packet() -> Packet {
    let params: Params<f32> = Config::default().validate().unwrap();
    let mut estimate = step(&params, &mut State::new(&params), Sample::default());
    for (slot, value) in estimate.parameters.iter_mut().zip([1350.0, 5.0, 1.35, 0.0]) {
        *slot = Some(Estimated {
            value,
            std_error: 0.01,
        });
    }
    Packet::of(&estimate, 1e-3, 1)
}

/// GIVEN a board that sends every thousandth record, in contact with a weight. WHEN it starts anew with the weight on
/// and finds free air there, THEN it saves at once, though the last record that it has sent was in contact.
#[test]
fn a_save_asks_for_the_contact_of_now_and_not_of_the_last_record_that_was_sent() {
    let world = world(HELD);
    let mut device = device(&world, BYTES_PER_MS);
    device.set(Key::TelemetryEvery, 1000.0).unwrap();
    device.health().unwrap();
    world.lock().unwrap().hand = Hand::Holding {
        position_m: 1e-3,
        force_n: 10.0,
    };
    // A question is answered 10 ms later.
    for _ in 0..20 {
        device.ask(Command::Identify).unwrap();
    }
    let in_contact = Answer::Refused(Refusal::InContact, 0);
    assert_eq!(device.ask(Command::Save).unwrap(), in_contact);
    device.order(Command::Restart).unwrap();
    for _ in 0..40 {
        device.ask(Command::Identify).unwrap();
    }
    assert_eq!(device.ask(Command::Save).unwrap(), Answer::Done);
}
