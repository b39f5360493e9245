//! Numbered faults of samples and boards.

/// A fault of a sample or of a board. The codes are stable, since frames, logs and `estimate.json`
/// contain them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
#[repr(u8)]
pub enum Fault {
    /// The force is NaN, infinite, beyond [`crate::estimate::estimator::RANGE`], or has jumped there and
    /// back as [`crate::board::sensing`] sees it; the sample is dropped.
    ForceUnusable = 1,
    /// The position is NaN, infinite or beyond [`crate::estimate::estimator::RANGE`]; the sample is dropped.
    PositionUnusable = 2,
    /// The time stamp is not later than that of the last sample; the sample is dropped.
    TimeNotAdvancing = 3,
    /// More than 1.5 periods have passed since the last sample; the filters start anew.
    SampleMissed = 4,
    /// The force is at the end of its range; the sample is not learned from.
    ForceSaturated = 5,
    /// The 1 kHz task was late. Reported by the board.
    Overrun = 6,
    /// The result of a calculation was not finite; the estimator started anew.
    NotFinite = 7,
    /// The force has not changed for too long, because the converter hangs or a cable is off; the sample
    /// is not learned from. Reported by [`crate::board::sensing`].
    ForceStuck = 8,
    /// The position moved faster than the probe can; the filters start anew. Reported by
    /// [`crate::board::sensing`].
    PositionJump = 9,
    /// The force rises while the position does not change; the sample is not learned from. Reported by
    /// [`crate::board::sensing`].
    PositionStuck = 10,
    /// The stored settings of the board cannot be used, and it runs on the defaults.
    SettingsInvalid = 11,
    /// Force or position has not been calibrated: their scale is that of the data sheets.
    NotCalibrated = 12,
    /// The law does not explain the force. Reported by the board in its [`crate::board::link::Health`];
    /// in an estimate the status `model_suspect` says it.
    EstimatorSuspect = 13,
    /// The crystal of the board does not run, and its clock is the internal oscillator: time, speed and
    /// damping are wrong by up to 1 % at 25 °C, and 8 % beyond. Reported by the board.
    ClockInternal = 14,
    /// No impedances to render arrive any more, and the force fades out. Reported by
    /// [`crate::board::reflection::Renderer`].
    RenderStopped = 15,
    /// The impedance or the position to render is not a usable number, and the force is zero. Reported by
    /// [`crate::board::reflection::Renderer`].
    RenderUnusable = 16,
}

impl Fault {
    /// All faults in the order of their codes.
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

    /// The stable code of the fault.
    pub const fn code(self) -> u8 {
        self as u8
    }

    /// The name of the fault, as files contain it.
    pub const fn name(self) -> &'static str {
        match self {
            Fault::ForceUnusable => "force_unusable",
            Fault::PositionUnusable => "position_unusable",
            Fault::TimeNotAdvancing => "time_not_advancing",
            Fault::SampleMissed => "sample_missed",
            Fault::ForceSaturated => "force_saturated",
            Fault::Overrun => "overrun",
            Fault::NotFinite => "not_finite",
            Fault::ForceStuck => "force_stuck",
            Fault::PositionJump => "position_jump",
            Fault::PositionStuck => "position_stuck",
            Fault::SettingsInvalid => "settings_invalid",
            Fault::NotCalibrated => "not_calibrated",
            Fault::EstimatorSuspect => "estimator_suspect",
            Fault::ClockInternal => "clock_internal",
            Fault::RenderStopped => "render_stopped",
            Fault::RenderUnusable => "render_unusable",
        }
    }

    /// The fault with this code.
    pub fn with_code(code: u8) -> Option<Fault> {
        Fault::ALL.into_iter().find(|fault| fault.code() == code)
    }

    /// Describes the fault in a short sentence for people.
    pub const fn describe(self) -> &'static str {
        match self {
            Fault::ForceUnusable => "force is no usable number or a spike, sample dropped",
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
            Fault::ClockInternal => {
                "clock is the internal oscillator, rates off by up to 1 % at 25 °C, 8 % beyond"
            }
            Fault::RenderStopped => "no impedance to render comes any more, force faded out",
            Fault::RenderUnusable => "rendering met no usable number, force is zero",
        }
    }
}

/// A set of [`Fault`]s, in which bit `code − 1` stands for the fault with that code.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Faults(u16);

impl Faults {
    /// The empty set.
    pub const NONE: Faults = Faults(0);

    /// The bits of the set, as frames contain them.
    pub const fn bits(self) -> u16 {
        self.0
    }

    /// The set with these bits of a frame; unknown bits are kept.
    pub const fn from_bits(bits: u16) -> Faults {
        Faults(bits)
    }

    /// Adds a fault to the set.
    pub const fn with(self, fault: Fault) -> Faults {
        Faults(self.0 | 1 << (fault.code() - 1))
    }

    /// Whether the fault is in the set.
    pub const fn has(self, fault: Fault) -> bool {
        self.0 & (1 << (fault.code() - 1)) != 0
    }

    /// Whether the two sets have a fault in common.
    pub const fn intersects(self, others: Faults) -> bool {
        self.0 & others.0 != 0
    }

    /// The faults that are in both sets.
    pub const fn intersection(self, others: Faults) -> Faults {
        Faults(self.0 & others.0)
    }

    /// The faults in the set, in the order of their codes.
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
