//! Frames out, and a log line for whatever a person would want to see. Low priority: may be late,
//! may not be wrong.

use crate::board::{Board, Link, Selected};
use embedded_hal::digital::OutputPin;
use estimator_core::board::budget::Meter;
use estimator_core::estimate::{Event, Phase};
use estimator_core::board::frame::{self, Frame, MAX_ENCODED, RECORD_ENCODED};
use estimator_core::board::sampling::Record;
use estimator_core::{Estimate, Fault, Faults, Status};

/// Records that wait for the link: 64 ms of it. Codes, sample and estimate are at most 180 bytes
/// together (frame.rs), of the 200 that 2 Mbaud carry in a millisecond.
pub const QUEUE: usize = 64;

/// Telemetry over a link, with a light.
pub struct Telemetry<L, P> {
    link: L,
    light: P,
    sequence: u16,
    /// What a record costs to encode and queue, in the board's unit.
    pub encode: Meter,
    last: Option<Estimate<f32>>,
    last_in_contact: Option<Estimate<f32>>,
    /// What is wrong with rendering.
    rendering: Faults,
}

impl<L: Link, P: OutputPin> Telemetry<L, P> {
    /// Nothing sent yet.
    pub fn new(link: L, light: P) -> Self {
        Telemetry {
            link,
            light,
            sequence: 0,
            encode: Meter::new(),
            last: None,
            last_in_contact: None,
            rendering: Faults::NONE,
        }
    }

    /// Whether the frames of one record fit into the link. Where they do not, the queue fills and
    /// the sampling task counts the drops: they are counted in one place.
    pub fn has_room(&self) -> bool {
        self.link.room() >= RECORD_ENCODED
    }

    /// Sends the frames of a record and logs what happened in it.
    pub fn send(&mut self, record: &Record) {
        let start = Selected::now();
        if record.due.shown {
            if let Some(codes) = record.codes {
                self.send_frame(&Frame::Codes(codes));
            }
            self.send_frame(&Frame::Sample(record.sample));
            self.send_frame(&Frame::Estimate(record.estimate));
            if let Some(rendered) = record.rendered {
                self.send_frame(&Frame::Rendered(rendered));
            }
        }
        if let Some(packet) = record.packet() {
            self.send_frame(&Frame::Reflection(packet));
        }
        self.encode.record(Selected::now().wrapping_sub(start));
        self.log_changes(&record.estimate);
        self.show(&record.estimate);
        self.last = Some(record.estimate);
        self.rendering = record.rendered.map_or(Faults::NONE, |of| of.faults);
        if record.estimate.phase == Phase::Contact {
            self.last_in_contact = self.last;
        }
    }

    /// Lets the link work.
    pub fn poll(&mut self) {
        self.link.poll();
    }

    /// The last words of a finite run.
    pub fn finish(&mut self) {
        match &self.last_in_contact {
            Some(estimate) => log_estimate("final estimate", estimate),
            None => defmt::info!("final estimate: nothing was touched"),
        }
        self.link.finish();
    }

    /// The next byte from the host.
    pub fn receive(&mut self) -> Option<u8> {
        self.link.receive()
    }

    /// Where the probe is; before the first sample, as if it were in free air.
    pub fn phase(&self) -> Phase {
        self.last.map_or(Phase::Settling, |last| last.phase)
    }

    /// Time of the last estimate (µs).
    pub fn time_us(&self) -> u64 {
        self.last.map_or(0, |last| last.time_us)
    }

    /// What is wrong now, the estimator's own doubts included.
    pub fn faults(&self) -> Faults {
        let Some(last) = self.last else {
            return Faults::NONE;
        };
        match last.status {
            Status::ModelSuspect => last.faults.with(Fault::EstimatorSuspect) | self.rendering,
            _ => last.faults | self.rendering,
        }
    }

    /// Sends a frame; there must be room for it. Never inlined: there are eight that do.
    #[inline(never)]
    pub fn send_frame(&mut self, frame: &Frame) {
        let mut bytes = [0; MAX_ENCODED];
        let length = frame::encode(frame, self.sequence, &mut bytes);
        self.link.send(&bytes[..length]);
        self.sequence = self.sequence.wrapping_add(1);
    }

    fn log_changes(&self, now: &Estimate<f32>) {
        let before = self.last.as_ref();
        match now.event {
            Some(Event::Contact) => defmt::info!("{=u64:us}: contact", now.time_us),
            Some(Event::Release) => {
                if let Some(last) = &self.last_in_contact {
                    log_estimate("release", last);
                }
            }
            Some(Event::MaterialChange) => log_estimate("material change", now),
            None => {}
        }
        if now.status == Status::Converged && before.is_some_and(|b| b.status != Status::Converged)
        {
            log_estimate("converged", now);
        }
        if before.is_none_or(|b| b.faults != now.faults) {
            for fault in now.faults.iter() {
                defmt::warn!(
                    "{=u64:us}: fault {=u8}: {=str}",
                    now.time_us,
                    fault.code(),
                    fault.describe()
                );
            }
        }
    }

    /// On in contact, blinking once a second in free air, off while settling.
    fn show(&mut self, estimate: &Estimate<f32>) {
        let on = match estimate.phase {
            Phase::Contact => true,
            Phase::Free => estimate.time_us % 1_000_000 < 100_000,
            Phase::Settling => false,
        };
        // A light that fails takes nothing with it.
        let _ = self.light.set_state(on.into());
    }
}

fn log_estimate(what: &'static str, estimate: &Estimate<f32>) {
    defmt::info!(
        "{=u64:us}: {=str}: {=str}, {=str}",
        estimate.time_us,
        what,
        estimate.law.name(),
        estimate.status.name()
    );
    for (info, slot) in estimate.law.parameters().iter().zip(&estimate.parameters) {
        match slot {
            Some(p) => defmt::info!(
                "  {=str} = {=f32} ± {=f32} {=str}",
                info.name,
                p.value,
                p.std_error,
                info.unit.symbol()
            ),
            None => defmt::info!("  {=str} not observable", info.name),
        }
    }
}
