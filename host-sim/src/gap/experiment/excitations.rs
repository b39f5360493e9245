//! Motions to record: one of each kind, as deep and as fast as the rig and its log suggest.

use crate::motion::{Motion, Segment};
use crate::number::quantity;

/// Where and how fast the motions of a rig may go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ExcitationRange {
    /// Where the surface is, or the middle of the travel where there is none (m).
    pub(super) surface_m: f64,
    /// How deep a motion may press (m). It uses as much free air.
    pub(super) depth_m: f64,
    /// Duration of one slow stroke (s); everything else is a multiple or a fraction of it.
    pub(super) stroke_s: f64,
    /// Whether there is anything to touch.
    pub(super) touches: bool,
}

/// A motion that excites effects.
#[derive(Clone, Debug)]
pub(super) struct Excitation {
    /// The name in `plan.json`.
    pub(super) name: &'static str,
    /// What to record, in words.
    pub(super) words: String,
    pub(super) motion: Motion,
    /// The largest force (N) that is expected on the way, where it was predicted.
    pub(super) peak_n: Option<f64>,
}

/// Predictions of a force until a motion is gentle enough. Derived: each makes it at least 5 % shallower, which is a
/// factor of 7 in all.
const TRIES: usize = 40;

/// One motion of each kind, each as deep as the range allows and as keeps the force that `peak_n` predicts (N) below
/// `most_n`: a fast stroke of a depth that a slow one may go to drove the rig's own cell to its end.
pub(super) fn bounded(
    range: ExcitationRange,
    most_n: f64,
    peak_n: impl Fn(&Motion) -> f64,
) -> Vec<Excitation> {
    let mut found = excitations(range);
    for own in &mut found {
        let mut depth_m = range.depth_m;
        for _ in 0..TRIES {
            let peak = peak_n(&own.motion);
            own.peak_n = Some(peak);
            if peak <= most_n || !peak.is_finite() {
                break;
            }
            // A force grows at least with the depth; the root keeps what a steeper one would leave out.
            depth_m *= (most_n / peak).sqrt().clamp(0.5, 0.95);
            let gentler = excitations(ExcitationRange { depth_m, ..range });
            match gentler.into_iter().find(|other| other.name == own.name) {
                Some(other) => *own = other,
                None => break,
            }
        }
    }
    found
}

