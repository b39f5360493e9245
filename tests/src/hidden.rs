//! Rigs with hidden effects, and the score of `palpate gap` on them. A rig that was built
//! with the project's physics would hide what the project finds best. So [`rig`] shares no code with the
//! project, which a test reads from its sources; only [`score`] knows both sides.

pub mod rig;
pub mod score;
