//! Rigs with hidden effects, and the score of `palpate gap` on them. Nobody who has to find an effect
//! has written the rig that hides it: [`rig`] shares no code with the project, and a test reads its
//! sources for that. Only [`score`] knows both sides.

pub mod rig;
pub mod score;
