//! One forward step: a fit with each effect that promises anything added to it.

use estimator_core::physics::effect::EffectId;
use rayon::prelude::*;

use crate::gap::model::fit::{Fit, MOST_STEPS};
use crate::gap::model::shape::{Shape, Term};
use crate::gap::model::start::{starts, starts_from_file};
use crate::gap::search::physical::is_physical;
use crate::gap::search::proposals::{LinearizedModel, Proposal, ranked};
use crate::gap::search::relatives::is_lateness;
use crate::gap::search::run::Search;
use crate::gap::search::sets::{added_effects, is_last_repeated, keep_kinds, truncate};

/// Effects that are refitted jointly in a forward step.
const REFITTED: usize = 8;
/// Fits that are followed further, and those of them that are followed to their minimum.
const FOLLOWED: [usize; 2] = [6, 3];
/// Effects whose fits also start from the values of the model file: a base that ran away alone drags a joint
/// fit with it.
const FROM_FILE: usize = 4;
/// Steps of a joint refit before it has to be among the best, and before it has to be again.
const FIRST_STEPS: [usize; 2] = [4, 8];

/// Share of each mode of a spectrum where its fit starts: two fifths stay behind three of them.
const SPECTRUM_SHARE: f64 = 0.2;
/// Where the modes of a spectrum stand on the scale from the slowest that a log shows to the fastest.
const SPECTRUM: [f64; 3] = [1.0 / 6.0, 0.5, 5.0 / 6.0];

/// A shape, where its fit starts, and how many steps it has.
type Start = (Shape, Vec<f64>, usize);

