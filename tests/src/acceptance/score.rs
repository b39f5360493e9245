//! How well a method estimates one case, and many.

use estimator_core::estimate::config::{Config, Surface};
use estimator_core::estimate::method::Method;
use estimator_core::estimate::{Estimate, Event};
use estimator_core::{State, step};
use palpate::log::UniformLog;
use palpate::replay::samples;

use super::cases::Case;
use super::floor::Floor;
use crate::quantile::quantile;
use crate::tolerance::{CLOSE, SURE};

/// How well one method estimates one case.
#[derive(Clone, Copy, Debug)]
pub struct Score {
    /// The largest relative error of K, λ, n at the end; infinite if one is not observable.
    pub(crate) worst: f64,
    /// The time (s) from the first touch until K, λ, n stay within 5 % of the truth.
    pub(crate) settles_s: f64,
    /// The error of the surface (m), if the method estimates it.
    pub(crate) surface_m: Option<f64>,
    /// The relative errors of K, λ and n, infinite where one is not observable.
    pub(crate) errors: [f64; 3],
    /// Whether the truth lies in the 95 % intervals of K, λ, n.
    pub(crate) covered: [bool; 3],
    /// The number of false material changes.
    pub(crate) changes: u32,
    /// The Cramér–Rao bound of the case.
    pub(crate) floor: Floor,
}

/// What a method says along a log.
pub(crate) struct Ran {
    /// Its last estimate.
    pub(crate) end: Estimate<f32>,
    /// The last time (s) at which an error was more than 5 %; not before the first touch.
    pub(crate) unsettled_s: f64,
    /// The number of material changes that it flagged.
    pub(crate) changes: u32,
}

/// Runs a method over a log with its first touch at `touched_s`, and tells it the surface if that is given;
/// `worst` is the largest relative error of an estimate.
pub(crate) fn run(
    log: &UniformLog,
    touched_s: f64,
    method: Method,
    surface_m: Option<f64>,
    worst: impl Fn(&Estimate<f32>) -> f64,
) -> Ran {
    let mut config = Config {
        method,
        ..Config::default()
    };
    if let Some(surface_m) = surface_m {
        config.contact.surface = Surface::Known {
            position_m: surface_m as f32,
        };
    }
    let params = config.validate::<f32>().expect("the defaults are valid");
    let mut state = State::new(&params);
    let mut unsettled_s = touched_s;
    let mut changes = 0;
    let mut end = None;
    for (time_s, sample) in log.time_s.iter().zip(samples(log)) {
        let estimate = step(&params, &mut state, sample);
        changes += u32::from(estimate.event == Some(Event::MaterialChange));
        if worst(&estimate) > CLOSE {
            unsettled_s = *time_s;
        }
        end = Some(estimate);
    }
    Ran {
        end: end.expect("the log is not empty"),
        unsettled_s,
        changes,
    }
}

/// Runs a method over a case, and tells it the surface if `known`.
pub fn score(case: &Case, method: Method, known: bool) -> Score {
    let surface_m = known.then_some(case.truth[3]);
    let worst = |estimate: &Estimate<f32>| largest(errors(estimate, &case.truth));
    let Ran {
        end,
        unsettled_s,
        changes,
    } = run(&case.log, case.touched_s, method, surface_m, worst);
    let last_slot = end.law.parameters().len() - 1;
    let surface = end.parameters[last_slot].map(|p| (f64::from(p.value) - case.truth[3]).abs());
    Score {
        worst: worst(&end),
        settles_s: unsettled_s - case.touched_s,
        surface_m: surface,
        covered: std::array::from_fn(|slot| {
            end.parameters[slot].is_some_and(|p| {
                let off = (f64::from(p.value) - case.truth[slot]).abs();
                off < SURE * f64::from(p.std_error)
            })
        }),
        errors: errors(&end, &case.truth),
        changes,
        floor: Floor::of(case, known),
    }
}

/// The largest of several errors.
pub(crate) fn largest(errors: impl IntoIterator<Item = f64>) -> f64 {
    errors.into_iter().fold(0.0, f64::max)
}

/// The relative errors of K, λ, n.
pub(crate) fn errors(estimate: &Estimate<f32>, truth: &[f64; 4]) -> [f64; 3] {
    std::array::from_fn(|slot| {
        let value = estimate.parameters[slot].map(|p| f64::from(p.value));
        value.map_or(f64::INFINITY, |value| (value / truth[slot] - 1.0).abs())
    })
}

/// A row of the table: the scores of one method in one setting.
#[derive(Clone, Debug, Default)]
pub struct Row {
    scores: Vec<Score>,
}

impl Row {
    /// Adds a score.
    pub fn push(&mut self, score: Score) {
        self.scores.push(score);
    }

    /// The share of the runs whose K, λ and n all end within `bound` of the truth.
    pub fn within(&self, bound: f64) -> f64 {
        self.share(|score| score.worst < bound)
    }

    /// The share of the runs that flagged a change where there was none.
    pub fn changed(&self) -> f64 {
        self.share(|score| score.changes > 0)
    }

    fn share(&self, is: impl Fn(&Score) -> bool) -> f64 {
        self.scores.iter().filter(|score| is(score)).count() as f64 / self.scores.len() as f64
    }

    /// The `share`-quantile of the settling times (s).
    pub fn settles_s(&self, share: f64) -> f64 {
        quantile(self.scores.iter().map(|score| score.settles_s), share)
    }

    /// The `share`-quantile of the surface's error (m).
    pub fn surface_m(&self, share: f64) -> f64 {
        quantile(
            self.scores.iter().filter_map(|score| score.surface_m),
            share,
        )
    }

    /// The errors of K, λ, n and the surface over their Cramér–Rao bounds, root mean square.
    pub fn over_floor(&self) -> [f64; 4] {
        std::array::from_fn(|slot| {
            let squares = self.scores.iter().map(|score| {
                let error = match slot {
                    3 => score.surface_m.unwrap_or(f64::NAN),
                    _ => score.errors[slot],
                };
                (error / score.floor.sigma[slot]).powi(2)
            });
            (squares.sum::<f64>() / self.scores.len() as f64).sqrt()
        })
    }

    /// The share of the runs that an estimator at the Cramér–Rao bound would have within `bound`.
    pub fn floor_within(&self, bound: f64) -> f64 {
        let shares = self.scores.iter().map(|score| score.floor.within(bound));
        shares.sum::<f64>() / self.scores.len() as f64
    }

    /// The `share`-quantile of the times (s) before which no estimator can be sure to be within 5 %.
    pub fn floor_settles_s(&self, share: f64) -> f64 {
        quantile(self.scores.iter().map(|score| score.floor.settles_s), share)
    }

    /// The shares of the runs in which the truth lies in the 95 % intervals of K, λ and n.
    pub fn coverage(&self) -> [f64; 3] {
        std::array::from_fn(|slot| self.share(|score| score.covered[slot]))
    }
}
