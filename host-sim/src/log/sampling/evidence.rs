//! Whether force and position were sampled on the line or at the stamps.
//!
//! A sample is predicted from its four neighbours by a cubic. If the instants scatter by η about the line,
//! the prediction on the line errs by v·Dη, where D takes the same prediction from η itself; if only the
//! stamps scatter, it errs by the noise. Which of the two leaves fewer squares decides; a square counts
//! up to [`LARGEST_SIGMAS`], so that touches and spikes do not decide.

use super::numbering::Line;
use crate::log::record::Log;
use crate::signal;

/// Largest error of a prediction that counts, in standard deviations of its noise.
const LARGEST_SIGMAS: f64 = 5.0;
/// Noise of a prediction's error over that of a sample: √(1 + 2·(4² + 1)/6²).
const ERROR_NOISE: f64 = 1.394;

/// Whether the channels were sampled on the line; also where nothing tells, since the samples then stay
/// as they were measured.
pub(super) fn follow_the_line(log: &Log, line: &Line) -> bool {
    let deviations: Vec<f64> = line.residuals(&log.time_s).collect();
    let gain: f64 = [&log.position_m, &log.force_n]
        .into_iter()
        .map(|channel| gain_of_stamps(channel, &deviations, line))
        .sum();
    gain <= 0.0
}

/// How many squares (in variances of the noise) fewer the stamps leave than the line.
fn gain_of_stamps(channel: &[f64], deviations_s: &[f64], line: &Line) -> f64 {
    let noise = signal::noise(channel);
    if noise <= 0.0 {
        return 0.0;
    }
    let square = |error: f64| {
        (error / (ERROR_NOISE * noise))
            .abs()
            .min(LARGEST_SIGMAS)
            .powi(2)
    };
    let unbroken = |at: usize| line.numbers[at + 2] - line.numbers[at - 2] == 4;
    let inner = (2..channel.len().saturating_sub(2)).filter(|at| unbroken(*at));
    let gains = inner.map(|at| {
        let error = unpredicted(channel, at);
        let speed = (channel[at + 1] - channel[at - 1]) / (2.0 * line.period_s);
        let moved = speed * unpredicted(deviations_s, at);
        square(error) - square(error - moved)
    });
    gains.sum()
}

/// What the cubic through its four neighbours leaves of a sample.
fn unpredicted(channel: &[f64], at: usize) -> f64 {
    let near = channel[at - 1] + channel[at + 1];
    let far = channel[at - 2] + channel[at + 2];
    channel[at] - (4.0 * near - far) / 6.0
}
