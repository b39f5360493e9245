//! The host at the other end of the line: sends commands at the line's pace and decodes what comes.

use crate::chip::{MICROSECOND, UNITS_PER_SECOND};
use crate::machine::Machine;
use estimator_core::board::frame::{Decoder, Frame, MAX_ENCODED, encode};
use estimator_core::board::link::Command;

/// Ten bits at 2 Mbaud, in units.
const BYTE: u64 = 5 * MICROSECOND;

/// A frame that came, with the time of its last byte and its sequence number.
#[derive(Clone, Debug)]
pub struct Received {
    /// When its last byte came (units).
    pub at: u64,
    /// Its sequence number.
    pub sequence: u16,
    /// What it says.
    pub frame: Frame,
}

impl Received {
    /// When its last byte came (s).
    pub fn seconds(&self) -> f64 {
        self.at as f64 / UNITS_PER_SECOND as f64
    }
}

/// The host's end of the line.
pub struct Host {
    decoder: Decoder,
    /// Frames that came.
    pub frames: Vec<Received>,
    /// Frames that could not be read.
    pub garbled: u32,
    /// Bytes that came.
    pub bytes: u64,
    taken: usize,
    line_free: u64,
    sequence: u16,
}

impl Default for Host {
    fn default() -> Self {
        Host {
            decoder: Decoder::new(),
            frames: Vec::new(),
            garbled: 0,
            bytes: 0,
            taken: 0,
            line_free: 0,
            sequence: 0,
        }
    }
}

impl Host {
    /// Decodes what the board has sent since the last time.
    pub fn listen(&mut self, machine: &mut Machine) {
        let sent = std::mem::take(&mut machine.chip.uart.sent);
        self.taken += sent.len();
        self.take(&sent);
    }

    /// Decodes bytes with their times.
    pub fn take(&mut self, bytes: &[(u64, u8)]) {
        self.bytes += bytes.len() as u64;
        for (at, byte) in bytes {
            match self.decoder.push(*byte) {
                Some(Ok((sequence, frame))) => {
                    self.frames.extend(frame.parts().map(|frame| Received {
                        at: *at,
                        sequence,
                        frame,
                    }));
                }
                Some(Err(_)) => self.garbled += 1,
                None => {}
            }
        }
    }

    /// Sends a command; returns its sequence number.
    pub fn send(&mut self, machine: &mut Machine, command: Command) -> u16 {
        let frame = match command {
            Command::Reflect(packet) => Frame::Reflection(packet),
            command => Frame::Command(command),
        };
        let mut bytes = [0; MAX_ENCODED];
        let length = encode(&frame, self.sequence, &mut bytes);
        let sequence = self.sequence;
        self.sequence = self.sequence.wrapping_add(1);
        self.put(machine, &bytes[..length]);
        sequence
    }

    /// Puts bytes on the line to the board.
    pub fn put(&mut self, machine: &mut Machine, bytes: &[u8]) {
        for byte in bytes {
            self.line_free = self.line_free.max(machine.chip.now) + BYTE;
            machine.chip.uart.coming.push_back((self.line_free, *byte));
        }
        machine.chip.attention = true;
    }

    /// Bytes that came since the last look of a gateway.
    pub fn forwarded(machine: &mut Machine) -> Vec<(u64, u8)> {
        std::mem::take(&mut machine.chip.uart.sent)
    }
}
