//! Position–position: a spring and a damper between master and slave, each of which sees the other's
//! position as it was one delay ago.
//!
//! F_m = k(x_m − x_s′) + b(v_m − v_s′), and the same at the slave. What the operator feels of the material is
//! in series with k, and in free motion the delay drags: F_m = k(x_m(t) − x_m(t − 2T)).

use crate::teleop::scheme::{MasterCommand, Message, Scheme, Sensed, SlaveCommand};

/// The spring and the damper between the two ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coupling {
    /// k (N/m)
    pub stiffness_n_per_m: f64,
    /// b (N s/m)
    pub damping_ns_per_m: f64,
}

impl Default for Coupling {
    /// Stiffer than the gel by five, and with the master's damping stable at 1 kHz.
    fn default() -> Self {
        Coupling {
            stiffness_n_per_m: 12e3,
            damping_ns_per_m: 40.0,
        }
    }
}

impl Coupling {
    /// The force that pulls a position and a speed to others (N).
    pub fn force_n(&self, own: (f64, f64), other: (f64, f64)) -> f64 {
        self.stiffness_n_per_m * (own.0 - other.0) + self.damping_ns_per_m * (own.1 - other.1)
    }
}

/// The scheme.
#[derive(Clone, Debug, Default)]
pub struct PositionPosition {
    coupling: Coupling,
    /// Position (m) and speed (m/s) that were heard last, at either end.
    of_slave: Option<(f64, f64)>,
    of_master: Option<(f64, f64)>,
}

impl PositionPosition {
    /// The scheme with a coupling.
    pub fn new(coupling: Coupling) -> Self {
        PositionPosition {
            coupling,
            ..PositionPosition::default()
        }
    }
}

impl Scheme for PositionPosition {
    fn master(&mut self, own: &Sensed, arrived: Option<Message>) -> MasterCommand {
        if let Some([position_m, speed_mps, ..]) = arrived.and_then(Message::signals) {
            self.of_slave = Some((position_m, speed_mps));
        }
        let at = (own.position_m, own.speed_mps);
        MasterCommand {
            force_n: self
                .of_slave
                .map_or(0.0, |other| self.coupling.force_n(at, other)),
            message: Some(Message::Signals([at.0, at.1, 0.0, 0.0])),
        }
    }

    fn slave(&mut self, own: &Sensed, arrived: Option<Message>) -> SlaveCommand {
        if let Some([position_m, speed_mps, ..]) = arrived.and_then(Message::signals) {
            self.of_master = Some((position_m, speed_mps));
        }
        let at = (own.position_m, own.speed_mps);
        let (position_m, speed_mps) = self.of_master.unwrap_or((own.position_m, 0.0));
        SlaveCommand {
            compliance: Some((
                self.coupling.stiffness_n_per_m,
                self.coupling.damping_ns_per_m,
            )),
            message: Some(Message::Signals([at.0, at.1, 0.0, 0.0])),
            ..SlaveCommand::follow(position_m, speed_mps)
        }
    }
}
