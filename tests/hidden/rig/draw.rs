//! Draws an effect of the catalogue for a rig: its form and parameters, at a strength.
//!
//! The same stream at another strength gives the same effect, only stronger: that is how
//! `case` finds the strength that a wanted gap needs. Strength 1 is a few per cent of the peak force.

use super::effect::{Effect, Friction};
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
        ("coulomb_friction", "stribeck" | "lugre" | "tanh") => &["stribeck_friction"],
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
        in_material,
        at_contact,
        in_guide,
        over_time_and_way,
        in_sensing,
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

/// Relaxation, elastic response, softening.
fn in_material(id: &str, other: bool, s: f64, scale: &Scale, r: &mut Random) -> Option<Drawn> {
    let depth = scale.depth_m;
    Some(match id {
        "stress_relaxation" => relaxation(other, s, scale, r),
        "power_law_stiffness" => {
            let n = 1.0 + (0.3 * s * r.between(0.8, 1.2)).clamp(0.02, 0.9);
            if !other {
                let curve = Effect::Curve {
                    terms: vec![(1.0, n)],
                    blunt: 0.0,
                };
                ("catalogue", curve, vec![("exponent", n)])
            } else if r.chance(0.5) {
                let blunt = r.between(0.03e-3, 0.08e-3);
                let curve = Effect::Curve {
                    terms: vec![(1.0, n)],
                    blunt,
                };
                ("blunt", curve, vec![("exponent", n), ("blunt_m", blunt)])
            } else {
                // A tip between two shapes, n ± 0.2.
                let terms = vec![(0.5, (n - 0.2).max(1.0)), (0.5, n + 0.2)];
                let params = vec![("exponent_low", terms[0].1), ("exponent_high", terms[1].1)];
                ("two_powers", Effect::Curve { terms, blunt: 0.0 }, params)
            }
        }
        "depth_dependent_damping" => {
            let exponent = (0.8 * s * r.between(0.8, 1.2)).clamp(0.05, 1.8);
            let levelling = if other { r.between(0.03, 0.1) } else { 0.0 };
            let form = if other { "levelling" } else { "catalogue" };
            let params = vec![("exponent", exponent), ("levelling", levelling)];
            (
                form,
                Effect::DampingDepth {
                    exponent,
                    levelling,
                },
                params[..1 + usize::from(other)].to_vec(),
            )
        }
        "exponential_stiffening" => {
            let total = (0.4 * s * r.between(0.8, 1.2)).clamp(0.01, 1.5);
            if other {
                // 1/(1−δ/δ_L): the same stiffening at the deepest point.
                let locking = (1.0 - (-total).exp()) / depth;
                (
                    "locking",
                    Effect::Stiffening { rate: 0.0, locking },
                    vec![("locking_per_m", locking)],
                )
            } else {
                let rate = total / depth;
                (
                    "catalogue",
                    Effect::Stiffening { rate, locking: 0.0 },
                    vec![("rate", rate)],
                )
            }
        }
        "cyclic_softening" => {
            let fraction = (0.2 * s * r.between(0.8, 1.2)).clamp(0.005, 0.65);
            let size = depth * r.between(0.1, 0.4);
            let energy = if other {
                scale.material.exponent + 1.0
            } else {
                0.0
            };
            let effect = Effect::Softening {
                fraction,
                scale: size,
                energy,
            };
            let form = if other { "ogden_roxburgh" } else { "catalogue" };
            (
                form,
                effect,
                vec![("fraction", fraction), ("depth_scale", size)],
            )
        }
        "buried_layer" => {
            let stiffness = (0.6 * s * scale.peak_n / depth).min(4.0 * scale.peak_n / depth);
            let at = depth * r.between(0.35, 0.65);
            let rounding = if other { 0.05 * at } else { 0.0 };
            let effect = Effect::Layer {
                stiffness,
                depth: at,
                rounding,
            };
            let form = if other { "rounded" } else { "catalogue" };
            (form, effect, vec![("stiffness", stiffness), ("depth", at)])
        }
        _ => return None,
    })
}

