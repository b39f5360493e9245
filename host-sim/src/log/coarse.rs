//! Stamps that repeat: left out, or spread over the samples that share them.

use super::record::Log;
use crate::number::quantity;

/// Stamps may lie this many of their steps off the line of even samples.
const OFF_LINE: f64 = 1.05;

impl Log {
    /// Leaves every sample out whose stamp is that of the sample before.
    pub(super) fn leave_out_repeated(&mut self) {
        let time_s = &self.time_s;
        let kept: Vec<bool> = (0..time_s.len())
            .map(|at| at == 0 || time_s[at] != time_s[at - 1])
            .collect();
        let channels = [&mut self.time_s, &mut self.position_m, &mut self.force_n];
        let extra = self.extra.iter_mut().map(|column| &mut column.values);
        for channel in channels.into_iter().chain(extra) {
            let mut keep = kept.iter();
            channel.retain(|_| keep.next().is_some_and(|keep| *keep));
        }
    }

    /// Whether every sample whose stamp is that of the one before has its position and force, too: at a coarse clock
    /// some of them would differ.
    pub(super) fn repeats_are_copies(&self) -> bool {
        let mut repeats = (1..self.len()).filter(|at| self.time_s[*at] == self.time_s[at - 1]);
        let moves = crate::stats::range(&self.position_m) > 0.0;
        let is_copy = |at: usize| {
            self.position_m[at] == self.position_m[at - 1]
                && self.force_n[at] == self.force_n[at - 1]
        };
        moves && repeats.all(is_copy)
    }

    /// Replaces stamps that are coarser than the sampling by even ones, if each stays within a step of where it
    /// was; the note to that, or `None` with nothing changed.
    pub(super) fn spread_evenly(&mut self) -> Option<String> {
        let first_s = *self.time_s.first()?;
        let last_s = *self.time_s.last()?;
        let steps: Vec<f64> = self
            .time_s
            .windows(2)
            .map(|pair| pair[1] - pair[0])
            .filter(|step| *step > 0.0)
            .collect();
        let step_s = steps.iter().copied().fold(f64::INFINITY, f64::min);
        // The first and the last stamp may be shared by fewer samples: those between them count.
        let inner = self
            .time_s
            .iter()
            .filter(|t| **t > first_s && **t < last_s)
            .count();
        let next_s = *self.time_s.iter().find(|t| **t > first_s)?;
        let before = self.time_s.iter().take_while(|t| **t <= first_s).count();
        if inner == 0 {
            return None;
        }
        let period_s = (last_s - next_s) / inner as f64;
        let even_s = |at: usize| next_s + (at as f64 - before as f64) * period_s;
        let mut all = self.time_s.iter().enumerate();
        if !all.all(|(at, stamp)| (even_s(at) - stamp).abs() <= OFF_LINE * step_s) {
            return None;
        }
        self.time_s = (0..self.time_s.len()).map(even_s).collect();
        let (step, rate_hz) = (
            quantity(step_s, 3, "s"),
            super::timing::snapped(1.0 / period_s),
        );
        Some(format!(
            "the time stamps come in steps of {step}, coarser than the sampling: the samples between them are \
             taken as even, {rate_hz} a second"
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn log(time_s: Vec<f64>) -> Log {
        let zeros = vec![0.0; time_s.len()];
        Log::from_channels(time_s, zeros.clone(), zeros)
    }

    #[test]
    fn stamps_of_ten_milliseconds_at_a_kilohertz_become_even() {
        let mut log = log((3..2003).map(|i| f64::from(i / 10) * 0.01).collect());
        assert!(log.spread_evenly().unwrap().contains("1000"));
        assert!((log.duration_s() - 1.999).abs() < 1e-9);
    }

    #[test]
    fn stamps_that_stand_still_for_long_are_left_alone() {
        let stamps = (0..2000).map(|i: i32| {
            f64::from(if i < 1000 {
                i / 10
            } else {
                100 + (i - 1000) / 50
            }) * 0.01
        });
        let mut log = log(stamps.collect());
        let before = log.clone();
        assert_eq!(log.spread_evenly(), None);
        assert_eq!(log, before);
    }

    #[test]
    fn rows_that_were_written_twice_are_copies_and_two_samples_of_one_stamp_are_none() {
        let stamps = (0..40).map(|i: i32| f64::from(i / 2) * 5e-3);
        let mut log = log(stamps.collect());
        log.position_m = (0..40).map(|i: i32| f64::from(i / 2) * 1e-4).collect();
        assert!(log.repeats_are_copies());
        log.force_n[7] = 0.1;
        assert!(!log.repeats_are_copies());
    }

    #[test]
    fn repeated_samples_leave_with_all_their_cells() {
        let mut log = log(vec![0.0, 1.0, 1.0, 2.0]);
        log.force_n = vec![1.0, 2.0, 3.0, 4.0];
        log.leave_out_repeated();
        assert_eq!((log.len(), log.force_n), (3, vec![1.0, 2.0, 4.0]));
    }
}
