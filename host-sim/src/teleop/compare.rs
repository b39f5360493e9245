//! All schemes side by side: environments × schemes × round trips × jitters × losses, some seeds each.

use std::sync::atomic::{AtomicUsize, Ordering};

use estimator_core::board::reflection::Limit;
use rayon::prelude::*;

use super::environment::Environment;
use super::measure::felt::NotCompared;
use super::measure::stability::Rest;
use super::measure::{Measures, run};
use super::options::{Options, SchemeId};
use crate::stats::{highest, median};

/// What is compared.
#[derive(Clone, Debug)]
pub struct Grid {
    /// What all runs share.
    pub base: Options,
    /// What is touched.
    pub environments: Vec<Environment>,
    /// The schemes.
    pub schemes: Vec<SchemeId>,
    /// Round trips (s).
    pub round_trips_s: Vec<f64>,
    /// Shares of the delay.
    pub jitters: Vec<f64>,
    /// Shares of the messages.
    pub losses: Vec<f64>,
    /// Seeds, from 1 on.
    pub seeds: u64,
}

impl Grid {
    /// The table: four environments, eight schemes, eight round trips up to 5 s, with and without jitter,
    /// three losses.
    pub fn table(base: Options, seeds: u64) -> Grid {
        Grid {
            base,
            environments: Environment::compared(),
            schemes: SchemeId::ALL.to_vec(),
            round_trips_s: vec![0.0, 0.01, 0.03, 0.1, 0.3, 1.0, 2.0, 5.0],
            jitters: vec![0.0, 0.3],
            losses: vec![0.0, 0.05, 0.2],
            seeds,
        }
    }

    /// All schemes on the material and the operator of one run, without and with losses: the map of its
    /// report.
    pub fn around(options: &Options) -> Grid {
        Grid {
            base: options.clone(),
            environments: vec![options.environment.clone()],
            schemes: SchemeId::ALL.to_vec(),
            round_trips_s: vec![0.0, 0.03, 0.1, 0.3, 1.0],
            jitters: vec![0.0],
            losses: vec![0.0, 0.2],
            seeds: 1,
        }
    }

    /// The cells, without their measures.
    fn cells(&self) -> Vec<(&Environment, SchemeId, f64, f64, f64)> {
        let mut cells = Vec::new();
        for environment in &self.environments {
            for scheme in &self.schemes {
                for round_trip_s in &self.round_trips_s {
                    for jitter in &self.jitters {
                        for loss in &self.losses {
                            cells.push((environment, *scheme, *round_trip_s, *jitter, *loss));
                        }
                    }
                }
            }
        }
        cells
    }
}

/// A limit of the renderer that is at work in a smaller share of the contact moves the felt force by less than what
/// people feel. Not measured.
const LIMITED: f64 = 0.05;

/// One cell of the comparison.
#[derive(Clone, Debug)]
pub struct Cell {
    /// The name of the first material.
    pub environment: String,
    /// The scheme.
    pub scheme: SchemeId,
    /// The round trip (s).
    pub round_trip_s: f64,
    /// Its jitter, as a share.
    pub jitter: f64,
    /// The share of lost messages.
    pub loss: f64,
    /// The runs, a seed each.
    pub runs: Vec<Measures>,
}

impl Cell {
    /// The median of a measure over the runs that have it; `None` if most have none.
    pub fn median(&self, of: impl Fn(&Measures) -> Option<f64>) -> Option<f64> {
        let values: Vec<f64> = self.runs.iter().filter_map(of).collect();
        (2 * values.len() > self.runs.len()).then(|| median(values))
    }

    /// Whether a limit of the renderer kept the impedance from what it is in more than a twentieth of the contact, in
    /// the median over the runs. That another impedance comes in is none.
    pub fn is_limited(&self) -> bool {
        let most = |run: &Measures| {
            let limits = run
                .limits
                .iter()
                .filter(|(name, _)| *name != Limit::Blending.name());
            highest(limits.map(|(_, share)| *share))
        };
        self.median(|run| Some(most(run)))
            .is_some_and(|share| share > LIMITED)
    }

    /// Whether every run came to rest, on each material.
    pub fn rest(&self) -> Rest {
        let each = self.runs.iter().map(Measures::rests);
        each.reduce(Rest::and).unwrap_or_default()
    }

    /// Whether every run is known to have come to rest.
    pub fn is_stable(&self) -> bool {
        self.rest() == Rest::Rests
    }

    /// How old what is applied at the end of a way is, in the median (s): 0 to the slave, 1 to the master.
    pub fn age_s(&self, way: usize) -> Option<f64> {
        self.median(|run| run.ages_s[way])
    }

    /// Why there is no felt force to compare in most runs.
    pub fn not_compared(&self) -> Option<NotCompared> {
        let share = self.median(|run| run.felt_force_rmse_share);
        let mut why = self
            .runs
            .iter()
            .filter_map(|run| run.felt_force_not_compared);
        why.next().filter(|_| share.is_none())
    }
}

/// Runs a grid on all cores; `progress` hears how many runs of how many are done.
pub fn compare(grid: &Grid, progress: &(dyn Fn(usize, usize) + Sync)) -> Vec<Cell> {
    let cells = grid.cells();
    let total = cells.len() * grid.seeds as usize;
    let done = AtomicUsize::new(0);
    cells
        .par_iter()
        .map(|(environment, scheme, round_trip_s, jitter, loss)| {
            let options = Options {
                environment: (*environment).clone(),
                ..grid.base.clone()
            };
            let options = options
                .with_scheme(*scheme)
                .with_channel(0.5 * round_trip_s, *jitter, *loss)
                .with_task_for_delay();
            let runs = (1..=grid.seeds).map(|seed| {
                let (_, measures) = run(&options, seed);
                progress(done.fetch_add(1, Ordering::Relaxed) + 1, total);
                measures
            });
            Cell {
                environment: environment.first.name.clone(),
                scheme: *scheme,
                round_trip_s: *round_trip_s,
                jitter: *jitter,
                loss: *loss,
                runs: runs.collect(),
            }
        })
        .collect()
}
