//! The end of a program that cannot go on: it logs why, then stops. The board has commanded no motion, and
//! [`Board::stop`] takes its force away.

use core::panic::PanicInfo;
use cortex_m_rt::{ExceptionFrame, exception};
use palpate_firmware::board::{Board, Outcome, Selected};

#[panic_handler]
fn panic(info: &PanicInfo) -> ! {
    // Only the location is logged: the message would need 3 KiB of formatting that nothing else uses.
    match info.location() {
        Some(at) => defmt::error!("panic at {=str}:{=u32}", at.file(), at.line()),
        None => defmt::error!("panic"),
    }
    Selected::stop(Outcome::Failed)
}

/// Stops after `defmt::panic!`, which has logged its message already.
#[defmt::panic_handler]
fn defmt_panic() -> ! {
    Selected::stop(Outcome::Failed)
}

#[exception]
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    defmt::error!(
        "hard fault at {=u32:#010x}, called from {=u32:#010x}",
        frame.pc(),
        frame.lr()
    );
    Selected::stop(Outcome::Failed)
}
