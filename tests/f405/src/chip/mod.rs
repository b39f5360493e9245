//! The part around the core: memories, peripherals, and the time that they share.
//!
//! Time counts in units of 1/344 064 000 000 s, of which a cycle at 168 MHz has 2048 and a microsecond
//! 344 064: periods of all clocks are whole numbers.

mod access;
mod adc;
mod dma;
mod events;
pub(crate) mod flash;
mod gpio;
mod iwdg;
mod rcc;
mod scs;
mod spi;
mod timer;
pub(crate) mod trace;
mod uart;

pub use flash::{EraseTimes, Operation, apply};
pub use rcc::Crystal;
pub use trace::{Cost, Drive, Reset, Trace};

use crate::world::World;
use adc::Adc;
use dma::Dma;
use flash::Flash;
use gpio::Port;
use iwdg::Iwdg;
use rcc::{Periods, Rcc};
use scs::Scs;
use spi::{Sensors, Spi};
use timer::Timer;
use uart::Uart;

/// Units of time in a second.
pub const UNITS_PER_SECOND: u64 = 344_064_000_000;
/// Units of time in a millisecond.
pub const MILLISECOND: u64 = UNITS_PER_SECOND / 1000;
/// Units of time in a microsecond.
pub const MICROSECOND: u64 = MILLISECOND / 1000;
/// No event comes.
pub(crate) const NEVER: u64 = u64::MAX;

/// Where flash and RAM are.
pub(crate) const FLASH: u32 = 0x0800_0000;
pub(crate) const RAM: u32 = 0x2000_0000;
const RAM_BYTES: usize = 128 * 1024;
const CCM: u32 = 0x1000_0000;
const CCM_BYTES: usize = 64 * 1024;
/// Backup registers of the RTC and the backup memory, which only a power cut forgets.
const BACKUP_WORDS: usize = 20;
/// The debugger's configuration, and its bit that assigns the trace's pins (RM0090, 38.16.3).
const DBGMCU_CR: u32 = 0xe004_2004;
const TRACE_IOEN: u32 = 1 << 5;
/// The voltage detector (RM0090, 5.4.1) and its line of EXTI (12.3).
const PWR_CR: u32 = 0x4000_7000;
const EXTI_IMR: u32 = 0x4001_3c00;
const EXTI_RTSR: u32 = 0x4001_3c08;
const EXTI_PR: u32 = 0x4001_3c14;
const SUPPLY: u32 = 1 << 16;

/// What differs from one board to the next.
#[derive(Clone, Copy, Debug)]
pub struct Part {
    /// Cycles an instruction takes, 1.0 to 1.8.
    pub cycles_per_instruction: f64,
    /// The crystal.
    pub crystal: Crystal,
    /// The internal oscillator in parts of 16 MHz: 0.99 to 1.01.
    pub internal: f64,
    /// The watchdog's oscillator (Hz): 17 000 to 47 000.
    pub watchdog_hz: u64,
    /// How long erases take.
    pub erase: EraseTimes,
}

impl Default for Part {
    fn default() -> Self {
        Part {
            cycles_per_instruction: 1.3,
            crystal: Crystal::Good,
            internal: 1.003,
            watchdog_hz: 32_000,
            erase: EraseTimes::LONGEST,
        }
    }
}

/// The part.
pub struct Chip {
    /// The time, in units since the power came.
    pub now: u64,
    pub(crate) next_event: u64,
    /// The core has to look at the chip before it goes on.
    pub(crate) attention: bool,
    pub(crate) fault: bool,
    /// Events are being done: an access by a stream meets no others.
    advancing: bool,
    pub(crate) ram: Vec<u8>,
    ccm: Vec<u8>,
    pub(crate) backup: [u32; BACKUP_WORDS],
    /// The flash with its controller.
    pub(crate) flash: Flash,
    /// The system control space.
    pub scs: Scs,
    pub(crate) rcc: Rcc,
    iwdg: Iwdg,
    ports: [Port; 9],
    timers: [Timer; 8],
    adc: Adc,
    dma: Dma,
    pub(crate) uart: Uart,
    spi: Spi,
    pub(crate) sensors: Sensors,
    /// Registers without a meaning in this model: what was written is read.
    plain: std::collections::BTreeMap<u32, u32>,
    /// EXTI's line of the voltage detector is pending.
    supply_sank: bool,
    periods: Periods,
    part: Part,
    /// The reset that is to come.
    pub(crate) reset: Option<Reset>,
    /// Exceptions that are held back until a time: a long critical section, or another priority.
    pub(crate) held: (u128, u64),
    /// The notes.
    pub trace: Trace,
    /// The mechanics.
    pub world: Box<dyn World>,
}

