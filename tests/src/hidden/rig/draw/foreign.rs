//! Forms of the effects that the catalogue does not have, as the literature and the bench have them.

use super::super::effect::{Effect, Formula, Friction};
use super::super::random::Random;
use super::{Drawn, Scale};

/// Every form with the effect of the catalogue that it is a form of.
pub(crate) const FORMS: [(&str, &str); 15] = [
    ("bristles", "coulomb_friction"),
    ("iwan", "coulomb_friction"),
    ("by_position", "coulomb_friction"),
    ("fractional", "stress_relaxation"),
    ("stretched", "stress_relaxation"),
    ("jkr", "adhesion"),
    ("dmt", "adhesion"),
    ("tanh_layer", "buried_layer"),
    ("two_harmonics", "cogging"),
    ("random_walk", "force_drift"),
    ("two_exponentials", "force_drift"),
    ("elastic_stop", "backlash"),
    ("breathing", "surface_motion"),
    ("resonant_cell", "force_lag"),
    ("lorentz_bristles", "stribeck_friction"),
];

/// The effect that a form is a form of.
pub(crate) fn id_of(form: &str) -> Option<&'static str> {
    let known = FORMS.iter().find(|(name, _)| *name == form);
    known.map(|(_, id)| *id)
}

/// Draws a form, or `None` if the name is not that of one.
pub(super) fn draw(name: &str, _: bool, s: f64, scale: &Scale, r: &mut Random) -> Option<Drawn> {
    let form = FORMS.iter().find(|(form, _)| *form == name)?.0;
    let force = |of: f64, r: &mut Random| (of * s * r.between(0.8, 1.2)).min(0.5) * scale.peak_n;
    let effect = match form {
        "bristles" | "lorentz_bristles" | "iwan" | "by_position" => {
            rubbing(form, force(0.03, r), scale, r)
        }
        "fractional" | "stretched" => relaxing(form, s, scale, r),
        "jkr" => Effect::Adhesion {
            // The neck thins slowly and tears; little pull on the way in.
            force: force(0.03, r),
            neck: r.log_between(0.2e-3, 0.8e-3),
            loading: r.between(0.1, 0.5),
            shape: r.between(0.35, 0.6),
        },
        "dmt" => Effect::Attraction {
            force: force(0.03, r),
            range: r.log_between(0.05e-3, 0.3e-3),
        },
        "tanh_layer" => {
            let at = scale.depth_m * r.between(0.35, 0.65);
            let steepest = 4.0 * scale.peak_n / scale.depth_m;
            Effect::Layer {
                stiffness: (0.6 * s * scale.peak_n / scale.depth_m).min(steepest),
                depth: at,
                rounding: at * r.between(0.1, 0.25),
            }
        }
        "two_harmonics" => Effect::Cogging {
            amplitude: force(0.01, r),
            pitch: r.log_between(0.3e-3, f64::min(2e-3, 0.4 * scale.way_m)),
            phase: r.phase(),
            second: r.between(0.4, 0.7),
        },
        "random_walk" | "two_exponentials" => wandering(form, force(0.03, r), scale, r),
        "elastic_stop" => {
            // The two flanks give way over half of the play.
            let width = (0.05e-3 * s * r.between(0.8, 1.2)).min(0.5e-3);
            let plays = [0.5, 0.75, 1.0, 1.25, 1.5];
            Effect::Backlash {
                plays: plays.iter().map(|of| (of * width, 0.2)).collect(),
            }
        }
        "breathing" => Effect::Surface {
            amplitude: (0.03e-3 * s * r.between(0.8, 1.2)).min(0.6e-3),
            hz: r.log_between(0.2, 0.6),
            phase: r.phase(),
            second: r.between(0.25, 0.4),
        },
        _ => Effect::Resonance {
            hz: (90.0 / (s * r.between(0.8, 1.2))).clamp(6.0, 400.0),
            damping: r.between(0.3, 0.7),
        },
    };
    Some((form, effect, Vec::new()))
}

