//! The emulator: QEMU's `netduinoplus2`, an STM32F405 of which the core, the FPU, the NVIC and
//! SysTick work and the peripherals read 0 (README, "What the emulator shows, and what it cannot").
//!
//! Samples come from the file [`SAMPLES`], frames go into [`TELEMETRY`], commands come from [`COMMANDS`], the
//! codes of the force output go into [`FORCES`], and `settings.flash` keeps the settings, all in QEMU's working
//! directory. With `-icount shift=0,sleep=off` an instruction is 1 ns of virtual time.

pub mod device;
mod flash;

pub use self::Qemu as Selected;

use crate::board::{Acquired, Board, ForceOutput, Link, Outcome, Parts, Sensors, Watchdog};
use crate::systick;
use core::convert::Infallible;
use core::ffi::CStr;
use cortex_m::peripheral::SYST;
// The log goes to QEMU's standard output.
use defmt_semihosting as _;
use embedded_hal::digital::{ErrorType, OutputPin};
use estimator_core::board::frame::{Decoder, Frame};
use estimator_core::board::history::ResetCause;
use estimator_core::board::link::RECORD_ROOM;
use estimator_core::board::ram_flash::{RamFlash, SECTOR};
use estimator_core::board::sampling::{FULL, RATE_HZ, Reading};
use estimator_core::board::settings::store::Store;
use semihosting::fs::File;
use semihosting::io::{Read, Write};

/// File of the samples: the frames [`Frame::Sample`] and [`Frame::Codes`] in it are used, others skipped.
const SAMPLES: &CStr = c"samples.frames";
/// File into which the frames go.
const TELEMETRY: &CStr = c"telemetry.frames";
/// File of the commands, if it exists at the start; it may grow while the emulator runs.
const COMMANDS: &CStr = c"commands.frames";
/// File of the force output: for each code that differs from the one before it, the number of the tick
/// (u32) and the code (u16).
const FORCES: &CStr = c"force.codes";
/// Ticks between two looks for commands: a look costs the host microseconds.
const LOOK_EVERY: u32 = 32;

/// Bytes that a semihosting call moves: it stops the emulator for microseconds of real time, and a block
/// holds about 100 samples.
const BLOCK: usize = 4096;

/// Clock of the machine's SysTick (Hz), as on the F405.
const CORE_HZ: u32 = 168_000_000;

/// Address of the counter of the machine's timer TIM2 (reference manual RM0090, 18.4.10).
const TIM2_CNT: *const u32 = 0x4000_0024 as *const u32;

/// The emulated board.
pub struct Qemu;

impl Board for Qemu {
    const NAME: &'static str = "qemu";
    const COST_UNIT: &'static str = "instructions";
    const TICK: u32 = 1_000_000_000 / RATE_HZ;

    type Sensors = Recording;
    type Link = Output;
    type Light = NoLight;
    type Flash = RamFlash;
    type Watchdog = NoWatchdog;
    type Output = Recorded;

    fn start(core: cortex_m::Peripherals) -> Parts<Qemu> {
        Parts {
            sensors: Recording::open(core.SYST),
            link: Output::create(),
            light: NoLight,
            store: Store::new(flash::open(), 0, SECTOR),
            watchdog: NoWatchdog,
            output: Recorded::create(),
            clock_fallback: false,
            reset: ResetCause::PowerOn,
        }
    }

    /// Reads TIM2, which runs at 1 GHz here whatever is written to it. Under `shift=0` a nanosecond is an
    /// instruction, so the count is exact; SysTick's 168 MHz would resolve six instructions. (The DWT
    /// counter reads 0.)
    fn now() -> u32 {
        // SAFETY: the address is that of a register of the machine, and a load does not change it.
        unsafe { TIM2_CNT.read_volatile() }
    }

    /// Waits without `wfi`: with `sleep=off`, QEMU 7.2 goes past the first tick to the second before the core
    /// wakes, and a tick takes 2 ms. Instructions that do nothing serve as well: a tick full of them takes the
    /// host 27 µs in runs of 400 (75 µs in runs of 100), and a tick ends a run early.
    fn idle() {
        // SAFETY: the instructions do nothing.
        unsafe { core::arch::asm!(".rept 400", "nop", ".endr", options(nomem, nostack)) }
    }

    fn make_safe() {}

    fn stop(outcome: Outcome) -> ! {
        semihosting::process::exit(match outcome {
            Outcome::Done => 0,
            Outcome::Failed => 1,
        })
    }
}

/// Sensors that read a file.
pub struct Recording {
    file: File,
    block: [u8; BLOCK],
    used: usize,
    filled: usize,
    decoder: Decoder,
    tick: Option<SYST>,
}

impl Recording {
    fn open(tick: SYST) -> Self {
        let Ok(file) = File::open(SAMPLES) else {
            defmt::panic!("cannot open samples.frames in QEMU's working directory");
        };
        Recording {
            file,
            block: [0; BLOCK],
            used: 0,
            filled: 0,
            decoder: Decoder::new(),
            tick: Some(tick),
        }
    }

