//! Faults of instants and stamps.

use super::{Fault, Scene, row};
use crate::faults::rig::plan::{Clock, Plan};

/// A plan with a faulty clock from the start.
fn clock(clock: Clock) -> Plan {
    Plan {
        clock,
        ..Plan::default()
    }
}

/// Holes of up to so many seconds, two seconds apart.
fn holes(scene: &mut Scene) -> super::Spans {
    let longest = scene.of([0.01, 0.05, 0.25]);
    let mut spans = scene.spans(longest, 2.0);
    for span in &mut spans {
        span.end = span.start + longest * scene.random.between(0.6, 1.0);
    }
    spans
}

pub(super) const ROWS: &[Fault] = &[
    row("rate", "200, 5000, 10 000 Hz, honest", |scene| {
        clock(Clock {
            rate_hz: scene.of([200.0, 5000.0, 10_000.0]),
            ..Clock::default()
        })
    }),
    row(
        "lost_rows",
        "holes of 10, 50, 250 ms, stamps kept",
        |scene| {
            let dropped = holes(scene);
            clock(Clock {
                dropped,
                ..Clock::default()
            })
        },
    ),
    row(
        "thinned_rows",
        "0.5, 5, 30 % of the rows missing, stamps kept",
        |scene| {
            clock(Clock {
                dropped_share: scene.of([0.005, 0.05, 0.3]),
                ..Clock::default()
            })
        },
    ),
    row(
        "renumbered",
        "holes of 10, 50, 250 ms, stamps anew",
        |scene| {
            let dropped = holes(scene);
            clock(Clock {
                dropped,
                renumbered: true,
                ..Clock::default()
            })
        },
    ),
    row(
        "thinned_renumbered",
        "0.5, 5, 30 % of the rows missing, stamps anew",
        |scene| {
            clock(Clock {
                dropped_share: scene.of([0.005, 0.05, 0.3]),
                renumbered: true,
                ..Clock::default()
            })
        },
    ),
    row("late_samples", "5 % up to 0.5, 2, 10 ms late", |scene| {
        clock(Clock {
            late: 0.05,
            late_s: scene.of([5e-4, 2e-3, 1e-2]),
            ..Clock::default()
        })
    }),
    row("jitter_stamps", "20, 100, 300 µs", |scene| {
        clock(Clock {
            stamps_s: scene.of([2e-5, 1e-4, 3e-4]),
            ..Clock::default()
        })
    }),
    row("jitter_both", "20, 100, 300 µs", |scene| {
        clock(Clock {
            both_s: scene.of([2e-5, 1e-4, 3e-4]),
            ..Clock::default()
        })
    }),
    row("jitter_force", "20, 100, 300 µs", |scene| {
        clock(Clock {
            force_s: scene.of([2e-5, 1e-4, 3e-4]),
            ..Clock::default()
        })
    }),
    row("clock_speed", "1, 5, 20 % fast", |scene| {
        clock(Clock {
            speed: scene.of([1.01, 1.05, 1.2]),
            ..Clock::default()
        })
    }),
];