/// Friction that bends before it slides, in elements, or with the place.
fn rubbing(form: &str, force: f64, scale: &Scale, r: &mut Random) -> Effect {
    let bristle = r.log_between(30e-6, 150e-6);
    match form {
        "iwan" => {
            let slips = [0.3, 0.6, 1.0, 1.6, 2.5];
            Effect::Iwan {
                elements: slips.iter().map(|of| (0.2 * force, of * bristle)).collect(),
            }
        }
        "by_position" => Effect::Load {
            // F(1 + a sin(2πx/p))·tanh(v/v_t)
            formula: Formula(|p, _, x, v| {
                let place = 1.0 + p[1] * (std::f64::consts::TAU * x / p[2]).sin();
                p[0] * place * (v / p[3]).tanh()
            }),
            params: vec![
                force,
                r.between(0.15, 0.35),
                scale.way_m * r.between(0.4, 1.2),
                r.log_between(0.1e-3, 0.3e-3),
            ],
        },
        _ => Effect::Friction(Friction {
            stat: force
                * if form == "bristles" {
                    r.between(1.1, 1.3)
                } else {
                    r.between(1.6, 2.3)
                },
            speed: r.log_between(2e-3, 8e-3),
            lorentz: form == "lorentz_bristles",
            width: 0.4 * bristle,
            ..Friction::coulomb(force)
        }),
    }
}

/// A power law of time, or a stretched exponential, as a spectrum of seven modes over three decades.
fn relaxing(form: &str, s: f64, scale: &Scale, r: &mut Random) -> Effect {
    let fraction = (0.15 * s * r.between(0.8, 1.2)).clamp(0.005, 0.6);
    let middle = match scale.material.mode {
        Some((_, base)) => base * r.log_between(4.0, 12.0),
        None => r.log_between(0.5, 5.0),
    };
    let alpha = r.between(-0.2, 0.2);
    let weights: Vec<(f64, f64)> = (0..7)
        .map(|k| {
            let ratio = 10f64.powf(0.5 * f64::from(k) - 1.5);
            let weight = match form {
                "fractional" => ratio.powf(alpha),
                // The spectrum of exp(−√(νt)): ρ(λ) d ln λ ~ λ^{−1/2}·exp(−1/(4λ)).
                _ => ratio.powf(-0.5) * (-0.25 / ratio).exp(),
            };
            (weight, middle * ratio)
        })
        .collect();
    let sum: f64 = weights.iter().map(|(weight, _)| weight).sum();
    Effect::Modes(
        weights
            .iter()
            .map(|(w, rate)| (fraction * w / sum, *rate))
            .collect(),
    )
}

/// A zero that wanders: waves with random phases whose power falls with the square of the frequency, or two
/// exponentials of which one is fast.
fn wandering(form: &str, force: f64, scale: &Scale, r: &mut Random) -> Effect {
    if form == "two_exponentials" {
        let formula = |p: &[f64], t: f64, _: f64, _: f64| {
            p[0] * ((1.0 - p[1]) * -(-t / p[2]).exp_m1() + p[1] * -(-t / p[3]).exp_m1())
        };
        let params = vec![
            r.sign() * force,
            r.between(0.3, 0.5),
            scale.seconds * r.between(0.4, 1.0),
            scale.seconds * r.between(0.03, 0.1),
        ];
        return Effect::Load {
            formula: Formula(formula),
            params,
        };
    }
    let mut params = vec![force, scale.seconds];
    params.extend((0..12).flat_map(|k| {
        let k = f64::from(k) + 0.5;
        [r.normal() / k, r.normal() / k]
    }));
    let formula = |p: &[f64], t: f64, _: f64, _: f64| {
        let turn = std::f64::consts::PI * t / p[1];
        let waves = p[2..].chunks_exact(2).enumerate();
        let sum = waves.map(|(k, ab)| {
            let angle = (k as f64 + 0.5) * turn;
            ab[0] * angle.sin() + ab[1] * (angle.cos() - 1.0)
        });
        p[0] * sum.sum::<f64>()
    };
    Effect::Load {
        formula: Formula(formula),
        params,
    }
}
