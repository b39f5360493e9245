//! Commands, answers and health as bytes of a frame.

use super::{Answer, Command, Description, Health, Identity, Range, Refusal, Reply, Text};
use crate::board::history::{Crash, History, ResetCause};
use crate::board::settings::{Bounds, Key};
use crate::board::wire::{FrameError, Reader, Writer};
use crate::estimate::fault::Faults;

impl Command {
    pub(crate) fn put(&self, body: &mut Writer) {
        match *self {
            Command::Identify => body.put([1]),
            Command::Get(id) => body.put([2, id]),
            Command::Set(id, value) => {
                body.put([3, id]);
                body.put(value.to_le_bytes());
            }
            Command::Save => body.put([4]),
            Command::Reload => body.put([5]),
            Command::Defaults => body.put([6]),
            Command::Restart => body.put([7]),
            Command::Discard => body.put([8]),
            Command::Prepare(id, value) => {
                body.put([9, id]);
                body.put(value.to_le_bytes());
            }
            Command::Commit => body.put([10]),
            Command::Arm => body.put([11]),
            Command::Disarm => body.put([12]),
            Command::Describe(id) => body.put([13, id]),
            Command::Unknown(tag) => body.put([tag]),
            // Has a frame of its own.
            Command::Reflect(_) => {}
        }
    }

    pub(crate) fn take(reader: &mut Reader) -> Result<Command, FrameError> {
        let [tag] = reader.take()?;
        Ok(match tag {
            1 => Command::Identify,
            2 => {
                let [id] = reader.take()?;
                Command::Get(id)
            }
            3 => {
                let [id] = reader.take()?;
                Command::Set(id, reader.number()?)
            }
            4 => Command::Save,
            5 => Command::Reload,
            6 => Command::Defaults,
            7 => Command::Restart,
            8 => Command::Discard,
            9 => {
                let [id] = reader.take()?;
                Command::Prepare(id, reader.number()?)
            }
            10 => Command::Commit,
            11 => Command::Arm,
            12 => Command::Disarm,
            13 => {
                let [id] = reader.take()?;
                Command::Describe(id)
            }
            tag => {
                // Whatever it carries: the answer is that it is not known.
                reader.skip();
                Command::Unknown(tag)
            }
        })
    }
}

impl Reply {
    pub(crate) fn put(&self, body: &mut Writer) {
        body.put(self.to.to_le_bytes());
        match &self.answer {
            Answer::Identity(identity) => {
                body.put([1, identity.layout, u8::from(identity.unsaved)]);
                body.put(identity.board.0);
                body.put(identity.firmware.0);
                body.put(identity.rate_hz.to_le_bytes());
                body.put(identity.tick.to_le_bytes());
            }
            Answer::Value(id, value) => {
                body.put([2, *id]);
                body.put(value.to_le_bytes());
            }
            Answer::Done => body.put([3]),
            Answer::Refused(reason, id) => body.put([4, *reason as u8, *id]),
            Answer::Description(description) => {
                body.put([5]);
                description.put(body);
            }
        }
    }

    pub(crate) fn take(reader: &mut Reader) -> Result<Reply, FrameError> {
        let to = u16::from_le_bytes(reader.take()?);
        let [tag] = reader.take()?;
        let answer = match tag {
            1 => {
                let [layout, unsaved] = reader.take()?;
                Answer::Identity(Identity {
                    layout,
                    unsaved: unsaved != 0,
                    board: Text(reader.take()?),
                    firmware: Text(reader.take()?),
                    rate_hz: u16::from_le_bytes(reader.take()?),
                    tick: u32::from_le_bytes(reader.take()?),
                })
            }
            2 => {
                let [id] = reader.take()?;
                Answer::Value(id, reader.number()?)
            }
            3 => Answer::Done,
            4 => {
                let [reason, id] = reader.take()?;
                let reason = Refusal::ALL.into_iter().find(|r| *r as u8 == reason);
                Answer::Refused(reason.ok_or(FrameError::Content)?, id)
            }
            5 => Answer::Description(Description::take(reader)?),
            _ => return Err(FrameError::Content),
        };
        Ok(Reply { to, answer })
    }
}