impl Search<'_> {
    /// The best fit with each effect that promises anything added to `from`, the best first.
    pub(crate) fn expanded(&self, from: &Fit) -> Vec<Fit> {
        let starts = self.starts(from).into_par_iter();
        let begun: Vec<Fit> = self.screen.see(self.problem(), |screen| {
            let fits = starts.map(|(shape, start, steps)| screen.fit_briefly(&shape, start, steps));
            fits.collect()
        });
        let mut fits = best_of_each_set(begun);
        fits.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        keep_kinds(&mut fits, FOLLOWED[0], is_last_repeated);
        let mut fits = self.continued(fits, FIRST_STEPS[1]);
        // What means nothing yet may still come to, and takes no place of what does.
        fits.sort_by_key(|fit| !is_physical(fit, self.dataset.scales));
        keep_kinds(&mut fits, FOLLOWED[1], is_last_repeated);
        let mut done = self.continued(fits, MOST_STEPS);
        done.retain(|fit| is_physical(fit, self.dataset.scales));
        done
    }

    /// Continues fits for some steps, and sorts them with the best first.
    fn continued(&self, fits: Vec<Fit>, steps: usize) -> Vec<Fit> {
        let mut fits: Vec<Fit> = fits
            .into_par_iter()
            .map(|fit| self.problem().fit_briefly(&fit.shape, fit.numbers, steps))
            .collect();
        fits.sort_by(|a, b| self.score(a).total_cmp(&self.score(b)));
        fits
    }

    /// Where joint refits with one effect more start: from the fit, and from the values of the model file.
    fn starts(&self, from: &Fit) -> Vec<Start> {
        let mut starts = Vec::new();
        for (rank, proposals) in self.proposals(from, REFITTED).iter().enumerate() {
            for proposal in proposals {
                let (shape, start) = self.with_term(from, &proposal.term);
                let from_file = shape.start();
                if rank < FROM_FILE && from_file != start {
                    starts.push((shape.clone(), from_file, FIRST_STEPS[0]));
                }
                starts.push((shape, start, FIRST_STEPS[0]));
            }
        }
        starts.extend(self.starts_from_file(from));
        starts.extend(self.spectrum(from));
        // A base that ran away hides what is missing from its own linearization.
        if self.is_far(from) {
            let from_file = self.with_file_values(from);
            for proposals in self.proposals(&from_file, FROM_FILE) {
                let (shape, start) = self.with_term(&from_file, &proposals[0].term);
                starts.push((shape, start, FIRST_STEPS[0]));
            }
        }
        starts
    }

    /// Starts with the values of the model file, of effects that the fitted law imitates so well that its
    /// residuals show nothing of them. The way from the file is longer and has more steps.
    fn starts_from_file(&self, from: &Fit) -> impl Iterator<Item = Start> {
        let scales = self.dataset.scales;
        let terms = (self.ids.iter()).flat_map(|id| starts_from_file(*id, &from.shape, scales));
        terms.map(|term| {
            let (shape, _) = self.with_term(from, &term);
            let from_file = shape.start();
            (shape, from_file, FIRST_STEPS.iter().sum())
        })
    }

    /// A start with relaxation over all times that the log shows, far from the noise. One mode takes little off a
    /// material that relaxes by a power of time: a cantilever's press into cells gave the first place to hysteresis, and
    /// what was found hung on how the record was cut.
    fn spectrum(&self, from: &Fit) -> Option<Start> {
        let id = EffectId::StressRelaxation;
        let is_new = !from.shape.terms.iter().any(|term| term.id == id);
        if !is_new || !self.is_far(from) || !self.ids.contains(&id) {
            return None;
        }
        let alone = starts(id, &from.shape, self.dataset.scales);
        let (slowest, fastest) = (alone.first()?, alone.last()?.row[1]);
        let mut terms = from.shape.terms_at(&from.numbers);
        terms.extend(SPECTRUM.map(|place| {
            let mut mode = slowest.clone();
            let rate = slowest.row[1] * (fastest / slowest.row[1]).powf(place);
            mode.row[..2].copy_from_slice(&[SPECTRUM_SHARE, rate]);
            mode
        }));
        let (shape, start) = from.with_terms(terms, self.dataset.scales);
        Some((shape, start, FIRST_STEPS.iter().sum()))
    }

    /// The effects that promise most beside a fit, with their best starts.
    fn proposals(&self, from: &Fit, most: usize) -> Vec<Vec<Proposal>> {
        let wrong_sign = self.decide().wrong_sign;
        let scales = self.dataset.scales;
        // What is faster than a screen shows: waves, and a lag of a millisecond where samples are 10 ms apart.
        let (fast, slow): (Vec<_>, Vec<_>) = self.ids.iter().partition(|id| is_lateness(**id));
        let mut each = self.screen.see(self.problem(), |screen| {
            let mut each = LinearizedModel::new(screen, from, scales).of_sizes(&slow, wrong_sign);
            let left_out = self.weights.len() as f64 / screen.weights.len() as f64;
            each.iter_mut().for_each(|own| own.gain *= left_out);
            each
        });
        let whole = LinearizedModel::new(self.problem(), from, scales);
        each.extend(whole.of_sizes(&fast, wrong_sign));
        each.extend(whole.of_waves(&slow, wrong_sign));
        let mut proposals = ranked(each);
        let least = self.decide().least_promise * (from.cost - self.noise_cost).max(0.0);
        proposals.retain(|starts| starts[0].gain > least);
        // One more mode of a spectrum needs the others to make room. Neither a first order nor a few
        // steps show what it is worth, so that it always gets its refit.
        let has = |id: EffectId| from.shape.terms.iter().any(|term| term.id == id);
        truncate(&mut proposals, most, |starts| has(starts[0].term.id));
        proposals
    }

    fn with_term(&self, from: &Fit, term: &Term) -> (Shape, Vec<f64>) {
        let mut terms = from.shape.terms_at(&from.numbers);
        terms.push(term.clone());
        from.with_terms(terms, self.dataset.scales)
    }

    /// The effects of a fit on the law with the values of the model file.
    fn with_file_values(&self, fit: &Fit) -> Fit {
        let mut numbers = fit.numbers.clone();
        let law = fit.shape.environment_count();
        numbers[..law].copy_from_slice(&fit.shape.start()[..law]);
        Fit {
            cost: self.problem().cost(&fit.shape, &numbers),
            shape: fit.shape.clone(),
            numbers,
        }
    }
}

/// The fit with the lowest cost for each set of effects.
fn best_of_each_set(all: Vec<Fit>) -> Vec<Fit> {
    let mut best: Vec<Fit> = Vec::new();
    for fit in all {
        let ids = added_effects(&fit);
        match best.iter_mut().find(|other| added_effects(other) == ids) {
            Some(other) if other.cost <= fit.cost => {}
            Some(other) => *other = fit,
            None => best.push(fit),
        }
    }
    best
}
