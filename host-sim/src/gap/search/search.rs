//! Which effects are there: forward steps from a beam of fits, swaps, and backward elimination, every
//! one a joint refit of law and effects.

use estimator_core::physics::effect::EffectId;
use rayon::prelude::*;

use crate::gap::data::fit_data::Course;
use crate::gap::data::low_pass::LowPass;
use crate::gap::data::scales::Scales;
use crate::gap::finding::Tried;
use crate::gap::model::fit::{Fit, MOST_STEPS, Problem};
use crate::gap::model::shape::{Shape, Term};
use crate::gap::model::start::{repeats, starts as starts_of};
use crate::gap::model::weights::{variances, weights};
use crate::gap::noise::floor::Floor;
use crate::gap::progress::Progress;
use crate::gap::search::proposals::{Ground, Proposal};
use crate::model;

/// Candidates that are refitted jointly in a forward step.
const REFITTED: usize = 8;
/// Fits that are followed further, and those of them that are followed to their minimum.
const FOLLOWED: [usize; 2] = [5, 3];
/// Candidates that also start from the model file's values: a base that ran away alone drags a joint
/// fit with it.
const FROM_FILE: usize = 4;
const EXPONENTIAL: EffectId = EffectId::ExponentialStiffening;
/// A fit with so many times the floor's Σ w r² may have run away.
const RAN_AWAY: f64 = 4.0;
/// Fits that the next step goes on from.
const BEAM: usize = 3;
/// They leave at most so many times the excess of the best, if that is small.
const BEHIND: f64 = 4.0;
/// Most effects that are added.
const MOST_ADDED: usize = 5;
/// Steps of a joint refit before it has to be among the best, and before it has to be again.
const FIRST_STEPS: [usize; 2] = [4, 8];

/// Share of the base's excess that is left after two effects, and after three, when nothing is named: true
/// sets of three leave 4 % at most, what no catalogue has 5 to 50 %, and three of the five effects of cells
/// under a cantilever 17 %.
const HOPELESS: [f64; 2] = [0.5, 0.25];

/// A search over the catalogue on one resolution of the logs.
pub(in crate::gap) struct Search<'a> {
    pub(in crate::gap) courses: &'a [Course],
    pub(in crate::gap) floors: &'a [Floor],
    pub(in crate::gap) low_pass: Option<LowPass>,
    /// 1/N² per sample, of the best fit so far.
    pub(in crate::gap) weights: Vec<f64>,
    pub(in crate::gap) base: &'a model::Environment,
    pub(in crate::gap) given: &'a [Term],
    pub(in crate::gap) scales: &'a Scales,
    pub(in crate::gap) ids: &'a [EffectId],
    /// Who is told how far it is.
    pub(in crate::gap) progress: &'a dyn Progress,
    /// Σ w r² of nothing but noise.
    pub(in crate::gap) floor: f64,
    /// Blocks per independent residual.
    pub(in crate::gap) correlation: f64,
    /// Fits of the forward steps, for the report.
    pub(in crate::gap) tried: Vec<Fit>,
}

/// What came of it.
pub(in crate::gap) struct Found {
    pub(in crate::gap) best: Fit,
    /// For every effect that was added, the best fits with another one in its place.
    pub(in crate::gap) rivals: Vec<Vec<Fit>>,
}

/// The effects that a fit adds to the base model, in order.
pub(in crate::gap) fn added(fit: &Fit) -> Vec<EffectId> {
    let own = fit.added().into_iter();
    let mut ids: Vec<EffectId> = own.map(|at| fit.shape.terms[at].id).collect();
    ids.sort();
    ids
}

/// Whether its numbers mean what their names say.
fn is_physical(fit: &Fit) -> bool {
    let terms = fit.shape.terms_at(&fit.numbers);
    let is_physical = |term: &Term| (term.id.info().is_physical)(&term.row);
    terms.iter().all(|term| term.given || is_physical(term))
}

/// Whether its last effect stands in it twice.
fn is_one_more(fit: &Fit) -> bool {
    let terms = &fit.shape.terms;
    let last = terms.last().map(|term| term.id);
    terms.iter().filter(|term| Some(term.id) == last).count() > 1
}

/// Whether it has three waves of a kind and none that is three times the others: a Fourier series of
/// something that is no wave. A line may have a harmonic, or sidebands of a modulation.
fn is_series(fit: &Fit) -> bool {
    let terms = fit.shape.terms_at(&fit.numbers);
    let waves = terms.iter().filter(|own| !own.given && repeats(own.id));
    waves.clone().any(|wave| {
        let each = waves.clone().filter(|own| own.id == wave.id);
        let mut sizes: Vec<f64> = each.map(|own| own.row[0].abs()).collect();
        sizes.sort_by(|a, b| b.total_cmp(a));
        sizes.len() > 2 && sizes[0] < 3.0 * sizes[1]
    })
}

