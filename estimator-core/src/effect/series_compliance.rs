//! A rig that gives way: a spring between the motor and the tip.

use super::effect;

effect! {
    /// tip = x − F_contact/k_s
    SeriesCompliance = "series_compliance", Transmission {
        /// k_s (N/m)
        stiffness_n_per_m = "stiffness", NewtonPerMetre, Positive;
    }
    law: "tip = x − F_contact/k_s",
    signature: "a softer and less damped contact at high force; couples force into depth",
    motion: "fast and slow strokes of the same depth",
}
