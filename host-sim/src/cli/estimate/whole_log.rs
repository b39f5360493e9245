//! `--method batch` on the command line.

use std::io;
use std::path::Path;

use estimator_core::physics::law::LawId;

use serde_json::Value;

use super::{args::EstimateArgs, batch::numbers, batch::summary, batch::write};
use crate::batch::{Batch, Family, Options, all_families};
use crate::diagnostic::Diagnostic;
use crate::log::UniformLog;
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

/// Writes the files of a fit, and gives what is said of it and its JSON.
pub(super) fn told(
    args: &EstimateArgs,
    file: &Path,
    path: &Path,
    folder: Option<&str>,
    log: &UniformLog,
    fitted: &Batch,
) -> io::Result<(String, Value)> {
    let numbers = numbers(log, fitted);
    if let Some(folder) = args.folder(folder) {
        write(&folder, file, log, fitted, &numbers, args.every as usize)?;
        if args.mcap {
            super::mcap::write(&folder.join("estimate.mcap"), log, None)?;
        }
    }
    Ok((summary(path, log, fitted), numbers))
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
