//! A board at the other end of a port: the frames that it sends, the commands and their answers, and the
//! count of what was lost.

use std::collections::VecDeque;
use std::io;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use estimator_core::board::frame::{Decoder, Frame, MAX_ENCODED, encode};
use estimator_core::board::link::{Answer, BAUD, Command, Description, Health, Identity, Refusal};
use estimator_core::board::settings::{Key, Settings};

use super::port::Port;
use crate::diagnostic::Diagnostic;

/// A board that says nothing for so long is not there any more.
pub const SILENCE: Duration = Duration::from_secs(3);
/// How long the host waits for an answer. An answer comes within milliseconds; the answer to a save may wait
/// 4 s until the flash is erased.
const PATIENCE: Duration = Duration::from_millis(500);
const PATIENCE_FOR_FLASH: Duration = Duration::from_secs(6);
const PATIENCE_FOR_HEALTH: Duration = Duration::from_millis(1500);
/// How often a command is sent if no answer comes. Every command may be repeated.
const ATTEMPTS: usize = 3;
/// How often a command is repeated if the board is too busy for it.
const BUSY_ATTEMPTS: usize = 50;

/// The counts of what has come over a link.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Statistics {
    /// Frames with a correct check sum.
    pub frames: u64,
    /// Stretches of bytes that are no frame.
    pub garbled: u64,
    /// Frames that are missing from the sequence.
    pub lost: u64,
}

/// A board behind a port.
pub struct Device<P> {
    port: P,
    decoder: Decoder,
    waiting: VecDeque<Frame>,
    expected: Option<u16>,
    sequence: u16,
    /// Whether the first zero byte has come. Before it stands the rest of a frame that began earlier.
    in_step: bool,
    statistics: Statistics,
    tap: Option<Tap>,
}

/// A function that takes the bytes as they come, for example into a file.
pub type Tap = Box<dyn FnMut(&[u8]) -> io::Result<()>>;

impl<P: Port> Device<P> {
    /// Listens to a port.
    pub fn new(port: P) -> Self {
        Device {
            port,
            decoder: Decoder::new(),
            waiting: VecDeque::new(),
            expected: None,
            // It starts at a random number, so that a late answer to another host is not taken for ours.
            sequence: anywhere(),
            in_step: false,
            statistics: Statistics::default(),
            tap: None,
        }
    }

    /// The counts of what has come so far.
    pub fn statistics(&self) -> Statistics {
        self.statistics
    }

    /// The port.
    pub fn port(&mut self) -> &mut P {
        &mut self.port
    }

    /// The next frame, if one has come.
    ///
    /// # Errors
    /// The port fails.
    pub fn next_frame(&mut self) -> io::Result<Option<Frame>> {
        if self.waiting.is_empty() {
            self.listen()?;
        }
        Ok(self.waiting.pop_front())
    }

    /// From now on gives every byte that comes to `tap` as well; `None` ends that.
    pub fn tap(&mut self, tap: Option<Tap>) {
        self.tap = tap;
    }

    fn listen(&mut self) -> io::Result<()> {
        let mut bytes = [0; 4096];
        let count = self.port.read(&mut bytes)?;
        let bytes = bytes.get(..count).unwrap_or(&[]);
        if let Some(tap) = &mut self.tap {
            tap(bytes)?;
        }
        for byte in bytes {
            match self.decoder.push(*byte) {
                Some(Ok((sequence, frame))) => {
                    let expected = self.expected.unwrap_or(sequence);
                    self.statistics.lost += u64::from(sequence.wrapping_sub(expected));
                    self.expected = Some(sequence.wrapping_add(1));
                    self.statistics.frames += 1;
                    self.waiting.extend(frame.parts());
                }
                Some(Err(_)) => self.statistics.garbled += u64::from(self.in_step),
                None => {}
            }
            self.in_step |= *byte == 0;
        }
        Ok(())
    }

