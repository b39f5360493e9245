//! The section `compensation`: a setting for each parameter of each effect that a board can
//! compensate, with the catalogue's names, units and bounds. An effect is on a board at most once, and
//! is on while one of its parameters is not 0.
//!
//! Effects that count the time from the start of a log have no settings: a board that was switched on
//! knows nothing of it. Its resting force follows a slow drift.

use super::info::{Bounds, Info};
use crate::physics::{effect, effect::EffectId};

/// How many settings the section has.
pub const COUNT: usize = {
    let (mut count, mut at) = (0, 0);
    while at < EffectId::ALL.len() {
        if EffectId::ALL[at].is_for_boards() {
            count += EffectId::ALL[at].info().parameters.len();
        }
        at += 1;
    }
    count
};
/// The largest number of settings that can be other than 0: what a record in flash has room for beside
/// the settings of the board. The eight largest effects would have 28, of which three are dry frictions,
/// each a form of the others, and the forms of most effects exclude each other or are rare.
pub(super) const MOST_AT_ONCE: usize = 20;
const SECTION: &str = "compensation.";
/// The length of the longest name: `compensation.stribeck_friction.transition_speed`.
const NAME: usize = 48;
/// A number beyond every rig, and within f32 when it is squared.
const LARGEST: f32 = 1e9;

/// The number of the setting for a parameter of the effect with a code. Numbers stand in the flash of
/// boards: those of the effects 11…26 are 64…127; 27…50 have 160…255, since 128 is that of
/// `reflection` and 144…159 are those of `render`. Fifth parameters came later, and have those of an effect 47, which
/// there must not be.
pub(super) const fn number(code: u8, place: u8) -> Option<u8> {
    match code {
        12 if place == 4 => Some(240),
        29 if place == 4 => Some(241),
        _ if place > 3 => None,
        11..=26 => Some(64 + 4 * (code - 11) + place),
        27..=50 => Some(160 + 4 * (code - 27) + place),
        _ => None,
    }
}

/// A parameter of an effect that a board can compensate.
#[derive(Clone, Copy, Debug)]
pub struct Parameter(&'static Row);

#[derive(Debug)]
struct Row {
    id: u8,
    effect: EffectId,
    place: u8,
    ends: Ends,
    info: Info,
}

/// The ends of a setting's bounds that are no values while the effect is on. They stand for the
/// catalogue's bounds, whose ranges would take 24 bytes of flash in every row.
#[derive(Clone, Copy, Debug)]
enum Ends {
    Included,
    ZeroExcluded,
    ZeroAndOneExcluded,
}

impl Parameter {
    /// All of them, effect by effect.
    pub(super) const ALL: [Parameter; COUNT] = {
        let mut all = [Parameter(&ROWS[0]); COUNT];
        let mut at = 0;
        while at < COUNT {
            all[at] = Parameter(&ROWS[at]);
            at += 1;
        }
        all
    };

    /// The parameters of an effect, in the catalogue's order.
    pub(super) fn all_of(effect: EffectId) -> impl Iterator<Item = Parameter> {
        let rows = ROWS.iter().filter(move |row| row.effect == effect);
        rows.map(Parameter)
    }

    /// The effects that a board can compensate. From the rows and not from the catalogue, for whose
    /// texts a board has no flash.
    pub(super) fn effects() -> impl Iterator<Item = EffectId> {
        let first = ROWS.iter().filter(|row| row.place == 0);
        first.map(|row| row.effect)
    }

    /// The parameter of an effect at a place in the catalogue's order.
    pub fn of(effect: EffectId, place: usize) -> Option<Parameter> {
        let mut all = Parameter::ALL.into_iter();
        all.find(|one| one.effect() == effect && usize::from(one.0.place) == place)
    }

    /// The effect that it belongs to.
    pub const fn effect(self) -> EffectId {
        self.0.effect
    }

    pub(super) const fn place(self) -> usize {
        self.0.place as usize
    }

    /// What a value within the setting's bounds would have to be while the effect is on; `None` if it
    /// can be used.
    pub(super) fn refuses(self, value: f32) -> Option<&'static str> {
        let (is_excluded, bounds) = match self.0.ends {
            Ends::Included => return None,
            Ends::ZeroExcluded => (value == 0.0, effect::Bounds::Positive),
            Ends::ZeroAndOneExcluded => (value == 0.0 || value == 1.0, effect::Bounds::Fraction),
        };
        is_excluded.then(|| bounds.name())
    }

    pub(super) const fn id(self) -> u8 {
        self.0.id
    }

    pub(super) const fn info(self) -> &'static Info {
        &self.0.info
    }
}

impl PartialEq for Parameter {
    fn eq(&self, other: &Parameter) -> bool {
        self.id() == other.id()
    }
}

impl Eq for Parameter {}

const NOTHING: Row = Row {
    id: 0,
    effect: EffectId::CoulombFriction,
    place: 0,
    ends: Ends::Included,
    info: Info {
        name: "",
        unit: "1",
        bounds: Bounds::Within(0.0, 0.0),
        default: 0.0,
        restarts: true,
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
        while effect.is_for_boards() && place < effect.info().parameters.len() {
            rows[row] = Row {
                id: match number(effect as u8, place as u8) {
                    Some(id) => id,
                    None => panic!("no number is left for this effect"),
                },
                effect,
                place: place as u8,
                ends: match effect.info().parameters[place].bounds {
                    effect::Bounds::Positive => Ends::ZeroExcluded,
                    effect::Bounds::Fraction => Ends::ZeroAndOneExcluded,
                    _ => Ends::Included,
                },
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
        unit: of.unit.ascii(),
        bounds: match of.bounds {
            effect::Bounds::Any | effect::Bounds::Angle => Bounds::Within(-LARGEST, LARGEST),
            effect::Bounds::NotNegative | effect::Bounds::Positive => Bounds::Within(0.0, LARGEST),
            effect::Bounds::Fraction => Bounds::Within(0.0, 1.0),
            effect::Bounds::Within(low, high) => Bounds::Within(low as f32, high as f32),
        },
        default: 0.0,
        restarts: true,
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
        while effect.is_for_boards() && place < effect.info().parameters.len() {
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
