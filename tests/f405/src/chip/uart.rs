//! UART4 (RM0090, chapter 30): 8N1 at the pace of its divider, with DMA both ways.

use super::NEVER;
use std::collections::VecDeque;

const ORE: u32 = 1 << 3;
const IDLE: u32 = 1 << 4;
const RXNE: u32 = 1 << 5;
const TC: u32 = 1 << 6;
const TXE: u32 = 1 << 7;

pub(crate) struct Uart {
    pub(crate) sr: u32,
    dr: u32,
    brr: u32,
    pub(crate) cr1: u32,
    cr2: u32,
    pub(crate) cr3: u32,
    gtpr: u32,
    /// The peripheral's clock, in units of time.
    clock: u64,
    shifting: Option<u8>,
    held: Option<u8>,
    done_at: u64,
    /// What the board has sent, with the end of each byte.
    pub(crate) sent: Vec<(u64, u8)>,
    /// What comes to the board, with the end of each byte.
    pub(crate) coming: VecDeque<(u64, u8)>,
    /// Bytes that came before the last one was fetched.
    pub(crate) overrun: u32,
}

impl Uart {
    pub(crate) fn new() -> Self {
        Uart {
            sr: TXE | TC,
            dr: 0,
            brr: 0,
            cr1: 0,
            cr2: 0,
            cr3: 0,
            gtpr: 0,
            clock: 1,
            shifting: None,
            held: None,
            done_at: NEVER,
            sent: Vec::new(),
            coming: VecDeque::new(),
            overrun: 0,
        }
    }

    /// The registers as after a reset; what is on the line stays.
    pub(crate) fn reset(&mut self) {
        let (sent, coming) = (
            std::mem::take(&mut self.sent),
            std::mem::take(&mut self.coming),
        );
        *self = Uart {
            sent,
            coming,
            ..Uart::new()
        };
    }

    pub(crate) fn set_clock(&mut self, clock: u64) {
        self.clock = clock;
    }

    /// The time of ten bits, in units.
    pub(crate) fn byte_time(&self) -> u64 {
        let divider = match self.cr1 & 1 << 15 != 0 {
            // With OVER8 the fraction has three bits.
            true => (self.brr >> 4) * 8 + (self.brr & 7),
            false => self.brr,
        };
        10 * self.clock * u64::from(divider.max(1))
    }

    fn is_sending(&self) -> bool {
        self.cr1 & 1 << 13 != 0 && self.cr1 & 1 << 3 != 0
    }

    fn is_receiving(&self) -> bool {
        self.cr1 & 1 << 13 != 0 && self.cr1 & 1 << 2 != 0
    }

    pub(crate) fn event(&self) -> u64 {
        let next = self.coming.front().map_or(NEVER, |(at, _)| *at);
        self.done_at.min(next)
    }

    pub(crate) fn at_event(&mut self, now: u64) {
        if self.done_at <= now {
            let at = self.done_at;
            if let Some(byte) = self.shifting.take() {
                self.sent.push((at, byte));
            }
            self.done_at = NEVER;
            match self.held.take() {
                Some(byte) => self.shift(at, byte),
                None => self.sr |= TC,
            }
            self.sr |= TXE;
        }
        while let Some((at, byte)) = self.coming.front().copied()
            && at <= now
        {
            self.coming.pop_front();
            self.receive(byte);
        }
    }

    fn receive(&mut self, byte: u8) {
        if !self.is_receiving() {
            return;
        }
        if self.sr & RXNE != 0 {
            self.sr |= ORE;
            self.overrun += 1;
            return;
        }
        self.dr = u32::from(byte);
        self.sr |= RXNE | IDLE;
    }

    fn shift(&mut self, now: u64, byte: u8) {
        self.shifting = Some(byte);
        self.done_at = now + self.byte_time();
    }

    /// Whether the transmitter asks for a byte by DMA.
    pub(crate) fn wants(&self) -> bool {
        self.is_sending() && self.sr & TXE != 0 && self.cr3 & 1 << 7 != 0
    }

    /// Whether the receiver offers a byte by DMA.
    pub(crate) fn offers(&self) -> bool {
        self.sr & RXNE != 0 && self.cr3 & 1 << 6 != 0
    }

    /// Whether the interrupt line is high: TXEIE, TCIE, RXNEIE and IDLEIE stand where their flags do.
    pub(crate) fn line(&self) -> bool {
        self.sr & self.cr1 & (TXE | TC | RXNE | IDLE) != 0
            || self.sr & ORE != 0 && self.cr1 & RXNE != 0
    }

    pub(crate) fn read(&mut self, offset: u32) -> u32 {
        match offset {
            0x00 => self.sr,
            0x04 => {
                self.sr &= !(RXNE | ORE | IDLE);
                self.dr
            }
            0x08 => self.brr,
            0x0c => self.cr1,
            0x10 => self.cr2,
            0x14 => self.cr3,
            _ => self.gtpr,
        }
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32, now: u64) {
        match offset {
            0x00 => self.sr &= value | !(TC | RXNE),
            0x04 => {
                if !self.is_sending() {
                    return;
                }
                self.sr &= !TC;
                match self.shifting {
                    None => self.shift(now, value as u8),
                    Some(_) => {
                        self.held = Some(value as u8);
                        self.sr &= !TXE;
                    }
                }
            }
            0x08 => self.brr = value,
            0x0c => self.cr1 = value,
            0x10 => self.cr2 = value,
            0x14 => self.cr3 = value,
            _ => self.gtpr = value,
        }
    }
}
