//! The band in which an intention has no part: the band-pass, and the courses without which it starts anew.

use std::f64::consts::PI;

use crate::signal::parabola;

/// The band in which the intention has no part (Hz).
pub const BAND_HZ: (f64, f64) = (3.0, 20.0);

/// A section of second order, in the transposed direct form II.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Section {
    b: [f64; 3],
    a: [f64; 2],
    state: [f64; 2],
}

impl Section {
    /// A Butterworth section: a low pass, or a high pass.
    fn new(cutoff_hz: f64, q: f64, period_s: f64, high: bool) -> Section {
        let k = (PI * cutoff_hz * period_s).tan();
        let norm = 1.0 / (1.0 + k / q + k * k);
        let b = match high {
            true => [norm, -2.0 * norm, norm],
            false => [k * k * norm, 2.0 * k * k * norm, k * k * norm],
        };
        Section {
            b,
            a: [2.0 * (k * k - 1.0) * norm, (1.0 - k / q + k * k) * norm],
            state: [0.0; 2],
        }
    }

    fn step(&mut self, x: f64) -> f64 {
        let y = self.b[0] * x + self.state[0];
        self.state[0] = self.b[1] * x - self.a[0] * y + self.state[1];
        self.state[1] = self.b[2] * x - self.a[1] * y;
        y
    }
}

/// The band-pass: Butterworth, of eighth order towards the intention, whose 10 mm at 0.8 Hz must not reach the
/// 50 µm in the band, and of fourth order towards the noise.
#[derive(Clone, Copy, Debug)]
pub(super) struct BandPass([Section; 6]);

impl BandPass {
    pub(super) fn new(period_s: f64) -> BandPass {
        let high = |q| Section::new(BAND_HZ.0, q, period_s, true);
        let low = |q| Section::new(BAND_HZ.1, q, period_s, false);
        // The quality factors of Butterworth filters of eighth and fourth order.
        BandPass([
            high(0.509_796),
            high(0.601_345),
            high(0.899_976),
            high(2.562_915),
            low(0.541_196),
            low(1.306_563),
        ])
    }

    pub(super) fn step(&mut self, x: f64) -> f64 {
        self.0.iter_mut().fold(x, |x, section| section.step(x))
    }
}

/// A signal as it would go on: value, rate and half of the acceleration, at a time 0.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Course(pub(super) [f64; 3]);

impl Course {
    /// Through the last samples, at the middle one of which it is 0.
    pub(super) fn through(samples: &[f64], period_s: f64) -> Course {
        let half = samples.len() / 2;
        let (value, rate) = parabola(samples, half, half, period_s);
        let mean = samples.iter().sum::<f64>() / samples.len() as f64;
        // The mean of t² over −h…h periods.
        let spread_s2 = (half * (half + 1)) as f64 / 3.0 * period_s * period_s;
        Course([value, rate, (mean - value) / spread_s2])
    }

    pub(super) fn at(&self, time_s: f64) -> f64 {
        let [value, rate, bend] = self.0;
        value + time_s * (rate + time_s * bend)
    }
}
