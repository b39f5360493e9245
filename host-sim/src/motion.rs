//! What the rig's motor follows: segments of ramps, holds and waves, joined smoothly.

mod file;
mod segment;
mod write;

pub use segment::Segment;

use crate::diagnostic::Diagnostic;
use segment::Joint;

/// A reference motion: position over time, without jumps in position or velocity.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    start_m: f64,
    pieces: Vec<Piece>,
    duration_s: f64,
}

/// Where a motion goes, and how fast.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// The lowest position (m): farthest out of the material.
    pub lowest_m: f64,
    /// The highest (m): deepest into it.
    pub highest_m: f64,
    /// The highest speed (m/s) either way.
    pub fastest_mps: f64,
}

impl Limits {
    /// Those of positions (m) with their speeds (m/s).
    pub fn of(states: impl IntoIterator<Item = (f64, f64)>) -> Limits {
        let none = Limits {
            lowest_m: f64::INFINITY,
            highest_m: f64::NEG_INFINITY,
            fastest_mps: 0.0,
        };
        states.into_iter().fold(none, |so_far, (x, v)| Limits {
            lowest_m: so_far.lowest_m.min(x),
            highest_m: so_far.highest_m.max(x),
            fastest_mps: so_far.fastest_mps.max(v.abs()),
        })
    }
}

/// A segment, when it begins and how it takes over from the one before.
#[derive(Clone, Debug, PartialEq)]
struct Piece {
    from_s: f64,
    seconds: f64,
    segment: Segment,
    /// Where the segment before ended (m).
    origin_m: f64,
    joint: Joint,
}

impl Motion {
    /// A motion that begins at rest at `start_m` (m).
    ///
    /// # Errors
    /// No segment, or one that lasts no time or forever, is too fast for its frequency to mean
    /// anything, or holds a number that is not finite.
    pub fn new(start_m: f64, segments: Vec<Segment>) -> Result<Motion, Diagnostic> {
        if segments.is_empty() {
            return Err(Diagnostic::new("the motion has no segment")
                .remedy("write at least one [[segment]]"));
        }
        for segment in &segments {
            segment.check()?;
        }
        Ok(Motion::joined(start_m, segments))
    }

    fn joined(start_m: f64, segments: Vec<Segment>) -> Motion {
        let mut motion = Motion {
            start_m,
            pieces: Vec::with_capacity(segments.len()),
            duration_s: 0.0,
        };
        let mut state = (start_m, 0.0);
        for segment in segments {
            let seconds = segment.seconds(state.0);
            let piece = Piece {
                from_s: motion.duration_s,
                seconds,
                origin_m: state.0,
                joint: segment.joint(state, seconds),
                segment,
            };
            state = piece.position(seconds);
            motion.duration_s += seconds;
            motion.pieces.push(piece);
        }
        motion
    }

    /// The built-in palpation of a surface at 0 m down to `peak_depth_m` (m), 8.6 s: rest in free
    /// air (0.6 s, for the noise), approach, sine touches at 1 and 2 Hz that leave the surface each
    /// time, a ramp to 80 % of the depth, a hold of 1 s, back, rest in free air.
    ///
    /// All lengths scale with the depth; the fastest is 7.2 depths a second.
    pub fn palpation(peak_depth_m: f64) -> Motion {
        let depth_m = |share: f64| share * peak_depth_m;
        let touches = |frequency_hz, seconds| Segment::Sine {
            mean_m: depth_m(0.425),
            amplitude_m: depth_m(0.575),
            frequency_hz,
            seconds,
        };
        let ramp = |share, speed| Segment::Ramp {
            to_m: depth_m(share),
            speed_mps: depth_m(speed),
        };
        let segments = vec![
            Segment::Hold { seconds: 0.6 },
            ramp(-0.15, 1.25),
            touches(1.0, 3.0),
            touches(2.0, 2.0),
            ramp(0.8, 2.0),
            Segment::Hold { seconds: 1.0 },
            ramp(-0.5, 2.0),
            Segment::Hold { seconds: 0.5 },
        ];
        Motion::joined(depth_m(-0.5), segments)
    }

    /// The motion for a surface at `surface_m` (m) instead of 0.
    pub fn shifted(&self, surface_m: f64) -> Motion {
        let segments = self
            .pieces
            .iter()
            .map(|piece| piece.segment.shifted(surface_m));
        Motion::joined(self.start_m + surface_m, segments.collect())
    }

    /// This motion, then the segments of another.
    pub fn then(&self, other: &Motion) -> Motion {
        let pieces = self.pieces.iter().chain(&other.pieces);
        Motion::joined(
            self.start_m,
            pieces.map(|piece| piece.segment.clone()).collect(),
        )
    }

    /// How long it lasts (s).
    pub fn duration_s(&self) -> f64 {
        self.duration_s
    }

    /// Position (m) and velocity (m/s) at a time (s); at rest before the beginning and after the end.
    pub fn position(&self, time_s: f64) -> (f64, f64) {
        let index = self.pieces.partition_point(|piece| piece.from_s <= time_s);
        let Some(piece) = index.checked_sub(1).map(|index| &self.pieces[index]) else {
            return (self.start_m, 0.0);
        };
        let within_s = time_s - piece.from_s;
        if index == self.pieces.len() && within_s > piece.seconds {
            return (piece.position(piece.seconds).0, 0.0);
        }
        piece.position(within_s.min(piece.seconds))
    }

    /// The highest position (m), as near as [`Motion::limits`].
    pub fn highest_m(&self) -> f64 {
        self.limits().highest_m
    }

