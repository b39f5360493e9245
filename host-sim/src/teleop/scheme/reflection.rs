//! Impedance reflection (Biagiotti & Melchiorri): the slave's board identifies the environment, its
//! parameters cross, and the master's board renders them at its own position. With the operator's impedance
//! going the other way it is the two-sided scheme, and with a changed impedance the shaped one.
//!
//! A delay delays what is known of the material, and not the force. Estimator, packets and renderer are the
//! core's, as on the boards. At most 100 messages a second go either way.

use std::f64::consts::TAU;

use estimator_core::board::frame::{Decoder, Frame, MAX_ENCODED, PACKET_ENCODED, encode};
use estimator_core::board::reflection::{Packet, Rendered};
use estimator_core::physics::law::LawKind;
use estimator_core::{Estimate, estimate::Estimated};

use super::guard::{Guard, GuardLimits};
use super::ledger::Ledger;
use super::shape::Shape;
use crate::teleop::board::{Board, PACKETS_HZ, Rendering};
use crate::teleop::hand::{Excitation, HandIdentifier};
use crate::teleop::held::{Held, Touch};
use crate::teleop::scheme::{MasterCommand, Message, Reflecting, Scheme, Sensed, SlaveCommand};

/// The depth at which the boards report (m): the default of their settings.
const REFERENCE_DEPTH_M: f32 = 1e-3;
/// A position that is older is not extrapolated any further (s).
const FURTHEST_S: f64 = 0.02;
/// By how much of a period the simulated master's force is older than its position. Both are read at the end of a
/// tick over which the command was held; the hand's inertia is then that under the command, whose middle is half
/// a tick back. Without it masses come out 3 % low, with noise and without.
const FORCE_LATE: f64 = 0.5;
/// How long a hand that was heard is used (s): ten of its packets, half of which may be late or lost.
const HAND_HOLDS_S: f64 = 0.2;
/// What smooths the positions that come 100 times a second (Hz).
const SMOOTHING_HZ: f64 = 20.0;

/// The variants of the scheme.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ReflectionOptions {
    /// How the master's board renders.
    pub rendering: Rendering,
    /// The slave's guard.
    pub guard: GuardLimits,
    /// How the impedance is changed before it is rendered.
    pub shape: Shape,
    /// Whether the operator's impedance goes to the slave.
    pub both: bool,
    /// The known force at the master that shows the hand.
    pub excitation: Option<Excitation>,
    /// Whether `excitation` was chosen, and `None` means that there is none.
    pub excites: bool,
}

/// The master's end.
struct Master {
    board: Board,
    hand: HandIdentifier,
    heard: Option<Packet>,
    rendered: Rendered,
    ledger: Ledger,
    ticks: u64,
}

/// The slave's end.
struct Slave {
    board: Board,
    guard: Guard,
    held: Held,
    estimate: Option<Estimate<f32>>,
    /// Position (m) and speed (m/s) that were heard last, and how long ago (s).
    of_master: Option<(f64, f64, f64)>,
    /// The operator's stiffness (N/m), damping (N s/m) and intention (m), and how long ago they were heard
    /// (s).
    hand: Option<(f64, f64, f64)>,
    hand_age_s: f64,
    /// The smoothed position (m) and speed (m/s).
    smoothed: Option<(f64, f64)>,
}

/// The scheme.
pub struct Reflection {
    options: ReflectionOptions,
    master: Master,
    slave: Slave,
}

impl Reflection {
    /// The scheme with its variant.
    pub fn new(options: ReflectionOptions) -> Reflection {
        let rendering = Rendering {
            shaping: options.shape.gain,
            ..options.rendering
        };
        Reflection {
            options,
            master: Master {
                board: Board::master(&rendering),
                hand: HandIdentifier::new(1e-3, FORCE_LATE, options.rendering.device_ns_per_m),
                heard: None,
                rendered: Rendered::default(),
                ledger: Ledger::default(),
                ticks: 0,
            },
            slave: Slave {
                board: Board::slave(),
                guard: Guard::new(options.guard),
                held: Held::default(),
                estimate: None,
                of_master: None,
                hand: None,
                hand_age_s: 0.0,
                smoothed: None,
            },
        }
    }

