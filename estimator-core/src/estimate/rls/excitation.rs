//! When there is something to learn: the regressor moves.

use nalgebra::SVector;

use crate::maths::scalar::Real;

/// Samples that are learned from after the regressor has last moved: as long as the regressor
/// moves by its step within this many samples, every sample counts.
const STAY_OPEN: u32 = 64;

/// Gate on the motion of the regressor. A hold repeats one regressor: under forgetting it would
/// wind the covariance up in every other direction until the estimates explode (60 s at the
/// chapter's 0.9988).
#[derive(Clone, Copy, Debug)]
pub struct Excitation<T: Real, const N: usize> {
    from: SVector<T, N>,
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
    /// Whether to learn from `phi`: it has moved by `step` of its largest component within the last
    /// 64 samples.
    pub fn admits(&mut self, phi: &SVector<T, N>, step: T) -> bool {
        let mut moved = T::zero();
        let mut scale = T::zero();
        for (now, before) in phi.iter().zip(self.from.iter()) {
            moved = moved.max_of((*now - *before).abs());
            scale = scale.max_of(now.abs());
        }
        if moved > step * scale {
            self.from = *phi;
            self.open = STAY_OPEN;
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
        assert_eq!(admitted, STAY_OPEN as usize);
        assert!(gate.admits(&Vector2::new(2.03, 0.0), 0.01));
    }

    #[test]
    fn a_slow_ramp_keeps_it_open() {
        // 1 mm/s at 1 mm of depth: 0.1 % a sample.
        let mut gate = Excitation::<f64, 2>::default();
        assert!(
            (0..1000).all(|i| gate.admits(&Vector2::new(1.0 + 1e-3 * f64::from(i), 0.1), 0.01))
        );
    }
}
