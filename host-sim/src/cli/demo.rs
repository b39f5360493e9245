//! The demo: the chapter's gel and plastic on the simulated rig, told apart by the board's code; then
//! a friction that the model does not know of, found, named and taken off.

use std::error::Error;
use std::path::{Path, PathBuf};

use clap::Args;
use estimator_core::Config;
use estimator_core::estimate::method::Method;

use crate::cli::progress::Bar;
use crate::cli::{estimate::Shown, estimate::document, gap::print::summary};
use crate::diagnostic::Diagnostic;
use crate::estimate::{Choices, Estimation, estimate};
use crate::gap::{Finding, Options, Progress, gap};
use crate::log::UniformLog;
use crate::model::Model;
use crate::motion::Motion;
use crate::number::Measured;
use crate::output::{say, try_folder, write_atomically};
use crate::plant::{GEL, Material, PLASTIC, Rig, Stage};
use crate::report::{Document, Provenance, Tone, gap::GapReport};
use estimator_core::physics::{effect::CoulombFriction, effect::Effect, law::ContactLaw};

/// What is hidden in the demo's third log (N).
const HIDDEN_FRICTION_N: f64 = 0.35;
/// Below this speed (m/s) it turns around: no dry contact reverses at once.
const FRICTION_TRANSITION_MPS: f64 = 2e-4;

/// What the demo's simulation knows of the gel.
const BASE: &str = r#"[environment]
law = "hunt_crossley"
stiffness = 1500.0   # N/m at 1 mm
damping = 32.0       # N s/m at 1 mm
exponent = 1.3
surface = 0.0        # m
"#;

/// Arguments of the demo.
#[derive(Args, Clone, Debug)]
pub struct DemoArgs {
    /// Where the report and the logs go.
    #[arg(long, value_name = "DIR", default_value = "palpate-demo")]
    pub out: PathBuf,
    /// Seed of the sensors' noise.
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
}

impl Default for DemoArgs {
    fn default() -> Self {
        DemoArgs {
            out: "palpate-demo".into(),
            seed: 1,
        }
    }
}

/// A material palpated on the simulated rig and estimated.
#[derive(Clone, Debug)]
pub struct Palpated {
    /// What was touched.
    pub material: Material,
    /// Where its surface was (m).
    pub surface_m: f64,
    /// What the sensors read.
    pub log: UniformLog,
    /// What the estimator made of it.
    pub estimation: Estimation,
}

/// Palpates one material, its surface at `surface_m` (m), twice over (17 s) and estimates it with
/// `method`; if `known`, the estimator is told where the surface is.
///
/// # Errors
/// A material that the rig cannot follow.
pub fn palpate(
    material: Material,
    surface_m: f64,
    seed: u64,
    method: Method,
    known: bool,
) -> Result<Palpated, Diagnostic> {
    let once = Motion::palpation(material.peak_depth_m).shifted(surface_m);
    let schedule = Stage::throughout(material.at(surface_m));
    let run = Rig::default().run(&schedule, &once.then(&once), seed)?;
    let log = run.log.uniform()?;
    let choices = Choices {
        surface_m: known.then_some(surface_m),
        ..Choices::default()
    };
    let estimation = estimate(&log, Config::default(), &[method], choices)?;
    Ok(Palpated {
        material,
        surface_m,
        log,
        estimation,
    })
}

/// Runs the demo.
///
/// # Errors
/// What the file system says.
pub fn run(args: &DemoArgs) -> Result<(), Box<dyn Error>> {
    say(
        "A simulated rig palpates two materials; the estimator is told nothing about them, nor\n\
         where they begin. Load cell: 20 mN noise, 5 mN steps; encoder: 1 µm; 1 kHz.\n\n",
    )?;
    // Written at the end, tried before anything is computed.
    try_folder(&args.out)?;
    let bar = Bar::after_a_while();
    let mut shown = Vec::new();
    for (material, surface_m) in [(GEL, 180e-6), (PLASTIC, -120e-6)] {
        let method = Method::HUNT_CROSSLEY_BANK;
        bar.at(0.2 * shown.len() as f64, material.name);
        let palpated = palpate(material, surface_m, args.seed, method, false)?;
        bar.suspend(|| say(found(&palpated)))?;
        let path = args.out.join(format!("{}.csv", material.name));
        write_log(&path, &palpated.log)?;
        let law = material.law;
        let columns = Shown::new(material.name, &palpated.log, &palpated.estimation);
        let columns = columns.with_true_elastic(|depth_m| law.force_n(depth_m, 0.0));
        shown.push(columns.with_truth(&[
            ("stiffness", law.stiffness_n_per_m),
            ("damping", law.damping_ns_per_m),
            ("exponent", law.exponent),
            ("surface", surface_m),
        ]));
    }
    bar.at(0.4, "a friction that the model does not know");
    let finding = hidden(args)?;
    drop(bar);
    told(&finding)?;
    let report = args.out.join("report.html");
    page(shown, &finding)?.write(&report)?;
    say(format!(
        "report: {}\nnext:   palpate estimate {}\n        palpate gap --model {} --log {} --out result\n",
        report.display(),
        args.out.join("gel.csv").display(),
        args.out.join("base.toml").display(),
        args.out.join("hidden.csv").display(),
    ))?;
    Ok(())
}

