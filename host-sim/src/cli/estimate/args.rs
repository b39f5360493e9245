//! Arguments of `palpate estimate`.

use std::path::{Path, PathBuf};

use clap::Args;
use estimator_core::physics::law::MOST_MODES;

use super::{law::AUTO, law::LawChoice, law::law_choice, methods::MethodChoice};
use crate::batch::Indenter;
use crate::cli::ReadingArgs;
use crate::diagnostic::Diagnostic;
use crate::log::UniformLog;
use crate::settings::Settings;

/// Arguments of `palpate estimate`.
#[derive(Args, Clone, Debug)]
#[command(
    after_help = "Example:\n  palpate estimate log.csv --law hunt_crossley --out result\n  \
    palpate estimate instron.csv --columns \"t=Time[ms]*1e-3,x=pos_mm*1e-3,f=-Fz\"\n  \
    palpate estimate indentation.csv --method batch --indenter sphere:0.003 --out result\n  \
    palpate estimate log.csv --compensate model.toml --out result"
)]
pub struct EstimateArgs {
    /// Logs: CSV with t_s (s), x_m (m, growing into the material), f_n (N, pushing out), or .csv.gz.
    #[arg(required = true, value_name = "LOG")]
    pub logs: Vec<PathBuf>,
    /// The contact law; auto takes the one that explains the force best.
    #[arg(long, value_parser = law_choice(), default_value = AUTO)]
    pub law: LawChoice,
    /// The estimator; by default the law's own, and with --law auto the fit of the whole log where no
    /// estimator explains the force.
    #[arg(long, value_enum)]
    pub method: Option<MethodChoice>,
    /// Where estimate.json, estimate.csv and report.html go; a folder per log if there are several.
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
    /// What is given for a fit of the whole log.
    #[command(flatten)]
    pub batch: BatchArgs,
    /// How the log is read.
    #[command(flatten)]
    pub reading: ReadingArgs,
}

impl EstimateArgs {
    /// Reads a log and takes off it what the rig adds.
    pub(super) fn read(&self, path: &Path) -> Result<UniformLog, Diagnostic> {
        let log = self.reading.read(path)?;
        match &self.compensate {
            None => Ok(log),
            Some(model) => crate::compensate::read(log, model),
        }
    }

    /// The configuration that was given, or the defaults.
    pub(super) fn settings(&self) -> Result<Settings, Diagnostic> {
        match &self.config {
            Some(path) => crate::settings::read(path),
            None => Ok(Settings::default()),
        }
    }

    /// Where the files of a log go.
    pub(super) fn folder(&self, name: &str) -> Option<PathBuf> {
        let out = self.out.as_ref()?;
        Some(match self.logs.len() > 1 {
            true => out.join(name),
            false => out.clone(),
        })
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
    #[arg(long, value_name = "1", value_parser = poisson)]
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

/// A folder for each log: its name without endings, and with a number where an earlier log has the
/// same (`simulate` calls every one log.csv).
pub(super) fn names(logs: &[PathBuf]) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for path in logs {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let name = name.trim_end_matches(".gz").trim_end_matches(".csv");
        let numbered = (2..).map(|number| format!("{name}-{number}"));
        let free = std::iter::once(name.to_string())
            .chain(numbered)
            .find(|name| !names.contains(name));
        names.extend(free);
    }
    names
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_folder_of_a_log_is_its_name_without_endings() {
        assert_eq!(names(&["a/b/log.1.csv.gz".into()]), ["log.1"]);
    }

    #[test]
    fn logs_of_one_name_do_not_overwrite_each_other() {
        let logs = ["a/log.csv", "b/log.csv", "log-2.csv", "c/log.csv.gz"].map(PathBuf::from);
        assert_eq!(names(&logs), ["log", "log-2", "log-2-2", "log-3"]);
    }
}
