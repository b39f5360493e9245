//! What can be wrong with a sample or a board, by number.

/// A numbered fault. The numbers are stable: they stand in frames, logs and `estimate.json`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Fault {
    /// The force is NaN, infinite or beyond [`crate::estimate::estimator::RANGE`]; the sample is dropped.
    ForceUnusable = 1,
    /// The position is NaN, infinite or beyond [`crate::estimate::estimator::RANGE`]; the sample is dropped.
    PositionUnusable = 2,
    /// The time did not advance; the sample is dropped.
    TimeNotAdvancing = 3,
    /// More than 1.5 periods since the last sample; the filters start anew.
    SampleMissed = 4,
    /// The force channel stands at the end of its range; the sample is not learned from.
    ForceSaturated = 5,
    /// The 1 kHz task was late; reported by the board.
    Overrun = 6,
    /// A calculation left the finite numbers; the estimator started anew.
    NotFinite = 7,
    /// The force has had one code for too long: a converter that hangs, a cable that is off; the
    /// sample is not learned from. Reported by [`crate::board::sensing`], as are the next four.
    ForceStuck = 8,
    /// The position moved faster than the probe can; the filters start anew.
    PositionJump = 9,
    /// The force rises while the position stands still; the sample is not learned from.
    PositionStuck = 10,
    /// The settings in the board's memory cannot be used, and the defaults took their place.
    SettingsInvalid = 11,
    /// Force or position has not been calibrated: numbers have the scale of the wiring's data sheet.
    NotCalibrated = 12,
    /// The law does not explain the force: the estimate's status is `model_suspect`. Reported by the
    /// board in its [`crate::board::link::Health`]; an estimate says it by its status.
    EstimatorSuspect = 13,
    /// The board's crystal is dead and its clock the internal oscillator: time is off by up to 1 %,
    /// speed and damping with it. Reported by the board.
    ClockInternal = 14,
    /// Impedances to render have stopped coming: the force has faded out, or is about to. Reported by
    /// [`crate::board::reflection::Renderer`], as is the next.
    RenderStopped = 15,
    /// What is rendered is not a usable number, or the position that it is rendered at is none: the
    /// force is zero.
    RenderUnusable = 16,
}

impl Fault {
    /// All faults in the order of their numbers.
    pub const ALL: [Fault; 16] = [
        Fault::ForceUnusable,
        Fault::PositionUnusable,
        Fault::TimeNotAdvancing,
        Fault::SampleMissed,
        Fault::ForceSaturated,
        Fault::Overrun,
        Fault::NotFinite,
        Fault::ForceStuck,
        Fault::PositionJump,
        Fault::PositionStuck,
        Fault::SettingsInvalid,
        Fault::NotCalibrated,
        Fault::EstimatorSuspect,
        Fault::ClockInternal,
        Fault::RenderStopped,
        Fault::RenderUnusable,
    ];

    /// The stable number.
    pub const fn code(self) -> u8 {
        self as u8
    }

    /// A short sentence for people.
    pub const fn describe(self) -> &'static str {
        match self {
            Fault::ForceUnusable => "force is not a usable number, sample dropped",
            Fault::PositionUnusable => "position is not a usable number, sample dropped",
            Fault::TimeNotAdvancing => "time does not advance, sample dropped",
            Fault::SampleMissed => "samples missing, filters restarted",
            Fault::ForceSaturated => "force at the end of its range, sample not learned from",
            Fault::Overrun => "the sampling task was late",
            Fault::NotFinite => "calculation left the finite numbers, estimator restarted",
            Fault::ForceStuck => "force does not change at all, sample not learned from",
            Fault::PositionJump => "position jumped, filters restarted",
            Fault::PositionStuck => {
                "force rises but position stands still, sample not learned from"
            }
            Fault::SettingsInvalid => "stored settings cannot be used, running on defaults",
            Fault::NotCalibrated => "sensors are not calibrated, scale is nominal",
            Fault::EstimatorSuspect => "the law does not explain the force",
            Fault::ClockInternal => "clock is the internal oscillator, rates off by up to 1 %",
            Fault::RenderStopped => "no impedance to render comes any more, force faded out",
            Fault::RenderUnusable => "rendering met no usable number, force is zero",
        }
    }
}

/// A set of [`Fault`]s; bit `code − 1` stands for the fault with that code.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Faults(u16);

impl Faults {
    /// Nothing wrong.
    pub const NONE: Faults = Faults(0);

    /// The set as bits, for frames.
    pub const fn bits(self) -> u16 {
        self.0
    }

    /// The set from bits of a frame; unknown bits are kept.
    pub const fn from_bits(bits: u16) -> Faults {
        Faults(bits)
    }

    /// This set and one fault more.
    pub const fn with(self, fault: Fault) -> Faults {
        Faults(self.0 | 1 << (fault.code() - 1))
    }

    /// Whether the fault is in the set.
    pub const fn has(self, fault: Fault) -> bool {
        self.0 & (1 << (fault.code() - 1)) != 0
    }

    /// The faults in the set, by number.
    pub fn iter(self) -> impl Iterator<Item = Fault> {
        Fault::ALL.into_iter().filter(move |fault| self.has(*fault))
    }
}

impl core::ops::BitOr for Faults {
    type Output = Faults;
    fn bitor(self, other: Faults) -> Faults {
        Faults(self.0 | other.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_codes_are_stable_and_the_list_is_complete() {
        let codes: [u8; 16] = Fault::ALL.map(Fault::code);
        assert_eq!(
            codes,
            [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16]
        );
    }

    #[test]
    fn a_set_gives_back_what_was_put_in() {
        let set = Faults::NONE.with(Fault::SampleMissed).with(Fault::Overrun);
        let mut members = set.iter();
        assert_eq!(members.next(), Some(Fault::SampleMissed));
        assert_eq!(members.next(), Some(Fault::Overrun));
        assert_eq!(members.next(), None);
        assert_eq!(Faults::from_bits(set.bits()), set);
    }
}
