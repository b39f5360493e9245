//! The table of settings: number, name, unit, bounds, default, and what each decides.

use super::compensation::{self, Parameter};
use crate::estimate::fault::Fault;
use core::fmt;

/// How many settings there are.
pub const COUNT: usize = Key::ALL.len();
/// How many of them are of the board itself, before the section `compensation`, and after it.
const OWN: usize = 19;
const AFTER: usize = 9;

/// A setting. Its number ([`Key::id`]) is stable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Key {
    /// Newtons per code of the load cell's converter; negative if the code falls with the force.
    ForcePerCode,
    /// The code that stands for 0 N.
    ForceZeroCode,
    /// A single conversion below this is saturated.
    ForceLowestCode,
    /// A single conversion above this is saturated.
    ForceHighestCode,
    /// The same code for this long is a stuck converter; 0: never.
    ForceStuckS,
    /// Whether the two values above came from known weights.
    ForceCalibrated,
    /// Root mean square of what the calibration left over.
    ForceResidualN,
    /// Metres per code of the encoder; negative if it counts down into the material.
    PositionPerCode,
    /// A faster motion between two samples is a jump; 0: never.
    PositionFastestMps,
    /// A force that rises by this much over a position that stands still is a stuck encoder; 0: never.
    PositionStuckN,
    /// Whether the encoder's scale and sign were checked.
    PositionCalibrated,
    /// Number of the [`Method`].
    EstimatorMethod,
    /// δ₀: the depth that parameters are reported at.
    EstimatorDepthM,
    /// A typical force.
    EstimatorForceN,
    /// Samples on either side of the Savitzky–Golay filter's centre.
    EstimatorHalfWidth,
    /// Touch at this many standard deviations of the filtered force.
    EstimatorTouchSigma,
    /// Lift-off below this many.
    EstimatorReleaseSigma,
    /// Free air at the start.
    EstimatorSettleS,
    /// Every how many samples are sent.
    TelemetryEvery,
    /// A parameter of an effect of the rig that is taken off before the estimator.
    Compensation(Parameter),
    /// Every how many samples the identified impedance is sent to the other side; 0: never.
    ReflectionEvery,
    /// Largest force that is rendered; 0: nothing is.
    RenderForceN,
    /// Force of the full output; negative if the output falls with the force.
    RenderFullN,
    /// Share of the full output that stands for 0 N.
    RenderZero,
    /// Damping of the master itself, which bounds what it can render.
    RenderDeviceNsPerM,
    /// Fastest change of the force.
    RenderSlewNps,
    /// Without a packet for so long the force fades out.
    RenderTimeoutS,
    /// In which it fades out, and a new packet comes in.
    RenderFadeS,
    /// Factor on the impedance.
    RenderShaping,
}

/// Which values a setting can have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bounds {
    /// From the first to the second.
    Within(f32, f32),
    /// From the first to the second in magnitude, of either sign.
    Signed(f32, f32),
    /// Whole numbers from the first to the second.
    Whole(f32, f32),
}

impl Bounds {
    /// Whether a value is one of them; NaN never is.
    #[inline(never)]
    pub fn hold(self, value: f32) -> bool {
        match self {
            Bounds::Within(low, high) => (low..=high).contains(&value),
            Bounds::Signed(low, high) => (low..=high).contains(&value.abs()),
            Bounds::Whole(low, high) => {
                (low..=high).contains(&value) && libm::floorf(value) == value
            }
        }
    }
}

impl fmt::Display for Bounds {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Bounds::Within(low, high) => write!(f, "from {low} to {high}"),
            Bounds::Signed(low, high) => write!(f, "from {low:e} to {high} or the negative of it"),
            Bounds::Whole(low, high) => write!(f, "a whole number from {low} to {high}"),
        }
    }
}

/// What is known about a setting.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Info {
    /// `section.name`, as it stands in the TOML backup.
    pub name: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Which values it can have.
    pub bounds: Bounds,
    /// Its value on a board that nobody has set: the reference wiring's data sheets.
    pub default: f32,
    /// What it decides, for people.
    pub about: &'static str,
}

