//! Which column holds a channel, by its name, its unit and its cells.

use super::cell::{Cell, NumberFormat, looks_like_number, number};
use super::channel::{Channel, Header, Origin, Placed};
use super::names::{self, Fit, Words};
use super::stamp;
use super::units::{self, Quantity, Unit};

/// Why a channel has no column.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Unclear {
    /// No name and no unit fits.
    Nothing,
    /// The name of this column fits, and nothing says its unit.
    Unit(usize),
    /// Several columns fit equally well.
    Several(Vec<usize>),
}

/// Stamps since 1970 that lie between 1998 and 2128, by their unit.
const EPOCHS: [(&str, f64); 4] = [("s", 1.0), ("ms", 1e3), ("us", 1e6), ("ns", 1e9)];
const EPOCH_S: std::ops::Range<f64> = 0.9e9..5e9;

fn words(channel: Channel) -> &'static Words {
    match channel {
        Channel::Time => &names::TIME,
        Channel::Position => &names::POSITION,
        Channel::Force => &names::FORCE,
    }
}

fn suits(channel: Channel, quantity: Quantity) -> bool {
    match channel {
        Channel::Time => quantity == Quantity::Time,
        Channel::Position => matches!(quantity, Quantity::Length | Quantity::Angle),
        Channel::Force => matches!(quantity, Quantity::Force | Quantity::Torque),
    }
}

/// A column that may hold the channel.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    index: usize,
    fit: Fit,
    unit: Option<Unit>,
}

/// The column of a channel, among those that no other channel has.
pub(super) fn guess(channel: Channel, header: Header, taken: &[usize]) -> Result<Placed, Unclear> {
    let free = (0..header.names.len()).filter(|index| !taken.contains(index));
    let candidates: Vec<Candidate> = free
        .filter_map(|index| candidate(channel, header, index))
        .collect();
    let known = |candidate: &&Candidate| candidate.unit.is_some();
    let best = candidates
        .iter()
        .filter(known)
        .map(|candidate| candidate.fit)
        .min();
    let Some(best) = best else {
        let first = candidates.iter().min_by_key(|candidate| candidate.fit);
        return Err(first.map_or(Unclear::Nothing, |first| Unclear::Unit(first.index)));
    };
    // A better name without a unit is no worse than one with it.
    if let Some(better) = candidates
        .iter()
        .find(|candidate| candidate.unit.is_none() && candidate.fit < best)
    {
        return Err(Unclear::Unit(better.index));
    }
    let equal: Vec<&Candidate> = candidates
        .iter()
        .filter(known)
        .filter(|c| c.fit == best)
        .collect();
    match equal[..] {
        [
            Candidate {
                index,
                unit: Some(unit),
                ..
            },
        ] => Ok(Placed {
            index: *index,
            factor: unit.factor,
            unit: Some(*unit),
            origin: Origin::Guessed,
        }),
        _ => Err(Unclear::Several(
            equal.iter().map(|candidate| candidate.index).collect(),
        )),
    }
}

fn candidate(channel: Channel, header: Header, index: usize) -> Option<Candidate> {
    if !holds_values(channel, header, index) {
        return None;
    }
    let unit = unit(channel, header, index);
    let foreign = stated_unit(channel, header, index);
    if unit.is_none() && foreign.is_some() {
        return None;
    }
    let name = name(header, index);
    let is_weak = unit.is_none_or(|unit| unit.symbol == "gf");
    let fit = match words(channel).fit(name) {
        Some(fit) => fit,
        // Acceleration is given in g, too.
        None if !is_weak && !names::is_other(name) && is_unit_sure(header, index) => Fit::UnitOnly,
        None => return None,
    };
    Some(Candidate { index, fit, unit })
}

/// The name of a column without its unit.
fn name<'a>(header: Header<'a>, index: usize) -> &'a str {
    units::split(&header.names[index]).0
}

/// Whether a unit stands in a row of its own or in brackets, and not only behind a `_`.
fn is_unit_sure(header: Header, index: usize) -> bool {
    let in_row = header.units.get(index).is_some_and(|cell| !cell.is_empty());
    in_row
        || header.names[index]
            .trim_end()
            .ends_with([')', ']', '>', '}'])
}

/// The unit that a column says it has, whatever it measures.
fn stated_unit(channel: Channel, header: Header, index: usize) -> Option<Unit> {
    let in_row = header.units.get(index).and_then(|cell| units::parse(cell));
    let (name, in_name) = units::split(&header.names[index]);
    let unit = in_row.or(in_name)?;
    // `torque_nm` in small letters is no length, but a cantilever's `Deflection (nm)` is.
    let is_torque = channel == Channel::Force
        && unit.symbol == "nm"
        && names::FORCE.fit(name).is_some()
        && !names::is_deflection(name);
    let is_either = unit.symbol == "MN" && is_in_capitals(header);
    (!is_either).then(|| if is_torque { units::torque() } else { unit })
}

