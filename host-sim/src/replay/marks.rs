//! What a replay of a log has in it to point at: touches and events.

use std::collections::BTreeMap;

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

impl EventMark {
    /// Whether it is the recursion's opinion about the material.
    pub fn is_material_change(&self) -> bool {
        self.kind == EventKind::Estimator(Event::MaterialChange)
    }

    /// Whether it is a fault.
    pub fn is_fault(&self) -> bool {
        matches!(self.kind, EventKind::Fault { .. })
    }
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

/// How often one fault began.
#[derive(Clone, Debug, PartialEq)]
pub struct FaultTally {
    /// The stable number.
    pub code: u8,
    /// For people.
    pub description: String,
    /// How many times.
    pub count: usize,
    /// When it began first and last (s).
    pub between_s: (f64, f64),
}

/// The faults among events, one tally for each, since a log may have a fault in every sample.
pub fn fault_tallies<'a>(events: impl IntoIterator<Item = &'a EventMark>) -> Vec<FaultTally> {
    let mut tallies: BTreeMap<u8, FaultTally> = BTreeMap::new();
    for event in events {
        let EventKind::Fault { code, description } = &event.kind else {
            continue;
        };
        let first = || FaultTally {
            code: *code,
            description: description.clone(),
            count: 0,
            between_s: (event.time_s, event.time_s),
        };
        let tally = tallies.entry(*code).or_insert_with(first);
        tally.count += 1;
        tally.between_s.1 = event.time_s;
    }
    tallies.into_values().collect()
}
