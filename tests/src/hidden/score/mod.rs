//! Scores `palpate gap` against what was really hidden; nothing else reads truth.json.

pub mod answer;
pub mod further;
pub mod injected;
pub mod judge;
pub mod library;
pub mod process;
pub mod records;
pub mod run;
pub mod scored;
pub mod share;
pub mod sweep;
pub mod table;
pub mod truth;