/// Whether a header has no small letter: `F (MN)` beside `T (S)` may be millinewton.
fn is_in_capitals(header: Header) -> bool {
    let mut cells = header.names.iter().chain(header.units);
    !cells.any(|cell| cell.chars().any(char::is_lowercase))
}

/// The unit of a column if it is one of the channel; of stamps the one that their size tells.
pub(super) fn unit(channel: Channel, header: Header, index: usize) -> Option<Unit> {
    match stated_unit(channel, header, index) {
        Some(unit) => Some(unit).filter(|unit| suits(channel, unit.quantity)),
        None if channel == Channel::Time => stamp_unit(header, index),
        None => None,
    }
}

/// The unit of stamps that show it: dates, times of day, and counts since 1970.
fn stamp_unit(header: Header, index: usize) -> Option<Unit> {
    let first = header.sample.first()?.get(index)?;
    if stamp::seconds(first).is_some() {
        return units::parse("s");
    }
    let Cell::Number(value) = number(first.as_bytes(), NumberFormat::default()) else {
        return None;
    };
    let mut epochs = EPOCHS.into_iter();
    let (name, _) = epochs.find(|(_, per_second)| EPOCH_S.contains(&(value / per_second)))?;
    units::parse(name)
}

/// Whether most of the first cells of a column are numbers or, of time, stamps; a date alone is no time.
fn holds_values(channel: Channel, header: Header, index: usize) -> bool {
    let cells = || header.sample.iter().filter_map(|row| row.get(index));
    let is_value = |cell: &&String| {
        looks_like_number(cell) || (channel == Channel::Time && stamp::seconds(cell).is_some())
    };
    cells().filter(|cell| !cell.is_empty()).count() <= 2 * cells().filter(is_value).count()
}

/// A column as `--columns` names it: by its number where others have its name.
pub(super) fn called(header: Header, index: usize) -> String {
    let name = &header.names[index];
    match header.names.iter().filter(|other| *other == name).count() {
        1 => name.clone(),
        _ => (index + 1).to_string(),
    }
}

/// A column that is called as the channel is, but holds text, and the first of its cells.
pub(super) fn text_in(channel: Channel, header: Header<'_>) -> Option<(usize, &str)> {
    let named =
        (0..header.names.len()).filter(|index| words(channel).fit(name(header, *index)).is_some());
    let mut texts = named.filter(|index| !holds_values(channel, header, *index));
    let index = texts.next()?;
    let cells = header.sample.iter().filter_map(|row| row.get(index));
    let first = cells.map(String::as_str).find(|cell| !cell.is_empty())?;
    Some((index, first))
}

/// A column that is called as the channel is, or a strain or a stress, but whose unit is of something else.
pub(super) fn in_other_units(channel: Channel, header: Header) -> Option<usize> {
    let is_called = |index: &usize| {
        let own = name(header, *index);
        words(channel).fit(own).is_some() || names::is_relative(channel, own)
    };
    (0..header.names.len()).filter(is_called).find(|index| {
        stated_unit(channel, header, *index).is_some() && unit(channel, header, *index).is_none()
    })
}

/// A column that holds how far a cantilever bends, in a unit of length.
pub(super) fn bent(header: Header) -> Option<(usize, Unit)> {
    (0..header.names.len()).find_map(|index| {
        let unit = stated_unit(Channel::Force, header, index)?;
        let is_bent =
            names::is_deflection(name(header, index)) && unit.quantity == Quantity::Length;
        is_bent.then_some((index, unit))
    })
}

/// What `--columns` probably should be.
pub(super) struct Suggestion {
    /// Units that are not said left as SI.
    pub(super) as_si: String,
    /// The same with the units that people have otherwise where none is said: mm.
    pub(super) as_usual: Option<String>,
    /// The channels whose unit nothing says.
    pub(super) unsure: Vec<Channel>,
}