impl Description {
    fn put(&self, body: &mut Writer) {
        let (kind, low, high) = match self.bounds {
            Bounds::Within(low, high) => (0, low, high),
            Bounds::Signed(low, high) => (1, low, high),
            Bounds::Whole(low, high) => (2, low, high),
        };
        body.put([self.id, kind, u8::from(self.restarts)]);
        for number in [low, high, self.default] {
            body.put(number.to_le_bytes());
        }
        body.put(self.unit.0);
        body.put(self.name.0);
    }

    fn take(reader: &mut Reader) -> Result<Description, FrameError> {
        let [id, kind, restarts] = reader.take()?;
        let [low, high, default] = [reader.number()?, reader.number()?, reader.number()?];
        let bounds = match kind {
            0 => Bounds::Within(low, high),
            1 => Bounds::Signed(low, high),
            2 => Bounds::Whole(low, high),
            _ => return Err(FrameError::Content),
        };
        Ok(Description {
            id,
            bounds,
            default,
            restarts: restarts != 0,
            unit: Text(reader.take()?),
            name: Text(reader.take()?),
        })
    }
}

impl Range {
    fn put(&self, body: &mut Writer) {
        for value in [self.min, self.mean, self.max] {
            body.put(value.to_le_bytes());
        }
    }

    fn take(reader: &mut Reader) -> Result<Range, FrameError> {
        Ok(Range {
            min: u32::from_le_bytes(reader.take()?),
            mean: u32::from_le_bytes(reader.take()?),
            max: u32::from_le_bytes(reader.take()?),
        })
    }
}

impl Health {
    pub(crate) fn put(&self, body: &mut Writer) {
        body.put(self.time_us.to_le_bytes());
        let counts = [
            self.samples,
            self.dropped,
            self.overruns,
            self.missed,
            self.garbled,
            self.stack_free,
        ];
        for count in counts {
            body.put(count.to_le_bytes());
        }
        for range in [&self.period, &self.step, &self.task] {
            range.put(body);
        }
        body.put(self.faults.bits().to_le_bytes());
        let concerns = self.concerns.map_or(0, Key::id);
        body.put([concerns, u8::from(self.clock_fallback)]);
        self.response.put(body);
        body.put([u8::from(self.armed)]);
        body.put(self.latched.bits().to_le_bytes());
        put_history(body, &self.history);
    }

    pub(crate) fn take(reader: &mut Reader) -> Result<Health, FrameError> {
        let mut health = Health {
            time_us: u64::from_le_bytes(reader.take()?),
            samples: u32::from_le_bytes(reader.take()?),
            dropped: u32::from_le_bytes(reader.take()?),
            overruns: u32::from_le_bytes(reader.take()?),
            missed: u32::from_le_bytes(reader.take()?),
            garbled: u32::from_le_bytes(reader.take()?),
            stack_free: u32::from_le_bytes(reader.take()?),
            period: Range::take(reader)?,
            step: Range::take(reader)?,
            task: Range::take(reader)?,
            faults: Faults::from_bits(u16::from_le_bytes(reader.take()?)),
            ..Health::default()
        };
        let [concerns, clock_fallback] = reader.take()?;
        health.concerns = Key::from_id(concerns);
        health.clock_fallback = clock_fallback != 0;
        // An older firmware ends here.
        if !reader.is_empty() {
            health.response = Range::take(reader)?;
            let [armed] = reader.take()?;
            health.armed = armed != 0;
            health.latched = Faults::from_bits(u16::from_le_bytes(reader.take()?));
            health.history = take_history(reader)?;
        }
        Ok(health)
    }
}

fn put_history(body: &mut Writer, history: &History) {
    body.put([history.reset as u8, u8::from(history.crash.is_some())]);
    for word in history.crash.map_or([0; 4], Crash::to_words) {
        body.put(word.to_le_bytes());
    }
}

fn take_history(reader: &mut Reader) -> Result<History, FrameError> {
    let [reset, crashed] = reader.take()?;
    let mut words = [0; 4];
    for word in &mut words {
        *word = u32::from_le_bytes(reader.take()?);
    }
    let crash = Crash::from_words(words).filter(|_| crashed != 0);
    Ok(History {
        reset: ResetCause::with_code(reset),
        crash,
    })
}
