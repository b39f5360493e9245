//! How long a fault of one sample stays with the results.

use crate::estimate::fault::Faults;

/// Faults of the samples that a window still contains.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LingeringFaults {
    faults: Faults,
    remaining_samples: usize,
}

impl LingeringFaults {
    /// Takes the faults of one sample; gives them with those of the samples before it, for as long as
    /// the last of them is within `memory_samples`.
    pub(super) fn update(&mut self, faults: Faults, memory_samples: usize) -> Faults {
        if faults != Faults::NONE {
            self.faults = self.faults | faults;
            self.remaining_samples = memory_samples;
        } else {
            self.remaining_samples = self.remaining_samples.saturating_sub(1);
        }
        if self.remaining_samples == 0 {
            self.faults = Faults::NONE;
        }
        self.faults
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::fault::Fault;

    #[test]
    fn a_fault_stays_for_the_memory_of_the_window() {
        let mut lingering = LingeringFaults::default();
        let stuck = Faults::NONE.with(Fault::ForceStuck);
        for i in 0..20 {
            let faults = if i == 5 { stuck } else { Faults::NONE };
            let expected = if (5..8).contains(&i) {
                stuck
            } else {
                Faults::NONE
            };
            assert_eq!(lingering.update(faults, 3), expected, "{i}");
        }
    }
}
