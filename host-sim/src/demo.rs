//! The demo: the chapter's gel and plastic on the simulated rig, told apart by the board's code.

use std::error::Error;
use std::path::{Path, PathBuf};

use clap::Args;
use estimator_core::Config;
use estimator_core::config::Method;

use crate::diagnostic::Diagnostic;
use crate::estimate::{Choices, Estimation, Shown, document, estimate};
use crate::log::UniformLog;
use crate::motion::Motion;
use crate::output::say;
use crate::plant::{GEL, Material, PLASTIC, Rig, Stage};
use crate::report::number::Measured;
use estimator_core::law::ContactLaw;

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

/// A material palpated on the simulated rig and estimated with its surface known.
#[derive(Clone, Debug)]
pub struct Palpated {
    /// What was touched.
    pub material: Material,
    /// What the sensors read.
    pub log: UniformLog,
    /// What the estimator made of it.
    pub estimation: Estimation,
}

/// Palpates one material twice over (16 s) and estimates it by Hunt–Crossley's two stages.
///
/// # Errors
/// A material that the rig cannot follow.
pub fn palpate(material: Material, seed: u64) -> Result<Palpated, Diagnostic> {
    let once = Motion::palpation(material.peak_depth_m);
    let schedule = Stage::throughout(material.at(0.0));
    let run = Rig::default().run(&schedule, &once.then(&once), seed)?;
    let log = run.log.uniform()?;
    let choices = Choices {
        surface_m: Some(0.0),
        ..Choices::default()
    };
    let methods = [Method::HuntCrossleyTwoStage];
    let estimation = estimate(&log, Config::default(), &methods, choices)?;
    Ok(Palpated {
        material,
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
        "A simulated rig palpates two materials; the estimator is told where the surface is,\n\
         and nothing else. Load cell: 20 mN noise, 5 mN steps; encoder: 1 µm; 1 kHz.\n\n",
    )?;
    let mut shown = Vec::new();
    for material in [GEL, PLASTIC] {
        let palpated = palpate(material, args.seed)?;
        say(found(&palpated))?;
        let path = args.out.join(format!("{}.csv", material.name));
        write_log(&path, &palpated.log)?;
        let law = material.law;
        let columns = Shown::new(material.name, &palpated.log, &palpated.estimation);
        shown.push(columns.with_true_elastic(|depth_m| law.force_n(depth_m, 0.0)));
    }
    let report = args.out.join("report.html");
    document(&shown, "Palpating gel and plastic", &[])?.write(&report)?;
    let next = args.out.join("gel.csv");
    say(format!(
        "report: {}\nnext:   palpate estimate {}\n",
        report.display(),
        next.display()
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
    let truth = [law.stiffness_n_per_m, law.damping_ns_per_m, law.exponent];
    let outcome = &palpated.estimation.outcome;
    let mut text = format!("{} ({})\n", palpated.material.name, outcome.status.name());
    for ((info, estimate), truth) in outcome.named(&outcome.parameters).zip(truth) {
        let (found, off) = match estimate {
            Some(e) => {
                let error = Some(f64::from(e.std_error));
                let found = Measured::new(f64::from(e.value), error, info.unit.symbol());
                let off = 100.0 * (f64::from(e.value) / truth - 1.0);
                (found.to_string(), format!("{off:+.2} %"))
            }
            None => ("not observable".into(), String::new()),
        };
        text.push_str(&format!(
            "  {:<10} {found:<26} true {truth:<8} {off}\n",
            info.name
        ));
    }
    text.push('\n');
    text
}
