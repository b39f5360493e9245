//! Two emulated boards joined by the bridge of `palpate teleop` over loopback UDP: what one of them touches, the
//! other one renders. Each runs at its own virtual time; the bridge goes by the stamps of their samples, in lockstep.

use crate::fields::{assert_same, rendered_fields};
use crate::frames::codes;
use crate::settings::{changed, save};
use estimator_core::Sample;
use estimator_core::board::frame::{Decoder, Frame, MAX_ENCODED, encode};
use estimator_core::board::link::{Change, Command};
use estimator_core::board::reflection::Packet;
use estimator_core::board::sampling::{FULL, Sampler};
use estimator_core::board::settings::{Key, Setup};
use estimator_core::physics::law::{ContactLaw, HuntCrossley, unilateral};
use palpate::link::Device;
use palpate::link::port::{Files, Port};
use palpate::teleop::bridge::run::{MasterView, Wire, framed, give, packets};
use palpate::teleop::bridge::{Endpoint, Key as Secret, Role};
use palpate::teleop::held::Held;
use tests::emulator::{Emulator, Live, wait_until};
use tests::signal::palpation;
use tests::tolerance;

/// The gel is the first half of the palpation.
const SAMPLES: usize = 9_000;
/// Both get so many samples at a time.
const CHUNK: usize = 32;
/// Telemetry leaves the emulator in blocks of 4 KiB, of 111 bytes a sample: what is older has come.
const BLOCK_US: u64 = 96_000;
/// From here on the estimate has converged and arrived.
const KNOWN_US: u64 = 5_000_000;

/// The settings of the slave: 20 packets a second, as many as the emulator's command file takes.
fn slave() -> Emulator {
    let emulator = Emulator::from_env("joined-slave").expect("set-up");
    save(&emulator, &changed([(Key::ReflectionEvery, 50.0)]));
    emulator
}

const MASTER: [(Key, f32); 5] = [
    (Key::RenderForceN, 20.0),
    (Key::RenderFullN, 20.0),
    // What the gel's damping needs at 4.5 mm.
    (Key::RenderDeviceNsPerM, 120.0),
    (Key::RenderTimeoutS, 1.0),
    (Key::RenderSlewNps, 1e5),
];

fn master() -> Emulator {
    let emulator = Emulator::from_env("joined-master").expect("set-up");
    save(&emulator, &changed(MASTER));
    emulator
}

/// The time of the last sample that has come from a board (µs).
fn time_us(board: &mut Live) -> u64 {
    let frames = board.frames().expect("telemetry");
    let last = frames.iter().rev().find_map(|(_, frame)| match frame {
        Frame::Sample(sample) => Some(sample.time_us),
        _ => None,
    });
    last.unwrap_or(0)
}

fn command(command: Command) -> Vec<u8> {
    let mut bytes = [0; MAX_ENCODED];
    let length = encode(&Frame::Command(command), 0, &mut bytes);
    bytes[..length].to_vec()
}

fn packet_of(frame: &[u8]) -> Packet {
    let mut decoder = Decoder::new();
    match frame.iter().find_map(|byte| decoder.push(*byte)) {
        Some(Ok((_, Frame::Reflection(packet)))) => packet,
        other => panic!("{other:?}"),
    }
}

