//! What a board says of its force output, of its last reset, and of the run that ended with it, for people.

use estimator_core::board::history::{Crash, CrashKind, ResetCause};
use estimator_core::board::link::Health;
use estimator_core::{Fault, Faults};

/// The lines of a board's condition: the force output where it is armed or held at rest, and its history where
/// the board tells one.
pub fn lines(health: &Health) -> Vec<String> {
    let history = &health.history;
    let mut lines = Vec::new();
    lines.extend(output(health.armed, health.latched));
    if history.reset != ResetCause::Unknown {
        lines.push(format!("last reset: {}", history.reset.describe()));
    }
    lines.extend(history.crash.as_ref().map(ended));
    lines
}

fn output(armed: bool, latched: Faults) -> Option<String> {
    let faults: Vec<_> = latched.iter().map(Fault::describe).collect();
    match (armed, faults.is_empty()) {
        (true, _) => Some("force output armed".into()),
        (false, true) => None,
        (false, false) => Some(format!(
            "force output at rest since: {}; `config arm` arms it again",
            faults.join("; ")
        )),
    }
}

fn ended(crash: &Crash) -> String {
    let place = match crash.kind {
        CrashKind::Panic if crash.at > 0 => format!(", line {}", crash.at),
        CrashKind::HardFault => format!(" at {:#010x}, called from {:#010x}", crash.at, crash.from),
        _ => String::new(),
    };
    format!(
        "the run before it ended with a {} while {}{place}",
        crash.kind.describe(),
        crash.stage.describe()
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use estimator_core::board::history::{History, Stage};

    #[test]
    fn a_board_that_has_nothing_to_tell_has_no_lines() {
        assert_eq!(lines(&Health::default()), [] as [&str; 0]);
    }

    #[test]
    fn what_ended_the_run_before_is_said_with_its_place() {
        let health = Health {
            latched: Faults::NONE.with(Fault::Overrun),
            history: History {
                reset: ResetCause::Watchdog,
                crash: Some(Crash {
                    kind: CrashKind::HardFault,
                    stage: Stage::Estimate,
                    at: 0x0800_1234,
                    from: 0x0800_0200,
                }),
            },
            ..Health::default()
        };
        assert_eq!(
            lines(&health),
            [
                "force output at rest since: the sampling task was late; `config arm` arms it again",
                "last reset: watchdog",
                "the run before it ended with a hard fault while estimating at 0x08001234, called from \
                 0x08000200",
            ]
        );
    }
}
