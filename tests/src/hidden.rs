//! Rigs with hidden effects, and the score of `palpate gap` on them. A rig that was built
//! with the project's physics would hide what the project finds best. So [`rig`] shares no code with the
//! project, which a test reads from its sources; only [`score`] knows both sides.
//!
//! A threshold of the workflow is data, and [`score::sweep`] says what it is worth: all rigs at −25 %, as it
//! is, and at +25 %, in a table of right, open and wrong answers and false alarms, and below it the rigs that
//! are answered in another way. `cargo run --release -p tests --example hidden -- sweep` lists the thresholds.
//! A value that was chosen on some seeds is scored on others.

//!
//! Two further tables ask about the world as it is:
//!
//! - `… --example hidden -- hard --rigs 10 --seed 5`: harder rigs, with sensors and sampling as they are on a
//!   bench ([`rig::harder`]), forms that the catalogue lacks and nineteen misfits that are in none, by group;
//!   `--only none,unknown` draws some groups, and `hard DIR` scores rigs that are there already, also those
//!   of others.
//! - `… --example hidden -- injected --sizes 1,2,5`: effects put into measured records ([`rig::inject`]). The
//!   model that `gap` finds on the clean record is its owner's; what that leaves is the remainder; an effect
//!   that changes the force by so many remainders (rms) has to be named, and nothing but it, and on the clean
//!   record nothing. `--records DIR` adds records whose licence keeps them out of the repository.

pub mod rig;
pub mod score;