/// A mode well away (factor five at least) from the base's own.
fn relaxation(other: bool, s: f64, scale: &Scale, r: &mut Random) -> Drawn {
    let fraction = (0.12 * s * r.between(0.8, 1.2)).clamp(0.005, 0.5);
    let rate = match scale.material.mode {
        Some((_, own)) if own > 2.0 => own / r.log_between(5.0, 12.0),
        Some((_, own)) => own * r.log_between(5.0, 15.0),
        None => r.log_between(0.4, 8.0),
    };
    if !other {
        let params = vec![("fraction", fraction), ("rate", rate)];
        return ("catalogue", Effect::Modes(vec![(fraction, rate)]), params);
    }
    if r.chance(0.6) || scale.material.mode.is_some() {
        let apart = r.log_between(2.0, 4.0);
        let modes = vec![
            (0.5 * fraction, rate * apart),
            (0.5 * fraction, rate / apart),
        ];
        let params = vec![
            ("fraction", fraction),
            ("rate_fast", modes[0].1),
            ("rate_slow", modes[1].1),
        ];
        return ("two_branches", Effect::Modes(modes), params);
    }
    // A flat spectrum over a decade and a half, as of a power law of time.
    let modes = (0..4).map(|k| {
        (
            0.25 * fraction,
            rate * 10f64.powf(0.5 * f64::from(k) - 0.75),
        )
    });
    (
        "spectrum",
        Effect::Modes(modes.collect()),
        vec![("fraction", fraction), ("rate_middle", rate)],
    )
}

/// What happens at the surface.
fn at_contact(id: &str, other: bool, s: f64, scale: &Scale, r: &mut Random) -> Option<Drawn> {
    let (depth, peak) = (scale.depth_m, scale.peak_n);
    Some(match id {
        "adhesion" => {
            let force = (0.02 * s * r.between(0.8, 1.2)).min(0.3) * peak;
            let neck = r.log_between(0.2e-3, 0.8e-3);
            let (loading, shape) = if other {
                (r.between(0.6, 0.9), r.between(0.7, 1.4))
            } else {
                (1.0, 1.0)
            };
            let effect = Effect::Adhesion {
                force,
                neck,
                loading,
                shape,
            };
            let form = if other { "peeling" } else { "catalogue" };
            (form, effect, vec![("force", force), ("neck_length", neck)])
        }
        "permanent_set" => {
            let fraction = (0.1 * s * r.between(0.8, 1.2)).clamp(0.002, 0.5);
            let yield_depth = depth * r.between(0.15, 0.5);
            let delay = if other { r.between(0.02, 0.06) } else { 0.0 };
            let effect = Effect::Set {
                fraction,
                yield_depth,
                delay,
            };
            let form = if other { "creeping" } else { "catalogue" };
            (
                form,
                effect,
                vec![("fraction", fraction), ("yield_depth", yield_depth)],
            )
        }
        "surface_motion" => {
            let amplitude = (0.03e-3 * s * r.between(0.8, 1.2)).min(0.6e-3);
            let (hz, phase) = (r.log_between(0.4, 4.0), r.phase());
            let second = if other { r.between(0.1, 0.25) } else { 0.0 };
            let effect = Effect::Surface {
                amplitude,
                hz,
                phase,
                second,
            };
            (
                harmonic(other),
                effect,
                vec![
                    ("amplitude", amplitude),
                    ("frequency", hz),
                    ("phase", phase),
                ],
            )
        }
        "hysteretic_damping" => {
            let force = (0.05 * s * r.between(0.8, 1.2)).min(0.4) * peak;
            let yields = depth * r.between(0.03, 0.15);
            let elements = if other {
                [0.4, 0.7, 1.1, 1.8]
                    .iter()
                    .map(|w| (0.25 * force, w * yields))
                    .collect()
            } else {
                vec![(force, yields)]
            };
            let form = if other { "maxwell_slip" } else { "catalogue" };
            let effect = Effect::Hysteresis {
                elements,
                jenkins: other,
            };
            (
                form,
                effect,
                vec![("force", force), ("yield_displacement", yields)],
            )
        }
        _ => return None,
    })
}

fn harmonic(other: bool) -> &'static str {
    if other {
        "second_harmonic"
    } else {
        "catalogue"
    }
}

/// Friction, drag, mass.
fn in_guide(id: &str, other: bool, s: f64, scale: &Scale, r: &mut Random) -> Option<Drawn> {
    let (peak, fastest) = (scale.peak_n, scale.fastest_mps);
    let share = |of: f64, r: &mut Random| (of * s * r.between(0.8, 1.2)).min(0.5) * peak;
    Some(match id {
        "coulomb_friction" => coulomb(other, share(0.03, r), r),
        "stribeck_friction" => stribeck(other, share(0.03, r), r),
        "viscous_drag" => {
            let linear = share(0.03, r) / fastest;
            let bend = if other { r.between(0.15, 0.35) } else { 0.0 };
            let effect = Effect::Drag {
                linear,
                quadratic: bend * linear / fastest,
            };
            let params = vec![("coefficient", linear), ("quadratic_share", bend)];
            (
                if other { "with_square" } else { "catalogue" },
                effect,
                params[..1 + usize::from(other)].to_vec(),
            )
        }
        "asymmetric_drag" => {
            let coefficient = r.sign() * share(0.03, r) / fastest;
            let bend = if other {
                r.between(0.1, 0.3) * r.sign()
            } else {
                0.0
            };
            let effect = Effect::AsymmetricDrag {
                coefficient,
                bend,
                speed: 0.5 * fastest,
            };
            let params = vec![("coefficient", coefficient), ("bend", bend)];
            (
                if other { "power" } else { "catalogue" },
                effect,
                params[..1 + usize::from(other)].to_vec(),
            )
        }
        "tool_inertia" => {
            let mass = share(0.02, r);
            let loose = if other { r.between(0.15, 0.3) } else { 0.0 };
            let effect = Effect::Inertia {
                mass,
                loose,
                hz: r.between(25.0, 45.0),
                damping: 0.5,
            };
            let params = vec![("mass", mass), ("loose_share", loose)];
            (
                if other { "loose_part" } else { "catalogue" },
                effect,
                params[..1 + usize::from(other)].to_vec(),
            )
        }
        _ => return None,
    })
}

