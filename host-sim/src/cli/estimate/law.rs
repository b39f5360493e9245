//! `--law` on the command line.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use estimator_core::physics::law::LawId;

/// The law on the command line; `None` takes the one that explains the force best.
pub(super) type LawChoice = Option<LawId>;

pub(super) const AUTO: &str = "auto";

pub(super) fn law_choice() -> impl TypedValueParser<Value = LawChoice> {
    let auto = PossibleValue::new(AUTO).help("The one that explains the force best");
    let touched = LawId::ALL.iter().filter(|law| **law != LawId::Free);
    let laws = touched.map(|law| {
        let value = PossibleValue::new(law.name()).help(law.info().summary);
        value.aliases(law.info().alias)
    });
    PossibleValuesParser::new(std::iter::once(auto).chain(laws)).map(|name| LawId::from_name(&name))
}
