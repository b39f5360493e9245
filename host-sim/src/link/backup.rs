//! The settings of a board as a TOML file, with a section for each part and a unit for each value.

use std::error::Error;
use std::io;
use std::path::Path;

use estimator_core::board::{link::Command, settings::Invalid, settings::Key, settings::Settings};

use super::{Device, Port};
use crate::diagnostic::Diagnostic;
use crate::output::write_atomically;
use crate::toml_reader::{Bounds, Table, TomlFile};

const COMPENSATION: &str = "compensation";

/// The text of a backup, without the settings that the board does not know.
pub fn text(settings: &Settings, unknown: &[Key], of: &str) -> String {
    let mut text = format!("# Settings of {of}, for `palpate config restore`.\n");
    let mut section = "";
    for key in Key::ALL.into_iter().filter(|key| !unknown.contains(key)) {
        let info = key.info();
        let (part, name) = split(info.name);
        if part != section {
            text.push_str(&format!("\n[{part}]\n"));
            section = part;
        }
        let unit = if info.unit == "1" { "" } else { info.unit };
        let gap = if unit.is_empty() { "" } else { ": " };
        let value = settings.get(key);
        text.push_str(&format!("{name} = {value} # {unit}{gap}{}\n", info.about));
    }
    text
}

/// Writes a backup.
///
/// # Errors
/// The file cannot be written.
pub fn write(path: &Path, settings: &Settings, unknown: &[Key], of: &str) -> io::Result<()> {
    write_atomically(path, |writer| {
        writer.write_all(text(settings, unknown, of).as_bytes())
    })
}

/// Reads a backup into `settings`. A setting that the file does not name keeps its value.
///
/// # Errors
/// The file cannot be read, or has an unknown key, a value that is no number, or a value that a board
/// cannot use. The error gives the line.
pub fn read(path: &Path, settings: Settings) -> Result<Settings, Diagnostic> {
    parse(&TomlFile::read(path)?, settings)
}

fn parse(file: &TomlFile, mut settings: Settings) -> Result<Settings, Diagnostic> {
    let root = file.root();
    let mut parts: Vec<&str> = Key::ALL
        .iter()
        .map(|key| split(key.info().name).0)
        .collect();
    parts.dedup();
    let compensation = root.table(COMPENSATION)?;
    for part in parts {
        let Some(table) = section(&root, compensation.as_ref(), part)? else {
            continue;
        };
        for key in Key::ALL
            .into_iter()
            .filter(|key| split(key.info().name).0 == part)
        {
            if let Some(value) = table.number(split(key.info().name).1, Bounds::Any)? {
                settings.put(key, value as f32);
            }
        }
        table.finish()?;
    }
    if let Some(compensation) = &compensation {
        compensation.finish()?;
    }
    root.finish()?;
    match settings.check() {
        Ok(()) => Ok(settings),
        Err(invalid) => Err(unusable(&root, compensation.as_ref(), &invalid)?),
    }
}

/// The table of a section: `[force]`, or `[compensation.coulomb_friction]`.
fn section<'a>(
    root: &Table<'a>,
    compensation: Option<&Table<'a>>,
    part: &str,
) -> Result<Option<Table<'a>>, Diagnostic> {
    match (part.split_once('.'), compensation) {
        (Some((_, effect)), Some(compensation)) => compensation.table(effect),
        (Some(_), None) => Ok(None),
        (None, _) => root.table(part),
    }
}

/// The error about a value, with its line.
fn unusable(
    root: &Table,
    compensation: Option<&Table>,
    invalid: &Invalid,
) -> Result<Diagnostic, Diagnostic> {
    let (part, name) = split(invalid.key.info().name);
    let what = format!("`{}` cannot be {}", invalid.key.info().name, invalid.value);
    let diagnostic = match section(root, compensation, part)? {
        Some(table) => table.wrong(name, what),
        None => root.wrong(name, what),
    };
    Ok(diagnostic.remedy(invalid.to_string()))
}

