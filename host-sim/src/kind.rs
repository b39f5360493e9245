//! Machines that move along a line, and machines that turn.
//!
//! Everything is computed in the same numbers; what they are called differs. A position is an angle in rad
//! where a machine turns, a force a torque in N m, and every unit that is made of them follows. The kind
//! is known where results are worded, on the thread that words them ([`worded`]), as a language is: a
//! function that prints a stiffness need not be told it.

use std::cell::Cell;

use estimator_core::physics::effect::{EffectId, Repeats};

use crate::diagnostic::Diagnostic;
use crate::log::UniformLog;

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
const UNITS: [(&str, &str); 17] = [
    ("m", "rad"),
    ("N", "N m"),
    ("N/m", "N m/rad"),
    ("N s/m", "N m s/rad"),
    ("N·s/m", "N·m·s/rad"),
    ("N s²/m²", "N m s²/rad²"),
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

    /// `metres` or `radians`.
    pub const fn position_words(self) -> &'static str {
        match self {
            Kind::Linear => "metres",
            Kind::Rotary => "radians",
        }
    }

    /// `newtons` or `newton metres`.
    pub const fn force_words(self) -> &'static str {
        match self {
            Kind::Linear => "newtons",
            Kind::Rotary => "newton metres",
        }
    }

    /// Whether a machine of this kind can have an effect.
    pub fn can_have(self, id: EffectId) -> bool {
        self == Kind::Rotary || id.info().repeats != Repeats::EveryTurn
    }

    /// The kind of a machine of which a model may say one and logs may show one; along a line if nobody
    /// does.
    ///
    /// # Errors
    /// A model and a log, or two logs, of different kinds.
    pub fn agreed(model: Option<Kind>, logs: &[UniformLog]) -> Result<Kind, Diagnostic> {
        let mut agreed = model;
        for log in logs {
            match (agreed, log.kind) {
                (Some(one), Some(other)) if one != other => {
                    return Err(other.contradicts(one, log, model.is_some()));
                }
                (None, kind) => agreed = kind,
                _ => {}
            }
        }
        Ok(agreed.unwrap_or_default())
    }

    fn contradicts(self, one: Kind, log: &UniformLog, is_model: bool) -> Diagnostic {
        let who = if is_model {
            "the model says"
        } else {
            "the first log has"
        };
        Diagnostic::new(format!(
            "the log has positions in {} and forces in {}, and {who} {} and {}",
            self.unit("m"),
            self.unit("N"),
            one.unit("m"),
            one.unit("N"),
        ))
        .in_file(&log.path)
        .value(self.name())
        .remedy(match is_model {
            true => format!("write kind = \"{}\" at the top of the model, or give the columns (--columns x=NAME,f=NAME)", self.name()),
            false => "give logs of one machine, or the columns that belong together (--columns x=NAME,f=NAME)".into(),
        })
    }
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

    #[test]
    fn a_model_and_a_log_of_two_kinds_are_an_error() {
        let log = |kind| UniformLog {
            kind,
            ..UniformLog::default()
        };
        let (turns, unknown) = (log(Some(Kind::Rotary)), log(None));
        assert_eq!(
            Kind::agreed(None, &[unknown.clone(), turns.clone()]),
            Ok(Kind::Rotary)
        );
        assert_eq!(
            Kind::agreed(Some(Kind::Rotary), &[unknown]),
            Ok(Kind::Rotary)
        );
        let error = Kind::agreed(Some(Kind::Linear), &[turns]).unwrap_err();
        assert!(error.to_string().contains("rad"), "{error}");
    }
}
