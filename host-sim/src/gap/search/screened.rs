//! The samples that the first steps of a joint refit take.

use crate::gap::data::fit_data::FitData;

/// Every second sample of the logs of a search: two dozen starts with a few steps each are half of its work, and what
/// is followed is followed on all samples. All of them where rests are thinned: their few samples in motion are what a
/// start is judged by, and with half of them a foam's relaxation was not found.
pub(crate) struct Screened {
    pub(super) logs: Vec<FitData>,
    /// One sample of so many is taken.
    step: usize,
}

impl Screened {
    pub(crate) fn of(logs: &[FitData]) -> Screened {
        let step = match logs.iter().all(FitData::is_nearly_even) {
            true => 2,
            false => 1,
        };
        Screened {
            logs: logs.iter().map(|log| log.thinned(step)).collect(),
            step,
        }
    }

    /// Of one value for each sample of all logs, log after log, those of the samples that are taken.
    pub(super) fn of_all(&self, values: &[f64], logs: &[FitData]) -> Vec<f64> {
        let mut left = values;
        let mut taken = Vec::with_capacity(values.len() / self.step + logs.len());
        for log in logs {
            let (own, others) = left.split_at(log.len());
            taken.extend(FitData::kept(log.len(), self.step).map(|at| own[at]));
            left = others;
        }
        taken
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::Log;

    #[test]
    fn the_values_of_the_samples_that_are_taken_are_taken() {
        let log = |count: u32| {
            let time: Vec<f64> = (0..count).map(|at| 1e-3 * f64::from(at)).collect();
            let log = Log::from_channels(time.clone(), time.clone(), time);
            FitData::of(&log.uniform().unwrap())
        };
        let logs = [log(41), log(64)];
        let screened = Screened::of(&logs);
        let times = |logs: &[FitData]| -> Vec<f64> {
            let each = logs.iter().flat_map(|log| log.time_s.iter());
            each.copied().collect()
        };
        let taken = screened.of_all(&times(&logs), &logs);
        assert_eq!(taken, times(&screened.logs));
        assert_eq!(taken.len(), 20 + 32);
    }
}