/// One motion of each kind.
pub(super) fn excitations(range: ExcitationRange) -> Vec<Excitation> {
    let kinds: [(&'static str, String, f64, Vec<Segment>); 6] = [
        ("palpation", range.palpation_words(), -0.5, palpation(range)),
        (
            "ramp_and_hold",
            range.ramp_and_hold_words(),
            -0.3,
            ramp_and_hold(range),
        ),
        ("fast_sine", range.fast_sine_words(), -0.2, fast_sine(range)),
        ("free_air", range.free_air_words(), -0.1, free_air(range)),
        ("steps", range.steps_words(), -0.2, steps(range)),
        ("depths", range.depths_words(), -0.3, depths(range)),
    ];
    let of_kind = |(name, words, start, segments): (_, _, f64, _)| {
        let motion = Motion::new(start * range.depth_m, segments).ok()?;
        Some(Excitation {
            name,
            words,
            motion: motion.shifted(range.surface_m),
            peak_n: None,
        })
    };
    kinds.into_iter().filter_map(of_kind).collect()
}

/// The motions in words.
impl ExcitationRange {
    /// A length in depths.
    fn m(self, depths: f64) -> String {
        quantity(depths * self.depth_m, 2, "m")
    }

    /// A frequency in cycles per stroke.
    fn hz(self, per_stroke: f64) -> String {
        quantity(per_stroke / self.stroke_s, 2, "Hz")
    }

    /// A time in strokes.
    fn s(self, strokes: f64) -> String {
        quantity(strokes * self.stroke_s, 2, "s")
    }

    /// Words that only mean something where there is a surface: without one nothing is in contact, and
    /// all air is free.
    fn with_surface(self, words: &'static str) -> &'static str {
        if self.touches { words } else { "" }
    }

    fn palpation_words(self) -> String {
        format!(
            "{} of {} at {} and {}{}, then a ramp and a hold",
            if self.touches { "touches" } else { "strokes" },
            self.m(1.0),
            self.hz(1.0),
            self.hz(2.0),
            self.with_surface(" from free air"),
        )
    }

    fn ramp_and_hold_words(self) -> String {
        format!(
            "a ramp to {} within {}, a hold of {}, out as slowly; then again ten times as fast",
            self.m(0.8),
            self.s(2.0),
            self.s(10.0)
        )
    }

    fn fast_sine_words(self) -> String {
        format!(
            "sines of ±{} about {}{} at {}, {} and {}",
            self.m(0.3),
            self.m(0.6),
            self.with_surface(" in contact"),
            self.hz(2.0),
            self.hz(6.0),
            self.hz(12.0)
        )
    }

    fn free_air_words(self) -> String {
        format!(
            "strokes of up to {}{} at three speeds, with a rest after every reversal",
            self.m(1.0),
            self.with_surface(" in free air"),
        )
    }

    fn steps_words(self) -> String {
        format!(
            "steps down to {} and up in fifths, each held for {}",
            self.m(1.0),
            self.s(1.0)
        )
    }

    fn depths_words(self) -> String {
        format!(
            "strokes{} to {}, {}, {} and {}, at {} and {}",
            self.with_surface(" from free air"),
            self.m(0.25),
            self.m(0.5),
            self.m(0.75),
            self.m(1.0),
            self.hz(1.0),
            self.hz(3.0)
        )
    }
}

/// The segments that motions are made of, in depths and strokes.
impl ExcitationRange {
    fn ramp(self, to: f64, depths_per_stroke: f64) -> Segment {
        Segment::Ramp {
            to_m: to * self.depth_m,
            speed_mps: depths_per_stroke * self.depth_m / self.stroke_s,
        }
    }

    fn hold(self, strokes: f64) -> Segment {
        Segment::Hold {
            seconds: strokes * self.stroke_s,
        }
    }

    fn sine(self, mean: f64, amplitude: f64, per_stroke: f64, strokes: f64) -> Segment {
        Segment::Sine {
            mean_m: mean * self.depth_m,
            amplitude_m: amplitude * self.depth_m,
            frequency_hz: per_stroke / self.stroke_s,
            seconds: strokes * self.stroke_s,
        }
    }
}

fn palpation(range: ExcitationRange) -> Vec<Segment> {
    vec![
        range.hold(0.6),
        range.ramp(-0.15, 1.25),
        range.sine(0.425, 0.575, 1.0, 3.0),
        range.sine(0.425, 0.575, 2.0, 2.0),
        range.ramp(0.8, 2.0),
        range.hold(1.0),
        range.ramp(-0.5, 2.0),
        range.hold(0.5),
    ]
}

fn ramp_and_hold(range: ExcitationRange) -> Vec<Segment> {
    vec![
        range.hold(0.5),
        range.ramp(0.8, 0.5),
        range.hold(10.0),
        range.ramp(-0.3, 0.5),
        range.hold(2.0),
        range.ramp(0.8, 5.0),
        range.hold(10.0),
        range.ramp(-0.3, 5.0),
        range.hold(0.5),
    ]
}

fn fast_sine(range: ExcitationRange) -> Vec<Segment> {
    vec![
        range.hold(0.5),
        range.ramp(0.3, 1.0),
        range.sine(0.6, 0.3, 2.0, 3.0),
        range.sine(0.6, 0.3, 6.0, 3.0),
        range.sine(0.6, 0.3, 12.0, 2.0),
        range.ramp(-0.2, 1.0),
        range.hold(0.5),
    ]
}

fn free_air(range: ExcitationRange) -> Vec<Segment> {
    let mut segments = vec![range.hold(0.5)];
    for speed in [0.5, 2.0, 8.0] {
        for to in [-1.0, -0.4, -0.8, -0.1] {
            segments.extend([range.ramp(to, speed), range.hold(0.3)]);
        }
    }
    segments.extend([
        range.ramp(-1.0, 1.0),
        range.sine(-0.55, 0.45, 3.0, 2.0),
        range.hold(3.0),
    ]);
    segments
}

fn steps(range: ExcitationRange) -> Vec<Segment> {
    let mut segments = vec![range.hold(0.5)];
    for to in [0.2, 0.4, 0.6, 0.8, 1.0, 0.8, 0.6, 0.4, 0.2, -0.2] {
        segments.extend([range.ramp(to, 4.0), range.hold(1.0)]);
    }
    segments
}

fn depths(range: ExcitationRange) -> Vec<Segment> {
    let mut segments = vec![range.hold(0.5)];
    for per_stroke in [1.0, 3.0] {
        for depth in [0.25, 0.5, 0.75, 1.0] {
            let (mean, amplitude) = (0.5 * (depth - 0.2), 0.5 * (depth + 0.2));
            segments.push(range.sine(mean, amplitude, per_stroke, 3.0 / per_stroke));
        }
    }
    segments.extend([range.ramp(-0.3, 2.0), range.hold(0.5)]);
    segments
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_motion_stays_within_its_reach_at_any_scale() {
        for (depth_m, stroke_s) in [(4e-3, 1.0), (2e-6, 0.02), (0.3, 30.0)] {
            let range = ExcitationRange {
                surface_m: 2.0 * depth_m,
                depth_m,
                stroke_s,
                touches: true,
            };
            let all = excitations(range);
            assert_eq!(all.len(), 6);
            for excitation in all {
                let samples = (0..4000).map(|at| {
                    let time_s = f64::from(at) / 4000.0 * excitation.motion.duration_s();
                    (excitation.motion.position(time_s).0 - range.surface_m) / depth_m
                });
                let (low, high) = samples.fold((0.0_f64, 0.0_f64), |(low, high), x| {
                    (low.min(x), high.max(x))
                });
                assert!(
                    low >= -1.001 && high <= 1.001,
                    "{}: {low} to {high}",
                    excitation.name
                );
                assert!(
                    excitation.name != "free_air" || high <= 0.0,
                    "free air does not touch: {high}"
                );
            }
        }
    }
}
