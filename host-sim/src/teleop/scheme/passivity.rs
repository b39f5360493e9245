//! Time-domain passivity (B. Hannaford, J.-H. Ryu, "Time-domain passivity control of haptic interfaces",
//! IEEE Trans. Robotics and Automation 18(1), 2002; with delay J.-H. Ryu et al., "A passive bilateral
//! control scheme for a teleoperator with time-varying communication delay", Mechatronics 20, 2010):
//! position–force, and a damper that takes out what the channel has created.
//!
//! Each end counts the energy that went in on its side and sends the sum; the energy that may come out at
//! the other end is what was reported to have gone in. Beyond it, the master's force gets a damper α·v, and
//! the slave's commanded speed is taken back by β·F. That is felt as jumps of the force, and the slave falls
//! behind in position.

use crate::teleop::scheme::{MasterCommand, Message, Scheme, Sensed, SlaveCommand};

/// The energies at one port (J).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Port {
    /// What went into the channel here.
    entered_j: f64,
    /// What came out here, less what the damper has taken.
    left_j: f64,
    /// What went in at the other end, as reported last.
    allowed_j: f64,
}

impl Port {
    /// Counts the work of a tick that goes into the channel.
    fn count(&mut self, work_j: f64) {
        self.entered_j += work_j.max(0.0);
        self.left_j += (-work_j).max(0.0);
    }

    /// The damper takes energy of what came out.
    fn dissipate(&mut self, work_j: f64) {
        self.left_j -= work_j;
    }

    /// What came out too much.
    fn excess_j(&self) -> f64 {
        (self.left_j - self.allowed_j).max(0.0)
    }
}

/// The largest damper (N s/m) that the master renders, and the largest yielding (m/N s) of the slave.
const LARGEST_DAMPER: f64 = 250.0;
const LARGEST_YIELD: f64 = 0.02;
/// Below this speed (m/s) and force (N) no energy can be taken out.
const STILL_MPS: f64 = 1e-4;
const SLACK_N: f64 = 0.05;

/// The scheme.
#[derive(Clone, Debug, Default)]
pub struct Passivity {
    master: Port,
    slave: Port,
    heard_n: f64,
    of_master: Option<(f64, f64)>,
    /// How far the slave's command has fallen behind (m).
    behind_m: f64,
}

impl Scheme for Passivity {
    fn master(&mut self, own: &Sensed, arrived: Option<Message>) -> MasterCommand {
        if let Some([force_n, entered_j, ..]) = arrived.and_then(Message::signals) {
            (self.heard_n, self.master.allowed_j) = (force_n, entered_j);
        }
        self.master
            .count(self.heard_n * own.speed_mps * own.period_s);
        let square = own.speed_mps * own.speed_mps;
        let excess_j = self.master.excess_j();
        let damper = match own.speed_mps.abs() > STILL_MPS {
            true => (excess_j / (square * own.period_s)).min(LARGEST_DAMPER),
            false => 0.0,
        };
        self.master.dissipate(damper * square * own.period_s);
        MasterCommand {
            force_n: self.heard_n + damper * own.speed_mps,
            message: Some(Message::Signals([
                own.position_m,
                own.speed_mps,
                self.master.entered_j,
                0.0,
            ])),
        }
    }

    fn slave(&mut self, own: &Sensed, arrived: Option<Message>) -> SlaveCommand {
        if let Some([position_m, speed_mps, entered_j, _]) = arrived.and_then(Message::signals) {
            self.of_master = Some((position_m, speed_mps));
            self.slave.allowed_j = entered_j;
        }
        let (position_m, speed_mps) = self.of_master.unwrap_or((own.position_m, 0.0));
        let force_n = own.force_n;
        // The material pushes against the motion: what it takes comes out of the channel here.
        self.slave.count(-force_n * speed_mps * own.period_s);
        let yielding = match force_n.abs() > SLACK_N {
            true => {
                let full = self.slave.excess_j() / (force_n * force_n * own.period_s);
                full.min(LARGEST_YIELD)
            }
            false => 0.0,
        };
        let taken_mps = yielding * force_n;
        self.slave.dissipate(taken_mps * force_n * own.period_s);
        self.behind_m += taken_mps * own.period_s;
        // In free air nothing keeps the slave from catching up.
        if force_n.abs() <= SLACK_N {
            self.behind_m *= (-2.0 * own.period_s).exp();
        }
        SlaveCommand {
            message: Some(Message::Signals([force_n, self.slave.entered_j, 0.0, 0.0])),
            ..SlaveCommand::follow(position_m - self.behind_m, speed_mps - taken_mps)
        }
    }
}
