//! How well the catalogue's form can stand for the form that a rig really has.
//!
//! A workflow that knows the catalogue cannot leave less than the best joint fit of base and effect
//! in the catalogue's form, from a start at the true values. Where that is well above the floor, the
//! honest answer is not `missing_effects` alone.

use super::case::Case;
use super::draw::Hidden;
use super::draw::machine::MACHINE;
use super::effect::{Effect, Formula, Friction};
use super::fit::{Limit, Target, base_limits, speed};
use super::material::{Law, Material};
use super::motion::Track;
use super::plant::Plant;

/// Sub-steps in a sample: enough for a ratio to 1 %.
const EVERY: usize = 2;

/// Another effect of the catalogue is as right a name if its best fit leaves no more than this times
/// what the best fit of the hidden one leaves: the rig is in neither form.
const AS_GOOD: f64 = 1.005;

/// Pairs of the hidden effect's id and another id that describes this rig as well; `form_rmse_n` (N) is
/// what the best fit of the hidden one leaves.
pub(crate) fn as_good(case: &Case, form_rmse_n: f64) -> Vec<(&'static str, &'static str)> {
    let hidden = &case.hidden[0];
    let rivals = rivals(hidden, case.material.law, &case.track);
    let good = rivals
        .iter()
        .filter(|rival| best_rmse_n(case, rival) < AS_GOOD * form_rmse_n);
    good.map(|rival| (hidden.id, rival.id)).collect()
}

/// The relatives that another form of an effect may come close to, with first guesses of their
/// parameters: a low-pass of second order is nearly a delay, and one bent curve nearly the other.
fn rivals(hidden: &Hidden, law: Law, track: &Track) -> Vec<Hidden> {
    if hidden.form == "catalogue" {
        return Vec::new();
    }
    let rival = |id, name, guess: f64| Hidden {
        id,
        form: "catalogue",
        params: vec![(name, guess)],
        ..hidden.clone()
    };
    let deepest_m = track.range_m().1;
    let p = hidden.params[0].1;
    match hidden.id {
        "force_lag" => vec![rival("time_delay", "delay", p)],
        "exponential_stiffening" if law == Law::KelvinVoigt => {
            vec![rival("power_law_stiffness", "exponent", 1.2)]
        }
        "power_law_stiffness" => {
            vec![rival(
                "exponential_stiffening",
                "rate",
                (p - 1.0) / deepest_m,
            )]
        }
        _ => Vec::new(),
    }
}

/// The RMSE (N) that the base with an effect in the catalogue's form leaves when it is fitted to the log.
pub fn best_rmse_n(case: &Case, hidden: &Hidden) -> f64 {
    let (effect_start, effect_limits) = start(hidden);
    let law = case.material.law;
    let bases = law.parameters().len();
    let mut limits = base_limits(law);
    limits.extend(effect_limits);
    let read = case.plant.readings(&case.track);
    let predict = |numbers: &[f64]| {
        let effect = catalogue_form(hidden, &numbers[bases..]);
        let material = Material::from_numbers(law, &numbers[..bases]);
        if matches!(effect, Effect::Encoder { .. }) {
            return behind_encoder(material, effect, &read);
        }
        let cable = case.given.map(|(stiffness, _)| Effect::cable(stiffness));
        let plant = Plant {
            hidden: [effect].into_iter().chain(cable).collect(),
            ..Plant::bare(material)
        };
        plant.samples(&case.track, EVERY)
    };
    let f = case.rows.iter().map(|row| row[2]).collect();
    let mut numbers = case.material.numbers();
    numbers.extend(effect_start);
    Target {
        f,
        predict: Box::new(predict),
        limits,
    }
    .fit(&numbers, &[])
    .rmse_n
}

/// The force of the bare material at the true positions behind the readings of an encoder with this
/// error.
fn behind_encoder(material: Material, encoder: Effect, read: &[f64]) -> Vec<f64> {
    let plant = Plant {
        hidden: vec![encoder],
        ..Plant::bare(material)
    };
    let true_m = |read: &f64| {
        // Converges as 2πA/p, here 0.3 at most: 10⁻⁵ of the error.
        (0..10).fold(*read, |x, _| x + read - plant.read_m(x))
    };
    let x: Vec<f64> = read.iter().map(true_m).collect();
    let v = speed(&x, 1e-3);
    plant.force(&x, &v, &v, 1e-3)
}

