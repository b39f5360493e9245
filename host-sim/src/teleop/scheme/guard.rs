//! The slave's own guard: what it has not told the master about, it touches gently.
//!
//! Until an impedance has crossed, the operator feels nothing of the material and goes on into it. The slave
//! limits its force and its speed then: in contact it goes in at v = v_c·(1 − F/F_g(t)), where F_g swings
//! between a third and all of the largest force three times a second. A force that is only clipped would
//! stand still, and teach the estimator nothing: on plastic it never converged. Once the master has acknowledged
//! an impedance, the operator feels that one, and the slave may use what it predicts at the depth that the
//! operator has chosen, and a margin: a stiffer material that takes its place meets the same guard. When the board
//! flags another material, and it is stiffer than the margin, the guard closes again: from gel to plastic the peak is
//! lower then, and the swing shows the plastic in 0.2 s of contact instead of 0.6 s.

use std::f64::consts::TAU;

use estimator_core::Status;
use estimator_core::board::reflection::{Packet, Reflected};
use estimator_core::physics::law::RelaxingLaw;

use crate::teleop::scheme::Sensed;

/// The limits of a guarded slave.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GuardLimits {
    /// The largest force while nothing has crossed, and the margin on what has (N).
    pub force_n: f64,
    /// The margin as a factor on the predicted force.
    pub factor: f64,
    /// The fastest approach while nothing has crossed (m/s).
    pub speed_mps: f64,
    /// v_c: the fastest motion in contact while nothing has crossed (m/s).
    pub contact_mps: f64,
}

impl Default for GuardLimits {
    /// 3.5 N determine gel and plastic within half a second of palpation, and lie below what
    /// position–force without delay presses with; 30 mm/s are the chapter's ramp.
    fn default() -> Self {
        GuardLimits {
            force_n: 3.5,
            factor: 1.25,
            speed_mps: 0.03,
            contact_mps: 0.012,
        }
    }
}

/// A force that is a contact (N): ten times the noise of the load cell.
const TOUCHED_N: f64 = 0.2;
/// How often the force of a closed guard swings (Hz).
const SWINGS_HZ: f64 = 3.0;
/// Packets on their way whose acknowledgement can still come: 8 s at 100 a second.
const MOST_UNDERWAY: usize = 800;

/// The guard of a slave.
#[derive(Clone, Debug)]
pub struct Guard {
    limits: GuardLimits,
    /// What was sent and not acknowledged yet: number and impedance.
    underway: std::collections::VecDeque<(u16, Option<Reflected>)>,
    /// The impedance that the master renders.
    crossed: Option<Reflected>,
    followed_m: Option<f64>,
}

impl Guard {
    /// A guard that lets nothing through yet.
    pub fn new(limits: GuardLimits) -> Guard {
        Guard {
            limits,
            underway: std::collections::VecDeque::new(),
            crossed: None,
            followed_m: None,
        }
    }

    /// Remembers a packet that was sent.
    pub fn sent(&mut self, packet: &Packet) {
        if self.underway.len() == MOST_UNDERWAY {
            self.underway.pop_front();
        }
        let trusted = matches!(packet.status, Status::Converged | Status::ModelSuspect);
        let reflected = packet.reflected().ok().flatten().filter(|_| trusted);
        self.underway.push_back((packet.sequence, reflected));
    }

    /// The master renders the packet with this number.
    pub fn acknowledged(&mut self, sequence: u16) {
        let Some(at) = self.underway.iter().position(|(own, _)| *own == sequence) else {
            return;
        };
        let crossed = self.underway.get(at).and_then(|(_, reflected)| *reflected);
        self.crossed = crossed.or(self.crossed);
        self.underway.drain(..at);
    }

    /// Another material is there, whose force is so many times what was known. Beyond the margin what has crossed is
    /// forgotten.
    pub fn changed(&mut self, stiffer: f64) {
        if stiffer > self.limits.factor {
            self.crossed = None;
            self.underway.clear();
        }
    }

    /// Whether nothing has crossed yet.
    pub fn is_closed(&self) -> bool {
        self.crossed.is_none()
    }

    /// The largest force (N) at a depth that the operator has chosen (m), moving at a speed (m/s).
    pub fn force_n(&self, position_m: f64, speed_mps: f64) -> f64 {
        let GuardLimits {
            force_n, factor, ..
        } = self.limits;
        let Some(crossed) = &self.crossed else {
            return force_n;
        };
        let law = &crossed.impedance;
        let depth_m = position_m as f32 - crossed.surface_m;
        let elastic_n = law.elastic_n(depth_m);
        let moving_n = law.force_n(depth_m, speed_mps.max(0.0) as f32);
        force_n + factor * f64::from(elastic_n.max(moving_n).max(0.0))
    }

    /// The position (m) that is followed on the way to another one (m), by a slave that feels a force (N).
    pub fn position_m(&mut self, wanted_m: f64, own: &Sensed) -> f64 {
        let last_m = self.followed_m.unwrap_or(own.position_m);
        let GuardLimits {
            force_n,
            speed_mps,
            contact_mps,
            ..
        } = self.limits;
        let most_mps = match (self.is_closed(), own.force_n > TOUCHED_N) {
            // What has built up while closed is given back ten times as fast.
            (false, _) => 10.0 * speed_mps,
            (true, false) => speed_mps,
            (true, true) => {
                let swing = (TAU * SWINGS_HZ * 1e-6 * own.time_us as f64).sin();
                let aim_n = force_n * (0.67 + 0.33 * swing);
                contact_mps * (1.0 - own.force_n / aim_n).clamp(-3.0, 1.0)
            }
        };
        // Outwards it is free to move.
        let followed_m = (wanted_m - last_m).min(most_mps * own.period_s) + last_m;
        self.followed_m = Some(followed_m);
        followed_m
    }
}
