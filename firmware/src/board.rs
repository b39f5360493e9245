//! The seam between the application and a board. Everything above it is the same on every board and in the
//! emulator; everything below it is one folder in `board/`.
//!
//! The `mod.rs` of a board's folder has two names, which this module passes on:
//!
//! - `Selected`, the type that implements [`Board`];
//! - `device`, a module of the form that RTIC expects of a device crate. It has `NVIC_PRIO_BITS`, the number
//!   of priority bits of the part, and `interrupt` with two interrupts under the names by which `main.rs`
//!   binds them. The board raises `TICK` once a millisecond. `SPARE` is an interrupt that the board has no
//!   other use for: RTIC starts the telemetry task with it.
//!
//! RTIC gives the two handlers the symbols `TICK` and `SPARE`. A part with a crate of its own has other
//! names in its vector table; a linker script `vectors.x` in the folder then sets one equal to the other
//! (`f405/vectors.x`). A folder without such a crate brings the table itself (`qemu/device.rs`, `device.x`).
//! A `memory.x` in the folder takes precedence over the one in the repository's root.

// One line for each board; build.rs checks that exactly one of their features is on.
#[cfg_attr(feature = "f405", path = "board/f405/mod.rs")]
#[cfg_attr(feature = "qemu", path = "board/qemu/mod.rs")]
mod selected;

pub use selected::{Selected, device};

use embedded_hal::digital::OutputPin;
use embedded_storage::nor_flash::NorFlash;
use estimator_core::board::{history::ResetCause, sampling::Reading, settings::store::Store};

/// A board as a whole: how it starts, its stopwatch, and how it ends.
pub trait Board {
    /// The name of the board, for logs.
    const NAME: &'static str;
    /// The unit of [`Board::now`] in the plural: "cycles", "instructions".
    const COST_UNIT: &'static str;
    /// Length of a tick, in [`Board::COST_UNIT`].
    const TICK: u32;

    /// The sensors belong to the sampling task.
    type Sensors: Sensors + Send;
    /// The link belongs to the telemetry task.
    type Link: Link + Send;
    /// The status light is an output of any kind.
    type Light: OutputPin + Send;
    /// The flash keeps the settings.
    type Flash: NorFlash + Send;
    /// The watchdog resets the board when it is not fed.
    type Watchdog: Watchdog + Send;
    /// The force output takes the rendered force.
    type Output: ForceOutput + Send;

    /// Brings the board up. It raises no tick before [`Sensors::start`].
    ///
    /// Every wait for something that may be absent (a crystal) has a bound, and the log names the
    /// replacement. Without any replacement, the log says so and the function does not return.
    fn start(core: cortex_m::Peripherals) -> Parts<Self>;

    /// Reads a free-running counter in [`Board::COST_UNIT`] that wraps at 2³². Differences are right up to
    /// 4 s (emulator) or 51 s (F405). No debugger stops it. Takes no more than a load.
    fn now() -> u32;

    /// Waits, called over and over while there is nothing to do. Returns with the next tick at the latest.
    fn idle();

    /// Puts the force output into the state that it has after a reset, at once and for good. It is the first thing
    /// that a program does which cannot go on, from any task or exception.
    fn make_safe();

    /// Ends the program; a healthy board never calls it. The emulator exits with a status. A board stops
    /// with interrupts off and with its outputs, the force output included, as they are after a reset; its
    /// watchdog then starts it again.
    fn stop(outcome: Outcome) -> !;
}

/// The parts of a board that has started.
pub struct Parts<B: Board + ?Sized> {
    /// The sensors go to the sampling task.
    pub sensors: B::Sensors,
    /// The link goes to the telemetry task, like the parts below.
    pub link: B::Link,
    /// The status light.
    pub light: B::Light,
    /// The store has the flash sectors that are reserved for settings. An erase may stall the core for
    /// seconds.
    pub store: Store<B::Flash>,
    /// The watchdog. It may run from the start, long enough for it, or begin with the first [`Watchdog::feed`].
    pub watchdog: B::Watchdog,
    /// The force output goes to the sampling task, except while settings are saved.
    pub output: B::Output,
    /// True if a replacement drives the clock: times are off by more than a crystal's, on the F405 by up to 1 % at
    /// 25 °C and by 8 % from −40 to 105 °C.
    pub clock_fallback: bool,
    /// The cause of the reset before this start.
    pub reset: ResetCause,
}

