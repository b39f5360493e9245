//! The chapter's experiments E1–E4 on the simulated rig: motor, 20 mN load cell in 5 mN steps, 1 µm
//! encoder, 1 kHz. The surface is known, the estimator knows nothing else.

use estimator_core::estimate::Event;
use estimator_core::estimate::config::Filter;
use estimator_core::estimate::method::Method;
use estimator_core::physics::law::ContactLaw;
use estimator_core::{Config, Estimate, Status};
use palpate::cli::demo::{self, Palpated};
use palpate::estimate::{Choices, Estimation, estimate};
use palpate::log::UniformLog;
use palpate::motion::Motion;
use palpate::plant::{GEL, Material, PLASTIC, Rig, Run, Stage};
use tests::tolerance;

/// The seeds of the sensors' noise for E1 and E3.
const SEEDS: std::ops::Range<u64> = 1..101;
/// The seed of E2 and E4.
const SEED: u64 = 5;

/// The chapter's estimator on a material whose surface it knows.
fn palpate(material: Material, seed: u64) -> Palpated {
    demo::palpate(material, 0.0, seed, Method::HUNT_CROSSLEY_TWO_STAGE, true).unwrap()
}

/// The true K (N/m), λ (N s/m) and n.
fn truth(material: &Material) -> [f64; 3] {
    let law = material.law;
    [law.stiffness_n_per_m, law.damping_ns_per_m, law.exponent]
}

/// The relative errors of K, λ, n; infinite for a parameter that is not observable.
fn errors(estimate: &Estimate<f32>, truth: [f64; 3]) -> [f64; 3] {
    let mut errors = [f64::INFINITY; 3];
    for ((error, parameter), truth) in errors.iter_mut().zip(&estimate.parameters).zip(truth) {
        if let Some(parameter) = parameter {
            *error = (f64::from(parameter.value) / truth - 1.0).abs();
        }
    }
    errors
}

fn last(estimation: &Estimation) -> &Estimate<f32> {
    estimation.replay.last().expect("the log is not empty")
}

fn assert_found(palpated: &Palpated, seed: u64) {
    let name = palpated.material.name;
    let end = last(&palpated.estimation);
    for (parameter, error) in ["K", "λ", "n"]
        .iter()
        .zip(errors(end, truth(&palpated.material)))
    {
        assert!(
            error < tolerance::CHAPTER,
            "{name}, seed {seed}: {parameter} is off by {error}"
        );
    }
    assert_eq!(end.status, Status::Converged, "{name}, seed {seed}");
    let changes = moments(&palpated.estimation, Event::MaterialChange);
    assert!(
        changes.is_empty(),
        "{name}, seed {seed}: no other material at {changes:?} s"
    );
}

#[test]
fn e1_stiff_plastic_gives_up_k_lambda_and_n() {
    for seed in SEEDS {
        let palpated = palpate(PLASTIC, seed);
        assert_found(&palpated, seed);
        let peak_n = palpated.log.force_n.iter().copied().fold(0.0, f64::max);
        assert!(
            (10.0..15.0).contains(&peak_n),
            "E1 presses to 12–14 N, here {peak_n}"
        );
    }
}

#[test]
fn e3_soft_gel_gives_up_k_lambda_and_n() {
    for seed in SEEDS {
        let palpated = palpate(GEL, seed);
        assert_found(&palpated, seed);
        let settled_s = palpated.estimation.outcome.settled_at_s.unwrap();
        assert!(
            tolerance::E3_SETTLES_S.contains(&settled_s),
            "seed {seed}: settled {settled_s} s after the first touch"
        );
        let multiple = palpated.estimation.outcome.force_rmse_n.unwrap() / 0.02;
        // Noise, and 0.3 % of 10 N from the parameters.
        assert!(
            multiple < 2.0,
            "seed {seed}: loop and power follow the data to {multiple} × noise"
        );
    }
}

