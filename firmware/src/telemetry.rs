//! Telemetry: frames to the host, the status light, and a log line for every event that a person would want
//! to see. It runs at low priority: it may be late, but not wrong.

use crate::board::{Board, Link, Selected};
use embedded_hal::digital::OutputPin;
use estimator_core::board::budget::Meter;
use estimator_core::board::frame::{self, Frame, MAX_ENCODED};
use estimator_core::board::link::RECORD_ROOM;
use estimator_core::board::sampling::{RATE_HZ, Record};
use estimator_core::estimate::{Event, Phase};
use estimator_core::{Estimate, Faults, Status};

/// Telemetry over a link, with a status light.
pub struct Telemetry<L, P> {
    link: L,
    light: P,
    sequence: u16,
    /// This measures the encoding and queueing of a record, in the board's unit.
    pub encode: Meter,
    last: Option<Estimate<f32>>,
    /// The last estimate of the last contact that has ended.
    last_contact: Option<Estimate<f32>>,
    /// A frame on its way to the link. Kept, since clearing it anew costs 190 instructions.
    encoded: [u8; MAX_ENCODED],
    faults: Faults,
}

impl<L: Link, P: OutputPin> Telemetry<L, P> {
    /// New telemetry has sent nothing.
    pub fn new(link: L, light: P) -> Self {
        Telemetry {
            link,
            light,
            sequence: 0,
            encode: Meter::new(),
            last: None,
            last_contact: None,
            encoded: [0; MAX_ENCODED],
            faults: Faults::NONE,
        }
    }

    /// Returns whether the frames of one record fit into the link, and leave room for an answer and for health.
    /// If not, the queue fills and the sampling task counts the drops: this is the only place where they are
    /// counted.
    pub fn has_room_for_a_record(&self) -> bool {
        self.link.room() >= RECORD_ROOM
    }

    /// Returns whether one frame fits into the link.
    pub fn has_room(&self) -> bool {
        self.link.room() >= MAX_ENCODED
    }

    /// Sends the frames of a record and logs what happened in it.
    pub fn send(&mut self, record: &Record) {
        let start = Selected::now();
        record.for_each_frame(|frame| self.send_frame(frame));
        self.encode.record(Selected::now().wrapping_sub(start));
        self.log_changes(&record.estimate);
        self.last = Some(record.estimate);
        self.faults = record.faults();
    }

    /// Starts the link on the queued frames.
    pub fn poll(&mut self) {
        self.link.poll();
    }

    /// Logs the final estimate of a finite run and sends everything that is queued.
    pub fn finish(&mut self) {
        let touching = self
            .last
            .as_ref()
            .filter(|last| last.phase == Phase::Contact);
        match touching.or(self.last_contact.as_ref()) {
            Some(estimate) => log_estimate("final estimate", estimate),
            None => defmt::info!("final estimate: nothing was touched"),
        }
        self.link.finish();
    }

    /// Returns the next byte from the host.
    pub fn receive(&mut self) -> Option<u8> {
        self.link.receive()
    }

    /// Returns the time of the last estimate (µs).
    pub fn time_us(&self) -> u64 {
        self.last.map_or(0, |last| last.time_us)
    }

    /// Returns the faults of the last record that was sent.
    pub fn faults(&self) -> Faults {
        self.faults
    }

    /// Sends a frame, for which there must be room. Never inlined: eight places send frames.
    #[inline(never)]
    pub fn send_frame(&mut self, frame: &Frame) {
        let length = frame::encode(frame, self.sequence, &mut self.encoded);
        self.link.send(&self.encoded[..length]);
        self.sequence = self.sequence.wrapping_add(1);
    }

    fn log_changes(&mut self, now: &Estimate<f32>) {
        let before = self.last.as_ref();
        if let Some(last) = before
            && last.phase == Phase::Contact
            && now.phase != Phase::Contact
        {
            self.last_contact = self.last;
        }
        match now.event {
            Some(Event::Contact) => defmt::info!("{=u64:us}: contact", now.time_us),
            Some(Event::Release) => {
                if let Some(last) = &self.last_contact {
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

    /// Switches the light by the phase and the number of samples: on in contact, a flash of 0.1 s every second in
    /// free air, off while settling.
    pub fn show(&mut self, phase: Phase, samples: u32) {
        let on = match phase {
            Phase::Contact => true,
            Phase::Free => samples % RATE_HZ < RATE_HZ / 10,
            Phase::Settling => false,
        };
        // Nothing depends on the light.
        let _ = self.light.set_state(on.into());
    }
}

/// Logs an estimate with its parameters.
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
