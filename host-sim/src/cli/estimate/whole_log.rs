//! `--method batch` on the command line.

use std::error::Error;

use clap::Args;
use estimator_core::Config;
use estimator_core::physics::law::{LawId, MOST_MODES};

use super::batch::{summary, write};
use super::{EstimateArgs, MethodChoice, names};
use crate::batch::{Family, Indenter, Options, all_families, batch};
use crate::diagnostic::Diagnostic;
use crate::output::say;

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

/// Whether the arguments ask for a fit of the whole log.
pub(super) fn wanted(args: &EstimateArgs) -> bool {
    args.method == Some(MethodChoice::BATCH)
}

fn families(law: Option<LawId>, modes: Option<u8>) -> Vec<Family> {
    let wanted = |family: &Family| {
        let listed = family.law.info().most_modes > 0;
        law.is_none_or(|law| law == family.law)
            && (!listed || modes.is_none_or(|modes| usize::from(modes) == family.modes))
    };
    all_families().into_iter().filter(wanted).collect()
}

/// Fits every log.
pub(super) fn run(args: &EstimateArgs) -> Result<(), Box<dyn Error>> {
    let base = match &args.config {
        Some(path) => crate::settings::read(path)?,
        None => Config::default(),
    };
    let options = Options {
        families: families(args.law, args.batch.modes),
        reference_depth_m: args.reference_depth,
        surface_m: args.surface,
        indenter: args.batch.indenter,
        poisson: args.batch.poisson.unwrap_or(Options::default().poisson),
    };
    for (path, name) in args.logs.iter().zip(names(&args.logs)) {
        let log = args.read(path)?;
        let fitted = batch(&log, base, &options)?;
        say(summary(path, &log, &fitted))?;
        if let Some(out) = &args.out {
            let folder = if args.logs.len() > 1 {
                out.join(name)
            } else {
                out.clone()
            };
            write(&folder, path, &log, &fitted, args.every as usize)?;
            let report = folder.join("report.html");
            say(format!("report: {}\n", report.display()))?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn auto_compares_every_law_and_a_number_of_modes_can_be_given() {
        assert_eq!(families(None, None), all_families());
        let two = families(Some(LawId::QuasiLinear), Some(2));
        assert_eq!(two, [Family::quasi_linear(2)]);
        assert_eq!(families(Some(LawId::QuasiLinear), None).len(), MOST_MODES);
    }

    #[test]
    fn what_only_batch_takes_is_refused_elsewhere_with_the_remedy() {
        let args = BatchArgs {
            poisson: Some(0.3),
            ..BatchArgs::default()
        };
        let error = args.refuse().unwrap_err().to_string();
        assert!(error.contains("--method batch"), "{error}");
        assert!(BatchArgs::default().refuse().is_ok());
    }
}
