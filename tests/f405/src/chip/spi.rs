//! SPI3 (RM0090, chapter 28) as master, eight bits a frame, polled; and on its bus the two sensors of the
//! second wiring, an AS5047P and an ADS1220, as their data sheets have them.

use super::{MICROSECOND, NEVER};
use std::collections::VecDeque;

const RXNE: u32 = 1;
const TXE: u32 = 2;
const OVR: u32 = 1 << 6;
const BSY: u32 = 1 << 7;

pub(crate) struct Spi {
    cr1: u32,
    cr2: u32,
    sr: u32,
    dr: u32,
    clock: u64,
    shifting: Option<u8>,
    held: Option<u8>,
    done_at: u64,
}

impl Spi {
    pub(crate) fn new() -> Self {
        Spi {
            cr1: 0,
            cr2: 0,
            sr: TXE,
            dr: 0,
            clock: 1,
            shifting: None,
            held: None,
            done_at: NEVER,
        }
    }

    pub(crate) fn set_clock(&mut self, clock: u64) {
        self.clock = clock;
    }

    pub(crate) fn event(&self) -> u64 {
        self.done_at
    }

    /// The byte whose last bit goes out now.
    pub(crate) fn at_event(&mut self) -> Option<u8> {
        let at = self.done_at;
        self.done_at = NEVER;
        let sent = self.shifting.take();
        if let Some(next) = self.held.take() {
            self.sr |= TXE;
            self.shift(at, next);
        }
        sent
    }

    /// The byte that came in at the same time.
    pub(crate) fn received(&mut self, byte: u8) {
        if self.sr & RXNE != 0 {
            self.sr |= OVR;
            return;
        }
        self.dr = u32::from(byte);
        self.sr |= RXNE;
    }

    fn shift(&mut self, now: u64, byte: u8) {
        self.shifting = Some(byte);
        self.done_at = now + 8 * self.clock * (2 << (self.cr1 >> 3 & 7));
    }

    pub(crate) fn line(&self) -> bool {
        let asks = ((self.cr2 >> 6 & 1) * RXNE) | ((self.cr2 >> 7 & 1) * TXE);
        self.sr & asks != 0
    }

    pub(crate) fn read(&mut self, offset: u32) -> u32 {
        match offset {
            0x00 => self.cr1,
            0x04 => self.cr2,
            0x08 => self.sr | if self.shifting.is_some() { BSY } else { 0 },
            0x0c => {
                self.sr &= !(RXNE | OVR);
                self.dr
            }
            0x10 => 7,
            _ => 0,
        }
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32, now: u64) {
        match offset {
            0x00 => self.cr1 = value,
            0x04 => self.cr2 = value,
            0x0c if self.cr1 & 1 << 6 != 0 => match self.shifting {
                None => self.shift(now, value as u8),
                Some(_) => {
                    self.held = Some(value as u8);
                    self.sr &= !TXE;
                }
            },
            _ => {}
        }
    }
}

/// The two sensors.
#[derive(Default)]
pub(crate) struct Sensors {
    /// Bytes of the encoder's frame that have gone by, and what it answers.
    frame: Vec<u8>,
    answer: u16,
    registers: [u8; 4],
    command: VecDeque<u8>,
    reply: VecDeque<u8>,
    /// When the running conversion started and will be done, and the code of the last one.
    conversion: Option<(u64, u64)>,
    pub(crate) code: i32,
    ready: bool,
    /// The cables of encoder and converter are off.
    pub(crate) cut: [bool; 2],
}

/// A conversion takes 0.5 to 0.6 ms in turbo mode at 2000 samples a second, and 50 ms as after a reset.
const CONVERSION: u64 = 550 * MICROSECOND;
const SLOW_CONVERSION: u64 = 50_000 * MICROSECOND;
/// The bits of rate and mode of register 1 (8.6.1.2), and their value for turbo mode at 2000 a second.
const RATE: u8 = 0b1111_1000;
const TURBO: u8 = 0b1101_0000;

impl Sensors {
    /// A select line rises: a frame of the encoder ends, or a command of the converter.
    pub(crate) fn deselect_encoder(&mut self, angle: impl FnOnce() -> u16) {
        if let [high, low] = self.frame[..] {
            let address = u16::from_be_bytes([high, low]) & 0x3fff;
            let data = match address {
                0x3fff => angle() & 0x3fff,
                // The magnet is right: gain 128, ready.
                0x3ffc => 0x180,
                _ => 0,
            };
            self.answer = data | ((data.count_ones() % 2) as u16) << 15;
        }
        self.frame.clear();
    }

    /// The converter has lost its supply for an instant.
    pub(crate) fn brown_out_converter(&mut self) {
        (self.registers, self.conversion, self.ready) = ([0; 4], None, false);
        self.deselect_bridge();
    }

    pub(crate) fn deselect_bridge(&mut self) {
        self.command.clear();
        self.reply.clear();
    }

    /// A byte to the encoder and the one that comes back.
    pub(crate) fn encoder(&mut self, byte: u8) -> u8 {
        let out = self.answer.to_be_bytes().get(self.frame.len()).copied();
        self.frame.push(byte);
        out.unwrap_or(0)
    }

    /// A byte to the converter and the one that comes back.
    pub(crate) fn bridge(&mut self, byte: u8, now: u64) -> u8 {
        if let Some(out) = self.reply.pop_front() {
            return out;
        }
        if let Some(index) = self.command.pop_front() {
            if let Some(slot) = self.registers.get_mut(usize::from(index)) {
                *slot = byte;
            }
            return 0;
        }
        match byte {
            0x06 | 0x07 => {
                *self = Sensors {
                    answer: self.answer,
                    cut: self.cut,
                    ..Sensors::default()
                }
            }
            0x08 | 0x09 => {
                let length = match self.registers[1] & RATE {
                    TURBO => CONVERSION,
                    _ => SLOW_CONVERSION,
                };
                self.conversion = Some((now, now + length));
                self.ready = false;
            }
            0x10..=0x1f => {
                self.ready = false;
                self.reply.extend(&self.code.to_be_bytes()[1..]);
            }
            0x20..=0x2f => {
                let first = byte >> 2 & 3;
                let last = (first + (byte & 3)).min(3);
                let registers = &self.registers[usize::from(first)..=usize::from(last)];
                self.reply.extend(registers);
            }
            0x40..=0x4f => {
                let first = byte >> 2 & 3;
                self.command.extend(first..=(first + (byte & 3)).min(3));
            }
            _ => {}
        }
        0
    }

    pub(crate) fn event(&self) -> u64 {
        self.conversion.map_or(NEVER, |(_, done)| done)
    }

    /// A conversion is done; `mean` gives the code for the time that it took.
    pub(crate) fn at_event(&mut self, mean: impl FnOnce(u64, u64) -> i32) {
        if let Some((from, to)) = self.conversion.take()
            && !self.cut[1]
        {
            self.code = mean(from, to);
            self.ready = true;
        }
    }

    /// The level of DRDY.
    pub(crate) fn not_ready(&self) -> bool {
        !self.ready
    }
}
