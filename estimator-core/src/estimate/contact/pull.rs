//! Whether the surface pulls at the probe, when it is met or when it is left, which no law of contact here does.

use crate::estimate::Phase;

/// So many samples in the 64 before a touch or after a lift-off that lie below zero are a pull.
const PULL_SAMPLES: u32 = 4;
/// Samples after a lift-off in which a surface that adheres still pulls: those that are remembered.
const PULL_WITHIN: u32 = u64::BITS;

/// Watches whether the surface pulls.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pull {
    /// Samples since the last contact, 0 in contact.
    since_contact: u32,
    /// A bit for each of the last samples: whether its force was below zero.
    below: u64,
    pub(super) has_pulled: bool,
}

impl Pull {
    /// Takes the phase of a sample, and whether its force is below zero. A surface that jumps to the probe is
    /// known to pull at the touch, before the estimates that it bends have been believed once; a lift-off
    /// answers anew.
    pub(super) fn observe(&mut self, phase: Phase, below: bool) {
        self.below = self.below << 1 | u64::from(below);
        if phase != Phase::Contact {
            self.since_contact = self.since_contact.saturating_add(1);
            if self.since_contact == PULL_WITHIN {
                self.has_pulled = self.is_pulling();
            }
        } else if self.since_contact > 0 {
            self.since_contact = 0;
            self.has_pulled |= self.is_pulling();
        }
    }

    fn is_pulling(&self) -> bool {
        self.below.count_ones() >= PULL_SAMPLES
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether it pulls after a stretch of samples in this phase, the first of them below zero.
    fn after(pull: &mut Pull, phase: Phase, samples: u32, below: u32) -> bool {
        for at in 0..samples {
            pull.observe(phase, at < below);
        }
        pull.has_pulled
    }

    #[test]
    fn a_surface_that_jumps_to_the_probe_pulls_from_the_touch_on() {
        let mut pull = Pull::default();
        assert!(!after(&mut pull, Phase::Free, 500, 0));
        assert!(!after(&mut pull, Phase::Free, PULL_SAMPLES, PULL_SAMPLES));
        assert!(after(&mut pull, Phase::Contact, 1, 0));
        // Left without a pull, it is none: the force had another reason.
        assert!(after(&mut pull, Phase::Contact, 500, 0));
        assert!(!after(&mut pull, Phase::Free, PULL_WITHIN, 0));
    }

    #[test]
    fn a_surface_that_holds_on_pulls_until_it_is_left_without() {
        let mut pull = Pull::default();
        assert!(!after(&mut pull, Phase::Contact, 500, 0));
        assert!(after(&mut pull, Phase::Free, PULL_WITHIN, PULL_SAMPLES));
        assert!(after(&mut pull, Phase::Free, 500, 0));
        assert!(after(&mut pull, Phase::Contact, 500, 0));
        assert!(!after(&mut pull, Phase::Free, PULL_WITHIN, 0));
    }

    #[test]
    fn samples_that_chance_puts_below_zero_are_no_pull() {
        let mut pull = Pull::default();
        for at in 0..5000_u32 {
            pull.observe(Phase::Free, at.is_multiple_of(32));
        }
        assert!(!after(&mut pull, Phase::Contact, 1, 0));
    }
}
