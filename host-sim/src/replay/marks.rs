//! What a replay of a log has in it to point at: touches and events.

use estimator_core::estimate::Event;

/// One touch, in figures that no model is needed for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Touch {
    /// From (s).
    pub from_s: f64,
    /// To (s).
    pub to_s: f64,
    /// Largest force (N).
    pub peak_force_n: f64,
    /// Largest depth (m).
    pub peak_depth_m: f64,
    /// Largest force over the depth there (N/m), both since the force left its baseline; `None` where the
    /// log does not show that.
    pub secant_stiffness: Option<f64>,
    /// Work that the probe did and did not get back (J); `None` of a touch that the log cuts off.
    pub dissipated_j: Option<f64>,
    /// Share of the force at the start of the longest hold that is left at its end; `None` without a hold.
    pub relaxation_ratio: Option<f64>,
}

/// Something that happened.
#[derive(Clone, Debug, PartialEq)]
pub struct EventMark {
    /// When (s).
    pub time_s: f64,
    /// What.
    pub kind: EventKind,
}

/// What can happen.
#[derive(Clone, Debug, PartialEq)]
pub enum EventKind {
    /// An event of the estimator.
    Estimator(Event),
    /// A fault, by its number and in words.
    Fault {
        /// The stable number.
        code: u8,
        /// For people.
        description: String,
    },
}
