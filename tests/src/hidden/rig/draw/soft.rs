//! Effects in the material: relaxation, elastic response, softening.

use super::super::effect::Effect;
use super::super::random::Random;
use super::{Drawn, Scale};

/// Draws the effect `id`, or `None` if it belongs to another file.
pub(super) fn draw(id: &str, other: bool, s: f64, scale: &Scale, r: &mut Random) -> Option<Drawn> {
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
            let params = [("exponent", exponent), ("levelling", levelling)];
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

/// A relaxation mode at a rate that is at least a factor of five from that of the base.
fn relaxation(other: bool, s: f64, scale: &Scale, r: &mut Random) -> Drawn {
    let fraction = (0.12 * s * r.between(0.8, 1.2)).clamp(0.005, 0.5);
    let rate = match scale.material.mode {
        Some((_, base)) if base > 2.0 => base / r.log_between(5.0, 12.0),
        Some((_, base)) => base * r.log_between(5.0, 15.0),
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
