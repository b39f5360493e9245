//! The table of settings: number, name, unit, bounds, default, and what each decides.

use super::{
    compensation, compensation::Parameter, info::Bounds::Signed, info::Bounds::Whole,
    info::Bounds::Within, info::Info,
};
use crate::estimate::fault::Fault;

/// How many settings there are.
pub const COUNT: usize = Key::ALL.len();
/// The largest whole number up to which f32 has them all.
const EXACT: f32 = 16_777_216.0;
/// Whether a change restarts the estimator.
const RESTARTS: bool = true;
const RUNS_ON: bool = false;

/// Makes [`Key`] of the rows before and behind the section `compensation`, whose rows follow from
/// the catalogue of effects.
macro_rules! keys {
    (@rows $($(#[$doc:meta])* $Key:ident = $id:literal, $name:literal, $unit:literal, $bounds:expr,
        $default:expr, $restarts:expr, $about:literal;)+) => {
        /// A setting. Its number ([`Key::id`]) is stable.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Key {
            $($(#[$doc])* $Key,)+
            /// A parameter of an effect of the rig that is compensated before the estimator.
            Compensation(Parameter),
        }

        impl Key {
            /// The stable number. 64…127 and 160…255 are those of the section `compensation`,
            /// 144…159 those of `render`.
            pub const fn id(self) -> u8 {
                match self {
                    $(Key::$Key => $id,)+
                    Key::Compensation(parameter) => parameter.id(),
                }
            }

            /// Name, unit, bounds and default.
            #[inline(never)]
            pub const fn info(self) -> &'static Info {
                match self {
                    $(Key::$Key => const {
                        &Info {
                            name: $name,
                            unit: $unit,
                            bounds: $bounds,
                            default: $default,
                            restarts: $restarts,
                            about: $about,
                        }
                    },)+
                    Key::Compensation(parameter) => parameter.info(),
                }
            }
        }
    };
    ({ $($before:tt)+ } compensation { $($behind:tt)+ }) => {
        keys! { @rows $($before)+ $($behind)+ }
        keys! { @names BEFORE { $($before)+ } }
        keys! { @names BEHIND { $($behind)+ } }
    };
    (@names $NAMES:ident { $($(#[$doc:meta])* $Key:ident = $id:literal, $name:literal, $unit:literal,
        $bounds:expr, $default:expr, $restarts:expr, $about:literal;)+ }) => {
        const $NAMES: &[Key] = &[$(Key::$Key),+];
    };
}

keys! {
{
    /// The force per code of the load cell's converter (N); negative if the code falls with the force.
    // ±50 N over 12 bits, 32 conversions summed.
    ForcePerCode = 1, "force.n_per_code", "N", Signed(1e-9, 1e3), 100.0 / 4096.0 / 32.0, RESTARTS,
        "force per code; negative if the code falls with the force";
    /// The code that stands for 0 N.
    ForceZeroCode = 2, "force.zero_code", "1", Within(-EXACT, EXACT), 2048.0 * 32.0, RESTARTS,
        "the code that stands for 0 N";
    /// The code below which a single conversion is saturated.
    ForceLowestCode = 3, "force.lowest_code", "1", Whole(-EXACT, EXACT), 16.0, RESTARTS,
        "a single conversion below this is saturated";
    /// The code above which a single conversion is saturated.
    ForceHighestCode = 4, "force.highest_code", "1", Whole(-EXACT, EXACT), 4079.0, RESTARTS,
        "a single conversion above this is saturated";
    /// The time with the same code after which the converter is stuck (s); 0: it never is.
    ForceStuckS = 5, "force.stuck_s", "s", Within(0.0, 60.0), 1.0, RESTARTS,
        "the same code for this long is a stuck converter; 0: never";
    /// Whether force per code and zero come from known weights.
    ForceCalibrated = 6, "force.calibrated", "1", Whole(0.0, 1.0), 0.0, RESTARTS,
        "1: the scale comes from known weights";
    /// The root mean square of the calibration's residuals (N).
    ForceResidualN = 7, "force.residual_n", "N", Within(0.0, 1e6), 0.0, RUNS_ON,
        "what the calibration left over, rms";
    /// The codes beyond the saturated ones at which a single conversion is none, since a cable is off; 0: never.
    // A live zero tells a cable from a force: at 4 to 20 mA, half of the 4 mA below the lowest code.
    ForceBrokenBeyond = 8, "force.broken_beyond", "1", Whole(0.0, EXACT), 0.0, RESTARTS,
        "so many codes beyond the saturated ones a cable is off; 0: never";
    /// The position per code of the encoder (m); negative if it counts down into the material.
    // A count of 1 µm, 32 latches summed.
    PositionPerCode = 16, "position.m_per_code", "m", Signed(1e-12, 1.0), 1e-6 / 32.0, RESTARTS,
        "position per code; negative if it counts down into the material";
    /// The speed above which a motion between two samples is a jump (m/s); 0: it never is.
    PositionFastestMps = 17, "position.fastest_mps", "m/s", Within(0.0, 1e3), 5.0, RESTARTS,
        "a faster motion is a jump of the encoder; 0: never";
    /// The rise of the force over a standing position that makes the encoder stuck (N); 0: it never is.
    PositionStuckN = 18, "position.stuck_n", "N", Within(0.0, 1e6), 5.0, RESTARTS,
        "a force that rises so far at a standing position is a stuck encoder; 0: never";
    /// Whether the encoder's scale and sign were checked.
    PositionCalibrated = 19, "position.calibrated", "1", Whole(0.0, 1.0), 0.0, RESTARTS,
        "1: scale and sign of the encoder were checked";
    /// The way from the zero of the position beyond which the rig cannot be (m); 0: there is none.
    PositionReachM = 20, "position.reach_m", "m", Within(0.0, 1e3), 0.0, RESTARTS,
        "a position further from zero is none: the encoder counts noise; 0: never";
    /// The number of the [`crate::estimate::method::Method`].
    EstimatorMethod = 32, "estimator.method", "1", Whole(1.0, 7.0), 5.0, RESTARTS,
        "1 Kelvin-Voigt, 2 two-stage, 3 Zener, 4 cascade, 5 bank, 6 Kelvin-Voigt with surface, 7 cascade of two";
    /// δ₀, the depth that parameters are reported at (m).
    EstimatorDepthM = 33, "estimator.depth_m", "m", Within(1e-10, 1.0), 1e-3, RESTARTS,
        "the depth that parameters are reported at";
    /// A typical force (N).
    EstimatorForceN = 34, "estimator.force_n", "N", Within(1e-12, 1e6), 1.0, RESTARTS,
        "a typical force";
    /// The samples on either side of the Savitzky–Golay filter's centre.
    EstimatorHalfWidth = 35, "estimator.half_width", "1", Whole(2.0, 32.0), 8.0, RESTARTS,
        "samples on either side of the filter's centre";
    /// The standard deviations of the raw force at which a touch begins.
    EstimatorTouchSigma = 36, "estimator.touch_sigma", "1", Within(1.0, 1e3), 6.0, RESTARTS,
        "touch at this many standard deviations of the raw force";
    /// The standard deviations of the raw force below which it ends.
    EstimatorReleaseSigma = 37, "estimator.release_sigma", "1", Within(1.0, 100.0), 3.0, RESTARTS,
        "lift-off below this many";
    /// The time in free air at the start (s).
    EstimatorSettleS = 38, "estimator.settle_s", "s", Within(0.02, 10.0), 0.2, RESTARTS,
        "free air at the start";
    /// The number of samples of which one is sent.
    TelemetryEvery = 48, "telemetry.every", "1", Whole(1.0, 1000.0), 1.0, RUNS_ON,
        "send every so many samples";
}
compensation
{
    /// The number of samples after which the identified impedance is sent to the other side; 0: never.
    ReflectionEvery = 128, "reflection.every", "1", Whole(0.0, 1000.0), 0.0, RUNS_ON,
        "send the identified impedance every so many samples; 0: never";
    /// The largest force that is rendered (N); 0: nothing is rendered.
    RenderForceN = 144, "render.force_n", "N", Within(0.0, 1e4), 0.0, RUNS_ON,
        "largest force that is put out; 0: nothing is rendered";
    /// The force of the full output (N); negative if the output falls with the force.
    RenderFullN = 145, "render.full_n", "N", Signed(1e-3, 1e5), 10.0, RUNS_ON,
        "force of the full output; negative if the output falls with the force";
    /// The share of the full output that stands for 0 N.
    RenderZero = 146, "render.zero", "1", Within(0.0, 1.0), 0.0, RUNS_ON,
        "share of the full output that stands for 0 N";
    /// The damping of the master itself (N s/m), which bounds what it can render.
    RenderDeviceNsPerM = 147, "render.device_ns_per_m", "N s/m", Within(0.0, 1e4), 0.0, RUNS_ON,
        "damping of the master itself: bounds the stiffness that it can render";
    /// The fastest change of the rendered force (N/s).
    RenderSlewNps = 148, "render.slew_nps", "N/s", Within(1.0, 1e6), 5e3, RUNS_ON,
        "fastest change of the force";
    /// The time without a packet after which the rendered force fades out (s).
    RenderTimeoutS = 149, "render.timeout_s", "s", Within(2e-3, 10.0), 0.1, RUNS_ON,
        "without a packet for so long the force fades out";
    /// The time in which the rendered force fades out, or a new packet's force comes in (s).
    RenderFadeS = 150, "render.fade_s", "s", Within(2e-3, 10.0), 0.05, RUNS_ON,
        "in which it fades out, and a new packet comes in";
    /// The factor on the impedance that is rendered.
    RenderShaping = 151, "render.shaping", "1", Within(0.0, 100.0), 1.0, RUNS_ON,
        "the impedance is rendered times this";
}
}

impl Key {
    /// The number of settings besides those of the section `compensation`.
    pub(super) const BESIDES: usize = BEFORE.len() + BEHIND.len();

    /// All settings, section by section.
    pub const ALL: [Key; Key::BESIDES + compensation::COUNT] = {
        let mut all = [Key::ForcePerCode; Key::BESIDES + compensation::COUNT];
        let (mut at, behind) = (0, BEFORE.len() + compensation::COUNT);
        while at < all.len() {
            all[at] = if at < BEFORE.len() {
                BEFORE[at]
            } else if at < behind {
                Key::Compensation(Parameter::ALL[at - BEFORE.len()])
            } else {
                BEHIND[at - behind]
            };
            at += 1;
        }
        all
    };

    /// The setting with a number.
    pub fn from_id(id: u8) -> Option<Key> {
        TABLE.get(place(id)?).copied()
    }

    /// The setting with a name.
    pub fn from_name(name: &str) -> Option<Key> {
        Key::ALL.into_iter().find(|key| key.info().name == name)
    }

    /// The setting that decides about a fault, if one does.
    pub const fn deciding(fault: Fault) -> Option<Key> {
        match fault {
            Fault::ForceUnusable => Some(Key::ForceBrokenBeyond),
            Fault::PositionUnusable => Some(Key::PositionReachM),
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
static TABLE: [Key; COUNT] = Key::ALL;
static IDS: [u8; COUNT] = {
    let mut ids = [0; COUNT];
    let mut at = 0;
    while at < COUNT {
        ids[at] = Key::ALL[at].id();
        at += 1;
    }
    ids
};

/// Where the key with a number stands in [`Key::ALL`].
#[inline(never)]
fn place(id: u8) -> Option<usize> {
    IDS.iter().position(|key| *key == id)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_numbers_are_stable_and_names_and_numbers_are_unique() {
        let ids = Key::ALL.map(Key::id);
        assert_eq!(
            ids[..BEFORE.len()],
            [
                1, 2, 3, 4, 5, 6, 7, 8, 16, 17, 18, 19, 20, 32, 33, 34, 35, 36, 37, 38, 48
            ]
        );
        assert_eq!(
            ids[COUNT - BEHIND.len()..],
            [128, 144, 145, 146, 147, 148, 149, 150, 151]
        );
        // The effects from 27 on have numbers from 160 on, and stand with the others of their section.
        assert!(ids.iter().filter(|id| **id < 160).is_sorted());
        for key in Key::ALL {
            assert_eq!(Key::from_id(key.id()), Some(key));
            assert_eq!(Key::from_name(key.info().name), Some(key));
        }
    }

    #[test]
    fn an_effect_of_any_number_up_to_50_has_room_and_collides_with_no_setting() {
        let mut taken: [bool; 256] = [false; 256];
        for key in BEFORE.iter().chain(BEHIND) {
            taken[usize::from(key.id())] = true;
        }
        // The other numbers of the section `render`.
        taken[152..160].fill(true);
        for code in 11..=50 {
            for place in 0..4 {
                let id = compensation::number(code, place).expect("a number");
                assert!(
                    !core::mem::replace(&mut taken[usize::from(id)], true),
                    "{id}"
                );
            }
        }
        assert_eq!(compensation::number(27, 0), Some(160));
        assert_eq!(compensation::number(50, 3), Some(255));
        assert_eq!(compensation::number(10, 0), None);
        assert_eq!(compensation::number(51, 0), None);
        assert_eq!(compensation::number(26, 4), None);
    }
}
