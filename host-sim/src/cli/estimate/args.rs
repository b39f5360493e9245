//! Arguments of `palpate estimate`.

use std::path::{Path, PathBuf};

use clap::Args;
use estimator_core::physics::law::MOST_MODES;

use super::{law::AUTO, law::LawChoice, law::law_choice, methods::MethodChoice};
use crate::batch::Indenter;
use crate::cli::ReadingArgs;
use crate::diagnostic::Diagnostic;
use crate::kind::Kind;
use crate::log::UniformLog;
use crate::settings::Settings;

/// Arguments of `palpate estimate`.
#[derive(Args, Clone, Debug)]
#[command(
    after_help = "Example:\n  palpate estimate log.csv --law hunt_crossley --out result\n  \
    palpate estimate runs --out result\n  \
    palpate estimate instron.csv --columns \"t=Time[ms]*1e-3,x=pos_mm*1e-3,f=-Fz\"\n  \
    palpate estimate indentation.csv --method batch --indenter sphere:0.003 --out result\n  \
    palpate estimate log.csv --compensate model.toml --out result\n\n\
    A parameter is held by two lines under [estimator] of the file that --config names:\n  \
    fixed = [\"exponent\"]\n  initial = { exponent = 1.5 }"
)]
pub struct EstimateArgs {
    /// Logs: CSV with t_s (s), x_m (m, growing into the material), f_n (N, pushing out), or what a machine
    /// exports; .gz, folders, patterns such as 'runs/*.csv', or - for standard input.
    #[arg(required = true, value_name = "LOG")]
    pub logs: Vec<PathBuf>,
    /// The contact law; auto takes the one that explains the force best.
    #[arg(long, value_parser = law_choice(), default_value = AUTO)]
    pub law: LawChoice,
    /// The estimator; by default the law's own, and with --law auto the fit of the whole log where no
    /// estimator explains the force.
    #[arg(long, value_enum)]
    pub method: Option<MethodChoice>,
    /// Where estimate.json, estimate.csv and report.html go; a folder per log, summary.csv and
    /// summary.json if there are several.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Estimator configuration (TOML): filter, contact, forgetting, initial values.
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
    /// Depth (m) at which stiffness and damping are reported; 1 mm unless the log is of another scale.
    #[arg(long, value_name = "M", value_parser = positive)]
    pub reference_depth: Option<f64>,
    /// Position of the surface (m), if it is known; otherwise it is found, or taken from the impact.
    #[arg(long, value_name = "M", allow_negative_numbers = true, value_parser = finite)]
    pub surface: Option<f64>,
    /// Take the effects of the rig in this model (TOML), such as `palpate gap` writes, off the log
    /// before anything else: friction, drag, inertia, lag, delay, compliance, ….
    #[arg(long, value_name = "FILE")]
    pub compensate: Option<PathBuf>,
    /// Write every N-th sample into estimate.csv.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    pub every: u32,
    /// Also write estimate.mcap: samples and estimates over time, for Foxglove and PlotJuggler.
    #[arg(long, requires = "out")]
    pub mcap: bool,
    /// What is given for a fit of the whole log.
    #[command(flatten)]
    pub batch: BatchArgs,
    /// How the log is read.
    #[command(flatten)]
    pub reading: ReadingArgs,
}

impl EstimateArgs {
    /// Reads every recording of a file and takes off it what the rig adds.
    pub(super) fn read(&self, path: &Path) -> Result<Vec<UniformLog>, Diagnostic> {
        let logs = self.reading.read(path)?;
        let Some(model) = &self.compensate else {
            return Ok(logs);
        };
        logs.into_iter()
            .map(|log| crate::compensate::read(log, model))
            .collect()
    }

    /// The configuration that was given, or the defaults.
    pub(super) fn settings(&self) -> Result<Settings, Diagnostic> {
        match &self.config {
            Some(path) => crate::settings::read(path),
            None => Ok(Settings::default()),
        }
    }

    /// Where the files of a log go: into a folder of that name, or into `--out` itself.
    pub(super) fn folder(&self, name: Option<&str>) -> Option<PathBuf> {
        let out = self.out.as_ref()?;
        Some(name.map_or(out.clone(), |name| out.join(name)))
    }

    /// Whether law and method are left open: then the fit of the whole log may stand in for them.
    pub(super) fn is_auto(&self) -> bool {
        self.law.is_none() && self.method.is_none()
    }

    /// Whether the arguments ask for a fit of the whole log.
    pub(super) fn wants_whole_log(&self) -> bool {
        self.method == Some(MethodChoice::BATCH)
    }
}

/// Arguments that only the fit of a whole log has.
#[derive(Args, Clone, Debug, Default)]
pub struct BatchArgs {
    /// What touches, for Young's modulus: sphere:RADIUS_M, cone:HALF_ANGLE_DEG or flat:RADIUS_M (batch).
    #[arg(long, value_name = "SHAPE")]
    pub indenter: Option<Indenter>,
    /// Poisson's ratio of the material, for Young's modulus; 0.5 unless given (batch).
    #[arg(long, value_name = "1", value_parser = poisson, requires = "indenter")]
    pub poisson: Option<f64>,
    /// Relaxation modes of quasi_linear, 1 to 4; otherwise as many as the log asks for (batch).
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(1..=MOST_MODES as i64))]
    pub modes: Option<u8>,
}

fn poisson(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        // Thermodynamics allows −1 to ½.
        Ok(value) if value > -1.0 && value <= 0.5 => Ok(value),
        _ => Err("must be a number over -1 and up to 0.5".into()),
    }
}

impl BatchArgs {
    /// Refuses what only something that presses along a line has.
    pub(super) fn refuse_on(&self, kind: Kind) -> Result<(), Diagnostic> {
        if kind == Kind::Linear || self.indenter.is_none() {
            return Ok(());
        }
        Err(Diagnostic::new(
            "Young's modulus is that of an indenter pressed along a line, and this log is of a machine that turns",
        )
        .value("--indenter")
        .remedy("leave --indenter out: stiffness and damping are in N m/rad and N m s/rad"))
    }

    /// Refuses what the recursive methods do not take.
    pub(super) fn refuse(&self) -> Result<(), Diagnostic> {
        let given = [
            ("--indenter", self.indenter.is_some()),
            ("--poisson", self.poisson.is_some()),
            ("--modes", self.modes.is_some()),
        ];
        match given.iter().find(|(_, given)| *given) {
            None => Ok(()),
            Some((name, _)) => Err(Diagnostic::new("this needs a fit of the whole log")
                .value(name)
                .remedy("add --method batch")),
        }
    }
}

fn positive(text: &str) -> Result<f64, String> {
    let value = finite(text)?;
    if value > 0.0 {
        Ok(value)
    } else {
        Err("must be positive, in metres".into())
    }
}

fn finite(text: &str) -> Result<f64, String> {
    let value: f64 = text
        .parse()
        .map_err(|_| "must be a number in metres, such as 0.001")?;
    if value.is_finite() {
        Ok(value)
    } else {
        Err("must be finite".into())
    }
}
