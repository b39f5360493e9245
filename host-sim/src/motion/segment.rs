//! One segment of a motion, and how it takes over from the one before.

use std::f64::consts::{PI, TAU};

use crate::diagnostic::Diagnostic;

/// Shortest time in which a velocity changes (s): 20 ms lie within what a 100 Hz motor follows.
const BLEND_S: f64 = 0.02;

/// A piece of motion. Waves begin at their lowest point.
#[derive(Clone, Debug, PartialEq)]
pub enum Segment {
    /// To a position at constant speed, with 20 ms of constant acceleration at either end.
    Ramp {
        /// Where to (m).
        to_m: f64,
        /// How fast (m/s).
        speed_mps: f64,
    },
    /// Rest where the segment before ended.
    Hold {
        /// How long (s).
        seconds: f64,
    },
    /// x = mean − amplitude·cos(2πft)
    Sine {
        /// Middle (m).
        mean_m: f64,
        /// Half the stroke (m).
        amplitude_m: f64,
        /// f (Hz)
        frequency_hz: f64,
        /// How long (s).
        seconds: f64,
    },
    /// Several sines at once, of equal amplitude and with Schroeder's phases; never further than
    /// `amplitude_m` from the mean.
    Multisine {
        /// Middle (m).
        mean_m: f64,
        /// Sum of the amplitudes (m).
        amplitude_m: f64,
        /// The frequencies (Hz).
        frequencies_hz: Vec<f64>,
        /// How long (s).
        seconds: f64,
    },
    /// A sine whose frequency grows or falls linearly.
    Chirp {
        /// Middle (m).
        mean_m: f64,
        /// Half the stroke (m).
        amplitude_m: f64,
        /// Frequency at the beginning (Hz).
        from_hz: f64,
        /// Frequency at the end (Hz).
        to_hz: f64,
        /// How long (s).
        seconds: f64,
    },
}

/// What is left, at the beginning of a segment, of where the one before ended: a cubic that fades.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Joint {
    off_m: f64,
    off_mps: f64,
    seconds: f64,
}

impl Joint {
    /// Distance from the segment's own position (m) and velocity (m/s).
    pub(super) fn deviation(&self, within_s: f64) -> (f64, f64) {
        let s = within_s / self.seconds;
        if s >= 1.0 {
            return (0.0, 0.0);
        }
        // Hermite's cubics: 1 and slope 0, 0 and slope 1, both ending in 0 with slope 0.
        let (value, slope) = ((1.0 - s).powi(2) * (1.0 + 2.0 * s), -6.0 * s * (1.0 - s));
        let (drift, drift_slope) = (s * (1.0 - s).powi(2), (1.0 - s) * (1.0 - 3.0 * s));
        (
            self.off_m * value + self.off_mps * self.seconds * drift,
            self.off_m * slope / self.seconds + self.off_mps * drift_slope,
        )
    }
}

impl Segment {
    /// How long it takes from `origin_m` (s).
    pub(super) fn seconds(&self, origin_m: f64) -> f64 {
        match self {
            Segment::Ramp { to_m, speed_mps } => {
                let cruise_s = (to_m - origin_m).abs() / speed_mps;
                cruise_s + BLEND_S.min(cruise_s)
            }
            Segment::Hold { seconds }
            | Segment::Sine { seconds, .. }
            | Segment::Multisine { seconds, .. }
            | Segment::Chirp { seconds, .. } => *seconds,
        }
    }

    /// Position (m) and velocity (m/s) `t` seconds into it.
    pub(super) fn target(&self, origin_m: f64, t: f64) -> (f64, f64) {
        match self {
            Segment::Ramp { to_m, speed_mps } => ramp(origin_m, *to_m, *speed_mps, t),
            Segment::Hold { .. } => (origin_m, 0.0),
            Segment::Sine {
                mean_m,
                amplitude_m,
                frequency_hz,
                ..
            } => wave(
                *mean_m,
                *amplitude_m,
                TAU * frequency_hz * t,
                TAU * frequency_hz,
            ),
            Segment::Multisine {
                mean_m,
                amplitude_m,
                frequencies_hz,
                ..
            } => multisine(*mean_m, *amplitude_m, frequencies_hz, t),
            Segment::Chirp {
                mean_m,
                amplitude_m,
                from_hz,
                to_hz,
                seconds,
            } => {
                let sweep = (to_hz - from_hz) / seconds;
                let phase = TAU * (from_hz * t + 0.5 * sweep * t * t);
                wave(*mean_m, *amplitude_m, phase, TAU * (from_hz + sweep * t))
            }
        }
    }

