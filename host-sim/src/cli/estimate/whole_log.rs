//! `--method batch` on the command line.

use std::error::Error;
use std::path::Path;

use estimator_core::physics::law::LawId;

use super::{args::EstimateArgs, args::names, batch::summary, batch::write};
use crate::batch::{Batch, Family, Options, all_families, batch};
use crate::diagnostic::Diagnostic;
use crate::log::UniformLog;
use crate::output::say;
use crate::settings::Settings;

fn families(law: Option<LawId>, modes: Option<u8>) -> Vec<Family> {
    let wanted = |family: &Family| {
        let listed = family.law.info().most_modes > 0;
        law.is_none_or(|law| law == family.law)
            && (!listed || modes.is_none_or(|modes| usize::from(modes) == family.modes))
    };
    all_families().into_iter().filter(wanted).collect()
}

/// What a whole log is fitted with.
pub(super) fn options(args: &EstimateArgs, settings: &Settings) -> Result<Options, Diagnostic> {
    let options = Options {
        elastic: settings.elastic,
        held: settings.held.clone(),
        families: families(args.law, args.batch.modes),
        reference_depth_m: args.reference_depth,
        surface_m: args.surface,
        indenter: args.batch.indenter,
        poisson: args.batch.poisson.unwrap_or(Options::default().poisson),
        ..Options::default()
    };
    options.check()?;
    Ok(options)
}

/// Fits every log.
pub(super) fn run(args: &EstimateArgs) -> Result<(), Box<dyn Error>> {
    let settings = args.settings()?;
    let options = options(args, &settings)?;
    for (path, name) in args.logs.iter().zip(names(&args.logs)) {
        let log = args.read(path)?;
        let fitted = batch(&log, settings.config, &options)?;
        tell(args, path, &name, &log, &fitted)?;
    }
    Ok(())
}

/// Prints a fit and writes its files.
pub(super) fn tell(
    args: &EstimateArgs,
    path: &Path,
    name: &str,
    log: &UniformLog,
    fitted: &Batch,
) -> Result<(), Box<dyn Error>> {
    say(summary(path, log, fitted))?;
    if let Some(folder) = args.folder(name) {
        write(&folder, path, log, fitted, args.every as usize)?;
        let report = folder.join("report.html");
        say(format!("report: {}\n", report.display()))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::args::BatchArgs;
    use super::*;
    use estimator_core::physics::law::MOST_MODES;

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