fn coulomb(other: bool, force: f64, r: &mut Random) -> Drawn {
    let rigid = Friction::coulomb(force);
    let bristle = r.log_between(20e-6, 150e-6);
    let (which, excess, speed) = (r.unit(), r.between(1.1, 1.35), r.log_between(1e-3, 6e-3));
    if !other {
        let width = if r.chance(0.4) { bristle } else { 0.0 };
        let params = vec![("force", force), ("width", width)];
        return (
            "catalogue",
            Effect::Friction(Friction { width, ..rigid }),
            params,
        );
    }
    let falling = Friction {
        stat: force * excess,
        speed,
        ..rigid
    };
    let (form, friction) = if which < 0.35 {
        ("stribeck", falling)
    } else if which < 0.7 {
        (
            "lugre",
            Friction {
                width: 0.5 * bristle,
                ..falling
            },
        )
    } else {
        (
            "tanh",
            Friction {
                smooth: r.log_between(0.1e-3, 0.6e-3),
                ..rigid
            },
        )
    };
    let params = vec![
        ("force", force),
        ("static_force", friction.stat),
        ("speed", speed),
    ];
    (form, Effect::Friction(friction), params)
}

fn stribeck(other: bool, kinetic: f64, r: &mut Random) -> Drawn {
    let stat = kinetic * r.between(1.5, 2.3);
    let speed = r.log_between(1.5e-3, 10e-3);
    let (which, bristle) = (r.unit(), r.log_between(10e-6, 40e-6));
    let plain = Friction {
        stat,
        speed,
        ..Friction::coulomb(kinetic)
    };
    let (form, friction) = match (other, which < 0.5) {
        (false, _) => ("catalogue", plain),
        (true, true) => (
            "lorentz",
            Friction {
                lorentz: true,
                ..plain
            },
        ),
        (true, false) => (
            "lugre",
            Friction {
                width: bristle,
                ..plain
            },
        ),
    };
    let params = vec![
        ("kinetic_force", kinetic),
        ("static_force", stat),
        ("speed", speed),
    ];
    (form, Effect::Friction(friction), params)
}

