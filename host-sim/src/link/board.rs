//! A board without hardware: the core's sampling, settings and protocol code between a simulated
//! world and a line that carries so many bytes a millisecond.
//!
//! What the firmware adds around the same code is here in the same order: a queue of 64 records whose
//! overflow is counted, frames out as the line has room, commands in, health once a second, and the force
//! that is put out.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex};

use embedded_storage::nor_flash::{ErrorType, NorFlash, ReadNorFlash};
use estimator_core::board::budget::{Budget, Stations};
use estimator_core::board::frame::{Frame, MAX_ENCODED, RECORD_ENCODED, encode};
use estimator_core::board::link::{Answer, Change, Command, Health, Identity, Name};
use estimator_core::board::link::{Refusal, Reply, Responder};
use estimator_core::board::reflection::Packet;
use estimator_core::board::sampling::{Record, Sampler};
use estimator_core::board::settings::store::{LAYOUT, SLOT, Store};
use estimator_core::board::settings::{Key, Settings};
use estimator_core::estimate::Phase;
use estimator_core::{Estimate, Fault, Faults, Status};

use super::world::World;

/// 2 Mbaud, ten bits a byte.
pub const BYTES_PER_MS: usize = 200;
/// As in the firmware.
const QUEUE: usize = 64;
/// As in the firmware: two chunks.
const LINE: usize = 1024;
/// The code of the full force output, as on the F405.
pub const FULL: u16 = 2625;
const RATE_HZ: u16 = 1000;
/// Four slots a sector, as in the emulator: every fourth save erases.
pub const SECTOR: u32 = 4 * SLOT as u32;

/// Flash in memory.
#[derive(Clone, Debug)]
pub struct RamFlash(Vec<u8>);

impl Default for RamFlash {
    fn default() -> Self {
        RamFlash(vec![0xff; 2 * SECTOR as usize])
    }
}

impl RamFlash {
    /// What it holds: the emulator's `settings.flash`.
    pub fn bytes(&self) -> &[u8] {
        &self.0
    }
}

impl ErrorType for RamFlash {
    type Error = std::convert::Infallible;
}

impl ReadNorFlash for RamFlash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Self::Error> {
        let start = offset as usize;
        bytes.copy_from_slice(&self.0[start..start + bytes.len()]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.0.len()
    }
}

impl NorFlash for RamFlash {
    const WRITE_SIZE: usize = 1;
    const ERASE_SIZE: usize = SECTOR as usize;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Self::Error> {
        self.0[from as usize..to as usize].fill(0xff);
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Self::Error> {
        let place = self.0[offset as usize..].iter_mut();
        place.zip(bytes).for_each(|(slot, byte)| *slot &= byte);
        Ok(())
    }
}

/// The board.
pub struct SimulatedBoard {
    world: Arc<Mutex<World>>,
    sampler: Sampler,
    responder: Responder<RamFlash>,
    change: Option<Change>,
    budget: Budget,
    queue: VecDeque<Record>,
    line: VecDeque<u8>,
    bytes_per_ms: usize,
    arrived: VecDeque<u8>,
    commands: VecDeque<u8>,
    sequence: u16,
    ticks: u64,
    last: Option<Estimate<f32>>,
    rendering: Faults,
    packet: Option<Packet>,
    force_code: u16,
    /// Settings that its firmware does not know yet.
    unknown: Vec<Key>,
}

impl SimulatedBoard {
    /// A new board in a world, behind a line of so many bytes a millisecond.
    pub fn new(world: Arc<Mutex<World>>, bytes_per_ms: usize) -> Self {
        let store = Store::new(RamFlash::default(), 0, SECTOR);
        let identity = Identity {
            board: Name::new("simulated"),
            firmware: Name::new(env!("CARGO_PKG_VERSION")),
            layout: LAYOUT,
            rate_hz: RATE_HZ,
            tick: 1_000_000,
            unsaved: false,
        };
        let responder = Responder::new(store, identity);
        let setup = responder
            .setup()
            .expect("settings that load have been checked");
        SimulatedBoard {
            world,
            sampler: Sampler::new(setup),
            responder,
            change: None,
            budget: Budget::new(),
            queue: VecDeque::new(),
            line: VecDeque::new(),
            bytes_per_ms,
            arrived: VecDeque::new(),
            commands: VecDeque::new(),
            sequence: 0,
            ticks: 0,
            last: None,
            rendering: Faults::NONE,
            packet: None,
            force_code: 0,
            unknown: Vec::new(),
        }
    }

    /// A board with an older firmware, which does not know these settings.
    pub fn without(mut self, unknown: &[Key]) -> Self {
        self.unknown = unknown.to_vec();
        self
    }

    /// The code that the force output has now, of [`FULL`].
    pub fn force_code(&self) -> u16 {
        self.force_code
    }

    /// The settings in force.
    pub fn settings(&self) -> &Settings {
        self.responder.settings()
    }

    /// Samples so far, and how many of their records found the queue full.
    pub fn counts(&self) -> (u32, u32) {
        (self.budget.samples, self.budget.dropped)
    }

    /// Bytes that have gone over the line and wait to be taken.
    pub fn waiting(&self) -> usize {
        self.arrived.len()
    }

