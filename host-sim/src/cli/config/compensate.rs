//! `palpate config compensate`: what the gap workflow found goes to the board, which takes it off
//! before it estimates.
//!
//! A board has one place for each effect of a rig ([`estimator_core::board::settings::compensation`]). What
//! belongs to the material stays in the force: the board is asked for it. All is checked before
//! anything is sent, and comes into force as a whole.

use std::error::Error;
use std::path::PathBuf;

use clap::Args;
use estimator_core::board::settings::{Invalid, Settings};
use estimator_core::physics::effect::{Effect, Repeats};

use crate::diagnostic::{Diagnostic, listed};
use crate::link::{Device, Port, backup::restore};
use crate::model::Model;
use crate::number::quantity;

/// Arguments of `palpate config compensate`.
#[derive(Args, Clone, Debug)]
#[command(
    after_help = "Example:\n  palpate gap --model base.toml --log run1/log.csv --out gap\n  \
    palpate config --port /dev/ttyUSB0 compensate gap/model.toml\n  \
    palpate config --port /dev/ttyUSB0 compensate --off\n\n\
    The effects of the rig in the model replace those that the board compensates now, and are saved.\n\
    Effects of the material stay in the force. Lift the probe off first: the estimator restarts.\n\
    Friction, drag, inertia and lag need speeds, and make the estimates 6 ms later; a positive delay\n\
    adds itself. The stamp of an estimate says so: it is that of the instant it belongs to."
)]
pub struct CompensateArgs {
    /// The model of `palpate gap`, or one of your own (TOML).
    #[arg(required_unless_present = "off")]
    pub model: Option<PathBuf>,
    /// Compensate nothing any more.
    #[arg(long, conflicts_with = "model")]
    pub off: bool,
}

/// What a model asks of a board.
#[derive(Clone, Debug, Default)]
pub struct Plan {
    effects: Vec<Effect<f64>>,
    /// Of the material.
    stay: Vec<&'static str>,
    /// Of the rig, but counted from the start of a log.
    timed: Vec<&'static str>,
    of: PathBuf,
}

/// What is asked for, without a board.
///
/// # Errors
/// A model that cannot be read or used, an effect twice, or values that no board can use.
pub fn plan(args: &CompensateArgs) -> Result<Option<Plan>, Diagnostic> {
    let Some(path) = args.model.as_deref().filter(|_| !args.off) else {
        return Ok(None);
    };
    let model = Model::read(path)?;
    let mut plan = Plan {
        of: path.to_path_buf(),
        ..Plan::default()
    };
    for effect in model.rig()?.effects() {
        let id = effect.id();
        match (id.belongs_to_rig(), id.is_for_boards()) {
            (true, true) => plan.take(*effect)?,
            (true, false) => plan.timed.push(id.name()),
            (false, _) => plan.stay.push(id.name()),
        }
    }
    // On a board with the default settings: what its own change is the count of the encoder alone.
    plan.over(Settings::default())?;
    Ok(Some(plan))
}

impl Plan {
    fn take(&mut self, effect: Effect<f64>) -> Result<(), Diagnostic> {
        let id = effect.id();
        if self.effects.iter().any(|own| own.id() == id) {
            return Err(Diagnostic::new(format!("{} a second time", id.name()))
                .in_file(&self.of)
                .at_key("effect.id")
                .value(id.name())
                .note("a board has one place for each effect")
                .remedy("make one of them: forces of the same law add up"));
        }
        self.effects.push(effect);
        Ok(())
    }

    /// The settings with these effects in place of theirs.
    fn over(&self, settings: Settings) -> Result<Settings, Diagnostic> {
        let mut wanted = settings.without_compensation();
        for effect in &self.effects {
            wanted.put_effect(effect);
        }
        match wanted.check() {
            Ok(()) => Ok(wanted),
            Err(invalid) => Err(self.unusable(&invalid)),
        }
    }

    fn unusable(&self, invalid: &Invalid) -> Diagnostic {
        let name = invalid.key.info().name;
        let key = name.strip_prefix("compensation.").unwrap_or(name);
        Diagnostic::new("the board cannot compensate this")
            .in_file(&self.of)
            .at_key(&format!("effect.{key}"))
            .value(invalid.value)
            .remedy(invalid.to_string())
    }

    /// What it is, for people.
    fn said(&self, wanted: &Settings) -> String {
        let mut text = String::new();
        if !self.effects.is_empty() {
            text.push_str("compensated on the board:\n");
        }
        for effect in &self.effects {
            let values = effect.id().info().parameters.iter().zip(effect.row());
            let values = values.filter(|(info, value)| *value != 0.0 || info.default.is_none());
            let values: Vec<String> = values
                .map(|(info, value)| {
                    format!("{} {}", info.name, quantity(value, 5, info.unit.symbol()))
                })
                .collect();
            text.push_str(&format!(
                "  {:<22} {}\n",
                effect.id().name(),
                values.join(", ")
            ));
        }
        if self
            .effects
            .iter()
            .any(|effect| effect.id().info().repeats == Repeats::AlongTheWay)
        {
            text.push_str(
                "  a phase counts from the encoder's zero: where that is wherever the board was switched on,\n  \
                 it holds until the power goes, and has to be found again after that\n",
            );
        }
        for (names, why) in [
            (&self.stay, "stays in the force, it belongs to the material"),
            (
                &self.timed,
                "stays in the force, its time counts from the start of the log, of which a board knows \
                 nothing (its resting force follows a slow drift)",
            ),
        ] {
            if !names.is_empty() {
                text.push_str(&format!("{why}: {}\n", listed(names.iter().copied())));
            }
        }
        if let Some(setup) = wanted.setup().ok().filter(|setup| setup.late_us > 0) {
            text.push_str(&format!(
                "estimates are {} later; their stamps are those of the instants they belong to\n",
                quantity(setup.late_us as f64 * 1e-6, 3, "s")
            ));
        }
        text
    }
}

/// Puts the plan into the board, or takes everything out of it if there is none; saves.
///
/// # Errors
/// Whatever the board refuses: then nothing has changed.
pub fn run<P: Port>(device: &mut Device<P>, plan: Option<&Plan>) -> Result<String, Box<dyn Error>> {
    let Some(plan) = plan else {
        let now = device.settings()?;
        let changed = restore(device, &now, &now.without_compensation())?;
        return Ok(match changed {
            0 => "nothing was compensated\n".to_string(),
            _ => "nothing is compensated any more; saved\n".to_string(),
        });
    };
    if plan.effects.is_empty() {
        let said = plan.said(&Settings::default());
        let of = plan.of.display();
        return Ok(format!(
            "{said}{of} has no effect of the rig that a board can compensate: nothing sent\n"
        ));
    }
    let now = device.settings()?;
    let wanted = plan.over(now)?;
    let changed = restore(device, &now, &wanted)?;
    Ok(format!(
        "{}{changed} settings changed, saved\n",
        plan.said(&wanted)
    ))
}
