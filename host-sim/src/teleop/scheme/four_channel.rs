//! Four channels (D. A. Lawrence, "Stability and transparency in bilateral teleoperation", IEEE Trans.
//! Robotics and Automation 9(5), 1993): position and force both ways.
//!
//! F_m = F_e′ + k(x_m − x_s′) + b(v_m − v_s′), and the slave adds F_h′ to the force of its servo. Lawrence's
//! ideal gains hold the accelerations as well, C₁ = Z_s + C_s and C₄ = −(Z_m + C_m); as everywhere in
//! practice they are left out here, so the devices' masses are felt.

use super::position_position::Coupling;
use crate::teleop::scheme::{MasterCommand, Message, Scheme, Sensed, SlaveCommand};

/// What was heard last of the other end: position (m), speed (m/s), force (N).
type Heard = Option<(f64, f64, f64)>;

/// The scheme.
#[derive(Clone, Debug, Default)]
pub struct FourChannel {
    coupling: Coupling,
    of_slave: Heard,
    of_master: Heard,
}

impl FourChannel {
    /// The scheme with a coupling.
    pub fn new(coupling: Coupling) -> Self {
        FourChannel {
            coupling,
            ..FourChannel::default()
        }
    }
}

fn heard(arrived: Option<Message>) -> Heard {
    let [position_m, speed_mps, force_n, _] = arrived.and_then(Message::signals)?;
    Some((position_m, speed_mps, force_n))
}

fn told(own: &Sensed) -> Option<Message> {
    Some(Message::Signals([
        own.position_m,
        own.speed_mps,
        own.force_n,
        0.0,
    ]))
}

impl Scheme for FourChannel {
    fn master(&mut self, own: &Sensed, arrived: Option<Message>) -> MasterCommand {
        self.of_slave = heard(arrived).or(self.of_slave);
        let at = (own.position_m, own.speed_mps);
        let force_n = self
            .of_slave
            .map_or(0.0, |(position_m, speed_mps, force_n)| {
                force_n + self.coupling.force_n(at, (position_m, speed_mps))
            });
        MasterCommand {
            force_n,
            message: told(own),
        }
    }

    fn slave(&mut self, own: &Sensed, arrived: Option<Message>) -> SlaveCommand {
        self.of_master = heard(arrived).or(self.of_master);
        let (position_m, speed_mps, force_n) = self.of_master.unwrap_or((own.position_m, 0.0, 0.0));
        SlaveCommand {
            forward_n: force_n,
            message: told(own),
            ..SlaveCommand::follow(position_m, speed_mps)
        }
    }
}
