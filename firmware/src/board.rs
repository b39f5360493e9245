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
use estimator_core::Faults;
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

    /// Brings the board up. The tick may be raised from here on; RTIC delivers it after `init`.
    ///
    /// Waits with a bound for whatever may be absent (a crystal), and logs what had to replace it.
    fn start(
        core: cortex_m::Peripherals,
        device: pac::Peripherals,
    ) -> (Self::Sensors, Self::Link, Self::Light);

    /// A free-running counter in [`Board::COST_UNIT`], wrapping at 2³². Differences are right up to
    /// 4 s (emulator) or 25 s (board). Takes no more than a load.
    fn now() -> u32;

    /// Called over and over while there is nothing to do. Returns at the latest with the next tick.
    fn idle();

    /// Ends the program; never called on a healthy board. The emulator exits with a status, a
    /// board stops with interrupts off, its outputs as they are after reset.
    fn stop(outcome: Outcome) -> !;
}

/// Where the samples come from.
pub trait Sensors {
    /// The instant that belongs to this tick. Called once per tick, from the sampling task only.
    ///
    /// Force and position are of the same instant; `time_us` grows strictly and advances with the
    /// instants that were missed, so that a gap in the data is a gap in time. Faults that only the
    /// board can see (saturation, a late call) are set. Does not block and does not fail: without
    /// an instant it answers [`Acquired::Nothing`].
    fn sample(&mut self) -> Acquired;
}

/// Where the frames go.
pub trait Link {
    /// Bytes that [`Link::send`] takes now. Grows as the hardware sends; never shrinks by itself.
    fn room(&self) -> usize;

    /// Queues bytes, at most [`Link::room`] of them (more are cut off). Does not block.
    fn send(&mut self, bytes: &[u8]);

    /// Called after every batch: starts the hardware on what is queued. Does not block.
    fn poll(&mut self);

    /// Called once before [`Board::stop`]: everything queued goes out. May block.
    fn finish(&mut self);
}

/// The answer to [`Sensors::sample`].
pub enum Acquired {
    /// One instant.
    Sample(RawSample),
    /// A spurious call.
    Nothing,
    /// The recording is used up: the emulator only.
    End,
}

/// One instant as the hardware gave it.
#[derive(Clone, Copy)]
pub struct RawSample {
    /// Time since start (µs).
    pub time_us: u64,
    /// The encoder.
    pub position: Reading,
    /// The load cell.
    pub force: Reading,
    /// What the board knows to be wrong.
    pub faults: Faults,
}

/// A number from a converter and what one of it is worth.
#[derive(Clone, Copy)]
pub struct Reading {
    /// The converter's number, its zero already taken off.
    pub code: i32,
    /// SI units per code. A recording that is already in SI is code 1 of the recorded value: exact
    /// for every f32, NaN included.
    pub si_per_code: f32,
}

/// How a program ends.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// The recording was processed.
    Done,
    /// Something is broken; the log says what.
    Failed,
}
