use super::*;
use crate::board::frame::{Decoder, Frame, MAX_ENCODED, PACKET_ENCODED, encode};
use crate::board::wire::FrameError;
use crate::estimate::fault::{Fault, Faults};
use crate::estimate::status::Status;
use crate::estimate::{Estimate, Estimated, PARAMETER_SLOTS, Phase};
use crate::physics::law::LawKind;
extern crate std;
use std::vec::Vec;

mod packet;
mod render;

/// Knuth's MMIX generator; seeds are named where it is made.
struct Random(u64);

impl Random {
    fn bits(&mut self) -> u32 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 32) as u32
    }

    fn below(&mut self, end: u32) -> u32 {
        self.bits() % end
    }

    fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * (self.bits() as f32 / u32::MAX as f32)
    }

    /// Any pattern of bits, and more often than chance the ones that hurt.
    fn any_number(&mut self) -> f32 {
        const EDGES: [f32; 8] = [
            f32::NAN,
            f32::INFINITY,
            f32::NEG_INFINITY,
            f32::MAX,
            f32::MIN_POSITIVE,
            0.0,
            -0.0,
            1e-3,
        ];
        match self.below(4) {
            0 => EDGES[self.below(8) as usize],
            1 => f32::from_bits(self.bits()),
            _ => self.between(-5e-3, 5e-3),
        }
    }
}

const GEL: [f32; 4] = [1350.0, 36.0, 1.35, 2e-4];
const PLASTIC: [f32; 4] = [11_500.0, 70.0, 1.2, -1e-4];

fn estimate(law: LawKind, values: &[f32]) -> Estimate<f32> {
    let mut parameters = [None; PARAMETER_SLOTS];
    for (slot, value) in parameters.iter_mut().zip(values) {
        *slot = Some(Estimated {
            value: *value,
            std_error: value.abs() / 300.0,
        });
    }
    Estimate {
        time_us: 12_345_678,
        law,
        phase: Phase::Contact,
        status: Status::Converged,
        reason: None,
        depth_m: 1e-3,
        speed_mps: -0.02,
        force_n: 3.5,
        parameters,
        innovation: Default::default(),
        forgetting: 1.0,
        event: None,
        faults: Faults::from_bits(5),
    }
}

fn packet(law: LawKind, values: &[f32], sequence: u16) -> Packet {
    Packet::of(&estimate(law, values), 1e-3, sequence)
}

/// Values that each law can have, the surface last.
fn usual(law: LawKind) -> &'static [f32] {
    match law {
        LawKind::KelvinVoigt => &[2260.0, 123.0, 1e-4],
        LawKind::HuntCrossley => &GEL,
        LawKind::HuntCrossleySkew => &[1350.0, 36.0, 1.35, 1e-4, 2e-4],
        LawKind::Zener => &[3000.0, 900.0, 780.0, 1e-4],
        LawKind::QuasiLinear => &[1800.0, 1.6, 0.3, 2.0, 1e-4],
        LawKind::QuasiLinear2 => &[1800.0, 1.6, 0.2, 3.0, 0.15, 0.1, 1e-4],
    }
}
