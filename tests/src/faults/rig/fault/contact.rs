//! Faults that change what the probe meets.

use super::{Fault, Scene, row};
use crate::faults::rig::plan::{Plan, Swap, World};

/// A plan with another world from the start.
fn world(world: World) -> Plan {
    Plan {
        world,
        ..Plan::default()
    }
}

/// Another material from `from_s` on, stiffer or softer.
fn swap(scene: &mut Scene, from_s: f64) -> Plan {
    let (stiffness, damping) = scene.of([(1.2, 1.3), (1.5, 2.0), (3.0, 4.0)]);
    let softer = scene.random.chance(0.5);
    let factor = |value: f64| if softer { 1.0 / value } else { value };
    Plan {
        onset_s: from_s,
        end_s: Some(from_s),
        swap: Some(Swap {
            from_s,
            stiffness: factor(stiffness),
            damping: factor(damping),
        }),
        ..Plan::default()
    }
}

pub(super) const ROWS: &[Fault] = &[
    row("swap_in_contact", "K × 1.2, 1.5, 3, or over it", |scene| {
        let from_s = scene.pressing();
        swap(scene, from_s)
    })
    .meets()
    .passes(),
    row("swap_in_air", "K × 1.2, 1.5, 3, or over it", |scene| {
        let from_s = scene.in_air();
        swap(scene, from_s)
    })
    .meets()
    .passes(),
    row("creep_fast", "3, 10, 30 % within 0.2 s", |scene| {
        world(World {
            relaxing: scene.of([0.03, 0.1, 0.3]),
            relaxing_s: 0.2,
            ..World::default()
        })
    })
    .meets(),
    row("creep_slow", "3, 10, 30 % within 3 s", |scene| {
        world(World {
            relaxing: scene.of([0.03, 0.1, 0.3]),
            relaxing_s: 3.0,
            ..World::default()
        })
    })
    .meets(),
    row("surface_drift", "± 10, 50, 200 µm/s", |scene| {
        world(World {
            drift_mps: scene.of([1e-5, 5e-5, 2e-4]) * scene.random.sign(),
            ..World::default()
        })
    })
    .meets(),
    row("breathing", "20, 100, 500 µm at 0.25 Hz", |scene| {
        world(World {
            breath_m: scene.of([2e-5, 1e-4, 5e-4]),
            breath_phase: scene.random.phase(),
            ..World::default()
        })
    })
    .meets(),
    row(
        "yields",
        "0.1, 0.4, 1.5 depths/s at twice 60 % of the peak",
        |scene| {
            world(World {
                yields_at_n: 0.6 * scene.peak_n,
                yields_mps: scene.depth_m * scene.of([0.1, 0.4, 1.5]),
                ..World::default()
            })
        },
    )
    .meets(),
    row("adhesion", "0.05, 0.2, 0.8 N", |scene| {
        world(World {
            adhesion_n: scene.of([0.05, 0.2, 0.8]),
            ..World::default()
        })
    })
    .meets(),
    row(
        "compliance",
        "3, 10, 30 % of the depth at the peak",
        |scene| {
            let give = scene.of([0.03, 0.1, 0.3]);
            world(World {
                compliance_m_per_n: give * scene.depth_m / scene.peak_n,
                ..World::default()
            })
        },
    )
    .meets(),
    row("backlash", "10, 30, 100 µm", |scene| {
        world(World {
            play_m: scene.of([1e-5, 3e-5, 1e-4]),
            ..World::default()
        })
    })
    .meets(),
    row("stick_slip", "0.03, 0.1, 0.3 N", |scene| {
        world(World {
            friction_n: scene.of([0.03, 0.1, 0.3]),
            ..World::default()
        })
    })
    .meets(),
    row("tool_inertia", "20, 100, 500 g", |scene| {
        world(World {
            mass_kg: scene.of([0.02, 0.1, 0.5]),
            ..World::default()
        })
    })
    .meets(),
];
