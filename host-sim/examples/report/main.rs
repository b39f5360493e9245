//! Writes the reports of made-up palpations, to look at what a report looks like:
//! `cargo run --release -p host-sim --example report -- FOLDER`.
//!
//! The forces come from Hunt–Crossley contacts with noise, the estimates from a recursive least
//! squares on the linearised law with forgetting (24): enough to give every figure its typical
//! shape, not the estimator of Palpate.

mod palpation;

use std::error::Error;
use std::path::Path;

use estimator_core::physics::law::{ContactLaw, HuntCrossley};
use palpate::number::Measured;
use palpate::report::estimate::{
    Elastic, EstimateReport, FinalParameter, ForgettingLaw, Run, Segment, Trajectory,
};
use palpate::report::{Input, Provenance, Tone};

use palpation::{FORGETTING, Log, Motion, NAMES, RATE_HZ, law};

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).ok_or("which folder?")?;
    let folder = Path::new(&folder);
    std::fs::create_dir_all(folder)?;
    let gel = law(1350.0, 36.0, 1.35, 1e-3);
    let plastic = law(11_500.0, 70.0, 1.2, 1e-3);
    let soft = Motion {
        depth_m: 4.3e-3,
        period_s: 1.0,
        touches: 6,
        seconds: 8.0,
    };
    let stiff = Motion {
        depth_m: 0.95e-3,
        ..soft
    };
    let gel_log = Log::make(&[gel], soft, 0.02);
    let plastic_log = Log::make(&[plastic], stiff, 0.02);
    write(folder, "gel", &[("", &gel_log, 0.02)])?;
    write(
        folder,
        "pair",
        &[("gel", &gel_log, 0.02), ("plastic", &plastic_log, 0.02)],
    )?;
    let change = Motion {
        depth_m: 1.0e-3,
        period_s: 1.2,
        touches: 8,
        seconds: 11.0,
    };
    write(
        folder,
        "change",
        &[("", &Log::make(&[gel, plastic], change, 0.02), 0.02)],
    )?;
    let hour = Motion {
        touches: 3000,
        seconds: 3600.0,
        ..soft
    };
    write(
        folder,
        "hour",
        &[("", &Log::make(&[gel], hour, 0.02), 0.02)],
    )?;
    let cell = law(0.02, 4e-4, 1.5, 1e-6);
    let probe = Motion {
        depth_m: 1.8e-6,
        period_s: 2.0,
        touches: 3,
        seconds: 8.0,
    };
    write(
        folder,
        "afm",
        &[("", &Log::make(&[cell], probe, 4e-10), 4e-10)],
    )?;
    Ok(())
}

