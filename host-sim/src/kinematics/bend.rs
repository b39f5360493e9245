//! The acceleration: bends of local polynomials of the fifth degree.
//!
//! The bend of a cubic is a mean over its window, and a motor's acceleration turns within
//! milliseconds: on a simulated servo (18–35 Hz, 1 µm, 1 kHz) a cubic as wide as its residuals allow
//! made a mass 1.6 to 2.8 % too large, the quintic 0.6 %.
//!
//! Where a position is as noisy as measured ones are, a narrow window says nothing of the acceleration, and a few
//! of them spoil all: the record of a friction damper, 0.76 m/s² rms, got 3.3 m/s² with a correlation of 0.25,
//! and a mass that made half of the force took 3 % off. The narrowest window of a log is therefore the one that
//! shows most beyond its noise.

use super::misfit::within;
use super::width;
use crate::stats::rms;

/// Half-widths that are tried, widest first; three is the narrowest that leaves anything.
const HALF_WIDTHS: [usize; 9] = [15, 12, 10, 8, 7, 6, 5, 4, 3];
const DEGREE: i32 = 5;
/// Most windows in which bends are looked at to find the narrowest width.
const LOOKED_AT: usize = 10_000;
/// The mean square of bends less this many times that of their noise is largest at the narrowest window. 2 were
/// right for a noise that is known and white; that of a position remembers, and is read too low by a half.
const NOISE_COUNTS: f64 = 10.0;
/// A position moves if it is this many standard deviations of its noise elsewhere at the end of a window.
const MOVES: f64 = 6.0;

/// The windows of a log, and the noise of its position.
pub(super) struct Bends {
    /// Widest first. The last one is taken where none is within the noise.
    windows: Vec<Quintic>,
    noise_m: f64,
}

impl Bends {
    /// Those for a position with such a noise (m); `wider` are the half-widths that its rate asks for.
    pub(super) fn of(channel: &[f64], wider: &[usize], noise_m: f64) -> Bends {
        let narrowest = narrowest(channel, noise_m);
        let mut windows = Quintic::all(wider);
        match windows.iter().any(|own| own.half_width >= narrowest) {
            true => windows.retain(|own| own.half_width >= narrowest),
            false => windows = vec![Quintic::new(narrowest)],
        }
        Bends { windows, noise_m }
    }

    /// Bend per sample at a sample, at the ends of the log that of the next that has a window, its noise for one
    /// of 1 in the position, and the half-width of the narrowest window if even that leaves more than the noise; `None` in a
    /// log that is shorter than a window.
    pub(super) fn at(&self, channel: &[f64], at: usize) -> Option<(f64, f64, Option<usize>)> {
        let last = channel.len() - 1;
        let least = self.windows.last().map(|own| own.half_width);
        let least = least.filter(|width| 2 * width <= last)?;
        let at = at.clamp(least, last - least);
        let mut narrowest = None;
        let room = at.min(last - at);
        for own in self.windows.iter().filter(|own| own.half_width <= room) {
            let (bend, left) = own.bend(channel, at);
            if left <= own.within * self.noise_m {
                return Some((bend, own.noise, None));
            }
            narrowest = Some((bend, own.noise, Some(own.half_width)));
        }
        narrowest
    }
}

/// The places up to so many on either side of one.
pub(super) fn around<T>(all: &mut [T], at: usize, reach: usize) -> &mut [T] {
    let to = (at + reach + 1).min(all.len());
    &mut all[at.saturating_sub(reach)..to]
}