/// The source of the samples.
pub trait Sensors {
    /// Counts after which the encoder's counter begins again: a position after many missed ticks may be off by as much,
    /// which is then a fault. 0: it never begins again.
    const COUNTS: u32;

    /// Starts the ticks. It is the last thing that the start does: a tick that nobody takes for milliseconds would
    /// give all later ones a false phase.
    fn start(&mut self);

    /// Reads the instant that belongs to this tick. Only the sampling task calls it, once a tick.
    ///
    /// Force and position are of the same instant. `time_us` increases strictly and also counts the
    /// instants that were missed, so that a gap in the data is a gap in time. The board sets the faults that
    /// only it can see (a late call, an error flag of a sensor). The call blocks for a tenth of a tick at
    /// most and does not fail: without an instant it returns [`Acquired::Nothing`].
    fn sample(&mut self) -> Acquired;
}

/// The way of the frames to the host, and of the commands from it.
pub trait Link {
    /// Returns how many bytes [`Link::send`] takes now. The number grows as the hardware sends, and shrinks
    /// only with what is sent.
    fn room(&self) -> usize;

    /// Queues at most [`Link::room`] bytes and cuts off the rest. Does not block.
    fn send(&mut self, bytes: &[u8]);

    /// Starts the hardware on the queued bytes; called after every batch. Does not block.
    fn poll(&mut self);

    /// Returns the next byte from the host, if there is one. Bytes that nobody fetches in time are lost.
    fn receive(&mut self) -> Option<u8>;

    /// Sends everything that is queued; called once before [`Board::stop`]. May block.
    fn finish(&mut self);
}

/// A timer that resets the board when it is not fed.
pub trait Watchdog {
    /// Restarts the timer, called every tenth of a second while the sampling task meets its deadlines. From the
    /// first call on the timer is at least 0.3 s long and at most 1 s, whatever the speed of its oscillator.
    fn feed(&mut self);

    /// Makes the timer longer until it is fed again: more than the 4 s that an erase of the flash may take.
    fn lengthen(&mut self);
}

/// The force command: an analog or PWM signal to whatever drives a master, an amplifier with a current
/// loop of its own. It is a force on the operator's hand and no motion; the firmware never asks where the
/// master goes. The settings say what a code is in newtons (`render.full_n`, `render.zero`).
pub trait ForceOutput {
    /// The code of the full output; 0 is no output.
    const FULL: u16;

    /// Puts out a code of at most [`ForceOutput::FULL`] until the next call, or for 1.8 ms: without another call
    /// the hardware then puts out `rest`, the code of 0 N, and needs no instruction for it. The code takes effect
    /// within a tick, and the call takes a microsecond at most. Called at every tick, with the code of 0 N
    /// while nothing is rendered.
    ///
    /// Before the first call and after [`Board::stop`] the output is as the hardware leaves it without a
    /// program: wire it so that this is 0 N.
    fn put(&mut self, code: u16, rest: u16);

    /// Returns whether the hardware has put the output to rest since the last [`ForceOutput::put`].
    fn rested(&mut self) -> bool;
}

/// The answer to [`Sensors::sample`].
pub enum Acquired {
    /// The sensors were read; with the stopwatch's reading at which the instant was due.
    Reading(Reading, u32),
    /// The call was spurious: there is no new instant.
    Nothing,
    /// The recording is used up; only the emulator has one.
    End,
}

/// The way in which a program ends.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// The recording was processed.
    Done,
    /// Something is broken; the log says what.
    Failed,
}
