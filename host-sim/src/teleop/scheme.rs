//! The schemes that couple master and slave, a file each behind one trait.
//!
//! A scheme runs at both ends. At each tick an end knows what its own sensors say and the newest message
//! that has arrived from the other end, and nothing else; what it sends goes through the channel.

pub mod four_channel;
pub mod guard;
pub mod ledger;
pub mod passivity;
pub mod position_force;
pub mod position_position;
pub mod reflection;
pub mod shape;
pub mod wave_variables;

use estimator_core::Estimate;
use estimator_core::board::frame::PACKET_ENCODED;
use estimator_core::board::reflection::{Packet, Rendered};

use super::hand::HandEstimate;

/// The loop that keeps the slave where it is told.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Servo {
    /// kp (N/m)
    pub stiffness_n_per_m: f64,
    /// kd (N s/m)
    pub damping_ns_per_m: f64,
}

/// What the sensors of one end say at a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sensed {
    /// The end's own clock (µs).
    pub time_us: u64,
    /// Time since the last tick (s).
    pub period_s: f64,
    /// Position (m), growing into the material.
    pub position_m: f64,
    /// Speed (m/s).
    pub speed_mps: f64,
    /// The load cell (N): the hand's push into the material at the master, the material's push out of it
    /// at the slave.
    pub force_n: f64,
    /// The actuator's force along the position (N).
    pub actuator_n: f64,
}

/// What crosses the channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Message {
    /// Numbers; what they mean is the scheme's.
    Signals([f64; 4]),
    /// A frame of the core with an impedance, as the boards send it.
    Frame([u8; PACKET_ENCODED]),
}

impl Message {
    /// Its length (bytes): numbers cross in 32 bits, with eight bytes of time stamp and four of CRC.
    pub fn bytes(&self) -> usize {
        match self {
            Message::Signals(_) => 8 + 4 * 4 + 4,
            Message::Frame(bytes) => bytes.len(),
        }
    }

    /// The numbers, if it has some.
    pub fn signals(self) -> Option<[f64; 4]> {
        match self {
            Message::Signals(signals) => Some(signals),
            Message::Frame(_) => None,
        }
    }
}

/// What the master is to do until the next tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MasterCommand {
    /// The force that pushes the operator out (N).
    pub force_n: f64,
    /// What is sent to the slave.
    pub message: Option<Message>,
}

/// What the slave is to do until the next tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlaveCommand {
    /// The position to follow (m); between ticks it moves on at `speed_mps`.
    pub position_m: f64,
    /// The speed to follow (m/s).
    pub speed_mps: f64,
    /// A force beside that of the servo (N).
    pub forward_n: f64,
    /// The largest force of servo and `forward_n` together (N).
    pub force_limit_n: f64,
    /// Stiffness (N/m) and damping (N s/m) with which it follows; `None`: those of the servo.
    pub compliance: Option<(f64, f64)>,
    /// What is sent to the master.
    pub message: Option<Message>,
}

impl SlaveCommand {
    /// Following a position (m) and a speed (m/s), with all the force that the slave has.
    pub fn follow(position_m: f64, speed_mps: f64) -> SlaveCommand {
        SlaveCommand {
            position_m,
            speed_mps,
            forward_n: 0.0,
            force_limit_n: f64::INFINITY,
            compliance: None,
            message: None,
        }
    }
}

/// What a scheme that reflects impedances knows at a tick.
#[derive(Clone, Copy, Debug, Default)]
pub struct Reflecting {
    /// What the slave's estimator says.
    pub estimate: Option<Estimate<f32>>,
    /// The packet that the master renders.
    pub heard: Option<Packet>,
    /// What the master puts out.
    pub rendered: Rendered,
    /// ΣV_new − V_old of the impedances that were exchanged so far (J).
    pub exchanged_j: f64,
    /// The operator's impedance, as the master's board identifies it.
    pub hand: Option<HandEstimate>,
    /// Packets that a board has refused.
    pub refused: u64,
    /// Whether the slave's force is limited by its guard.
    pub guarded: bool,
}

/// A scheme of teleoperation.
pub trait Scheme {
    /// A tick of the master.
    fn master(&mut self, own: &Sensed, arrived: Option<Message>) -> MasterCommand;

    /// A tick of the slave.
    fn slave(&mut self, own: &Sensed, arrived: Option<Message>) -> SlaveCommand;

    /// What a scheme that reflects impedances knows; `None` of the others.
    fn reflecting(&self) -> Option<Reflecting> {
        None
    }
}
