//! A cell of the table: one fault at one severity, over materials, motions and seeds.

use super::judge::{Look, Verdict, judge};
use super::run::Flag;
use crate::faults::rig::case::Case;
use crate::faults::rig::fault::Fault;
use crate::quantile::quantile;
use estimator_core::Status;
use rayon::prelude::*;

/// So many logs of a hundred may be wrong.
pub const BAR: f64 = 0.02;

/// One cell.
pub struct Cell {
    /// The fault.
    pub fault: &'static Fault,
    /// 0, 1 or 2.
    pub severity: usize,
    /// Its logs.
    pub verdicts: Vec<Verdict>,
}

impl Cell {
    /// Runs a cell of so many logs; `done` is told of every one.
    pub fn run(
        fault: &'static Fault,
        severity: usize,
        seed: u64,
        logs: u64,
        look: Look,
        done: impl Fn() + Sync,
    ) -> Cell {
        let one = |index: u64| {
            let verdict = judge(&Case::new(fault, severity, seed, index), look);
            done();
            verdict
        };
        Cell {
            fault,
            severity,
            verdicts: (0..logs).into_par_iter().map(one).collect(),
        }
    }

    /// Number of logs for which this holds.
    pub fn count(&self, holds: impl Fn(&Verdict) -> bool) -> usize {
        self.verdicts.iter().filter(|v| holds(v)).count()
    }

    /// Logs that count.
    pub fn seeable(&self) -> usize {
        self.count(|v| v.unseeable.is_none())
    }

    /// Logs that count and are wrong.
    pub fn wrong(&self) -> usize {
        self.count(Verdict::wrong_and_seeable)
    }

    /// Whether more logs are wrong than the bar allows.
    pub fn over_the_bar(&self) -> bool {
        self.wrong() as f64 > BAR * self.seeable() as f64
    }

    /// The longest time of being wrong, of the logs that count (s).
    pub fn longest_s(&self) -> f64 {
        let counted = self.verdicts.iter().filter(|v| v.unseeable.is_none());
        counted.map(|v| v.wrong_s).fold(0.0, f64::max)
    }

    /// Logs whose first remark is this, and the median time until it (s).
    pub fn flagged(&self, kind: Flag) -> (usize, f64) {
        let times = self.verdicts.iter().filter_map(|v| v.flag);
        let times: Vec<f64> = times.filter(|f| f.0 == kind).map(|f| f.1).collect();
        (times.len(), quantile(&times, 0.5))
    }

    /// Logs that had to recover, those that did so in time, and the median (s).
    pub fn recovery(&self) -> (usize, usize, f64) {
        let times: Vec<f64> = self.verdicts.iter().filter_map(|v| v.recovered_s).collect();
        let timely = self.count(Verdict::recovered_in_time);
        (times.len(), timely, quantile(&times, 0.5))
    }

    /// Logs that had to learn another material, those that did so in time, and those of an efficient estimator.
    pub fn relearned(&self) -> (usize, usize, f64) {
        let asked = self.verdicts.iter().filter(|v| v.efficient.is_some());
        let timely = asked.clone().filter(|v| v.recovered_in_time());
        let efficient = asked.clone().filter_map(|v| v.efficient).sum();
        (asked.count(), timely.count(), efficient)
    }

    /// Logs that end in this status.
    pub fn ends(&self, status: Status) -> usize {
        self.count(|v| v.status == Some(status))
    }

    /// Changes of material that were reported, and the hours of the logs.
    pub fn changes(&self) -> (usize, f64) {
        let seconds: f64 = self.verdicts.iter().map(|v| v.seconds).sum();
        let changes = self.verdicts.iter().map(|v| v.changes).sum();
        (changes, seconds / 3600.0)
    }
}
