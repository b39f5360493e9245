//! The rig against closed forms.

use std::path::Path;
use tests::faults::rig::case::Case;
use tests::faults::rig::fault::{self, all, named};
use tests::faults::rig::plan::World;
use tests::faults::rig::world::{Stage, forces};
use tests::faults::rig::{FINE_HZ, NOISE_N, REFERENCE_M, material::Material};
use tests::faults::score::fit::fit;
use tests::tolerance::{FAULT_FIT, FAULT_FIT_ERRORS, FAULT_FIT_RESIDUAL};

fn case(name: &str, severity: usize, index: u64) -> Case {
    let fault = named(name).unwrap_or_else(|| panic!("{name} is no fault"));
    Case::new(fault, severity, 3, index)
}

#[test]
fn the_rig_uses_no_code_of_the_project_and_not_the_scorer() {
    let mut folders = vec![Path::new(env!("CARGO_MANIFEST_DIR")).join("src/faults/rig")];
    let mut read = 0;
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            read += 1;
            let text = std::fs::read_to_string(&path).unwrap();
            let code = text.lines().filter(|line| !line.trim().starts_with("//"));
            for line in code {
                for foreign in ["estimator_core", "palpate::", "score::", "tolerance"] {
                    assert!(!line.contains(foreign), "{}: {line}", path.display());
                }
            }
        }
    }
    assert!(read > 10, "{read} files");
}

#[test]
fn names_are_unique_and_every_fault_makes_a_log() {
    let mut names: Vec<&str> = all().map(|fault| fault.name).collect();
    assert_eq!(names[0], "none");
    names.sort_unstable();
    let number = names.len();
    names.dedup();
    assert_eq!(names.len(), number);
    for (place, fault) in fault::all().enumerate() {
        let rows = Case::new(fault, place % 3, 3, place as u64).rows;
        let channels = rows.position_m.iter().chain(&rows.force_n);
        assert!(channels.chain(&rows.time_s).all(|value| value.is_finite()));
        let increases = rows.time_s.windows(2).all(|pair| pair[0] < pair[1]);
        assert!(increases && rows.time_s.len() > 1000, "{}", fault.name);
    }
}

#[test]
fn the_same_seed_gives_the_same_log_and_another_one_another() {
    let log = |seed| Case::new(named("spikes_force").unwrap(), 1, seed, 2).csv();
    assert_eq!(log(7), log(7));
    assert_ne!(log(7), log(8));
}

/// A sine of 1 Hz and 1 mm around the surface against F = (K·δ₀ + λ·δ̇)(δ/δ₀)ⁿ with its exact speed.
#[test]
fn the_force_is_the_law_at_every_sub_step() {
    let material = Material {
        numbers: [1349.0, 36.0, 1.35],
    };
    let stages = [Stage {
        from_s: 0.0,
        material,
    }];
    let omega = std::f64::consts::TAU;
    let time = |k: usize| k as f64 / FINE_HZ;
    let path: Vec<f64> = (0..20_000)
        .map(|k| 1e-3 * (omega * time(k)).sin())
        .collect();
    let force = forces(&path, &stages, &World::default());
    for k in (1..path.len()).step_by(7) {
        let speed = 1e-3 * omega * (omega * (time(k) - 0.5 / FINE_HZ)).cos();
        let depth = path[k].max(0.0);
        let due = (1349.0 * REFERENCE_M + 36.0 * speed) * (depth / REFERENCE_M).powf(1.35);
        assert!((force[k] - due).abs() < 1e-6, "{k}: {} of {due}", force[k]);
    }
}