fn write(folder: &Path, name: &str, logs: &[(&str, &Log, f64)]) -> Result<(), Box<dyn Error>> {
    let curves: Vec<[Vec<f64>; 3]> = logs.iter().map(|(_, log, _)| elastic(log)).collect();
    let finals: Vec<_> = logs
        .iter()
        .map(|(_, log, _)| log.finals(log.time_s.len() - 1))
        .collect();
    let before: Vec<_> = logs
        .iter()
        .map(|(_, log, _)| {
            log.change_s
                .map(|t| log.finals((t * RATE_HZ) as usize - 200))
        })
        .collect();
    let runs: Vec<Run> = (0..logs.len())
        .map(|i| {
            let (name, log, noise_n) = logs[i];
            let [depth_m, estimated_n, true_n] = &curves[i];
            let scale = 0.02 / noise_n;
            Run {
                name,
                law: "hunt_crossley",
                time_s: (&log.time_s).into(),
                depth_m: (&log.depth_m).into(),
                speed_mps: (&log.speed_mps).into(),
                measured_n: (&log.measured_n).into(),
                estimated_n: (&log.estimated_n).into(),
                innovation_n: (&log.innovation_n).into(),
                mean_residual: None,
                forgetting: (&log.forgetting).into(),
                status: (&log.status).into(),
                noise_n: Some(noise_n),
                forgetting_law: Some(ForgettingLaw {
                    alpha_2_per_n: FORGETTING.alpha_2_per_n * scale,
                    alpha_3_n: FORGETTING.alpha_3_n / scale,
                    ..FORGETTING
                }),
                parameters: trajectories(log),
                finals: finals[i].clone(),
                segments: segments(log, before[i].as_deref(), &finals[i]),
                touches: (&log.touches).into(),
                events: (&log.events).into(),
                elastic: Some(Elastic {
                    depth_m: depth_m.into(),
                    estimated_n: estimated_n.into(),
                    true_n: true_n.into(),
                }),
                force_rmse_n: Some(1.07 * noise_n),
                settled_at_s: Some(0.81),
                reference_depth_m: log.true_law.map(|law| law.reference_depth_m),
            }
        })
        .collect();
    let report = EstimateReport {
        title: &format!("Estimate of {name}.csv"),
        tone: Tone::Good,
        badge: "converged",
        verdict: &format!(
            "A Hunt–Crossley contact: {}; it explains the force down to the noise of the load cell.",
            sentence(&finals[finals.len() - 1])
        ),
        runs: &runs,
        notes: &["The log is sampled at 1000 Hz without gaps.".into(), "Damping is identified mostly from the loading strokes: the speed while unloading is lower.".into()],
        provenance: Provenance::new(format!("palpate estimate {name}.csv --law auto --out report"))
            .input(Input::new(format!("{name}.csv"), "sha256:ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"))
            .setting("Filter", "Savitzky–Golay, half width 10 samples")
            .setting("Method", "two-stage Hunt–Crossley, (25)–(37)"),
    };
    let path = folder.join(format!("{name}.html"));
    report.document().write(&path)?;
    println!(
        "{} {} kB",
        path.display(),
        std::fs::metadata(&path)?.len() / 1024
    );
    Ok(())
}

fn sentence(finals: &[FinalParameter]) -> String {
    let part = |p: &FinalParameter| {
        let e = p.estimate?;
        Some(format!(
            "{} {}",
            p.name,
            Measured::new(e.value, Some(e.std_error), p.unit)
        ))
    };
    finals
        .iter()
        .filter_map(part)
        .collect::<Vec<_>>()
        .join(", ")
}

fn trajectories(log: &Log) -> Vec<Trajectory<'_>> {
    let each = NAMES.iter().zip(&log.parameters);
    each.map(|((name, unit), values)| Trajectory {
        name,
        unit,
        values: values.into(),
    })
    .collect()
}

fn segments<'a>(
    log: &Log,
    before: Option<&'a [FinalParameter<'a>]>,
    finals: &'a [FinalParameter<'a>],
) -> Vec<Segment<'a>> {
    let end = log.time_s[log.time_s.len() - 1];
    match (log.change_s, before) {
        (Some(t), Some(before)) => vec![
            Segment {
                from_s: log.touches[0].from_s,
                to_s: t,
                parameters: before.to_vec(),
            },
            Segment {
                from_s: t,
                to_s: end,
                parameters: finals.to_vec(),
            },
        ],
        _ => vec![Segment {
            from_s: log.touches[0].from_s,
            to_s: end,
            parameters: finals.to_vec(),
        }],
    }
}

/// Depth, estimated and true elastic force.
fn elastic(log: &Log) -> [Vec<f64>; 3] {
    let end = log
        .touches
        .iter()
        .map(|t| t.peak_depth_m)
        .fold(0.0, f64::max);
    let depths: Vec<f64> = (0..=100).map(|i| end * f64::from(i) / 100.0).collect();
    let value = |p: usize| {
        log.parameters[p]
            .last()
            .copied()
            .flatten()
            .map_or(0.0, |e| e.value)
    };
    let truth = log.true_law.unwrap_or(law(0.0, 0.0, 1.0, 1e-3));
    let estimate = law(value(0), value(1), value(2), truth.reference_depth_m);
    let force = |law: HuntCrossley<f64>| depths.iter().map(|d| law.force_n(*d, 0.0)).collect();
    [depths.clone(), force(estimate), force(truth)]
}
