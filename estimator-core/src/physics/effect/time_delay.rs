//! A force that belongs to an earlier position, or a later one.

use super::row::effect;

effect! {
    /// The delayed force F(t − T_d).
    TimeDelay = "time_delay" {
        /// T_d (s), negative if the position is late
        delay_s = "delay", Second, Any, Size, Linear(Part(Duration, -40.0), Part(Duration, 40.0));
    }
    stage: ForceReading, sign: Either, proportional: true, several: false, repeats: Never, timed: false,
    laws: AnyLaw, needs_derivative: false, family: Lateness, simpler: None, is_physical: |_| true,
    example: [8e-3, 0.0, 0.0, 0.0, 0.0], starts: &[Starts::at(&[Each(&[Times(1.0, Period), Times(6.0, Period), Times(-6.0, Period)])])],
    law: "F(t − T_d)",
    signature: "a pure shift between the channels",
    motion: "fast strokes, and a step",
}
