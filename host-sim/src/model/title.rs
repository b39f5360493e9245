//! The laws as people call them.

use estimator_core::physics::law::LawId;

/// Name of a law for people.
pub fn law_title(name: &str) -> String {
    match LawId::from_name(name) {
        Some(law) => law.info().title.into(),
        None => name.replace('_', " "),
    }
}