/// The start of the parameters of the catalogue's form, and how each may move.
fn start(hidden: &Hidden) -> (Vec<f64>, Vec<Limit>) {
    let p: Vec<f64> = hidden.params.iter().map(|(_, value)| *value).collect();
    let relative = |share: f64, of: f64| Limit::free(share * of.abs());
    if hidden.id == "gravity_torque" {
        let limits = vec![Limit::Scaled, Limit::free(0.3)];
        return (p[..2].to_vec(), limits);
    }
    if MACHINE.contains(&hidden.id) {
        // The exponent of a loop stays what it is, and γ keeps its sign.
        let count = if hidden.id == "bouc_wen" { 2 } else { p.len() };
        return (p[..count].to_vec(), vec![Limit::Scaled; count]);
    }
    if matches!(hidden.effect, Effect::Load { .. }) {
        let limits = vec![Limit::Scaled; p.len()];
        return (p, limits);
    }
    match (hidden.id, hidden.form) {
        ("stress_relaxation", "two_branches") => {
            (vec![p[0], (p[1] * p[2]).sqrt()], vec![Limit::Scaled; 2])
        }
        ("power_law_stiffness", "two_powers") => {
            (vec![0.5 * (p[0] + p[1])], vec![Limit::free(0.3)])
        }
        ("exponential_stiffening", _) => (vec![1.3 * p[0]], vec![Limit::Scaled]),
        // As on the rig: elastic before it slides, or sliding with a transition speed.
        ("coulomb_friction", _) => {
            let second = if elastic(hidden) { 20e-6 } else { 0.15e-3 };
            (vec![p[0], second], vec![Limit::Scaled; 2])
        }
        ("stribeck_friction", _) => (p[..4].to_vec(), vec![Limit::Scaled; 4]),
        ("surface_motion" | "periodic_disturbance", _) => {
            let limits = vec![Limit::Scaled, relative(0.005, p[1]), Limit::free(0.5)];
            (p[..3].to_vec(), limits)
        }
        ("cogging", _) => {
            let limits = vec![Limit::Scaled, relative(0.01, p[1]), Limit::free(0.5)];
            (p[..3].to_vec(), limits)
        }
        ("asymmetric_drag" | "force_offset" | "time_delay", _) => {
            (vec![p[0]], vec![relative(0.5, p[0])])
        }
        // The rig's drift has no time constant; the fit starts from 10 s.
        ("force_drift", _) => (
            vec![2.0 * p[0], 10.0],
            vec![relative(1.0, p[0]), Limit::Scaled],
        ),
        ("encoder_periodic_error", _) => (
            p[..3].to_vec(),
            vec![Limit::Scaled, relative(0.01, p[1]), Limit::free(0.5)],
        ),
        (
            "adhesion" | "permanent_set" | "hysteretic_damping" | "cyclic_softening"
            | "buried_layer" | "stress_relaxation",
            _,
        ) => (p[..2].to_vec(), vec![Limit::Scaled; 2]),
        _ => (vec![p[0]], vec![Limit::Scaled]),
    }
}

fn elastic(hidden: &Hidden) -> bool {
    matches!(hidden.effect, Effect::Friction(friction) if friction.width > 0.0)
}

/// An effect that measured machines asked for, in the catalogue's form; `None` for any other.
fn of_machine(hidden: &Hidden, p: &[f64]) -> Option<Effect> {
    let own = |name: &str| hidden.params.iter().find(|(own, _)| *own == name);
    let value = |name: &str| own(name).map_or(0.0, |(_, value)| *value);
    Some(match hidden.id {
        "drive_backlash" => Effect::Flanks(vec![(p[0], 1.0)]),
        "bouc_wen" => Effect::Loop {
            stiffness: p[0],
            beta: p[1],
            gamma: value("gamma") * p[1] / value("beta"),
            exponent: value("exponent"),
            inner: 0.0,
        },
        "load_friction" => Effect::LoadFriction {
            coefficient: p[0],
            smooth: p[1],
            rises: 0.0,
            speed: 1.0,
        },
        "quadratic_drag" => Effect::Drag {
            linear: 0.0,
            quadratic: p[0],
        },
        "gravity_torque" => Effect::Load {
            formula: Formula(|p, _, x, _| p[0] * (x / p[1] + p[2]).sin()),
            params: vec![p[0], value("radian_m"), p[1]],
        },
        "loading_curve" => Effect::Curves {
            fraction: p[0],
            smooth: p[1],
            lasting: 0.0,
            parts: 0.0,
        },
        "snap_through" => Effect::Snap {
            force: p[0],
            depth: p[1],
            width: p[2],
            skewed: 0.0,
        },
        _ => return None,
    })
}

