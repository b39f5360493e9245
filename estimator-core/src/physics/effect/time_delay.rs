//! A force that belongs to an earlier position, or a later one.

use super::effect;

effect! {
    /// F(t − T_d)
    TimeDelay = "time_delay", ForceReading {
        /// T_d (s), negative if the position is late
        delay_s = "delay", Second, Any;
    }
    law: "F(t − T_d)",
    signature: "a pure shift between the channels",
    motion: "fast strokes, and a step",
}
