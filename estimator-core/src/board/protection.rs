//! The latch of the force output: it rests after a reset, until somebody arms it, and after a fault that makes
//! the force unsafe, until somebody arms it again.

use crate::estimate::fault::{Fault, Faults};

/// The number of an arming; 0 is a board that is not armed. Each arming has another number, so that a latch
/// opens for a new one only.
pub type Arming = u16;

/// The faults that latch: the force belongs to another instant, or to no position.
pub const LATCHING: [Fault; 3] = [Fault::Overrun, Fault::PositionUnusable, Fault::PositionJump];

/// The state of the latch, which the sampling task owns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Latch {
    /// The arming under which the faults came.
    under: Arming,
    faults: Faults,
}

impl Latch {
    /// A board that is not armed yet.
    pub const fn new() -> Self {
        Latch {
            under: 0,
            faults: Faults::NONE,
        }
    }

    /// Takes the faults of an instant and returns whether a force may be put out under `arming`.
    pub fn update(&mut self, arming: Arming, faults: Faults) -> bool {
        if arming != self.under {
            *self = Latch {
                under: arming,
                faults: Faults::NONE,
            };
        }
        if arming != 0 {
            self.faults = self.faults | LATCHED.intersection(faults);
        }
        arming != 0 && self.faults == Faults::NONE
    }

    /// Returns the faults since the last arming that hold the output at rest.
    pub fn faults(&self) -> Faults {
        self.faults
    }

    /// Returns whether a fault holds the output at rest under this arming. A fault that came under another one says
    /// nothing about it.
    pub fn holds(&self, arming: Arming) -> bool {
        self.faults != Faults::NONE && arming == self.under
    }
}

const LATCHED: Faults = {
    let (mut all, mut at) = (Faults::NONE, 0);
    while at < LATCHING.len() {
        all = all.with(LATCHING[at]);
        at += 1;
    }
    all
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_force_needs_an_arming_and_a_fault_ends_it_until_the_next_one() {
        let mut latch = Latch::default();
        assert!(!latch.update(0, Faults::NONE), "after a reset");
        assert!(latch.update(1, Faults::NONE));
        for fault in LATCHING {
            let number = 2 + u16::from(fault.code());
            assert!(latch.update(number, Faults::NONE));
            assert!(!latch.update(number, Faults::NONE.with(fault)), "{fault:?}");
            assert!(!latch.update(number, Faults::NONE), "it stays");
            assert_eq!(latch.faults(), Faults::NONE.with(fault));
            assert!(latch.holds(number) && !latch.holds(number + 1), "{fault:?}");
        }
        assert!(latch.update(99, Faults::NONE), "armed again");
        assert_eq!(latch.faults(), Faults::NONE);
        assert!(!latch.holds(99));
        assert!(!latch.update(0, Faults::NONE), "disarmed");
    }

    #[test]
    fn a_fault_that_says_nothing_about_the_position_latches_nothing() {
        let others = Fault::ALL
            .into_iter()
            .filter(|fault| !LATCHING.contains(fault));
        let mut latch = Latch::default();
        for fault in others {
            assert!(latch.update(1, Faults::NONE.with(fault)), "{fault:?}");
        }
    }
}