    /// How the segment takes over from `before` (position (m), velocity (m/s)).
    pub(super) fn joint(&self, before: (f64, f64), seconds: f64) -> Joint {
        let (position_m, velocity_mps) = self.target(before.0, 0.0);
        let off_m = before.0 - position_m;
        // A cubic's largest slope is 1.5 times its mean: as fast as the wave itself, or slower.
        let travel_s = match self.top_speed_mps() {
            speed if speed > 0.0 => 1.5 * off_m.abs() / speed,
            _ => 0.0,
        };
        Joint {
            off_m,
            off_mps: before.1 - velocity_mps,
            seconds: travel_s
                .max(BLEND_S)
                .min(0.5 * seconds)
                .max(f64::MIN_POSITIVE),
        }
    }

    fn top_speed_mps(&self) -> f64 {
        match self {
            Segment::Ramp { speed_mps, .. } => *speed_mps,
            Segment::Hold { .. } => 0.0,
            Segment::Sine {
                amplitude_m,
                frequency_hz,
                ..
            } => TAU * frequency_hz * amplitude_m,
            Segment::Multisine {
                amplitude_m,
                frequencies_hz,
                ..
            } => {
                let count = frequencies_hz.len().max(1) as f64;
                TAU * frequencies_hz.iter().sum::<f64>() / count * amplitude_m
            }
            Segment::Chirp {
                amplitude_m,
                from_hz,
                to_hz,
                ..
            } => TAU * from_hz.max(*to_hz) * amplitude_m,
        }
    }

    /// The segment moved by `by_m` (m).
    pub(super) fn shifted(&self, by_m: f64) -> Segment {
        let mut moved = self.clone();
        match &mut moved {
            Segment::Ramp { to_m: place, .. }
            | Segment::Sine { mean_m: place, .. }
            | Segment::Multisine { mean_m: place, .. }
            | Segment::Chirp { mean_m: place, .. } => *place += by_m,
            Segment::Hold { .. } => {}
        }
        moved
    }

    /// The kind, and the numbers but for frequencies in a list, as a motion file names them.
    pub(super) fn numbers(&self) -> (&'static str, Vec<(&'static str, f64)>) {
        let (kind, numbers): (_, &[_]) = match self {
            Segment::Ramp { to_m, speed_mps } => ("ramp", &[("to", to_m), ("speed", speed_mps)]),
            Segment::Hold { seconds } => ("hold", &[("seconds", seconds)]),
            Segment::Sine {
                mean_m,
                amplitude_m,
                frequency_hz,
                seconds,
            } => (
                "sine",
                &[
                    ("mean", mean_m),
                    ("amplitude", amplitude_m),
                    ("frequency", frequency_hz),
                    ("seconds", seconds),
                ],
            ),
            Segment::Multisine {
                mean_m,
                amplitude_m,
                seconds,
                ..
            } => (
                "multisine",
                &[
                    ("mean", mean_m),
                    ("amplitude", amplitude_m),
                    ("seconds", seconds),
                ],
            ),
            Segment::Chirp {
                mean_m,
                amplitude_m,
                from_hz,
                to_hz,
                seconds,
            } => (
                "chirp",
                &[
                    ("mean", mean_m),
                    ("amplitude", amplitude_m),
                    ("from", from_hz),
                    ("to", to_hz),
                    ("seconds", seconds),
                ],
            ),
        };
        let numbers = numbers.iter().map(|(name, number)| (*name, **number));
        (kind, numbers.collect())
    }

    pub(super) fn check(&self) -> Result<(), Diagnostic> {
        let (_, numbers) = self.numbers();
        let numbers: Vec<f64> = numbers.into_iter().map(|(_, number)| number).collect();
        // All but a hold begin with a place, which may be negative.
        let (place, positive) = numbers.split_at(usize::from(numbers.len() > 1));
        let frequencies_hz = match self {
            Segment::Multisine { frequencies_hz, .. } => frequencies_hz.as_slice(),
            _ => &[1.0],
        };
        let count = frequencies_hz.len() as f64;
        let bad_place = place.iter().find(|value| !value.is_finite());
        let bad_positive = frequencies_hz
            .iter()
            .chain(positive)
            .chain([&count])
            .find(|value| !(value.is_finite() && **value > 0.0));
        match bad_place.or(bad_positive) {
            None => Ok(()),
            Some(value) => Err(Diagnostic::new("a segment holds a number that it cannot use")
                .value(value)
                .remedy("speeds, amplitudes, frequencies and seconds are positive, all numbers finite")),
        }
    }
}

