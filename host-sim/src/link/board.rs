//! A simulated board: the core's sampling, settings and protocol code between a simulated world and a
//! line of limited speed.
//!
//! The core's tick runs here as it runs in the firmware. Around it are the parts that the firmware adds: a
//! queue of records whose overflow is counted, frames that go out as the line has room, commands, and the
//! board's health once a second. The line drains as the board's does ([`super::line`]).

use std::collections::VecDeque;
use std::sync::{Arc, Mutex};

use estimator_core::board::{
    budget::Budget, budget::Started, frame::Frame, frame::MAX_ENCODED, frame::encode,
    history::History, link::Answer, link::Change, link::Command, link::Description, link::Health,
    link::Identity, link::Name, link::RECORD_ROOM, link::Refusal, link::Reply, link::Responder,
    ram_flash::RamFlash, ram_flash::SECTOR, reflection::Packet, sampling::FULL,
    sampling::PERIOD_US, sampling::Ports, sampling::QUEUE, sampling::RATE_HZ, sampling::Reading,
    sampling::Record, sampling::Sampler, settings::Key, settings::Settings,
    settings::store::LAYOUT, settings::store::Store,
};
use estimator_core::estimate::Phase;
use estimator_core::{Estimate, Faults};

use super::line::Line;
use super::world::World;

/// The length of a tick on the stopwatch (ns).
const TICK_NS: u32 = 1_000_000_000 / RATE_HZ;
/// The hardware around the simulated tick.
#[derive(Default)]
struct SimulatedPorts {
    /// The reading of the stopwatch in this tick (ns). The simulated task takes no time.
    now_ns: u32,
    packet: Option<Packet>,
    force_code: u16,
    queue: VecDeque<Record>,
}

impl Ports for SimulatedPorts {
    const FULL: u16 = FULL;

    fn now(&self) -> u32 {
        self.now_ns
    }

    fn packet(&mut self) -> Option<Packet> {
        self.packet.take()
    }

    fn put(&mut self, code: u16, _rest: u16) {
        self.force_code = code;
    }

    fn queue(&mut self, record: Record) -> bool {
        let has_room = self.queue.len() < QUEUE;
        if has_room {
            self.queue.push_back(record);
        }
        has_room
    }
}

/// A board without hardware.
pub struct SimulatedBoard {
    world: Arc<Mutex<World>>,
    sampler: Sampler,
    responder: Responder<RamFlash>,
    change: Option<Change>,
    ports: SimulatedPorts,
    budget: Budget,
    /// The number of samples at the last health.
    reported: u32,
    line: Line,
    commands: VecDeque<u8>,
    sequence: u16,
    ticks: u64,
    last: Option<Estimate<f32>>,
    faults: Faults,
    history: History,
    /// A setting that only the firmware of this board knows, with its value.
    newer: Option<(Description, f32)>,
    /// The settings that the firmware of this board does not know yet.
    unknown: Vec<Key>,
}

impl SimulatedBoard {
    /// Puts a new board into a world, behind a line that carries `bytes_per_ms` bytes a millisecond.
    pub fn new(world: Arc<Mutex<World>>, bytes_per_ms: usize) -> Self {
        let store = Store::new(RamFlash::default(), 0, SECTOR);
        let identity = Identity {
            board: Name::new("simulated"),
            firmware: Name::new(env!("CARGO_PKG_VERSION")),
            layout: LAYOUT,
            rate_hz: RATE_HZ as u16,
            tick: TICK_NS,
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
            ports: SimulatedPorts::default(),
            budget: Budget::new(),
            reported: 0,
            line: Line::new(bytes_per_ms),
            commands: VecDeque::new(),
            sequence: 0,
            ticks: 0,
            last: None,
            faults: Faults::NONE,
            history: History::default(),
            newer: None,
            unknown: Vec::new(),
        }
    }

    /// Makes the firmware an older one, which does not know these settings.
    pub fn without(mut self, unknown: &[Key]) -> Self {
        self.unknown = unknown.to_vec();
        self
    }

    /// Makes the firmware a newer one, with a setting that the host does not know. Its number is larger than all
    /// others.
    pub fn with(mut self, setting: Description) -> Self {
        self.newer = Some((setting, setting.default));
        self
    }

    /// Gives the board a history, as if its last run had ended so.
    pub fn after(mut self, history: History) -> Self {
        self.history = history;
        self
    }

    /// Returns the code that the force output has now; the full output is [`FULL`].
    pub fn force_code(&self) -> u16 {
        self.ports.force_code
    }

    /// Returns the settings in force.
    pub fn settings(&self) -> &Settings {
        self.responder.settings()
    }

    /// Returns the number of samples so far, and how many of their records found the queue full.
    pub fn counts(&self) -> (u32, u32) {
        (self.budget.samples, self.budget.dropped)
    }

