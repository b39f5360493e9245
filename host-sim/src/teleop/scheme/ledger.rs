//! The energy that an exchange of impedances adds: V_new − V_old at the depth where the master is.
//!
//! A rendered spring that becomes another one under the hand holds more energy or less than before, and
//! nobody has put it there. That is the one source of energy of impedance reflection; it is counted and
//! declared.

use estimator_core::board::reflection::{Packet, Reflected};
use estimator_core::physics::law::RelaxingLaw;

/// Steps of the integral over the depth. The elastic force rises smoothly: 0.1 % of the energy.
const STEPS: u32 = 24;

/// The sum of what exchanges have added.
#[derive(Clone, Copy, Debug, Default)]
pub struct Ledger {
    rendered: Option<(u16, Reflected)>,
    exchanged_j: f64,
}

impl Ledger {
    /// Books a packet from the tick on in which it is rendered, at the master's position (m). `most_n` is
    /// the largest force that is rendered (N).
    pub fn book(&mut self, packet: Option<&Packet>, sequence: u16, position_m: f64, most_n: f64) {
        if self.rendered.is_some_and(|(own, _)| own == sequence) {
            return;
        }
        let Some(packet) = packet.filter(|packet| packet.sequence == sequence) else {
            return;
        };
        let Ok(Some(reflected)) = packet.reflected() else {
            return;
        };
        let before = self.rendered.map(|(_, before)| before);
        let same = before.is_some_and(|before| before == reflected);
        self.rendered = Some((sequence, reflected));
        if same {
            return;
        }
        let before_j = before.map_or(0.0, |before| stored_j(&before, position_m, most_n));
        self.exchanged_j += stored_j(&reflected, position_m, most_n) - before_j;
    }

    /// The sum so far (J).
    pub fn exchanged_j(&self) -> f64 {
        self.exchanged_j
    }

    /// The energy that is stored in what is rendered, at a position (m).
    pub fn stored_j(&self, position_m: f64, most_n: f64) -> f64 {
        self.rendered
            .map_or(0.0, |(_, of)| stored_j(&of, position_m, most_n))
    }
}

/// ∫F⁽ᵉ⁾dδ up to a position (J).
fn stored_j(of: &Reflected, position_m: f64, most_n: f64) -> f64 {
    let depth_m = position_m - f64::from(of.surface_m);
    if depth_m <= 0.0 {
        return 0.0;
    }
    let width_m = depth_m / f64::from(STEPS);
    let forces = (0..STEPS).map(|step| {
        let at_m = (f64::from(step) + 0.5) * width_m;
        f64::from(of.impedance.elastic_n(at_m as f32)).clamp(0.0, most_n)
    });
    width_m * forces.sum::<f64>()
}
