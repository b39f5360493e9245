//! `--method` on the command line: the core's table of methods, and the fit of a whole log.

use std::sync::LazyLock;

use clap::ValueEnum;
use clap::builder::PossibleValue;
use estimator_core::estimate::identify::{self, method_info};
use estimator_core::estimate::method::{Method, MethodInfo, Offer};

use super::law::LawChoice;
use crate::diagnostic::Diagnostic;

/// A method by its name on the command line, which methods for different laws may share.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MethodChoice(&'static str);

impl MethodChoice {
    /// The whole log at once.
    pub const BATCH: Self = MethodChoice("batch");

    /// The name of a method.
    pub(super) fn of(method: Method) -> Self {
        MethodChoice(method_info(method).map_or("", |info| info.name))
    }

    pub(super) fn name(self) -> &'static str {
        self.0
    }

    fn rows(self) -> impl Iterator<Item = &'static MethodInfo> {
        rows().into_iter().filter(move |row| row.name == self.0)
    }
}

impl ValueEnum for MethodChoice {
    fn value_variants<'a>() -> &'a [Self] {
        static ALL: LazyLock<Vec<MethodChoice>> = LazyLock::new(|| {
            let names = identify::methods().map(|row| MethodChoice(row.name));
            distinct(names.chain([MethodChoice::BATCH]))
        });
        &ALL
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        let value = PossibleValue::new(self.0);
        let Some(first) = self.rows().next() else {
            return Some(value.help("The whole log at once (every law)"));
        };
        let laws = distinct(self.rows().map(law_of)).join(", ");
        let hidden = first.offer == Offer::Unlisted;
        Some(value.help(format!("{} ({laws})", first.about)).hide(hidden))
    }
}

/// The core's methods, the simplest law first, and what chooses the law itself last.
fn rows() -> Vec<&'static MethodInfo> {
    let mut rows: Vec<_> = identify::methods().collect();
    rows.sort_by_key(|row| (row.offer == Offer::ChoosesLaw, row.law.code()));
    rows
}

/// The `--law` that a method goes with.
fn law_of(row: &MethodInfo) -> &'static str {
    match row.offer {
        Offer::ChoosesLaw => "auto",
        _ => row.law.name(),
    }
}

/// Each value once, where it stands first.
fn distinct<T: PartialEq>(values: impl IntoIterator<Item = T>) -> Vec<T> {
    let mut kept = Vec::new();
    for value in values {
        if !kept.contains(&value) {
            kept.push(value);
        }
    }
    kept
}

/// The methods that a choice of law and method leaves, simplest law first.
pub(super) fn methods(
    law: LawChoice,
    method: Option<MethodChoice>,
) -> Result<Vec<Method>, Diagnostic> {
    let has_law = |row: &MethodInfo| law.is_none_or(|law| law_of(row) == law.name());
    let is_wanted = |row: &MethodInfo| match method {
        Some(method) => row.name == method.0,
        None => row.offer == Offer::Default,
    };
    let left: Vec<Method> = rows()
        .into_iter()
        .filter(|row| has_law(row) && is_wanted(row))
        .map(|row| row.method)
        .collect();
    if left.is_empty() {
        return Err(Diagnostic::new("this method does not estimate this law")
            .value(method.map_or("", MethodChoice::name))
            .remedy(pairs()));
    }
    Ok(left)
}

/// Which methods go with which law.
fn pairs() -> String {
    let mut text = String::new();
    for law in distinct(rows().into_iter().map(law_of)) {
        let of_law = rows().into_iter().filter(|row| law_of(row) == law);
        let mut names = distinct(of_law.map(|row| row.name));
        let last = names.pop().unwrap_or_default();
        let (and, go) = (
            if names.is_empty() { "" } else { " and " },
            if text.is_empty() { "go " } else { "" },
        );
        text.push_str(&format!("{}{and}{last} {go}with {law}, ", names.join(", ")));
    }
    text + "batch with every law; or leave --method out"
}

#[cfg(test)]
mod tests {
    use super::*;
    use estimator_core::physics::law::LawId;

    #[test]
    fn a_method_that_does_not_go_with_the_law_is_refused_with_a_remedy() {
        let error = methods(Some(LawId::KelvinVoigt), Some(MethodChoice("two_stage"))).unwrap_err();
        assert!(
            error.to_string().contains("go with kelvin_voigt"),
            "{error}"
        );
    }

    #[test]
    fn auto_tries_every_law_the_simplest_first() {
        let all = methods(None, None).unwrap();
        let simplest_first = [
            Method::KELVIN_VOIGT_SURFACE,
            Method::HUNT_CROSSLEY_BANK,
            Method::ZENER_ARX,
            Method::HAMMERSTEIN_CASCADE,
            Method::QUASI_LINEAR_BANK,
            Method::HAMMERSTEIN_CASCADE_2,
            Method::QUASI_LINEAR_BANK_2,
        ];
        assert_eq!(all, simplest_first);
    }
}