    /// Takes bytes that have gone over the line.
    pub fn take(&mut self, into: &mut [u8]) -> usize {
        let count = into.len().min(self.arrived.len());
        for (slot, byte) in into.iter_mut().zip(self.arrived.drain(..count)) {
            *slot = byte;
        }
        count
    }

    /// Bytes from the host.
    pub fn receive(&mut self, bytes: &[u8]) {
        self.commands.extend(bytes);
    }

    /// A millisecond: the sampling task, then answers and telemetry, then the line.
    pub fn tick(&mut self) {
        self.sample();
        self.answer();
        while self.room()
            && let Some(record) = self.queue.pop_front()
        {
            self.send_record(&record);
        }
        let (samples, every) = (self.budget.samples, u32::from(RATE_HZ));
        if samples.is_multiple_of(every) && self.room() {
            self.send(&Frame::Health(self.health()));
        }
        let carried = self.bytes_per_ms.min(self.line.len());
        self.arrived.extend(self.line.drain(..carried));
    }

    fn sample(&mut self) {
        self.ticks += 1;
        let codes = self
            .world
            .lock()
            .expect("nobody panics with the world in hand")
            .codes(self.ticks);
        let sample = self.sampler.convert(&codes);
        if let Some(packet) = self.packet.take() {
            self.sampler.take(&packet);
        }
        let (rendered, code) = self.sampler.render(&sample, FULL);
        self.force_code = code;
        let contact = self.sampler.compensate(sample);
        let estimate = self.sampler.step(contact);
        let due = self.sampler.due(&estimate);
        let record = Record {
            codes: Some(codes),
            sample,
            estimate,
            rendered,
            due,
        };
        let dropped = due.any() && self.queue.len() >= QUEUE;
        if due.any() && !dropped {
            self.queue.push_back(record);
        }
        // No stopwatch: nanoseconds of a task that takes none.
        let start = (self.ticks * 1_000_000) as u32;
        let at = Stations {
            start,
            acquired: start,
            converted: start,
            put_out: start,
            compensated: start,
            stepped: start,
            queued: start,
        };
        self.budget.sample(&at, &sample, dropped, 1000, 1_000_000);
        if let Some(change) = self.change.take() {
            self.sampler.apply(&change);
        }
    }

    fn answer(&mut self) {
        while self.room()
            && let Some(byte) = self.commands.pop_front()
        {
            let Some((to, command)) = self.responder.push(byte) else {
                continue;
            };
            let in_contact = self.last.is_some_and(|last| last.phase == Phase::Contact);
            let busy = self.change.is_some();
            if let Some(id) = self.unknown(&command) {
                let answer = Answer::Refused(Refusal::UnknownSetting, id);
                self.send(&Frame::Reply(Reply { to, answer }));
                continue;
            }
            let answered = self.responder.answer(to, command, in_contact, busy);
            self.change = answered.change.or(self.change.take());
            self.packet = answered.packet.or(self.packet.take());
            self.send(&Frame::Reply(answered.reply));
        }
    }

    /// The setting that a command is about, if this firmware does not know it.
    fn unknown(&self, command: &Command) -> Option<u8> {
        let (Command::Get(id) | Command::Set(id, _) | Command::Prepare(id, _)) = command else {
            return None;
        };
        let key = Key::from_id(*id).filter(|key| self.unknown.contains(key));
        key.map(Key::id)
    }

    fn health(&self) -> Health {
        let last = self.last.as_ref();
        let faults = last.map_or(Default::default(), |last| match last.status {
            Status::ModelSuspect => last.faults.with(Fault::EstimatorSuspect),
            _ => last.faults,
        }) | self.rendering;
        Health {
            time_us: last.map_or(0, |last| last.time_us),
            samples: self.budget.samples,
            dropped: self.budget.dropped,
            overruns: self.budget.overruns,
            missed: self.budget.missed,
            garbled: self.responder.garbled(),
            period: self.budget.period.range(),
            step: self.budget.step.range(),
            task: self.budget.task.range(),
            stack_free: 0,
            faults,
            concerns: self.responder.concerns(),
            clock_fallback: false,
        }
    }

    fn room(&self) -> bool {
        LINE - self.line.len() >= RECORD_ENCODED
    }

    fn send_record(&mut self, record: &Record) {
        if record.due.shown {
            if let Some(codes) = record.codes {
                self.send(&Frame::Codes(codes));
            }
            self.send(&Frame::Sample(record.sample));
            self.send(&Frame::Estimate(record.estimate));
            if let Some(rendered) = record.rendered {
                self.send(&Frame::Rendered(rendered));
            }
        }
        if let Some(packet) = record.packet() {
            self.send(&Frame::Reflection(packet));
        }
        self.rendering = record.rendered.map_or(Faults::NONE, |of| of.faults);
        self.last = Some(record.estimate);
    }

    fn send(&mut self, frame: &Frame) {
        let mut bytes = [0; MAX_ENCODED];
        let length = encode(frame, self.sequence, &mut bytes);
        self.line.extend(&bytes[..length]);
        self.sequence = self.sequence.wrapping_add(1);
    }
}
