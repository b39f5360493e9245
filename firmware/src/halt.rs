//! The end of a program that cannot go on: it puts the force output to rest, keeps why for the next start, logs
//! it, and stops. The board has commanded no motion.

use core::panic::PanicInfo;
use cortex_m_rt::{ExceptionFrame, exception};
use estimator_core::board::history::CrashKind;
use palpate_firmware::board::{Board, Outcome, Selected};
use palpate_firmware::crash;

#[panic_handler]
fn panic(info: &PanicInfo) -> ! {
    Selected::make_safe();
    let location = info.location();
    crash::remember(CrashKind::Panic, location.map_or(0, |at| at.line()), 0);
    // Only the location is logged: the message would need 3 KiB of formatting that nothing else uses.
    match location {
        Some(at) => defmt::error!("panic at {=str}:{=u32}", at.file(), at.line()),
        None => defmt::error!("panic"),
    }
    Selected::stop(Outcome::Failed)
}

/// Stops after `defmt::panic!`, which has logged its message already; a log blocks nobody.
#[defmt::panic_handler]
fn defmt_panic() -> ! {
    Selected::make_safe();
    crash::remember(CrashKind::Panic, 0, 0);
    Selected::stop(Outcome::Failed)
}

#[exception]
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    Selected::make_safe();
    crash::remember(CrashKind::HardFault, frame.pc(), frame.lr());
    defmt::error!(
        "hard fault at {=u32:#010x}, called from {=u32:#010x}",
        frame.pc(),
        frame.lr()
    );
    Selected::stop(Outcome::Failed)
}
