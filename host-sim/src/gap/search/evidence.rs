//! The evidence for each effect of the best set, against what that set leaves.
//!
//! A measured record keeps a remainder that no catalogue explains, and against the noise floor nothing could
//! ever be named there. Each effect is therefore weighed by itself, over all sets that were fitted: the best
//! set with it against the best set of any size without it and without whatever stands for it. That must
//! leave several times as many squares, in most parts of the log where the effect acts and beside what the
//! remainder predicts of itself; or be so sharp that no remainder moves like it; or act in nearly every part; or
//! stand out by itself ([`super::alone`]).
//! Parts of the log must give the effect the same size ([`super::parts`]). A form that is not the true one fails here even if
//! it takes off more than any other of the catalogue.

use estimator_core::physics::effect::{ChainStage, EffectId};

use crate::gap::finding::{Next, Support};
use crate::gap::model::{fit::Fit, shape::Term, start::repeats, zero_step::ZeroStep};
use crate::gap::search::blocks::Blocks;
use crate::gap::search::parts::Parts;
use crate::gap::search::physical::is_fourier_series;
use crate::gap::search::relatives::{are_alike, stands_for};
use crate::gap::search::remainder::Remainder;
use crate::gap::search::run::{Search, SearchResult};
use crate::gap::search::sets::{added_effects, is_repeated};
use crate::gap::thresholds;

/// What speaks for one effect of the best set.
#[derive(Clone, Debug)]
pub(crate) struct Evidence {
    pub(crate) id: EffectId,
    pub(crate) support: Support,
    /// Effects outside its nested family that leave nearly as little in its place.
    pub(crate) alternatives: Vec<EffectId>,
    /// Whether it is named though something remains.
    pub(crate) is_strong: bool,
    /// Whether it or one of its alternatives is.
    pub(crate) is_strong_group: bool,
    /// Whether it takes a large share off, in most blocks, whatever the remainder predicts of itself.
    pub(crate) is_large: bool,
    /// Whether the best set without it is worse at all, and it is no wave that does not stand for itself.
    pub(crate) is_needed: bool,
    /// Of several waves of this kind the frequencies (Hz) or pitches (m) of those that take little off alone.
    pub(crate) faint_waves: Vec<f64>,
}

impl Evidence {
    /// Whether this is one of several waves, and takes little off alone.
    pub(crate) fn is_faint(&self, term: &Term) -> bool {
        let mut faint = self.faint_waves.iter();
        // A refit moves it by less than it is apart from the next.
        faint.any(|wave| (term.row[1] / wave - 1.0).abs() < 0.01)
    }
}

