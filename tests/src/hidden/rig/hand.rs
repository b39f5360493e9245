//! A hand that pushes the rig once, which no model of the rig explains.

use super::case::Case;
use super::fit::rms;
use super::random::Random;
use std::f64::consts::PI;

/// The stream of its draws, apart from those of the rig.
const STREAM: u64 = 0x4A4D;

impl Case {
    /// The same log with a hand on the rig for 0.8 to 2 % of it: half a sine of force, of 3 to 8 times its standard
    /// deviation, once, either way.
    #[must_use]
    pub fn pushed(mut self) -> Case {
        let mut random = Random::new(self.seed, self.index << 16 | STREAM);
        let count = self.rows.len() as f64;
        let mean = self.rows.iter().map(|row| row[2]).sum::<f64>() / count;
        let off: Vec<f64> = self.rows.iter().map(|row| row[2] - mean).collect();
        let most = random.sign() * random.between(3.0, 8.0) * rms(&off);
        let (from, length) = (random.between(0.2, 0.8), random.between(0.008, 0.02));
        for (at, row) in self.rows.iter_mut().enumerate() {
            let share = (at as f64 / count - from) / length;
            if (0.0..1.0).contains(&share) {
                row[2] += most * (PI * share).sin();
            }
        }
        self
    }
}
