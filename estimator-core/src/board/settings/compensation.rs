//! The section `compensation`: what the board takes off before it estimates. A setting for each
//! parameter of each effect of the rig, with the catalogue's names, units and bounds, so that an
//! effect is on a board at most once.
//!
//! Numbers are 64 + 4·(code of the effect − 11) + place of the parameter: 64…127 for the effects 11…26,
//! of which all that a board can take off are. An effect is on while one of its parameters is not 0.
//!
//! `force_drift` and `periodic_disturbance` have no place here: their time counts from the start of a
//! log, and a board that was switched on knows nothing of it. Its resting force follows a slow drift.

use super::{Bounds, Info, Invalid, Key, Settings};
use crate::board::sensing::CODES_PER_COUNT;
use crate::estimate::compensation::{Compensation, compensates};
use crate::estimate::config::Config;
use crate::estimate::error::ConfigError;
use crate::physics::effect::{self, Effect, EffectId, MOST_PARAMETERS};
use crate::physics::rig::MOST_EFFECTS;

/// How many settings the section has.
pub const COUNT: usize = count();
/// Most parameters that can be other than 0: those of the [`MOST_EFFECTS`] effects with the most.
pub(super) const MOST_AT_ONCE: usize = {
    let (mut sum, mut effects, mut size) = (0, 0, MOST_PARAMETERS);
    while size > 0 {
        let mut at = 0;
        while at < EffectId::ALL.len() {
            let of = EffectId::ALL[at];
            if has_place(of) && of.info().parameters.len() == size && effects < MOST_EFFECTS {
                (sum, effects) = (sum + size, effects + 1);
            }
            at += 1;
        }
        size -= 1;
    }
    sum
};
/// The first number of the section.
const FIRST: u8 = 64;
const SECTION: &str = "compensation.";
/// Longest name: `compensation.stribeck_friction.transition_speed`.
const NAME: usize = 48;
/// Beyond every rig, and within f32 when it is squared.
const LARGEST: f32 = 1e9;

