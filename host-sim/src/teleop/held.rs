//! What the slave sends of what it knows: the best that it has, and not always the last.
//!
//! A board says what it estimates now. On a material that its law does not explain, parameters come and go: some are
//! not observable for a while, some changes of material are none, and an estimate that has just begun anew may be
//! worse than the one before. A master that is told of nothing puts no force out, and the operator goes in until
//! something does: on a foam at 2 s of round trip 11 mm and 46 N deep, which taught the estimator another foam. So
//!
//! - an estimate that has converged is sent;
//! - any other complete one is, if it explains the last touches better than the one that was sent before (a board
//!   that has flagged a change goes on to report the old one for a while);
//! - otherwise that one is sent again, as large as the last touches say. After a change of material it is sent as
//!   [`Status::Changed`], until something explains the new one better or nothing has: neither the guard nor anybody
//!   else takes it for an answer.
//!
//! The slave's host does this, in the simulated system and in the bridge.

use std::collections::VecDeque;

use estimator_core::Status;
use estimator_core::board::reflection::{Packet, Reflected};

/// The slave at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// Position (m).
    pub position_m: f32,
    /// Speed (m/s).
    pub speed_mps: f32,
    /// The material's force (N).
    pub force_n: f32,
}

/// A force that is a contact (N): ten times the noise of the load cell.
const TOUCHED_N: f32 = 0.2;
/// Touches that are remembered: at 100 a second a stroke of palpation at 0.8 Hz, in and out.
const TOUCHES: usize = 64;
/// Touches that say how large it is: 0.1 s of them, in which a hand has gone in by a millimetre. Not measured.
const ENOUGH: usize = 10;
/// A smaller difference is below what people feel.
const FELT: f32 = 0.05;

/// What is known, and the last touches.
#[derive(Clone, Debug, Default)]
pub struct Held {
    known: Option<Packet>,
    /// Whether it is of a material that is no longer there.
    is_of_before: bool,
    touches: VecDeque<Touch>,
    /// How deep the material was touched from which what is known was learned (m).
    learned_to_m: f32,
}

impl Held {
    /// Remembers an instant at which the slave touches something.
    pub fn observe(&mut self, touch: Touch) {
        if touch.force_n > TOUCHED_N {
            if self.touches.len() == TOUCHES {
                self.touches.pop_front();
            }
            self.touches.push_back(touch);
            if !self.is_of_before {
                self.learned_to_m = self.learned_to_m.max(touch.position_m);
            }
        }
    }

    /// The packet that goes to the master for one that has come from the board.
    pub fn complete(&mut self, packet: Packet) -> Packet {
        // A board that has started anew may be another rig.
        if self
            .known
            .is_some_and(|known| packet.time_us < known.time_us)
        {
            *self = Held::default();
        }
        if packet.status == Status::Changed && !self.is_of_before {
            self.is_of_before = true;
            self.touches.clear();
        }
        if !self.is_better(&packet) {
            self.rescale();
        } else {
            self.known = Some(packet);
            if self.is_of_before {
                let depths = self.touches.iter().map(|touch| touch.position_m);
                self.learned_to_m = depths.fold(0.0, f32::max);
            }
            // What a change begins with may still be the old one.
            self.is_of_before = packet.status == Status::Changed;
        }
        // Nothing explains the touches since the change better: it was none, or this is the best there is.
        self.is_of_before &= self.touches.len() < TOUCHES;
        let Some(known) = &self.known else {
            return packet;
        };
        let mut held = packet.with_parameters_of(known);
        if self.is_of_before {
            held.status = Status::Changed;
        }
        held
    }

