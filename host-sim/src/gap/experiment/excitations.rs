//! Motions to record: a kind each, as long and as fast as the rig and its log suggest.

use crate::motion::{Motion, Segment};
use crate::number::quantity;

/// What a rig's motions are made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::gap) struct Reach {
    /// Where the surface is, or the middle of the travel where there is none (m).
    pub(in crate::gap) surface_m: f64,
    /// How deep it may press (m); the free air that is used is as long.
    pub(in crate::gap) depth_m: f64,
    /// One slow stroke (s); everything else is a multiple or a fraction of it.
    pub(in crate::gap) stroke_s: f64,
    /// Whether there is anything to touch.
    pub(in crate::gap) touches: bool,
}

/// A motion of the menu.
#[derive(Clone, Debug)]
pub(in crate::gap) struct Dish {
    /// What `plan.json` calls it.
    pub(in crate::gap) name: &'static str,
    /// What to record, in words.
    pub(in crate::gap) words: String,
    pub(in crate::gap) motion: Motion,
}

/// Every kind once.
pub(in crate::gap) fn menu(reach: Reach) -> Vec<Dish> {
    let (d, s) = (reach.depth_m, reach.stroke_s);
    let m = |depths: f64| quantity(depths * d, 2, "m");
    let hz = |per_stroke: f64| quantity(per_stroke / s, 2, "Hz");
    // Without a surface nothing is in contact, and there is no other air.
    let (touch, air, free, contact) = match reach.touches {
        true => ("touches", " from free air", " in free air", " in contact"),
        false => ("strokes", "", "", ""),
    };
    let seconds = |strokes: f64| quantity(strokes * s, 2, "s");
    let dish = |name, words: String, start: f64, segments: Vec<Segment>| {
        let motion = Motion::new(start * d, segments).ok()?;
        Some(Dish {
            name,
            words,
            motion: motion.shifted(reach.surface_m),
        })
    };
    let dishes = [
        dish(
            "palpation",
            format!(
                "{touch} of {} at {} and {}{air}, then a ramp and a hold",
                m(1.0),
                hz(1.0),
                hz(2.0)
            ),
            -0.5,
            palpation(reach),
        ),
        dish(
            "ramp_and_hold",
            format!(
                "a ramp to {} within {}, a hold of {}, out as slowly; then again ten times as fast",
                m(0.8),
                seconds(2.0),
                seconds(10.0)
            ),
            -0.3,
            ramp_and_hold(reach),
        ),
        dish(
            "fast_sine",
            format!(
                "sines of ±{} about {}{contact} at {}, {} and {}",
                m(0.3),
                m(0.6),
                hz(2.0),
                hz(6.0),
                hz(12.0)
            ),
            -0.2,
            fast_sine(reach),
        ),
        dish(
            "free_air",
            format!(
                "strokes of up to {}{free} at three speeds, with a rest after every reversal",
                m(1.0)
            ),
            -0.1,
            free_air(reach),
        ),
        dish(
            "steps",
            format!(
                "steps down to {} and up in fifths, each held for {}",
                m(1.0),
                seconds(1.0)
            ),
            -0.2,
            steps(reach),
        ),
        dish(
            "depths",
            format!(
                "strokes{air} to {}, {}, {} and {}, at {} and {}",
                m(0.25),
                m(0.5),
                m(0.75),
                m(1.0),
                hz(1.0),
                hz(3.0)
            ),
            -0.3,
            depths(reach),
        ),
    ];
    dishes.into_iter().flatten().collect()
}

/// The parts that motions are made of, in depths and strokes.
impl Reach {
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

fn palpation(r: Reach) -> Vec<Segment> {
    vec![
        r.hold(0.6),
        r.ramp(-0.15, 1.25),
        r.sine(0.425, 0.575, 1.0, 3.0),
        r.sine(0.425, 0.575, 2.0, 2.0),
        r.ramp(0.8, 2.0),
        r.hold(1.0),
        r.ramp(-0.5, 2.0),
        r.hold(0.5),
    ]
}

fn ramp_and_hold(r: Reach) -> Vec<Segment> {
    vec![
        r.hold(0.5),
        r.ramp(0.8, 0.5),
        r.hold(10.0),
        r.ramp(-0.3, 0.5),
        r.hold(2.0),
        r.ramp(0.8, 5.0),
        r.hold(10.0),
        r.ramp(-0.3, 5.0),
        r.hold(0.5),
    ]
}

fn fast_sine(r: Reach) -> Vec<Segment> {
    vec![
        r.hold(0.5),
        r.ramp(0.3, 1.0),
        r.sine(0.6, 0.3, 2.0, 3.0),
        r.sine(0.6, 0.3, 6.0, 3.0),
        r.sine(0.6, 0.3, 12.0, 2.0),
        r.ramp(-0.2, 1.0),
        r.hold(0.5),
    ]
}

fn free_air(r: Reach) -> Vec<Segment> {
    let mut segments = vec![r.hold(0.5)];
    for speed in [0.5, 2.0, 8.0] {
        for to in [-1.0, -0.4, -0.8, -0.1] {
            segments.extend([r.ramp(to, speed), r.hold(0.3)]);
        }
    }
    segments.extend([
        r.ramp(-1.0, 1.0),
        r.sine(-0.55, 0.45, 3.0, 2.0),
        r.hold(3.0),
    ]);
    segments
}

fn steps(r: Reach) -> Vec<Segment> {
    let mut segments = vec![r.hold(0.5)];
    for to in [0.2, 0.4, 0.6, 0.8, 1.0, 0.8, 0.6, 0.4, 0.2, -0.2] {
        segments.extend([r.ramp(to, 4.0), r.hold(1.0)]);
    }
    segments
}

fn depths(r: Reach) -> Vec<Segment> {
    let mut segments = vec![r.hold(0.5)];
    for per_stroke in [1.0, 3.0] {
        for depth in [0.25, 0.5, 0.75, 1.0] {
            let (mean, amplitude) = (0.5 * (depth - 0.2), 0.5 * (depth + 0.2));
            segments.push(r.sine(mean, amplitude, per_stroke, 3.0 / per_stroke));
        }
    }
    segments.extend([r.ramp(-0.3, 2.0), r.hold(0.5)]);
    segments
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_motion_stays_within_its_reach_at_any_scale() {
        for (depth_m, stroke_s) in [(4e-3, 1.0), (2e-6, 0.02), (0.3, 30.0)] {
            let reach = Reach {
                surface_m: 2.0 * depth_m,
                depth_m,
                stroke_s,
                touches: true,
            };
            let menu = menu(reach);
            assert_eq!(menu.len(), 6);
            for dish in menu {
                let samples = (0..4000).map(|at| {
                    let time_s = f64::from(at) / 4000.0 * dish.motion.duration_s();
                    (dish.motion.position(time_s).0 - reach.surface_m) / depth_m
                });
                let (low, high) = samples.fold((0.0_f64, 0.0_f64), |(low, high), x| {
                    (low.min(x), high.max(x))
                });
                assert!(
                    low >= -1.001 && high <= 1.001,
                    "{}: {low} to {high}",
                    dish.name
                );
                assert!(
                    dish.name != "free_air" || high <= 0.0,
                    "free air does not touch: {high}"
                );
            }
        }
    }
}
