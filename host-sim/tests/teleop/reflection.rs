//! Impedance reflection between two boards: one identifies what it touches, the other renders it; and
//! boards whose firmware does not know of it.

use std::sync::{Arc, Mutex};

use crate::common::Folder;
use estimator_core::board::frame::Frame;
use estimator_core::board::link::{Answer, BYTES_PER_MS, Command, Refusal};
use estimator_core::board::reflection::{Impedance, Output, Packet, Speed};
use estimator_core::board::sampling::FULL;
use estimator_core::board::settings::{Key, Settings};
use estimator_core::physics::law::{ContactLaw, HuntCrossley};
use estimator_core::{Fault, Sample, Status};
use palpate::cli::config;
use palpate::link::port::Simulated;
use palpate::link::world::{Hand, World};
use palpate::link::{Device, Port, SimulatedBoard};

fn board(hand: Hand) -> SimulatedBoard {
    let mut world = World::default();
    world.hand = hand;
    SimulatedBoard::new(Arc::new(Mutex::new(world)), BYTES_PER_MS)
}

fn device(board: SimulatedBoard) -> Device<Simulated> {
    Device::new(Simulated::at_once(board))
}

fn set<P: Port>(device: &mut Device<P>, values: &[(Key, f32)]) {
    for (key, value) in values {
        device.prepare(*key, *value).unwrap();
    }
    device.order(Command::Commit).unwrap();
    if values.iter().any(|(key, _)| *key == Key::RenderForceN) {
        device.order(Command::Arm).unwrap();
    }
}

/// A board that sends packets at 200 Hz and everything else at 20 Hz: 74 of the 200 bytes that a millisecond
/// carries.
const SLAVE: [(Key, f32); 2] = [(Key::ReflectionEvery, 5.0), (Key::TelemetryEvery, 50.0)];

/// A handle with a damping of 100 N s/m, which allows 50 000 N/m and 250 N s/m: more than the gel has
/// anywhere.
const MASTER: [(Key, f32); 5] = [
    (Key::RenderForceN, 10.0),
    (Key::RenderDeviceNsPerM, 100.0),
    (Key::RenderTimeoutS, 10.0),
    (Key::RenderFadeS, 0.02),
    (Key::RenderSlewNps, 1e5),
];

/// The slave's packets until its estimate has converged.
fn packets<P: Port>(slave: &mut Device<P>) -> Vec<Packet> {
    let mut packets = Vec::new();
    loop {
        if let Some(Frame::Reflection(packet)) = slave.next_frame().unwrap() {
            packets.push(packet);
            if packet.status == Status::Converged && packets.len() > 400 {
                return packets;
            }
        }
    }
}

fn law(packet: &Packet) -> (HuntCrossley<f32>, f32) {
    let reflected = packet.reflected().unwrap().expect("all parameters");
    match reflected.impedance {
        Impedance::HuntCrossley(law) => (law, reflected.surface_m),
        other => panic!("{other:?}"),
    }
}

/// Asserts that what is rendered at every sample follows the law of `packet`, once that has come in.
fn renders_the_law<P: Port>(master: &mut Device<P>, packet: &Packet) {
    let (law, surface_m) = law(packet);
    let (mut speed, mut sample) = (Speed::default(), Sample::default());
    let (mut seen, mut pushed) = (0, 0);
    while seen < 2000 {
        match master.next_frame().unwrap() {
            Some(Frame::Sample(next)) => sample = next,
            Some(Frame::Rendered(rendered)) => {
                assert_eq!(rendered.time_us, sample.time_us);
                let speed_mps = speed.update(sample.time_us, sample.position_m);
                // 20 ms of coming in, and of a speed whose history was not seen: (2/3)²⁰⁰.
                seen += u32::from(rendered.sequence == packet.sequence);
                if seen > 200 {
                    let depth_m = sample.position_m - surface_m;
                    let own_n = law.force_n(depth_m, speed_mps).max(0.0);
                    let error_n = (rendered.force_n - own_n).abs();
                    assert!(error_n <= 2e-6 * own_n, "{rendered:?}: {own_n}");
                    assert_eq!((rendered.limits, rendered.faults), (0, Default::default()));
                    pushed += u32::from(own_n > 1.0);
                }
            }
            Some(_) | None => {}
        }
    }
    assert!(pushed > 500, "{pushed}");
}

