//! Rigs with hidden effects, and the score of `palpate gap` on them. A rig that was built
//! with the project's physics would hide what the project finds best. So [`rig`] shares no code with the
//! project, which a test reads from its sources; only [`score`] knows both sides.
//!
//! A threshold of the workflow is data, and [`score::sweep`] says what it is worth: all rigs at −25 %, as it
//! is, and at +25 %, in a table of right, open and wrong answers and false alarms, and below it the rigs that
//! are answered in another way. `cargo run --release -p tests --example hidden -- sweep` lists the thresholds.
//! A value that was chosen on some seeds is scored on others.

pub mod rig;
pub mod score;
