//! `palpate simulate`: a model and a motion through the simulated rig, into a log.

use std::error::Error;
use std::path::PathBuf;

use clap::Args;
use serde_json::json;

use crate::cli::progress::Spinner;
use crate::diagnostic::Diagnostic;
use crate::kind;
use crate::model::Model;
use crate::motion::Motion;
use crate::number::quantity;
use crate::output::{result, say, try_folder};
use crate::plant::{Contact, Effects, Rig, Run, Stage, depth_at_m};
use crate::stats::highest;

/// Force at the deepest point of the built-in motion (N): the chapter's touches reach 10 to 14 N.
const PALPATION_FORCE_N: f64 = 10.0;

/// Depth of the built-in motion where nothing pushes back (m): the chapter's on gel.
const FREE_DEPTH_M: f64 = 4.2e-3;

/// Arguments of `palpate simulate`.
#[derive(Args, Clone, Debug)]
#[command(
    about = "Run a model on the simulated rig and write what its sensors read",
    long_about = "Run a model on the simulated rig (position-controlled linear motor, load cell, encoder) \
                  and write what its sensors read as a log: t_s [s], x_m [m] growing into the material, \
                  f_n [N] pushing the probe out.",
    after_help = "Example:\n  palpate simulate --model gel.toml --motion palpation --seed 7 --out run1\n\n\
                  A model, in SI units:\n  [environment]\n  law = \"hunt_crossley\"\n  \
                  stiffness = 1350.0   # N/m at 1 mm\n  damping = 36.0       # N s/m at 1 mm\n  \
                  exponent = 1.35\n  surface = 0.0        # m\n  \
                  # recovery = \"creep\": a surface that relaxes keeps a dent; else it follows the probe\n\n  \
                  [[effect]]           # zero or more; `palpate effects` lists them\n  \
                  id = \"coulomb_friction\"\n  force = 0.41         # N"
)]
pub struct SimulateArgs {
    /// Model file (TOML): environment, effects, sensors.
    #[arg(long, value_name = "FILE")]
    pub model: PathBuf,
    /// Motion file (TOML, in m, m/s, Hz, s), or `palpation`: rest, touches at 1 and 2 Hz, ramp and
    /// hold, scaled to about 10 N.
    #[arg(long, value_name = "FILE", default_value = "palpation")]
    pub motion: PathBuf,
    /// Seed of the sensors' noise; one seed is one recording.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Folder for `log.csv`; made if missing.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
}

/// Simulates, writes `log.csv` and says what it did.
///
/// # Errors
/// A [`Diagnostic`] for a model or motion that cannot be read or simulated; an I/O error if the log
/// cannot be written.
pub fn run(args: &SimulateArgs) -> Result<(), Box<dyn Error + Send + Sync>> {
    try_folder(&args.out)?;
    let spinner = Spinner::new(1);
    let said = record(args)?;
    drop(spinner);
    say(said)?;
    let log = args.out.join("log.csv").display().to_string();
    result(&json!({ "log": log, "seed": args.seed }))?;
    Ok(())
}

/// Simulates, writes `log.csv`, and gives what to say about it.
fn record(args: &SimulateArgs) -> Result<String, Box<dyn Error + Send + Sync>> {
    let model = Model::read(&args.model)?;
    let (contact, effects) = model.simulated()?;
    let motion = read_motion(args, &contact, &effects)?;
    let rig = Rig {
        sensors: model.sensors,
        effects,
        ..Rig::default()
    };
    let mut run = rig.run(&Stage::throughout(contact), &motion, args.seed)?;
    run.log.kind = model.kind;
    let path = args.out.join("log.csv");
    run.log.write_csv(&path)?;
    let kind = model.kind.unwrap_or_default();
    let summary = kind::worded(kind, || summary(&run, &model, args));
    Ok(format!("{summary}\n  log         {}\n", path.display()))
}

fn read_motion(
    args: &SimulateArgs,
    contact: &Contact,
    effects: &Effects,
) -> Result<Motion, Diagnostic> {
    if args.motion.as_os_str() != "palpation" {
        return Motion::read(&args.motion);
    }
    let depth_m = depth_at_m(contact, effects, PALPATION_FORCE_N).unwrap_or(FREE_DEPTH_M);
    Ok(Motion::palpation(depth_m).shifted(contact.surface_m))
}