#[test]
fn a_slave_sends_what_it_identifies_at_the_set_rate_and_the_drops_are_none() {
    let mut slave = device(board(Hand::Palpating));
    set(&mut slave, &SLAVE);
    let packets = packets(&mut slave);
    for pair in packets.windows(2) {
        assert_eq!(pair[1].sequence, pair[0].sequence.wrapping_add(1));
        assert_eq!(pair[1].time_us - pair[0].time_us, 5000);
    }
    let (law, surface_m) = law(packets.last().unwrap());
    // The scale of an uncalibrated cell is 3 % off.
    assert!(
        (law.stiffness_n_per_m * 1.03 / 1350.0 - 1.0).abs() < 0.02,
        "{law:?}"
    );
    assert!((law.exponent / 1.35 - 1.0).abs() < 0.02, "{law:?}");
    assert!(surface_m.abs() < 2e-5, "{surface_m}");
    assert_eq!(slave.port().board().counts().1, 0);
    assert_eq!(slave.statistics().garbled, 0);
}

#[test]
fn packets_that_the_line_cannot_carry_are_counted_as_dropped() {
    // 921 600 baud; a packet at every sample alone takes 72 bytes of the 92, estimates the rest.
    let mut world = World::default();
    world.hand = Hand::Palpating;
    let board = SimulatedBoard::new(Arc::new(Mutex::new(world)), 92);
    let mut slave = device(board);
    set(
        &mut slave,
        &[(Key::ReflectionEvery, 1.0), (Key::TelemetryEvery, 2.0)],
    );
    let (mut numbers, mut lost) = (Vec::new(), 0_u32);
    while numbers.len() < 3000 {
        if let Some(Frame::Reflection(packet)) = slave.next_frame().unwrap() {
            if let Some(last) = numbers.last() {
                lost += u32::from(packet.sequence.wrapping_sub(*last)) - 1;
            }
            numbers.push(packet.sequence);
        }
    }
    assert_eq!(slave.statistics().lost, 0, "what was sent has come");
    let dropped = slave.port().board().counts().1;
    // Those that found the queue full after the last that came.
    assert!(
        lost > 500 && (lost..lost + 200).contains(&dropped),
        "{lost} {dropped}"
    );
}

#[test]
fn a_master_renders_the_same_law_and_its_output_is_that_force_to_a_code() {
    let mut slave = device(board(Hand::Palpating));
    set(&mut slave, &SLAVE);
    let told = *packets(&mut slave).last().unwrap();
    let mut master = device(board(Hand::Palpating));
    set(&mut master, &MASTER);
    assert_eq!(master.port().board().force_code(), 0);
    assert_eq!(master.ask(Command::Reflect(told)).unwrap(), Answer::Done);
    renders_the_law(&mut master, &told);
    // A hand that holds 2 mm deep: the output has the code of a force that does not change.
    let held = Hand::Holding {
        position_m: 2e-3,
        force_n: 0.0,
    };
    let mut master = device(board(held));
    set(&mut master, &MASTER);
    assert_eq!(master.ask(Command::Reflect(told)).unwrap(), Answer::Done);
    let mut rendered = Vec::new();
    while rendered.len() < 500 {
        if let Some(Frame::Rendered(next)) = master.next_frame().unwrap() {
            rendered.push(next.force_n);
        }
    }
    let force_n = rendered[499];
    assert!(force_n > 3.0 && force_n == rendered[250], "{force_n}");
    let output = Output {
        zero: 0.0,
        full_n: 10.0,
    };
    let code = master.port().board().force_code();
    assert_eq!(code, output.code(force_n, FULL));
    // A code is 3.8 mN of 10 N.
    assert!((f32::from(code) * 10.0 / f32::from(FULL) - force_n).abs() < 1.95e-3);
}

#[test]
fn what_a_master_is_told_before_it_is_set_up_or_late_is_refused_for_its_reason() {
    let mut slave = device(board(Hand::Palpating));
    set(&mut slave, &SLAVE);
    let packets = packets(&mut slave);
    let (earlier, later) = (packets[packets.len() - 2], packets[packets.len() - 1]);
    let mut master = device(board(Hand::Palpating));
    let error = master
        .order(Command::Reflect(later))
        .unwrap_err()
        .to_string();
    assert!(error.contains("render.force_n"), "{error}");
    set(&mut master, &MASTER);
    assert_eq!(master.ask(Command::Reflect(later)).unwrap(), Answer::Done);
    assert_eq!(
        master.ask(Command::Reflect(earlier)).unwrap(),
        Answer::Refused(Refusal::Overtaken, 0)
    );
}