    /// What is known, as large as the last touches say.
    fn rescale(&mut self) {
        let Some(known) = self.known.filter(|_| self.touches.len() >= ENOUGH) else {
            return;
        };
        let Ok(Some(of)) = known.reflected() else {
            return;
        };
        // The factor with the least squares of what is left.
        let sums = self.touches.iter().map(|touch| {
            let predicted_n = predicted_n(&of, touch);
            (predicted_n * touch.force_n, predicted_n * predicted_n)
        });
        let (both, square) = sums.fold((0.0, 0.0), |sum, own| (sum.0 + own.0, sum.1 + own.1));
        let factor = both / square;
        if factor.is_finite() && (factor - 1.0).abs() > FELT {
            self.known = Some(known.scaled(factor));
        }
    }

    /// Whether a packet says more than what is known.
    fn is_better(&self, packet: &Packet) -> bool {
        let Ok(Some(new)) = packet.reflected() else {
            return false;
        };
        let known = self
            .known
            .and_then(|known| known.reflected().ok().flatten());
        match known {
            Some(known) if packet.status != Status::Converged => {
                self.touches.is_empty() || self.square_error(&new) < self.square_error(&known)
            }
            _ => true,
        }
    }

    /// How many times as large the forces of a material that has just taken the place of another one are as what is
    /// known of that one predicts, rms over rms; `None` without a change, or without a touch since. What lies deeper than
    /// was ever touched is not compared: a stiffer layer is met there, and no other material.
    pub fn stiffer_since_change(&self) -> Option<f64> {
        let known = self.known.filter(|_| self.is_of_before)?;
        let of = known.reflected().ok().flatten()?;
        let sum = |force_n: fn(&Reflected, &Touch) -> f32| {
            let known = |touch: &&Touch| touch.position_m <= self.learned_to_m;
            let squares = self.touches.iter().filter(known);
            f64::from(
                squares
                    .map(|touch| force_n(&of, touch).powi(2))
                    .sum::<f32>(),
            )
        };
        let (felt, predicted) = (sum(|_, touch| touch.force_n), sum(predicted_n));
        (felt > 0.0).then(|| (felt / predicted.max(1e-9)).sqrt())
    }

    /// The sum of the squares by which an impedance misses the forces of the last touches (N²).
    fn square_error(&self, of: &Reflected) -> f32 {
        let square = |touch: &Touch| (predicted_n(of, touch) - touch.force_n).powi(2);
        self.touches.iter().map(square).sum()
    }
}

