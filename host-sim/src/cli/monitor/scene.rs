//! What the screen shows: the last seconds of every channel, events, and the state of the link.
//!
//! Channels are kept in slots of equal time, each with the least and the greatest of its samples, so that no peak is
//! lost however wide the screen is.

use std::collections::VecDeque;

use estimator_core::board::frame::Frame;
use estimator_core::estimate::{Event, Phase};
use estimator_core::physics::law::ParameterInfo;
use estimator_core::{Estimate, Faults};

use super::view::View;

/// The time that the strips show (s).
pub(super) const SHOWN_S: f64 = 20.0;
/// Slots of that time: twice the dots of a terminal 200 wide.
const SLOTS: f64 = 800.0;
/// Points of the loop: a touch of 2 s at a fifth of the samples.
const LOOP: usize = 800;
const LOOP_EVERY: u64 = 5;
/// The most events that are kept.
const EVENTS: usize = 40;

/// A channel over the time that is shown.
#[derive(Debug, Default)]
pub(super) struct Strip {
    slots: VecDeque<(f64, f64, f64)>,
}

impl Strip {
    fn push(&mut self, time_s: f64, value: f64) {
        let slot_s = SHOWN_S / SLOTS;
        match self.slots.back_mut() {
            Some((from, low, high)) if time_s - *from < slot_s && time_s >= *from => {
                *low = low.min(value);
                *high = high.max(value);
            }
            _ => self.slots.push_back((time_s, value, value)),
        }
        while self
            .slots
            .front()
            .is_some_and(|(from, ..)| time_s - from > SHOWN_S)
        {
            self.slots.pop_front();
        }
    }

    /// A line through the least and the greatest value of every slot.
    pub(super) fn points(&self) -> Vec<(f64, f64)> {
        let both = self
            .slots
            .iter()
            .flat_map(|(at, low, high)| [(*at, *low), (*at, *high)]);
        both.collect()
    }
}

/// A parameter over the time that is shown.
#[derive(Debug)]
pub(super) struct Trend {
    pub(super) info: &'static ParameterInfo,
    /// Times (s), values and standard errors.
    pub(super) points: VecDeque<(f64, f64, f64)>,
}

impl Trend {
    fn push(&mut self, time_s: f64, value: f64, std_error: f64) {
        let slot_s = SHOWN_S / SLOTS;
        if self
            .points
            .back()
            .is_none_or(|(last, ..)| time_s - last >= slot_s)
        {
            self.points.push_back((time_s, value, std_error));
        }
        while self
            .points
            .front()
            .is_some_and(|(at, ..)| time_s - at > SHOWN_S)
        {
            self.points.pop_front();
        }
    }
}

/// Something that happened.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Happened {
    pub(super) time_s: f64,
    pub(super) what: String,
    /// Whether it is a fault.
    pub(super) is_fault: bool,
}

/// What is on the screen.
#[derive(Debug, Default)]
pub(super) struct Scene {
    pub(super) name: String,
    pub(super) view: View,
    pub(super) time_s: f64,
    pub(super) force: Strip,
    pub(super) depth: Strip,
    pub(super) trends: Vec<Trend>,
    /// Depth (m) and force (N) of the touches shown last.
    pub(super) path: VecDeque<(f64, f64)>,
    pub(super) events: VecDeque<Happened>,
    pub(super) faults: Faults,
    pub(super) marks: usize,
    pub(super) is_paused: bool,
    pub(super) has_ended: bool,
    /// Since when a recording runs (s), and where it goes.
    pub(super) recording: Option<(f64, String)>,
    /// The last answer to a key.
    pub(super) said: String,
    samples: u64,
}

impl Scene {
    pub(super) fn new(name: &str) -> Scene {
        Scene {
            name: name.into(),
            ..Scene::default()
        }
    }

    /// Takes a frame; whether it is time to draw.
    pub(super) fn take(&mut self, frame: &Frame, every_us: u64) -> bool {
        if let Frame::Estimate(estimate) = frame {
            self.estimate(estimate);
        }
        self.view.take(frame, every_us)
    }

    fn estimate(&mut self, estimate: &Estimate<f32>) {
        let time_s = estimate.time_us as f64 * 1e-6;
        // A board that was reset starts its time anew.
        if time_s < self.time_s {
            (self.force, self.depth) = (Strip::default(), Strip::default());
            self.trends.clear();
            self.happened(time_s, "the board restarted".into(), false);
        }
        self.time_s = time_s;
        let (force_n, depth_m) = (f64::from(estimate.force_n), f64::from(estimate.depth_m));
        self.force.push(time_s, force_n);
        self.depth.push(time_s, depth_m);
        self.samples += 1;
        if estimate.phase == Phase::Contact && self.samples.is_multiple_of(LOOP_EVERY) {
            self.path.push_back((depth_m, force_n));
            if self.path.len() > LOOP {
                self.path.pop_front();
            }
        }
        self.parameters(estimate);
        if let Some(event) = estimate.event {
            let what = match event {
                Event::Contact => "contact",
                Event::Release => "release",
                Event::MaterialChange => "material change",
            };
            self.happened(time_s, what.into(), false);
        }
        let known = self.faults;
        for fault in estimate.faults.iter().filter(|fault| !known.has(*fault)) {
            let what = format!("fault {}: {}", fault.code(), fault.describe());
            self.happened(time_s, what, true);
        }
        self.faults = estimate.faults;
        while self.events.len() > EVENTS {
            self.events.pop_front();
        }
    }

    fn parameters(&mut self, estimate: &Estimate<f32>) {
        let infos = estimate.law.parameters();
        let is_other = self.trends.len() != infos.len()
            || self
                .trends
                .iter()
                .zip(infos)
                .any(|(own, info)| own.info.name != info.name);
        if is_other {
            let empty = |info| Trend {
                info,
                points: VecDeque::new(),
            };
            self.trends = infos.iter().map(empty).collect();
        }
        let time_s = self.time_s;
        for (trend, slot) in self.trends.iter_mut().zip(estimate.parameters) {
            if let Some(own) = slot {
                trend.push(time_s, own.value.into(), own.std_error.into());
            }
        }
    }

    fn happened(&mut self, time_s: f64, what: String, is_fault: bool) {
        self.events.push_back(Happened {
            time_s,
            what,
            is_fault,
        });
    }

    /// Marks the present instant.
    pub(super) fn mark(&mut self) {
        self.marks += 1;
        self.happened(self.time_s, format!("mark {}", self.marks), false);
    }
}
