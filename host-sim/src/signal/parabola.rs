//! Value and rate of a channel, smoothed by a parabola through its neighbours.

/// Value and rate, at sample `at`, of the parabola through the `2·half_width + 1` samples around it
/// (fewer at the ends of the channel), which are `period_s` apart.
pub fn parabola(channel: &[f64], at: usize, half_width: usize, period_s: f64) -> (f64, f64) {
    let half_width = half_width.min(at).min(channel.len().saturating_sub(at + 1));
    let centre = channel[at];
    if half_width == 0 {
        return (centre, 0.0);
    }
    let m = half_width as f64;
    // Savitzky & Golay 1964: weights of the value and of the slope.
    let norm = (2.0 * m - 1.0) * (2.0 * m + 1.0) * (2.0 * m + 3.0) / 3.0;
    let squares = m * (m + 1.0) * (2.0 * m + 1.0) / 3.0;
    let (mut value, mut slope) = (centre, 0.0);
    for k in 1..=half_width {
        let (before, after) = (channel[at - k], channel[at + k]);
        let k = k as f64;
        value += (3.0 * m * m + 3.0 * m - 1.0 - 5.0 * k * k) / norm
            * ((before - centre) + (after - centre));
        slope += k / squares * (after - before);
    }
    (value, slope / period_s)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_is_its_own_and_the_ends_of_a_channel_are_no_trap() {
        let channel: Vec<f64> = (0..50)
            .map(|i| 0.1 * f64::from(i))
            .map(|t| 1.0 + t * t)
            .collect();
        for at in [0, 1, 7, 48, 49] {
            let t = 0.1 * at as f64;
            let (value, slope) = parabola(&channel, at, 5, 0.1);
            assert!((value - (1.0 + t * t)).abs() < 1e-12);
            // A single sample has no slope.
            let expected = if at == 0 || at == 49 { 0.0 } else { 2.0 * t };
            assert!((slope - expected).abs() < 1e-12, "{at}: {slope}");
        }
    }
}
