//! The bridge of `palpate teleop` between two simulated boards: on one host, and over loopback UDP.

use std::net::UdpSocket;
use std::sync::{Arc, Mutex};

use estimator_core::board::link::{BYTES_PER_MS, Command};
use estimator_core::board::settings::Key as Setting;
use estimator_core::physics::law::{ContactLaw, HuntCrossley};
use palpate::link::port::Simulated;
use palpate::link::world::{Hand, World};
use palpate::link::{Device, SimulatedBoard};
use palpate::teleop::bridge::run::{
    MasterView, Wire, check_master, check_slave, framed, give, local, look, packets,
};
use palpate::teleop::bridge::{Endpoint, Key, Role};
use palpate::teleop::channel::{Channel, ChannelConfig};
use palpate::teleop::held::Held;

const TIMEOUT_S: f64 = 0.2;
const FADE_S: f64 = 0.05;
/// Time between two looks at both boards, which go on by 10 ms at each read (s).
const LOOK_S: f64 = 0.01;

fn board(hand: Hand, settings: &[(Setting, f32)]) -> Device<Simulated> {
    let mut world = World::default();
    // A calibrated cell.
    world.n_per_code /= 1.03;
    world.zero_code = 65_536.0;
    world.hand = hand;
    let board = SimulatedBoard::new(Arc::new(Mutex::new(world)), BYTES_PER_MS);
    let mut device = Device::new(Simulated::at_once(board));
    for (key, value) in settings {
        device.prepare(*key, *value).unwrap();
    }
    device.order(Command::Commit).unwrap();
    if settings
        .iter()
        .any(|(key, _)| *key == Setting::RenderForceN)
    {
        device.order(Command::Arm).unwrap();
    }
    device
}

fn slave() -> Device<Simulated> {
    board(
        Hand::Palpating,
        &[
            (Setting::ReflectionEvery, 10.0),
            (Setting::TelemetryEvery, 50.0),
        ],
    )
}

/// A master whose handle is held 3 mm deep.
fn master() -> Device<Simulated> {
    board(
        Hand::Holding {
            position_m: DEEP_M,
            force_n: 0.0,
        },
        &[
            (Setting::RenderForceN, 12.0),
            (Setting::RenderFullN, 15.0),
            (Setting::RenderDeviceNsPerM, 100.0),
            (Setting::RenderTimeoutS, TIMEOUT_S as f32),
            (Setting::RenderFadeS, FADE_S as f32),
            (Setting::TelemetryEvery, 10.0),
        ],
    )
}

const DEEP_M: f64 = 3e-3;

/// The gel's force at the master's depth (N).
fn real_n() -> f64 {
    HuntCrossley::new(1350.0_f64, 36.0, 1.35, 1e-3).force_n(DEEP_M, 0.0)
}

fn force_n(view: &MasterView) -> f64 {
    view.rendered
        .map_or(0.0, |rendered| f64::from(rendered.force_n))
}

/// Lets the master alone go on, as if the bridge had been killed.
fn alone(master: &mut Device<Simulated>, view: &mut MasterView, seconds: f64) {
    for _ in 0..(seconds / LOOK_S) as u32 {
        look(master, view).unwrap();
    }
}

#[test]
fn on_one_host_the_master_renders_what_the_slave_touches_and_fades_out_without_the_bridge() {
    let (mut slave, mut master) = (slave(), master());
    check_slave(&mut slave).unwrap();
    check_master(&mut master).unwrap();
    let config = ChannelConfig {
        delay_s: 0.05,
        jitter: 0.3,
        loss: 0.2,
        ..ChannelConfig::default()
    };
    let (mut channel, mut held) = (Channel::new(config, 7), Held::default());
    let mut view = MasterView::default();
    for step in 0..800 {
        local(
            &mut slave,
            &mut master,
            &mut channel,
            (&mut held, &mut view),
            f64::from(step) * LOOK_S,
        )
        .unwrap();
    }
    // The bar of the simulated system.
    let share = force_n(&view) / real_n() - 1.0;
    assert!(
        share.abs() < 0.05,
        "{} N for {} N",
        force_n(&view),
        real_n()
    );
    assert!(!view.has_stopped() && view.given > 200, "{view:?}");
    assert!(channel.counts().lost > 20);
    alone(&mut master, &mut view, 5.0 * (TIMEOUT_S + FADE_S));
    assert!(view.has_stopped(), "{view:?}");
    assert_eq!(force_n(&view), 0.0);
}

