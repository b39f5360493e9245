//! The acceleration: bends of local polynomials of the fifth degree.
//!
//! The bend of a cubic is a mean over its window, and a motor's acceleration turns within
//! milliseconds: on a simulated servo (18–35 Hz, 1 µm, 1 kHz) a cubic as wide as its residuals allow
//! made a mass 1.6 to 2.8 % too large, the quintic 0.6 %.

use super::misfit::within;

/// Half-widths that are tried, widest first; three is the narrowest that leaves anything.
const HALF_WIDTHS: [usize; 9] = [15, 12, 10, 8, 7, 6, 5, 4, 3];
const DEGREE: i32 = 5;

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
        Quintic {
            half_width,
            noise: product(&bends, &bends).sqrt(),
            within: within((2 * half_width) as f64 - f64::from(DEGREE)),
            basis,
            bends,
        }
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
