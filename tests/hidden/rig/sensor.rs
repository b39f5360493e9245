//! What is added to the force: noise, white or coloured, and the converter's codes.

use super::random::Random;

/// Spectrum of the noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Noise {
    White,
    /// First-order, corner (Hz).
    Corner(f64),
    /// Five first-order stages, 0.7–180 Hz: close to 1/f.
    Pink,
    /// White, and a share (of the power) in a band of this width about this line (Hz): a hum
    /// whose phase wanders, so that it is no `periodic_disturbance`.
    Hum {
        hz: f64,
        width_hz: f64,
        share: f64,
    },
}

impl Noise {
    /// A coloured one, or white.
    pub(crate) fn draw(coloured: bool, random: &mut Random) -> Self {
        let which = random.unit();
        let corner = random.log_between(5.0, 150.0);
        let hz = *random.pick(&[50.0, 60.0]);
        let (width_hz, share) = (random.between(1.5, 4.0), random.between(0.2, 0.6));
        match (coloured, which) {
            (false, _) => Noise::White,
            (true, w) if w < 0.4 => Noise::Corner(corner),
            (true, w) if w < 0.7 => Noise::Pink,
            (true, _) => Noise::Hum {
                hz,
                width_hz,
                share,
            },
        }
    }

    /// As truth.json calls it.
    pub(crate) fn name(self) -> String {
        match self {
            Noise::White => "white".into(),
            Noise::Corner(hz) => format!("ar1_{hz:.0}_hz"),
            Noise::Pink => "pink".into(),
            Noise::Hum { hz, .. } => format!("hum_{hz:.0}_hz"),
        }
    }

    /// `count` samples at 1 kHz of unit variance (in expectation).
    pub(crate) fn samples(self, count: usize, random: &mut Random) -> Vec<f64> {
        match self {
            Noise::White => (0..count).map(|_| random.normal()).collect(),
            Noise::Corner(hz) => coloured(&[hz], count, random),
            Noise::Pink => coloured(&[0.7, 2.8, 11.2, 45.0, 180.0], count, random),
            Noise::Hum {
                hz,
                width_hz,
                share,
            } => {
                let (a, b) = (
                    coloured(&[width_hz], count, random),
                    coloured(&[width_hz], count, random),
                );
                let (line, rest) = (share.sqrt(), (1.0 - share).sqrt());
                (0..count)
                    .map(|k| {
                        let angle = std::f64::consts::TAU * hz * k as f64 * 1e-3;
                        line * (a[k] * angle.cos() + b[k] * angle.sin()) + rest * random.normal()
                    })
                    .collect()
            }
        }
    }
}

/// Sum of first-order noises of equal power.
fn coloured(corners_hz: &[f64], count: usize, random: &mut Random) -> Vec<f64> {
    let keep = |hz: &f64| (-std::f64::consts::TAU * hz * 1e-3).exp();
    let keeps: Vec<f64> = corners_hz.iter().map(keep).collect();
    let mut states: Vec<f64> = keeps.iter().map(|_| random.normal()).collect();
    let scale = (corners_hz.len() as f64).sqrt();
    (0..count)
        .map(|_| {
            for (state, keep) in states.iter_mut().zip(&keeps) {
                *state = keep * *state + (1.0 - keep * keep).sqrt() * random.normal();
            }
            states.iter().sum::<f64>() / scale
        })
        .collect()
}

/// The step (N) of a 12-bit converter that reaches 1.3 times the peak both ways, in whole millinewtons.
pub(crate) fn code_n(peak_n: f64) -> f64 {
    (2.6 * peak_n / 4096.0 * 1e3).round().max(1.0) * 1e-3
}
