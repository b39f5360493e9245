//! Where a program goes that cannot go on: says why, then stops. The board has commanded nothing,
//! so there is nothing to bring to a safe state.

use core::panic::PanicInfo;
use cortex_m_rt::{ExceptionFrame, exception};
use palpate_firmware::board::{Board, Outcome, Selected};

#[panic_handler]
fn panic(info: &PanicInfo) -> ! {
    defmt::error!("{}", defmt::Display2Format(info));
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