/// Runs both over the same motion, and gives what the master sent and the packets that it was given.
fn joined(touched: &[Sample<f32>]) -> (Vec<(u16, Frame)>, Vec<Packet>) {
    let (slave, master) = (slave(), master());
    let (mut at_slave, mut at_master) = (
        slave.start().expect("slave"),
        master.start().expect("master"),
    );
    let open = |of: &Emulator| Device::new(Files::open(&of.directory).expect("files"));
    let (mut from_slave, mut to_master) = (open(&slave), open(&master));
    let anywhere = "127.0.0.1:0".parse().expect("address");
    let mut listens = Wire::open(Some(anywhere), None).expect("socket");
    let address = listens.address().expect("address");
    let mut connects = Wire::open(None, Some(address)).expect("socket");
    let key = || Secret::new([7; 32]);
    let mut ends = [
        Endpoint::new(Role::Listen, key()),
        Endpoint::new(Role::Connect, key()),
    ];
    let (mut best, mut view, mut given) = (Held::default(), MasterView::default(), Vec::new());
    // The master's own cell touches nothing.
    let held = touched.iter().map(|sample| Sample {
        force_n: 0.0,
        ..*sample
    });
    let [touched, held] = [touched.to_vec(), held.collect()].map(|samples: Vec<_>| {
        let frames = codes(&samples).into_iter().map(Frame::Codes);
        frames.collect::<Vec<_>>()
    });
    to_master
        .port()
        .write(&command(Command::Arm))
        .expect("commands");
    for (step, (touch, hold)) in touched.chunks(CHUNK).zip(held.chunks(CHUNK)).enumerate() {
        at_slave.feed(touch).expect("slave");
        at_master.feed(hold).expect("master");
        let now_us = (1000 * CHUNK * (step + 1)) as u64;
        let come = |board: &mut Live| time_us(board) + BLOCK_US >= now_us;
        let both = || come(&mut at_slave) && come(&mut at_master);
        wait_until("both have come so far", both).expect("both run");
        for packet in packets(&mut from_slave, &mut best).expect("slave") {
            ends[0].send(now_us, &framed(&packet));
        }
        listens.exchange(&mut ends[0], now_us);
        for frame in connects.exchange(&mut ends[1], now_us) {
            given.push(packet_of(&frame));
            give(&mut to_master, &mut view, &frame).expect("master");
        }
    }
    at_slave.finish().expect("slave");
    let counts = ends[1].counts();
    assert_eq!((counts.strangers, counts.replayed, counts.late), (0, 0, 0));
    assert_eq!(counts.passed, view.given);
    (at_master.finish().expect("master"), given)
}

#[test]
fn the_master_renders_what_the_slave_touches_as_the_host_would_to_the_bit() {
    let mut touched = palpation(2 * SAMPLES, 4);
    touched.truncate(SAMPLES);
    let (sent, given) = joined(&touched);
    assert!(given.len() > 100, "{} packets", given.len());
    let setup = changed(MASTER).setup().expect("valid");
    let mut host = Sampler::new(setup);
    let gel = HuntCrossley::new(1350.0, 36.0, 1.35, 1e-3);
    let (mut read, mut armed, mut taken) = (None, false, 0);
    let (mut square, mut count, mut peak) = (0.0, 0, 0.0_f64);
    for (index, (_, frame)) in sent.iter().enumerate() {
        match frame {
            Frame::Codes(codes) => {
                // A sample that is not rendered still moves the host's renderer on.
                if let Some(read) = read.replace(host.convert(codes)) {
                    host.render(&read, false, FULL);
                }
            }
            Frame::Rendered(rendered) => {
                let sample = read.take().expect("codes come first");
                if !std::mem::replace(&mut armed, true) {
                    let setup = Setup { arming: 1, ..setup };
                    host.apply(&Change {
                        setup,
                        restart: false,
                    });
                }
                if rendered.sequence != taken {
                    taken = rendered.sequence;
                    let packet = given.iter().find(|packet| packet.sequence == taken);
                    host.take(packet.expect("one that was given"));
                }
                let (force, _) = host.render(&sample, false, FULL);
                assert_same(index, &force.expect("armed"), rendered, rendered_fields);
                let at = (sample.time_us / 1000) as usize - 1;
                if sample.time_us > KNOWN_US && at + 2 < touched.len() {
                    let position = |at: usize| f64::from(touched[at].position_m);
                    let speed = (position(at + 2) - position(at - 2)) / 4e-3;
                    let real = unilateral(gel.force_n(position(at), speed));
                    square += (f64::from(rendered.force_n) - real).powi(2);
                    (count, peak) = (count + 1, peak.max(real));
                }
            }
            _ => {}
        }
    }
    assert!(armed && count > 3000, "{count}");
    let share = (square / f64::from(count)).sqrt() / peak;
    println!(
        "felt minus true force: {:.2} % of {peak:.1} N, {} packets",
        100.0 * share,
        given.len()
    );
    assert!(share <= tolerance::FELT, "{share}");
}
