//! The delay between the two channels: the early one waits for the other.

use crate::estimate::error::{ConfigError, require};
use crate::maths::scalar::Real;

/// Largest delay between the channels that can be compensated, in either direction (samples).
pub const MAX_DELAY_SAMPLES: usize = 64;

/// Delay of the force behind the position, in whole samples and a fraction of one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ChannelDelay<T> {
    whole: usize,
    fraction: T,
    /// Whether the force is late, so that the position waits; otherwise the force waits.
    position_waits: bool,
}

/// The last samples of the channel that waits, newest first.
#[derive(Clone, Debug)]
pub(super) struct DelayLine<T> {
    samples: [T; MAX_DELAY_SAMPLES + 2],
}

impl<T: Real> ChannelDelay<T> {
    pub(super) fn new(delay_s: f64, rate_hz: f64) -> Result<Self, ConfigError> {
        let samples = delay_s.abs() * rate_hz;
        require(
            // 64 ms from a setting in f32 are 64.000 000 3 samples.
            samples <= MAX_DELAY_SAMPLES as f64 * (1.0 + 1e-6),
            "time_delay.delay",
            delay_s as f32,
            "must be at most 64 samples long, either way",
        )?;
        let whole = samples as usize;
        Ok(ChannelDelay {
            whole,
            fraction: T::from_f64(samples - whole as f64),
            position_waits: delay_s > 0.0,
        })
    }

    /// Length of the delay, rounded down (samples).
    pub(super) fn samples(&self) -> usize {
        self.whole
    }

    /// Takes position (m) and force (N) as they were read; gives both at one instant.
    pub(super) fn align(&self, line: &mut DelayLine<T>, position_m: T, force_n: T) -> (T, T) {
        if self.whole == 0 && self.fraction == T::zero() {
            return (position_m, force_n);
        }
        let early = self.early(position_m, force_n);
        line.samples.rotate_right(1);
        if let Some(newest) = line.samples.first_mut() {
            *newest = early;
        }
        let before = |steps: usize| line.samples.get(steps).copied().unwrap_or(early);
        let delayed =
            before(self.whole) + self.fraction * (before(self.whole + 1) - before(self.whole));
        match self.position_waits {
            true => (delayed, force_n),
            false => (position_m, delayed),
        }
    }

    /// Fills the line as if both channels had always read this.
    pub(super) fn restart(&self, line: &mut DelayLine<T>, position_m: T, force_n: T) {
        line.samples = [self.early(position_m, force_n); MAX_DELAY_SAMPLES + 2];
    }

    fn early(&self, position_m: T, force_n: T) -> T {
        if self.position_waits {
            position_m
        } else {
            force_n
        }
    }
}

impl<T: Real> Default for DelayLine<T> {
    fn default() -> Self {
        DelayLine {
            samples: [T::zero(); MAX_DELAY_SAMPLES + 2],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_early_channel_is_delayed_by_whole_samples_and_a_fraction() {
        for (delay_s, expected) in [
            (0.0, (10.0, 20.0)),
            (2.5e-3, (7.5, 20.0)),
            (-2.5e-3, (10.0, 15.0)),
        ] {
            let delay = ChannelDelay::<f64>::new(delay_s, 1000.0).unwrap();
            let mut line = DelayLine::default();
            delay.restart(&mut line, 0.0, 0.0);
            let last = (1..=10).map(|i| delay.align(&mut line, f64::from(i), 2.0 * f64::from(i)));
            assert_eq!(last.last(), Some(expected));
        }
    }

    #[test]
    fn a_delay_beyond_the_line_is_refused() {
        assert!(ChannelDelay::<f32>::new(f64::from(0.064_f32), 1000.0).is_ok());
        assert!(ChannelDelay::<f32>::new(-0.0641, 1000.0).is_err());
    }
}
