//! What an efficient estimator could know of the material after a swap.

use crate::faults::rig::RATE_HZ;
use crate::faults::rig::case::Case;
use crate::information::{Information, Sensors, Touch, within};
use crate::tolerance::CLOSE;

/// The probability that an estimator at the Cramér–Rao bound, which learns of the swap at once and knows the
/// resting force, is within 5 % after so many seconds of contact. It may forget the surface: what is touched is
/// another thing.
pub fn recovers(case: &Case, from_s: f64, contact_s: f64) -> f64 {
    let mut information = Information::new(&Sensors {
        force_noise_n: case.plan.force.noise_n,
        force_step_n: case.plan.force.step_n,
        count_m: case.plan.position.count_m,
    });
    let first = ((from_s * RATE_HZ).ceil() as usize).max(1);
    (0..first).for_each(|_| information.add_free_air());
    let depth_m = &case.depth_m;
    let touched = (first..depth_m.len().saturating_sub(1)).filter(|at| depth_m[*at] > 0.0);
    for at in touched.take((contact_s * RATE_HZ) as usize) {
        let touch = Touch {
            depth_m: depth_m[at],
            speed_mps: (depth_m[at + 1] - depth_m[at - 1]) * RATE_HZ / 2.0,
            force_growth_n: 0.0,
        };
        information.add(case.truth(at as f64 / RATE_HZ), &touch);
    }
    within(CLOSE, &information.bound())
}
