//! A board at the other end of a port: frames in, commands out and answered, and what got lost.

use std::collections::VecDeque;
use std::io;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use estimator_core::board::frame::{Decoder, Frame, MAX_ENCODED, encode};
use estimator_core::board::link::{Answer, BAUD, Command, Identity, Refusal};
use estimator_core::board::settings::{Key, Settings};

use super::port::Port;
use crate::diagnostic::Diagnostic;

/// An answer comes within milliseconds; one to a save may wait for an erase of the flash, 4 s.
const PATIENCE: Duration = Duration::from_millis(500);
const PATIENCE_FOR_FLASH: Duration = Duration::from_secs(6);
/// Times that a command is sent when no answer comes: every command may be repeated.
const ATTEMPTS: usize = 3;
/// Times that a command is asked again that the board was too busy for.
const BUSY_ATTEMPTS: usize = 50;

/// What has come over a link so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Statistics {
    /// Good frames.
    pub frames: u64,
    /// Stretches of bytes that were no frame.
    pub garbled: u64,
    /// Frames that are missing from the sequence.
    pub lost: u64,
}

/// A board.
pub struct Device<P> {
    port: P,
    decoder: Decoder,
    waiting: VecDeque<Frame>,
    expected: Option<u16>,
    sequence: u16,
    /// Whether the first zero has come: before it is the rest of a frame that began earlier.
    in_step: bool,
    statistics: Statistics,
    tap: Option<Tap>,
}

/// Takes bytes as they come, such as into a file.
pub type Tap = Box<dyn FnMut(&[u8]) -> io::Result<()>>;

impl<P: Port> Device<P> {
    /// Listens to a port.
    pub fn new(port: P) -> Self {
        Device {
            port,
            decoder: Decoder::new(),
            waiting: VecDeque::new(),
            expected: None,
            // Anywhere: an answer that is still on its way to another host must not be taken for ours.
            sequence: anywhere(),
            in_step: false,
            statistics: Statistics::default(),
            tap: None,
        }
    }

    /// What has come so far.
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
    /// What the port says.
    pub fn next_frame(&mut self) -> io::Result<Option<Frame>> {
        if self.waiting.is_empty() {
            self.listen()?;
        }
        Ok(self.waiting.pop_front())
    }

    /// From now on, gives every byte to `tap` as it comes, whoever asked for it; `None`: to nobody.
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
                    self.waiting.push_back(frame);
                }
                Some(Err(_)) => self.statistics.garbled += u64::from(self.in_step),
                None => {}
            }
            self.in_step |= *byte == 0;
        }
        Ok(())
    }

    /// Sends a command and waits for its answer; other frames that come meanwhile are dropped.
    ///
    /// # Errors
    /// What the port says, or that no answer comes.
    pub fn ask(&mut self, command: Command) -> io::Result<Answer> {
        let patience = match command {
            Command::Save => PATIENCE_FOR_FLASH,
            _ => PATIENCE,
        };
        for _ in 0..ATTEMPTS {
            let to = self.sequence;
            self.sequence = self.sequence.wrapping_add(1);
            let mut bytes = [0; MAX_ENCODED + 1];
            // A zero first: whatever garbage the line began with is no part of the command.
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

    /// The same for a command that must not be refused.
    ///
    /// # Errors
    /// [`Device::ask`]'s, or a [`Diagnostic`] with the board's reason.
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

    /// Who is there.
    ///
    /// # Errors
    /// [`Device::order`]'s, or that it is something else.
    pub fn identity(&mut self) -> Result<Identity, Box<dyn std::error::Error>> {
        match self.order(Command::Identify)? {
            Answer::Identity(identity) => Ok(identity),
            other => Err(unexpected(&other).into()),
        }
    }

    /// A setting's value.
    ///
    /// # Errors
    /// [`Device::order`]'s.
    pub fn get(&mut self, key: Key) -> Result<f32, Box<dyn std::error::Error>> {
        match self.order(Command::Get(key.id()))? {
            Answer::Value(id, value) if id == key.id() => Ok(value),
            other => Err(unexpected(&other).into()),
        }
    }

    /// Gives a setting a value, in force at once and not saved.
    ///
    /// # Errors
    /// [`Device::order`]'s.
    pub fn set(&mut self, key: Key, value: f32) -> Result<(), Box<dyn std::error::Error>> {
        match self.order(Command::Set(key.id(), value))? {
            Answer::Value(id, taken) if id == key.id() && taken == value => Ok(()),
            other => Err(unexpected(&other).into()),
        }
    }

    /// A value that is to come into force together with others, at [`Command::Commit`].
    ///
    /// # Errors
    /// [`Device::order`]'s.
    pub fn prepare(&mut self, key: Key, value: f32) -> Result<(), Box<dyn std::error::Error>> {
        match self.order(Command::Prepare(key.id(), value))? {
            Answer::Value(id, taken) if id == key.id() && taken == value => Ok(()),
            other => Err(unexpected(&other).into()),
        }
    }

    /// All settings that the board knows. One that an older firmware does not know has its default
    /// here, with which the board does what it did before there was such a setting.
    ///
    /// # Errors
    /// [`Device::order`]'s.
    pub fn settings(&mut self) -> Result<Settings, Box<dyn std::error::Error>> {
        self.known_settings().map(|(settings, _)| settings)
    }

    /// The same, and which settings the board does not know.
    ///
    /// # Errors
    /// [`Device::order`]'s.
    pub fn known_settings(&mut self) -> Result<(Settings, Vec<Key>), Box<dyn std::error::Error>> {
        let (mut settings, mut unknown) = (Settings::default(), Vec::new());
        for key in Key::ALL {
            match self.ask(Command::Get(key.id()))? {
                Answer::Refused(Refusal::UnknownSetting, _) => unknown.push(key),
                Answer::Value(id, value) if id == key.id() => settings.put(key, value),
                // Busy, or refused for a reason: asked again, and said.
                _ => settings.put(key, self.get(key)?),
            }
        }
        Ok((settings, unknown))
    }
}

/// A number that the next start hardly has as well.
fn anywhere() -> u16 {
    let now = SystemTime::now().duration_since(UNIX_EPOCH);
    // Nanoseconds in units of 1.024 µs: clocks of 1 µs still give every number.
    now.map_or(0, |now| (now.subsec_nanos() >> 10) as u16)
}

fn unexpected(answer: &Answer) -> io::Error {
    io::Error::other(format!("the board answers something else: {answer:?}"))
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
    if reason == Refusal::InContact {
        return diagnostic.remedy("if it is in free air, its zero has crept: `config restart`");
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