impl Chip {
    pub(crate) fn new(part: Part, world: Box<dyn World>) -> Self {
        let rcc = Rcc::new(part.crystal, part.internal);
        let periods = rcc.periods();
        let mut chip = Chip {
            now: 0,
            next_event: 0,
            attention: true,
            fault: false,
            advancing: false,
            // What memory holds when the power comes is anything.
            ram: (0..RAM_BYTES).map(|i| (i * 167 + 13) as u8).collect(),
            ccm: vec![0xa5; CCM_BYTES],
            backup: [0; BACKUP_WORDS],
            flash: Flash::new(part.erase),
            scs: Scs::new(),
            rcc,
            iwdg: Iwdg::new(part.watchdog_hz),
            ports: std::array::from_fn(Port::after_reset),
            timers: timers(),
            adc: Adc::new(),
            dma: Dma::new(),
            uart: Uart::new(),
            spi: Spi::new(),
            sensors: Sensors::default(),
            plain: Default::default(),
            supply_sank: false,
            periods,
            part,
            reset: None,
            held: (0, 0),
            trace: Trace::default(),
            world,
        };
        chip.take_clock();
        chip
    }

    /// A reset of everything but the memories and the backup domain.
    pub(crate) fn reset(&mut self, why: Reset) {
        const PIN: u32 = 1 << 26;
        let flags = match why {
            Reset::Watchdog => PIN | 1 << 29,
            Reset::Software => PIN | 1 << 28,
            Reset::BrownOut => PIN | 1 << 25,
        };
        self.rcc.reset(flags);
        self.scs = Scs::new();
        self.iwdg = Iwdg::new(self.part.watchdog_hz);
        self.ports = std::array::from_fn(Port::after_reset);
        self.timers = timers();
        self.adc = Adc::new();
        self.dma = Dma::new();
        self.uart.reset();
        self.spi = Spi::new();
        self.plain.clear();
        self.supply_sank = false;
        self.flash.reset();
        self.trace.was_reset(self.now, why);
        self.periods = self.rcc.periods();
        self.take_clock();
        self.note_drive();
        self.reset = None;
        self.attention = true;
    }

    /// The supply sinks to 2.85 V for a time: the voltage detector sees it at level 7, if it is on, and passes it on.
    pub(crate) fn sink_supply(&mut self) {
        let has = |at: u32, bits: u32| self.plain.get(&at).is_some_and(|v| v & bits == bits);
        let watched = has(PWR_CR, 7 << 5 | 1 << 4);
        self.supply_sank = watched && has(EXTI_RTSR, SUPPLY) && has(EXTI_IMR, SUPPLY);
        self.attention = true;
    }

    /// Forgets what only the supply keeps.
    pub(crate) fn lose_power(&mut self) {
        for (index, byte) in self.ram.iter_mut().enumerate() {
            *byte = (index * 91 + 7) as u8;
        }
        self.backup = [0; BACKUP_WORDS];
    }

    /// The length of a core's cycle, in units.
    pub(crate) fn cycle(&self) -> u64 {
        self.periods.core
    }

    pub(crate) fn instruction_time(&self) -> u64 {
        (self.periods.core as f64 * self.part.cycles_per_instruction) as u64
    }

    /// The time in seconds since the power came.
    pub fn seconds(&self) -> f64 {
        self.now as f64 / UNITS_PER_SECOND as f64
    }

    /// Whether PB12 holds the motor stage's gate driver off.
    pub fn gate_driver_is_off(&self) -> bool {
        self.ports[1].is_low(12)
    }

    /// Whether the status light, PC4, is on.
    pub fn light(&self) -> bool {
        self.ports[2].is_high(4)
    }

    /// Whether the force output's pin is an input.
    pub fn force_pin_is_input(&self) -> bool {
        self.ports[1].mode(3) == 0
    }

    /// Whether the trace has its pins, PB3 among them.
    pub fn trace_has_pins(&self) -> bool {
        let cr = self.plain.get(&DBGMCU_CR).copied().unwrap_or(0);
        cr & TRACE_IOEN != 0
    }

    /// A debugger gives the trace its pins; only a power cut takes them back.
    pub(crate) fn give_trace_its_pins(&mut self) {
        *self.plain.entry(DBGMCU_CR).or_insert(0) |= TRACE_IOEN;
    }

    /// Hands the periods of the clocks to those who run on them.
    fn take_clock(&mut self) {
        let new = self.rcc.periods();
        if new.core != self.periods.core {
            let old = self.periods.core;
            self.scs.new_clock(self.now, old, new.core);
        }
        self.periods = new;
        for (index, timer) in self.timers.iter_mut().enumerate() {
            let period = match index {
                0 | 7 => new.timers2,
                _ => new.timers1,
            };
            timer.set_clock(self.now, period);
        }
        self.adc.set_clock(new.apb2);
        self.uart.set_clock(new.apb1);
        self.spi.set_clock(new.apb1);
    }

    /// Notes what drives the force output.
    fn note_drive(&mut self) {
        const PB3: u32 = 3;
        const TIM2: usize = 1;
        let port = &self.ports[1];
        let drive = match (port.mode(PB3), port.alternate(PB3)) {
            (2, Some(1)) => self.timers[TIM2].share(1, self.now, self.rcc.stopped),
            (1, _) => Some(f64::from(u8::from(port.is_high(PB3)))),
            _ => None,
        };
        let drive = drive.map_or(Drive::Floating, Drive::Share);
        self.trace.driven(self.now, drive);
        self.world.driven(self.now, drive);
    }
}

fn timers() -> [Timer; 8] {
    // TIM2 and TIM5 have 32 bits.
    std::array::from_fn(|index| Timer::new(index == 1 || index == 4))
}
