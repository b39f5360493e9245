//! The catalogue is implemented twice, by the generator and by `estimator_core::physics::rig`, without
//! shared code: on the same motion at 20 kHz both give the same force, effect by effect.

use estimator_core::physics::effect::{Effect, EffectId, MOST_PARAMETERS, Motion};
use estimator_core::physics::law::{
    Elastic, HuntCrossley, KelvinVoigt, QuasiLinear, RelaxationMode, Zener,
};
use estimator_core::physics::rig::{Environment, Rig};
use tests::hidden::rig::case::Case;
use tests::hidden::rig::draw::every_id;
use tests::hidden::rig::fit::rms;
use tests::hidden::rig::material::Law;
use tests::hidden::rig::motion::{FINE_HZ, SUBSTEPS};

/// The largest difference (rms) over the peak force. The two treat the sub-step of a touch, of a reversal
/// and of a stop differently; the noise of these rigs is 4·10⁻⁴ of the peak and more.
const AGREE: f64 = 1e-4;

/// The material of a case as the project's environment.
fn environment(case: &Case) -> Environment<f64> {
    let p = case.material.numbers();
    let bare: Environment<f64> = match case.material.law {
        Law::KelvinVoigt => KelvinVoigt {
            stiffness_n_per_m: p[0],
            damping_ns_per_m: p[1],
        }
        .into(),
        Law::HuntCrossley => HuntCrossley::new(p[0], p[1], p[2], 1e-3).into(),
        Law::QuasiLinear => QuasiLinear {
            elastic: Elastic::Power {
                stiffness_n_per_m: p[0],
                exponent: p[1],
                reference_depth_m: 1e-3,
            },
            modes: [RelaxationMode {
                fraction: p[2],
                rate_per_s: p[3],
            }],
        }
        .into(),
        Law::Zener => Zener {
            stiffness_n_per_m: p[0],
            second_stiffness_n_per_m: p[1],
            damping_ns_per_m: p[2],
        }
        .into(),
    };
    bare.at(case.material.surface)
}

/// The hidden effect of a case as the project's effect.
fn effect(case: &Case) -> Effect<f64> {
    let hidden = &case.hidden[0];
    let id = EffectId::from_name(hidden.id).unwrap_or_else(|| panic!("{} is unknown", hidden.id));
    let mut row = [0.0; MOST_PARAMETERS];
    let info = id.info();
    // How long a radian is on the rig is no number of the effect.
    for (name, value) in hidden.params.iter().filter(|own| own.0 != "radian_m") {
        let place = info.parameters.iter().position(|p| p.name == *name);
        row[place.unwrap_or_else(|| panic!("{} has no {name}", hidden.id))] = *value;
    }
    Effect::new(id, &row)
}

/// The project's force at the samples of a case.
fn theirs(case: &Case) -> Vec<f64> {
    let mut rig = Rig::bare(environment(case));
    let mut lever = Rig::bare(Environment::free());
    match case.radian_m() {
        Some(_) => lever = lever.with(effect(case)),
        None => rig = rig.with(effect(case)),
    }
    if let Some(cable) = case.cable_n_per_m() {
        rig = rig.with(Effect::new(
            EffectId::CableStiffness,
            &[cable, 0.0, 0.0, 0.0, 0.0],
        ));
    }
    let (track, mut state) = (&case.track, rig.at_rest());
    // A rig that turns has its positions in radians.
    let radian_m = case.radian_m().unwrap_or(1.0);
    let late = (rig.delay_s().unwrap_or(0.0) * FINE_HZ).round() as i64;
    // v_read/v
    let gain = |x: f64| (case.plant.read_m(x + 1e-9) - case.plant.read_m(x - 1e-9)) / 2e-9;
    let force: Vec<f64> = (0..track.x.len())
        .map(|k| {
            let read = Motion {
                time_s: k as f64 / FINE_HZ,
                position_m: case.plant.read_m(track.x[k]),
                speed_mps: track.v[k] * gain(track.x[k]),
                acceleration_mps2: track.a[k],
            };
            let turned = Motion {
                position_m: read.position_m / radian_m,
                ..read
            };
            let weight = lever.step(&mut lever.at_rest(), turned, 1.0 / FINE_HZ);
            rig.step(&mut state, read, 1.0 / FINE_HZ).force_n + weight.force_n
        })
        .collect();
    let last = force.len() as i64 - 1;
    (0..track.samples)
        .map(|k| force[((k * SUBSTEPS) as i64 - late).clamp(0, last) as usize])
        .collect()
}

#[test]
fn both_readings_of_the_catalogue_agree() {
    let mut apart = Vec::new();
    for index in 0..every_id().len() {
        let case = Case::sketch(5, index);
        let ours = case.plant.samples(&case.track, SUBSTEPS);
        let peak = ours.iter().fold(0.0, |top: f64, f| f.abs().max(top));
        let difference: Vec<f64> = theirs(&case)
            .iter()
            .zip(&ours)
            .map(|(t, o)| t - o)
            .collect();
        let share = rms(&difference) / peak;
        if share.is_nan() || share >= AGREE {
            apart.push(format!(
                "{} on {}: {share:.2e}",
                case.hidden[0].id,
                case.material.law.name()
            ));
        }
    }
    assert!(apart.is_empty(), "{apart:#?}");
}
