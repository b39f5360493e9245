//! Where a program goes that cannot go on: says why, then stops. The board has commanded no motion; the
//! force that it may put out goes with [`Board::stop`].

use core::panic::PanicInfo;
use cortex_m_rt::{ExceptionFrame, exception};
use palpate_firmware::board::{Board, Outcome, Selected};

#[panic_handler]
fn panic(info: &PanicInfo) -> ! {
    // Where, and not what: the text needs 3 KiB of formatting that nothing else does.
    match info.location() {
        Some(at) => defmt::error!("panic at {=str}:{=u32}", at.file(), at.line()),
        None => defmt::error!("panic"),
    }
    Selected::stop(Outcome::Failed)
}

/// `defmt::panic!` has already logged its message.
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