/// What an impedance makes of a touch (N).
fn predicted_n(of: &Reflected, touch: &Touch) -> f32 {
    let depth_m = touch.position_m - of.surface_m;
    of.impedance.force_n(depth_m, touch.speed_mps).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use estimator_core::estimate::Estimated;
    use estimator_core::{Config, Faults, Sample, State, step};

    /// A packet of a linear spring (N/m) from 0 m on, or without its parameters.
    fn packet(time_us: u64, stiffness: Option<f32>, status: Status) -> Packet {
        let params = Config::default().validate::<f32>().unwrap();
        let sample = Sample {
            time_us,
            position_m: 0.0,
            force_n: 0.0,
            faults: Faults::NONE,
        };
        let mut estimate = step(&params, &mut State::new(&params), sample);
        // Stiffness, damping, exponent, surface.
        for (slot, rest) in
            estimate
                .parameters
                .iter_mut()
                .zip([None, Some(0.0), Some(1.0), Some(0.0)])
        {
            *slot = stiffness.map(|stiffness| Estimated {
                value: rest.unwrap_or(stiffness),
                std_error: 0.1,
            });
        }
        (estimate.time_us, estimate.status) = (time_us, status);
        Packet::of(&estimate, 1e-3, 1)
    }

    fn sent(
        held: &mut Held,
        time_us: u64,
        known: Option<f32>,
        status: Status,
    ) -> (Option<f32>, Status) {
        let sent = held.complete(packet(time_us, known, status));
        assert_eq!(sent.time_us, time_us);
        (sent.parameters()[0].map(|known| known.value), sent.status)
    }

    #[test]
    fn what_was_known_is_kept_until_something_else_is_and_is_said_to_be_of_before_a_change() {
        let held = &mut Held::default();
        let (suspect, changed) = (Status::ModelSuspect, Status::Changed);
        assert_eq!(sent(held, 1, None, suspect), (None, suspect));
        assert_eq!(sent(held, 2, Some(1.0), suspect), (Some(1.0), suspect));
        assert_eq!(sent(held, 3, None, suspect), (Some(1.0), suspect));
        assert_eq!(sent(held, 4, None, changed), (Some(1.0), changed));
        assert_eq!(sent(held, 5, None, suspect), (Some(1.0), changed));
        assert_eq!(sent(held, 6, Some(2.0), suspect), (Some(2.0), suspect));
        assert_eq!(sent(held, 7, None, suspect), (Some(2.0), suspect));
        // A board that has started anew.
        assert_eq!(sent(held, 1, None, suspect), (None, suspect));
    }

    #[test]
    fn what_explains_the_last_touches_worse_is_not_sent_unless_it_has_converged() {
        let held = &mut Held::default();
        let suspect = Status::ModelSuspect;
        assert_eq!(sent(held, 1, Some(900.0), suspect).0, Some(900.0));
        for position_m in [1e-3, 2e-3, 3e-3] {
            let (speed_mps, force_n) = (0.0, 1000.0 * position_m);
            held.observe(Touch {
                position_m,
                speed_mps,
                force_n,
            });
        }
        assert_eq!(sent(held, 2, Some(7000.0), suspect).0, Some(900.0));
        assert_eq!(sent(held, 3, Some(1050.0), suspect).0, Some(1050.0));
        assert_eq!(sent(held, 4, Some(900.0), suspect).0, Some(1050.0));
        assert_eq!(sent(held, 5, Some(900.0), Status::Converged).0, Some(900.0));
        // Of another material the old touches say nothing.
        assert_eq!(sent(held, 6, None, Status::Changed).0, Some(900.0));
        assert_eq!(sent(held, 7, Some(7000.0), suspect).0, Some(7000.0));
    }

    fn touch(position_m: f32, force_n: f32) -> Touch {
        Touch {
            position_m,
            speed_mps: 0.0,
            force_n,
        }
    }

    #[test]
    fn what_is_held_is_as_large_as_the_last_touches_say() {
        let held = &mut Held::default();
        sent(held, 1, Some(1000.0), Status::Converged);
        // The board goes on to report the old one.
        sent(held, 2, Some(1000.0), Status::Changed);
        let steps = 1..=ENOUGH as u16;
        for position_m in steps.map(|step| 1e-4 * f32::from(step)) {
            let known = sent(held, 3, Some(1000.0), Status::Changed);
            assert_eq!(known, (Some(1000.0), Status::Changed));
            held.observe(touch(position_m, 300.0 * position_m + 0.25));
        }
        let (found, status) = sent(held, 4, Some(1000.0), Status::Changed);
        // Σ F·x/Σ x² of these touches.
        let exact = 300.0 + 0.25 * 55.0 / (385.0 * 1e-4);
        assert!(
            (found.unwrap() / exact - 1.0).abs() < 1e-4,
            "{found:?} for {exact}"
        );
        assert_eq!(status, Status::Changed);
    }

    #[test]
    fn another_material_is_stiffer_where_the_one_before_was_touched_and_a_layer_is_where_it_was_not()
     {
        for (position_m, stiffer) in [(1e-3, Some(6.0)), (3e-3, None)] {
            let held = &mut Held::default();
            held.observe(touch(2e-3, 2.0));
            sent(held, 1, Some(1000.0), Status::Converged);
            assert_eq!(held.stiffer_since_change(), None);
            sent(held, 2, None, Status::Changed);
            held.observe(touch(position_m, 6e3 * position_m));
            let found = held.stiffer_since_change();
            assert_eq!(found.map(|found| found.round()), stiffer, "{position_m}");
        }
    }
}
