//! A model as the core computes it: environment and effects as one [`Rig`].

use estimator_core::physics::effect::EffectId;
use estimator_core::physics::rig::{self, MOST_EFFECTS, MOST_MODES, Rig};

use super::{Environment, Model};
use crate::diagnostic::Diagnostic;
use crate::plant::{Contact, Effects};

/// Effects that a rig has once: two power laws are no law, two amplifiers one filter of second
/// order, two plays one play.
const ONCE: [EffectId; 5] = [
    EffectId::PowerLawStiffness,
    EffectId::DepthDependentDamping,
    EffectId::Backlash,
    EffectId::DriveBacklash,
    EffectId::ForceLag,
];

impl Model {
    /// The whole model as the core simulates, fits and compensates it.
    ///
    /// # Errors
    /// An effect that the catalogue does not know or that has a wrong parameter, one that cannot
    /// enter twice, more effects or relaxation modes than a rig has.
    pub fn rig(&self) -> Result<Rig<f64>, Diagnostic> {
        self.rig_at().map_err(|error| error.in_file(&self.path))
    }

    /// The model as the simulated rig has it: what is touched, and what the rig adds.
    ///
    /// # Errors
    /// As [`Model::rig`].
    pub fn simulated(&self) -> Result<(Contact, Effects), Diagnostic> {
        let effects = self.rig()?.effects;
        // Model::rig has refused what has no contact.
        let contact = self.environment.contact().unwrap_or(Contact::FREE);
        Ok((contact, effects))
    }

    fn rig_at(&self) -> Result<Rig<f64>, Diagnostic> {
        let mut rig = Rig::bare(self.environment.core()?);
        for (count, effect) in self.effects.iter().enumerate() {
            let core = effect.core()?;
            let kind = self.kind.unwrap_or_default();
            if !kind.can_have(core.id()) {
                return Err(effect
                    .wrong(format!("{} on a machine that does not turn", effect.id))
                    .at_key("effect.id")
                    .value(&effect.id)
                    .remedy(
                        "write kind = \"rotary\" at the top of the model, or remove the effect",
                    ));
            }
            if count >= MOST_EFFECTS {
                return Err(effect
                    .wrong(format!("more than {MOST_EFFECTS} effects"))
                    .at_key("effect")
                    .value(&effect.id)
                    .remedy("remove the one that matters least"));
            }
            let same = |other: &&EffectId| **other == core.id();
            if ONCE.iter().any(|id| same(&id)) && rig.effects().any(|own| own.id() == core.id()) {
                return Err(effect
                    .wrong(format!("{} a second time", effect.id))
                    .at_key("effect.id")
                    .value(&effect.id)
                    .remedy("a rig has it once: remove one of them"));
            }
            rig = rig.with(core);
        }
        Ok(rig)
    }
}

impl Environment {
    /// The environment as the core computes it.
    ///
    /// # Errors
    /// More than [`MOST_MODES`] relaxation modes.
    pub fn core(&self) -> Result<rig::Environment<f64>, Diagnostic> {
        match self.contact() {
            Some(contact) => Ok(contact.environment()),
            None => Err(
                Diagnostic::new(format!("more than {MOST_MODES} relaxation modes"))
                    .at_key("environment.relaxation")
                    .remedy("describe the relaxation by fewer modes"),
            ),
        }
    }
}
