//! Ctrl-C: a verb that runs until it is stopped ends as it would by itself; any other leaves nothing half
//! written and ends with status 130, as shells expect.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::output::remove_unfinished;

/// Whether a verb looks at [`is_interrupted`].
static WATCHED: AtomicBool = AtomicBool::new(false);
static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Exit status of a process that Ctrl-C ended: 128 and the number of the signal.
const STATUS: i32 = 130;

/// Takes Ctrl-C from here on. Without it, the system's way stays.
pub fn catch() {
    // A second handler, or a system without signals: Ctrl-C ends the process as ever.
    let _ = ctrlc::set_handler(|| {
        let first = !INTERRUPTED.swap(true, Ordering::Relaxed);
        if first && WATCHED.load(Ordering::Relaxed) {
            return;
        }
        remove_unfinished();
        std::process::exit(STATUS);
    });
}

/// Says that the verb ends by itself once [`is_interrupted`]; a second Ctrl-C ends it at once.
pub fn watch() {
    WATCHED.store(true, Ordering::Relaxed);
}

/// Whether Ctrl-C was pressed.
pub fn is_interrupted() -> bool {
    INTERRUPTED.load(Ordering::Relaxed)
}