    /// Where it goes and how fast, looked at every millisecond and 20 000 times at least: motions of
    /// a microscope last less than a second.
    pub fn limits(&self) -> Limits {
        let steps = (self.duration_s * 1e3).ceil().max(2e4) as u64;
        let step_s = self.duration_s / steps as f64;
        Limits::of((0..=steps).map(|at| self.position(at as f64 * step_s)))
    }
}

impl Piece {
    fn position(&self, within_s: f64) -> (f64, f64) {
        let (position_m, velocity_mps) = self.segment.target(self.origin_m, within_s);
        let (off_m, off_mps) = self.joint.deviation(within_s);
        (position_m + off_m, velocity_mps + off_mps)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The largest jump of position (m) and of velocity (m/s) beyond what a step of 10 µs explains.
    fn jumps(motion: &Motion) -> (f64, f64) {
        let steps = (motion.duration_s() * 1e5) as u32;
        let at = |step: u32| motion.position(f64::from(step) * 1e-5);
        let mut worst = (0.0_f64, 0.0_f64);
        for step in 0..steps {
            let (here, next) = (at(step), at(step + 1));
            let explained = 0.5 * (here.1 + next.1) * 1e-5;
            worst.0 = worst.0.max((next.0 - here.0 - explained).abs());
            worst.1 = worst.1.max((next.1 - here.1).abs());
        }
        worst
    }

    #[test]
    fn the_velocity_is_the_derivative_of_the_position_and_neither_jumps() {
        let wild = Motion::new(
            -2e-3,
            vec![
                Segment::Sine {
                    mean_m: 1e-3,
                    amplitude_m: 2e-3,
                    frequency_hz: 1.3,
                    seconds: 1.0,
                },
                Segment::Multisine {
                    mean_m: 0.0,
                    amplitude_m: 1e-3,
                    frequencies_hz: vec![0.7, 3.0, 7.0],
                    seconds: 2.0,
                },
                Segment::Hold { seconds: 0.2 },
                Segment::Chirp {
                    mean_m: 1e-3,
                    amplitude_m: 1e-3,
                    from_hz: 0.5,
                    to_hz: 10.0,
                    seconds: 3.0,
                },
                Segment::Ramp {
                    to_m: 0.0,
                    speed_mps: 0.03,
                },
            ],
        )
        .unwrap();
        for motion in [wild, Motion::palpation(4.2e-3)] {
            let (position, velocity) = jumps(&motion);
            // Accelerations reach 11 m/s² at the wildest joint. One that jumps within the step of
            // 10 µs costs the trapezoidal rule an eighth of 11 m/s²·(10 µs)².
            assert!(position < 1.4e-10, "{position:e} m");
            assert!(velocity < 1.2e-4, "{velocity:e} m/s");
        }
    }

    #[test]
    fn a_palpation_rests_in_free_air_leaves_contact_each_cycle_and_scales() {
        let motion = Motion::palpation(1e-3);
        assert!((0..600).all(|ms| motion.position(f64::from(ms) * 1e-3) == (-0.5e-3, 0.0)));
        let crossings = (0..(motion.duration_s() * 1e3) as u32)
            .map(|ms| motion.position(f64::from(ms) * 1e-3).0 > 0.0)
            .collect::<Vec<_>>()
            .windows(2)
            .filter(|pair| !pair[0] && pair[1])
            .count();
        assert_eq!(crossings, 3 + 4 + 1);
        assert!((motion.highest_m() - 1e-3).abs() < 1e-9);
        let (end_m, end_mps) = motion.position(motion.duration_s());
        assert!((end_m + 0.5e-3).abs() < 1e-12 && end_mps.abs() < 1e-12);
        assert!(
            (motion.duration_s() - 8.6).abs() < 0.1,
            "{}",
            motion.duration_s()
        );
        let deep = Motion::palpation(4e-3);
        let ratio = deep.position(2.03).0 / motion.position(2.03).0;
        assert!((ratio - 4.0).abs() < 1e-9);
    }

    #[test]
    fn limits_are_the_wave_s_own_however_fast_it_is() {
        for hz in [0.1, 600.0] {
            let sine = Segment::Sine {
                mean_m: 1e-6,
                amplitude_m: 3e-6,
                frequency_hz: hz,
                seconds: 5.0 / hz,
            };
            let limits = Motion::new(-2e-6, vec![sine]).unwrap().limits();
            let fastest_mps = std::f64::consts::TAU * hz * 3e-6;
            assert!((limits.lowest_m + 2e-6).abs() < 1e-11, "{limits:?}");
            assert!((limits.highest_m - 4e-6).abs() < 1e-11, "{limits:?}");
            assert!((limits.fastest_mps / fastest_mps - 1.0).abs() < 1e-4);
        }
    }

    #[test]
    fn a_shifted_motion_is_the_same_one_elsewhere() {
        let motion = Motion::palpation(1e-3);
        let shifted = motion.shifted(5e-3);
        for ms in [0, 700, 1234, 4567, 8000] {
            let at_s = f64::from(ms) * 1e-3;
            let moved = shifted.position(at_s).0 - motion.position(at_s).0;
            assert!((moved - 5e-3).abs() < 1e-15);
        }
    }

    #[test]
    fn a_motion_of_nothing_is_refused() {
        assert!(Motion::new(0.0, Vec::new()).is_err());
        let still = Segment::Ramp {
            to_m: 1.0,
            speed_mps: 0.0,
        };
        assert!(Motion::new(0.0, vec![still]).is_err());
    }
}
