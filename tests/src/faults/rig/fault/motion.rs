//! Motions that tell little, and logs without free air. The law holds in all of them.

use super::{Fault, row};
use crate::faults::rig::NOISE_N;
use crate::faults::rig::motion::Special;
use crate::faults::rig::plan::{Force, Plan};

/// A row whose motion is the fault.
const fn moved(
    name: &'static str,
    severities: &'static str,
    motion: fn(usize) -> Special,
) -> Fault {
    Fault {
        motion,
        ..row(name, severities, |_| Plan::default())
    }
}

pub(super) const ROWS: &[Fault] = &[
    Fault {
        motion: |_| Special::Fast(1.3),
        ..row("fast_touches", "5, 20, 100 mN of noise, honest", |scene| {
            Plan {
                force: Force {
                    noise_n: scene.of([5e-3, NOISE_N, 0.1]),
                    ..Force::default()
                },
                ..Plan::default()
            }
        })
    },
    moved("slow", "5, 2, 0.5 mm/s", |severity| {
        Special::Slow([5e-3, 2e-3, 5e-4][severity])
    }),
    moved("tiny_motion", "10, 3, 1 % of the motion", |severity| {
        Special::Tiny([0.1, 0.03, 0.01][severity])
    }),
    moved("hover", "10, 5, 2 % of the motion", |severity| {
        Special::Shallow([0.1, 0.05, 0.02][severity])
    }),
    moved("chatter", "1, 3, 8 % of the depth at 25 Hz", |severity| {
        Special::Vibration([0.01, 0.03, 0.08][severity])
    }),
    moved("short_taps", "80, 40, 20 ms", |severity| {
        Special::Taps([0.08, 0.04, 0.02][severity])
    }),
    moved(
        "one_depth",
        "three presses, one held, one slow and held",
        |severity| {
            let (often, per_s) = [(3, 3.0), (1, 3.0), (1, 0.3)][severity];
            Special::OneDepth(often, per_s)
        },
    ),
    moved(
        "starts_in_contact",
        "at 30, 60, 95 % of the depth",
        |severity| Special::StartsAt([0.3, 0.6, 0.95][severity]),
    ),
    moved(
        "no_free_air",
        "100, 30, 5 ms before the touch",
        |severity| Special::FreeAir([0.1, 0.03, 0.005][severity]),
    ),
    moved(
        "never_free",
        "never below 10, 40, 70 % of the depth",
        |severity| Special::NeverFree([0.1, 0.4, 0.7][severity]),
    ),
];
