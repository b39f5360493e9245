//! `palpate config`: a board's settings.

use std::error::Error;
use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use estimator_core::board::{link::Command, link::Description, settings::Key};

pub mod calibrate;
pub mod compensate;

use crate::diagnostic::{Diagnostic, listed, nearest};
use crate::link::{Device, Port, backup, backup::restore, condition, port};
use crate::output::say;
use calibrate::CalibrateArgs;
use compensate::CompensateArgs;

/// Arguments of `palpate config`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Example:\n  palpate config --port /dev/ttyUSB0 show\n  \
    palpate config --port /dev/ttyUSB0 set estimator.depth_m 0.002\n  \
    palpate config --port /dev/ttyUSB0 calibrate --weights 0,0.5,1,2\n  \
    palpate config --port /dev/ttyUSB0 compensate gap/model.toml\n\n\
    A change is in force at once; `save` keeps it through a power cut. Nothing that restarts the\n\
    estimator is taken while the probe is in contact.")]
pub struct ConfigArgs {
    /// Serial port, the emulator's working directory, or `simulated`: a simulated board, new at every start.
    #[arg(long, value_name = "PORT")]
    pub port: String,
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Subcommand, Clone, Debug)]
enum Verb {
    /// All settings with their units
    Show,
    /// One setting with its bounds and its default
    Get {
        /// Its name, such as force.n_per_code.
        name: String,
    },
    /// Change a setting, in the unit that `show` says
    Set {
        /// Its name, such as estimator.depth_m.
        name: String,
        /// The new value.
        #[arg(allow_negative_numbers = true)]
        value: f32,
    },
    /// Store the settings in the board, so that they survive a power cut
    Save,
    /// Go back to the saved settings
    Reload,
    /// Back to the defaults (not saved)
    Defaults,
    /// Forget the estimates and start again; the probe must be in free air
    Restart,
    /// Allow the force output; a reset, a save, a restart and a fault disarm it
    Arm,
    /// Set the force output to 0 N and disable it
    Disarm,
    /// Write all settings into a file
    Backup {
        /// TOML.
        file: PathBuf,
    },
    /// Set and save all settings of a file
    Restore {
        /// TOML, as `backup` writes it; what it does not name stays as it is.
        file: PathBuf,
    },
    /// Find scale and zero of the load cell with known weights, and the encoder's scale and sign
    Calibrate(CalibrateArgs),
    /// Compensate on the board what `palpate gap` found: friction, inertia, compliance, lag …
    Compensate(CompensateArgs),
}

/// Runs the verb.
///
/// # Errors
/// A [`Diagnostic`] for a port that is not there, a name or value that is none, and whatever the
/// board refuses; an I/O error if it does not answer.
pub fn run(args: &ConfigArgs) -> Result<(), Box<dyn Error>> {
    // What can be refused without a board is refused without one.
    if let Verb::Get { name } | Verb::Set { name, .. } = &args.verb
        && let Err(unknown) = key_of(name)
    {
        // A newer board may know it.
        let Ok(port) = port::open(&args.port) else {
            return Err(unknown.into());
        };
        let value = match &args.verb {
            Verb::Set { value, .. } => Some(*value),
            _ => None,
        };
        let done = newer(&mut Device::new(port), name, value)?;
        return Ok(say(done.ok_or(unknown)?)?);
    }
    if let Verb::Compensate(wanted) = &args.verb {
        let plan = compensate::plan(wanted)?;
        let mut device = Device::new(port::open(&args.port)?);
        say(compensate::run(&mut device, plan.as_ref())?)?;
        return Ok(());
    }
    let mut device = Device::new(port::open(&args.port)?);
    say(done(&mut device, &args.verb)?)?;
    Ok(())
}

fn done<P: Port>(device: &mut Device<P>, verb: &Verb) -> Result<String, Box<dyn Error>> {
    match verb {
        Verb::Show => show(device),
        Verb::Get { name } => {
            let key = key_of(name)?;
            let info = key.info();
            let line = line(key, device.get(key)?);
            Ok(format!(
                "{line}{:24} {}; default {}\n",
                "", info.bounds, info.default
            ))
        }
        Verb::Set { name, value } => {
            let key = key_of(name)?;
            device.set(key, *value)?;
            Ok(format!(
                "{}not saved: `config save` keeps it\n",
                line(key, *value)
            ))
        }
        Verb::Save => ordered(device, Command::Save, "saved"),
        Verb::Reload => ordered(device, Command::Reload, "as saved"),
        Verb::Defaults => ordered(device, Command::Defaults, "defaults in force, not saved"),
        Verb::Restart => ordered(device, Command::Restart, "settling"),
        Verb::Arm => ordered(device, Command::Arm, "armed"),
        Verb::Disarm => ordered(device, Command::Disarm, "disarmed"),
        Verb::Backup { file } => keep(device, file),
        Verb::Restore { file } => restored(device, file),
        Verb::Calibrate(args) => calibrate::run(device, args, &mut calibrate::Terminal),
        Verb::Compensate(args) => compensate::run(device, compensate::plan(args)?.as_ref()),
    }
}

fn ordered<P: Port>(
    device: &mut Device<P>,
    command: Command,
    said: &str,
) -> Result<String, Box<dyn Error>> {
    device.order(command)?;
    Ok(format!("{said}\n"))
}