    /// The operator's impedance as a packet: a spring and a damper from where the hand wants to be.
    fn hand_packet(&self, own: &Sensed) -> Option<Packet> {
        let hand = self.master.hand.estimate();
        if !hand.is_known() {
            return None;
        }
        let mut estimate = self.slave.estimate?;
        let ((k, k_error), (b, b_error)) = (hand.stiffness_n_per_m, hand.damping_ns_per_m);
        let intended_m = own.position_m + (own.force_n + b * own.speed_mps) / k;
        estimate.law = LawKind::KelvinVoigt;
        estimate.time_us = own.time_us;
        estimate.parameters = [None; estimator_core::estimate::PARAMETER_SLOTS];
        let known = [(k, k_error), (b, b_error), (intended_m, 1e-3)];
        for (slot, (value, std_error)) in estimate.parameters.iter_mut().zip(known) {
            *slot = Some(Estimated {
                value: value as f32,
                std_error: std_error as f32,
            });
        }
        Some(Packet::of(
            &estimate,
            REFERENCE_DEPTH_M,
            self.master.ticks as u16,
        ))
    }

    /// What the master sends at a tick, 100 times a second; in the two-sided scheme position and hand in
    /// turn.
    fn told_by_master(&self, own: &Sensed) -> Option<Message> {
        let every = (1000.0 / PACKETS_HZ) as u64;
        if !self.master.ticks.is_multiple_of(every) {
            return None;
        }
        let turn = (self.master.ticks / every).is_multiple_of(2);
        if self.options.both
            && turn
            && let Some(packet) = self.hand_packet(own)
        {
            return Some(framed(&packet));
        }
        let acknowledged = f64::from(self.master.rendered.sequence);
        Some(Message::Signals([
            own.position_m,
            own.speed_mps,
            acknowledged,
            0.0,
        ]))
    }
}

/// A packet as a frame.
fn framed(packet: &Packet) -> Message {
    let mut long = [0; MAX_ENCODED];
    encode(&Frame::Reflection(*packet), packet.sequence, &mut long);
    let mut bytes = [0; PACKET_ENCODED];
    bytes.copy_from_slice(&long[..PACKET_ENCODED]);
    Message::Frame(bytes)
}

/// The packet in a frame; `None` if a bit of it is wrong.
fn packet_in(bytes: &[u8]) -> Option<Packet> {
    let mut decoder = Decoder::new();
    bytes.iter().find_map(|byte| match decoder.push(*byte)? {
        Ok((_, Frame::Reflection(packet))) => Some(packet),
        _ => None,
    })
}

impl Slave {
    fn hear(&mut self, arrived: Option<Message>, period_s: f64) {
        if let Some((.., age_s)) = &mut self.of_master {
            *age_s += period_s;
        }
        self.hand_age_s += period_s;
        // Without news of the hand the slave follows the position, as in the one-sided scheme.
        self.hand = self.hand.filter(|_| self.hand_age_s < HAND_HOLDS_S);
        match arrived {
            Some(Message::Signals([position_m, speed_mps, sequence, _])) => {
                self.of_master = Some((position_m, speed_mps, 0.0));
                self.guard.acknowledged(sequence as u16);
            }
            Some(Message::Frame(bytes)) => {
                let packet = packet_in(&bytes);
                let slots = packet.map(|packet| packet.parameters());
                if let Some([Some(k), Some(b), Some(intended), ..]) = slots {
                    let value = |known: Estimated<f32>| f64::from(known.value);
                    self.hand = Some((value(k), value(b), value(intended)));
                    self.hand_age_s = 0.0;
                }
            }
            None => {}
        }
    }