/// The largest whole number up to which f32 has them all.
const EXACT: f32 = 16_777_216.0;

impl Key {
    /// All settings in the order of their numbers.
    pub const ALL: [Key; OWN + compensation::COUNT + AFTER] = {
        let own: [Key; OWN] = [
            Key::ForcePerCode,
            Key::ForceZeroCode,
            Key::ForceLowestCode,
            Key::ForceHighestCode,
            Key::ForceStuckS,
            Key::ForceCalibrated,
            Key::ForceResidualN,
            Key::PositionPerCode,
            Key::PositionFastestMps,
            Key::PositionStuckN,
            Key::PositionCalibrated,
            Key::EstimatorMethod,
            Key::EstimatorDepthM,
            Key::EstimatorForceN,
            Key::EstimatorHalfWidth,
            Key::EstimatorTouchSigma,
            Key::EstimatorReleaseSigma,
            Key::EstimatorSettleS,
            Key::TelemetryEvery,
        ];
        let after: [Key; AFTER] = [
            Key::ReflectionEvery,
            Key::RenderForceN,
            Key::RenderFullN,
            Key::RenderZero,
            Key::RenderDeviceNsPerM,
            Key::RenderSlewNps,
            Key::RenderTimeoutS,
            Key::RenderFadeS,
            Key::RenderShaping,
        ];
        let mut all = [Key::ForcePerCode; OWN + compensation::COUNT + AFTER];
        let mut at = 0;
        while at < all.len() {
            all[at] = if at < OWN {
                own[at]
            } else if at < OWN + compensation::COUNT {
                Key::Compensation(Parameter::ALL[at - OWN])
            } else {
                after[at - OWN - compensation::COUNT]
            };
            at += 1;
        }
        all
    };

    /// How many there are besides those of the section `compensation`.
    pub(super) const BESIDES: usize = OWN + AFTER;

    /// The stable number. 64…127 are those of the section `compensation`, 144…159 of `render`.
    pub const fn id(self) -> u8 {
        match self {
            Key::ForcePerCode => 1,
            Key::ForceZeroCode => 2,
            Key::ForceLowestCode => 3,
            Key::ForceHighestCode => 4,
            Key::ForceStuckS => 5,
            Key::ForceCalibrated => 6,
            Key::ForceResidualN => 7,
            Key::PositionPerCode => 16,
            Key::PositionFastestMps => 17,
            Key::PositionStuckN => 18,
            Key::PositionCalibrated => 19,
            Key::EstimatorMethod => 32,
            Key::EstimatorDepthM => 33,
            Key::EstimatorForceN => 34,
            Key::EstimatorHalfWidth => 35,
            Key::EstimatorTouchSigma => 36,
            Key::EstimatorReleaseSigma => 37,
            Key::EstimatorSettleS => 38,
            Key::TelemetryEvery => 48,
            Key::Compensation(parameter) => parameter.id(),
            Key::ReflectionEvery => 128,
            Key::RenderForceN => 144,
            Key::RenderFullN => 145,
            Key::RenderZero => 146,
            Key::RenderDeviceNsPerM => 147,
            Key::RenderSlewNps => 148,
            Key::RenderTimeoutS => 149,
            Key::RenderFadeS => 150,
            Key::RenderShaping => 151,
        }
    }

    /// The one with a number.
    pub fn from_id(id: u8) -> Option<Key> {
        TABLE.get(place(id)?).copied()
    }

    /// The one with a name.
    pub fn from_name(name: &str) -> Option<Key> {
        Key::ALL.into_iter().find(|key| key.info().name == name)
    }

