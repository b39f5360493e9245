//! Transparency over frequency: what is felt of the material over what there is to feel, Ẑ/Z, at the lines of
//! a motion that holds all of them.

use std::f64::consts::TAU;

use crate::motion::{Motion, Segment};
use crate::teleop::environment::Environment;
use crate::teleop::measure::rest_on_the_first;
use crate::teleop::measure::stability::Rest;
use crate::teleop::options::Options;
use crate::teleop::system::System;
use crate::teleop::trace::{Row, Trace};

/// One line of the spectrum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// The frequency (Hz).
    pub frequency_hz: f64,
    /// |Ẑ/Z|
    pub magnitude: f64,
    /// arg(Ẑ/Z) (rad)
    pub phase_rad: f64,
}

/// The lines (Hz), 0.1 to 30, each a multiple of 0.1.
const LINES_HZ: [f64; 14] = [
    0.1, 0.2, 0.4, 0.7, 1.1, 1.7, 2.6, 4.1, 6.1, 8.9, 12.7, 17.3, 23.3, 29.9,
];
/// One period of all lines (s).
const PERIOD_S: f64 = 10.0;
/// How long is palpated before (s): an impedance converges within a second and crosses.
const LEARNS_S: f64 = 5.0;

/// The transparency of a scheme on the first material; one that does not come to rest on it moves by itself, and has
/// none.
pub fn transparency(options: &Options, seed: u64) -> Vec<Line> {
    let trace = moved(options, seed);
    match trace.ended && rest_on_the_first(options, seed) != Rest::Moves {
        true => lines(&trace),
        false => LINES_HZ.map(not_determined).into(),
    }
}

/// The first material under a motion that holds all lines.
fn moved(options: &Options, seed: u64) -> Trace {
    let mut options = options.clone();
    let round_trip_s = options.channels[0].delay_s + options.channels[1].delay_s;
    options.environment = Environment::throughout(options.environment.first);
    options.operator.intention = motion(LEARNS_S + round_trip_s);
    System::new(&options, seed).run()
}

fn lines(trace: &Trace) -> Vec<Line> {
    let last_s = trace.rows.last().map_or(0.0, |row| row.time_s);
    let rows = trace.between(last_s - PERIOD_S + 0.5 * trace.period_s, f64::INFINITY);
    let of = |frequency_hz: f64, force: fn(&Row) -> f64| {
        let (mut re, mut im) = (0.0, 0.0);
        for row in rows {
            let (sin, cos) = (TAU * frequency_hz * row.time_s).sin_cos();
            re += force(row) * cos;
            im -= force(row) * sin;
        }
        (re, im)
    };
    let lines = LINES_HZ.into_iter().map(|frequency_hz| {
        let (felt, real) = (
            of(frequency_hz, |row| row.felt_n),
            of(frequency_hz, |row| row.true_n),
        );
        Line {
            frequency_hz,
            magnitude: felt.0.hypot(felt.1) / real.0.hypot(real.1),
            phase_rad: (felt.1 * real.0 - felt.0 * real.1).atan2(felt.0 * real.0 + felt.1 * real.1),
        }
    });
    lines.collect()
}

/// A line of a system that does not follow the motion.
fn not_determined(frequency_hz: f64) -> Line {
    Line {
        frequency_hz,
        magnitude: f64::NAN,
        phase_rad: f64::NAN,
    }
}

/// Whether a scheme oscillated by itself, so that no line was determined.
pub fn oscillates(lines: &[Line]) -> bool {
    lines.iter().all(|line| line.magnitude.is_nan())
}

/// A palpation for the estimator, then all lines about a depth that is never left, for two periods: the
/// first one lets what was before die away.
fn motion(learns_s: f64) -> Motion {
    let segments = vec![
        Segment::Hold { seconds: 0.6 },
        Segment::Sine {
            mean_m: 4e-3,
            amplitude_m: 10e-3,
            frequency_hz: 0.8,
            seconds: learns_s,
        },
        Segment::Ramp {
            to_m: 9e-3,
            speed_mps: 0.06,
        },
        Segment::Multisine {
            mean_m: 9e-3,
            amplitude_m: 6e-3,
            frequencies_hz: LINES_HZ.to_vec(),
            seconds: 2.0 * PERIOD_S,
        },
    ];
    Motion::new(-6e-3, segments).expect("the segments have durations and finite numbers")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::teleop::SchemeId;
    use crate::teleop::environment::Material;

    #[test]
    fn a_scheme_that_oscillates_by_itself_has_no_transparency_and_one_that_follows_has() {
        let lines = |scheme: SchemeId, delay_s: f64| {
            let mut options = Options::default().with_scheme(scheme);
            options.environment = Environment::throughout(Material::linear(1000.0, 5.0));
            transparency(&options.with_channel(delay_s, 0.0, 0.0), 1)
        };
        assert!(oscillates(&lines(SchemeId::PositionForce, 0.5)));
        assert!(!oscillates(&lines(SchemeId::Reflection, 0.15)));
        assert!(!oscillates(&lines(SchemeId::WaveVariables, 0.05)));
    }
}