/// Of each set of effects the first.
fn keep_first<T>(list: &mut Vec<T>, ids: impl Fn(&T) -> Vec<EffectId>) {
    let mut seen: Vec<Vec<EffectId>> = Vec::new();
    list.retain(|own| {
        let ids = ids(own);
        let new = !seen.contains(&ids);
        seen.push(ids);
        new
    });
}

/// The first so many, and whatever else is to stay.
fn truncate<T>(list: &mut Vec<T>, most: usize, stays: impl Fn(&T) -> bool) {
    let mut rank = 0;
    list.retain(|own| {
        rank += 1;
        rank <= most || stays(own)
    });
}

impl Search<'_> {
    pub(in crate::gap) fn problem(&self) -> Problem<'_> {
        Problem {
            courses: self.courses,
            weights: &self.weights,
            low_pass: self.low_pass,
        }
    }

    /// Weights for what `fit` says the residuals may be; fits to old weights are to be costed again.
    pub(in crate::gap) fn weigh(&mut self, fit: &Fit) {
        self.weights = weights(&variances(fit, self.courses, self.floors, self.low_pass));
        self.floor = self.weights.iter().filter(|w| **w > 0.0).count() as f64;
    }

    /// The same shape at its minimum under the present weights.
    pub(in crate::gap) fn refitted(&self, fit: &Fit) -> Fit {
        self.problem().fit(&fit.shape, fit.numbers.clone())
    }

    /// The sets that came closest, for the report.
    pub(in crate::gap) fn ladder(&self, base: &Fit, found: &Found) -> Vec<Tried> {
        let all: Vec<&Fit> = [base, &found.best]
            .into_iter()
            .chain(found.rivals.iter().flatten())
            .chain(&self.tried)
            .collect();
        let mut ladder: Vec<Tried> = all
            .into_par_iter()
            .map(|fit| Tried {
                ids: added(fit),
                ratio: (self.costed(fit).cost / self.floor).sqrt(),
            })
            .collect();
        ladder.sort_by(|a, b| a.ratio.total_cmp(&b.ratio));
        keep_first(&mut ladder, |own| own.ids.clone());
        ladder
    }

    fn costed(&self, fit: &Fit) -> Fit {
        Fit {
            cost: self.problem().cost(&fit.shape, &fit.numbers),
            ..fit.clone()
        }
    }

    /// The base law with nothing added, from several places of the surface.
    pub(in crate::gap) fn base_fit(&self) -> Fit {
        let shape = Shape::new(self.base, self.given.to_vec(), self.scales);
        let start = shape.start();
        let surface = self
            .base
            .parameters()
            .iter()
            .position(|own| own.name == "surface");
        let moved = |share: f64| {
            let mut start = start.clone();
            for (number, free) in start.iter_mut().zip(&shape.free) {
                if surface.is_some_and(|at| {
                    free.owner == crate::gap::model::shape::Owner::Environment(at)
                }) {
                    *number =
                        (*number + share * self.scales.travel_m).clamp(free.lowest, free.highest);
                }
            }
            start
        };
        let shares = [0.0, 0.07, -0.07, 0.2, -0.2];
        let fits = shares
            .par_iter()
            .map(|share| self.problem().walk(&shape, moved(*share), 8))
            .collect::<Vec<_>>();
        let best = fits.into_iter().min_by(|a, b| a.cost.total_cmp(&b.cost));
        let numbers = best.map_or(start.clone(), |fit| fit.numbers);
        self.problem().fit(&shape, numbers)
    }

    /// Cost with a price on free numbers: BIC in units of independent residuals.
    pub(in crate::gap) fn score(&self, fit: &Fit) -> f64 {
        // The floor of Σ w r² is the number of samples that count.
        let independent = (self.floor / self.correlation).max(2.0);
        fit.cost / self.correlation + fit.numbers.len() as f64 * independent.ln()
    }

    pub(in crate::gap) fn is_adequate(&self, fit: &Fit) -> bool {
        fit.cost <= 1.02 * self.floor
    }

    /// The best fit with each effect that promises anything added to `from`, best first.
    pub(in crate::gap) fn expanded(&self, from: &Fit) -> Vec<Fit> {
        let walked: Vec<Fit> = self
            .starts(from)
            .into_par_iter()
            .map(|(shape, start, steps)| self.problem().walk(&shape, start, steps))
            .collect();
        // The best start of each effect goes on, if it has a chance.
        let mut fits: Vec<Fit> = Vec::new();
        for fit in walked {
            let id = added(&fit);
            match fits.iter_mut().find(|own| added(own) == id) {
                Some(own) if own.cost <= fit.cost => {}
                Some(own) => *own = fit,
                None => fits.push(fit),
            }
        }
        fits.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        truncate(&mut fits, FOLLOWED[0], is_one_more);
        let mut fits = self.walked(fits, FIRST_STEPS[1]);
        truncate(&mut fits, FOLLOWED[1], is_one_more);
        let mut done = self.walked(fits, MOST_STEPS);
        done.retain(is_physical);
        done
    }

    /// Fits some steps further, the best first.
    fn walked(&self, fits: Vec<Fit>, steps: usize) -> Vec<Fit> {
        let mut fits: Vec<Fit> = fits
            .into_par_iter()
            .map(|fit| self.problem().walk(&fit.shape, fit.numbers, steps))
            .collect();
        fits.sort_by(|a, b| self.score(a).total_cmp(&self.score(b)));
        fits
    }

    /// Where joint refits with one effect more start, and the steps that they have: from the fit, and from
    /// the model file's values.
    fn starts(&self, from: &Fit) -> Vec<(Shape, Vec<f64>, usize)> {
        let mut starts = Vec::new();
        for (rank, own) in self.proposals(from, REFITTED).iter().enumerate() {
            for proposal in own {
                let (shape, start) = self.with(from, &proposal.term);
                let filed = shape.start();
                if rank < FROM_FILE && filed != start {
                    starts.push((shape.clone(), filed, FIRST_STEPS[0]));
                }
                starts.push((shape, start, FIRST_STEPS[0]));
            }
        }
        // A power of the depth imitates an exponential, and what it leaves shows nothing of one: an
        // exponent of 4.4 for 1.5 and e^{1.2}. The way from the file is longer.
        if self.ids.contains(&EXPONENTIAL)
            && let Some(term) = starts_of(EXPONENTIAL, &from.shape, self.scales).get(1)
        {
            let (shape, _) = self.with(from, term);
            let filed = shape.start();
            starts.push((shape, filed, FIRST_STEPS.iter().sum()));
        }
        // A base that ran away hides what is missing from its own linearisation.
        if from.cost > RAN_AWAY * self.floor {
            let filed = self.filed(from);
            for own in self.proposals(&filed, FROM_FILE) {
                let (shape, start) = self.with(&filed, &own[0].term);
                starts.push((shape, start, FIRST_STEPS[0]));
            }
        }
        starts
    }

    /// What promises most beside a fit.
    fn proposals(&self, from: &Fit, most: usize) -> Vec<Vec<Proposal>> {
        let mut proposals = Ground::new(self.problem(), from, self.scales).proposals(self.ids);
        let least = 1e-3 * (from.cost - self.floor).max(0.0);
        proposals.retain(|own| own[0].gain > least);
        // One more mode needs the others to make room: neither a first order nor a few steps show what
        // it is worth, and it always gets its refit.
        let has = |id: EffectId| from.shape.terms.iter().any(|term| term.id == id);
        truncate(&mut proposals, most, |own| has(own[0].term.id));
        proposals
    }

    /// The fit with one effect more.
    fn with(&self, from: &Fit, term: &Term) -> (Shape, Vec<f64>) {
        let mut terms = from.shape.terms_at(&from.numbers);
        terms.push(term.clone());
        from.with_terms(terms, self.scales)
    }

    /// The fit's effects on the model file's law.
    fn filed(&self, fit: &Fit) -> Fit {
        let mut numbers = fit.numbers.clone();
        let law = fit.shape.environment_count();
        numbers[..law].copy_from_slice(&fit.shape.start()[..law]);
        Fit {
            cost: self.problem().cost(&fit.shape, &numbers),
            shape: fit.shape.clone(),
            numbers,
        }
    }

    /// Finds what is there.
    pub(in crate::gap) fn run(&mut self, base: Fit) -> Found {
        let mut base_cost = base.cost;
        let mut best = base.clone();
        let nothing = Found {
            best: base.clone(),
            rivals: Vec::new(),
        };
        let mut beam = vec![base.clone()];
        let mut level = 0;
        while level < MOST_ADDED && !self.is_adequate(&best) {
            // What explains little in two steps is in no catalogue.
            let excess = (base_cost - self.floor).max(1.0);
            let left = (best.cost - self.floor) / excess;
            if (level >= 2 && left > HOPELESS[usize::from(level > 2)]) || is_series(&best) {
                return nothing;
            }
            // Later steps are longer: five effects, with all that is there, are half of the time.
            let share = 0.1 + 0.5 * level as f64 / MOST_ADDED as f64;
            let what = format!(
                "effect {} of at most {MOST_ADDED}: {} in the catalogue",
                level + 1,
                self.ids.len()
            );
            self.progress.at(share, &what);
            let mut children: Vec<Fit> = beam.iter().flat_map(|fit| self.expanded(fit)).collect();
            children.sort_by(|a, b| self.score(a).total_cmp(&self.score(b)));
            keep_first(&mut children, added);
            self.tried.extend_from_slice(&children);
            let Some(child) = children.first() else { break };
            // As plain as its rivals are.
            let ahead = child.cost - self.floor;
            let last = child.shape.terms.last();
            let accepted = last.is_some_and(|term| self.pays(term.id, &best, child, base_cost));
            if accepted {
                best = child.clone();
                self.weigh(&best);
                best = self.problem().fit(&best.shape, best.numbers);
                base_cost = self.costed(&base).cost;
                best = self.formed(best, base_cost);
                children[0] = best.clone();
            } else if level > 0 {
                break;
            }
            // Near the floor the one that is far ahead is it; far from it none is.
            let least = ahead.max(0.25 * self.floor);
            if least < RAN_AWAY * self.floor {
                children.retain(|fit| fit.cost - self.floor <= BEHIND * least);
            }
            children.truncate(BEAM);
            beam = children.iter().map(|fit| self.costed(fit)).collect();
            level += 1;
        }
        self.progress.at(0.6, "leaving out, swapping");
        best = self.without_idle(best, base_cost);
        best = self.formed_instead(best, base_cost);
        if is_series(&best) {
            return nothing;
        }
        let found = self.swapped(best, base_cost);
        let found = self.simpler(found, base_cost);
        Found {
            best: self.plainer(found.best, base_cost),
            ..found
        }
    }

    /// Leaves out what does not pay.
    fn without_idle(&self, mut best: Fit, base_cost: f64) -> Fit {
        loop {
            let without: Option<(EffectId, Fit)> = best
                .added()
                .into_par_iter()
                .map(|at| (best.shape.terms[at].id, self.without(&best, at)))
                .min_by(|a, b| a.1.cost.total_cmp(&b.1.cost));
            match without {
                Some((id, fit)) if !self.pays(id, &fit, &best, base_cost) => {
                    best = fit;
                }
                _ => return best,
            }
        }
    }

    /// The best fit without a term.
    pub(in crate::gap) fn without(&self, fit: &Fit, at: usize) -> Fit {
        let (shape, start) = fit.without(at, self.scales);
        let filed = shape.start();
        let (a, b) = rayon::join(
            || self.problem().fit(&shape, start),
            || self.problem().fit(&shape, filed),
        );
        if a.cost <= b.cost { a } else { b }
    }

    /// Stribeck's friction becomes Coulomb's where the difference does not pay.
    fn simpler(&self, found: Found, base_cost: f64) -> Found {
        let complex = |term: &Term| term.id == EffectId::StribeckFriction && !term.given;
        let Some(at) = found.best.shape.terms.iter().position(complex) else {
            return found;
        };
        let coulomb = Search {
            ids: &[EffectId::CoulombFriction],
            weights: self.weights.clone(),
            tried: Vec::new(),
            ..*self
        };
        let simple = coulomb.expanded(&self.without(&found.best, at));
        match simple.into_iter().next() {
            Some(fit)
                if fit.cost - found.best.cost
                    < self.price(EffectId::StribeckFriction, fit.cost, &found.best, base_cost) =>
            {
                Found { best: fit, ..found }
            }
            _ => found,
        }
    }

    /// Tries every other effect in the place of each; what is better takes its place.
    fn swapped(&self, best: Fit, base_cost: f64) -> Found {
        let mut best = best;
        for _ in 0..3 {
            let rivals: Vec<Vec<Fit>> = best
                .added()
                .into_iter()
                .map(|at| {
                    let mut fits = self.expanded(&self.without(&best, at));
                    let ids = added(&best);
                    fits.retain(|fit| added(fit) != ids);
                    fits
                })
                .collect();
            let better = rivals
                .iter()
                .flatten()
                .min_by(|a, b| self.score(a).total_cmp(&self.score(b)))
                .filter(|fit| self.score(fit) < self.score(&best) - 6.0);
            match better {
                Some(fit) => best = self.without_idle(fit.clone(), base_cost),
                None => return Found { best, rivals },
            }
        }
        Found {
            best,
            rivals: Vec::new(),
        }
    }
}