#[test]
fn when_the_channel_breaks_the_force_fades_out_and_health_says_so() {
    let mut slave = device(board(Hand::Palpating));
    set(&mut slave, &SLAVE);
    let told = *packets(&mut slave).last().unwrap();
    // A hand that holds 2 mm deep.
    let held = Hand::Holding {
        position_m: 2e-3,
        force_n: 0.0,
    };
    let mut master = device(board(held));
    set(
        &mut master,
        &[&MASTER[..], &[(Key::RenderTimeoutS, 0.2)]].concat(),
    );
    assert_eq!(master.ask(Command::Reflect(told)).unwrap(), Answer::Done);
    let (mut most_n, mut last_n) = (0.0_f32, 0.0);
    loop {
        match master.next_frame().unwrap() {
            Some(Frame::Rendered(rendered)) => {
                most_n = most_n.max(rendered.force_n);
                last_n = rendered.force_n;
            }
            Some(Frame::Health(health)) if health.faults.has(Fault::RenderStopped) => break,
            Some(_) | None => {}
        }
    }
    assert!(most_n > 3.0, "{most_n}");
    assert_eq!((last_n, master.port().board().force_code()), (0.0, 0));
}

#[test]
fn the_monitor_shows_both_sides_and_a_recording_has_its_log() {
    let folder = Folder::new();
    let mut slave = device(board(Hand::Palpating));
    set(&mut slave, &[(Key::ReflectionEvery, 5.0)]);
    set(&mut slave, &MASTER);
    let told = packets(&mut slave);
    slave.ask(Command::Reflect(*told.last().unwrap())).unwrap();
    let out = folder.path("run");
    let statistics = palpate::link::record::record(&mut slave, &out, Some(2_000_000)).unwrap();
    assert_eq!((statistics.lost, statistics.garbled), (0, 0));
    let said = palpate::link::record::convert(&out, palpate::kind::Kind::Linear).unwrap();
    assert!(
        said.contains("0 samples missing") && said.contains("0 frames garbled"),
        "{said}"
    );
    let args = palpate::cli::monitor::MonitorArgs {
        every: 0.5,
        looks: Some(3),
        ..Default::default()
    };
    let mut text = String::new();
    palpate::cli::monitor::watch(slave, &args, |shown| {
        text.push_str(&shown);
        Ok(())
    })
    .unwrap();
    for word in ["reflects   200 Hz", "renders  "] {
        assert!(text.contains(word), "no {word} in {text}");
    }
}

/// Settings that older firmware does not know.
fn newer() -> [Vec<Key>; 2] {
    let all = || Key::ALL.into_iter();
    let effects =
        all().filter(|key| matches!(key, Key::Compensation(of) if of.effect().is_for_boards()));
    let teleoperation = all().filter(|key| {
        let name = key.info().name;
        name.starts_with("reflection.") || name.starts_with("render.")
    });
    let teleoperation: Vec<Key> = teleoperation.collect();
    assert_eq!(teleoperation.len(), 9);
    [
        teleoperation.clone(),
        effects.chain(teleoperation).collect(),
    ]
}

#[test]
fn settings_of_an_older_firmware_are_read_and_what_it_lacks_is_said() {
    for unknown in newer() {
        let mut old = device(board(Hand::Palpating).without(&unknown));
        set(&mut old, &[(Key::TelemetryEvery, 3.0)]);
        let (settings, missing) = old.known_settings().unwrap();
        assert_eq!(missing, unknown);
        let mut expected = Settings::default();
        expected.put(Key::TelemetryEvery, 3.0);
        assert_eq!(settings, expected);
        let said = config::show(&mut old).unwrap();
        assert!(said.contains("telemetry.every          3 "), "{said}");
        assert!(
            said.contains("not known to this firmware: reflection.every\n"),
            "{said}"
        );
        assert!(
            said.contains("firmware: render.force_n, render.full_n, "),
            "{said}"
        );
        let effects = said.contains("not known to this firmware: compensation.*\n");
        assert_eq!(effects, unknown.len() > 9, "{said}");
        assert!(!said.contains("\nrender."), "{said}");
        let error = old.get(Key::RenderForceN).unwrap_err().to_string();
        assert!(
            error.contains("render.force_n") && error.contains("older"),
            "{error}"
        );
    }
}

