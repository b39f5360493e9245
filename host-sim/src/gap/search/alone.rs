//! The effect that stands out if one alone is added to the base.
//!
//! Sets of several effects may follow what a single one makes: forces that were 1.3 ms late in a drive's record were
//! followed by two waves and a friction to within 1.16 times the squares, and no name stood. Of the effects that are
//! added alone a lag left the least there, and the next that is no lateness 1.67 times as much, in every block.

use estimator_core::physics::effect::EffectId;
use rayon::prelude::*;

use crate::gap::model::{fit::Fit, start::repeats};
use crate::gap::search::blocks::Blocks;
use crate::gap::search::parts::Parts;
use crate::gap::search::relatives::stands_for;
use crate::gap::search::remainder::Remainder;
use crate::gap::search::run::Search;
use crate::gap::search::sets::{added_effects, keep_first};

impl Search<'_> {
    /// The effect that alone leaves least, if the next that does not stand for it is clearly behind; `all` are fits of
    /// any size. No wave is one, since several together fit any curve that wanders.
    pub(super) fn effect_alone(
        &self,
        base: &Fit,
        all: &[Fit],
        blocks: &Blocks,
    ) -> Option<EffectId> {
        let decide = &self.dataset.thresholds.evidence;
        let singles = self.singles(all);
        let fit = singles.first()?;
        let id = added_effects(fit)[0];
        if repeats(id) {
            return None;
        }
        let behind = singles
            .iter()
            .find(|other| !stands_for(added_effects(other)[0], id));
        let next = behind.map_or_else(|| self.refitted(base), Fit::clone);
        if next.cost < decide.lead * fit.cost {
            return None;
        }
        let [more, less] = [&next, fit].map(|fit| self.weighted_residuals(fit));
        let (times, sigmas) = Remainder::of(&less).gain(&more, &less, blocks);
        // A damping that grows with the square of the speed, which is in no catalogue, was followed by a quadratic
        // drag in 86 % of them.
        let is_clear = blocks.better(&more, &less) >= decide.sharp_blocks
            && times >= decide.beside
            && sigmas >= decide.beside_sigmas
            && Parts::of(&self.dataset, &self.weights, fit).agree(fit, id, decide);
        is_clear.then_some(id)
    }

    /// The best fit with each effect that was tried alone under the present weights, the best first.
    fn singles(&self, all: &[Fit]) -> Vec<Fit> {
        let single = all.par_iter().filter(|fit| added_effects(fit).len() == 1);
        let mut singles: Vec<Fit> = single.map(|fit| self.refitted(fit)).collect();
        singles.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        keep_first(&mut singles, added_effects);
        singles
    }
}
