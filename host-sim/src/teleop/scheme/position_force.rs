//! Position–force: the slave follows the master's position, the master feels the slave's load cell, both
//! as they were one delay ago.
//!
//! F_m = F_e′. Without delay it is as transparent as the slave's servo; the loop x_m → x_s → F_e → x_m
//! then has the whole round trip in it, and a stiff material makes it unstable from tens of milliseconds.

use crate::teleop::scheme::{MasterCommand, Message, Scheme, Sensed, SlaveCommand};

/// The scheme.
#[derive(Clone, Debug, Default)]
pub struct PositionForce {
    /// The force that was heard last (N).
    heard_n: f64,
    /// Position (m) and speed (m/s) that were heard last.
    of_master: Option<(f64, f64)>,
}

impl Scheme for PositionForce {
    fn master(&mut self, own: &Sensed, arrived: Option<Message>) -> MasterCommand {
        if let Some([force_n, ..]) = arrived.and_then(Message::signals) {
            self.heard_n = force_n;
        }
        MasterCommand {
            force_n: self.heard_n,
            message: Some(Message::Signals([own.position_m, own.speed_mps, 0.0, 0.0])),
        }
    }

    fn slave(&mut self, own: &Sensed, arrived: Option<Message>) -> SlaveCommand {
        if let Some([position_m, speed_mps, ..]) = arrived.and_then(Message::signals) {
            self.of_master = Some((position_m, speed_mps));
        }
        let (position_m, speed_mps) = self.of_master.unwrap_or((own.position_m, 0.0));
        SlaveCommand {
            message: Some(Message::Signals([own.force_n, 0.0, 0.0, 0.0])),
            ..SlaveCommand::follow(position_m, speed_mps)
        }
    }
}