    /// Sends a command and waits for its answer. Other frames that come meanwhile are dropped.
    ///
    /// # Errors
    /// The port fails, or no answer comes.
    pub fn ask(&mut self, command: Command) -> io::Result<Answer> {
        let patience = match command {
            Command::Save => PATIENCE_FOR_FLASH,
            _ => PATIENCE,
        };
        for _ in 0..ATTEMPTS {
            let to = self.sequence;
            self.sequence = self.sequence.wrapping_add(1);
            let mut bytes = [0; MAX_ENCODED + 1];
            // A zero byte comes first, so that garbage at the start of the line is no part of the command.
            let mut encoded = [0; MAX_ENCODED];
            let length = encode(&Frame::Command(command), to, &mut encoded);
            bytes[1..=length].copy_from_slice(&encoded[..length]);
            self.port.write(&bytes[..=length])?;
            if let Some(answer) = self.await_answer(to, patience)? {
                return Ok(answer);
            }
        }
        Err(io::Error::new(
            io::ErrorKind::TimedOut,
            format!(
                "the board does not answer ({} frames came, {} were garbled): is its RX line \
                 connected, and is it a Palpate board at {} baud?",
                self.statistics.frames, self.statistics.garbled, BAUD
            ),
        ))
    }

    fn await_answer(&mut self, to: u16, patience: Duration) -> io::Result<Option<Answer>> {
        let start = Instant::now();
        while start.elapsed() < patience {
            match self.next_frame()? {
                Some(Frame::Reply(reply)) if reply.to == to => return Ok(Some(reply.answer)),
                Some(_) | None => {}
            }
        }
        Ok(None)
    }

    /// Sends a command as [`Device::ask`] does, and takes a refusal for an error.
    ///
    /// # Errors
    /// As [`Device::ask`], or a [`Diagnostic`] with the reason why the board refuses.
    pub fn order(&mut self, command: Command) -> Result<Answer, Box<dyn std::error::Error>> {
        for _ in 0..BUSY_ATTEMPTS {
            match self.ask(command)? {
                Answer::Refused(Refusal::Busy, _) => {}
                Answer::Refused(reason, id) => return Err(refused(command, reason, id).into()),
                answer => return Ok(answer),
            }
        }
        Err(refused(command, Refusal::Busy, 0).into())
    }

    /// Asks which board and which firmware it is.
    ///
    /// # Errors
    /// As [`Device::order`], or the answer is no identity.
    pub fn identity(&mut self) -> Result<Identity, Box<dyn std::error::Error>> {
        match self.order(Command::Identify)? {
            Answer::Identity(identity) => Ok(identity),
            other => Err(unexpected(&other).into()),
        }
    }

    /// Asks for the value of a setting.
    ///
    /// # Errors
    /// [`Device::order`]'s.
    pub fn get(&mut self, key: Key) -> Result<f32, Box<dyn std::error::Error>> {
        match self.order(Command::Get(key.id()))? {
            Answer::Value(id, value) if id == key.id() => Ok(value),
            other => Err(unexpected(&other).into()),
        }
    }

    /// Gives a setting a value, which is in force at once and is not saved.
    ///
    /// # Errors
    /// [`Device::order`]'s.
    pub fn set(&mut self, key: Key, value: f32) -> Result<(), Box<dyn std::error::Error>> {
        match self.order(Command::Set(key.id(), value))? {
            Answer::Value(id, taken) if id == key.id() && taken == value => Ok(()),
            other => Err(unexpected(&other).into()),
        }
    }

    /// Gives a setting a value that comes into force together with others, at [`Command::Commit`].
    ///
    /// # Errors
    /// [`Device::order`]'s.
    pub fn prepare(&mut self, key: Key, value: f32) -> Result<(), Box<dyn std::error::Error>> {
        match self.order(Command::Prepare(key.id(), value))? {
            Answer::Value(id, taken) if id == key.id() && taken == value => Ok(()),
            other => Err(unexpected(&other).into()),
        }
    }

