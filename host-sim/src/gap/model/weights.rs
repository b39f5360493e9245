//! The variances that residuals should have: the noise of the force, and what the errors of the motion
//! make of it.

use crate::gap::data::fit_data::FitData;
use crate::gap::data::low_pass::LowPass;
use crate::gap::data::motion_errors::{SPEED_ERROR_FACTOR, acceleration_error_factor};
use crate::gap::model::{
    fit::Fit, simulate::depths, simulate::forces_of_changed, simulate::forces_of_wound,
};
use crate::gap::noise::floor::NoiseFloor;
use crate::stats::highest;

/// The variances (N²) that the residuals of a fit should have. A sample that says nothing has 0: one in
/// a gap, or at the instant of a touch, which no sampling resolves.
pub(crate) fn variances(
    fit: &Fit,
    logs: &[FitData],
    floors: &[NoiseFloor],
    low_pass: Option<LowPass>,
) -> Vec<f64> {
    let of_position = effect_of_errors(fit, logs, with_position_error);
    let of_speed = effect_of_speed(fit, logs);
    let of_acceleration = effect_of_errors(fit, logs, with_corners_error);
    let before = effect_of_what_was_before(fit, logs);
    let contact = !fit.shape.base.is_free();
    let depths = depths(&fit.shape, &fit.numbers, logs);
    let mut variances = Vec::with_capacity(of_position.len());
    let mut is_forgotten = Vec::with_capacity(of_position.len());
    for ((log, floor), depth_m) in logs.iter().zip(floors).zip(&depths) {
        let noise_n2 = floor.variances(depth_m, &log.speed_mps);
        let share = low_pass.map_or(1.0, |low_pass| low_pass.variance_share(log.period_s));
        for at in 0..log.len() {
            let row = variances.len();
            // Within a sample of the surface a force that jumps is somewhere in between.
            let near_m = log.step_s(at) * log.speed_mps[at].abs() + 2.0 * log.position_noise_m;
            let touching = contact && depth_m[at].abs() < near_m && log.speed_mps[at] != 0.0;
            let motion = of_position[row] + of_speed[row] + of_acceleration[row];
            let variance = noise_n2[at] + share * motion;
            is_forgotten.push(before[row] < variance);
            variances.push(if log.count[at] == 0.0 || touching {
                0.0
            } else {
                variance
            });
        }
    }
    leave_out(&mut variances, &is_forgotten);
    variances
}

/// Of logs that remember for a larger share of their samples what was before them nothing is left out: what sticks for
/// so long is a spring of theirs. Not measured.
const LONGEST: f64 = 0.25;

/// Leaves the samples out that still remember what was before the log, which is one unknown for all of them.
fn leave_out(variances: &mut [f64], is_forgotten: &[bool]) {
    let remembering = is_forgotten.iter().filter(|own| !**own).count();
    if remembering as f64 <= LONGEST * variances.len() as f64 {
        let each = variances.iter_mut().zip(is_forgotten);
        let remembering = each.filter(|(_, own)| !**own);
        remembering.for_each(|(variance, _)| *variance = 0.0);
    }
}

/// The variances (N²) that an error of the motion gives the predicted forces: the square of half the
/// difference between the forces with the error added and taken off.
fn effect_of_errors(fit: &Fit, logs: &[FitData], change: impl Fn(&mut FitData, f64)) -> Vec<f64> {
    let changed =
        |sign: f64| forces_of_changed(&fit.shape, &fit.numbers, logs, |log| change(log, sign));
    let (more, less) = (changed(1.0), changed(-1.0));
    half_difference_squared(&more, &less).collect()
}

fn half_difference_squared(more: &[f64], less: &[f64]) -> impl Iterator<Item = f64> {
    let each = more.iter().zip(less);
    each.map(|(a, b)| (0.5 * (a - b)).powi(2))
}

/// The variances (N²) that a motion before the log gives the predicted forces: a friction that sticks may begin anywhere
/// between the forces at which it slides, and remembers that until it has slid. A stage that stood at the end of it was
/// `unexplained` (14 of 24 logs), and a gel had two false effects.
fn effect_of_what_was_before(fit: &Fit, logs: &[FitData]) -> Vec<f64> {
    let Some([more, less]) = forces_of_wound(&fit.shape, &fit.numbers, logs) else {
        return vec![0.0; logs.iter().map(FitData::len).sum()];
    };
    // Every force between them is as likely.
    let each = half_difference_squared(&more, &less);
    each.map(|square| square / 3.0).collect()
}

/// A direction of motion that is not known at a sample is not known so many samples on either side of it. Where a stage
/// stopped or turned, 5 of 8534 had 43 % of Σ w r², and a gel with Coulomb friction was `unexplained` by its own
/// model at 1.3 to 1.6 floors (5 of 8 recordings); with 2 all eight are at 0.88 to 0.95.
const TURNS_WITHIN: usize = 2;

/// The variances (N²) of the speed's error, which next to a turn is that of a neighbour too.
fn effect_of_speed(fit: &Fit, logs: &[FitData]) -> Vec<f64> {
    let own = effect_of_errors(fit, logs, with_speed_error);
    let around = |at: usize| {
        let from = at.saturating_sub(TURNS_WITHIN);
        let to = (at + TURNS_WITHIN + 1).min(own.len());
        highest(own[from..to].iter().copied())
    };
    (0..own.len()).map(around).collect()
}

fn with_position_error(log: &mut FitData, sign: f64) {
    let error = sign * log.position_noise_m;
    log.position_m.iter_mut().for_each(|x| *x += error);
}

/// Adds the error of the speed with a sign.
pub(crate) fn with_speed_error(log: &mut FitData, sign: f64) {
    let each = log.speed_mps.iter_mut().zip(&log.speed_noise_mps);
    each.for_each(|(v, noise)| *v += sign * SPEED_ERROR_FACTOR * noise);
}

/// Adds the error of the acceleration with a sign, larger next to a corner.
fn with_corners_error(log: &mut FitData, sign: f64) {
    add_noise_of_acceleration(log, |is_corner| sign * acceleration_error_factor(is_corner));
}

/// Adds the acceleration's standard deviation with a sign.
pub(crate) fn with_acceleration_error(log: &mut FitData, sign: f64) {
    add_noise_of_acceleration(log, |_| sign);
}

/// Adds the acceleration's standard deviation times a factor, that of a corner or of elsewhere.
fn add_noise_of_acceleration(log: &mut FitData, factor: impl Fn(bool) -> f64) {
    let noise = std::iter::zip(&log.acceleration_noise_mps2, &log.is_corner);
    let each = log.acceleration_mps2.iter_mut().zip(noise);
    each.for_each(|(a, (noise, is_corner))| *a += factor(*is_corner) * noise);
}

/// The weights (1/N²) of variances (N²); 0 where the variance is 0.
pub(crate) fn weights(variances: &[f64]) -> Vec<f64> {
    variances
        .iter()
        .map(|v| if *v > 0.0 { 1.0 / v } else { 0.0 })
        .collect()
}
