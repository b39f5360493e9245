//! Which columns hold time, position and force, with which sign and in which unit.

use std::str::FromStr;

use crate::diagnostic::{Diagnostic, listed, nearest};

/// One of the three channels of a log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channel {
    /// Time (s).
    Time,
    /// Position (m).
    Position,
    /// Force (N).
    Force,
}

impl Channel {
    /// All three, in the order of a log's columns.
    pub const ALL: [Channel; 3] = [Channel::Time, Channel::Position, Channel::Force];

    /// The name of its column in a log of our own.
    pub const fn column(self) -> &'static str {
        match self {
            Channel::Time => "t_s",
            Channel::Position => "x_m",
            Channel::Force => "f_n",
        }
    }

    /// Its letter in `--columns`.
    pub const fn letter(self) -> char {
        match self {
            Channel::Time => 't',
            Channel::Position => 'x',
            Channel::Force => 'f',
        }
    }

    /// Quantity and unit, for sentences.
    pub const fn quantity(self) -> &'static str {
        match self {
            Channel::Time => "time in seconds",
            Channel::Position => "position in metres",
            Channel::Force => "force in newtons",
        }
    }

    /// Beginnings of the names that other machines give the column.
    const fn usual_names(self) -> &'static [&'static str] {
        match self {
            Channel::Time => &["time", "elapsed", "t", "sec"],
            Channel::Position => &[
                "pos",
                "disp",
                "depth",
                "indent",
                "penetration",
                "travel",
                "extension",
                "height",
                "stroke",
                "x",
                "z",
                "gap",
            ],
            Channel::Force => &["force", "load", "axial", "f", "n"],
        }
    }

    /// Units of names, longest first, and what makes them SI.
    const fn usual_units(self) -> &'static [(&'static str, &'static str)] {
        match self {
            Channel::Time => &[
                ("ms", "1e-3"),
                ("us", "1e-6"),
                ("µs", "1e-6"),
                ("min", "60"),
            ],
            Channel::Position => &[
                ("mm", "1e-3"),
                ("um", "1e-6"),
                ("µm", "1e-6"),
                ("nm", "1e-9"),
                ("cm", "1e-2"),
            ],
            Channel::Force => &[
                ("mn", "1e-3"),
                ("un", "1e-6"),
                ("µn", "1e-6"),
                ("nn", "1e-9"),
                ("kn", "1e3"),
                ("gf", "9.80665e-3"),
                ("lbf", "4.4482216"),
            ],
        }
    }
}

/// A column and what turns its numbers into SI.
#[derive(Clone, Debug, PartialEq)]
struct Mapped {
    name: String,
    factor: f64,
}

/// The columns of the three channels: `t_s,x_m,f_n` unless said otherwise.
///
/// Written as `t=Time[ms]*1e-3,x=pos_mm*1e-3,f=-Fz`: a letter, a column's name as it stands in the
/// header, a sign before it, a factor after it. Letters that are left out keep their usual column.
#[derive(Clone, Debug, PartialEq)]
pub struct ColumnMap {
    channels: [Mapped; 3],
}

/// Where in a row a channel stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Placed {
    pub(super) channel: Channel,
    pub(super) index: usize,
    pub(super) factor: f64,
}

impl Default for ColumnMap {
    fn default() -> Self {
        ColumnMap {
            channels: Channel::ALL.map(|channel| Mapped {
                name: channel.column().to_string(),
                factor: 1.0,
            }),
        }
    }
}

impl FromStr for ColumnMap {
    type Err = Diagnostic;

    fn from_str(text: &str) -> Result<Self, Diagnostic> {
        let mut map = ColumnMap::default();
        let mut seen = [false; 3];
        for part in split_parts(text) {
            let (slot, mapped) = parse_part(part, text)?;
            if std::mem::replace(&mut seen[slot], true) {
                return Err(malformed("a channel is given twice", part, text));
            }
            map.channels[slot] = mapped;
        }
        Ok(map)
    }
}

/// Splits only where a comma is followed by a letter and `=`: names may contain commas.
fn split_parts(text: &str) -> Vec<&str> {
    let mut parts = Vec::new();
    let mut from = 0;
    for (at, _) in text.match_indices(',') {
        let rest = text[at + 1..].trim_start().as_bytes();
        if matches!(rest, [b't' | b'x' | b'f', b'=', ..]) {
            parts.push(text[from..at].trim());
            from = at + 1;
        }
    }
    parts.push(text[from..].trim());
    parts
}