    /// Name, unit, bounds and default.
    #[inline(never)]
    pub const fn info(self) -> Info {
        use Bounds::{Signed, Whole, Within};
        let (name, unit, bounds, default, about) = match self {
            Key::ForcePerCode => (
                "force.n_per_code",
                "N",
                Signed(1e-9, 1e3),
                // ±50 N over 12 bits, 32 conversions summed.
                100.0 / 4096.0 / 32.0,
                "force per code; negative if the code falls with the force",
            ),
            Key::ForceZeroCode => (
                "force.zero_code",
                "1",
                Within(-EXACT, EXACT),
                2048.0 * 32.0,
                "the code that stands for 0 N",
            ),
            Key::ForceLowestCode => (
                "force.lowest_code",
                "1",
                Whole(-EXACT, EXACT),
                16.0,
                "a single conversion below this is saturated",
            ),
            Key::ForceHighestCode => (
                "force.highest_code",
                "1",
                Whole(-EXACT, EXACT),
                4079.0,
                "a single conversion above this is saturated",
            ),
            Key::ForceStuckS => (
                "force.stuck_s",
                "s",
                Within(0.0, 60.0),
                1.0,
                "the same code for this long is a stuck converter; 0: never",
            ),
            Key::ForceCalibrated => (
                "force.calibrated",
                "1",
                Whole(0.0, 1.0),
                0.0,
                "1: the scale comes from known weights",
            ),
            Key::ForceResidualN => (
                "force.residual_n",
                "N",
                Within(0.0, 1e6),
                0.0,
                "what the calibration left over, rms",
            ),
            Key::PositionPerCode => (
                "position.m_per_code",
                "m",
                Signed(1e-12, 1.0),
                // A count of 1 µm, 32 latches summed.
                1e-6 / 32.0,
                "position per code; negative if it counts down into the material",
            ),
            Key::PositionFastestMps => (
                "position.fastest_mps",
                "m/s",
                Within(0.0, 1e3),
                5.0,
                "a faster motion is a jump of the encoder; 0: never",
            ),
            Key::PositionStuckN => (
                "position.stuck_n",
                "N",
                Within(0.0, 1e6),
                5.0,
                "a force that rises so far at a standing position is a stuck encoder; 0: never",
            ),
            Key::PositionCalibrated => (
                "position.calibrated",
                "1",
                Whole(0.0, 1.0),
                0.0,
                "1: scale and sign of the encoder were checked",
            ),
            Key::EstimatorMethod => (
                "estimator.method",
                "1",
                Whole(1.0, 7.0),
                5.0,
                "1 Kelvin-Voigt, 2 two-stage, 3 Zener, 4 cascade, 5 bank, 6 Kelvin-Voigt with surface, 7 cascade of two",
            ),
            Key::EstimatorDepthM => (
                "estimator.depth_m",
                "m",
                Within(1e-10, 1.0),
                1e-3,
                "the depth that parameters are reported at",
            ),
            Key::EstimatorForceN => (
                "estimator.force_n",
                "N",
                Within(1e-12, 1e6),
                1.0,
                "a typical force",
            ),
            Key::EstimatorHalfWidth => (
                "estimator.half_width",
                "1",
                Whole(2.0, 32.0),
                8.0,
                "samples on either side of the filter's centre",
            ),
            Key::EstimatorTouchSigma => (
                "estimator.touch_sigma",
                "1",
                Within(1.0, 1e3),
                6.0,
                "touch at this many standard deviations of the force",
            ),
            Key::EstimatorReleaseSigma => (
                "estimator.release_sigma",
                "1",
                Within(1.0, 100.0),
                3.0,
                "lift-off below this many",
            ),
            Key::EstimatorSettleS => (
                "estimator.settle_s",
                "s",
                Within(0.02, 10.0),
                0.2,
                "free air at the start",
            ),
            Key::TelemetryEvery => (
                "telemetry.every",
                "1",
                Whole(1.0, 1000.0),
                1.0,
                "send every so many samples",
            ),
            Key::Compensation(parameter) => return parameter.info(),
            Key::ReflectionEvery => (
                "reflection.every",
                "1",
                Whole(0.0, 1000.0),
                0.0,
                "send the identified impedance every so many samples; 0: never",
            ),
            Key::RenderForceN => (
                "render.force_n",
                "N",
                Within(0.0, 1e4),
                0.0,
                "largest force that is put out; 0: nothing is rendered",
            ),
            Key::RenderFullN => (
                "render.full_n",
                "N",
                Signed(1e-3, 1e5),
                10.0,
                "force of the full output; negative if the output falls with the force",
            ),
            Key::RenderZero => (
                "render.zero",
                "1",
                Within(0.0, 1.0),
                0.0,
                "share of the full output that stands for 0 N",
            ),
            Key::RenderDeviceNsPerM => (
                "render.device_ns_per_m",
                "N s/m",
                Within(0.0, 1e4),
                0.0,
                "damping of the master itself: bounds the stiffness that it can render",
            ),
            Key::RenderSlewNps => (
                "render.slew_nps",
                "N/s",
                Within(1.0, 1e6),
                5e3,
                "fastest change of the force",
            ),
            Key::RenderTimeoutS => (
                "render.timeout_s",
                "s",
                Within(2e-3, 10.0),
                0.1,
                "without a packet for so long the force fades out",
            ),
            Key::RenderFadeS => (
                "render.fade_s",
                "s",
                Within(2e-3, 10.0),
                0.05,
                "in which it fades out, and a new packet comes in",
            ),
            Key::RenderShaping => (
                "render.shaping",
                "1",
                Within(0.0, 100.0),
                1.0,
                "the impedance is rendered times this",
            ),
        };
        Info {
            name,
            unit,
            bounds,
            default,
            about,
        }
    }

