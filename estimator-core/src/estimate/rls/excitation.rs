//! The gate of excitation: samples are learned from while the regressor moves.

use nalgebra::SVector;

use crate::maths::scalar::Real;

/// Number of samples that are learned from after a motion of the regressor: every sample counts as
/// long as the regressor moves by its step within this many.
const OPEN_SAMPLES: u32 = 64;

/// Gate that is open while the regressor moves. A hold repeats one regressor, and with forgetting the
/// covariance grows in every other direction until the estimates diverge, after 60 s at the chapter's
/// forgetting factor of 0.9988.
#[derive(Clone, Copy, Debug)]
pub struct Excitation<T: Real, const N: usize> {
    /// The regressor at its last motion.
    from: SVector<T, N>,
    /// Number of samples for which the gate stays open.
    open: u32,
}

impl<T: Real, const N: usize> Default for Excitation<T, N> {
    fn default() -> Self {
        Excitation {
            from: SVector::repeat(T::zero()),
            open: 0,
        }
    }
}

impl<T: Real, const N: usize> Excitation<T, N> {
    /// Whether to learn from `phi`: within the last 64 samples it has moved by the fraction `step` of its
    /// largest component.
    pub fn admits(&mut self, phi: &SVector<T, N>, step: T) -> bool {
        let mut moved = T::zero();
        let mut scale = T::zero();
        for (now, before) in phi.iter().zip(self.from.iter()) {
            moved = moved.max_of((*now - *before).abs());
            scale = scale.max_of(now.abs());
        }
        if moved > step * scale {
            self.from = *phi;
            self.open = OPEN_SAMPLES;
        } else {
            self.open = self.open.saturating_sub(1);
        }
        self.open > 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector2;

    #[test]
    fn a_hold_closes_the_gate_and_motion_opens_it() {
        let mut gate = Excitation::<f64, 2>::default();
        let hold = Vector2::new(2.0, 1e-4);
        let admitted = (0..1000).filter(|_| gate.admits(&hold, 0.01)).count();
        assert_eq!(admitted, OPEN_SAMPLES as usize);
        assert!(gate.admits(&Vector2::new(2.03, 0.0), 0.01));
    }

    #[test]
    fn a_slow_ramp_keeps_it_open() {
        // 1 mm/s at a depth of 1 mm: 0.1 % per sample.
        let mut gate = Excitation::<f64, 2>::default();
        assert!(
            (0..1000).all(|i| gate.admits(&Vector2::new(1.0 + 1e-3 * f64::from(i), 0.1), 0.01))
        );
    }
}