/// A parameter of an effect that a board can take off.
#[derive(Clone, Copy, Debug)]
pub struct Parameter(&'static Row);

#[derive(Debug)]
struct Row {
    id: u8,
    effect: EffectId,
    place: u8,
    bounds: effect::Bounds,
    info: Info,
}

/// Whether an effect can be taken off by a board: the rig's own, unless it counts time from a start.
pub const fn has_place(id: EffectId) -> bool {
    compensates(id) && !matches!(id, EffectId::ForceDrift | EffectId::PeriodicDisturbance)
}

impl Parameter {
    /// All of them in the order of their numbers.
    pub(super) const ALL: [Parameter; COUNT] = {
        let mut all = [Parameter(&ROWS[0]); COUNT];
        let mut at = 0;
        while at < COUNT {
            all[at] = Parameter(&ROWS[at]);
            at += 1;
        }
        all
    };

    /// The one of an effect, by its place in the catalogue's order.
    pub fn of(effect: EffectId, place: usize) -> Option<Parameter> {
        let mut all = Parameter::ALL.into_iter();
        all.find(|one| one.effect() == effect && usize::from(one.0.place) == place)
    }

    /// Whose it is.
    pub const fn effect(self) -> EffectId {
        self.0.effect
    }

    pub(super) const fn id(self) -> u8 {
        self.0.id
    }

    pub(super) const fn info(self) -> Info {
        self.0.info
    }
}

impl PartialEq for Parameter {
    fn eq(&self, other: &Parameter) -> bool {
        self.id() == other.id()
    }
}

impl Eq for Parameter {}

impl Settings {
    /// What is taken off the samples; `None` if nothing.
    ///
    /// # Errors
    /// The first value that cannot be used.
    #[inline(never)]
    pub(super) fn compensation(&self) -> Result<Option<Compensation<f32>>, Invalid> {
        let mut effects = [None; MOST_EFFECTS];
        let mut free = effects.iter_mut();
        // From the rows and not from the catalogue, whose texts a board has no flash for.
        for row in ROWS.iter().filter(|row| row.place == 0) {
            let id = row.effect;
            let Some(effect) = self.effect(id)? else {
                continue;
            };
            let Some(slot) = free.next() else {
                return Err(self.invalid(id, 0, "0: no more than 8 effects at once"));
            };
            *slot = Some(effect);
        }
        if effects.iter().all(Option::is_none) {
            return Ok(None);
        }
        let count_m = self.get(Key::PositionPerCode).abs() * CODES_PER_COUNT as f32;
        Compensation::from_rig_effects(effects, Config::default().rate_hz, f64::from(count_m))
            .map(Some)
            .map_err(|error| self.named(&error))
    }

    /// An effect of the section; `None` while all its parameters are 0.
    #[inline(never)]
    fn effect(&self, id: EffectId) -> Result<Option<Effect<f32>>, Invalid> {
        let own = || ROWS.iter().filter(|row| row.effect == id);
        let mut row = [0.0; MOST_PARAMETERS];
        for (value, at) in row.iter_mut().zip(own()) {
            *value = self.get(Key::Compensation(Parameter(at)));
        }
        if row.iter().all(|value| *value == 0.0) {
            return Ok(None);
        }
        for (value, at) in row.iter().zip(own()) {
            if !at.bounds.allow(f64::from(*value)) {
                return Err(self.invalid(id, usize::from(at.place), at.bounds.name()));
            }
        }
        Ok(Some(Effect::new(id, &row)))
    }

    /// Puts an effect into the section, in place of what it said of it; false if it has no place there.
    pub fn put_effect(&mut self, effect: &Effect<f64>) -> bool {
        for (place, value) in effect.row().into_iter().enumerate() {
            if let Some(parameter) = Parameter::of(effect.id(), place) {
                self.put(Key::Compensation(parameter), value as f32);
            }
        }
        has_place(effect.id())
    }

    /// Takes all effects out of the section.
    pub fn without_compensation(mut self) -> Settings {
        for parameter in Parameter::ALL {
            self.put(Key::Compensation(parameter), 0.0);
        }
        self
    }

    fn named(&self, error: &ConfigError) -> Invalid {
        let of_the_delay = self.invalid(EffectId::TimeDelay, 0, error.expected);
        Invalid {
            value: error.value,
            ..of_the_delay
        }
    }

    fn invalid(&self, id: EffectId, place: usize, expected: &'static str) -> Invalid {
        // An effect that has no place here has not been asked for.
        let key = Parameter::of(id, place).map_or(Key::PositionPerCode, Key::Compensation);
        Invalid {
            key,
            value: self.get(key),
            expected: Some(expected),
        }
    }
}

const fn count() -> usize {
    let (mut count, mut at) = (0, 0);
    while at < EffectId::ALL.len() {
        if has_place(EffectId::ALL[at]) {
            count += EffectId::ALL[at].info().parameters.len();
        }
        at += 1;
    }
    count
}

const NOTHING: Row = Row {
    id: 0,
    effect: EffectId::CoulombFriction,
    place: 0,
    bounds: effect::Bounds::Any,
    info: Info {
        name: "",
        unit: "1",
        bounds: Bounds::Within(0.0, 0.0),
        default: 0.0,
        about: "",
    },
};
const NAMES: &[([u8; NAME], usize); COUNT] = &names();
const ROWS: &[Row; COUNT] = &rows();

const fn rows() -> [Row; COUNT] {
    let mut rows = [NOTHING; COUNT];
    let (mut row, mut at) = (0, 0);
    while at < EffectId::ALL.len() {
        let effect = EffectId::ALL[at];
        let mut place = 0;
        while has_place(effect) && place < effect.info().parameters.len() {
            rows[row] = Row {
                id: FIRST + 4 * (effect as u8 - EffectId::CoulombFriction as u8) + place as u8,
                effect,
                place: place as u8,
                bounds: effect.info().parameters[place].bounds,
                info: info(effect, place, &NAMES[row]),
            };
            place += 1;
            row += 1;
        }
        at += 1;
    }
    rows
}

const fn info(effect: EffectId, place: usize, name: &'static ([u8; NAME], usize)) -> Info {
    let of = &effect.info().parameters[place];
    let name = match core::str::from_utf8(name.0.split_at(name.1).0) {
        Ok(name) => name,
        Err(_) => panic!("the names of the catalogue are ASCII"),
    };
    Info {
        name,
        unit: of.unit.symbol(),
        bounds: match of.bounds {
            effect::Bounds::Any | effect::Bounds::Angle => Bounds::Within(-LARGEST, LARGEST),
            effect::Bounds::NotNegative | effect::Bounds::Positive => Bounds::Within(0.0, LARGEST),
            effect::Bounds::Fraction => Bounds::Within(0.0, 1.0),
            effect::Bounds::Within(low, high) => Bounds::Within(low as f32, high as f32),
        },
        default: 0.0,
        about: "of an effect of the rig that is taken off; 0: not",
    }
}

/// `compensation.<effect>.<parameter>`, with its length.
const fn names() -> [([u8; NAME], usize); COUNT] {
    let mut names = [([0; NAME], 0); COUNT];
    let (mut row, mut at) = (0, 0);
    while at < EffectId::ALL.len() {
        let effect = EffectId::ALL[at];
        let mut place = 0;
        while has_place(effect) && place < effect.info().parameters.len() {
            let parts = [
                SECTION,
                effect.name(),
                ".",
                effect.info().parameters[place].name,
            ];
            let mut part = 0;
            while part < parts.len() {
                let bytes = parts[part].as_bytes();
                let mut byte = 0;
                while byte < bytes.len() {
                    names[row].0[names[row].1] = bytes[byte];
                    names[row].1 += 1;
                    byte += 1;
                }
                part += 1;
            }
            place += 1;
            row += 1;
        }
        at += 1;
    }
    names
}

#[cfg(test)]
mod tests;
