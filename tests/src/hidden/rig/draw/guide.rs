//! Effects in the guide: friction, drag, mass.

use super::super::effect::{Effect, Friction};
use super::super::random::Random;
use super::{Drawn, Scale};

/// Draws the effect `id`, or `None` if it belongs to another file.
pub(super) fn draw(id: &str, other: bool, s: f64, scale: &Scale, r: &mut Random) -> Option<Drawn> {
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
            let params = [("coefficient", linear), ("quadratic_share", bend)];
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
            let params = [("coefficient", coefficient), ("bend", bend)];
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
            let params = [("mass", mass), ("loose_share", loose)];
            (
                if other { "loose_part" } else { "catalogue" },
                effect,
                params[..1 + usize::from(other)].to_vec(),
            )
        }
        _ => return None,
    })
}

/// The speed at which the friction reverses. No dry contact reverses at once: the rigs of `data/hidden-effects` take 0.1–0.3 mm/s (which is
/// also what an encoder of 1 µm can tell from standing), and so do these.
fn transition_mps(r: &mut Random) -> f64 {
    r.log_between(0.1e-3, 0.3e-3)
}

fn coulomb(other: bool, force: f64, r: &mut Random) -> Drawn {
    let rigid = Friction::coulomb(force);
    let bristle = r.log_between(20e-6, 150e-6);
    let (which, excess, speed) = (r.unit(), r.between(1.1, 1.35), r.log_between(1e-3, 6e-3));
    let smooth = transition_mps(r);
    if !other {
        if r.chance(0.4) {
            let dahl = Friction {
                width: bristle,
                ..rigid
            };
            return (
                "catalogue",
                Effect::Friction(dahl),
                vec![("force", force), ("width", bristle)],
            );
        }
        let sliding = Friction { smooth, ..rigid };
        let params = vec![("force", force), ("transition_speed", smooth)];
        return ("catalogue", Effect::Friction(sliding), params);
    }
    let falling = Friction {
        stat: force * excess,
        speed,
        smooth,
        ..rigid
    };
    let (form, friction) = match which {
        w if w < 0.4 => ("stribeck", falling),
        w if w < 0.8 => (
            "lugre",
            Friction {
                width: 0.5 * bristle,
                ..falling
            },
        ),
        // It reverses at once, while the encoder still reads the same count.
        _ => ("sharp", rigid),
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
    let smooth = transition_mps(r);
    let plain = Friction {
        stat,
        speed,
        smooth,
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
    let mut params = vec![
        ("kinetic_force", kinetic),
        ("static_force", stat),
        ("speed", speed),
    ];
    params.push(("transition_speed", smooth));
    (form, Effect::Friction(friction), params)
}