/// The report: what was palpated, and what was found of the friction, both beside the truth.
fn page(shown: Vec<Shown>, finding: &Finding) -> std::io::Result<Document> {
    let estimated: Vec<String> = shown.iter().map(Shown::verdict).collect();
    let named = finding
        .effects
        .iter()
        .any(|effect| effect.id.name() == "coulomb_friction");
    let of_the_friction = match named {
        true => "The friction that was hidden in a third run is found by name.",
        false => "The friction that was hidden in a third run is not found.",
    };
    let page = GapReport {
        title: "",
        finding,
        names: &[],
        provenance: Provenance::new(""),
    };
    let law = GEL.law;
    let section = page.short(
        "A friction that the model does not know of",
        &[
            ("stiffness", law.stiffness_n_per_m),
            ("damping", law.damping_ns_per_m),
            ("exponent", law.exponent),
            ("surface", 0.0),
            ("force", HIDDEN_FRICTION_N),
            ("transition_speed", FRICTION_TRANSITION_MPS),
        ],
    );
    let tone = if named { Tone::Good } else { Tone::Bad };
    let verdict = format!("{} {of_the_friction}", estimated.join(" "));
    let document = document(shown, "Palpating gel and plastic", &[])?;
    Ok(document
        .verdict(tone, if named { "found" } else { "not found" }, verdict)
        .section_at(1, section))
}

/// The gel once more, on a rig whose guide rubs; the model knows the gel to a tenth, and no friction.
fn hidden(args: &DemoArgs) -> Result<Finding, Box<dyn Error>> {
    let friction = CoulombFriction {
        force_n: HIDDEN_FRICTION_N,
        width_m: 0.0,
        transition_mps: FRICTION_TRANSITION_MPS,
    };
    let mut rig = Rig::default();
    rig.effects.push(Effect::CoulombFriction(friction));
    let once = Motion::palpation(GEL.peak_depth_m);
    let run = rig.run(
        &Stage::throughout(GEL.at(0.0)),
        &once.then(&once),
        args.seed,
    )?;
    let log = run.log.uniform()?;
    write_log(&args.out.join("hidden.csv"), &log)?;
    let path = args.out.join("base.toml");
    write_atomically(&path, |writer| writer.write_all(BASE.as_bytes()))?;
    let model = Model::read(&path)?;
    Ok(gap(&model, &[log], &Options::default())?)
}

fn told(finding: &Finding) -> std::io::Result<()> {
    say("Then the guide has friction; the model has none, and its gel is off by a tenth:\n")?;
    say(format!("{}\n", summary(finding)))?;
    say(format!(
        "  true        coulomb_friction force {HIDDEN_FRICTION_N} N\n\n"
    ))
}

fn write_log(path: &Path, log: &UniformLog) -> std::io::Result<()> {
    let channels = (
        log.time_s.clone(),
        log.position_m.clone(),
        log.force_n.clone(),
    );
    crate::log::Log::from_channels(channels.0, channels.1, channels.2).write_csv(path)
}

/// The estimates beside the truth, a line each.
fn found(palpated: &Palpated) -> String {
    let law = &palpated.material.law;
    let (stiffness, damping) = (law.stiffness_n_per_m, law.damping_ns_per_m);
    let truth = [stiffness, damping, law.exponent, palpated.surface_m];
    let outcome = &palpated.estimation.outcome;
    let mut text = format!("{} ({})\n", palpated.material.name, outcome.status.name());
    for ((info, estimate), truth) in outcome.named(&outcome.parameters).zip(truth) {
        let unit = info.unit.symbol();
        let found = match estimate {
            Some(e) => Measured::new(e.value.into(), Some(e.std_error.into()), unit).to_string(),
            None => "not observable".into(),
        };
        let truth = Measured::new(truth, None, unit);
        text.push_str(&format!("  {:<10} {found:<26} true {truth}\n", info.name));
    }
    text.push('\n');
    text
}
