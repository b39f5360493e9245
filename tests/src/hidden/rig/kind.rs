//! The kinds of cases, and which effects they hide.

use super::draw::CATALOGUE;
use super::draw::foreign::FORMS;
use super::draw::machine::MACHINE;
use super::motion::Profile;
use super::random::Random;

/// The effects that a slow sine is known to confuse.
const POOR: [&str; 9] = [
    "force_lag",
    "time_delay",
    "series_compliance",
    "stress_relaxation",
    "viscous_drag",
    "hysteretic_damping",
    "backlash",
    "coulomb_friction",
    "cable_stiffness",
];

/// What kind of answer a case asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// One effect in the catalogue's form.
    Single,
    /// One effect in a form other than the catalogue's.
    Mismatched,
    /// Two effects in the catalogue's form.
    Pair,
    /// Three effects in the catalogue's form.
    Triple,
    /// No effect.
    None,
    /// A misfit that is in no catalogue.
    Unknown,
    /// One effect under one slow sine, which is poor excitation.
    Poor,
    /// One effect that the best fit of the base nearly hides: it leaves 1.1 to 1.5 floors.
    Weak,
    /// Two effects in other forms.
    PairMismatched,
    /// One effect in a form that is foreign to the catalogue.
    Foreign,
    /// One of the effects that measured machines asked for, in the catalogue's form.
    Machine,
    /// One of those in another form.
    MachineMismatched,
}

impl Kind {
    /// Every kind with its name in truth.json.
    pub const ALL: [(Kind, &'static str); 12] = [
        (Kind::Single, "single"),
        (Kind::Mismatched, "mismatched"),
        (Kind::Pair, "pair"),
        (Kind::Triple, "triple"),
        (Kind::None, "none"),
        (Kind::Unknown, "unknown"),
        (Kind::Poor, "poor"),
        (Kind::Weak, "weak"),
        (Kind::PairMismatched, "pair_mismatched"),
        (Kind::Foreign, "foreign"),
        (Kind::Machine, "machine"),
        (Kind::MachineMismatched, "machine_mismatched"),
    ];

    /// The name in truth.json.
    pub fn name(self) -> &'static str {
        Kind::ALL
            .iter()
            .find(|(kind, _)| *kind == self)
            .map_or("", |(_, name)| name)
    }

    /// Draws the motion.
    pub(super) fn profile(self, random: &mut Random) -> Profile {
        match (self, random.unit()) {
            (Kind::Poor, _) => Profile::Slow,
            // Many touches: after a few, an offset or a drift could stand for what changes at each.
            (Kind::Unknown, _) => Profile::Mixed,
            (_, u) if u < 0.5 => Profile::Mixed,
            (_, u) if u < 0.75 => Profile::Steps,
            _ => Profile::Sines,
        }
    }

    /// Draws the gap ratio that each effect is to make by itself.
    pub(super) fn wanted(self, random: &mut Random) -> f64 {
        match self {
            Kind::Single | Kind::Machine => random.log_between(1.7, 20.0),
            Kind::Mismatched | Kind::PairMismatched | Kind::MachineMismatched | Kind::Poor => {
                random.log_between(1.7, 6.0)
            }
            Kind::Foreign => random.log_between(2.0, 12.0),
            Kind::Weak => random.between(1.15, 1.45),
            _ => random.log_between(2.0, 8.0),
        }
    }
}

/// The first of a case's random streams.
pub(super) fn stream(kind: Kind, index: u64) -> u64 {
    (index << 16) + kind as u64 * 1000
}

/// The ids of the effects that a case hides; the index runs through the catalogue.
pub(super) fn ids(kind: Kind, index: u64, random: &mut Random) -> Vec<&'static str> {
    let index = index as usize;
    match kind {
        Kind::Single | Kind::Mismatched | Kind::Weak => vec![CATALOGUE[index % CATALOGUE.len()]],
        Kind::Machine | Kind::MachineMismatched => vec![MACHINE[index % MACHINE.len()]],
        Kind::Foreign => vec![FORMS[index % FORMS.len()].0],
        Kind::Poor => vec![POOR[index % POOR.len()]],
        Kind::None | Kind::Unknown => Vec::new(),
        Kind::Pair | Kind::PairMismatched | Kind::Triple => {
            let count = if kind == Kind::Triple { 3 } else { 2 };
            let mut ids = vec![CATALOGUE[index % CATALOGUE.len()]];
            while ids.len() < count {
                let next = *random.pick(CATALOGUE);
                if ids.iter().all(|id| compatible(id, next)) {
                    ids.push(next);
                }
            }
            ids
        }
    }
}

/// Whether two effects make a pair: the sum of two of one family is nearly one of them again.
fn compatible(a: &str, b: &str) -> bool {
    const FAMILIES: [&[&str]; 6] = [
        &["coulomb_friction", "stribeck_friction"],
        &["force_lag", "time_delay"],
        &[
            "power_law_stiffness",
            "exponential_stiffening",
            "buried_layer",
        ],
        &["permanent_set", "cyclic_softening"],
        &["force_offset", "force_drift"],
        &["viscous_drag", "asymmetric_drag"],
    ];
    a != b
        && !FAMILIES
            .iter()
            .any(|family| family.contains(&a) && family.contains(&b))
}
