//! Lost motion in a drive: play in front of whatever restores in the load path.

use super::row::effect;

effect! {
    /// Play between the motor and what restores in the load path: a cable, a friction that sticks elastically
    /// before it slides, Bouc and Wen's loop. A flank only pushes, so that between the flanks there is no force.
    DriveBacklash = "drive_backlash" {
        /// w (m), the whole play
        width_m = "width", Metre, Positive, Shape, Logarithmic(Times(4.0, PositionNoise), Times(0.6, Travel));
    }
    stage: LoadPath, sign: OneWay, proportional: false, several: false, repeats: Never, timed: false,
    laws: AnyLaw, needs_derivative: false, family: Alone, simpler: None, is_physical: |_| true,
    example: [2e-4, 0.0, 0.0, 0.0, 0.0], starts: &[Starts::at(&[
        Each(&[Times(0.01, Travel), Times(0.03, Travel), Times(0.1, Travel), Times(0.2, Travel)]),
    ])],
    law: "x_d = x ∓ w/2 on a flank that pushes; no force between the flanks",
    signature: "a flat gap without force after each reversal, without a contact",
    motion: "reversals in free motion, longer than the play",
}
