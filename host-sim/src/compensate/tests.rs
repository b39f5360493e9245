//! What a rig hides biases an estimate, and its compensation takes the bias away.

use estimator_core::Config;
use estimator_core::estimate::method::Method;
use estimator_core::physics::{effect::Effect, effect::EffectId, rig::Effects};

use super::*;
use crate::estimate::{Choices, estimate};
use crate::motion::Motion;
use crate::plant::{GEL, Rig, Stage};
use crate::toml_reader::TomlFile;

const SEED: u64 = 11;

/// K (N/m), λ (N s/m), n of [`GEL`].
const TRUTH: [(&str, f64); 3] = [("stiffness", 1350.0), ("damping", 36.0), ("exponent", 1.35)];

/// A rig with these effects, as a model file has it.
fn model(effects: &str) -> Model {
    let text = format!(
        "[environment]\nlaw = \"hunt_crossley\"\nstiffness = 1350\ndamping = 36\nexponent = 1.35\n{effects}"
    );
    let path = Path::new("m.toml");
    Model::from_toml(&TomlFile::parse(text, path).unwrap(), path).unwrap()
}

/// What the sensors of that rig read over the built-in palpation of gel.
fn recorded(model: &Model) -> UniformLog {
    let rig = Rig {
        effects: model.rig().unwrap().effects,
        ..Rig::default()
    };
    let motion = Motion::palpation(GEL.peak_depth_m);
    let run = rig
        .run(&Stage::throughout(GEL.at(0.0)), &motion, SEED)
        .unwrap();
    run.log.uniform().unwrap()
}

/// How far each parameter is from the truth, in percent, and in standard errors.
fn errors(log: &UniformLog) -> [(f64, f64); 3] {
    let methods = [Method::HUNT_CROSSLEY_BANK];
    let found = estimate(log, Config::default(), &methods, Choices::default()).unwrap();
    TRUTH.map(|(name, truth)| {
        let Some(own) = found.outcome.value(name) else {
            return (f64::INFINITY, f64::INFINITY);
        };
        let off = f64::from(own.value) - truth;
        (
            100.0 * (off / truth).abs(),
            (off / f64::from(own.std_error)).abs(),
        )
    })
}

#[test]
fn hidden_effects_bias_the_estimate_and_compensation_takes_the_bias_away() {
    let effect = |id: &str, rest: &str| format!("[[effect]]\nid = \"{id}\"\n{rest}\n");
    let friction = |rest: &str| effect("coulomb_friction", &format!("force = 0.4\n{rest}"));
    let others = effect("force_offset", "force = 0.3") + &effect("tool_inertia", "mass = 0.2");
    // The largest error (%) that the effect must do at least, hidden.
    for (name, effects, hidden) in [
        (
            "friction, offset, inertia",
            friction("transition_speed = 5e-4") + &others,
            4.0,
        ),
        ("pre-sliding friction", friction("width = 1e-5"), 4.0),
        (
            "compliance",
            effect("series_compliance", "stiffness = 12000"),
            4.0,
        ),
        (
            "encoder",
            effect(
                "encoder_periodic_error",
                "amplitude = 4e-5\npitch = 2e-3\nphase = 0.4",
            ),
            2.0,
        ),
        ("lag", effect("force_lag", "time_constant = 4e-3"), 4.0),
        ("delay", effect("time_delay", "delay = 3.4e-3"), 4.0),
        ("early force", effect("time_delay", "delay = -3.4e-3"), 4.0),
        ("drag", effect("viscous_drag", "coefficient = 8"), 4.0),
    ] {
        let model = model(&effects);
        let raw = recorded(&model);
        let before = errors(&raw);
        let after = errors(&compensate(&raw, &model).unwrap());
        let worst = before
            .iter()
            .map(|(percent, _)| *percent)
            .fold(0.0, f64::max);
        assert!(worst > hidden, "{name} hidden: {before:.2?}");
        for (percent, sigmas) in after {
            assert!(
                percent < 1.0 && sigmas < 3.0,
                "{name} compensated: {after:.2?}"
            );
        }
    }
}

