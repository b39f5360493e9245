//! A coarser view of the logs, on which the first steps of many fits are taken and few of them picked.

use crate::gap::data::fit_data::FitData;
use crate::gap::model::problem::Problem;

/// Fewest samples of the view: half of those of a search. First steps take four tenths of a search's time, and most of
/// their fits are followed no further.
const LEAST: usize = 2_000;

/// The logs, of which every so many samples are left out.
pub(crate) struct Screen {
    logs: Vec<FitData>,
    step: usize,
}

impl Screen {
    /// The view of the logs of a search.
    pub(crate) fn of(logs: &[FitData]) -> Screen {
        let samples: usize = logs.iter().map(FitData::len).sum();
        let step = (samples / LEAST).max(1);
        let logs = logs.iter().map(|log| log.thinned(step)).collect();
        Screen { logs, step }
    }

    /// What comes of a problem of these logs as this view has it, each sample with its weight.
    pub(super) fn see<R>(&self, whole: Problem<'_>, run: impl FnOnce(Problem<'_>) -> R) -> R {
        let mut from = 0;
        let mut weights = Vec::new();
        for log in whole.logs {
            let own = &whole.weights[from..from + log.len()];
            weights.extend(FitData::thinned_rows(own.len(), self.step).map(|at| own[at]));
            from += log.len();
        }
        run(Problem {
            logs: &self.logs,
            weights: &weights,
            ..whole
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::Log;

    /// A log with so many samples, whose force is the number of the sample.
    fn log(samples: usize) -> FitData {
        let time = (0..samples).map(|at| 1e-3 * at as f64).collect();
        let position = (0..samples).map(|at| (0.01 * at as f64).sin()).collect();
        let force = (0..samples).map(|at| at as f64).collect();
        let log = Log::from_channels(time, position, force);
        FitData::of(&log.uniform().unwrap())
    }

    #[test]
    fn each_sample_of_the_view_keeps_its_weight() {
        // GIVEN two logs of a search whose weights are the numbers of the samples
        let logs = [log(2_500), log(2_501)];
        let weights: Vec<f64> = logs.iter().flat_map(|log| log.force_n.clone()).collect();
        let whole = Problem {
            logs: &logs,
            weights: &weights,
            low_pass: None,
            known: None,
        };
        Screen::of(&logs).see(whole, |thin| {
            // THEN every second sample is left, with its own.
            let forces = thin.logs.iter().flat_map(|log| log.force_n.clone());
            assert_eq!(forces.collect::<Vec<f64>>(), thin.weights);
            assert_eq!(thin.weights.len(), 1250 + 1250);
        });
        // AND a short log stays whole.
        let short = [log(900)];
        assert_eq!(Screen::of(&short).logs[0].len(), 900);
    }
}
