//! Which columns hold time, position and force, with which sign and in which unit.

use std::str::FromStr;

use super::channel::Channel;
use super::channel::{Header, Origin, Placed};
use super::guess;
use super::question;
use super::units::{self, Quantity};
use crate::diagnostic::Diagnostic;
use crate::kind::Kind;

/// A column that was named, and what turns its numbers into SI.
#[derive(Clone, Debug, PartialEq)]
struct Mapped {
    name: String,
    is_reversed: bool,
    /// `None`: the unit in the header decides.
    factor: Option<f64>,
}

impl Mapped {
    fn placed(&self, channel: Channel, header: Header, index: usize) -> Placed {
        let unit = match self.factor {
            Some(_) => None,
            None => guess::unit(channel, header, index),
        };
        let factor = self.factor.or(unit.map(|unit| unit.factor)).unwrap_or(1.0);
        Placed {
            index,
            factor: if self.is_reversed { -factor } else { factor },
            unit,
            origin: Origin::Named,
        }
    }
}

/// The columns of the three channels, where they are named; the others are found by their names and units.
///
/// Written as `t=Time[ms]*1e-3,x=pos_mm*1e-3,f=-Fz`: a letter, a column's name as it stands in the
/// header (or its number, from 1), a sign before it, a factor after it. Without a factor the unit in the header
/// counts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ColumnMap {
    channels: [Option<Mapped>; 3],
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
            map.channels[slot] = Some(mapped);
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
    let (mut signed, mut factor) = match column.rsplit_once('*') {
        None => (column, None),
        Some((name, factor)) => (name.trim(), Some(parse_factor(factor.trim(), part, text)?)),
    };
    // A product: a unit and a spring constant, `Deflection (nm)*1e-9*0.2`.
    while let (Some(behind), Some((name, more))) = (factor, signed.rsplit_once('*'))
        && let Ok(more) = more.trim().parse::<f64>()
        && more.is_finite()
        && more != 0.0
    {
        (signed, factor) = (name.trim(), Some(behind * more));
    }
    let (name, is_reversed) = match signed.strip_prefix('-') {
        Some(name) => (name.trim(), true),
        None => (signed, false),
    };
    if name.is_empty() {
        return Err(malformed("no column is named", part, text));
    }
    let name = name.to_string();
    Ok((
        slot,
        Mapped {
            name,
            is_reversed,
            factor,
        },
    ))
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
    /// Whether any of these names was asked for.
    pub(super) fn names_any_of(&self, names: &[String]) -> bool {
        self.channels
            .iter()
            .flatten()
            .any(|mapped| names.contains(&mapped.name))
    }

    /// Whether a header holds every name that was asked for, or all those of our own logs.
    pub(super) fn are_in(&self, header: &[String]) -> bool {
        let is_in = |name: &str| header.iter().any(|cell| cell == name);
        let mut named = self.channels.iter().flatten().peekable();
        match named.peek() {
            Some(_) => header.len() > 1 && named.all(|mapped| is_in(&mapped.name)),
            None => Channel::ALL
                .iter()
                .all(|channel| is_in(channel.column()) || is_in(channel.rotary_column())),
        }
    }

    /// Whether position or force was named, and so its sign was said.
    pub(super) fn orients(&self) -> bool {
        self.channels[1..].iter().any(Option::is_some)
    }

    /// Finds the columns in a header. Without a column of time, `is_timed` must not ask for one.
    pub(super) fn place(
        &self,
        header: Header,
        is_timed: bool,
    ) -> Result<[Option<Placed>; 3], Diagnostic> {
        let is_wanted = |channel: Channel| is_timed || channel != Channel::Time;
        let mut named = Channel::ALL.map(|channel| match is_wanted(channel) {
            true => self.named(channel, header),
            false => Ok(None),
        });
        let mut taken: Vec<usize> = Vec::new();
        taken.extend(named.iter().flatten().flatten().map(|placed| placed.index));
        let mut placed: [Option<Placed>; 3] = [None; 3];
        for channel in Channel::ALL
            .into_iter()
            .filter(|channel| is_wanted(*channel))
        {
            let slot = channel as usize;
            let named = std::mem::replace(&mut named[slot], Ok(None))?;
            placed[slot] = match named {
                Some(named) => Some(named),
                None => {
                    let guess = guess::guess(channel, header, &taken);
                    Some(guess.map_err(|why| question::of(channel, header, &why))?)
                }
            };
            taken.extend(placed[slot].map(|placed| placed.index));
        }
        one_machine(&placed, header)?;
        Ok(placed)
    }

    /// The column that was named, or that has the name of our own logs.
    fn named(&self, channel: Channel, header: Header) -> Result<Option<Placed>, Diagnostic> {
        let mapped = self.channels[channel as usize].as_ref();
        let rotary = channel.rotary_column();
        let own = match header.names.iter().any(|name| name == rotary) {
            true => rotary,
            false => channel.column(),
        };
        let name = mapped.map_or(own, |mapped| mapped.name.as_str());
        let mut hits = (0..header.names.len()).filter(|index| header.names[*index] == name);
        let Some(index) = hits.next() else {
            return match mapped {
                Some(mapped) => question::number(&mapped.name, header)
                    .map(|index| Some(mapped.placed(channel, header, index)))
                    .ok_or_else(|| question::missing(channel, header, Some(&mapped.name))),
                None => Ok(None),
            };
        };
        if hits.next().is_some() {
            return Err(question::same_name(channel, name, index));
        }
        let Some(mapped) = mapped else {
            return Ok(Some(Placed {
                index,
                factor: 1.0,
                unit: units::own(name),
                origin: Origin::Own,
            }));
        };
        Ok(Some(mapped.placed(channel, header, index)))
    }
}