/// The section and the name of a setting. A section may have sections of its own.
fn split(name: &'static str) -> (&'static str, &'static str) {
    name.rsplit_once('.').unwrap_or(("", name))
}

/// Gives all settings their new values at once, and saves them. If a value is refused, or the connection
/// breaks on the way, nothing has changed.
pub fn restore<P: Port>(
    device: &mut Device<P>,
    now: &Settings,
    wanted: &Settings,
) -> Result<usize, Box<dyn Error>> {
    let differs = |key: &Key| now.get(*key) != wanted.get(*key);
    let changed: Vec<Key> = Key::ALL.into_iter().filter(differs).collect();
    // An earlier host may have left some values that it never committed.
    device.order(Command::Discard)?;
    for key in &changed {
        device.prepare(*key, wanted.get(*key))?;
    }
    device.order(Command::Commit)?;
    device.order(Command::Save).map_err(|error| {
        format!("{error}\nthe new values are in force but not saved: the board loses them when its power goes off")
    })?;
    Ok(changed.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Result<Settings, Diagnostic> {
        let file = TomlFile::parse(text.into(), Path::new("board.toml"))?;
        parse(&file, Settings::default())
    }

    #[test]
    fn every_value_comes_back_to_the_bit() {
        let mut settings = Settings::default();
        for (index, key) in Key::ALL.into_iter().enumerate() {
            let value = settings.get(key) * (1.0 + index as f32 / 1024.0);
            if key.info().bounds.hold(value) {
                settings.put(key, value);
            }
        }
        settings.put(Key::PositionPerCode, -1.0 / 3.0 * 1e-7);
        settings.check().unwrap();
        assert_eq!(of(&text(&settings, &[], "a board")).unwrap(), settings);
    }

    #[test]
    fn an_effect_is_a_section_of_its_own_and_comes_back() {
        let text = "[compensation.coulomb_friction]\nforce = 0.4\nwidth = 1e-5\n";
        let settings = of(text).unwrap();
        let force = Key::from_name("compensation.coulomb_friction.force").unwrap();
        assert_eq!(settings.get(force), 0.4);
        assert!(
            super::text(&settings, &[], "a board")
                .contains("\n[compensation.coulomb_friction]\nforce = 0.4 # N: ")
        );
        assert_eq!(
            of(&super::text(&settings, &[], "a board")).unwrap(),
            settings
        );
        for (text, line, said) in [
            (
                "[compensation.coulomb_frict]\nforce = 1\n",
                1,
                "coulomb_friction",
            ),
            ("[compensation.tool_inertia]\n\nmas = 1\n", 3, "mass"),
            ("[compensation.tool_inertia]\nmass = -1\n", 2, "from 0"),
            ("[compensation.cogging]\namplitude = 1\n", 1, "pitch"),
        ] {
            let error = of(text).unwrap_err();
            assert_eq!(error.line, Some(line), "{error}");
            assert!(error.to_string().contains(said), "{error}");
        }
    }

    #[test]
    fn what_is_not_named_stays() {
        let settings = of("[estimator]\nhalf_width = 12\n").unwrap();
        assert_eq!(settings.get(Key::EstimatorHalfWidth), 12.0);
        assert_eq!(
            settings.get(Key::ForcePerCode),
            Settings::default().get(Key::ForcePerCode)
        );
    }

    #[test]
    fn a_misspelt_key_and_a_value_out_of_bounds_are_shown_at_their_line() {
        let error = of("[force]\nzero_cod = 3\n").unwrap_err();
        assert_eq!(error.line, Some(2), "{error}");
        assert!(error.to_string().contains("zero_code"), "{error}");
        let error = of("[estimator]\n\nhalf_width = 77\n").unwrap_err();
        assert_eq!(error.line, Some(3), "{error}");
        assert!(error.to_string().contains("from 2 to 32"), "{error}");
    }
}