#[test]
fn friction_that_flips_below_the_encoders_sight_is_taken_off_and_its_flips_are_not_learned_from() {
    // A motor that stops in contact swings about its end for 25 ms with less than 30 µm/s. The rig's
    // 0.4 N have a sign there, a 1 µm encoder sees none: learned from, they were 1.0 % and 4 touches of 5 ms.
    let model = model("[[effect]]\nid = \"coulomb_friction\"\nforce = 0.4\n");
    let raw = recorded(&model);
    let worst = |log: &UniformLog| {
        errors(log)
            .iter()
            .map(|(percent, _)| *percent)
            .fold(0.0, f64::max)
    };
    assert!(worst(&raw) > 4.0);
    let without = compensate(&raw, &model).unwrap();
    let after = worst(&without);
    assert!(after < 0.5, "{after} %");
    let methods = [Method::HUNT_CROSSLEY_BANK];
    let found = estimate(&without, Config::default(), &methods, Choices::default()).unwrap();
    // Three touches at 1 Hz, four at 2 Hz, a ramp with a hold.
    assert_eq!(found.outcome.touches.len(), 8);
    assert!(!without.has_force(without.len() - 460));
    assert!(
        without
            .notes
            .iter()
            .any(|note| note.contains("where a friction turns"))
    );
}

#[test]
fn a_rig_without_effects_leaves_the_log_as_it_is() {
    let model = model("");
    let raw = recorded(&model);
    let out = compensate(&raw, &model).unwrap();
    assert_eq!(out.position_m, raw.position_m);
    assert_eq!(out.force_n, raw.force_n);
    assert!(out.compensated.effects.is_empty());
    assert!(
        out.notes.iter().any(|note| note.contains("no effect")),
        "{:?}",
        out.notes
    );
}

#[test]
fn the_notes_say_what_came_off_and_what_stayed() {
    let model = model(
        "[[effect]]\nid = \"force_lag\"\ntime_constant = 0.004\n\
         [[effect]]\nid = \"adhesion\"\nforce = 0.1\nneck_length = 1e-4\n",
    );
    let raw = recorded(&model);
    let out = compensate(&raw, &model).unwrap();
    assert_eq!(out.compensated.effects, ["force_lag"]);
    assert!(
        out.notes
            .iter()
            .any(|note| note.contains("not compensated: `adhesion`")),
        "{:?}",
        out.notes
    );
    // 5 ms of half a window and a sample.
    assert_eq!(raw.len() - out.len(), 6);
    assert!((out.time_s[0] - raw.time_s[0]).abs() < 1e-12);
    assert_eq!(out.force_noise_n(), raw.force_noise_n());
}

#[test]
fn a_force_at_the_limit_is_not_learned_from() {
    let model = model("[[effect]]\nid = \"force_saturation\"\nlimit = 6.0\n");
    let out = compensate(&recorded(&model), &model).unwrap();
    let marked =
        crate::replay::samples(&out).filter(|sample| sample.faults.has(Fault::ForceSaturated));
    assert!(marked.count() > 100);
}

#[test]
fn a_delay_that_is_too_long_is_refused_with_its_rate() {
    let model = model("[[effect]]\nid = \"time_delay\"\ndelay = 0.2\n");
    let delay = Effect::new(EffectId::TimeDelay, &[0.2, 0.0, 0.0, 0.0, 0.0]);
    assert_eq!(model.rig().unwrap().effects, Effects::from_iter([delay]));
    let error = compensate(&recorded(&model), &model)
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("effect.time_delay.delay") && error.contains("64 samples"),
        "{error}"
    );
}

#[test]
fn whatever_a_result_is_made_of_counts_as_invented() {
    // GIVEN one sample that was invented
    let model = model("[[effect]]\nid = \"coulomb_friction\"\nforce = 0.4\n");
    let mut raw = recorded(&model);
    raw.in_gap[500] = true;
    // WHEN friction is taken off, whose window has 13 samples at 1 kHz: 11, and two for the central difference
    let out = compensate(&raw, &model).unwrap();
    // THEN so many results are
    let marked = out.in_gap.iter().filter(|marked| **marked).count();
    assert_eq!(marked, 13);
}
