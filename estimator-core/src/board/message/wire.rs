//! Commands, answers and health as bytes of a frame.

use super::{Answer, Command, Health, Identity, Name, Range, Refusal, Reply};
use crate::board::{settings::Key, wire::FrameError, wire::Reader, wire::Writer};
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
                    board: Name(reader.take()?),
                    firmware: Name(reader.take()?),
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
            _ => return Err(FrameError::Content),
        };
        Ok(Reply { to, answer })
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
        Ok(health)
    }
}
