//! The seam between the application and a board: everything above it is the same on the board and
//! in the emulator, everything below it is a file in `board/`.
//!
//! A board raises the interrupt [`DMA2_STREAM0`](stm32f4xx_hal::pac::Interrupt::DMA2_STREAM0) once
//! a millisecond: on the F405 it is the ADC's DMA stream, the emulator's tick pends it.

#[cfg(feature = "f405")]
mod f405;
#[cfg(feature = "qemu")]
mod qemu;

#[cfg(all(feature = "qemu", feature = "f405"))]
compile_error!("choose one board: `--no-default-features --features f405`, or the default `qemu`");
#[cfg(not(any(feature = "qemu", feature = "f405")))]
compile_error!("choose a board: `--features f405` or `--features qemu`");

/// The board that this build is for.
#[cfg(feature = "f405")]
pub use f405::F405 as Selected;
/// The board that this build is for.
#[cfg(feature = "qemu")]
pub use qemu::Qemu as Selected;

use embedded_hal::digital::OutputPin;
use embedded_storage::nor_flash::NorFlash;
use estimator_core::Sample;
use estimator_core::board::sensing::Codes;
use estimator_core::board::settings::store::Store;
use stm32f4xx_hal::pac;

/// Samples per second: the tick of every board.
pub const RATE_HZ: u32 = 1000;

/// The board as a whole: how to start it, its stopwatch, and how it ends.
pub trait Board {
    /// For logs.
    const NAME: &'static str;
    /// What [`Board::now`] counts, in the plural: "cycles", "instructions".
    const COST_UNIT: &'static str;
    /// How many of them pass between two ticks.
    const TICK: u32;

    /// Belongs to the sampling task.
    type Sensors: Sensors + Send;
    /// Belongs to the telemetry task.
    type Link: Link + Send;
    /// The status light, of whatever kind.
    type Light: OutputPin + Send;
    /// Where the settings are kept.
    type Flash: NorFlash + Send;
    /// Resets the board when it is not fed.
    type Watchdog: Watchdog + Send;
    /// Where the force goes that is rendered.
    type Output: ForceOutput + Send;

    /// Brings the board up. The tick may be raised from here on; RTIC delivers it after `init`.
    ///
    /// Waits with a bound for whatever may be absent (a crystal), and logs what had to replace it; where
    /// nothing can, it says so and does not return.
    fn start(core: cortex_m::Peripherals, device: pac::Peripherals) -> Parts<Self>;

    /// A free-running counter in [`Board::COST_UNIT`], wrapping at 2³². Differences are right up to
    /// 4 s (emulator) or 25 s (board). Takes no more than a load.
    fn now() -> u32;

    /// Called over and over while there is nothing to do. Returns at the latest with the next tick.
    fn idle();

    /// Ends the program; never called on a healthy board. The emulator exits with a status, a
    /// board stops with interrupts off, its outputs as they are after reset, the force's too; its
    /// watchdog then starts it again.
    fn stop(outcome: Outcome) -> !;
}

/// What a board is made of.
pub struct Parts<B: Board + ?Sized> {
    /// To the sampling task.
    pub sensors: B::Sensors,
    /// To the telemetry task, like the rest.
    pub link: B::Link,
    /// The status light.
    pub light: B::Light,
    /// The sectors that are reserved for settings. An erase may stall the core for seconds.
    pub store: Store<B::Flash>,
    /// Not running before its first meal.
    pub watchdog: B::Watchdog,
    /// To the sampling task, but while settings are saved.
    pub output: B::Output,
    /// Whether the clock is a replacement: times are off by up to 1 %.
    pub clock_fallback: bool,
}

/// Where the samples come from.
pub trait Sensors {
    /// The instant that belongs to this tick. Called once per tick, from the sampling task only.
    ///
    /// Force and position are of the same instant; `time_us` grows strictly and advances with the
    /// instants that were missed, so that a gap in the data is a gap in time. Faults that only the
    /// board can see (a late call, a sensor's own error flag) are set. Does not block longer than
    /// a tenth of a tick and does not fail: without an instant it answers [`Acquired::Nothing`].
    fn sample(&mut self) -> Acquired;
}

/// Where the frames go, and where commands come from.
pub trait Link {
    /// Bytes that [`Link::send`] takes now. Grows as the hardware sends; never shrinks by itself.
    fn room(&self) -> usize;

    /// Queues bytes, at most [`Link::room`] of them (more are cut off). Does not block.
    fn send(&mut self, bytes: &[u8]);

    /// Called after every batch: starts the hardware on what is queued. Does not block.
    fn poll(&mut self);

    /// The next byte from the host, if there is one. Bytes that nobody fetches in time are lost.
    fn receive(&mut self) -> Option<u8>;

    /// Called once before [`Board::stop`]: everything queued goes out. May block.
    fn finish(&mut self);
}

/// Resets the board when it is not fed.
pub trait Watchdog {
    /// Called while the sampling task meets its deadlines. A hunger of at least 8 s is survived:
    /// an erase of the flash may take 4.
    fn feed(&mut self);
}

/// The force command: an analog or PWM signal to whatever drives a master, an amplifier with a current
/// loop of its own. It is a force on the operator's hand and no motion; the firmware never asks where the
/// master goes. What a code is in newtons is settings (`render.full_n`, `render.zero`).
pub trait ForceOutput {
    /// The code of the full output; 0 is none.
    const FULL: u16;

    /// Puts out a code of at most [`ForceOutput::FULL`] until the next: within a tick, and takes a
    /// microsecond at most. Called at every tick, with the code of 0 N while nothing is rendered.
    ///
    /// Before the first call, and after [`Board::stop`], the output is what the hardware makes of it
    /// without a program: wire it so that this is 0 N.
    fn put(&mut self, code: u16);
}

/// The answer to [`Sensors::sample`].
pub enum Acquired {
    /// One instant, as the converters have it.
    Codes(Codes),
    /// One instant of a recording that is in SI units already: the emulator only.
    Sample(Sample<f32>),
    /// A spurious call.
    Nothing,
    /// The recording is used up: the emulator only.
    End,
}

/// How a program ends.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// The recording was processed.
    Done,
    /// Something is broken; the log says what.
    Failed,
}
