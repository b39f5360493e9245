//! What is known of a board between two looks, and a line of it for a pipe.

use estimator_core::board::frame::Frame;
use estimator_core::board::link::Health;
use estimator_core::board::reflection::{Limit, Packet, Rendered};
use estimator_core::estimate::Phase;
use estimator_core::{Estimate, Fault, Faults, Status};

use crate::link::device::Statistics;
use crate::number::{Measured, quantity};

/// What is known.
#[derive(Debug, Default)]
pub(super) struct View {
    pub(super) estimate: Option<Estimate<f32>>,
    pub(super) health: Option<Health>,
    looked_us: Option<u64>,
    /// Stamp of the newest sample, and how much older its estimate's is (µs): the delay of filter and
    /// compensation.
    sampled_us: u64,
    pub(super) late_us: u64,
    samples: u64,
    pub(super) rate_hz: f64,
    /// Faults since the last look: one of a single sample must not be missed.
    faults: Faults,
    /// The last impedance for the other side, and how many came since the last look; its rate (Hz).
    packet: Option<Packet>,
    packets: u64,
    packet_hz: f64,
    rendered: Option<Rendered>,
}

impl View {
    /// Takes a frame; whether it is time to look.
    pub(super) fn take(&mut self, frame: &Frame, every_us: u64) -> bool {
        match frame {
            Frame::Health(health) => self.health = Some(*health),
            Frame::Sample(sample) => {
                self.samples += 1;
                self.sampled_us = sample.time_us;
            }
            Frame::Estimate(estimate) => {
                self.late_us = self.sampled_us.saturating_sub(estimate.time_us);
                self.estimate = Some(*estimate);
                self.faults = self.faults | estimate.faults;
                return self.is_due(estimate.time_us, every_us);
            }
            Frame::Reflection(packet) => {
                self.packet = Some(*packet);
                self.packets += 1;
            }
            Frame::Rendered(rendered) => {
                self.rendered = Some(*rendered);
                self.faults = self.faults | rendered.faults;
            }
            // A device gives a record as its parts.
            Frame::Record(_) | Frame::Codes(_) | Frame::Command(_) | Frame::Reply(_) => {}
        }
        false
    }

    fn is_due(&mut self, now_us: u64, every_us: u64) -> bool {
        let last = *self.looked_us.get_or_insert(now_us);
        // A board that was reset starts its time anew.
        let elapsed = now_us.checked_sub(last).unwrap_or(every_us);
        if elapsed < every_us {
            return false;
        }
        self.rate_hz = self.samples as f64 * 1e6 / elapsed as f64;
        self.packet_hz = self.packets as f64 * 1e6 / elapsed as f64;
        (self.looked_us, self.samples, self.packets) = (Some(now_us), 0, 0);
        true
    }

    /// For a pipe.
    pub(super) fn line(&mut self, statistics: &Statistics) -> String {
        let Some(estimate) = self.estimate else {
            return String::new();
        };
        let mut text = format!(
            "{:9.3} s  {}  F {}  depth {}  {}",
            estimate.time_us as f64 * 1e-6,
            phase(estimate.phase),
            quantity(f64::from(estimate.force_n), 3, "N"),
            quantity(f64::from(estimate.depth_m), 3, "m"),
            estimate.status.name(),
        );
        for (name, value) in parameters(&estimate) {
            text.push_str(&format!("  {name} {value}"));
        }
        for said in self.teleoperation().into_iter().flatten() {
            text.push_str(&format!("  {said}"));
        }
        for fault in self.seen(&estimate).iter() {
            text.push_str(&format!("  fault {} ({})", fault.code(), fault.describe()));
        }
        text.push_str(&format!("  lost {}\n", statistics.lost));
        text
    }

    /// What goes to the other side, and what is rendered of what comes from there.
    pub(super) fn teleoperation(&self) -> [Option<String>; 2] {
        let reflects = self.packet.map(|packet| {
            let what = packet.status.name();
            format!("reflects   {:.0} Hz, {what}", self.packet_hz)
        });
        let renders = self.rendered.map(|rendered| {
            let force = quantity(f64::from(rendered.force_n), 3, "N");
            let limits = Limit::ALL.into_iter().filter(|limit| rendered.has(*limit));
            let limits: Vec<_> = limits.map(Limit::name).collect();
            match limits.is_empty() {
                true => format!("renders    {force}"),
                false => format!("renders    {force} ({})", limits.join(", ")),
            }
        });
        [reflects, renders]
    }

    /// Faults since the last look, and the estimator's doubts.
    fn seen(&mut self, estimate: &Estimate<f32>) -> Faults {
        let seen = std::mem::take(&mut self.faults);
        match estimate.status {
            Status::ModelSuspect => seen.with(Fault::EstimatorSuspect),
            _ => seen,
        }
    }
}

/// The parameters of the law by name; those that are not observable as such.
pub(super) fn parameters(estimate: &Estimate<f32>) -> impl Iterator<Item = (&'static str, String)> {
    let slots = estimate.parameters;
    let infos = estimate.law.parameters().iter();
    infos.zip(slots).map(|(info, slot)| {
        let text = match slot {
            Some(p) => {
                let error = Some(f64::from(p.std_error));
                Measured::new(f64::from(p.value), error, info.unit.symbol()).to_string()
            }
            None => "–".to_string(),
        };
        (info.name, text)
    })
}

pub(super) fn phase(phase: Phase) -> &'static str {
    match phase {
        Phase::Settling => "settling",
        Phase::Free => "free    ",
        Phase::Contact => "contact ",
    }
}
