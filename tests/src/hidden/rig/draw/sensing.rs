//! Effects between motor and tip, and between force and file.

use super::super::effect::Effect;
use super::super::random::Random;
use super::{Drawn, Scale, harmonic};

/// Draws the effect `id`, or `None` if it belongs to another file.
pub(super) fn draw(id: &str, other: bool, s: f64, scale: &Scale, r: &mut Random) -> Option<Drawn> {
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