/// At rest a spring in front of the tip takes its share: F = K·δ₀·((x − c·F)/δ₀)ⁿ.
#[test]
fn a_compliant_tool_rests_where_spring_and_material_balance() {
    let material = Material {
        numbers: [1349.0, 36.0, 1.35],
    };
    let stages = [Stage {
        from_s: 0.0,
        material,
    }];
    let world = World {
        compliance_m_per_n: 1e-4,
        ..World::default()
    };
    let path: Vec<f64> = (0..60_000)
        .map(|k| 3e-3 * (k as f64 / 2e4).min(1.0))
        .collect();
    let force = *forces(&path, &stages, &world).last().unwrap();
    let balance = material.force_n(3e-3 - 1e-4 * force, 0.0);
    assert!(
        (force / balance - 1.0).abs() < 1e-6,
        "{force} N, {balance} N"
    );
}

#[test]
fn the_truth_at_another_depth_is_the_same_law() {
    let case = case("none", 1, 3);
    let material = case.stages[0].material;
    for reference_m in [1e-5, REFERENCE_M, 4e-3] {
        let [stiffness, damping, exponent] = case.truth_at(0.0, reference_m);
        let law = |depth: f64, speed: f64| {
            (stiffness * reference_m + damping * speed) * (depth / reference_m).powf(exponent)
        };
        for (depth, speed) in [(2e-5, 1e-3), (8e-4, 0.02), (3e-3, -0.01)] {
            let due = material.force_n(depth, speed);
            assert!(
                (law(depth, speed) / due - 1.0).abs() < 1e-12,
                "{reference_m}"
            );
        }
    }
}

/// The offline fit finds an honest log's material within its standard errors and leaves the noise.
#[test]
fn the_offline_fit_leaves_the_noise_of_an_honest_log() {
    for index in 0..12 {
        let case = case("none", 1, index);
        let truth = case.truth(0.0);
        let start = truth.map(|value| 1.2 * value);
        let found = fit(&case.rows, start, case.surface_m + 1e-4).expect("the motion tells all");
        let numbers = found.values.iter().zip(found.std_errors).zip(truth);
        for (slot, ((value, error), truth)) in numbers.enumerate() {
            assert!(
                (value - truth).abs() < FAULT_FIT_ERRORS * error,
                "{index}: {value} ± {error} of {truth}"
            );
            assert!(
                (value / truth - 1.0).abs() < FAULT_FIT[slot],
                "{index}: {value} of {truth}"
            );
        }
        let ratio = found.rmse_n / NOISE_N;
        assert!(FAULT_FIT_RESIDUAL.contains(&ratio), "{index}: {ratio}");
    }
}

#[test]
fn a_swap_in_the_air_counts_from_the_next_touch() {
    let case = case("swap_in_air", 2, 0);
    let from_s = case.plan.onset_s;
    assert!(case.counts_from_s > from_s && case.counts_from_s < from_s + 1.0);
    assert!(case.counts(from_s - 0.01) && !case.counts(from_s + 0.01));
    let (before, after) = (case.truth(from_s - 1e-3)[0], case.truth(from_s)[0]);
    assert!(
        [3.0, 1.0 / 3.0]
            .iter()
            .any(|factor| (after / before / factor - 1.0).abs() < 1e-9)
    );
}

#[test]
fn a_late_force_is_late_by_what_is_said() {
    let (late, honest) = (case("skew", 2, 1), case("none", 1, 1));
    let by = (late.plan.force.late_s * 1e3).round() as i64;
    assert_eq!(by.abs(), 3);
    let error = |shift: i64| -> f64 {
        let pairs = (3000..6000_i64).map(|k| {
            let other = honest.rows.force_n[(k - shift) as usize];
            (late.rows.force_n[k as usize] - other).powi(2)
        });
        pairs.sum()
    };
    let best = (-5..=5).min_by(|a, b| error(*a).total_cmp(&error(*b)));
    assert_eq!(best, Some(by));
}

#[test]
fn a_converter_that_hangs_repeats_its_reading_for_so_long() {
    let case = case("stuck_adc", 2, 1);
    let from = (case.plan.onset_s * 1e3).round() as usize;
    let held = &case.rows.force_n[from..from + 499];
    assert!(held.iter().all(|force| force == &held[0]));
    assert_ne!(case.rows.force_n[from + 501], held[0]);
}