    fn next_byte(&mut self) -> Option<u8> {
        if self.used == self.filled {
            self.used = 0;
            self.filled = match self.file.read(&mut self.block) {
                Ok(count) => count,
                Err(_) => defmt::panic!("cannot read on in samples.frames"),
            };
        }
        let byte = *self.block[..self.filled].get(self.used)?;
        self.used += 1;
        Some(byte)
    }
}

impl Sensors for Recording {
    // A recording has positions without the wraps of a counter.
    const COUNTS: u32 = 0;

    fn start(&mut self) {
        if let Some(tick) = self.tick.take() {
            systick::start(tick, CORE_HZ, 1);
        }
    }

    fn sample(&mut self) -> Acquired {
        // The machine has no latency: a tick starts when it is due.
        let due = Qemu::now();
        while let Some(byte) = self.next_byte() {
            match self.decoder.push(byte) {
                Some(Ok((_, Frame::Sample(sample)))) => {
                    return Acquired::Reading(Reading::Sample(sample), due);
                }
                Some(Ok((_, Frame::Codes(codes)))) => {
                    return Acquired::Reading(Reading::Codes(codes), due);
                }
                Some(Ok(_)) | None => {}
                Some(Err(error)) => {
                    defmt::panic!("samples.frames: {}", defmt::Debug2Format(&error))
                }
            }
        }
        Acquired::End
    }
}

/// A link that writes a file.
pub struct Output {
    file: File,
    block: heapless::Vec<u8, BLOCK>,
    commands: Option<File>,
    received: heapless::Deque<u8, 64>,
    looks: u32,
}

impl Output {
    fn create() -> Self {
        let Ok(file) = File::create(TELEMETRY) else {
            defmt::panic!("cannot create telemetry.frames in QEMU's working directory");
        };
        Output {
            file,
            block: heapless::Vec::new(),
            commands: File::open(COMMANDS).ok(),
            received: heapless::Deque::new(),
            looks: 0,
        }
    }

    /// Reads commands that have come since the last look. At the end of the file it reads nothing.
    fn look_for_commands(&mut self) {
        let mut bytes = [0; 64];
        let count = match &mut self.commands {
            Some(file) => file.read(&mut bytes).unwrap_or(0),
            None => 0,
        };
        for byte in bytes.iter().take(count) {
            // All fit: the queue is empty here.
            let _ = self.received.push_back(*byte);
        }
    }
}

impl Link for Output {
    fn room(&self) -> usize {
        self.block.capacity() - self.block.len()
    }

    fn send(&mut self, bytes: &[u8]) {
        let fits = bytes.len().min(self.room());
        // The slice is cut to the room, so it fits.
        let _ = self.block.extend_from_slice(&bytes[..fits]);
    }

    fn poll(&mut self) {
        if self.room() < 2 * RECORD_ROOM {
            self.finish();
        }
    }

    fn receive(&mut self) -> Option<u8> {
        if self.received.is_empty() {
            self.looks += 1;
            if self.looks >= LOOK_EVERY {
                self.looks = 0;
                self.look_for_commands();
            }
        }
        self.received.pop_front()
    }

    fn finish(&mut self) {
        if self.file.write_all(&self.block).is_err() {
            defmt::panic!("cannot write telemetry.frames");
        }
        self.block.clear();
    }
}

/// A force output that writes a file.
pub struct Recorded {
    file: File,
    tick: u32,
    last: Option<u16>,
}

impl Recorded {
    fn create() -> Self {
        let Ok(file) = File::create(FORCES) else {
            defmt::panic!("cannot create force.codes in QEMU's working directory");
        };
        Recorded {
            file,
            tick: 0,
            last: None,
        }
    }
}

impl ForceOutput for Recorded {
    const FULL: u16 = FULL;

    fn put(&mut self, code: u16, _rest: u16) {
        if self.last.replace(code) != Some(code) {
            let [a, b, c, d] = self.tick.to_le_bytes();
            let [low, high] = code.to_le_bytes();
            if self.file.write_all(&[a, b, c, d, low, high]).is_err() {
                defmt::panic!("cannot write force.codes");
            }
        }
        self.tick = self.tick.wrapping_add(1);
    }

    fn rested(&mut self) -> bool {
        false
    }
}

/// A watchdog that is never fed and never resets: the machine's watchdog does nothing.
pub struct NoWatchdog;

impl Watchdog for NoWatchdog {
    fn feed(&mut self) {}

    fn lengthen(&mut self) {}
}

/// A light that nobody sees: the machine has none.
pub struct NoLight;

impl ErrorType for NoLight {
    type Error = Infallible;
}

impl OutputPin for NoLight {
    fn set_low(&mut self) -> Result<(), Infallible> {
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}
