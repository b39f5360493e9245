//! What the sensor adds to the force: noise, white or coloured, and the steps of the converter.

use super::fit::rms;
use super::motion::{SUBSTEPS, Track};
use super::plant::Plant;
use super::random::Random;

/// The spectrum of the noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Noise {
    /// White.
    White,
    /// First-order, with this corner (Hz).
    Corner(f64),
    /// Behind an amplifier of second order, with this corner (Hz) twice.
    Filtered(f64),
    /// Five first-order stages, 0.7–180 Hz: close to 1/f.
    Pink,
    /// White, and a share (of the power) in a broad hump: the resonance of a load cell that the floor
    /// excites. Half of the hump's power lies within ± a width (Hz) about its middle, 20 to 60 Hz,
    /// too wide for a line: the hum of the mains is a `periodic_disturbance`, not noise.
    Hump { hz: f64, width_hz: f64, share: f64 },
}

impl Noise {
    /// Draws a coloured noise, or gives white noise.
    pub(crate) fn draw(coloured: bool, random: &mut Random) -> Self {
        let which = random.unit();
        let corner = random.log_between(5.0, 150.0);
        let hz = random.log_between(80.0, 250.0);
        let (width_hz, share) = (random.between(20.0, 60.0), random.between(0.2, 0.6));
        match (coloured, which) {
            (false, _) => Noise::White,
            (true, w) if w < 0.4 => Noise::Corner(corner),
            (true, w) if w < 0.7 => Noise::Pink,
            (true, _) => Noise::Hump {
                hz,
                width_hz,
                share,
            },
        }
    }

    /// The name in truth.json.
    pub(crate) fn name(self) -> String {
        match self {
            Noise::White => "white".into(),
            Noise::Corner(hz) => format!("ar1_{hz:.0}_hz"),
            Noise::Filtered(hz) => format!("filtered_{hz:.0}_hz"),
            Noise::Pink => "pink".into(),
            Noise::Hump { hz, .. } => format!("hump_{hz:.0}_hz"),
        }
    }

    /// `count` samples of unit variance (in expectation), `dt` (s) apart.
    pub(crate) fn samples(self, count: usize, dt: f64, random: &mut Random) -> Vec<f64> {
        match self {
            Noise::White => (0..count).map(|_| random.normal()).collect(),
            Noise::Corner(hz) => coloured(&[hz], count, dt, random),
            Noise::Filtered(hz) => filtered(hz, count, dt, random),
            Noise::Pink => coloured(&[0.7, 2.8, 11.2, 45.0, 180.0], count, dt, random),
            Noise::Hump {
                hz,
                width_hz,
                share,
            } => {
                let (a, b) = (
                    coloured(&[width_hz], count, dt, random),
                    coloured(&[width_hz], count, dt, random),
                );
                let (line, rest) = (share.sqrt(), (1.0 - share).sqrt());
                (0..count)
                    .map(|k| {
                        let angle = std::f64::consts::TAU * hz * k as f64 * dt;
                        line * (a[k] * angle.cos() + b[k] * angle.sin()) + rest * random.normal()
                    })
                    .collect()
            }
        }
    }
}

/// First-order noise behind another stage with the same corner.
fn filtered(hz: f64, count: usize, dt: f64, random: &mut Random) -> Vec<f64> {
    let keep = (-std::f64::consts::TAU * hz * dt).exp();
    // What the second stage leaves of the first one's variance.
    let left = (1.0 - keep) / (1.0 + keep) * (1.0 + keep * keep) / (1.0 - keep * keep);
    let mut state = 0.0;
    let behind = |own: f64| {
        state = keep * state + (1.0 - keep) * own;
        state / left.sqrt()
    };
    // A second until the second stage remembers no start.
    let before = (1.0 / dt) as usize;
    let first = coloured(&[hz], count + before, dt, random);
    first.into_iter().map(behind).skip(before).collect()
}

/// The sum of first-order noises of equal power.
fn coloured(corners_hz: &[f64], count: usize, dt: f64, random: &mut Random) -> Vec<f64> {
    let keep = |hz: &f64| (-std::f64::consts::TAU * hz * dt).exp();
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

/// How force and position are recorded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Sensor {
    /// The spectrum of the noise.
    pub(crate) noise: Noise,
    /// Its standard deviation (N).
    pub(crate) noise_n: f64,
    /// The step of the force (N).
    pub(crate) code_n: f64,
}

/// A count of the encoder (m).
const COUNT_M: f64 = 1e-6;

/// A log.
#[derive(Clone, Debug)]
pub(crate) struct Recorded {
    /// Time (s), position (m), force (N).
    pub(crate) rows: Vec<[f64; 3]>,
    /// The noise floor: what noise and steps added to the force (N rms).
    pub(crate) floor_n: f64,
}

impl Sensor {
    /// Records a rig under a motion.
    pub(crate) fn record(&self, plant: &Plant, track: &Track, random: &mut Random) -> Recorded {
        let clean = plant.samples(track, SUBSTEPS);
        self.recorded(&clean, plant, track, random)
    }

    /// Records a force that is known already.
    pub(crate) fn recorded(
        &self,
        clean: &[f64],
        plant: &Plant,
        track: &Track,
        random: &mut Random,
    ) -> Recorded {
        let noise = self.noise.samples(clean.len(), 1e-3, random);
        let row = |(k, (clean, noise)): (usize, (&f64, &f64))| {
            let x = plant.read_m(track.x[k * SUBSTEPS]);
            let position = (x / COUNT_M).round() * COUNT_M;
            let force = ((clean + self.noise_n * noise) / self.code_n).round() * self.code_n;
            [k as f64 * 1e-3, position, force]
        };
        let rows: Vec<[f64; 3]> = clean.iter().zip(&noise).enumerate().map(row).collect();
        let wrong: Vec<f64> = rows.iter().zip(clean).map(|(r, c)| r[2] - c).collect();
        Recorded {
            floor_n: rms(&wrong),
            rows,
        }
    }
}

/// The step (N) of a 12-bit converter with a range of ±1.3 times the peak, in whole millinewtons.
pub(crate) fn code_n(peak_n: f64) -> f64 {
    (2.6 * peak_n / 4096.0 * 1e3).round().max(1.0) * 1e-3
}
