//! A damper that grows with the depth.

use super::row::effect;

effect! {
    /// The damping of a linear law becomes λ(δ/δ₀)^q δ̇.
    DepthDependentDamping = "depth_dependent_damping" {
        /// q
        exponent = "exponent", One, Positive, Shape, FitRange::up_to(Number(4.0));
    }
    stage: Contact, sign: OneWay, proportional: false, several: false, repeats: Never, timed: false,
    laws: LinearDamping, needs_derivative: false, family: Alone, simpler: None, is_physical: |_| true,
    example: [0.8, 0.0, 0.0, 0.0, 0.0], starts: &[Starts::at(&[Each(&[Number(0.3), Number(0.8), Number(1.5)])])],
    law: "λδ̇ → λ(δ/δ₀)^q δ̇",
    signature: "the loop closes at δ → 0; a force jump at touch and pull-off where the law has one",
    motion: "touch and leave at speed",
}
