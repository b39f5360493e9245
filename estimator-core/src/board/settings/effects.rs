//! The effects that the section `compensation` names, as the board compensates them.

use super::compensation::{MOST_AT_ONCE, Parameter};
use super::{key::Key, values::Invalid, values::Settings};
use crate::estimate::{compensation::Compensation, config::Config, error::ConfigError};
use crate::physics::{effect::Effect, effect::EffectId, effect::MOST_PARAMETERS, rig::Effects};

impl Settings {
    /// The compensation of the samples; `None` if no effect is on.
    ///
    /// # Errors
    /// The first value that cannot be used.
    #[inline(never)]
    pub(super) fn compensation(&self) -> Result<Option<Compensation<f32>>, Invalid> {
        let mut effects = Effects::none();
        let mut numbers = 0;
        for id in Parameter::effects() {
            let Some(effect) = self.effect(id)? else {
                continue;
            };
            if !effects.push(effect) {
                return Err(self.invalid(id, 0, "0: no more than 8 effects at once"));
            }
            numbers += effect.row().iter().filter(|value| **value != 0.0).count();
            if numbers > MOST_AT_ONCE {
                return Err(self.invalid(id, 0, "0: no more than 20 numbers of effects at once"));
            }
        }
        if effects.is_empty() {
            return Ok(None);
        }
        let count_m = f64::from(self.count_m());
        Compensation::from_rig_effects(effects, Config::default().rate_hz, count_m)
            .map(Some)
            .map_err(|error| self.of_the_delay(&error))
    }

    /// An effect of the section; `None` while all its parameters are 0.
    #[inline(never)]
    fn effect(&self, id: EffectId) -> Result<Option<Effect<f32>>, Invalid> {
        let mut row = [0.0; MOST_PARAMETERS];
        for (value, parameter) in row.iter_mut().zip(Parameter::all_of(id)) {
            *value = self.get(Key::Compensation(parameter));
        }
        if row.iter().all(|value| *value == 0.0) {
            return Ok(None);
        }
        for (value, parameter) in row.iter().zip(Parameter::all_of(id)) {
            if let Some(expected) = parameter.refuses(*value) {
                return Err(self.invalid(id, parameter.place(), expected));
            }
        }
        Ok(Some(Effect::new(id, &row)))
    }

    /// Puts an effect into the section, in place of what it said of it; false if a board cannot
    /// compensate it.
    pub fn put_effect(&mut self, effect: &Effect<f64>) -> bool {
        for (place, value) in effect.row().into_iter().enumerate() {
            if let Some(parameter) = Parameter::of(effect.id(), place) {
                self.put(Key::Compensation(parameter), value as f32);
            }
        }
        effect.id().is_for_boards()
    }

    /// The settings with all effects off.
    pub fn without_compensation(mut self) -> Settings {
        for parameter in Parameter::ALL {
            self.put(Key::Compensation(parameter), 0.0);
        }
        self
    }

    fn of_the_delay(&self, error: &ConfigError) -> Invalid {
        Invalid {
            value: error.value,
            ..self.invalid(EffectId::TimeDelay, 0, error.expected)
        }
    }

    fn invalid(&self, id: EffectId, place: usize, expected: &'static str) -> Invalid {
        // An effect that has no settings has not been asked for.
        let key = Parameter::of(id, place).map_or(Key::PositionPerCode, Key::Compensation);
        Invalid {
            key,
            value: self.get(key),
            expected: Some(expected),
        }
    }
}

#[cfg(test)]
mod tests;