    /// Asks for all settings. A setting that an older firmware does not know has its default, with which a
    /// newer firmware does what the older one does.
    ///
    /// # Errors
    /// [`Device::order`]'s.
    pub fn settings(&mut self) -> Result<Settings, Box<dyn std::error::Error>> {
        self.known_settings().map(|(settings, _)| settings)
    }

    /// Asks for all settings, and says which ones the board does not know.
    ///
    /// # Errors
    /// [`Device::order`]'s.
    pub fn known_settings(&mut self) -> Result<(Settings, Vec<Key>), Box<dyn std::error::Error>> {
        let (mut settings, mut unknown) = (Settings::default(), Vec::new());
        for key in Key::ALL {
            match self.ask(Command::Get(key.id()))? {
                Answer::Refused(Refusal::UnknownSetting, _) => unknown.push(key),
                Answer::Value(id, value) if id == key.id() => settings.put(key, value),
                // If the board is busy, this asks again; a refusal becomes an error.
                _ => settings.put(key, self.get(key)?),
            }
        }
        Ok((settings, unknown))
    }

    /// Asks what the settings are that this version does not know, each with its value. A board with an older
    /// firmware, which does not describe its settings, has none.
    ///
    /// # Errors
    /// The port fails, no answer comes, or an answer is no description.
    pub fn newer_settings(
        &mut self,
    ) -> Result<Vec<(Description, f32)>, Box<dyn std::error::Error>> {
        let (mut newer, mut from) = (Vec::new(), Some(0));
        while let Some(id) = from {
            let description = match self.ask(Command::Describe(id))? {
                Answer::Description(description) => description,
                Answer::Refused(..) => break,
                other => return Err(unexpected(&other).into()),
            };
            if Key::from_id(description.id).is_none() {
                match self.order(Command::Get(description.id))? {
                    Answer::Value(_, value) => newer.push((description, value)),
                    other => return Err(unexpected(&other).into()),
                }
            }
            from = description.id.checked_add(1);
        }
        Ok(newer)
    }

    /// Waits for the health that a board sends once a second; `None` if none comes.
    ///
    /// # Errors
    /// The port fails.
    pub fn health(&mut self) -> io::Result<Option<Health>> {
        let start = Instant::now();
        while start.elapsed() < PATIENCE_FOR_HEALTH {
            if let Some(Frame::Health(health)) = self.next_frame()? {
                return Ok(Some(health));
            }
        }
        Ok(None)
    }
}

/// A number that the next start of the program is unlikely to have as well.
fn anywhere() -> u16 {
    let now = SystemTime::now().duration_since(UNIX_EPOCH);
    // The nanoseconds in units of 1.024 µs: a clock with steps of 1 µs still gives every number.
    now.map_or(0, |now| (now.subsec_nanos() >> 10) as u16)
}

fn unexpected(answer: &Answer) -> io::Error {
    io::Error::other(format!("the board gave an unexpected answer: {answer:?}"))
}

fn refused(command: Command, reason: Refusal, id: u8) -> Diagnostic {
    let diagnostic = Diagnostic::new(format!("the board refuses: {}", reason.describe()));
    let diagnostic = match command {
        Command::Set(_, value) | Command::Prepare(_, value) => diagnostic.value(value),
        _ => diagnostic,
    };
    if reason == Refusal::UnknownSetting {
        let name = Key::from_id(id).map_or("", |key| key.info().name);
        return diagnostic.at_key(name).remedy(
            "its firmware is older than this `palpate`: flash a newer one, or leave the setting out",
        );
    }
    if reason == Refusal::NotArmed {
        return diagnostic.remedy(
            "run `config arm`: a reset, a save, a restart or a fault has disarmed it, and nothing else arms it",
        );
    }
    if reason == Refusal::InContact {
        return diagnostic.remedy("if the probe is in free air, the zero of the load cell has drifted: run `config restart`");
    }
    match Key::from_id(id) {
        Some(key) => {
            let info = key.info();
            diagnostic
                .at_key(info.name)
                .remedy(format!("{}: {} ({})", info.name, info.bounds, info.about))
        }
        None => diagnostic,
    }
}