#[test]
fn e1_and_e3_hold_with_the_chapters_filter_too() {
    let config = Config {
        filter: Filter::StateVariable {
            cutoff_hz: 40.0,
            damping_ratio: 1.0,
        },
        ..Config::default()
    };
    for material in [GEL, PLASTIC] {
        let palpated = palpate(material, SEED);
        let estimation = with(&palpated.log, config, Method::HUNT_CROSSLEY_TWO_STAGE);
        for error in errors(last(&estimation), truth(&material)) {
            assert!(error < tolerance::CHAPTER, "{}: {error}", material.name);
        }
    }
}

fn with(log: &UniformLog, config: Config, method: Method) -> Estimation {
    let choices = Choices {
        surface_m: Some(0.0),
        ..Choices::default()
    };
    estimate(log, config, &[method], choices).unwrap()
}

/// The two faults of E2 in a replay: the largest force at hardly any depth while pressing (N), and
/// the largest power F·δ̇ while unloading (W), which no passive contact can have.
fn faults(estimation: &Estimation) -> (f64, f64) {
    let mut at_zero_depth_n = 0.0_f64;
    let mut while_unloading_w = 0.0_f64;
    let settled = estimation.replay.records.len() / 2;
    let records = estimation
        .replay
        .records
        .iter()
        .zip(&estimation.outcome.replayed_n);
    for (record, force) in records.skip(settled) {
        let (force, speed) = (f64::from(*force), f64::from(record.speed_mps));
        if (0.0..5e-5).contains(&record.depth_m) && speed > 0.0 {
            at_zero_depth_n = at_zero_depth_n.max(force);
        }
        if speed < 0.0 {
            while_unloading_w = while_unloading_w.max(force * speed);
        }
    }
    (at_zero_depth_n, while_unloading_w)
}

#[test]
fn e2_the_linear_model_shows_its_two_faults_on_gel_and_hunt_crossley_does_not() {
    // GIVEN the gel of the chapter, pressed and released
    let palpated = palpate(GEL, SEED);
    let linear = with(&palpated.log, Config::default(), Method::KELVIN_VOIGT);
    // WHEN both laws are identified
    let (linear_n, linear_w) = faults(&linear);
    let (hunt_crossley_n, hunt_crossley_w) = faults(&palpated.estimation);
    // THEN Kelvin–Voigt jumps to a force at zero depth, λv = 60 N s/m · 15 mm/s, and returns power
    // of the wrong sign while unloading.
    assert!(
        linear_n > 0.3,
        "force of the linear model at zero depth: {linear_n} N"
    );
    assert!(
        linear_w > 1e-3,
        "power of the linear model while unloading: {linear_w} W"
    );
    // AND Hunt–Crossley at 50 µm has 1.5 % of its force at 1 mm, and gives power back only.
    assert!(hunt_crossley_n < 0.06, "{hunt_crossley_n} N");
    assert!(hunt_crossley_w < 1e-6, "{hunt_crossley_w} W");
    // AND its parameters are an average of the curve, near the chapter's 2260 N/m and 123 N s/m,
    let value = |slot: usize| f64::from(last(&linear).parameters[slot].unwrap().value);
    assert!((1800.0..2700.0).contains(&value(0)), "{} N/m", value(0));
    assert!((80.0..160.0).contains(&value(1)), "{} N s/m", value(1));
    // AND the linear model is not said to fit.
    assert_eq!(linear.outcome.status, Status::ModelSuspect);
}

/// Gel, then plastic under the same probe, swapped while it is lifted off.
fn swapped() -> (Run, f64) {
    let gel = Motion::palpation(GEL.peak_depth_m);
    let plastic = Motion::palpation(PLASTIC.peak_depth_m);
    let swap_s = 2.0 * gel.duration_s();
    let motion = gel.then(&gel).then(&plastic).then(&plastic);
    let schedule = [
        Stage {
            until_s: swap_s,
            contact: GEL.at(0.0),
        },
        Stage {
            until_s: f64::INFINITY,
            contact: PLASTIC.at(0.0),
        },
    ];
    (
        Rig::default().run(&schedule, &motion, SEED).unwrap(),
        swap_s,
    )
}

