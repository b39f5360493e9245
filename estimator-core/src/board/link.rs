//! The board's side of the link: takes bytes, answers commands, keeps the settings. The same code
//! runs in the firmware and in a simulated board.

pub use crate::board::message::{
    Answer, Command, Description, Health, Identity, Name, Range, Refusal, Reply, Text,
};

use crate::board::frame::{Decoder, Frame, MAX_ENCODED, RECORD_ENCODED};
use crate::board::outbox::OUTBOX;
use crate::board::protection::{Arming, Latch};
use crate::board::reflection::Packet;
use crate::board::settings::store::{Loaded, Store};
use crate::board::settings::{Key, Settings, Setup};
use crate::estimate::fault::{Fault, Faults};
use embedded_storage::nor_flash::NorFlash;

/// Speed of the serial line (baud), 8N1: exact on the board, and within 0.2 % on the adapters that have it.
pub const BAUD: u32 = 2_000_000;
/// Bytes that the serial line carries in a millisecond: a byte takes ten bits.
pub const BYTES_PER_MS: usize = BAUD as usize / 10 / 1000;

/// The room (bytes) with which a board sends the next record: for its frames, and then still for an answer and
/// its health, so that a line that the records fill does not silence the board.
pub const RECORD_ROOM: usize = RECORD_ENCODED + 2 * MAX_ENCODED;
const _: () = assert!(RECORD_ROOM + BYTES_PER_MS <= OUTBOX);

/// The answer to a command, and what the sampling task has to take over for it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Answered {
    /// The reply to be sent.
    pub reply: Reply,
    /// A change of the setup.
    pub change: Option<Change>,
    /// An impedance to be rendered.
    pub packet: Option<Packet>,
}

/// What changes in the sampling task.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Change {
    /// The new setup.
    pub setup: Setup,
    /// Whether the estimator starts anew; otherwise only telemetry changes.
    pub restart: bool,
}

/// Settings and commands of a board.
#[derive(Debug)]
pub struct Responder<F> {
    settings: Settings,
    saved: Settings,
    /// What a host is putting together, until it is committed or discarded.
    prepared: Option<Settings>,
    store: Store<F>,
    identity: Identity,
    decoder: Decoder,
    garbled: u32,
    /// The last impedance that was taken.
    packet: Option<Packet>,
    /// The arming of the force output that is in force, 0 if none is, and the last one there was.
    arming: Arming,
    armings: Arming,
    /// Faults from loading, until settings are loaded or set back.
    standing: Faults,
    concerns: Option<Key>,
}

impl<F: NorFlash> Responder<F> {
    /// Loads the settings; with ones that cannot be used, the defaults take their place, the fault
    /// [`Fault::SettingsInvalid`] stands, and [`Responder::concerns`] names the setting.
    pub fn new(mut store: Store<F>, identity: Identity) -> Self {
        let loaded = store.load();
        let mut responder = Responder {
            settings: Settings::default(),
            saved: Settings::default(),
            prepared: None,
            store,
            identity,
            decoder: Decoder::new(),
            garbled: 0,
            packet: None,
            arming: 0,
            armings: 0,
            standing: Faults::NONE,
            concerns: None,
        };
        match loaded {
            Ok(Loaded::Good(settings)) => {
                (responder.settings, responder.saved) = (settings, settings);
            }
            Ok(Loaded::Nothing) => {}
            Ok(Loaded::Bad(invalid)) => responder.invalid(Some(invalid.key)),
            Ok(Loaded::Newer(_)) | Err(_) => responder.invalid(None),
        }
        responder
    }

    fn invalid(&mut self, concerns: Option<Key>) {
        self.standing = Faults::NONE.with(Fault::SettingsInvalid);
        self.concerns = concerns;
    }

    /// The settings in force.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// The setting that could not be used, if that is why the board runs on defaults.
    pub fn concerns(&self) -> Option<Key> {
        self.concerns
    }

    /// The number of frames that could not be read or are no command.
    pub fn garbled(&self) -> u32 {
        self.garbled
    }

    /// What the sampling task starts with. It is never `None`, since the settings have been checked.
    pub fn setup(&self) -> Option<Setup> {
        let setup = self.settings.setup().ok()?;
        Some(Setup {
            conversion: setup.conversion.with_standing(self.standing),
            arming: self.arming,
            ..setup
        })
    }

