//! Which way the channels of a machine count, by what they show: air on one side, contact on the other.

use crate::signal;
use crate::stats::{extent, median, quantile};

/// Outer share of the travel in which the force of either end is looked at.
const END: f64 = 0.05;
/// Share of the travel over which either end's slope is taken.
const SIDE: f64 = 0.25;
/// The force changes so many times more on the side of the contact than in the air,
const STEEPER: f64 = 3.0;
/// and by so many standard deviations of its noise in all.
const PUSHES: f64 = 20.0;

/// In the air the force stays within this share of its whole range; of a machine that touches nothing it varies by
/// what drives and drags it. Measured over the outer quarter of the travel: at most 0.03 in 17 logs with a contact (two
/// with drift), at least 0.18 in 30 logs of machines without one.
const QUIET: f64 = 0.12;
/// A force that follows the position falls by this share of its range from end to end. Measured: springs without air
/// 0.59 and more, machines without contact whose force falls along the way up to 0.37.
const FOLLOWS: f64 = 0.5;

/// What has to be reversed so that the position grows into the material and the force pushes out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Orientation {
    /// Nothing, as far as the channels tell.
    AsIs,
    Both,
    Position,
    Force,
    /// One of the two, and nothing tells which.
    One,
}

/// How two channels are oriented.
pub(super) fn of(position: &[f64], force: &[f64]) -> Orientation {
    let (low, high) = extent(position);
    let travel = high - low;
    let near = |from: f64, to: f64| {
        let here = position.iter().zip(force);
        let here = here.filter(move |(x, _)| (from..=to).contains(*x));
        median(here.map(|(_, f)| *f))
    };
    if travel.is_nan() || travel <= 0.0 {
        return Orientation::AsIs;
    }
    let end = END * travel;
    let (at_low, at_high) = (near(low, low + end), near(high - end, high));
    let inner = |from: f64| {
        near(
            low + (from - 0.5 * END) * travel,
            low + (from + 0.5 * END) * travel,
        )
    };
    // How much the force changes over the outer quarter of either side.
    let (low_side, high_side) = (
        (inner(SIDE) - at_low).abs(),
        (at_high - inner(1.0 - SIDE)).abs(),
    );
    let rise = at_high - at_low;
    let noise = signal::noise(force);
    if !rise.is_finite() || rise.abs() < PUSHES * noise {
        return Orientation::AsIs;
    }
    let sure = |steep: f64, flat: f64| steep > STEEPER * (flat + noise);
    // Nothing but a contact is steep on one side and still on the other.
    let is_quiet = |from: f64, to: f64| {
        let here = position.iter().zip(force);
        let here: Vec<f64> = here
            .filter(|(x, _)| (from..=to).contains(*x))
            .map(|(_, f)| *f)
            .collect();
        spread(&here, 0.1) <= QUIET * spread(force, 0.005) + PUSHES * noise
    };
    let low_is_contact = sure(low_side, high_side) && is_quiet(high - SIDE * travel, high);
    let high_is_contact = sure(high_side, low_side) && is_quiet(low, low + SIDE * travel);
    match rise > 0.0 {
        true if low_is_contact => Orientation::Both,
        true => Orientation::AsIs,
        false if low_is_contact => Orientation::Position,
        false if high_is_contact => Orientation::Force,
        false if -rise > FOLLOWS * spread(force, 0.005) => Orientation::One,
        false => Orientation::AsIs,
    }
}

/// From the quantile of `outside` to that of its counterpart.
fn spread(values: &[f64], outside: f64) -> f64 {
    quantile(values.iter().copied(), 1.0 - outside) - quantile(values.iter().copied(), outside)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A press into 2 N/mm out of the air, with the signs given.
    fn oriented(x_sign: f64, f_sign: f64) -> Orientation {
        let phase = |i: u32| std::f64::consts::TAU * f64::from(i) / 1000.0;
        let x: Vec<f64> = (0..2000).map(|i| 1e-3 - 2e-3 * phase(i).cos()).collect();
        let f: Vec<f64> = x.iter().map(|x| f_sign * 2000.0 * x.max(0.0)).collect();
        let x: Vec<f64> = x.iter().map(|x| x_sign * x).collect();
        of(&x, &f)
    }

    #[test]
    fn the_side_of_the_contact_tells_every_sign() {
        assert_eq!(oriented(1.0, 1.0), Orientation::AsIs);
        assert_eq!(oriented(-1.0, -1.0), Orientation::Both);
        assert_eq!(oriented(-1.0, 1.0), Orientation::Position);
        assert_eq!(oriented(1.0, -1.0), Orientation::Force);
    }

    #[test]
    fn a_machine_that_touches_nothing_has_no_sign_to_guess() {
        // Drag and friction along two sines: whichever end the slower strokes reach, the medians of the force differ.
        for slow in [0.31, 0.43, 0.57] {
            let phase = |i: u32| f64::from(i) * 6e-3;
            let x: Vec<f64> = (0..6000)
                .map(|i| phase(i).sin() + 0.6 * (slow * phase(i)).sin())
                .collect();
            let drag = |at: usize| {
                let speed = x[at + 1] - x[at];
                100.0 * speed * if speed > 0.0 { 3.0 } else { 1.0 } + 0.2 * speed.signum()
            };
            let force: Vec<f64> = (0..x.len() - 1).map(drag).collect();
            let reversed: Vec<f64> = force.iter().map(|f| -f).collect();
            let x = &x[..force.len()];
            assert_eq!(of(x, &force), Orientation::AsIs, "{slow}");
            assert_eq!(of(x, &reversed), Orientation::AsIs, "{slow}");
        }
    }

    #[test]
    fn a_spring_without_air_does_not_tell_which_sign_is_wrong() {
        let x: Vec<f64> = (0..1000).map(|i| f64::from(i) * 1e-6).collect();
        let falling: Vec<f64> = x.iter().map(|x| -1000.0 * x).collect();
        assert_eq!(of(&x, &falling), Orientation::One);
        let rising: Vec<f64> = x.iter().map(|x| 1000.0 * x).collect();
        assert_eq!(of(&x, &rising), Orientation::AsIs);
    }
}
