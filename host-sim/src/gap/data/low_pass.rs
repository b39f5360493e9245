//! The zero-phase low-pass of `--bandwidth`. Measured and predicted force go through it alike, so that
//! what is above its corner does not count.

use crate::log::UniformLog;

/// Butterworth's low-pass of second order, run forwards and backwards: −6 dB at the corner, no delay.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LowPass {
    /// Corner frequency (Hz).
    pub(crate) corner_hz: f64,
}

impl LowPass {
    /// Filters a channel in place; `period_s` is the time between its samples.
    pub(crate) fn apply(self, channel: &mut [f64], period_s: f64) {
        let w = (std::f64::consts::PI * self.corner_hz * period_s)
            .min(1.5)
            .tan();
        let norm = 1.0 / (1.0 + std::f64::consts::SQRT_2 * w + w * w);
        let b = w * w * norm;
        let a = [
            2.0 * (w * w - 1.0) * norm,
            (1.0 - std::f64::consts::SQRT_2 * w + w * w) * norm,
        ];
        pass(channel, b, a);
        channel.reverse();
        pass(channel, b, a);
        channel.reverse();
    }

    /// A log behind the filter, at its even samples, and the share of the variance of white noise that is left there.
    pub(crate) fn behind(self, log: &UniformLog) -> (UniformLog, f64) {
        let mut filtered = UniformLog {
            taken: None,
            ..log.clone()
        };
        self.apply(&mut filtered.force_n, log.period_s());
        (filtered, self.variance_share(log.period_s()))
    }

    /// The share of the variance of white noise that is left behind the filter.
    pub(crate) fn variance_share(self, period_s: f64) -> f64 {
        // The energy of the impulse response is the integral of the squared magnitude.
        let mut response =
            vec![0.0; (40.0 / (self.corner_hz * period_s)).clamp(64.0, 1e6) as usize];
        let middle = response.len() / 2;
        response[middle] = 1.0;
        self.apply(&mut response, period_s);
        response.iter().map(|h| h * h).sum()
    }
}

/// Runs the filter once over a channel, from the steady state of the first sample on.
fn pass(channel: &mut [f64], b: f64, a: [f64; 2]) {
    let first = channel.first().copied().unwrap_or(0.0);
    let (mut x, mut y) = ([first; 2], [first; 2]);
    for sample in channel {
        let now = *sample;
        let out = b * (now + 2.0 * x[0] + x[1]) - a[0] * y[0] - a[1] * y[1];
        (x, y) = ([now, x[0]], [out, y[0]]);
        *sample = out;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_at_the_corner_is_halved_and_stays_where_it_is() {
        let wave = |hz: f64| -> Vec<f64> {
            (0..4000)
                .map(|at| (std::f64::consts::TAU * hz * 1e-3 * f64::from(at)).sin())
                .collect()
        };
        for (hz, gain) in [(2.0, 1.0), (20.0, 0.5), (200.0, 0.0)] {
            let (mut out, exact) = (wave(hz), wave(hz));
            LowPass { corner_hz: 20.0 }.apply(&mut out, 1e-3);
            for at in 1000..3000 {
                assert!(
                    (out[at] - gain * exact[at]).abs() < 2e-3,
                    "{hz} Hz at {at}: {}",
                    out[at]
                );
            }
        }
    }

    #[test]
    fn the_share_of_white_noise_is_that_of_the_band() {
        // Butterworth's fourth power has an equivalent bandwidth of 0.83 corners on either side.
        let share = LowPass { corner_hz: 20.0 }.variance_share(1e-3);
        assert!((share / (2.0 * 20.0 * 1e-3) - 0.83).abs() < 0.03, "{share}");
    }
}
