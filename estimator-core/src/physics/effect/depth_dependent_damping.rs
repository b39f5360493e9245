//! A damper that grows with the depth.

use super::effect;

effect! {
    /// The damping of a linear law becomes λ(δ/δ₀)^q δ̇.
    DepthDependentDamping = "depth_dependent_damping", Contact {
        /// q
        exponent = "exponent", One, Positive;
    }
    law: "λδ̇ → λ(δ/δ₀)^q δ̇",
    signature: "the loop closes at δ → 0; a force jump at touch and pull-off where the law has one",
    motion: "touch and leave at speed",
}
