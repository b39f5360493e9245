//! Scores `palpate gap` against what was really hidden; the only reader of truth.json.

pub(crate) mod answer;
pub(crate) mod confusion;
pub(crate) mod further;
pub(crate) mod judge;
pub(crate) mod library;
pub(crate) mod process;
pub(crate) mod run;
pub(crate) mod share;
pub(crate) mod table;
pub(crate) mod truth;