    /// The setting that decides about a fault, if one does.
    pub const fn deciding(fault: Fault) -> Option<Key> {
        match fault {
            Fault::ForceSaturated => Some(Key::ForceHighestCode),
            Fault::ForceStuck => Some(Key::ForceStuckS),
            Fault::PositionJump => Some(Key::PositionFastestMps),
            Fault::PositionStuck => Some(Key::PositionStuckN),
            Fault::NotCalibrated => Some(Key::ForceCalibrated),
            Fault::EstimatorSuspect => Some(Key::EstimatorMethod),
            Fault::RenderStopped => Some(Key::RenderTimeoutS),
            _ => None,
        }
    }

    /// Whether a change takes effect without the estimator starting anew.
    pub const fn is_harmless(self) -> bool {
        matches!(
            self,
            Key::TelemetryEvery
                | Key::ForceResidualN
                | Key::ReflectionEvery
                | Key::RenderForceN
                | Key::RenderFullN
                | Key::RenderZero
                | Key::RenderDeviceNsPerM
                | Key::RenderSlewNps
                | Key::RenderTimeoutS
                | Key::RenderFadeS
                | Key::RenderShaping
        )
    }

    /// [`Key::ALL`], where it is in flash.
    pub(crate) fn table() -> &'static [Key; COUNT] {
        &TABLE
    }

    pub(super) fn slot(self) -> usize {
        // Every key is in ALL.
        place(self.id()).unwrap_or(0)
    }
}

/// [`Key::ALL`] in one place: as a constant it would be in flash wherever it is used.
pub(super) static TABLE: [Key; COUNT] = Key::ALL;
static IDS: [u8; COUNT] = {
    let mut ids = [0; COUNT];
    let mut at = 0;
    while at < COUNT {
        ids[at] = Key::ALL[at].id();
        at += 1;
    }
    ids
};

/// Where the key with a number stands.
#[inline(never)]
fn place(id: u8) -> Option<usize> {
    IDS.iter().position(|own| *own == id)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_numbers_are_stable_and_names_and_numbers_are_unique() {
        let ids = Key::ALL.map(Key::id);
        assert_eq!(
            ids[..OWN],
            [
                1, 2, 3, 4, 5, 6, 7, 16, 17, 18, 19, 32, 33, 34, 35, 36, 37, 38, 48
            ]
        );
        assert_eq!(
            ids[COUNT - AFTER..],
            [128, 144, 145, 146, 147, 148, 149, 150, 151]
        );
        assert!(ids.is_sorted());
        for key in Key::ALL {
            assert_eq!(Key::from_id(key.id()), Some(key));
            assert_eq!(Key::from_name(key.info().name), Some(key));
        }
    }
}
