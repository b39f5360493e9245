//! Which way the channels of a machine count, by what they show: air on one side, contact on the other.

use crate::signal;
use crate::stats::{extent, median};

/// Outer share of the travel in which the force of either end is looked at.
const END: f64 = 0.05;
/// Share of the travel over which either end's slope is taken.
const SIDE: f64 = 0.25;
/// The force changes so many times more on the side of the contact than in the air,
const STEEPER: f64 = 3.0;
/// and by so many standard deviations of its noise in all.
const PUSHES: f64 = 20.0;

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
    match rise > 0.0 {
        true if sure(low_side, high_side) => Orientation::Both,
        true => Orientation::AsIs,
        false if sure(low_side, high_side) => Orientation::Position,
        false if sure(high_side, low_side) => Orientation::Force,
        false => Orientation::One,
    }
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
    fn a_spring_without_air_does_not_tell_which_sign_is_wrong() {
        let x: Vec<f64> = (0..1000).map(|i| f64::from(i) * 1e-6).collect();
        let falling: Vec<f64> = x.iter().map(|x| -1000.0 * x).collect();
        assert_eq!(of(&x, &falling), Orientation::One);
        let rising: Vec<f64> = x.iter().map(|x| 1000.0 * x).collect();
        assert_eq!(of(&x, &rising), Orientation::AsIs);
    }
}