/// Whether the machine turns, as the units of position and force say; `None` if neither is known.
pub(super) fn kind_of(placed: &[Option<Placed>; 3]) -> Option<Kind> {
    let unit = |channel: Channel| placed[channel as usize].and_then(|placed| placed.unit);
    let quantities = [Channel::Position, Channel::Force]
        .into_iter()
        .filter_map(unit)
        .map(|unit| unit.quantity);
    let mut kinds = quantities.filter_map(|quantity| match quantity {
        Quantity::Angle | Quantity::Torque => Some(Kind::Rotary),
        Quantity::Length | Quantity::Force => Some(Kind::Linear),
        _ => None,
    });
    kinds.next()
}

/// Radians and newtons, or metres and newton metres, are a mistake.
fn one_machine(placed: &[Option<Placed>; 3], header: Header) -> Result<(), Diagnostic> {
    let unit = |channel: Channel| placed[channel as usize].and_then(|placed| placed.unit);
    let (Some(position), Some(force)) = (unit(Channel::Position), unit(Channel::Force)) else {
        return Ok(());
    };
    let is_angle = position.quantity == Quantity::Angle;
    let is_torque = force.quantity == Quantity::Torque;
    if is_angle == is_torque {
        return Ok(());
    }
    let name = |channel: Channel| {
        let index = placed[channel as usize].map_or(0, |placed| placed.index);
        header.names.get(index).map_or("", String::as_str)
    };
    Err(Diagnostic::new(format!(
        "a position in {} and a force in {} do not belong to one machine",
        position.symbol, force.symbol
    ))
    .in_column(name(Channel::Force))
    .note(format!(
        "they are `{}` and `{}`",
        name(Channel::Position),
        name(Channel::Force)
    ))
    .remedy("name two columns that do, rad and N m or m and N: --columns 'x=NAME,f=NAME'"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn placed(columns: &str, names: &[&str]) -> Result<[(usize, f64); 3], Diagnostic> {
        let map = match columns {
            "" => ColumnMap::default(),
            text => text.parse().unwrap(),
        };
        let names: Vec<String> = names.iter().map(|name| (*name).to_string()).collect();
        let header = Header {
            names: &names,
            units: &[],
            sample: &[],
        };
        let placed = map.place(header, true)?;
        Ok(placed.map(|placed| placed.map_or((99, 0.0), |p| (p.index, p.factor))))
    }

    #[test]
    fn names_may_hold_brackets_spaces_and_commas() {
        let columns = "t=Time [ms]*1e-3, x=pos, raw*1e-6,f=-Fz";
        let found = placed(columns, &["Fz", "Time [ms]", "pos, raw"]).unwrap();
        assert_eq!(found, [(1, 1e-3), (2, 1e-6), (0, -1.0)]);
    }

    #[test]
    fn channels_that_are_left_out_keep_their_column() {
        let found = placed("f=-f_n", &["t_s", "x_m", "f_n"]).unwrap();
        assert_eq!(found, [(0, 1.0), (1, 1.0), (2, -1.0)]);
    }

    #[test]
    fn a_unit_in_the_header_counts_unless_a_factor_is_given() {
        let names = ["Time (ms)", "Extension (mm)", "Position (mm)", "Load (N)"];
        let found = placed("x=-Extension (mm)", &names).unwrap();
        assert_eq!(found, [(0, 1e-3), (1, -1e-3), (3, 1.0)]);
        let given = placed("x=Extension (mm)*2", &names).unwrap();
        assert_eq!(given[1], (1, 2.0));
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
    fn a_column_without_a_unit_is_answered_with_the_columns_option_that_would_fit() {
        let names = ["Elapsed Time (s)", "Displacement (mm)", "Load", "Temp"];
        let error = placed("", &names).unwrap_err();
        let remedy = error.remedy.as_deref().unwrap();
        assert!(
            remedy.contains("'t=Elapsed Time (s),x=Displacement (mm)*1e-3,f=Load'"),
            "{remedy}"
        );
        assert!(error.notes[0].contains("`Temp`"));
        assert!(error.notes[1].contains("its unit is not said"), "{error}");
    }

    #[test]
    fn two_columns_that_fit_are_a_question_with_its_flags() {
        let names = ["Time (s)", "Extension (mm)", "Position (mm)", "Load (N)"];
        let error = placed("", &names).unwrap_err();
        let remedy = error.remedy.as_deref().unwrap();
        let wanted = "--columns 'x=Extension (mm)' or --columns 'x=Position (mm)'";
        assert!(remedy.contains(wanted), "{remedy}");
    }

    #[test]
    fn a_position_without_a_unit_is_asked_for_in_both_units() {
        let error = placed("", &["time", "position", "force"]).unwrap_err();
        let remedy = error.remedy.as_deref().unwrap();
        for wanted in [
            "--columns 't=time,x=position,f=force' if it is in metres",
            "--columns 't=time,x=position*1e-3,f=force' if it is in millimetres",
        ] {
            assert!(remedy.contains(wanted), "{remedy}");
        }
        let unknown = placed("", &["Time (s)", "Travel (mm)", "Load (furlongs)"]).unwrap_err();
        let remedy = unknown.remedy.as_deref().unwrap();
        assert!(remedy.contains("f=Load (furlongs)*FACTOR"), "{remedy}");
        assert!(
            unknown.to_string().contains("no unit that is known"),
            "{unknown}"
        );
    }

    #[test]
    fn a_cantilevers_deflection_is_a_length_and_needs_its_spring_constant() {
        let names = ["Time (s)", "Height (nm)", "Deflection (nm)"];
        let remedy = placed("", &names).unwrap_err().remedy.clone().unwrap();
        let wanted = "--columns 'f=Deflection (nm)*1e-9*K'";
        assert!(remedy.contains(wanted), "{remedy}");
        let found = placed("f=Deflection (nm)*1e-9*0.25", &names).unwrap();
        assert_eq!(found, [(0, 1.0), (1, 1e-9), (2, 0.25e-9)]);
        // Beside a force it is none.
        let names = [
            "Time (s)",
            "Piezo height (um)",
            "Deflection (nm)",
            "Force (nN)",
        ];
        assert_eq!(placed("", &names).unwrap()[2], (3, 1e-9));
    }

    #[test]
    fn an_extensometer_is_nearer_the_tip_than_the_crosshead() {
        let names = [
            "Time (s)",
            "Crosshead (mm)",
            "Extensometer (mm)",
            "Load (N)",
        ];
        assert_eq!(placed("", &names).unwrap()[1].0, 2);
    }

    #[test]
    fn a_misspelt_column_finds_its_neighbour() {
        let error = placed("", &["t_s", "x_m", "fn"]).unwrap_err();
        assert_eq!(error.field.as_deref(), Some("column f_n"));
        assert!(error.notes[1].contains("`fn`"), "{error}");
    }

    #[test]
    fn two_columns_of_one_name_are_refused() {
        let error = placed("", &["t_s", "x_m", "x_m", "f_n"]).unwrap_err();
        assert!(error.what.contains("same name"));
    }

    #[test]
    fn a_rig_that_turns_is_read_and_half_of_one_is_refused() {
        let rotary = placed("", &["t_s", "x_rad", "f_nm"]).unwrap();
        assert_eq!(rotary, [(0, 1.0), (1, 1.0), (2, 1.0)]);
        let degrees = placed("", &["Time (s)", "Angle (deg)", "Torque (mNm)"]).unwrap();
        assert!((degrees[1].1 - 1f64.to_radians()).abs() < 1e-15 && degrees[2].1 == 1e-3);
        let half = placed("", &["Time (s)", "Angle (deg)", "Force (N)"]).unwrap_err();
        assert!(half.what.contains("do not belong to one machine"), "{half}");
    }
}