    /// Returns the faults of the last record that was sent.
    pub fn faults(&self) -> Faults {
        self.faults
    }

    /// Returns how many bytes have gone over the line and wait to be taken.
    pub fn waiting(&self) -> usize {
        self.line.arrived.len()
    }

    /// Takes bytes that have gone over the line, and returns how many.
    pub fn take(&mut self, into: &mut [u8]) -> usize {
        let arrived = &mut self.line.arrived;
        let count = into.len().min(arrived.len());
        for (slot, byte) in into.iter_mut().zip(arrived.drain(..count)) {
            *slot = byte;
        }
        count
    }

    /// Receives bytes from the host.
    pub fn receive(&mut self, bytes: &[u8]) {
        self.commands.extend(bytes);
    }

    /// Lets a millisecond pass: the sampling task, then answers and telemetry, then the line.
    pub fn tick(&mut self) {
        self.sample();
        self.answer();
        // Health goes before the records, for which a line that is too slow never has room left.
        if self.budget.samples.wrapping_sub(self.reported) >= RATE_HZ
            && self.line.outbox.room() >= MAX_ENCODED
        {
            self.reported = self.budget.samples;
            self.send(&Frame::Health(self.health()));
        }
        while self.line.outbox.room() >= RECORD_ROOM
            && let Some(record) = self.ports.queue.pop_front()
        {
            self.send_record(&record);
        }
        self.line.carry_for_a_millisecond();
    }

    fn sample(&mut self) {
        self.ticks += 1;
        let codes = self
            .world
            .lock()
            .expect("no thread panics while it holds the world")
            .codes(self.ticks);
        let start = (self.ticks * u64::from(TICK_NS)) as u32;
        self.ports.now_ns = start;
        let reading = Reading::Codes(codes);
        let started = Started { due: start, start };
        let sampled = self.sampler.tick(started, reading, &mut self.ports);
        self.budget.count(&sampled, PERIOD_US, TICK_NS);
        if let Some(change) = self.change.take() {
            self.sampler.apply(&change);
        }
        self.responder.heed(&self.budget.latch);
    }

    fn answer(&mut self) {
        while self.line.outbox.room() >= MAX_ENCODED
            && let Some(byte) = self.commands.pop_front()
        {
            let Some((to, command)) = self.responder.push(byte) else {
                continue;
            };
            let in_contact = self.budget.phase == Phase::Contact;
            let busy = self.change.is_some();
            if let Some(id) = self.unknown(&command) {
                let answer = Answer::Refused(Refusal::UnknownSetting, id);
                self.send(&Frame::Reply(Reply { to, answer }));
                continue;
            }
            if let Some(answer) = self.newer(&command) {
                self.send(&Frame::Reply(Reply { to, answer }));
                continue;
            }
            let answered = self.responder.answer(to, command, in_contact, busy);
            self.change = answered.change.or(self.change.take());
            self.ports.packet = answered.packet.or(self.ports.packet.take());
            self.send(&Frame::Reply(answered.reply));
        }
    }

    /// Returns the setting that a command is about, if this firmware does not know it.
    fn unknown(&self, command: &Command) -> Option<u8> {
        let (Command::Get(id) | Command::Set(id, _) | Command::Prepare(id, _)) = command else {
            return None;
        };
        let key = Key::from_id(*id).filter(|key| self.unknown.contains(key));
        key.map(Key::id)
    }

    /// Returns the answer about the setting that only this firmware knows, for a command that is about it.
    fn newer(&mut self, command: &Command) -> Option<Answer> {
        let (setting, value) = self.newer.as_mut()?;
        let last = Key::ALL.into_iter().map(Key::id).max().unwrap_or(0);
        match command {
            Command::Describe(id) if *id > last => Some(Answer::Description(*setting)),
            Command::Get(id) if *id == setting.id => Some(Answer::Value(*id, *value)),
            Command::Set(id, new) if *id == setting.id => {
                *value = *new;
                Some(Answer::Value(*id, *new))
            }
            _ => None,
        }
    }

    fn health(&self) -> Health {
        Health {
            time_us: self.last.map_or(0, |last| last.time_us),
            garbled: self.responder.garbled(),
            faults: self.faults,
            concerns: self.responder.concerns(),
            history: self.history,
            ..self.budget.health()
        }
    }

    fn send_record(&mut self, record: &Record) {
        record.for_each_frame(|frame| self.send(frame));
        self.faults = record.faults();
        self.last = Some(record.estimate);
    }

    fn send(&mut self, frame: &Frame) {
        let mut bytes = [0; MAX_ENCODED];
        let length = encode(frame, self.sequence, &mut bytes);
        self.line.outbox.write(&bytes[..length]);
        self.sequence = self.sequence.wrapping_add(1);
    }
}