impl Search<'_> {
    /// The evidence for each effect of the best set.
    pub(crate) fn evidence(&self, base: &Fit, result: &SearchResult) -> Vec<Evidence> {
        let best = &result.best;
        let mut ids = added_effects(best);
        ids.dedup();
        let mut all: Vec<Fit> = [base]
            .into_iter()
            .chain(&result.rivals)
            .chain(&self.tried)
            .map(|fit| self.with_present_cost(fit))
            .collect();
        let plain: Vec<Fit> = ids.iter().map(|id| self.without_kind(best, *id)).collect();
        all.extend_from_slice(&plain);
        let blocks = Blocks::of(&self.dataset, best);
        let alone = self.effect_alone(base, &all, &blocks);
        let weighing = Weighing {
            best,
            all: &all,
            alone,
            parts: Parts::of(&self.dataset, &self.weights, best),
            remainder: Remainder::of(&self.weighted_residuals(best)),
            blocks,
        };
        let each = ids.iter().zip(&plain);
        each.map(|(id, plain)| self.evidence_for(*id, plain, &weighing))
            .collect()
    }

    fn evidence_for(&self, id: EffectId, plain: &Fit, weighing: &Weighing<'_>) -> Evidence {
        let decide = &self.dataset.thresholds.evidence;
        let Weighing {
            best,
            all,
            parts,
            alone,
            ..
        } = weighing;
        let ids = added_effects(best);
        let with = best_with(all, best, id);
        let without = best_without(all, &[id]);
        let gain = self.gain(without, with, weighing);
        let support = Support {
            share: gain.share,
            blocks: gain.blocks,
            next: newcomer(without, &ids, &[id]).map(|id| Next {
                id,
                share: self.share(plain, without),
            }),
        };
        let is_ahead = |fit: &Fit| fit.cost >= decide.lead * with.cost;
        let mut alternatives = alternatives(all, &ids, id, is_ahead);
        if let (Some(list), Some(other)) = (&mut alternatives, as_alike(all, id)) {
            list.extend(Some(other.0).filter(|_| !is_ahead(other.1)));
        }
        // Several waves of about one size fit any curve that wanders, and take little off beside what the
        // remainder predicts of itself; one that is sharp is a wave whatever stands beside it. But a scale that is
        // read has one pitch: two of them are a converter's error, or another curve along the force.
        let is_scale = id.info().stage == ChainStage::PositionReading;
        let is_curve = repeats(id)
            && (is_scale || gain.beside.0 < decide.sharp)
            && is_series(best, id, self.decide());
        let is_no_step = || !self.is_rather_a_step(plain, with);
        let agrees = parts.agree(best, id, decide) && !is_curve && is_no_step();
        let is_sound = agrees && gain.is_sound(id, decide);
        let is_sound_group = alternatives.as_ref().is_some_and(|others| {
            is_sound
                || agrees
                    && !others.is_empty()
                    && others.iter().all(|other| is_as_placed(*other, id))
                    && {
                        let group: Vec<EffectId> = [&[id], others.as_slice()].concat();
                        let without = best_without(all, &group);
                        self.gain(without, with, weighing).is_sound(id, decide)
                    }
        });
        let is_alone = alone.is_some_and(|own| stands_for(own, id)) && (agrees || is_no_step());
        Evidence {
            is_strong: is_alone || is_sound && gain.lead >= decide.lead,
            // A wave fits any remainder, whatever it stands beside.
            is_needed: gain.lead >= decide.needed && (is_sound_group || is_alone || !repeats(id)),
            is_strong_group: is_sound_group || is_alone,
            is_large: agrees && gain.is_large_share(decide) && gain.lead >= decide.lead,
            faint_waves: self.faint_waves(id, weighing),
            alternatives: alternatives.unwrap_or_default(),
            id,
            support,
        }
    }

    /// Of several waves of a kind those without which the best set leaves hardly more.
    fn faint_waves(&self, id: EffectId, weighing: &Weighing<'_>) -> Vec<f64> {
        let best = weighing.best;
        let terms = best.shape.terms_at(&best.numbers);
        let own = |at: &usize| !terms[*at].given && terms[*at].id == id;
        let waves: Vec<usize> = (0..terms.len()).filter(own).collect();
        if !repeats(id) || waves.len() < 2 {
            return Vec::new();
        }
        let decide = &self.dataset.thresholds.evidence;
        let is_faint = |at: &usize| {
            let (shape, start) = best.without(*at, self.dataset.scales);
            let without = self.problem().fit(&shape, start);
            !self.gain(&without, best, weighing).is_large(decide)
        };
        let faint = waves.into_iter().filter(is_faint);
        faint.map(|at| terms[at].row[1]).collect()
    }

    /// Whether a sharp step of the zero beside a fit without an effect leaves less than the best with it.
    fn is_rather_a_step(&self, without: &Fit, with: &Fit) -> bool {
        let most = self.dataset.thresholds.evidence.rather_a_step * with.cost;
        let step = ZeroStep::of(&self.problem(), without);
        step.is_some_and(|(_, step)| step.cost < most)
    }

    /// The best fit without an effect and whatever stands for it.
    fn without_kind(&self, best: &Fit, id: EffectId) -> Fit {
        let mut terms = best.shape.terms_at(&best.numbers);
        terms.retain(|term| term.given || !stands_for(term.id, id));
        self.fitted_from_both(best.with_terms(terms, self.dataset.scales))
    }

    /// √w r of a fit.
    pub(super) fn weighted_residuals(&self, fit: &Fit) -> Vec<f64> {
        let residuals = self.problem().residuals(&fit.shape, &fit.numbers);
        let each = residuals.iter().zip(&self.weights);
        each.map(|(residual, weight)| residual * weight.sqrt())
            .collect()
    }

    /// The share that a fit takes off what stands above the noise with another.
    fn share(&self, more: &Fit, less: &Fit) -> f64 {
        let excess = (more.cost - self.noise_cost).max(f64::MIN_POSITIVE);
        ((more.cost - less.cost) / excess).clamp(0.0, 1.0)
    }

    /// What a fit takes off that another leaves.
    fn gain(&self, more: &Fit, less: &Fit, weighing: &Weighing<'_>) -> Gain {
        let residuals = [more, less].map(|fit| self.weighted_residuals(fit));
        let beside = weighing
            .remainder
            .gain(&residuals[0], &residuals[1], &weighing.blocks);
        Gain {
            share: self.share(more, less),
            lead: more.cost / less.cost,
            blocks: weighing.blocks.better(&residuals[0], &residuals[1]),
            beside,
        }
    }
}

/// What the evidence for each effect of a set is weighed with.
struct Weighing<'a> {
    best: &'a Fit,
    /// All fits, of any set.
    all: &'a [Fit],
    /// The effect that stands out of all others if one alone is added.
    alone: Option<EffectId>,
    parts: Parts,
    remainder: Remainder,
    blocks: Blocks,
}

/// What an effect takes off.
struct Gain {
    /// Of what stands above the noise.
    share: f64,
    /// How many times as many squares stay without it.
    lead: f64,
    /// The fraction of blocks in which it takes something off.
    blocks: f64,
    /// How many times as many squares stay without it beside the remainder as a process, and its standard errors
    /// from once.
    beside: (f64, f64),
}

impl Gain {
    /// Whether it is a large share, in most blocks.
    fn is_large_share(&self, decide: &thresholds::Evidence) -> bool {
        self.share >= decide.share && self.blocks >= decide.blocks
    }

    /// The same, beside the remainder as well.
    fn is_large(&self, decide: &thresholds::Evidence) -> bool {
        let (times, sigmas) = self.beside;
        self.is_large_share(decide) && times >= decide.beside && sigmas >= decide.beside_sigmas
    }