    /// Takes note of the force output's latch: an arming under which a fault has come is over. One that is newer
    /// stays: the sampling task has not taken it over yet, and its latch is still that of the arming before.
    pub fn heed(&mut self, latch: &Latch) {
        if latch.holds(self.arming) {
            self.arming = 0;
        }
    }

    /// Takes a byte of the link, and at the end of a command gives it with its sequence number.
    pub fn push(&mut self, byte: u8) -> Option<(u16, Command)> {
        match self.decoder.push(byte)? {
            Ok((sequence, Frame::Command(command))) => Some((sequence, command)),
            Ok((sequence, Frame::Reflection(packet))) => Some((sequence, Command::Reflect(packet))),
            Ok(_) | Err(_) => {
                self.garbled = self.garbled.saturating_add(1);
                None
            }
        }
    }

    /// Answers a command. `in_contact` is the phase at the last sample; `busy` means that the last
    /// change is still on its way to the sampling task.
    pub fn answer(&mut self, to: u16, command: Command, in_contact: bool, busy: bool) -> Answered {
        let mut rendered = None;
        let done = match command {
            Command::Reflect(packet) => self.reflect(packet, &mut rendered),
            command => self.try_to_answer(command, in_contact, busy),
        };
        let (answer, change) = match done {
            Ok(done) => done,
            // A save that failed has disarmed as well.
            Err((Refusal::FlashFailed, id)) => (
                Answer::Refused(Refusal::FlashFailed, id),
                self.change(false),
            ),
            Err((reason, id)) => (Answer::Refused(reason, id), None),
        };
        Answered {
            reply: Reply { to, answer },
            change,
            packet: rendered,
        }
    }

    /// Takes an impedance to be rendered; it is checked here, so that the sampling task takes it as it
    /// is. The same one again, since the answer to it was lost, is taken once: a channel that repeats
    /// itself has stopped.
    fn reflect(&mut self, packet: Packet, rendered: &mut Option<Packet>) -> Done {
        let most_n = Key::RenderForceN;
        permit(
            self.settings.get(most_n) == 0.0,
            Refusal::NotRendering,
            most_n.id(),
        )?;
        permit(self.arming == 0, Refusal::NotArmed, 0)?;
        let renderable = packet.is_sound() && packet.reflected().is_ok();
        permit(!renderable, Refusal::NotRenderable, 0)?;
        if let Some(last) = &self.packet {
            permit(packet.is_older_than(last), Refusal::Overtaken, 0)?;
            let again = packet.time_us == last.time_us && packet.sequence == last.sequence;
            if again {
                return Ok((Answer::Done, None));
            }
        }
        (self.packet, *rendered) = (Some(packet), Some(packet));
        Ok((Answer::Done, None))
    }

    fn try_to_answer(&mut self, command: Command, in_contact: bool, busy: bool) -> Done {
        // A restart is taken in contact as well: a zero that has crept looks like contact, and this is the way out.
        let disturbs = matches!(command, Command::Save | Command::Reload | Command::Defaults);
        permit(disturbs && in_contact, Refusal::InContact, 0)?;
        let changes = disturbs
            || matches!(
                command,
                Command::Restart | Command::Commit | Command::Arm | Command::Disarm
            );
        permit(changes && busy, Refusal::Busy, 0)?;
        match command {
            Command::Identify => {
                let identity = Identity {
                    unsaved: self.settings != self.saved,
                    ..self.identity
                };
                Ok((Answer::Identity(identity), None))
            }
            Command::Get(id) => {
                let key = Key::from_id(id).ok_or((Refusal::UnknownSetting, id))?;
                Ok((Answer::Value(id, self.settings.get(key)), None))
            }
            Command::Set(id, value) => {
                let key = Key::from_id(id).ok_or((Refusal::UnknownSetting, id))?;
                permit(key.info().restarts && in_contact, Refusal::InContact, id)?;
                permit(busy, Refusal::Busy, id)?;
                self.set(key, value)
            }
            Command::Save => self.save(),
            Command::Reload => self.reload(),
            Command::Defaults => {
                self.settings = Settings::default();
                self.prepared = None;
                self.restarted()
            }
            Command::Restart => self.restarted(),
            Command::Discard => {
                self.prepared = None;
                Ok((Answer::Done, None))
            }
            Command::Prepare(id, value) => {
                let key = Key::from_id(id).ok_or((Refusal::UnknownSetting, id))?;
                self.prepared.get_or_insert(self.settings).put(key, value);
                Ok((Answer::Value(id, value), None))
            }
            Command::Commit => self.commit(in_contact),
            Command::Arm => self.arm(),
            Command::Disarm => {
                self.arming = 0;
                Ok((Answer::Done, self.change(false)))
            }
            Command::Describe(from) => describe(from).map(|answer| (answer, None)),
            Command::Unknown(_) | Command::Reflect(_) => Err((Refusal::UnknownCommand, 0)),
        }
    }

