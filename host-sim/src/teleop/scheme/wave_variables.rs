//! Wave variables (G. Niemeyer, J.-J. E. Slotine, "Telemanipulation with time delays", Int. J. Robotics
//! Research 23(9), 2004): power-preserving combinations of speed and force cross the channel.
//!
//! u = (b·v + F)/√(2b), w = (b·v − F)/√(2b). Master: F_m = b·v_m − √(2b)·w_m, u_m = √(2b)·v_m − w_m.
//! Slave: v_d = (√(2b)·u_s − F_s)/b, w_s = u_s − √(2/b)·F_s, with F_s the force of its servo, which depends
//! on v_d: solved for it, since a stiff servo a tick later would be unstable. With any
//! constant delay the channel is passive. What crosses are the integrals of the waves, so a lost message
//! costs no position; they are used up at a limited rate, which a message's jitter would otherwise turn
//! into peaks of energy.
//!
//! **Impedance matching**: a slave whose servo has the damping b absorbs what arrives instead of reflecting
//! it. Unmatched, with a stiff servo, a spring k feels like 2bk/(2b + kT) at low frequencies, T the round
//! trip; matched, there is nothing to hold the slave's position to the master's, and it drifts.

use crate::teleop::scheme::{MasterCommand, Message, Scheme, Sensed, Servo, SlaveCommand};

/// How the waves are made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Waves {
    /// b: wave impedance (N s/m).
    pub impedance_ns_per_m: f64,
    /// The rate at which an integral that has arrived is used up (1/s); infinite: within a tick.
    pub rate_per_s: f64,
    /// Whether the slave's servo has the damping b.
    pub matched: bool,
}

impl Default for Waves {
    /// 30 N s/m: between the drag in free motion, b, and the softness in contact.
    fn default() -> Self {
        Waves {
            impedance_ns_per_m: 30.0,
            rate_per_s: 200.0,
            matched: false,
        }
    }
}

/// One end of the line: the integral that has arrived, and how much of it has been used.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct End {
    arrived: f64,
    used: f64,
    /// The integral of what this end sends.
    sent: f64,
}

impl End {
    /// The wave of this tick, √W.
    fn take(&mut self, arrived: Option<Message>, rate_per_s: f64, period_s: f64) -> f64 {
        if let Some([integral, ..]) = arrived.and_then(Message::signals) {
            self.arrived = integral;
        }
        let wave = (self.arrived - self.used) * rate_per_s.min(1.0 / period_s);
        self.used += wave * period_s;
        wave
    }

    fn send(&mut self, wave: f64, period_s: f64) -> Option<Message> {
        self.sent += wave * period_s;
        Some(Message::Signals([self.sent, 0.0, 0.0, 0.0]))
    }
}

/// The scheme.
#[derive(Clone, Debug, Default)]
pub struct WaveVariables {
    waves: Waves,
    servo: Servo,
    master: End,
    slave: End,
    /// Where the slave is to be (m).
    wanted_m: Option<f64>,
}

impl WaveVariables {
    /// The scheme with its waves, and with the slave's servo.
    pub fn new(waves: Waves, servo: Servo) -> Self {
        let b = waves.impedance_ns_per_m;
        let matched = Servo {
            stiffness_n_per_m: 40.0 * b,
            damping_ns_per_m: b,
        };
        WaveVariables {
            servo: if waves.matched { matched } else { servo },
            waves,
            ..WaveVariables::default()
        }
    }
}

impl Scheme for WaveVariables {
    fn master(&mut self, own: &Sensed, arrived: Option<Message>) -> MasterCommand {
        let b = self.waves.impedance_ns_per_m;
        let w = self
            .master
            .take(arrived, self.waves.rate_per_s, own.period_s);
        let root = (2.0 * b).sqrt();
        MasterCommand {
            force_n: b * own.speed_mps - root * w,
            message: self.master.send(root * own.speed_mps - w, own.period_s),
        }
    }

    fn slave(&mut self, own: &Sensed, arrived: Option<Message>) -> SlaveCommand {
        let b = self.waves.impedance_ns_per_m;
        let u = self
            .slave
            .take(arrived, self.waves.rate_per_s, own.period_s);
        let Servo {
            stiffness_n_per_m: k,
            damping_ns_per_m: d,
        } = self.servo;
        let last_m = self.wanted_m.unwrap_or(own.position_m);
        // F_s = k(x_d + v_d·T − x) + d(v_d − v)
        let standing_n = k * (last_m - own.position_m) - d * own.speed_mps;
        let speed_mps = ((2.0 * b).sqrt() * u - standing_n) / (b + d + k * own.period_s);
        let pulled_n = standing_n + (d + k * own.period_s) * speed_mps;
        let wanted_m = last_m + speed_mps * own.period_s;
        self.wanted_m = Some(wanted_m);
        let w = u - (2.0 / b).sqrt() * pulled_n;
        SlaveCommand {
            compliance: self.waves.matched.then_some((k, d)),
            message: self.slave.send(w, own.period_s),
            ..SlaveCommand::follow(wanted_m, speed_mps)
        }
    }
}