/// What `--columns` probably should be.
pub(super) fn suggestion(header: Header) -> Option<Suggestion> {
    let mut taken = Vec::new();
    let (mut as_si, mut as_usual) = (Vec::new(), Vec::new());
    let mut unsure = Vec::new();
    for channel in Channel::ALL {
        let own = (0..header.names.len()).find(|index| header.names[*index] == channel.column());
        let index = match own.map_or_else(|| guess(channel, header, &taken).map(|p| p.index), Ok) {
            Ok(index) | Err(Unclear::Unit(index)) => index,
            Err(Unclear::Several(indices)) => *indices.first()?,
            // Without a column of time there is --rate.
            Err(Unclear::Nothing) if channel == Channel::Time => continue,
            Err(Unclear::Nothing) => return None,
        };
        taken.push(index);
        let unit = unit(channel, header, index);
        let is_unknown = unit.is_none() && units::unknown(&header.names[index]).is_some();
        let factor = match unit {
            Some(unit) if !unit.factor_text.is_empty() => format!("*{}", unit.factor_text),
            None if is_unknown => "*FACTOR".into(),
            _ => String::new(),
        };
        let part = format!("{}={}", channel.letter(), called(header, index));
        if unit.is_none() {
            unsure.push(channel);
        }
        as_usual.push(
            match unit.is_none() && channel == Channel::Position && !is_unknown {
                true => format!("{part}*1e-3"),
                false => format!("{part}{factor}"),
            },
        );
        as_si.push(format!("{part}{factor}"));
    }
    let (as_si, as_usual) = (as_si.join(","), as_usual.join(","));
    Some(Suggestion {
        as_usual: (as_usual != as_si).then_some(as_usual),
        as_si,
        unsure,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn strings(cells: &[&str]) -> Vec<String> {
        cells.iter().map(|cell| (*cell).to_string()).collect()
    }

    fn guessed(names: &[&str], units: &[&str], row: &[&str]) -> Result<Vec<(usize, f64)>, Unclear> {
        let (names, units, sample) = (strings(names), strings(units), vec![strings(row)]);
        let header = Header {
            names: &names,
            units: &units,
            sample: &sample,
        };
        let mut taken = Vec::new();
        let mut found = Vec::new();
        for channel in Channel::ALL {
            let placed = guess(channel, header, &taken)?;
            taken.push(placed.index);
            found.push((placed.index, placed.factor));
        }
        Ok(found)
    }

    #[test]
    fn machines_are_understood_by_names_and_units() {
        for (names, units, row, wanted) in [
            (
                &["Time (s)", "Extension (mm)", "Load (kN)"][..],
                &[][..],
                &["0", "0", "0"][..],
                [(0, 1.0), (1, 1e-3), (2, 1e3)],
            ),
            (
                &["Prüfzeit", "Standardweg", "Traversenweg", "Standardkraft"],
                &["s", "mm", "mm", "N"],
                &["0"; 4],
                [(0, 1.0), (1, 1e-3), (3, 1.0)],
            ),
            (
                &[
                    "Depth (nm)",
                    "Load (µN)",
                    "Time (s)",
                    "Depth (V)",
                    "Load (V)",
                ],
                &[],
                &["0"; 5],
                [(2, 1.0), (0, 1e-9), (1, 1e-6)],
            ),
            (
                &["Temps (s)", "Déplacement (mm)", "Force (N)"],
                &[],
                &["0"; 3],
                [(0, 1.0), (1, 1e-3), (2, 1.0)],
            ),
            (
                &["Tiempo (s)", "Carrera (mm)", "Fuerza (N)"],
                &[],
                &["0"; 3],
                [(0, 1.0), (1, 1e-3), (2, 1.0)],
            ),
            (
                &["Kanal 1 [s]", "Kanal 2 [N]", "Kanal 3 [mm]"],
                &[],
                &["0"; 3],
                [(0, 1.0), (2, 1e-3), (1, 1.0)],
            ),
            (
                &["timestamp", "pos_mm", "Fz (N)"],
                &[],
                &["1772366400000", "0", "0"],
                [(0, 1e-3), (1, 1e-3), (2, 1.0)],
            ),
            (
                &["Date", "Time", "Weg / mm", "Kraft / N"],
                &[],
                &["2026-03-01", "12:00:00.1", "0", "0"],
                [(1, 1.0), (2, 1e-3), (3, 1.0)],
            ),
        ] {
            assert_eq!(guessed(names, units, row), Ok(wanted.to_vec()), "{names:?}");
        }
    }

    #[test]
    fn where_a_guess_could_be_wrong_it_is_none() {
        let two = guessed(
            &["Time (s)", "Extension (mm)", "Position (mm)", "Load (N)"],
            &[],
            &["0"; 4],
        );
        assert_eq!(two, Err(Unclear::Several(vec![1, 2])));
        let bare = guessed(&["Time (s)", "Extension (mm)", "Load"], &[], &["0"; 3]);
        assert_eq!(bare, Err(Unclear::Unit(2)));
        let none = guessed(
            &["Time (s)", "Temperature (°C)", "Load (N)"],
            &[],
            &["0"; 3],
        );
        assert_eq!(none, Err(Unclear::Nothing));
    }
}