    /// Keeps the settings. While the flash is written nothing runs that could stop a force.
    fn save(&mut self) -> Done {
        self.arming = 0;
        let saved = self.store.save(&self.settings);
        saved.map_err(|_| (Refusal::FlashFailed, 0))?;
        self.saved = self.settings;
        self.forgive()
    }

    fn set(&mut self, key: Key, value: f32) -> Done {
        let mut changed = self.settings;
        changed.put(key, value);
        changed
            .check()
            .map_err(|invalid| (Refusal::Unusable, invalid.key.id()))?;
        self.settings = changed;
        self.prepared = None;
        let change = self.change(key.info().restarts);
        Ok((Answer::Value(key.id(), value), change))
    }

    /// Puts what was prepared into force. With nothing prepared there is nothing to do: the answer to a
    /// first attempt was lost.
    fn commit(&mut self, in_contact: bool) -> Done {
        let Some(prepared) = self.prepared else {
            return Ok((Answer::Done, None));
        };
        let differs = |key: &Key| prepared.get(*key) != self.settings.get(*key);
        let disturbing = |key: &Key| differs(key) && key.info().restarts;
        let disturbs = Key::table().iter().copied().find(disturbing);
        if let Some(key) = disturbs {
            permit(in_contact, Refusal::InContact, key.id())?;
        }
        prepared
            .check()
            .map_err(|invalid| (Refusal::Unusable, invalid.key.id()))?;
        self.settings = prepared;
        self.prepared = None;
        Ok((Answer::Done, self.change(disturbs.is_some())))
    }

    fn reload(&mut self) -> Done {
        match self.store.load() {
            Ok(Loaded::Good(settings)) => self.settings = settings,
            Ok(Loaded::Nothing) => self.settings = Settings::default(),
            Ok(Loaded::Bad(invalid)) => return Err((Refusal::SavedUnusable, invalid.key.id())),
            Ok(Loaded::Newer(_)) => return Err((Refusal::SavedUnusable, 0)),
            Err(_) => return Err((Refusal::FlashFailed, 0)),
        }
        (self.saved, self.standing, self.concerns) = (self.settings, Faults::NONE, None);
        self.prepared = None;
        self.restarted()
    }

    /// Arms the force output under a new number. A packet from before does not come back.
    fn arm(&mut self) -> Done {
        let most_n = Key::RenderForceN;
        let nothing = self.settings.get(most_n) == 0.0;
        permit(nothing, Refusal::NotRendering, most_n.id())?;
        self.armings = self.armings.wrapping_add(1).max(1);
        self.arming = self.armings;
        self.packet = None;
        Ok((Answer::Done, self.change(false)))
    }

    /// Ends a fault from loading: what is in flash can be used now. The sampling task takes over that it is
    /// disarmed.
    fn forgive(&mut self) -> Done {
        let stood = self.standing != Faults::NONE;
        (self.standing, self.concerns) = (Faults::NONE, None);
        Ok((Answer::Done, self.change(stood)))
    }

    /// Lets the estimator start anew. The force output waits for another arming.
    fn restarted(&mut self) -> Done {
        self.arming = 0;
        Ok((Answer::Done, self.change(true)))
    }

    fn change(&self, restart: bool) -> Option<Change> {
        self.setup().map(|setup| Change { setup, restart })
    }
}

type Done = Result<(Answer, Option<Change>), (Refusal, u8)>;

/// Describes the first setting from a number on.
#[inline(never)]
fn describe(from: u8) -> Result<Answer, (Refusal, u8)> {
    let from_there = Key::table().iter().filter(|key| key.id() >= from);
    let key = from_there.min_by_key(|key| key.id());
    let key = key.ok_or((Refusal::UnknownSetting, from))?;
    let info = key.info();
    Ok(Answer::Description(Description {
        id: key.id(),
        name: Text::new(info.name),
        unit: Text::spaced(info.unit),
        bounds: info.bounds,
        default: info.default,
        restarts: info.restarts,
    }))
}

fn permit(forbidden: bool, reason: Refusal, id: u8) -> Result<(), (Refusal, u8)> {
    if forbidden { Err((reason, id)) } else { Ok(()) }
}

#[cfg(test)]
mod tests;
