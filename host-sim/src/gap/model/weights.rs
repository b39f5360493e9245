//! What a residual may be: the noise of the force, and what the errors of the motion make of it.

use crate::gap::data::fit_data::Course;
use crate::gap::data::low_pass::LowPass;
use crate::gap::data::motion_errors::{ACCELERATION_ERRORS, SPEED_ERRORS};
use crate::gap::model::fit::{Fit, along, forces_moved};
use crate::gap::noise::floor::Floor;

/// Variances (N²) that a fit's residuals should have, sample by sample; 0 for a sample that says nothing
/// (a gap, or the instant of touch, which no sampling resolves).
pub(in crate::gap) fn variances(
    fit: &Fit,
    courses: &[Course],
    floors: &[Floor],
    low_pass: Option<LowPass>,
) -> Vec<f64> {
    let moved = |change: fn(&mut Course, f64), sign: f64| {
        forces_moved(&fit.shape, &fit.numbers, courses, |course| {
            change(course, sign)
        })
    };
    let spread = |change: fn(&mut Course, f64)| -> Vec<f64> {
        let (more, less) = (moved(change, 1.0), moved(change, -1.0));
        more.iter()
            .zip(&less)
            .map(|(a, b)| (0.5 * (a - b)).powi(2))
            .collect()
    };
    let of_position = spread(|course, sign| {
        let error = sign * course.position_noise_m;
        course.position_m.iter_mut().for_each(|x| *x += error);
    });
    let of_speed = spread(|course, sign| {
        let noise = course.speed_noise_mps.iter();
        course
            .speed_mps
            .iter_mut()
            .zip(noise)
            .for_each(|(v, s)| *v += sign * SPEED_ERRORS * s);
    });
    let of_acceleration = spread(|course, sign| {
        let noise = course.acceleration_noise_mps2.iter();
        course
            .acceleration_mps2
            .iter_mut()
            .zip(noise)
            .for_each(|(a, s)| *a += sign * ACCELERATION_ERRORS * s);
    });
    let mut variances = Vec::with_capacity(of_position.len());
    for (course, floor) in courses.iter().zip(floors) {
        let share = low_pass.map_or(1.0, |own| own.share(course.period_s));
        let contact = !fit.shape.base.is_free();
        along(&fit.shape, &fit.numbers, course, |at, reading| {
            let row = variances.len();
            // Within a sample of the surface a force that jumps is somewhere in between.
            let near_m =
                course.step_s(at) * course.speed_mps[at].abs() + 2.0 * course.position_noise_m;
            let touching =
                contact && reading.touch.depth_m.abs() < near_m && course.speed_mps[at] != 0.0;
            let motion = of_position[row] + of_speed[row] + of_acceleration[row];
            variances.push(if course.count[at] == 0.0 || touching {
                0.0
            } else {
                share * (floor.used_n.powi(2) + motion)
            });
        });
    }
    variances
}

/// Weights of variances.
pub(in crate::gap) fn weights(variances: &[f64]) -> Vec<f64> {
    variances
        .iter()
        .map(|v| if *v > 0.0 { 1.0 / v } else { 0.0 })
        .collect()
}