/// The effect in the catalogue's form with these parameters.
fn catalogue_form(hidden: &Hidden, p: &[f64]) -> Effect {
    if let Some(effect) = of_machine(hidden, p) {
        return effect;
    }
    if let Effect::Load { formula, .. } = hidden.effect {
        let params = p.to_vec();
        return Effect::Load { formula, params };
    }
    let second = 0.0;
    match hidden.id {
        "stress_relaxation" => Effect::Modes(vec![(p[0], p[1])]),
        "power_law_stiffness" => Effect::Curve {
            terms: vec![(1.0, p[0])],
            blunt: 0.0,
        },
        "depth_dependent_damping" => Effect::DampingDepth {
            exponent: p[0],
            levelling: 0.0,
        },
        "exponential_stiffening" => Effect::Stiffening {
            rate: p[0],
            locking: 0.0,
        },
        "adhesion" => Effect::Adhesion {
            force: p[0],
            neck: p[1],
            loading: 1.0,
            shape: 1.0,
        },
        "permanent_set" => Effect::Set {
            fraction: p[0],
            yield_depth: p[1],
            delay: 0.0,
        },
        "buried_layer" => Effect::Layer {
            stiffness: p[0],
            depth: p[1],
            rounding: 0.0,
        },
        "surface_motion" => Effect::Surface {
            amplitude: p[0],
            hz: p[1],
            phase: p[2],
            second,
        },
        "hysteretic_damping" => Effect::Hysteresis {
            elements: vec![(p[0], p[1])],
            jenkins: false,
        },
        "cyclic_softening" => Effect::Softening {
            fraction: p[0],
            scale: p[1],
            energy: 0.0,
        },
        "coulomb_friction" => {
            let (width, smooth) = if elastic(hidden) {
                (p[1], 0.0)
            } else {
                (0.0, p[1])
            };
            Effect::Friction(Friction {
                width,
                smooth,
                ..Friction::coulomb(p[0])
            })
        }
        "stribeck_friction" => Effect::Friction(Friction {
            stat: p[1],
            speed: p[2],
            smooth: p[3],
            ..Friction::coulomb(p[0])
        }),
        "viscous_drag" => Effect::Drag {
            linear: p[0],
            quadratic: 0.0,
        },
        "asymmetric_drag" => Effect::AsymmetricDrag {
            coefficient: p[0],
            bend: 0.0,
            speed: 1.0,
        },
        "tool_inertia" => Effect::Inertia {
            mass: p[0],
            loose: 0.0,
            hz: 1.0,
            damping: 1.0,
        },
        "force_offset" => Effect::Offset {
            force: p[0],
            settling: 0.0,
            time: 1.0,
        },
        "force_drift" => Effect::Drift {
            rate: p[0],
            time: p[1],
            bend: 0.0,
            scale: 1.0,
        },
        "cable_stiffness" => Effect::cable(p[0]),
        "cogging" => Effect::Cogging {
            amplitude: p[0],
            pitch: p[1],
            phase: p[2],
            second,
        },
        "periodic_disturbance" => Effect::Disturbance {
            amplitude: p[0],
            hz: p[1],
            phase: p[2],
            second,
            breathing: 0.0,
        },
        "series_compliance" => Effect::Compliance {
            stiffness: p[0],
            progressive: 0.0,
            scale: 1.0,
        },
        "backlash" => Effect::Backlash {
            plays: vec![(p[0], 1.0)],
        },
        "force_lag" => Effect::Lag {
            time: p[0],
            order: 1,
        },
        "time_delay" => Effect::Delay {
            seconds: p[0],
            jitter: 0.0,
        },
        "force_saturation" => Effect::Saturation {
            limit: p[0],
            sharpness: f64::INFINITY,
        },
        _ => Effect::Encoder {
            amplitude: p[0],
            pitch: p[1],
            phase: p[2],
            second,
        },
    }
}
