//! What a cubic leaves out of position and speed.
//!
//! A window is as wide as its cubic stays within the noise, and within the noise every crest is a little too low:
//! 31 samples of 0.3 µm may leave 80 µm/s of a speed out, at each of its crests in the same sense, and a damper
//! comes out 0.4 % too large. The next two degrees over the same window show it, in the mean of a log: at one sample
//! they are mostly noise. That noise is independent of the cubic's own, so that they count no error twice.

/// What each sample on either side of the centre counts for what is left out, of the value by their sum and of the
/// slope per sample by their difference.
pub(super) struct Beyond(Vec<[f64; 2]>);

impl Beyond {
    /// Of the cubic over −m..m, from the polynomials of degrees 4 and 5 that are orthogonal to it. Five samples or
    /// three have no such polynomials, and one more on either side shows what is left out of their slope.
    pub(super) fn new(half_width: usize) -> Beyond {
        match half_width {
            1 => Beyond([1.0 / 6.0, -1.0 / 12.0].map(of_slope).into()),
            2 => Beyond([1.0 / 12.0, -1.0 / 15.0, 1.0 / 60.0].map(of_slope).into()),
            _ => Beyond::orthogonal(half_width),
        }
    }

    fn orthogonal(half_width: usize) -> Beyond {
        let each = || (1..=half_width).map(|k| k as f64);
        let sum = |power: i32| 2.0 * each().map(|k| k.powi(power)).sum::<f64>();
        let count = (2 * half_width + 1) as f64;
        let (s2, s4, s6, s8) = (sum(2), sum(4), sum(6), sum(8));
        let (even_norm, odd_norm) = (count * s4 - s2 * s2, s2 * s6 - s4 * s4);
        // k⁴ − a k² − b and k⁵ − c k³ − d k.
        let (a, b) = (
            (count * s6 - s2 * s4) / even_norm,
            (s4 * s4 - s2 * s6) / even_norm,
        );
        let (c, d) = (
            (s2 * s8 - s4 * s6) / odd_norm,
            (s6 * s6 - s4 * s8) / odd_norm,
        );
        let even = |k: f64| k.powi(4) - a * k * k - b;
        let odd = |k: f64| k.powi(5) - c * k.powi(3) - d * k;
        let even_square = b * b + 2.0 * each().map(|k| even(k).powi(2)).sum::<f64>();
        let odd_square = 2.0 * each().map(|k| odd(k).powi(2)).sum::<f64>();
        let shares = each().map(|k| [-b * even(k) / even_square, -d * odd(k) / odd_square]);
        Beyond(shares.collect())
    }

    /// Standard deviation of what is left out of the slope per sample, for a white noise of 1.
    pub(super) fn noise(&self) -> f64 {
        let squares = self.0.iter().map(|[_, slope]| 2.0 * slope * slope);
        squares.sum::<f64>().sqrt()
    }

    /// What is left out of value and slope per sample; nothing where the log has no such window.
    pub(super) fn at(&self, channel: &[f64], at: usize) -> [f64; 2] {
        let room = at.min(channel.len() - 1 - at);
        if room < self.0.len() {
            return [0.0; 2];
        }
        let mut left = [0.0; 2];
        for (k, [value, slope]) in (1..).zip(&self.0) {
            let (before, after) = (channel[at - k] - channel[at], channel[at + k] - channel[at]);
            left[0] += value * (after + before);
            left[1] += slope * (after - before);
        }
        left
    }
}

/// What three samples through a bend may leave out of a slope per sample: half of what the slopes on either side of it
/// differ by, each of a parabola; 0 elsewhere and near the ends. A corner that falls on a sample is symmetric to it, and
/// three samples halve its slope without a sign of it: a probe that was let go of at 100 Hz read 12 mm/s where it had 0
/// or 25.
pub(super) fn left_at_bend(channel: &[f64], at: usize, is_bend: bool) -> f64 {
    if !is_bend || at < 2 || at + 2 >= channel.len() {
        return 0.0;
    }
    let x = &channel[at - 2..=at + 2];
    let before = 1.5 * x[2] - 2.0 * x[1] + 0.5 * x[0];
    let after = -1.5 * x[2] + 2.0 * x[3] - 0.5 * x[4];
    0.5 * (after - before).abs()
}

fn of_slope(share: f64) -> [f64; 2] {
    [0.0, share]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kinematics::{HALF_WIDTHS, Window};

    /// A polynomial of the fifth degree around sample 30, where it is 2.0 and its slope per sample 0.3.
    fn quintic(at: usize) -> f64 {
        let u = 0.1 * (at as f64 - 30.0);
        2.0 + 3.0 * u - u.powi(2) + 0.5 * u.powi(3) + 0.4 * u.powi(4) - 0.3 * u.powi(5)
    }

    #[test]
    fn cubic_and_what_it_leaves_out_are_the_quintic() {
        let channel: Vec<f64> = (0..61).map(quintic).collect();
        for half_width in HALF_WIDTHS.into_iter().filter(|width| *width > 1) {
            let ([value, slope, _], _) = Window::new(half_width).cubic(&channel, 30);
            let left = Beyond::new(half_width).at(&channel, 30);
            assert!((slope + left[1] - 0.3).abs() < 1e-9, "{half_width}");
            assert!(left[1].abs() > 1e-5, "{half_width}: {}", left[1]);
            // Five samples go almost through the value itself.
            if half_width > 2 {
                assert!((value + left[0] - 2.0).abs() < 1e-9, "{half_width}");
                assert!(left[0].abs() > 1e-5, "{half_width}: {}", left[0]);
            }
        }
    }

    #[test]
    fn three_samples_leave_the_cubic_out_of_the_slope() {
        // GIVEN u + u³/6, of which a parabola through u = ±1 sees a slope of 7/6 at 0
        let cubic = |u: f64| u + u.powi(3) / 6.0;
        let channel = [-2.0, -1.0, 0.0, 1.0, 2.0].map(cubic);
        let left = Beyond::new(1).at(&channel, 2);
        assert!((left[1] + 1.0 / 6.0).abs() < 1e-12, "{}", left[1]);
        // THEN a wider window leaves nothing, and the ends of a log have none.
        let channel: Vec<f64> = (-30..=30).map(|u| cubic(0.1 * f64::from(u))).collect();
        for half_width in HALF_WIDTHS.into_iter().filter(|width| *width > 1) {
            let beyond = Beyond::new(half_width);
            let left = beyond.at(&channel, 30);
            assert!(left.iter().all(|left| left.abs() < 1e-9), "{half_width}");
            let ends = [0, 60].map(|at| beyond.at(&channel, at));
            assert_eq!(ends, [[0.0; 2]; 2]);
        }
    }
}
