//! The base model fitted by itself, from places that are apart.

use rayon::prelude::*;

use crate::gap::model::{fit::Fit, shape::Owner, shape::Shape};
use crate::gap::search::run::Search;

/// Shares of the travel by which the surface is moved.
const MOVED: [f64; 5] = [0.0, 0.07, -0.07, 0.2, -0.2];
/// Times by which a number of a given effect is changed.
const CHANGED: [f64; 4] = [0.7, 0.9, 1.1, 1.4];
/// Steps of a fit from such a place.
const BRIEF: usize = 8;
/// Most times that all numbers are changed.
const MOST_TURNS: usize = 3;
/// Another place is gone to if the fit from there leaves less than this share.
const BETTER: f64 = 0.98;

impl Search<'_> {
    /// Fits the base model with nothing added, from several places of the surface.
    pub(crate) fn base_fit(&self) -> Fit {
        let scales = self.dataset.scales;
        let shape = Shape::new(self.base, self.given.to_vec(), scales);
        let start = shape.start();
        let parameters = self.base.parameters();
        let surface = parameters.iter().position(|own| own.name == "surface");
        let is_surface = |owner: Owner| surface.is_some_and(|at| owner == Owner::Environment(at));
        let moved = |share: f64| {
            let mut start = start.clone();
            for (number, free) in start.iter_mut().zip(&shape.free) {
                if is_surface(free.owner) {
                    *number = (*number + share * scales.travel_m).clamp(free.lowest, free.highest);
                }
            }
            start
        };
        let best = self.best_of_brief(&shape, MOVED.map(moved).into());
        let numbers = best.map_or(start.clone(), |fit| fit.numbers);
        self.problem().fit(&shape, numbers)
    }

    /// The base from which no changed number of a given effect leads further. Where a bond breaks or a curve snaps, what
    /// is left has edges that no gradient sees across: with a cogging put into a cantilever's record the owner's model
    /// got stuck at 16.4 nN, and the cogging was not named; from 15.5 nN it is.
    pub(crate) fn unstuck(&self, base: Fit) -> Fit {
        let mut base = base;
        for _ in 0..MOST_TURNS {
            if !self.is_far(&base) {
                break;
            }
            let best = self.best_of_brief(&base.shape, changed(&base));
            match best.filter(|best| best.cost < BETTER * base.cost) {
                Some(best) => base = self.refitted(&best),
                None => break,
            }
        }
        base
    }

    /// The best of brief fits from these places; of equal ones the first.
    fn best_of_brief(&self, shape: &Shape, starts: Vec<Vec<f64>>) -> Option<Fit> {
        let brief = |start| self.problem().fit_briefly(shape, start, BRIEF);
        let fits: Vec<Fit> = starts.into_par_iter().map(brief).collect();
        fits.into_iter().min_by(|a, b| a.cost.total_cmp(&b.cost))
    }
}

/// The numbers of a fit, each time with one of a given effect's changed.
fn changed(fit: &Fit) -> Vec<Vec<f64>> {
    let free = fit.shape.free.iter().enumerate();
    let given = free.filter(|(_, free)| match free.owner {
        Owner::Effect(term, _) => fit.shape.terms[term].given,
        Owner::Environment(_) => false,
    });
    let each = given.flat_map(|(at, free)| {
        CHANGED.map(|times| {
            let mut numbers = fit.numbers.clone();
            let own = match free.logarithmic {
                true => numbers[at] + f64::ln(times),
                false => numbers[at] * times,
            };
            numbers[at] = own.clamp(free.lowest, free.highest);
            numbers
        })
    });
    each.collect()
}