/// What depends on time, or on the way of the motor.
fn over_time_and_way(
    id: &str,
    other: bool,
    s: f64,
    scale: &Scale,
    r: &mut Random,
) -> Option<Drawn> {
    let force = |of: f64, r: &mut Random| (of * s * r.between(0.8, 1.2)).min(0.5) * scale.peak_n;
    Some(match id {
        "force_offset" => {
            let force = r.sign() * force(0.02, r);
            let (settling, time) = (
                if other { r.between(0.05, 0.15) } else { 0.0 },
                r.between(0.5, 2.0),
            );
            let effect = Effect::Offset {
                force,
                settling,
                time,
            };
            (
                if other { "settling" } else { "catalogue" },
                effect,
                vec![("force", force)],
            )
        }
        "force_drift" => {
            let total = r.sign() * force(0.03, r);
            let (time, bend) = (scale.seconds * r.between(0.12, 0.4), r.between(0.6, 0.8));
            if other {
                let rate = total / scale.seconds;
                let effect = Effect::Drift {
                    rate,
                    time: 0.0,
                    bend,
                    scale: scale.seconds,
                };
                (
                    "power_of_time",
                    effect,
                    vec![("rate", rate), ("power", bend)],
                )
            } else if r.chance(0.5) {
                let rate = total / scale.seconds;
                let effect = Effect::Drift {
                    rate,
                    time: 0.0,
                    bend: 0.0,
                    scale: 1.0,
                };
                ("catalogue", effect, vec![("rate", rate)])
            } else {
                let rate = total / time;
                let effect = Effect::Drift {
                    rate,
                    time,
                    bend: 0.0,
                    scale: 1.0,
                };
                (
                    "catalogue",
                    effect,
                    vec![("rate", rate), ("time_constant", time)],
                )
            }
        }
        "cable_stiffness" => {
            let stiffness = force(0.03, r) / scale.way_m;
            let hardening = if other { r.between(0.1, 0.3) } else { 0.0 };
            let effect = Effect::Cable {
                stiffness,
                hardening,
                scale: scale.way_m,
            };
            (
                if other { "hardening" } else { "catalogue" },
                effect,
                vec![("stiffness", stiffness)],
            )
        }
        "cogging" => {
            let amplitude = force(0.01, r);
            let pitch = r.log_between(0.3e-3, f64::min(2e-3, 0.4 * scale.way_m));
            let (phase, second) = (r.phase(), if other { r.between(0.1, 0.3) } else { 0.0 });
            let effect = Effect::Cogging {
                amplitude,
                pitch,
                phase,
                second,
            };
            (
                harmonic(other),
                effect,
                vec![("amplitude", amplitude), ("pitch", pitch), ("phase", phase)],
            )
        }
        "periodic_disturbance" => {
            let amplitude = force(0.01, r);
            let (hz, phase) = (r.log_between(0.4, 80.0), r.phase());
            let (second, breathing) = match (other, r.chance(0.6)) {
                (false, _) => (0.0, 0.0),
                (true, true) => (r.between(0.1, 0.25), 0.0),
                (true, false) => (0.0, r.between(0.1, 0.25)),
            };
            let effect = Effect::Disturbance {
                amplitude,
                hz,
                phase,
                second,
                breathing,
            };
            let form = if breathing > 0.0 {
                "breathing"
            } else {
                harmonic(other)
            };
            (
                form,
                effect,
                vec![
                    ("amplitude", amplitude),
                    ("frequency", hz),
                    ("phase", phase),
                ],
            )
        }
        _ => return None,
    })
}

/// Between motor and tip, and between force and file.
fn in_sensing(id: &str, other: bool, s: f64, scale: &Scale, r: &mut Random) -> Option<Drawn> {
    let size = s * r.between(0.8, 1.2);
    Some(match id {
        "series_compliance" => {
            let stiffness = scale.peak_n / scale.depth_m * f64::max(10.0 / size, 1.5);
            let progressive = if other { r.between(0.15, 0.35) } else { 0.0 };
            let effect = Effect::Compliance {
                stiffness,
                progressive,
                scale: scale.peak_n / stiffness,
            };
            (
                if other { "progressive" } else { "catalogue" },
                effect,
                vec![("stiffness", stiffness)],
            )
        }
        "backlash" => {
            let width = (0.05e-3 * size).min(0.5e-3);
            let plays = if other {
                vec![(0.6 * width, 0.25), (width, 0.5), (1.4 * width, 0.25)]
            } else {
                vec![(width, 1.0)]
            };
            let form = if other { "three_plays" } else { "catalogue" };
            (form, Effect::Backlash { plays }, vec![("width", width)])
        }
        "force_lag" => {
            let time = (4e-3 * size).min(60e-3);
            let form = if other { "second_order" } else { "catalogue" };
            (
                form,
                Effect::Lag {
                    time,
                    order: 1 + usize::from(other),
                },
                vec![("time_constant", time)],
            )
        }
        "time_delay" => {
            let sign = if r.chance(0.2) { -1.0 } else { 1.0 };
            let seconds = sign * (3e-3 * size).min(if sign < 0.0 { 15e-3 } else { 30e-3 });
            let jitter = if other { r.between(0.02, 0.05) } else { 0.0 };
            let form = if other { "jitter" } else { "catalogue" };
            (
                form,
                Effect::Delay { seconds, jitter },
                vec![("delay", seconds)],
            )
        }
        "force_saturation" => {
            let limit = scale.peak_n * (1.0 - 0.15 * size).max(0.45);
            let sharpness = if other {
                r.between(15.0, 30.0)
            } else {
                f64::INFINITY
            };
            let form = if other { "soft" } else { "catalogue" };
            (
                form,
                Effect::Saturation { limit, sharpness },
                vec![("limit", limit)],
            )
        }
        "encoder_periodic_error" => {
            let pitch = r.log_between(0.2e-3, f64::min(2e-3, 0.4 * scale.way_m));
            let amplitude = (3e-6 * size).min(0.05 * pitch);
            let (phase, second) = (r.phase(), if other { r.between(0.1, 0.3) } else { 0.0 });
            let effect = Effect::Encoder {
                amplitude,
                pitch,
                phase,
                second,
            };
            (
                harmonic(other),
                effect,
                vec![("amplitude", amplitude), ("pitch", pitch), ("phase", phase)],
            )
        }
        _ => return None,
    })
}