#[test]
fn boards_that_send_or_render_nothing_are_refused_with_the_setting() {
    let mut silent = board(Hand::Palpating, &[]);
    for (error, key) in [
        (check_slave(&mut silent).unwrap_err(), "reflection.every"),
        (check_master(&mut silent).unwrap_err(), "render.force_n"),
    ] {
        assert!(error.to_string().contains(key), "{error}");
    }
}

/// Both ends of a bridge over loopback, each with its board.
struct Network {
    slave: Device<Simulated>,
    master: Device<Simulated>,
    wires: [Wire; 2],
    ends: [Endpoint; 2],
    held: Held,
    view: MasterView,
    now_us: u64,
}

impl Network {
    fn new(keys: [Key; 2]) -> Network {
        let listens = Wire::open(Some("127.0.0.1:0".parse().unwrap()), None).unwrap();
        let address = listens.address().unwrap();
        let connects = Wire::open(None, Some(address)).unwrap();
        let [here, there] = keys;
        Network {
            slave: slave(),
            master: master(),
            wires: [listens, connects],
            ends: [
                Endpoint::new(Role::Listen, here),
                Endpoint::new(Role::Connect, there),
            ],
            held: Held::default(),
            view: MasterView::default(),
            now_us: 0,
        }
    }

    fn run(&mut self, seconds: f64) {
        for _ in 0..(seconds / LOOK_S) as u32 {
            self.now_us += 10_000;
            for packet in packets(&mut self.slave, &mut self.held).unwrap() {
                self.ends[0].send(self.now_us, &framed(&packet));
            }
            assert!(
                self.wires[0]
                    .exchange(&mut self.ends[0], self.now_us)
                    .is_empty()
            );
            look(&mut self.master, &mut self.view).unwrap();
            for frame in self.wires[1].exchange(&mut self.ends[1], self.now_us) {
                give(&mut self.master, &mut self.view, &frame).unwrap();
            }
        }
    }
}

#[test]
fn over_a_network_the_master_renders_what_the_slave_touches_whatever_strangers_send() {
    let key = || Key::new([9; 32]);
    let mut network = Network::new([key(), key()]);
    let port = network.wires[1].address().unwrap().port();
    let stranger = UdpSocket::bind("127.0.0.1:0").unwrap();
    for round in 0..80_u8 {
        network.run(0.1);
        stranger.send_to(&[3; 100], ("127.0.0.1", port)).unwrap();
        stranger.send_to(&[round; 5], ("127.0.0.1", port)).unwrap();
    }
    let share = force_n(&network.view) / real_n() - 1.0;
    assert!(
        share.abs() < 0.05,
        "{} N for {} N",
        force_n(&network.view),
        real_n()
    );
    let counts = network.ends[1].counts();
    assert!(counts.strangers > 100, "{counts:?}");
    assert_eq!(counts.passed, network.view.given);
    assert!(network.ends[1].clock().is_some());
    alone(
        &mut network.master,
        &mut network.view,
        5.0 * (TIMEOUT_S + FADE_S),
    );
    assert!(network.view.has_stopped());
    assert_eq!(force_n(&network.view), 0.0);
}

#[test]
fn without_the_same_key_nothing_reaches_the_master() {
    let mut network = Network::new([Key::new([9; 32]), Key::new([10; 32])]);
    network.run(3.0);
    assert_eq!((network.view.given, force_n(&network.view)), (0, 0.0));
    assert!(network.ends[0].counts().strangers > 5);
    assert!(!network.ends[1].is_alive(network.now_us));
}

/// What somebody on the way makes of the slave's datagrams: when each arrives (µs later), and what.
type Tampers = fn(usize, &[u8]) -> Vec<(u64, Vec<u8>)>;

fn flipped(datagram: &[u8], bit: usize) -> Vec<u8> {
    let mut changed = datagram.to_vec();
    let bit = bit % (8 * changed.len());
    changed[bit / 8] ^= 1 << (bit % 8);
    changed
}

/// What came of it: what the master's end counted, and the force at the end over the gel's.
struct Outcome {
    counts: palpate::teleop::bridge::Counts,
    tampered: u64,
    force_share: f64,
    stopped: bool,
}

