//! Whether the surface pulls when the probe leaves it, which no law of contact here does.

use crate::estimate::Phase;

/// Samples after a lift-off in which a surface that adheres still pulls, and how many must.
const PULL_WITHIN: u32 = 64;
const PULL_SAMPLES: u32 = 4;

/// Watches whether the surface pulls when the probe leaves it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pull {
    since_contact: u32,
    below: u32,
    pub(super) has_pulled: bool,
}

impl Pull {
    /// Takes the phase of a sample, and whether its force is below zero.
    pub(super) fn observe(&mut self, phase: Phase, below: bool) {
        if phase == Phase::Contact {
            (self.since_contact, self.below) = (0, 0);
        }
        self.since_contact = self.since_contact.saturating_add(1);
        if self.since_contact <= PULL_WITHIN {
            self.below += u32::from(below);
            if self.below >= PULL_SAMPLES {
                self.has_pulled = true;
            }
        } else if self.since_contact == PULL_WITHIN + 1 {
            self.has_pulled = self.below >= PULL_SAMPLES;
        }
    }
}
