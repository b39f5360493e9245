//! Effects that measured machines asked for: lost motion, loops and friction of a drive, a lever's weight, other
//! curves of a material.

use super::super::effect::{Effect, Formula};
use super::super::random::Random;
use super::{Drawn, Scale};

/// The ids, which have kinds of cases of their own: the others' draws stay as they were.
pub(crate) const MACHINE: [&str; 7] = [
    "drive_backlash",
    "bouc_wen",
    "load_friction",
    "quadratic_drag",
    "gravity_torque",
    "loading_curve",
    "snap_through",
];

/// Draws the cable (N/m) that stands in the base model of a rig with this effect, where it needs one.
pub(crate) fn given_cable(id: &str, scale: &Scale, random: &mut Random) -> Option<f64> {
    let pulls = random.between(0.25, 0.6) * scale.peak_n / scale.way_m;
    match id {
        "drive_backlash" => Some(pulls),
        "load_friction" if random.chance(0.5) => Some(pulls),
        _ => None,
    }
}

/// Draws the effect `id`, or `None` if it belongs to another file.
pub(super) fn draw(id: &str, other: bool, s: f64, scale: &Scale, r: &mut Random) -> Option<Drawn> {
    let (peak, way, fastest) = (scale.peak_n, scale.way_m, scale.fastest_mps);
    let force = |of: f64, r: &mut Random| (of * s * r.between(0.8, 1.2)).min(0.6) * peak;
    let smooth = |r: &mut Random| r.log_between(0.1e-3, 0.4e-3);
    Some(match id {
        "drive_backlash" => {
            let width = (0.05 * s * r.between(0.8, 1.2)).min(0.4) * way;
            // Worn flanks touch one after the other.
            let worn = r.between(0.15, 0.35);
            let flanks = match other {
                true => vec![(width * (1.0 - worn), 0.5), (width * (1.0 + worn), 0.5)],
                false => vec![(width, 1.0)],
            };
            let form = if other { "worn" } else { "catalogue" };
            (form, Effect::Flanks(flanks), vec![("width", width)])
        }
        "bouc_wen" => bouc_wen(other, force(0.05, r), scale, r),
        "load_friction" => {
            let coefficient = (0.05 * s * r.between(0.8, 1.2)).min(0.6);
            let (rises, speed) = (r.between(0.15, 0.4), r.log_between(2e-3, 8e-3));
            let params = vec![
                ("coefficient", coefficient),
                ("transition_speed", smooth(r)),
            ];
            let effect = Effect::LoadFriction {
                coefficient,
                smooth: params[1].1,
                rises: if other { rises } else { 0.0 },
                speed,
            };
            (if other { "stribeck" } else { "catalogue" }, effect, params)
        }
        "quadratic_drag" => {
            let force = force(0.05, r);
            let power = if other { r.between(1.75, 2.4) } else { 2.0 };
            let params = vec![("coefficient", force / (fastest * fastest))];
            // c·v_m²·|v/v_m|^p·sgn v
            let effect = Effect::Load {
                formula: Formula(|p, _, _, v| p[0] * (v.abs() / p[1]).powf(p[2]) * v.signum()),
                params: vec![force, fastest, power],
            };
            (if other { "power" } else { "catalogue" }, effect, params)
        }
        "gravity_torque" => {
            // From a third of a turn to nearly a whole one.
            let radian = way / r.between(2.0, 5.5);
            let (phase, second) = (r.phase(), if other { r.between(0.05, 0.15) } else { 0.0 });
            let amplitude = force(0.05, r);
            let effect = Effect::Load {
                formula: Formula(|p, _, x, _| {
                    p[0] * ((x / p[1] + p[2]).sin() + p[3] * (2.0 * x / p[1] + 0.7).sin())
                }),
                params: vec![amplitude, radian, phase, second],
            };
            let params = vec![
                ("amplitude", amplitude),
                ("phase", phase),
                ("radian_m", radian),
            ];
            (
                if other { "two_masses" } else { "catalogue" },
                effect,
                params,
            )
        }
        "loading_curve" => {
            let fraction = (0.05 * s * r.between(0.8, 1.2)).min(0.6);
            // It takes a way to change curves, or the curves part with the depth.
            let (lasting, parts) = match (other, r.chance(0.5)) {
                (false, _) => (0.0, 0.0),
                (true, true) => (r.log_between(20e-6, 150e-6), 0.0),
                (true, false) => (0.0, r.between(0.3, 0.6) / scale.depth_m),
            };
            let smooth = smooth(r);
            let effect = Effect::Curves {
                fraction,
                smooth,
                lasting,
                parts,
            };
            let form = match other {
                false => "catalogue",
                true if parts > 0.0 => "parting",
                true => "lasting",
            };
            let params = vec![("fraction", fraction), ("transition_speed", smooth)];
            (form, effect, params)
        }
        "snap_through" => {
            let depth = scale.depth_m * r.between(0.3, 0.7);
            let width = depth * r.log_between(0.03, 0.15);
            let force = force(0.05, r);
            let effect = Effect::Snap {
                force,
                depth,
                width,
                skewed: if other { r.between(0.3, 0.7) } else { 0.0 },
            };
            let params = vec![("force", force), ("depth", depth), ("width", width)];
            (if other { "skewed" } else { "catalogue" }, effect, params)
        }
        _ => return None,
    })
}

/// A loop that levels off, or hardens; another form has a knee that is sharper, or rounder and then hardens.
fn bouc_wen(other: bool, force: f64, scale: &Scale, r: &mut Random) -> Drawn {
    let bends = scale.way_m * r.log_between(0.01, 0.06);
    let (gamma_share, hardens) = (r.between(0.4, 1.0), r.chance(0.3));
    let exponent = if other { r.between(1.4, 2.5) } else { 1.0 };
    let (beta, gamma, stiffness) = if hardens {
        // z grows to about twice the way.
        let beta = 1.2 / scale.way_m;
        (beta, -1.6 * beta, 1.5 * force / scale.way_m)
    } else {
        let both = bends.powf(-exponent);
        let beta = both / (1.0 + gamma_share);
        (beta, both - beta, force / bends)
    };
    let exponent = if hardens { 1.0 } else { exponent };
    let form = match (other, hardens) {
        (false, _) => "catalogue",
        (true, true) => "with_spring",
        (true, false) => "sharper",
    };
    let effect = Effect::Loop {
        stiffness,
        beta,
        gamma,
        exponent,
        // A second, stiffer loop inside the first, as of two clutches in parallel.
        inner: if form == "with_spring" { 0.2 } else { 0.0 },
    };
    let params = vec![
        ("stiffness", stiffness),
        ("beta", beta),
        ("gamma", gamma),
        ("exponent", exponent),
    ];
    (form, effect, params)
}
