//! The memory map (RM0090, table 1): who answers at which address.

use super::{CCM, Chip, EXTI_PR, FLASH, MICROSECOND, RAM, SUPPLY, flash};

/// The alias regions of single bits, and what they stand for.
const BITS_OF_RAM: u32 = 0x2200_0000;
const BITS_OF_PERIPHERALS: u32 = 0x4200_0000;
const PERIPHERALS: u32 = 0x4000_0000;
const RTC_BACKUP: u32 = 0x4000_2850;

fn little(bytes: &[u8]) -> u32 {
    bytes
        .iter()
        .rev()
        .fold(0, |all, byte| all << 8 | u32::from(*byte))
}

impl Chip {
    /// A word of memory, as the core fetches a vector or a debugger looks.
    pub fn word(&self, at: u32) -> u32 {
        self.memory(at, 4).unwrap_or(0)
    }

    /// A half word for the decoder; outside of memory it is an undefined instruction.
    pub(crate) fn peek(&self, at: u32) -> u16 {
        self.memory(at, 2).unwrap_or(0xde00) as u16
    }

    fn memory(&self, at: u32, bytes: u32) -> Option<u32> {
        let part = |memory: &[u8], base: u32| {
            let from = at.wrapping_sub(base) as usize;
            memory
                .get(from..from.checked_add(bytes as usize)?)
                .map(little)
        };
        match at >> 24 {
            0x20 => part(&self.ram, RAM),
            0x08 => part(&self.flash.memory, FLASH),
            0x00 => part(&self.flash.memory, 0),
            0x10 => part(&self.ccm, CCM),
            _ => None,
        }
    }

    /// Writes memory as a debugger does.
    pub fn poke(&mut self, at: u32, value: u32) {
        let from = at.wrapping_sub(RAM) as usize;
        if let Some(slot) = self.ram.get_mut(from..from + 4) {
            slot.copy_from_slice(&value.to_le_bytes());
        }
    }

    /// A read by the core or a stream.
    pub(crate) fn read(&mut self, at: u32, bytes: u32) -> u32 {
        let index = at.wrapping_sub(RAM) as usize;
        if bytes == 4
            && let Some(word) = self.ram.get(index..index.wrapping_add(4))
        {
            return little(word);
        }
        if let Some(value) = self.memory(at, bytes) {
            return value;
        }
        match at >> 24 {
            0x40 | 0x50 => {
                let shift = 8 * (at & 3);
                let mask = u32::MAX >> (32 - 8 * bytes);
                self.attention = true;
                self.catch_up();
                self.register(at & !3) >> shift & mask
            }
            0x42 | 0x22 => {
                let (base, bit) = alias(at);
                self.read(base, 4) >> bit & 1
            }
            0xe0 => {
                let (now, cycle) = (self.now, self.cycle());
                match at {
                    0xe004_2000 => 0x1007_6413,
                    0xe000_1000..=0xe000_1fff | 0xe000_e000..=0xe000_efff => {
                        let value = self.scs.read(at & !3, now, cycle);
                        value >> (8 * (at & 3)) & (u32::MAX >> (32 - 8 * bytes))
                    }
                    _ => self.plain.get(&at).copied().unwrap_or(0),
                }
            }
            // System memory: the flash's size, calibration of the ADC, the unique number.
            0x1f => {
                let word: u32 = match at & !3 {
                    0x1fff_7a20 => 1024 << 16,
                    0x1fff_7a28 => 1500 << 16,
                    _ => 0x0123_4567,
                };
                word >> (8 * (at & 3)) & (u32::MAX >> (32 - 8 * bytes))
            }
            _ => self.missing(at),
        }
    }

    #[cold]
    fn missing(&mut self, at: u32) -> u32 {
        self.trace.unmapped(at);
        self.fault = true;
        self.attention = true;
        0
    }

    /// A write by the core or a stream.
    pub(crate) fn write(&mut self, at: u32, bytes: u32, value: u32) {
        let index = at.wrapping_sub(RAM) as usize;
        if let Some(slot) = self.ram.get_mut(index..index.wrapping_add(bytes as usize)) {
            slot.copy_from_slice(&value.to_le_bytes()[..bytes as usize]);
            return;
        }
        match at >> 24 {
            0x10 => {
                let from = (at - CCM) as usize;
                match self.ccm.get_mut(from..from + bytes as usize) {
                    Some(slot) => slot.copy_from_slice(&value.to_le_bytes()[..bytes as usize]),
                    None => _ = self.missing(at),
                }
            }
            0x08 if ((at - FLASH) as usize) < flash::SIZE => {
                let offset = (at - FLASH) as usize;
                self.flash
                    .program(offset, bytes, value, self.now, MICROSECOND);
                self.attention = true;
            }
            0x40 | 0x50 => {
                self.catch_up();
                let merged = match bytes {
                    4 => value,
                    _ => {
                        // The bus repeats what is narrower than a word; registers of this model take words.
                        let (shift, mask) = (8 * (at & 3), u32::MAX >> (32 - 8 * bytes));
                        self.narrow(at & !3) & !(mask << shift) | (value & mask) << shift
                    }
                };
                self.set_register(at & !3, merged);
                self.attention = true;
            }
            0x42 | 0x22 => {
                let (base, bit) = alias(at);
                let before = self.read(base, 4);
                self.write(base, 4, before & !(1 << bit) | (value & 1) << bit);
            }
            0xe0 => {
                let (now, cycle) = (self.now, self.cycle());
                match at {
                    0xe000_1000..=0xe000_1fff | 0xe000_e000..=0xe000_efff => {
                        self.scs.write(at, bytes, value, now, cycle);
                    }
                    _ => _ = self.plain.insert(at, value),
                }
                self.attention = true;
            }
            _ => _ = self.missing(at),
        }
    }

