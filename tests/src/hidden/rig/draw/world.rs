//! Effects that depend on time or on the motor's position, whatever is touched.

use super::super::effect::Effect;
use super::super::random::Random;
use super::{Drawn, Scale, harmonic};

/// Draws the effect `id`, or `None` if it belongs to another file.
pub(super) fn draw(id: &str, other: bool, s: f64, scale: &Scale, r: &mut Random) -> Option<Drawn> {
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