fn wave(mean_m: f64, amplitude_m: f64, phase: f64, omega: f64) -> (f64, f64) {
    let (sin, cos) = phase.sin_cos();
    (mean_m - amplitude_m * cos, amplitude_m * omega * sin)
}

fn multisine(mean_m: f64, amplitude_m: f64, frequencies_hz: &[f64], t: f64) -> (f64, f64) {
    let count = frequencies_hz.len() as f64;
    let mut sum = (mean_m, 0.0);
    for (index, frequency_hz) in frequencies_hz.iter().enumerate() {
        // Schroeder: quadratic phases keep the crests of equal lines apart.
        let phase = PI * (index * index) as f64 / count;
        let omega = TAU * frequency_hz;
        let line = wave(0.0, amplitude_m / count, omega * t + phase, omega);
        sum = (sum.0 + line.0, sum.1 + line.1);
    }
    sum
}

/// Trapezoid of velocity: accelerate, cruise, brake.
fn ramp(from_m: f64, to_m: f64, speed_mps: f64, t: f64) -> (f64, f64) {
    let distance_m = to_m - from_m;
    let speed = speed_mps.copysign(distance_m);
    let cruise_s = distance_m.abs() / speed_mps;
    let blend_s = BLEND_S.min(cruise_s);
    let left_s = cruise_s + blend_s - t;
    if left_s <= 0.0 || blend_s == 0.0 {
        return (to_m, 0.0);
    }
    if t < blend_s {
        return (from_m + 0.5 * speed * t * t / blend_s, speed * t / blend_s);
    }
    if left_s < blend_s {
        return (
            to_m - 0.5 * speed * left_s * left_s / blend_s,
            speed * left_s / blend_s,
        );
    }
    (from_m + speed * (t - 0.5 * blend_s), speed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ramp_keeps_its_speed_and_arrives() {
        let segment = Segment::Ramp {
            to_m: -4e-3,
            speed_mps: 0.03,
        };
        let seconds = segment.seconds(2e-3);
        assert!((seconds - 0.22).abs() < 1e-12);
        assert_eq!(segment.target(2e-3, 0.1).1, -0.03);
        let (end_m, end_mps) = segment.target(2e-3, seconds);
        assert!((end_m + 4e-3).abs() < 1e-15 && end_mps.abs() < 1e-12);
    }

    #[test]
    fn a_ramp_to_where_it_is_takes_no_time() {
        let segment = Segment::Ramp {
            to_m: 1.0,
            speed_mps: 1.0,
        };
        assert_eq!(segment.seconds(1.0), 0.0);
        assert_eq!(segment.target(1.0, 0.0), (1.0, 0.0));
    }

    #[test]
    fn a_multisine_stays_within_its_amplitude() {
        let highest = (0..5000)
            .map(|ms| {
                multisine(0.0, 1.0, &[1.0, 2.0, 3.0, 5.0, 7.0], f64::from(ms) * 1e-3)
                    .0
                    .abs()
            })
            .fold(0.0, f64::max);
        assert!((0.3..=1.0).contains(&highest), "{highest}");
    }
}
