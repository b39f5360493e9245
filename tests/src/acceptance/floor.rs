//! The Cramér–Rao bound of a case.

use super::cases::{Case, SECONDS};
use crate::information::{Information, Sensors, Touch, within};
use crate::tolerance::{CLOSE, SURE};

/// The default sensors.
const FORCE_STEP_N: f64 = 0.005;
const COUNT_M: f64 = 1e-6;
/// The bound is calculated at every sample of this many.
const EVERY: usize = 10;

/// The bound of one case.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Floor {
    /// Standard deviations of K, λ, n (relative) and of the surface (m).
    pub(crate) sigma: [f64; 4],
    /// The time (s) from the first touch until the 95 % intervals of K, λ, n are within 5 %.
    pub(crate) settles_s: f64,
}

impl Floor {
    /// The bound of a case whose surface is told if `known`.
    pub(crate) fn of(case: &Case, known: bool) -> Floor {
        Floor::skewed(case, known, 0.0)
    }

    /// The same where the skew of the sensors is unknown, too (`asked` 1).
    pub(crate) fn skewed(case: &Case, known: bool, asked: f64) -> Floor {
        let mut information = Information::new(&Sensors {
            force_noise_n: case.force_noise_n,
            force_step_n: FORCE_STEP_N,
            count_m: COUNT_M,
        });
        if known {
            information.knows_surface();
        }
        let [stiffness, damping, exponent, _] = case.truth;
        let mut settles_s = SECONDS;
        for index in 0..case.run.time_s.len() {
            match touch(case, index, asked) {
                None => information.add_free_air(),
                Some(touch) => information.add([stiffness, damping, exponent], &touch),
            }
            if settles_s == SECONDS && index % EVERY == 0 {
                let sigma = information.bound();
                if sigma.iter().take(3).all(|sigma| SURE * sigma < CLOSE) {
                    settles_s = case.run.time_s[index] - case.touched_s;
                }
            }
        }
        let mut sigma = information.bound();
        // The encoder leaves the true position of the surface open by a count.
        sigma[3] = sigma[3].hypot(if known { 0.0 } else { COUNT_M / 12f64.sqrt() });
        Floor { sigma, settles_s }
    }

    /// See [`within`].
    pub(crate) fn within(&self, bound: f64) -> f64 {
        within(bound, &self.sigma)
    }
}

/// An instant of a case; `None` in free air.
fn touch(case: &Case, index: usize, asked: f64) -> Option<Touch> {
    let depth_m = case.run.position_m[index] - case.truth[3];
    if depth_m <= 0.0 || case.run.force_n[index] <= 0.0 {
        return None;
    }
    let next = (index + 1).min(case.run.force_n.len() - 1);
    Some(Touch {
        depth_m,
        speed_mps: case.run.velocity_mps[index],
        force_growth_n: 0.5 * asked * (case.run.force_n[next] - case.run.force_n[index.max(1) - 1]),
    })
}