/// Three seconds as it should be, and three with somebody in between. Every frame that reaches the master must be one
/// that the slave has sent, once, and in order.
fn with_somebody_in_between(tampers: Tampers) -> Outcome {
    let key = || Key::new([9; 32]);
    let mut ends = [
        Endpoint::new(Role::Listen, key()),
        Endpoint::new(Role::Connect, key()),
    ];
    let (mut slave, mut master) = (slave(), master());
    let (mut held, mut view) = (Held::default(), MasterView::default());
    let mut underway: Vec<(u64, Vec<u8>)> = Vec::new();
    let (mut sent, mut passed, mut tampered) = (Vec::new(), Vec::new(), 0);
    let mut before = ends[1].counts();
    for step in 1..=600_u64 {
        let now_us = 10_000 * step;
        for packet in packets(&mut slave, &mut held).unwrap() {
            let frame = framed(&packet);
            ends[0].send(now_us, &frame);
            sent.push(frame);
        }
        for datagram in ends[1].poll(now_us) {
            ends[0].receive(now_us, &datagram);
        }
        for datagram in ends[0].poll(now_us) {
            let own = step > 300;
            let arrive = match own {
                true => tampers(tampered, &datagram),
                false => vec![(0, datagram)],
            };
            tampered += usize::from(own);
            underway.extend(
                arrive
                    .into_iter()
                    .map(|(late_us, datagram)| (now_us + late_us, datagram)),
            );
        }
        look(&mut master, &mut view).unwrap();
        let (arrived, later): (Vec<_>, Vec<_>) = underway
            .into_iter()
            .partition(|(at_us, _)| *at_us <= now_us);
        underway = later;
        for (_, datagram) in arrived {
            if let Some(frame) = ends[1].receive(now_us, &datagram) {
                give(&mut master, &mut view, &frame).unwrap();
                passed.push(frame);
            }
        }
        if step == 300 {
            before = ends[1].counts();
        }
    }
    let mut rest = sent.iter();
    assert!(passed.iter().all(|frame| rest.any(|own| own == frame)));
    let after = ends[1].counts();
    let counts = palpate::teleop::bridge::Counts {
        passed: after.passed - before.passed,
        strangers: after.strangers - before.strangers,
        replayed: after.replayed - before.replayed,
        overtaken: after.overtaken - before.overtaken,
        late: after.late - before.late,
        ..after
    };
    Outcome {
        counts,
        tampered: tampered as u64,
        force_share: force_n(&view) / real_n(),
        stopped: view.has_stopped(),
    }
}

/// Conditions × outcome: what somebody does on the way, what of it is counted, and what the master renders.
#[test]
fn whatever_somebody_does_on_the_way_nothing_but_the_slaves_packets_is_rendered_and_all_is_counted()
{
    let rows: [(&str, Tampers); 8] = [
        ("nothing", |_, datagram| vec![(0, datagram.to_vec())]),
        ("a bit flipped", |at, datagram| {
            vec![(0, flipped(datagram, at))]
        }),
        ("cut short", |at, datagram| {
            vec![(0, datagram[..at % datagram.len()].to_vec())]
        }),
        ("replayed", |_, datagram| {
            vec![(0, datagram.to_vec()), (30_000, datagram.to_vec())]
        }),
        // Every other one by two of the 100 a second.
        ("reordered", |at, datagram| {
            vec![(20_000 * (at as u64 % 2), datagram.to_vec())]
        }),
        ("held up by 1 s", |_, datagram| {
            vec![(1_000_000, datagram.to_vec())]
        }),
        ("a stranger's beside", |at, datagram| {
            vec![(0, vec![3; 1 + at % 200]), (0, datagram.to_vec())]
        }),
        ("kept", |_, _| Vec::new()),
    ];
    for (name, tampers) in rows {
        let Outcome {
            counts,
            tampered,
            force_share,
            stopped,
        } = with_somebody_in_between(tampers);
        let renders = (force_share - 1.0).abs() < 0.05 && !stopped;
        let faded = force_share == 0.0 && stopped;
        let rejected = counts.strangers + counts.replayed + counts.overtaken + counts.late;
        println!("{name:20} {tampered:4} {counts:?} {force_share:.3} {stopped}");
        // Beside packets there are questions for the clock, and their answers.
        let (all, none) = (10 * counts.passed > 9 * tampered, counts.passed == 0);
        let as_expected = match name {
            "nothing" => renders && all && rejected == 0,
            "a bit flipped" | "cut short" => faded && none && counts.strangers == tampered,
            "replayed" => {
                renders && all && counts.replayed == rejected && 10 * counts.replayed > 9 * tampered
            }
            "reordered" => {
                renders && counts.overtaken == rejected && 10 * counts.overtaken > 4 * tampered
            }
            "held up by 1 s" => counts.late > 0 && counts.late == rejected,
            "a stranger's beside" => renders && all && counts.strangers == tampered,
            _ => faded && none && rejected == 0,
        };
        assert!(
            as_expected,
            "{name}: {counts:?} of {tampered}, {force_share}, {stopped}"
        );
    }
}
