//! What survives a reset: words of memory that the start of the program leaves as they are.

use core::sync::atomic::{AtomicU32, Ordering};
use estimator_core::board::history::{Crash, CrashKind, History, ResetCause, Stage};

/// The words of the last crash, with their check sum.
#[unsafe(link_section = ".uninit.PALPATE_CRASH")]
static WORDS: [AtomicU32; 4] = [const { AtomicU32::new(0) }; 4];
/// What the program is doing.
#[unsafe(link_section = ".uninit.PALPATE_STAGE")]
static STAGE: AtomicU32 = AtomicU32::new(0);

/// Notes what the program is doing, and returns what it did before.
#[inline]
pub fn mark(stage: Stage) -> Stage {
    let before = STAGE.load(Ordering::Relaxed);
    STAGE.store(stage as u32, Ordering::Relaxed);
    Stage::with_code(before as u8).unwrap_or_default()
}

/// Keeps what ends this run, for the next one. The first word counts: what follows from it is no cause.
pub fn remember(kind: CrashKind, at: u32, from: u32) {
    if Crash::from_words(WORDS.each_ref().map(load)).is_some() {
        return;
    }
    let stage = Stage::with_code(load(&STAGE) as u8).unwrap_or_default();
    let crash = Crash {
        kind,
        stage,
        at,
        from,
    };
    for (kept, word) in WORDS.iter().zip(crash.to_words()) {
        kept.store(word, Ordering::Relaxed);
    }
}

/// Returns what ended the run before, and forgets it, so that it is told once.
pub fn found(reset: ResetCause) -> History {
    let history = History::found(reset, WORDS.each_ref().map(load), load(&STAGE) as u8);
    for word in &WORDS {
        word.store(0, Ordering::Relaxed);
    }
    mark(Stage::Start);
    history
}

fn load(word: &AtomicU32) -> u32 {
    word.load(Ordering::Relaxed)
}
