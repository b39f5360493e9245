//! Effects at the surface, and hysteresis of the contact.

use super::super::effect::Effect;
use super::super::random::Random;
use super::{Drawn, Scale, harmonic};

/// Draws the effect `id`, or `None` if it belongs to another file.
pub(super) fn draw(id: &str, other: bool, s: f64, scale: &Scale, r: &mut Random) -> Option<Drawn> {
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
