//! The effects of a rig.

use crate::maths::scalar::Scalar;
use crate::physics::effect::Effect;

/// Most effects of a rig.
pub const MOST_EFFECTS: usize = 8;

/// The effects of a rig, at most [`MOST_EFFECTS`], in the order in which they were added.
///
/// They are gone through a dozen times a sample, once for each stage of the chain: empty slots are not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effects<S> {
    slots: [Option<Effect<S>>; MOST_EFFECTS],
    /// Number of slots in use, from the first on.
    used: usize,
}

impl<S: Scalar> Effects<S> {
    /// No effect.
    pub fn none() -> Effects<S> {
        Effects {
            slots: [None; MOST_EFFECTS],
            used: 0,
        }
    }

    /// Adds an effect. Returns false, and leaves it out, if there are [`MOST_EFFECTS`].
    pub fn push(&mut self, effect: Effect<S>) -> bool {
        let Some(slot) = self.slots.get_mut(self.used) else {
            return false;
        };
        *slot = Some(effect);
        self.used += 1;
        true
    }

    /// The effects, in the order in which they were added.
    pub fn iter(&self) -> impl Iterator<Item = &Effect<S>> + Clone {
        self.slots.iter().take(self.used).flatten()
    }

    /// Those that `keep` says.
    #[must_use]
    pub fn filtered(&self, keep: impl Fn(&Effect<S>) -> bool) -> Effects<S> {
        let kept = self.iter().filter(|effect| keep(effect));
        kept.copied().collect()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.used == 0
    }
}

/// The first [`MOST_EFFECTS`] of them.
impl<S: Scalar> FromIterator<Effect<S>> for Effects<S> {
    fn from_iter<I: IntoIterator<Item = Effect<S>>>(all: I) -> Effects<S> {
        let mut effects = Effects::none();
        for effect in all.into_iter().take(MOST_EFFECTS) {
            effects.push(effect);
        }
        effects
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::effect::EffectId;

    #[test]
    fn effects_keep_their_order_and_no_more_fit_than_there_are_slots() {
        let offset =
            |force_n: f64| Effect::new(EffectId::ForceOffset, &[force_n, 0.0, 0.0, 0.0, 0.0]);
        let all = || (0..10).map(|at| offset(f64::from(at)));
        let mut effects: Effects<f64> = all().collect();
        assert!(effects.iter().copied().eq(all().take(MOST_EFFECTS)));
        assert!(!effects.push(offset(1.0)));
        let large = effects.filtered(|effect| effect.row()[0] > 5.0);
        assert!(large.iter().copied().eq(all().skip(6).take(2)));
        assert!(Effects::<f64>::none().is_empty() && !effects.is_empty());
    }
}
