//! Shares with their confidence intervals.

use crate::tolerance::SURE;

/// A share: how many of how many cases.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Share {
    /// The cases that count.
    pub hits: usize,
    /// All cases.
    pub of: usize,
}

impl Share {
    /// Counts one more case.
    pub(crate) fn push(&mut self, hit: bool) {
        self.hits += usize::from(hit);
        self.of += 1;
    }

    /// Wilson's 95 % interval of the share.
    pub fn interval(self) -> (f64, f64) {
        if self.of == 0 {
            return (0.0, 1.0);
        }
        let (n, p, z) = (self.of as f64, self.hits as f64 / self.of as f64, SURE);
        let scale = 1.0 / (1.0 + z * z / n);
        let middle = scale * (p + z * z / (2.0 * n));
        let half = scale * z * (p * (1.0 - p) / n + z * z / (4.0 * n * n)).sqrt();
        ((middle - half).max(0.0), (middle + half).min(1.0))
    }

    /// The upper end of the one-sided 95 % interval of Clopper and Pearson: at a larger share, as few hits
    /// as these have a probability of less than 5 %. "At most 1 % at 95 % confidence" asks for it.
    pub fn upper(self) -> f64 {
        let (mut low, mut high) = (0.0, 1.0);
        if self.hits >= self.of {
            return high;
        }
        // 40 halvings: 10⁻¹².
        for _ in 0..40 {
            let middle: f64 = 0.5 * (low + high);
            if self.at_most_these(middle) > 0.05 {
                low = middle;
            } else {
                high = middle;
            }
        }
        high
    }

    /// The probability of no more hits than these at a share 0 < p < 1.
    fn at_most_these(self, p: f64) -> f64 {
        let n = self.of as f64;
        let (mut log, mut sum) = (n * (-p).ln_1p(), 0.0);
        for k in 0..=self.hits {
            sum += f64::exp(log);
            let k = k as f64;
            log += ((n - k) / (k + 1.0) * p / (1.0 - p)).ln();
        }
        sum
    }
}

impl std::fmt::Display for Share {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if self.of == 0 {
            return f.pad("–");
        }
        let (low, high) = self.interval();
        let share = 100.0 * self.hits as f64 / self.of as f64;
        f.pad(&format!(
            "{share:.1} ({:.0}–{:.0})",
            100.0 * low,
            100.0 * high
        ))
    }
}
