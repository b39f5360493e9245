//! `palpate effects`: the catalogue of what a rig can hide, and what each does to an estimate.

mod ignored;
mod json;
mod page;
mod text;

use std::error::Error;
use std::fs;
use std::path::PathBuf;

use clap::Args;
use estimator_core::physics::effect::EffectId;
use rayon::prelude::*;

pub use ignored::{Ignored, ignored};

use crate::cli::progress::Spinner;
use crate::diagnostic::{Diagnostic, listed, nearest};
use crate::kind::{self, Kind, kind_named};
use crate::output::{result, say, try_folder};
use crate::report::Provenance;

/// Arguments of `palpate effects`.
#[derive(Args, Clone, Debug)]
#[command(
    about = "The catalogue of effects that a rig can hide, and what each does to an estimate",
    long_about = "The catalogue of effects that a rig can hide: id, parameters with units (SI) and bounds, \
                  law, what gives it away and which motion shows it. Of one effect also what it does to \
                  stiffness, damping and exponent when a fit does not know of it.",
    after_help = "Example:\n  palpate effects\n  palpate effects series_compliance\n  \
                  palpate effects --out failure-modes"
)]
pub struct EffectsArgs {
    /// One effect, such as coulomb_friction; otherwise all of them.
    #[arg(value_name = "ID")]
    pub id: Option<String>,
    /// Folder for report.html: hysteresis loops, residuals and biased parameters, with pictures.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Units of a linear machine (m, N) or of a rotary one (rad, N m).
    #[arg(long, value_name = "KIND", default_value = "linear", value_parser = kind_named)]
    pub kind: Kind,
    /// Seed of the sensors' noise in the simulated palpations.
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
}

/// Runs the verb.
///
/// # Errors
/// A [`Diagnostic`] for an unknown effect; else what the file system says.
pub fn run(args: &EffectsArgs) -> Result<(), Box<dyn Error>> {
    kind::worded(args.kind, || show(args))
}

fn show(args: &EffectsArgs) -> Result<(), Box<dyn Error>> {
    let chosen = match &args.id {
        None => EffectId::ALL.to_vec(),
        Some(name) => vec![EffectId::from_name(name).ok_or_else(|| unknown(name))?],
    };
    if let Some(out) = &args.out {
        try_folder(out)?;
    }
    result(&json::catalogue(&chosen))?;
    let spinner = Spinner::new(1);
    let shown = match (args.id.is_some(), args.out.is_some()) {
        (false, false) => Vec::new(),
        _ => all(&chosen, args.seed)?,
    };
    drop(spinner);
    match (&args.id, shown.first()) {
        (Some(_), Some(one)) => say(text::one(one))?,
        _ => say(text::catalogue())?,
    }
    if let Some(out) = &args.out {
        fs::create_dir_all(out)
            .map_err(|error| format!("cannot make the folder {}: {error}", out.display()))?;
        let path = out.join("report.html");
        let provenance = Provenance::of_this_process();
        let provenance = provenance.setting("seed", args.seed.to_string());
        page::document(&shown, provenance).write(&path)?;
        say(format!("report: {}\n", path.display()))?;
    }
    Ok(())
}

fn unknown(name: &str) -> Diagnostic {
    let names = || EffectId::ALL.iter().map(|id| id.name());
    let diagnostic = Diagnostic::new(format!("unknown effect `{name}`"))
        .value(name)
        .note(format!("the effects are {}", listed(names())));
    match nearest(name, names()) {
        Some(near) => diagnostic.remedy(format!("palpate effects {near}")),
        None => diagnostic.remedy("`palpate effects` says what each of them is"),
    }
}

/// Simulates and fits every effect, on all cores.
fn all(ids: &[EffectId], seed: u64) -> Result<Vec<Ignored>, Diagnostic> {
    let done: Vec<_> = ids.par_iter().map(|id| ignored(*id, seed)).collect();
    done.into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_unknown_effect_is_refused_with_the_nearest_name() {
        let error = unknown("coulom_friction").to_string();
        assert!(
            error.contains("palpate effects coulomb_friction"),
            "{error}"
        );
    }
}
