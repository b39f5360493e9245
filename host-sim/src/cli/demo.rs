//! The demo: the chapter's gel and plastic on the simulated rig, told apart by the board's code; then
//! a friction that the model does not know of, found, named and taken off.

use std::error::Error;
use std::path::{Path, PathBuf};

use clap::Args;
use estimator_core::Config;
use estimator_core::estimate::method::Method;

use crate::cli::{estimate::Shown, estimate::document, gap::print::summary};
use crate::diagnostic::Diagnostic;
use crate::estimate::{Choices, Estimation, estimate};
use crate::gap::{Options, gap};
use crate::log::UniformLog;
use crate::model::Model;
use crate::motion::Motion;
use crate::number::Measured;
use crate::output::{say, write_atomically};
use crate::plant::{GEL, Material, PLASTIC, Rig, Stage};
use estimator_core::physics::{effect::CoulombFriction, effect::Effect, law::ContactLaw};

/// What is hidden in the demo's third log (N).
const HIDDEN_FRICTION_N: f64 = 0.35;

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
    let mut shown = Vec::new();
    for (material, surface_m) in [(GEL, 180e-6), (PLASTIC, -120e-6)] {
        let method = Method::HUNT_CROSSLEY_BANK;
        let palpated = palpate(material, surface_m, args.seed, method, false)?;
        say(found(&palpated))?;
        let path = args.out.join(format!("{}.csv", material.name));
        write_log(&path, &palpated.log)?;
        let law = material.law;
        let columns = Shown::new(material.name, &palpated.log, &palpated.estimation);
        shown.push(columns.with_true_elastic(|depth_m| law.force_n(depth_m, 0.0)));
    }
    let report = args.out.join("report.html");
    document(shown, "Palpating gel and plastic", &[])?.write(&report)?;
    hidden(args)?;
    say(format!(
        "report: {}\nnext:   palpate estimate {}\n        palpate gap --model {} --log {} --out result\n",
        report.display(),
        args.out.join("gel.csv").display(),
        args.out.join("base.toml").display(),
        args.out.join("hidden.csv").display(),
    ))?;
    Ok(())
}

/// The gel once more, on a rig whose guide rubs; the model knows the gel to a tenth, and no friction.
fn hidden(args: &DemoArgs) -> Result<(), Box<dyn Error>> {
    let friction = CoulombFriction {
        force_n: HIDDEN_FRICTION_N,
        width_m: 0.0,
        // No dry contact reverses at once.
        transition_mps: 2e-4,
    };
    let mut rig = Rig::default();
    rig.effects[0] = Some(Effect::CoulombFriction(friction));
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
    let finding = gap(&model, &[log], &Options::default())?;
    say("Then the guide rubs, and the model does not know it (gel to a tenth, no friction):\n")?;
    say(format!("{}\n", summary(&finding)))?;
    say(format!(
        "  true        coulomb_friction force {HIDDEN_FRICTION_N} N\n\n"
    ))?;
    Ok(())
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
