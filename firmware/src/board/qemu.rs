//! The emulator: QEMU's `netduinoplus2`, an STM32F405 of which the core, the FPU, the NVIC and
//! SysTick work and the peripherals read 0 (README, "What the emulator cannot show").
//!
//! Samples come from the file [`SAMPLES`], frames go into [`TELEMETRY`], commands come from
//! [`COMMANDS`], the force output's codes go into [`FORCES`] and settings are kept in `settings.flash`, all
//! in QEMU's working directory. Run with `-icount shift=0,sleep=off`: 1 instruction is then 1 ns of virtual time.

mod flash;

use super::{Acquired, Board, ForceOutput, Link, Outcome, Parts, RATE_HZ, Sensors, Watchdog};
use core::convert::Infallible;
use core::ffi::CStr;
use cortex_m::peripheral::{NVIC, syst::SystClkSource};
use cortex_m_rt::exception;
use embedded_hal::digital::{ErrorType, OutputPin};
use estimator_core::board::frame::{Decoder, Frame, MAX_ENCODED, RECORD_ENCODED};
use estimator_core::board::settings::store::Store;
use flash::{FlashFile, SECTOR};
use semihosting::fs::File;
use semihosting::io::{Read, Write};
use stm32f4xx_hal::pac;

/// Where the samples come from: frames, of which [`Frame::Sample`] and [`Frame::Codes`] are used and
/// others skipped.
const SAMPLES: &CStr = c"samples.frames";
/// Where the frames go.
const TELEMETRY: &CStr = c"telemetry.frames";
/// Where commands come from, if it is there at the start; may grow while the emulator runs.
const COMMANDS: &CStr = c"commands.frames";
/// Where the codes of the force output go: of each that differs from the one before it, the number of
/// the tick (u32) and the code (u16).
const FORCES: &CStr = c"force.codes";
/// Ticks between two looks into it: a look costs the host microseconds.
const LOOK_EVERY: u32 = 32;

/// A semihosting call stops the emulator for microseconds of real time: one per 100 samples.
const BLOCK: usize = 4096;

/// What the machine's SysTick runs at, like the board.
const CORE_HZ: u32 = 168_000_000;

/// The emulated board.
pub struct Qemu;

impl Board for Qemu {
    const NAME: &'static str = "qemu";
    const COST_UNIT: &'static str = "instructions";
    const TICK: u32 = 1_000_000_000 / RATE_HZ;

    type Sensors = Recording;
    type Link = Output;
    type Light = NoLight;
    type Flash = FlashFile;
    type Watchdog = NoWatchdog;
    type Output = Recorded;

    fn start(mut core: cortex_m::Peripherals, _: pac::Peripherals) -> Parts<Qemu> {
        let parts = Parts {
            sensors: Recording::open(),
            link: Output::create(),
            light: NoLight,
            store: Store::new(FlashFile::open(), 0, SECTOR),
            watchdog: NoWatchdog,
            output: Recorded::create(),
            clock_fallback: false,
        };
        core.SYST.set_clock_source(SystClkSource::Core);
        core.SYST.set_reload(CORE_HZ / RATE_HZ - 1);
        core.SYST.clear_current();
        core.SYST.enable_interrupt();
        core.SYST.enable_counter();
        parts
    }

    /// TIM2 runs at 1 GHz here whatever is written to it, and under `shift=0` a nanosecond is an
    /// instruction: exact, where SysTick's 168 MHz would resolve six. (The DWT counter reads 0.)
    fn now() -> u32 {
        // SAFETY: a load of a register that nothing else in this build uses.
        unsafe { (*pac::TIM2::ptr()).cnt().read().bits() }
    }

    /// Not `wfi`: with `sleep=off`, QEMU 7.2 goes past the first tick to the second before the core
    /// wakes, and a tick takes 2 ms. Instructions that do nothing are as good: a tick full of them
    /// takes the host 27 µs in runs of 400 (75 µs in runs of 100), and a tick ends a run early.
    fn idle() {
        // SAFETY: no operation.
        unsafe { core::arch::asm!(".rept 400", "nop", ".endr", options(nomem, nostack)) }
    }

    fn stop(outcome: Outcome) -> ! {
        semihosting::process::exit(match outcome {
            Outcome::Done => 0,
            Outcome::Failed => 1,
        })
    }
}

/// The tick: stands in for the ADC's DMA stream.
#[exception]
fn SysTick() {
    NVIC::pend(pac::Interrupt::DMA2_STREAM0);
}

/// Sensors that read a file.
pub struct Recording {
    file: File,
    block: [u8; BLOCK],
    used: usize,
    filled: usize,
    decoder: Decoder,
}

impl Recording {
    fn open() -> Self {
        let Ok(file) = File::open(SAMPLES) else {
            defmt::panic!("cannot open samples.frames in QEMU's working directory");
        };
        Recording {
            file,
            block: [0; BLOCK],
            used: 0,
            filled: 0,
            decoder: Decoder::new(),
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
    fn sample(&mut self) -> Acquired {
        while let Some(byte) = self.next_byte() {
            match self.decoder.push(byte) {
                Some(Ok((_, Frame::Sample(sample)))) => return Acquired::Sample(sample),
                Some(Ok((_, Frame::Codes(codes)))) => return Acquired::Codes(codes),
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

    /// At the end of the file there is nothing, until there is more.
    fn look_for_commands(&mut self) {
        let mut bytes = [0; 64];
        let count = match &mut self.commands {
            Some(file) => file.read(&mut bytes).unwrap_or(0),
            None => 0,
        };
        for byte in bytes.iter().take(count) {
            // As many as fit: it is empty here.
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
        // Cut to what fits, so that it does.
        let _ = self.block.extend_from_slice(&bytes[..fits]);
    }

    fn poll(&mut self) {
        if self.room() < MAX_ENCODED + 2 * RECORD_ENCODED {
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
    /// As on the F405.
    const FULL: u16 = 2625;

    fn put(&mut self, code: u16) {
        if self.last.replace(code) != Some(code) {
            let [a, b, c, d] = self.tick.to_le_bytes();
            let [low, high] = code.to_le_bytes();
            if self.file.write_all(&[a, b, c, d, low, high]).is_err() {
                defmt::panic!("cannot write force.codes");
            }
        }
        self.tick = self.tick.wrapping_add(1);
    }
}

/// The machine's watchdog does nothing.
pub struct NoWatchdog;

impl Watchdog for NoWatchdog {
    fn feed(&mut self) {}
}

/// The machine has no light.
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
