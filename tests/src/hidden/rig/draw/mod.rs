//! Draws an effect of the catalogue for a rig: its form, and its parameters at a strength.
//!
//! The same stream at another strength gives the same effect, only stronger or weaker: that is how `bare`
//! finds the strength that a wanted gap needs. Strength 1 is a few per cent of the peak force.

mod contact;
pub(crate) mod foreign;
mod guide;
pub(crate) mod machine;
mod sensing;
mod soft;
mod world;

use super::effect::Effect;
use super::material::{Law, Material};
use super::random::Random;

/// The ids of the catalogue.
pub const CATALOGUE: &[&str] = &[
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
    #[cfg(feature = "example-effect")]
    "tip_magnet",
];

/// All ids: the catalogue's, and those that measured machines asked for.
pub fn every_id() -> Vec<&'static str> {
    CATALOGUE.iter().chain(&machine::MACHINE).copied().collect()
}

/// The scales that make a strength comparable between rigs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scale {
    /// The material of the rig.
    pub(crate) material: Material,
    /// The largest force of the bare rig (N).
    pub(crate) peak_n: f64,
    /// The largest depth (m).
    pub(crate) depth_m: f64,
    /// The largest speed (m/s).
    pub(crate) fastest_mps: f64,
    /// The range of the motor's positions (m).
    pub(crate) way_m: f64,
    /// The length of the motion (s).
    pub(crate) seconds: f64,
}

/// A drawn effect.
#[derive(Clone, Debug)]
pub struct Hidden {
    /// Its id in the catalogue.
    pub id: &'static str,
    /// The name of its form: `catalogue`, or that of another form.
    pub form: &'static str,
    pub(crate) effect: Effect,
    /// Its parameters: under the catalogue's names where the form is the catalogue's, else under names of
    /// that form.
    pub params: Vec<(&'static str, f64)>,
}

/// The other ids that are right for a form: a Coulomb friction that falls with the speed is a Stribeck
/// friction as well.
pub(crate) fn accepted(id: &str, form: &str) -> &'static [&'static str] {
    match (id, form) {
        ("coulomb_friction", "stribeck" | "lugre" | "bristles" | "iwan" | "by_position") => {
            &["stribeck_friction"]
        }
        // With γ near 0 or a sharp knee it is nearly Dahl's friction.
        ("bouc_wen", "catalogue" | "sharper") => &["coulomb_friction"],
        ("force_lag", "resonant_cell") => &["time_delay"],
        _ => &[],
    }
}

/// Whether an effect makes sense on a law.
pub(crate) fn fits(id: &str, law: Law) -> bool {
    match foreign::id_of(id).unwrap_or(id) {
        "power_law_stiffness" | "depth_dependent_damping" => law == Law::KelvinVoigt,
        "stress_relaxation" => law != Law::Zener,
        _ => true,
    }
}

type Named = Vec<(&'static str, f64)>;
type Drawn = (&'static str, Effect, Named);

/// Draws the effect `id` at a strength, which is capped where the effect would be absurd.
pub(crate) fn build(
    id: &'static str,
    mismatched: bool,
    strength: f64,
    scale: &Scale,
    random: &mut Random,
) -> Hidden {
    let from = [
        foreign::draw,
        soft::draw,
        contact::draw,
        guide::draw,
        world::draw,
        sensing::draw,
        machine::draw,
        #[cfg(feature = "example-effect")]
        tip_magnet,
    ];
    let drawn = from
        .iter()
        .find_map(|draw| draw(id, mismatched, strength, scale, &mut random.clone()));
    let (form, effect, params) = drawn.unwrap_or_else(|| panic!("{id} is not in the catalogue"));
    Hidden {
        id: foreign::id_of(id).unwrap_or(id),
        form,
        effect,
        params,
    }
}

/// The invented effect of the worked example: −force/(1 + (x/reach)²).
#[cfg(feature = "example-effect")]
fn tip_magnet(id: &str, _: bool, s: f64, scale: &Scale, r: &mut Random) -> Option<Drawn> {
    let force = (0.05 * s * r.between(0.8, 1.2)).min(0.5) * scale.peak_n;
    let params = vec![("force", force), ("reach", r.log_between(0.3e-3, 0.6e-3))];
    let effect = Effect::Load {
        formula: super::effect::Formula(|p, _, x, _| -p[0] / (1.0 + (x / p[1]).powi(2))),
        params: params.iter().map(|(_, value)| *value).collect(),
    };
    (id == "tip_magnet").then_some(("catalogue", effect, params))
}

/// The name of the form of an effect that is a sine in the catalogue.
fn harmonic(other: bool) -> &'static str {
    if other {
        "second_harmonic"
    } else {
        "catalogue"
    }
}
