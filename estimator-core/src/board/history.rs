//! Why a board started, and what ended the run before: words that survive a reset in memory that the start
//! does not clear.

/// The cause of the last reset. The numbers are stable.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
#[non_exhaustive]
pub enum ResetCause {
    /// The board does not know.
    #[default]
    Unknown = 0,
    /// The supply came.
    PowerOn = 1,
    /// The supply sagged and came back.
    BrownOut = 2,
    /// The reset pin, or a debugger.
    Pin = 3,
    /// The program asked for it.
    Software = 4,
    /// The watchdog was not fed.
    Watchdog = 5,
}

impl ResetCause {
    const ALL: [ResetCause; 6] = [
        ResetCause::Unknown,
        ResetCause::PowerOn,
        ResetCause::BrownOut,
        ResetCause::Pin,
        ResetCause::Software,
        ResetCause::Watchdog,
    ];

    /// The cause with a number; one that this version does not know is [`ResetCause::Unknown`].
    pub fn with_code(code: u8) -> ResetCause {
        let mut all = ResetCause::ALL.into_iter();
        all.find(|cause| *cause as u8 == code).unwrap_or_default()
    }

    /// A few words for people.
    pub const fn describe(self) -> &'static str {
        match self {
            ResetCause::Unknown => "unknown",
            ResetCause::PowerOn => "power on",
            ResetCause::BrownOut => "supply sagged",
            ResetCause::Pin => "reset pin or debugger",
            ResetCause::Software => "software",
            ResetCause::Watchdog => "watchdog",
        }
    }
}

/// What ended a run. The numbers are stable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
#[non_exhaustive]
pub enum CrashKind {
    /// The program found that it cannot go on; [`Crash::at`] is the line of its source.
    Panic = 1,
    /// The core met an instruction or an address that it cannot use; [`Crash::at`] is the program counter.
    HardFault = 2,
    /// The crystal died.
    ClockFailed = 3,
    /// Nothing fed the watchdog, and nothing said why.
    Hang = 4,
    /// The supply sank so far that the flash might be read wrong.
    SupplySank = 5,
}

impl CrashKind {
    const ALL: [CrashKind; 5] = [
        CrashKind::Panic,
        CrashKind::HardFault,
        CrashKind::ClockFailed,
        CrashKind::Hang,
        CrashKind::SupplySank,
    ];

    /// A few words for people.
    pub const fn describe(self) -> &'static str {
        match self {
            CrashKind::Panic => "panic",
            CrashKind::HardFault => "hard fault",
            CrashKind::ClockFailed => "crystal died",
            CrashKind::Hang => "hang",
            CrashKind::SupplySank => "supply sank",
        }
    }
}

/// What a program was doing. The numbers are stable.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
#[non_exhaustive]
pub enum Stage {
    /// It was starting.
    #[default]
    Start = 0,
    /// It waited for the next tick.
    Idle = 1,
    /// The sampling task read the sensors or converted their codes.
    Read = 2,
    /// The sampling task rendered a force.
    Render = 3,
    /// The sampling task estimated.
    Estimate = 4,
    /// The sampling task counted, or took over other settings.
    Count = 5,
    /// The telemetry task answered a command.
    Answer = 6,
    /// The telemetry task sent and logged.
    Send = 7,
    /// The telemetry task wrote to flash.
    Save = 8,
}

impl Stage {
    const ALL: [Stage; 9] = [
        Stage::Start,
        Stage::Idle,
        Stage::Read,
        Stage::Render,
        Stage::Estimate,
        Stage::Count,
        Stage::Answer,
        Stage::Send,
        Stage::Save,
    ];

    /// The stage with a number.
    pub fn with_code(code: u8) -> Option<Stage> {
        Stage::ALL.into_iter().find(|stage| *stage as u8 == code)
    }

    /// A few words for people.
    pub const fn describe(self) -> &'static str {
        match self {
            Stage::Start => "starting",
            Stage::Idle => "waiting",
            Stage::Read => "reading the sensors",
            Stage::Render => "rendering",
            Stage::Estimate => "estimating",
            Stage::Count => "counting",
            Stage::Answer => "answering a command",
            Stage::Send => "sending",
            Stage::Save => "saving settings",
        }
    }
}

