//! What the windows of an acceleration may leave out of it.
//!
//! A corner of the set point turns the acceleration within a window, and the error in the windows around it is two to
//! three times the noise (measured on a simulated servo). How far the acceleration is from the line between its values a window before and after
//! shows where; it is noise itself at one sample, and counts in the mean over a window, as far as it is more than noise.

/// The mean of three accelerations 1, −2, 1 has six times the variance of one.
const OF_NOISE: f64 = 6.0;
/// So much of the difference from the line may be left out: a step of the acceleration, half of which a window sees on
/// either side.
const LEFT: f64 = 0.5;

/// Root mean squares (m/s²) of what may be left out at every sample, of accelerations with a noise (m/s²), from windows of
/// these half-widths (samples).
pub(super) fn left_out(acceleration: &[f64], noise: &[f64], half_widths: &[usize]) -> Vec<f64> {
    let last = acceleration.len().saturating_sub(1);
    let turned = |at: usize| {
        let reach = half_widths[at].min(at).min(last - at);
        let line = 0.5 * (acceleration[at - reach] + acceleration[at + reach]);
        4.0 * (line - acceleration[at]).powi(2) - OF_NOISE * noise[at].powi(2)
    };
    // Sums up to each sample.
    let mut sums = vec![0.0; acceleration.len() + 1];
    for at in 0..acceleration.len() {
        sums[at + 1] = sums[at] + turned(at);
    }
    let around = |at: usize| {
        let from = at.saturating_sub(half_widths[at]);
        let to = (at + half_widths[at]).min(last) + 1;
        let mean = (sums[to] - sums[from]) / (to - from) as f64;
        LEFT * mean.max(0.0).sqrt()
    };
    (0..acceleration.len()).map(around).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_of_the_acceleration_is_left_out_next_to_it_and_a_slope_is_not() {
        // GIVEN 1 m/s² until sample 100, 3 m/s² behind it and growing, known to 0.1 m/s² by eleven samples
        let at = |k: usize| {
            if k < 100 {
                1.0
            } else {
                3.0 + 0.01 * (k - 100) as f64
            }
        };
        let acceleration: Vec<f64> = (0..200).map(at).collect();
        let left = left_out(&acceleration, &[0.1; 200], &[5; 200]);
        // THEN about half of the step counts there, and nothing elsewhere.
        assert!((0.5..1.1).contains(&left[100]), "{}", left[100]);
        assert!(
            left[..85]
                .iter()
                .chain(&left[115..])
                .all(|left| *left == 0.0)
        );
    }
}