fn summary(run: &Run, model: &Model, args: &SimulateArgs) -> String {
    let deepest_m = highest(run.truth.position_m.iter().copied()) - model.environment.surface_m;
    let mut text = format!(
        "simulated {} over {}\n  rate        {} Hz\n  duration    {:.3} s, {} samples\n  \
         peak force  {}\n  peak depth  {}\n  seed        {}",
        model.environment.law.name(),
        args.motion.display(),
        model.sensors.rate_hz,
        run.log.duration_s(),
        run.log.len(),
        quantity(highest(run.truth.force_n.iter().copied()), 4, "N"),
        quantity(deepest_m, 4, "m"),
        args.seed,
    );
    for effect in &model.effects {
        let numbers = effect.parameters.iter();
        let numbers: Vec<String> = numbers
            .map(|(key, value)| format!("{key} {value}"))
            .collect();
        text.push_str(&format!(
            "\n  effect      {}: {}",
            effect.id,
            numbers.join(", ")
        ));
    }
    for note in &run.log.notes {
        text.push_str(&format!("\n  note        {note}"));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::{Log, ReadOptions};
    use std::fs;
    use tempfile::TempDir;

    /// A folder with a model in it.
    struct Folder(TempDir);

    impl Folder {
        fn with_model(model: &str) -> Folder {
            let folder = tempfile::tempdir().unwrap();
            fs::write(folder.path().join("model.toml"), model).unwrap();
            Folder(folder)
        }

        fn args(&self, seed: u64) -> SimulateArgs {
            SimulateArgs {
                model: self.0.path().join("model.toml"),
                motion: "palpation".into(),
                seed,
                out: self.0.path().join(format!("out{seed}")),
            }
        }
    }

    const GEL: &str = "[environment]\nlaw = \"hunt_crossley\"\nstiffness = 1350.0\n\
                       damping = 36.0\nexponent = 1.35\nsurface = 0.003\n";

    #[test]
    fn a_model_becomes_a_log_that_reads_and_one_seed_one_file() {
        let folder = Folder::with_model(GEL);
        let (first, second) = (folder.args(1), folder.args(2));
        record(&first).unwrap();
        record(&second).unwrap();
        let log = Log::read(&first.out.join("log.csv"), &ReadOptions::default()).unwrap();
        assert_eq!(log.rate_hz(), 1000.0);
        assert!(log.notes.is_empty(), "{:?}", log.notes);
        let peak = log.force_n.iter().copied().fold(0.0, f64::max);
        // 10 N at rest, more with the damper's share.
        assert!((10.0..13.0).contains(&peak), "{peak} N");
        // The surface at 3 mm is where the force begins.
        let touching = log
            .position_m
            .iter()
            .zip(&log.force_n)
            .filter(|(_, force)| **force > 0.5);
        assert!(touching.clone().count() > 2000);
        assert!(touching.into_iter().all(|(position, _)| *position > 3e-3));
        let bytes = |args: &SimulateArgs| fs::read(args.out.join("log.csv")).unwrap();
        let before = bytes(&first);
        record(&first).unwrap();
        assert_eq!(bytes(&first), before);
        assert_ne!(bytes(&second), before);
    }

    #[test]
    fn what_the_rig_cannot_simulate_is_refused_not_left_out() {
        let effect = format!("{GEL}\n[[effect]]\nid = \"coulomb_frictoin\"\nforce = 0.4\n");
        let modes = "{ fraction = 0.1, rate = 1 },".repeat(5);
        let five = format!(
            "[environment]\nlaw = \"quasi_linear\"\nstiffness = 3000\nexponent = 1.2\n\
             relaxation = [{modes}]\n"
        );
        for (model, what, line) in [
            (
                effect.as_str(),
                "unknown effect `coulomb_frictoin`",
                Some(8),
            ),
            (five.as_str(), "more than 4 relaxation modes", None),
        ] {
            let folder = Folder::with_model(model);
            let args = folder.args(1);
            let error = record(&args).unwrap_err();
            let diagnostic = error.downcast_ref::<Diagnostic>().unwrap();
            assert!(diagnostic.what.contains(what), "{diagnostic}");
            assert_eq!(diagnostic.line, line);
            assert!(!args.out.exists(), "nothing is written");
        }
    }

    #[test]
    fn a_folder_that_cannot_be_made_is_a_failure_not_bad_input() {
        let folder = Folder::with_model(GEL);
        let mut args = folder.args(1);
        args.out = folder.0.path().join("model.toml");
        let error = record(&args).unwrap_err();
        assert!(error.downcast_ref::<Diagnostic>().is_none());
        assert!(error.to_string().contains("cannot write"), "{error}");
    }
}
