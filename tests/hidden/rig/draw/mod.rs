//! Draws an effect of the catalogue for a rig: its form and parameters, at a strength.
//!
//! The same stream at another strength gives the same effect, only stronger: that is how
//! `case` finds the strength that a wanted gap needs. Strength 1 is a few per cent of the peak force.

mod contact;
mod guide;
mod sensing;
mod soft;
mod world;

use super::effect::Effect;
use super::material::{Law, Material};
use super::random::Random;

/// Ids of the catalogue.
pub(crate) const CATALOGUE: [&str; 26] = [
    "stress_relaxation",
    "power_law_stiffness",
    "depth_dependent_damping",
    "exponential_stiffening",
    "adhesion",
    "permanent_set",
    "buried_layer",
    "surface_motion",
    "hysteretic_damping",
    "cyclic_softening",
    "coulomb_friction",
    "stribeck_friction",
    "viscous_drag",
    "asymmetric_drag",
    "tool_inertia",
    "force_offset",
    "force_drift",
    "cable_stiffness",
    "cogging",
    "periodic_disturbance",
    "series_compliance",
    "backlash",
    "force_lag",
    "time_delay",
    "force_saturation",
    "encoder_periodic_error",
];

/// What the strengths are measured by.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scale {
    pub(crate) material: Material,
    /// Largest force and depth of the bare rig (N, m).
    pub(crate) peak_n: f64,
    pub(crate) depth_m: f64,
    /// Fastest motion (m/s).
    pub(crate) fastest_mps: f64,
    /// Way of the motor (m).
    pub(crate) way_m: f64,
    pub(crate) seconds: f64,
}

/// A drawn effect.
#[derive(Clone, Debug)]
pub(crate) struct Hidden {
    pub(crate) id: &'static str,
    /// `catalogue`, or what it is in its place.
    pub(crate) form: &'static str,
    pub(crate) effect: Effect,
    /// In the catalogue's names if the form is the catalogue's, else in the form's own.
    pub(crate) params: Vec<(&'static str, f64)>,
}

/// Ids that are right as well: a friction that falls with the speed is either, when the
/// catalogue says Coulomb and the rig does not.
pub(crate) fn accepted(id: &str, form: &str) -> &'static [&'static str] {
    match (id, form) {
        ("coulomb_friction", "stribeck" | "lugre") => &["stribeck_friction"],
        _ => &[],
    }
}

/// Whether an effect makes sense on a law.
pub(crate) fn fits(id: &str, law: Law) -> bool {
    match id {
        "power_law_stiffness" | "depth_dependent_damping" => law == Law::KelvinVoigt,
        "stress_relaxation" => law != Law::Zener,
        _ => true,
    }
}

type Named = Vec<(&'static str, f64)>;
type Drawn = (&'static str, Effect, Named);

/// The effect `id` at a strength; the strength is capped where the effect would be absurd.
pub(crate) fn build(
    id: &'static str,
    mismatched: bool,
    strength: f64,
    scale: &Scale,
    random: &mut Random,
) -> Hidden {
    let from = [
        soft::draw,
        contact::draw,
        guide::draw,
        world::draw,
        sensing::draw,
    ];
    let drawn = from
        .iter()
        .find_map(|draw| draw(id, mismatched, strength, scale, &mut random.clone()));
    let (form, effect, params) = drawn.unwrap_or_else(|| panic!("{id} is not in the catalogue"));
    Hidden {
        id,
        form,
        effect,
        params,
    }
}

/// A form that is a sine in the catalogue.
fn harmonic(other: bool) -> &'static str {
    if other {
        "second_harmonic"
    } else {
        "catalogue"
    }
}
