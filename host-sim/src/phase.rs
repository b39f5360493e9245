//! The phases of a contact: where in its course a sample is.

use crate::stats::{highest, quantile};

/// Depths below this share of the deepest are touch and lift-off.
const NEAR: f64 = 0.05;
/// Speeds below this share of the fast ones are a hold.
const STILL: f64 = 0.02;
/// The quantile of the speeds that is fast.
const FAST: f64 = 0.95;

/// The phases of the contact, or the ways it goes; every sample is in one.
pub(crate) const PHASES: [&str; 8] = [
    "free",
    "touch",
    "loading",
    "hold",
    "unloading",
    "lift_off",
    "forward",
    "backward",
];

/// What says in which phase a sample of a log is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Course {
    /// Largest penetration (m); 0 where nothing is touched.
    pub(crate) deepest_m: f64,
    /// 95 % quantile of the speeds (m/s).
    pub(crate) fast_mps: f64,
}

impl Course {
    /// The course of a log with these depths (m; 0 where there is nothing to touch) and speeds (m/s).
    pub(crate) fn of(depth_m: &[f64], speed_mps: &[f64]) -> Course {
        let speeds = speed_mps.iter().map(|v| v.abs());
        Course {
            deepest_m: highest(depth_m.iter().copied()).max(0.0),
            fast_mps: quantile(speeds.filter(|v| v.is_finite()), FAST),
        }
    }

    /// Whether the probe stands still at a speed (m/s).
    pub(crate) fn is_still(&self, speed_mps: f64) -> bool {
        speed_mps.abs() <= STILL * self.fast_mps
    }

    /// The phase of the contact at a depth (m) and a speed (m/s), or the way it goes where nothing is touched.
    pub(crate) fn phase(&self, depth_m: f64, speed_mps: f64) -> &'static str {
        let is_still = self.is_still(speed_mps);
        if self.deepest_m <= 0.0 {
            return match speed_mps > 0.0 {
                _ if is_still => "hold",
                true => "forward",
                false => "backward",
            };
        }
        let near_m = NEAR * self.deepest_m;
        if depth_m <= -near_m {
            "free"
        } else if depth_m < near_m && !is_still {
            if speed_mps > 0.0 { "touch" } else { "lift_off" }
        } else if depth_m <= 0.0 {
            "free"
        } else if is_still {
            "hold"
        } else if speed_mps > 0.0 {
            "loading"
        } else {
            "unloading"
        }
    }
}

/// The places in [`PHASES`] of the samples of a log, by their depths (m; 0 where there is nothing to touch) and speeds
/// (m/s).
pub(crate) fn phases_of(depth_m: &[f64], speed_mps: &[f64]) -> Vec<usize> {
    let course = Course::of(depth_m, speed_mps);
    let each = depth_m.iter().zip(speed_mps);
    each.map(|(depth_m, speed_mps)| {
        let now = course.phase(*depth_m, *speed_mps);
        let at = PHASES.iter().position(|phase| *phase == now);
        at.unwrap_or_default()
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_press_goes_through_the_phases_and_free_strokes_have_ways() {
        // GIVEN 10 mm/s in, at rest at 1 mm, and out again
        let depth_m = [-1e-3, 0.0, 5e-4, 1e-3, 5e-4, -1e-5];
        let speed_mps = [1e-2, 1e-2, 1e-2, 0.0, -1e-2, -1e-2];
        let names = |depth_m: &[f64]| -> Vec<&str> {
            let phases = phases_of(depth_m, &speed_mps).into_iter();
            phases.map(|at| PHASES[at]).collect()
        };
        let press = ["free", "touch", "loading", "hold", "unloading", "lift_off"];
        assert_eq!(names(&depth_m), press);
        let strokes = [
            "forward", "forward", "forward", "hold", "backward", "backward",
        ];
        assert_eq!(names(&[0.0; 6]), strokes);
    }

    #[test]
    fn every_sample_is_in_a_phase_of_the_contact_or_on_a_way() {
        // GIVEN a millimetre of depth at 10 mm/s
        let course = |deepest_m| Course {
            deepest_m,
            fast_mps: 1e-2,
        };
        let phase_at = |depth_m, speed_mps| course(1e-3).phase(depth_m, speed_mps);
        let phases = [
            (-1e-3, 1e-2, "free"),
            (-1e-5, 0.0, "free"),
            (-1e-5, 1e-2, "touch"),
            (1e-5, -1e-2, "lift_off"),
            (5e-4, 1e-2, "loading"),
            (5e-4, 1e-4, "hold"),
            (5e-4, -1e-2, "unloading"),
        ];
        for (depth_m, speed_mps, expected) in phases {
            assert_eq!(
                phase_at(depth_m, speed_mps),
                expected,
                "{depth_m} {speed_mps}"
            );
        }
        // THEN where nothing is touched there is no air, and no depth.
        let ways = [(1e-2, "forward"), (-1e-2, "backward"), (1e-4, "hold")];
        for (speed_mps, expected) in ways {
            assert_eq!(course(0.0).phase(0.0, speed_mps), expected);
        }
    }
}