    /// The position (m) and the speed (m/s) to follow: what was heard, extrapolated and smoothed.
    fn target(&mut self, own: &Sensed) -> (f64, f64) {
        let Some((position_m, speed_mps, age_s)) = self.of_master else {
            return (own.position_m, 0.0);
        };
        let ahead_s = age_s.min(FURTHEST_S);
        let goes_on = age_s <= FURTHEST_S;
        let wanted = (
            position_m + speed_mps * ahead_s,
            if goes_on { speed_mps } else { 0.0 },
        );
        let (mut x, mut v) = self.smoothed.unwrap_or((own.position_m, 0.0));
        let omega = TAU * SMOOTHING_HZ;
        // Critically damped, with the speed fed forward: it lags in acceleration only.
        let pull = omega * omega * (wanted.0 - x) + 2.0 * omega * (wanted.1 - v);
        v += pull * own.period_s;
        x += v * own.period_s;
        self.smoothed = Some((x, v));
        (x, v)
    }
}

impl Scheme for Reflection {
    fn master(&mut self, own: &Sensed, arrived: Option<Message>) -> MasterCommand {
        let master = &mut self.master;
        if let Some(Message::Frame(bytes)) = arrived
            && let Some(packet) = packet_in(&bytes)
            && master.board.take(packet).is_ok()
        {
            master.heard = Some(packet);
        }
        if self.options.both {
            master.hand.update(own.force_n, own.position_m);
        }
        master.ticks += 1;
        let record = master.board.tick(own.time_us, own.position_m, own.force_n);
        master.rendered = record.rendered.unwrap_or_default();
        let most_n = self.options.rendering.force_n;
        let sequence = master.rendered.sequence;
        master
            .ledger
            .book(master.heard.as_ref(), sequence, own.position_m, most_n);
        let excitation = self.options.excitation.filter(|_| self.options.both);
        let known_n = excitation.map_or(0.0, |force| force.at(1e-6 * own.time_us as f64));
        MasterCommand {
            force_n: self.master.board.force_n() + known_n,
            message: self.told_by_master(own),
        }
    }

    fn slave(&mut self, own: &Sensed, arrived: Option<Message>) -> SlaveCommand {
        let slave = &mut self.slave;
        slave.hear(arrived, own.period_s);
        let record = slave.board.tick(own.time_us, own.position_m, own.force_n);
        let mut estimate = record.estimate;
        self.options.shape.apply(&mut estimate);
        let due = record.due.reflected;
        let packet = due.map(|sequence| Packet::of(&estimate, REFERENCE_DEPTH_M, sequence));
        let packet = packet.map(|packet| {
            slave.held.observe(Touch {
                position_m: own.position_m as f32,
                speed_mps: own.speed_mps as f32,
                force_n: own.force_n as f32,
            });
            slave.held.complete(packet)
        });
        slave.estimate = Some(record.estimate);
        if let Some(packet) = &packet {
            if let Some(stiffer) = slave.held.stiffer_since_change() {
                slave.guard.changed(stiffer);
            }
            slave.guard.sent(packet);
        }
        let (position_m, speed_mps) = slave.target(own);
        let followed_m = slave.guard.position_m(position_m, own);
        let behind = (position_m - followed_m).abs() > 1e-6;
        let mut command = SlaveCommand {
            force_limit_n: slave.guard.force_n(position_m, speed_mps),
            message: packet.as_ref().map(framed),
            ..SlaveCommand::follow(followed_m, if behind { 0.0 } else { speed_mps })
        };
        if let (Some((k, b, intended_m)), true) = (slave.hand, self.options.both) {
            // The hand's own spring pulls the slave to where the hand wants to be.
            command.compliance = Some((k, b));
            command.position_m = intended_m;
        }
        command
    }

    fn reflecting(&self) -> Option<Reflecting> {
        Some(Reflecting {
            estimate: self.slave.estimate,
            heard: self.master.heard,
            rendered: self.master.rendered,
            exchanged_j: self.master.ledger.exchanged_j(),
            hand: self.options.both.then(|| self.master.hand.estimate()),
            refused: self.master.board.refused,
            guarded: self.slave.guard.is_closed(),
        })
    }
}
