//! A friction that sticks before it slides may fall with the speed.

use estimator_core::physics::effect::EffectId;
use estimator_core::physics::fit_range::Scale;

use crate::gap::model::fit::Fit;
use crate::gap::model::shape::Term;
use crate::gap::model::start::whole;
use crate::gap::search::physical::is_physical;
use crate::gap::search::run::{Search, SearchResult};

/// What it starts with: shares of the level force, and of the speed of the log. Starts at 0.03, 0.2 and 0.3 of the speed went
/// to the same fit on 12 rigs of 14.
const KINETIC: f64 = 0.9;
const STATIC: f64 = 1.5;
const SPEED: f64 = 0.1;

/// The largest static force over the kinetic one. Bristles that fell by a fifth were followed by 33 times as much within
/// 0.14 mm/s, which is no friction but a spring near rest; those that are in the literature fall by half.
const MOST: f64 = 5.0;

impl Search<'_> {
    /// A result with Stribeck's friction in the place of a Coulomb friction that was added and first bends, where the
    /// difference is significant; where it is not, that stays a rival. Six of six frictions of bristles that fall with the
    /// speed were Coulomb's, `certain`; with a decline the squares are 5 to 34 % fewer.
    pub(super) fn with_decline(&self, mut result: SearchResult, base_cost: f64) -> SearchResult {
        let Some(fit) = self.declining(&result.best) else {
            return result;
        };
        let id = EffectId::StribeckFriction;
        let threshold = self.effect_threshold(id, result.best.cost, &fit, base_cost);
        let other = match result.best.cost - fit.cost > threshold {
            true => std::mem::replace(&mut result.best, fit),
            false => fit,
        };
        result.rivals.push(other);
        result
    }

    /// The best fit with such a friction. It starts from what was found: from the sizes of the log a friction of five
    /// numbers follows a foam that relaxes.
    fn declining(&self, best: &Fit) -> Option<Fit> {
        let mut terms = best.shape.terms_at(&best.numbers);
        let bends =
            |term: &Term| !term.given && term.id == EffectId::CoulombFriction && term.row[1] > 0.0;
        let at = terms.iter().position(bends)?;
        if !self.ids.contains(&EffectId::StribeckFriction) {
            return None;
        }
        let scales = self.dataset.scales;
        let [force_n, width_m, ..] = terms[at].row;
        let [kinetic_n, static_n] = [KINETIC, STATIC].map(|share| share * force_n);
        // The stiffness with which it sticks, force over width, is the same.
        let start = [
            kinetic_n,
            static_n,
            SPEED * scales.size(Scale::Speed),
            0.0,
            STATIC * width_m,
        ];
        terms[at] = whole(EffectId::StribeckFriction, start, 3);
        terms[at].free[4] = true;
        let (shape, numbers) = best.with_terms(terms, scales);
        let fit = self.problem().fit(&shape, numbers);
        let [kinetic_n, static_n, ..] = fit.shape.terms_at(&fit.numbers)[at].row;
        (is_physical(&fit, scales) && static_n <= MOST * kinetic_n).then_some(fit)
    }
}