fn parse_part(part: &str, text: &str) -> Result<(usize, Mapped), Diagnostic> {
    let letter_and_column = part.split_once('=').map(|(l, c)| (l.trim(), c.trim()));
    let slot = letter_and_column.and_then(|(letter, _)| {
        Channel::ALL
            .iter()
            .position(|channel| letter == channel.letter().to_string())
    });
    let (Some((_, column)), Some(slot)) = (letter_and_column, slot) else {
        return Err(malformed("not a channel and a column", part, text));
    };
    let (signed, factor) = match column.rsplit_once('*') {
        None => (column, 1.0),
        Some((name, factor)) => (name.trim(), parse_factor(factor.trim(), part, text)?),
    };
    let (name, factor) = match signed.strip_prefix('-') {
        Some(name) => (name.trim(), -factor),
        None => (signed, factor),
    };
    if name.is_empty() {
        return Err(malformed("no column is named", part, text));
    }
    let name = name.to_string();
    Ok((slot, Mapped { name, factor }))
}

fn parse_factor(factor: &str, part: &str, text: &str) -> Result<f64, Diagnostic> {
    match factor.parse::<f64>() {
        Ok(value) if value.is_finite() && value != 0.0 => Ok(value),
        _ => Err(malformed(
            "the factor must be a number other than 0",
            part,
            text,
        )),
    }
}

fn malformed(what: &str, part: &str, text: &str) -> Diagnostic {
    Diagnostic::new(what)
        .excerpt(text, {
            let from = text.find(part).unwrap_or(0);
            from..from + part.len()
        })
        .value(part)
        .remedy("write it like t=Time[ms]*1e-3,x=pos_mm*1e-3,f=-Fz")
}

impl ColumnMap {
    /// Finds the three columns in a header.
    pub(super) fn place(&self, header: &[String]) -> Result<[Placed; 3], Diagnostic> {
        let mut placed = [Placed {
            channel: Channel::Time,
            index: 0,
            factor: 1.0,
        }; 3];
        for (slot, channel) in Channel::ALL.into_iter().enumerate() {
            let mapped = &self.channels[slot];
            let mut hits = header
                .iter()
                .enumerate()
                .filter(|(_, name)| **name == mapped.name);
            let Some((index, _)) = hits.next() else {
                return Err(self.missing(channel, header));
            };
            if hits.next().is_some() {
                return Err(Diagnostic::new("two columns have the same name")
                    .in_column(&mapped.name)
                    .remedy("rename one of them in the header"));
            }
            placed[slot] = Placed {
                channel,
                index,
                factor: mapped.factor,
            };
        }
        Ok(placed)
    }

    fn missing(&self, channel: Channel, header: &[String]) -> Diagnostic {
        let wanted = &self.channels[channel as usize].name;
        let names = || {
            header
                .iter()
                .map(String::as_str)
                .filter(|name| !name.is_empty())
        };
        let mut diagnostic = Diagnostic::new(format!(
            "no column `{wanted}` for the {}",
            channel.quantity()
        ))
        .in_column(wanted)
        .note(format!("the columns are {}", listed(names())));
        if header.len() < Channel::ALL.len() {
            let advice = "the header must be the first line, with commas, semicolons or tabs; put # before lines above it";
            return diagnostic.remedy(advice);
        }
        if let Some(near) = nearest(wanted, names()) {
            diagnostic = diagnostic.note(format!("the nearest name is `{near}`"));
        }
        diagnostic.remedy(match suggestion(header) {
            Some(columns) => format!("name the columns, perhaps --columns '{columns}'"),
            None => "name the columns: --columns 't=NAME*FACTOR,x=NAME*FACTOR,f=NAME*FACTOR', \
                     the factors into s, m and N"
                .to_string(),
        })
    }
}

/// What `--columns` probably should be, from the words that other machines use.
fn suggestion(header: &[String]) -> Option<String> {
    let mut taken = Vec::new();
    let mut parts = Vec::new();
    for channel in Channel::ALL {
        let (index, name) = guess(channel, header, &taken)?;
        taken.push(index);
        let factor = unit_factor(channel, name).map_or(String::new(), |f| format!("*{f}"));
        parts.push(format!("{}={name}{factor}", channel.letter()));
    }
    Some(parts.join(","))
}