#[test]
fn e4_after_a_swap_the_new_values_are_found_uninfluenced_by_the_old() {
    // GIVEN gel for two palpations, then plastic for two
    let (run, swap_s) = swapped();
    let log = run.log.uniform().unwrap();
    // WHEN the whole run is estimated, and the plastic alone as well
    let both = with(&log, Config::default(), Method::HUNT_CROSSLEY_TWO_STAGE);
    let alone = palpate(PLASTIC, SEED);
    // THEN the gel is found before the swap and the plastic after it,
    let [gel, plastic] = both.outcome.segments.as_slice() else {
        panic!(
            "two materials are two segments: {:?}",
            both.outcome.segments
        );
    };
    let of = |segment: &palpate::estimate::outcome::Segment| {
        let mut estimate = *last(&both);
        estimate.parameters = segment.parameters;
        estimate
    };
    for (segment, material) in [(gel, GEL), (plastic, PLASTIC)] {
        for error in errors(&of(segment), truth(&material)) {
            assert!(error < tolerance::CHAPTER, "{}: {error}", material.name);
        }
    }
    // AND the plastic's values are those of a run that never saw gel, within their errors
    for (after, fresh) in last(&both)
        .parameters
        .iter()
        .zip(last(&alone.estimation).parameters)
    {
        if let (Some(after), Some(fresh)) = (after, fresh) {
            let apart = f64::from((after.value - fresh.value).abs());
            let error = f64::from(after.std_error.hypot(fresh.std_error));
            assert!(apart <= tolerance::FAR * error, "{after:?} {fresh:?}");
        }
    }
    // AND the change is flagged once, within 50 ms of the first touch of the plastic,
    let changes = moments(&both, Event::MaterialChange);
    let touches = moments(&both, Event::Contact);
    let touched_s = touches.into_iter().find(|t| *t > swap_s).unwrap();
    assert_eq!(changes.len(), 1, "{changes:?}");
    assert!(
        (touched_s..touched_s + 0.05).contains(&changes[0]),
        "{changes:?}, {touched_s}"
    );
    // AND the transient is short.
    let first_s = moments(&both, Event::Contact)[0];
    let settled_s = first_s + both.outcome.settled_at_s.unwrap() - touched_s;
    assert!(
        tolerance::E4_SETTLES_S.contains(&settled_s),
        "settled {settled_s} s after the first touch"
    );
}

fn moments(estimation: &Estimation, event: Event) -> Vec<f64> {
    let replay = &estimation.replay;
    let all = (0..replay.records.len()).filter(|i| replay.records.at(*i).event == Some(event));
    all.map(|i| replay.time_s(i)).collect()
}

#[test]
fn the_law_is_the_one_that_was_simulated() {
    // The truth of the rig, the law and the formula written out here agree: nothing is fitted to itself.
    let run = Rig::default()
        .run(
            &Stage::throughout(GEL.at(0.0)),
            &Motion::palpation(GEL.peak_depth_m),
            SEED,
        )
        .unwrap();
    for i in (0..run.truth.force_n.len()).step_by(97) {
        let (depth_m, speed_mps) = (run.truth.position_m[i], run.truth.velocity_mps[i]);
        let depth = depth_m / 1e-3;
        let force = if depth > 0.0 {
            (1.35 + 36.0 * speed_mps) * depth.powf(1.35)
        } else {
            0.0
        };
        assert!((run.truth.force_n[i] - force.max(0.0)).abs() < 1e-9 * force.abs().max(1.0));
        assert!((GEL.law.force_n(depth_m, speed_mps) - force).abs() < 1e-9 * force.abs().max(1.0));
    }
}