#[test]
fn a_backup_of_an_older_firmware_is_restored_onto_a_newer_one_and_the_other_way_round() {
    for unknown in newer() {
        let folder = Folder::new();
        let path = |name| folder.path(name);
        let (old_file, new_file, later_file) =
            (path("old.toml"), path("new.toml"), path("later.toml"));
        let old_board = || device(board(Hand::Palpating).without(&unknown));
        // GIVEN what an older firmware's settings are
        let mut old = old_board();
        let said = (0..100).find_map(|_| {
            device_set_in_free_air(&mut old, Key::EstimatorHalfWidth, 12.0)?;
            config::keep(&mut old, &old_file).ok()
        });
        assert!(said.expect("free air").contains("not known"));
        let text = folder.read("old.toml");
        assert!(
            text.contains("half_width = 12") && !text.contains("render"),
            "{text}"
        );
        // WHEN they are restored onto a newer one that renders
        let mut new = device(board(Hand::Palpating));
        set(&mut new, &MASTER);
        let said = (0..100).find_map(|_| config::restored(&mut new, &old_file).ok());
        // THEN it has them, and what it had besides
        assert!(said.expect("free air").contains("1 changed, saved"));
        assert_eq!(new.get(Key::EstimatorHalfWidth).unwrap(), 12.0);
        assert_eq!(new.get(Key::RenderForceN).unwrap(), 10.0);
        // AND back onto the older one what both know, while the rest is at its defaults
        for (key, _) in MASTER {
            new.prepare(key, key.info().default).unwrap();
        }
        new.order(Command::Commit).unwrap();
        config::keep(&mut new, &new_file).unwrap();
        let mut old = old_board();
        let said = (0..100).find_map(|_| config::restored(&mut old, &new_file).ok());
        assert!(said.expect("free air").contains("1 changed, saved"));
        // AND what the older one cannot do is refused by its name, as a whole
        set(&mut new, &MASTER);
        config::keep(&mut new, &later_file).unwrap();
        let error = config::restored(&mut old, &later_file)
            .unwrap_err()
            .to_string();
        assert!(
            error.contains("render.force_n") && error.contains("older"),
            "{error}"
        );
    }
}

/// The hand touches once a second.
fn device_set_in_free_air(device: &mut Device<Simulated>, key: Key, value: f32) -> Option<()> {
    device.set(key, value).ok()
}

/// Two serial devices of the system: pseudo-terminals with a board at the other end of each.
#[cfg(unix)]
#[test]
fn one_boards_packets_are_rendered_by_another_over_two_pseudo_terminals() {
    use palpate::link::port::Serial;
    use serialport::{SerialPort, TTYPort};
    use std::sync::atomic::{AtomicBool, Ordering};
    let stop = Arc::new(AtomicBool::new(false));
    let connect = || {
        let (own, other) = TTYPort::pair().unwrap();
        let name = other.name().unwrap();
        // It holds a lock on the port.
        drop(other);
        let running = crate::terminal_end::serve(own, board(Hand::Palpating), Arc::clone(&stop));
        (Device::new(Serial::open(&name).unwrap()), running)
    };
    let ((mut slave, slave_runs), (mut master, master_runs)) = (connect(), connect());
    set(&mut slave, &SLAVE);
    set(&mut master, &MASTER);
    // Every packet is passed on as it comes, as a gateway would.
    let (mut told, mut passed) = (None, 0);
    while passed < 100 {
        if let Some(Frame::Reflection(packet)) = slave.next_frame().unwrap() {
            if packet.reflected().unwrap().is_none() {
                continue;
            }
            let answer = master.ask(Command::Reflect(packet)).unwrap();
            assert_eq!(answer, Answer::Done);
            (told, passed) = (Some(packet), passed + 1);
        }
    }
    renders_the_law(&mut master, &told.unwrap());
    assert_eq!(slave.statistics().garbled, 0);
    assert_eq!(master.statistics().garbled, 0);
    stop.store(true, Ordering::Relaxed);
    drop((slave, master));
    for running in [slave_runs, master_runs] {
        assert_eq!(running.join().unwrap().counts().1, 0, "nothing was dropped");
    }
}