fn guess<'a>(channel: Channel, header: &'a [String], taken: &[usize]) -> Option<(usize, &'a str)> {
    let free = || {
        header
            .iter()
            .enumerate()
            .filter(|(index, _)| !taken.contains(index))
    };
    let exact = free().find(|(_, name)| *name == channel.column());
    let by_word = || {
        channel
            .usual_names()
            .iter()
            .find_map(|word| free().find(|(_, name)| name.to_lowercase().starts_with(word)))
    };
    exact
        .or_else(by_word)
        .map(|(index, name)| (index, name.as_str()))
}

fn unit_factor(channel: Channel, name: &str) -> Option<&'static str> {
    let name = name.to_lowercase();
    let last_word = name
        .split(|c: char| !c.is_alphanumeric())
        .rfind(|word| !word.is_empty())?;
    let units = channel.usual_units().iter();
    units
        .clone()
        .find(|(unit, _)| *unit == last_word)
        .map(|(_, factor)| *factor)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn header(names: &[&str]) -> Vec<String> {
        names.iter().map(|name| (*name).to_string()).collect()
    }

    #[test]
    fn names_may_hold_brackets_spaces_and_commas() {
        let map: ColumnMap = "t=Time [ms]*1e-3, x=pos, raw*1e-6,f=-Fz".parse().unwrap();
        let placed = map
            .place(&header(&["Fz", "Time [ms]", "pos, raw"]))
            .unwrap();
        let found = placed.map(|p| (p.index, p.factor));
        assert_eq!(found, [(1, 1e-3), (2, 1e-6), (0, -1.0)]);
    }

    #[test]
    fn channels_that_are_left_out_keep_their_column() {
        let map: ColumnMap = "f=-f_n".parse().unwrap();
        let placed = map.place(&header(&["t_s", "x_m", "f_n"])).unwrap();
        assert_eq!(placed.map(|p| p.factor), [1.0, 1.0, -1.0]);
    }

    #[test]
    fn what_is_not_a_map_is_refused_with_the_part_that_is_wrong() {
        for (text, value) in [
            ("q=Time", "q=Time"),
            ("t=Time*fast,x=x_m", "t=Time*fast"),
            ("t=Time*0", "t=Time*0"),
            ("x=-", "x=-"),
            ("t=a,t=b", "t=b"),
            ("", ""),
        ] {
            let error = text.parse::<ColumnMap>().unwrap_err();
            assert_eq!(error.value.as_deref(), Some(value), "{error}");
            assert!(error.remedy.is_some());
        }
    }

    #[test]
    fn a_missing_column_is_answered_with_the_columns_option_that_would_fit() {
        let names = header(&["Elapsed Time (s)", "Displacement (mm)", "Load [kN]", "Temp"]);
        let error = ColumnMap::default().place(&names).unwrap_err();
        let remedy = error.remedy.as_deref().unwrap();
        assert!(
            remedy.contains("'t=Elapsed Time (s),x=Displacement (mm)*1e-3,f=Load [kN]*1e3'"),
            "{remedy}"
        );
        assert!(error.notes[0].contains("`Temp`"));
    }

    #[test]
    fn a_misspelt_column_finds_its_neighbour() {
        let error = ColumnMap::default()
            .place(&header(&["t_s", "x_m", "fn"]))
            .unwrap_err();
        assert_eq!(error.field.as_deref(), Some("column f_n"));
        assert!(error.notes[1].contains("`fn`"), "{error}");
    }

    #[test]
    fn a_title_above_the_header_is_answered_with_what_to_do_about_it() {
        let error = ColumnMap::default()
            .place(&header(&["Results Table 1"]))
            .unwrap_err();
        assert!(
            error.remedy.as_deref().unwrap().contains("put # before"),
            "{error}"
        );
    }

    #[test]
    fn two_columns_of_one_name_are_refused() {
        let error = ColumnMap::default().place(&header(&["t_s", "x_m", "x_m", "f_n"]));
        assert!(error.unwrap_err().what.contains("same name"));
    }
}