    /// What a register holds, without the effects of a read: data registers are written as they are.
    fn narrow(&mut self, at: u32) -> u32 {
        match at {
            0x4000_4c04 | 0x4000_3c0c => 0,
            at => self.register(at),
        }
    }

    fn register(&mut self, at: u32) -> u32 {
        let now = self.now;
        let offset = at & 0x3ff;
        match at & !0x3ff {
            base if timer_at(base).is_some() => {
                let timer = timer_at(base).unwrap_or(0);
                let encoder = self.world.counts(now);
                self.timers[timer].read(offset, now, encoder)
            }
            0x4000_3000 => self.iwdg.read(offset),
            0x4000_3c00 => self.spi.read(offset),
            0x4000_4c00 => self.uart.read(offset),
            0x4001_2000 => self.adc.read(offset),
            base @ 0x4002_0000..=0x4002_2000 => {
                self.drive_inputs();
                self.ports[(base - 0x4002_0000) as usize / 0x400].read(offset)
            }
            0x4002_3800 => self.rcc.read(offset, now),
            0x4002_3c00 => self.flash.read(offset, now),
            0x4002_6000 => self.dma.read(0, offset),
            0x4002_6400 => self.dma.read(1, offset),
            0x4004_0000..0x5000_0000 => self.missing(at),
            0x4000_2800 if (RTC_BACKUP..RTC_BACKUP + 80).contains(&at) => {
                self.backup[(at - RTC_BACKUP) as usize / 4]
            }
            _ => self.plain.get(&at).copied().unwrap_or(0),
        }
    }

    fn set_register(&mut self, at: u32, value: u32) {
        let now = self.now;
        let offset = at & 0x3ff;
        match at & !0x3ff {
            base if timer_at(base).is_some() => {
                let timer = timer_at(base).unwrap_or(0);
                let encoder = self.world.counts(now);
                if self.timers[timer].write(offset, value, now, encoder) {
                    self.timer_updated(timer);
                }
                self.listen();
                self.note_drive();
            }
            0x4000_3000 => self.iwdg.write(offset, value, now),
            0x4000_3c00 => self.spi.write(offset, value, now),
            0x4000_4c00 => self.uart.write(offset, value, now),
            0x4001_2000 => {
                self.adc.write(offset, value, now);
                self.listen();
            }
            base @ 0x4002_0000..=0x4002_2000 => {
                let before = [self.ports[0].is_low(2), self.ports[0].is_low(3)];
                self.ports[(base - 0x4002_0000) as usize / 0x400].write(offset, value);
                self.selected(before);
                self.note_drive();
            }
            0x4002_3800 => {
                self.rcc.write(offset, value, now);
                self.take_clock();
            }
            0x4002_3c00 => self.flash.write(offset, value, now, MICROSECOND),
            0x4002_6000 => self.dma.write(0, offset, value),
            0x4002_6400 => self.dma.write(1, offset, value),
            0x4004_0000..0x5000_0000 => _ = self.missing(at),
            0x4000_2800 if (RTC_BACKUP..RTC_BACKUP + 80).contains(&at) => {
                self.backup[(at - RTC_BACKUP) as usize / 4] = value;
            }
            // A pending line is cleared by a 1; of the lines the model has the voltage detector's.
            _ if at == EXTI_PR => self.supply_sank &= value & SUPPLY == 0,
            _ => _ = self.plain.insert(at, value),
        }
    }
}

/// The index of the timer at a base address: TIM2 to TIM7 on APB1, TIM1 and TIM8 on APB2.
fn timer_at(base: u32) -> Option<usize> {
    match base {
        0x4000_0000..=0x4000_1400 => Some((base - PERIPHERALS) as usize / 0x400 + 1),
        0x4001_0000 => Some(0),
        0x4001_0400 => Some(7),
        _ => None,
    }
}

/// The word and the bit that a word of an alias region stands for.
fn alias(at: u32) -> (u32, u32) {
    let (alias, base) = match at >= BITS_OF_PERIPHERALS {
        true => (BITS_OF_PERIPHERALS, PERIPHERALS),
        false => (BITS_OF_RAM, RAM),
    };
    let byte = (at - alias) / 32;
    (base + (byte & !3), (at - alias) / 4 % 8 + 8 * (byte & 3))
}