/// What ended the run before this one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Crash {
    /// What it was.
    pub kind: CrashKind,
    /// What the program was doing.
    pub stage: Stage,
    /// The place: a program counter or a line, as [`Crash::kind`] says.
    pub at: u32,
    /// The address from which the place was called, or 0.
    pub from: u32,
}

/// The words of a crash, with a check sum, as memory keeps them.
pub type CrashWords = [u32; 4];

/// The sum is never that of a memory that is all zeros or all ones.
const SALT: u32 = 0x9a1b_a7e5;

impl Crash {
    /// Returns the words that memory is to keep.
    pub fn to_words(self) -> CrashWords {
        let what = u32::from(self.kind as u8) | u32::from(self.stage as u8) << 8;
        [what, self.at, self.from, sum([what, self.at, self.from])]
    }

    /// Reads what memory has kept; `None` for memory that has lost its content or never had one.
    pub fn from_words([what, at, from, kept]: CrashWords) -> Option<Crash> {
        if kept != sum([what, at, from]) {
            return None;
        }
        let [kind, stage, ..] = what.to_le_bytes();
        let kind = CrashKind::ALL.into_iter().find(|k| *k as u8 == kind)?;
        let stage = Stage::with_code(stage)?;
        Some(Crash {
            kind,
            stage,
            at,
            from,
        })
    }
}

fn sum(words: [u32; 3]) -> u32 {
    words.iter().fold(SALT, |sum, word| {
        (sum ^ word).wrapping_mul(0x0100_0193).rotate_left(13)
    })
}

/// Why the board started, and what ended the run before.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct History {
    /// The cause of the last reset.
    pub reset: ResetCause,
    /// What ended the run before it, if anything did.
    pub crash: Option<Crash>,
}

impl History {
    /// Puts together what a start has found: the cause, the words of a crash, and the stage at which the
    /// program was last. A watchdog that was not fed without any word of a crash had met a hang.
    pub fn found(reset: ResetCause, words: CrashWords, stage: u8) -> History {
        let told = Crash::from_words(words);
        let hung = (reset == ResetCause::Watchdog).then(|| Crash {
            kind: CrashKind::Hang,
            stage: Stage::with_code(stage).unwrap_or_default(),
            at: 0,
            from: 0,
        });
        // A power-on leaves memory with any content, of which a sum would be right once in 2³².
        let kept = !matches!(reset, ResetCause::PowerOn);
        History {
            reset,
            crash: told.filter(|_| kept).or(hung),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CRASH: Crash = Crash {
        kind: CrashKind::HardFault,
        stage: Stage::Estimate,
        at: 0x0800_1234,
        from: 0x0800_4321,
    };

    #[test]
    fn a_crash_comes_back_and_memory_with_any_other_content_is_none() {
        let words = CRASH.to_words();
        assert_eq!(Crash::from_words(words), Some(CRASH));
        for word in 0..4 {
            for bit in 0..32 {
                let mut bad = words;
                bad[word] ^= 1 << bit;
                assert_eq!(Crash::from_words(bad), None, "{word} {bit}");
            }
        }
        for fill in [0, u32::MAX, 0xdead_beef] {
            assert_eq!(Crash::from_words([fill; 4]), None);
        }
    }

    #[test]
    fn a_watchdog_without_a_word_is_a_hang_where_it_was_and_a_word_says_more() {
        let hung = History::found(ResetCause::Watchdog, [0; 4], Stage::Send as u8);
        let crash = hung.crash.unwrap();
        assert_eq!((crash.kind, crash.stage), (CrashKind::Hang, Stage::Send));
        let told = History::found(ResetCause::Watchdog, CRASH.to_words(), Stage::Send as u8);
        assert_eq!(told.crash, Some(CRASH));
        for quiet in [ResetCause::Pin, ResetCause::PowerOn, ResetCause::BrownOut] {
            assert_eq!(History::found(quiet, [0; 4], 0).crash, None);
        }
        // A debugger that resets a board after its crash still finds it; a power cut has lost it.
        let pin = History::found(ResetCause::Pin, CRASH.to_words(), 0);
        assert_eq!(pin.crash, Some(CRASH));
        let power = History::found(ResetCause::PowerOn, CRASH.to_words(), 0);
        assert_eq!(power.crash, None);
    }
}
