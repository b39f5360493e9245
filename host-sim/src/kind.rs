//! Machines that move along a line, and machines that turn.
//!
//! Everything is computed in the same numbers; what they are called differs. A position is an angle in rad
//! where a machine turns, a force a torque in N m, and every unit that is made of them follows. The kind
//! is known where results are worded, on the thread that words them ([`worded`]), as a language is: a
//! function that prints a stiffness need not be told it.

use std::cell::Cell;

use estimator_core::physics::effect::{EffectId, Repeats};

/// Whether a machine moves along a line or turns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Kind {
    /// Positions in m, forces in N.
    #[default]
    Linear,
    /// Positions in rad, forces in N m.
    Rotary,
}

/// Units of a machine along a line, and what they are where it turns.
const UNITS: [(&str, &str); 19] = [
    ("m", "rad"),
    ("N", "N m"),
    ("N/m", "N m/rad"),
    ("N s/m", "N m s/rad"),
    ("N·s/m", "N·m·s/rad"),
    ("N s²/m²", "N m s²/rad²"),
    ("N/m²", "N m/rad²"),
    ("N s/m²", "N m s/rad²"),
    ("m/s", "rad/s"),
    ("m/s²", "rad/s²"),
    ("1/m", "1/rad"),
    ("1/m^ν", "1/rad^ν"),
    ("N/s", "N m/s"),
    ("kg", "kg m²"),
    ("N²/Hz", "(N m)²/Hz"),
    ("m/N", "rad/(N m)"),
    ("N/rad", "N m/rad"),
    ("N/√Hz", "N m/√Hz"),
    ("m²", "rad²"),
];

impl Kind {
    /// Both, as files name them.
    pub const ALL: [Kind; 2] = [Kind::Linear, Kind::Rotary];

    /// Its name in files.
    pub const fn name(self) -> &'static str {
        match self {
            Kind::Linear => "linear",
            Kind::Rotary => "rotary",
        }
    }

    /// The kind of a name.
    pub fn from_name(name: &str) -> Option<Kind> {
        Kind::ALL.into_iter().find(|kind| kind.name() == name)
    }

    /// What a unit of a machine along a line is on this one; a unit that is not made of m and N stays.
    pub fn unit(self, linear: &str) -> &str {
        let turned = || UNITS.iter().find(|(own, _)| *own == linear);
        match self {
            Kind::Linear => linear,
            Kind::Rotary => turned().map_or(linear, |(_, rotary)| *rotary),
        }
    }

    /// Whether a machine of this kind can have an effect.
    pub fn can_have(self, id: EffectId) -> bool {
        self == Kind::Rotary || id.info().repeats != Repeats::EveryTurn
    }
}

/// The kind of a flag on the command line.
///
/// # Errors
/// The names that there are.
pub fn kind_named(text: &str) -> Result<Kind, String> {
    Kind::from_name(text).ok_or_else(|| format!("one of {}", Kind::ALL.map(Kind::name).join(", ")))
}

thread_local! {
    static WORDED: Cell<Kind> = const { Cell::new(Kind::Linear) };
}

/// Words results of a machine of this kind: until it returns, the units of this thread are that kind's.
pub fn worded<T>(kind: Kind, word: impl FnOnce() -> T) -> T {
    struct Restored(Kind);
    impl Drop for Restored {
        fn drop(&mut self) {
            WORDED.set(self.0);
        }
    }
    let _restored = Restored(WORDED.replace(kind));
    word()
}

/// The kind that this thread words.
pub fn of_words() -> Kind {
    WORDED.get()
}

/// A unit of a machine along a line as this thread words it.
pub fn unit(linear: &str) -> &str {
    of_words().unit(linear)
}

#[cfg(test)]
mod tests {
    use super::*;
    use estimator_core::physics::law::LawId;

    #[test]
    fn every_unit_of_the_catalogue_and_the_laws_has_its_own_where_a_machine_turns() {
        let effects = EffectId::ALL.iter().flat_map(|id| id.info().parameters);
        let laws = LawId::ALL.iter().flat_map(|id| id.info().parameters);
        for info in effects.chain(laws) {
            let (linear, turned) = (info.unit.symbol(), Kind::Rotary.unit(info.unit.symbol()));
            let is_plain = matches!(linear, "1" | "1/s" | "s" | "Hz" | "rad");
            assert_eq!(linear == turned, is_plain, "{linear}");
            assert_eq!(Kind::Linear.unit(linear), linear);
        }
    }

    #[test]
    fn a_thread_words_a_kind_until_it_is_done() {
        assert_eq!(unit("N s/m"), "N s/m");
        assert_eq!(worded(Kind::Rotary, || unit("N s/m")), "N m s/rad");
        assert_eq!(unit("N s/m"), "N s/m");
    }
}