/// Writes all settings that the board knows into a file, and says which those are not.
///
/// # Errors
/// What board and file system say.
pub fn keep<P: Port>(device: &mut Device<P>, file: &Path) -> Result<String, Box<dyn Error>> {
    if file.exists() {
        return Err(Diagnostic::new("the file is there already")
            .in_file(file)
            .remedy("name another file, or remove this one")
            .into());
    }
    let name = device.identity()?.board.to_string();
    let (settings, unknown) = device.known_settings()?;
    backup::write(file, &settings, &unknown, &name)?;
    let known = Key::ALL.len() - unknown.len();
    let text = format!("{}: {known} settings\n", file.display());
    Ok(text + &not_known(&unknown))
}

/// Sets and saves the settings of a file; what it does not name stays.
///
/// # Errors
/// What file and board say; one that the board does not know and that is not at its default.
pub fn restored<P: Port>(device: &mut Device<P>, file: &Path) -> Result<String, Box<dyn Error>> {
    let now = device.settings()?;
    let changed = restore(device, &now, &backup::read(file, now)?)?;
    Ok(format!("{}: {changed} changed, saved\n", file.display()))
}

/// What the board is, and its settings.
///
/// # Errors
/// What the board says.
pub fn show<P: Port>(device: &mut Device<P>) -> Result<String, Box<dyn Error>> {
    let identity = device.identity()?;
    let (settings, unknown) = device.known_settings()?;
    let saved = if identity.unsaved {
        "not saved"
    } else {
        "saved"
    };
    let mut text = format!(
        "{}, firmware {}, {} Hz; settings {saved}\n",
        identity.board, identity.firmware, identity.rate_hz
    );
    // Of the effects, those that are on.
    let of_an_effect = |key: &Key| matches!(key, Key::Compensation(_));
    let on = |key: &Key| !of_an_effect(key) || settings.get(*key) != 0.0;
    let shown = |key: &Key| on(key) && !unknown.contains(key);
    for key in Key::ALL.into_iter().filter(shown) {
        text.push_str(&line(key, settings.get(key)));
    }
    if !Key::ALL
        .into_iter()
        .any(|key| of_an_effect(&key) && shown(&key))
    {
        text.push_str("compensation: none; `config compensate` sets it\n");
    }
    text.push_str(&not_known(&unknown));
    for (setting, value) in device.newer_settings()? {
        text.push_str(&described(&setting, value));
    }
    if let Some(health) = device.health()? {
        for said in condition::lines(&health) {
            text.push_str(&format!("{said}\n"));
        }
    }
    Ok(text)
}

/// The line of a setting that this version does not know, as the board describes it.
fn described(setting: &Description, value: f32) -> String {
    let valued = format!("{value} {}", setting.unit.as_str().trim_start_matches('1'));
    format!(
        "{:<24} {:<18} {}; default {} (newer than this `palpate`)\n",
        setting.name.as_str(),
        valued.trim_end(),
        setting.bounds,
        setting.default
    )
}

/// Reads or sets a setting that this version does not know, by its name on the board; `None` if the board does not
/// know it either.
fn newer<P: Port>(
    device: &mut Device<P>,
    name: &str,
    value: Option<f32>,
) -> Result<Option<String>, Box<dyn Error>> {
    let known = device.newer_settings()?;
    let found = known.into_iter().find(|(s, _)| s.name.as_str() == name);
    let Some((setting, now)) = found else {
        return Ok(None);
    };
    let Some(value) = value else {
        return Ok(Some(described(&setting, now)));
    };
    device.order(Command::Set(setting.id, value))?;
    let kept = "not saved: `config save` keeps it\n";
    Ok(Some(described(&setting, value) + kept))
}

/// What an older firmware lacks, by section: it does as it did before there was such a setting.
fn not_known(unknown: &[Key]) -> String {
    let section = |key: &Key| match key.info().name.split_once('.') {
        Some((section, _)) => section,
        None => "",
    };
    let mut text = String::new();
    for part in unknown.chunk_by(|a, b| section(a) == section(b)) {
        let names = part.iter().map(|key| key.info().name);
        let names = match part {
            [Key::Compensation(_), ..] => "compensation.*".to_string(),
            _ => names.collect::<Vec<_>>().join(", "),
        };
        text.push_str(&format!("not known to this firmware: {names}\n"));
    }
    text
}

fn line(key: Key, value: f32) -> String {
    let info = key.info();
    let about = match key {
        Key::Compensation(parameter) => parameter.effect().info().law,
        _ => info.about,
    };
    let unit = if info.unit == "1" { "" } else { info.unit };
    let valued = format!("{value} {unit}");
    format!("{:<24} {:<18} {about}\n", info.name, valued.trim_end())
}

fn key_of(name: &str) -> Result<Key, Diagnostic> {
    Key::from_name(name).ok_or_else(|| {
        let names = || Key::ALL.into_iter().map(|key| key.info().name);
        let diagnostic = Diagnostic::new("no such setting")
            .value(name)
            .note(format!("the settings are {}", listed(names())));
        match nearest(name, names()) {
            Some(near) => diagnostic.remedy(format!("write `{near}`")),
            None => diagnostic.remedy("`palpate config show` lists them"),
        }
    })
}