    /// Whether it speaks for an effect: it is large; or so sharp that no remainder moves like it; or in every
    /// block, where what is slow is followed by a remainder's prediction.
    fn is_sound(&self, id: EffectId, decide: &thresholds::Evidence) -> bool {
        let (times, sigmas) = self.beside;
        let is_sharp = times >= decide.sharp
            && sigmas >= decide.sharp_sigmas
            && self.blocks >= decide.sharp_blocks;
        // A wave of the right period follows a remainder that wanders in every block.
        let is_everywhere = !repeats(id)
            && self.lead >= decide.everywhere_lead
            && self.blocks >= decide.everywhere
            && times > 1.0
            && sigmas > 1.0;
        self.is_large(decide) || is_sharp || is_everywhere
    }
}

/// The best fit with an effect, of any size as those without it.
fn best_with<'a>(all: &'a [Fit], best: &'a Fit, id: EffectId) -> &'a Fit {
    let has = all.iter().filter(|fit| added_effects(fit).contains(&id));
    has.chain([best])
        .min_by(|a, b| a.cost.total_cmp(&b.cost))
        .unwrap_or(best)
}

/// The best fit without some effects and whatever stands for them. The base alone is always one.
fn best_without<'a>(all: &'a [Fit], ids: &[EffectId]) -> &'a Fit {
    let lacks = |fit: &&Fit| {
        let added = added_effects(fit);
        !added
            .iter()
            .any(|other| ids.iter().any(|id| stands_for(*other, *id)))
    };
    let best = all.iter().filter(lacks);
    best.min_by(|a, b| a.cost.total_cmp(&b.cost))
        .unwrap_or(&all[0])
}

/// The effect of a fit that stands in the place of others.
fn newcomer(fit: &Fit, ids: &[EffectId], out: &[EffectId]) -> Option<EffectId> {
    let mut added = added_effects(fit).into_iter();
    added.find(|other| !ids.contains(other) && !out.contains(other))
}

/// The best fit with another effect in the place of one from which it differs by less than a rig errs: in slow
/// motion a lag and a delay do.
fn as_alike(all: &[Fit], id: EffectId) -> Option<(EffectId, &Fit)> {
    let other = |fit: &Fit| {
        let mut added = added_effects(fit).into_iter();
        added.find(|other| are_alike(*other, id))
    };
    let others = all
        .iter()
        .filter(|fit| !added_effects(fit).contains(&id))
        .filter_map(|fit| Some((other(fit)?, fit)));
    others.min_by(|a, b| a.1.cost.total_cmp(&b.1.cost))
}

/// Whether one effect is at the same place of the machine as another: a curve that bends one way or another, a
/// pull of the load path. A group without a place says nothing.
fn is_as_placed(one: EffectId, other: EffectId) -> bool {
    one.info().stage == other.info().stage || stands_for(one, other)
}

/// The effects that leave nearly as little in the place of one, if the best set without all of these is
/// clearly worse; `None` if it is not, or if there are more than three.
fn alternatives(
    all: &[Fit],
    ids: &[EffectId],
    id: EffectId,
    is_ahead: impl Fn(&Fit) -> bool,
) -> Option<Vec<EffectId>> {
    let mut out = vec![id];
    for _ in 0..4 {
        let without = best_without(all, &out);
        if is_ahead(without) {
            return Some(out.split_off(1));
        }
        out.push(newcomer(without, ids, &out)?);
    }
    None
}

/// Whether an effect that repeats stands several times in a fit and none of its waves is prominent: a series
/// fits any curve.
fn is_series(fit: &Fit, id: EffectId, decide: &thresholds::Search) -> bool {
    is_repeated(id, fit) && is_fourier_series(fit, decide.prominent_wave, 2)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Share, lead, blocks, and what it takes beside the remainder, as measured on a record.
    type Measured = (f64, f64, f64, (f64, f64));

    fn is_sound(id: EffectId, (share, lead, blocks, beside): Measured) -> bool {
        let gain = Gain {
            share,
            lead,
            blocks,
            beside,
        };
        gain.is_sound(id, &thresholds::Evidence::default())
    }

    #[test]
    fn what_is_sharp_needs_no_share_and_what_is_slow_acts_in_every_block() {
        // GIVEN a delay of 1.3 ms in a drive's record, and what a pendulum's waves reached
        let delay = |times: f64| is_sound(EffectId::TimeDelay, (0.43, 1.74, 1.0, (times, 9.2)));
        assert!(delay(2.13));
        assert!(!delay(1.62));
        // AND the backlash of a friction damper, a wave that does as much, and a softening that stands for a
        // material that breaks in small steps
        let backlash = (0.56, 2.29, 0.95, (1.07, 1.34));
        let softening = (0.73, 1.85, 0.93, (1.18, 2.99));
        assert!(is_sound(EffectId::DriveBacklash, backlash));
        assert!(!is_sound(EffectId::Cogging, backlash));
        assert!(!is_sound(EffectId::CyclicSoftening, softening));
    }
}