/// The half-width that shows most of the bends beyond their noise.
fn narrowest(channel: &[f64], noise_m: f64) -> usize {
    let own = HALF_WIDTHS.iter().rev().copied();
    let all = own.chain(width::for_noise(HALF_WIDTHS[0]));
    let fits = |width: &usize| 16 * width < channel.len();
    let (mut most, mut narrowest) = (f64::NEG_INFINITY, HALF_WIDTHS[HALF_WIDTHS.len() - 1]);
    for width in all.take_while(fits) {
        let own = Quintic::new(width);
        // Where it rests there is nothing to show.
        let moving = channel
            .windows(2 * width + 1)
            .step_by(channel.len().div_ceil(LOOKED_AT))
            .filter(|window| (window[0] - window[window.len() - 1]).abs() > MOVES * noise_m);
        let shown = rms(moving.map(|window| own.bend_at_centre(window)));
        let beyond = shown.powi(2) - NOISE_COUNTS * (own.noise * noise_m).powi(2);
        if beyond > most {
            (most, narrowest) = (beyond, width);
        }
    }
    narrowest
}

/// A window, and what gives the bend at its centre.
pub(super) struct Quintic {
    pub(super) half_width: usize,
    /// Standard deviation of the bend per sample, for a white noise of 1.
    pub(super) noise: f64,
    /// What it may leave of a position, in standard deviations of its noise.
    pub(super) within: f64,
    /// Orthonormal polynomials of degrees 0 to 5 over −m..m.
    basis: Vec<Vec<f64>>,
    /// The bend per sample at the centre of each.
    bends: Vec<f64>,
    /// What each sample of the window counts for the bend.
    kernel: Vec<f64>,
}

impl Quintic {
    /// All widths, widest first; `wider` are those above the own ones.
    pub(super) fn all(wider: &[usize]) -> Vec<Quintic> {
        let all = wider.iter().copied().chain(HALF_WIDTHS);
        all.map(Quintic::new).collect()
    }

    fn new(half_width: usize) -> Quintic {
        let m = half_width as f64;
        let places: Vec<f64> = (0..=2 * half_width).map(|k| k as f64 / m - 1.0).collect();
        let (mut basis, mut bends): (Vec<Vec<f64>>, Vec<f64>) = (Vec::new(), Vec::new());
        // Gram & Schmidt on the powers of k/m; of those the square alone bends at the centre.
        for power in 0..=DEGREE {
            let mut own: Vec<f64> = places.iter().map(|u| u.powi(power)).collect();
            let mut bend = if power == 2 { 2.0 / (m * m) } else { 0.0 };
            for (one, its) in basis.iter().zip(&bends) {
                let share = product(&own, one);
                own.iter_mut().zip(one).for_each(|(a, b)| *a -= share * b);
                bend -= share * its;
            }
            let size = product(&own, &own).sqrt();
            own.iter_mut().for_each(|a| *a /= size);
            basis.push(own);
            bends.push(bend / size);
        }
        let kernel = (0..=2 * half_width).map(|k| {
            (basis.iter().zip(&bends))
                .map(|(one, bend)| one[k] * bend)
                .sum()
        });
        Quintic {
            half_width,
            kernel: kernel.collect(),
            noise: product(&bends, &bends).sqrt(),
            within: within((2 * half_width) as f64 - f64::from(DEGREE)),
            basis,
            bends,
        }
    }

    /// The bend per sample at the centre of a window.
    fn bend_at_centre(&self, window: &[f64]) -> f64 {
        product(window, &self.kernel)
    }

    /// Bend per sample, and rms of what the polynomial leaves of the channel.
    pub(super) fn bend(&self, channel: &[f64], at: usize) -> (f64, f64) {
        let window = &channel[at - self.half_width..=at + self.half_width];
        let near: Vec<f64> = window.iter().map(|x| x - channel[at]).collect();
        let shares = self.basis.iter().map(|one| product(&near, one));
        let mut left = product(&near, &near);
        let mut bend = 0.0;
        for (share, its) in shares.zip(&self.bends) {
            left -= share * share;
            bend += share * its;
        }
        let freedom = near.len() as f64 - self.basis.len() as f64;
        (bend, (left.max(0.0) / freedom).sqrt())
    }
}

fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, Normal};

    const SEED_BEND: u64 = 23;

    /// Bends of a sine of 1, `samples` long each turn, in a position with such a noise and every 500 samples a jump
    /// of so many standard deviations of it, and what they are.
    fn of_sine(samples: f64, noise: f64, jump: f64) -> (Vec<f64>, Vec<f64>) {
        let mut rng = rand_pcg::Pcg64::seed_from_u64(SEED_BEND);
        let normal = Normal::new(0.0, noise).unwrap();
        let turn = std::f64::consts::TAU / samples;
        let value = |at: usize| (turn * at as f64).sin();
        let jumped = |at: usize| if at % 500 == 250 { jump * noise } else { 0.0 };
        let channel: Vec<f64> = (0..8000)
            .map(|at| value(at) + jumped(at) + normal.sample(&mut rng))
            .collect();
        let bends = Bends::of(&channel, &[], noise);
        let found = (0..8000).map(|at| bends.at(&channel, at).unwrap().0);
        let true_bends = (0..8000).map(|at| -turn * turn * value(at));
        (found.collect(), true_bends.collect())
    }

    /// The rms of the error over that of the bends, but for the ends.
    fn error((found, bends): &(Vec<f64>, Vec<f64>)) -> f64 {
        let each = found.iter().zip(bends).skip(20).take(7960);
        rms(each.map(|(a, b)| a - b)) / rms(bends.iter().copied())
    }

    #[test]
    fn a_window_is_as_wide_as_the_noise_asks_for_and_the_ends_are_no_worse() {
        // GIVEN a turn in 2000 samples under a noise of a thousandth: the bends are 1e-5, that of the widest
        // window at 1 kHz, 31 samples, would have a noise of 5e-5
        let sine = of_sine(2000.0, 1e-3, 0.0);
        assert!(error(&sine) < 0.2, "{}", error(&sine));
        let ends = sine.0[..200].iter().chain(&sine.0[7800..]);
        assert!(ends.map(|a| a.abs()).fold(0.0, f64::max) < 1.5e-5);
        // AND without noise the window stays narrow.
        let sine = of_sine(40.0, 1e-9, 0.0);
        assert!(error(&sine) < 1e-3, "{}", error(&sine));
    }

    #[test]
    fn what_is_no_polynomial_does_not_choose_a_window_that_its_noise_rules() {
        // GIVEN a sine with a jump of ten standard deviations of its noise every 500 samples
        let sine = of_sine(1000.0, 1e-4, 10.0);
        // THEN it does not rule the bends: a parabola through it alone would be 50 times as large as they are.
        assert!(error(&sine) < 0.5, "{}", error(&sine));
    }

    #[test]
    fn the_bend_of_a_quintic_is_its_own_at_every_width() {
        // GIVEN a polynomial of the fifth degree, bend 0.6 at sample 20
        let at = |k: usize| {
            let u = k as f64 - 20.0;
            3.0 + u + 0.3 * u * u - 2e-2 * u.powi(3) + 1e-3 * u.powi(4) - 1e-5 * u.powi(5)
        };
        let channel: Vec<f64> = (0..41).map(at).collect();
        for window in Quintic::all(&[]) {
            let (bend, left) = window.bend(&channel, 20);
            assert!((bend - 0.6).abs() < 1e-9, "{}: {bend}", window.half_width);
            // Sums of squares of 700 lose eight digits.
            assert!(left < 1e-4, "{}: {left:e}", window.half_width);
        }
    }

    #[test]
    fn the_noise_of_a_bend_is_that_of_its_weights() {
        // One sample of 1 at each place: the sum of the squares of what the bend makes of them.
        for window in Quintic::all(&[]) {
            let m = window.half_width;
            let square: f64 = (0..=2 * m)
                .map(|one| {
                    let mut channel = vec![0.0; 2 * m + 1];
                    channel[one] = 1.0;
                    window.bend(&channel, m).0.powi(2)
                })
                .sum();
            assert!((square.sqrt() / window.noise - 1.0).abs() < 1e-9, "{m}");
        }
    }
}
