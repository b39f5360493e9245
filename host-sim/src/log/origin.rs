//! The columns that a log was read from, and how `--columns` asks for them in another unit or with another sign.

use super::channel::{Channel, Header, Origin, Placed};
use super::guess;
use super::units::{self, Quantity, Unit};
use crate::kind::Kind;

/// The column of one channel.
#[derive(Clone, Debug, PartialEq)]
struct Column {
    /// As `--columns` names it.
    name: String,
    is_reversed: bool,
    /// What makes its numbers SI, without the sign.
    factor: f64,
    /// The unit that the file says it has; `None` where nothing does or a factor was given instead.
    unit: Option<Unit>,
    is_named: bool,
}

/// The columns of the three channels; time has none where the rate was given.
#[derive(Clone, Debug, PartialEq)]
pub struct SourceColumns {
    columns: [Option<Column>; 3],
    /// Whether a sign was turned because of what the channels show, which naming a column ends.
    is_turned: bool,
}

impl SourceColumns {
    /// Those of a log in memory, or of our own names.
    pub(crate) fn own(kind: Kind) -> SourceColumns {
        let column = |channel: Channel| Column {
            name: channel.column_of(kind).into(),
            is_reversed: false,
            factor: 1.0,
            unit: units::own(channel.column_of(kind)),
            is_named: false,
        };
        SourceColumns {
            columns: Channel::ALL.map(|channel| Some(column(channel))),
            is_turned: false,
        }
    }

    /// Those of a file; `None` if they are those of our own logs.
    pub(super) fn of(header: Header, placed: &[Option<Placed>; 3]) -> Option<SourceColumns> {
        let mut all = placed.iter().flatten();
        if all.all(|placed| placed.origin == Origin::Own) {
            return None;
        }
        let column = |placed: Placed| Column {
            name: guess::called(header, placed.index),
            is_reversed: placed.factor < 0.0,
            factor: placed.factor.abs(),
            unit: placed.unit,
            is_named: placed.origin == Origin::Named,
        };
        Some(SourceColumns {
            columns: placed.map(|placed| placed.map(column)),
            is_turned: false,
        })
    }

    /// Turns the sign of a channel, which the reader has done.
    pub(super) fn turn(&mut self, channel: Channel) {
        self.is_turned = true;
        if let Some(column) = &mut self.columns[channel as usize] {
            column.is_reversed = !column.is_reversed;
        }
    }

    /// The name of a channel's column.
    pub(crate) fn name(&self, channel: Channel) -> &str {
        self.columns[channel as usize]
            .as_ref()
            .map_or("", |column| &column.name)
    }

    /// Whether the file says that a channel is in radians.
    pub(crate) fn is_in_radians(&self) -> bool {
        let unit = |column: &Column| column.unit;
        let unit = self.columns[Channel::Position as usize]
            .as_ref()
            .and_then(unit);
        unit.is_some_and(|unit| unit.quantity == Quantity::Angle && unit.symbol == "rad")
    }

    /// Whether a person has given a channel's factor: a wrong one is theirs.
    pub(crate) fn has_given_factor(&self, channel: Channel) -> bool {
        let column = self.columns[channel as usize].as_ref();
        column.is_some_and(|own| own.is_named && own.unit.is_none() && own.factor != 1.0)
    }

    /// Whether nothing says the unit of a channel that was named.
    pub(crate) fn has_no_unit(&self, channel: Channel) -> bool {
        let column = self.columns[channel as usize].as_ref();
        column.is_some_and(|own| own.is_named && own.unit.is_none())
    }

    /// `--columns` with some channels times a factor (−1 turns the sign), and the others as they are read now.
    pub(crate) fn option(&self, changes: &[(Channel, f64)]) -> String {
        let change = |channel: Channel| {
            let mut changes = changes.iter();
            changes
                .find(|(of, _)| *of == channel)
                .map(|(_, factor)| *factor)
        };
        // A sign that the reader turned must be said where any sign is: nothing is turned then.
        let says_a_sign = Channel::ALL[1..]
            .iter()
            .any(|channel| change(*channel).is_some());
        let part = |channel: Channel| {
            let column = self.columns[channel as usize].as_ref()?;
            let own = channel != Channel::Time && says_a_sign && self.is_turned;
            (change(channel).is_some() || column.is_named || own).then(|| {
                let text = column.text(change(channel).unwrap_or(1.0));
                format!("{}={text}", channel.letter())
            })
        };
        let parts: Vec<String> = Channel::ALL.into_iter().filter_map(part).collect();
        option(&parts.join(","))
    }

    /// `--columns` with position and force in each other's column.
    pub(crate) fn exchanged(&self) -> String {
        let (x, f) = (self.name(Channel::Position), self.name(Channel::Force));
        option(&format!("x={f},f={x}"))
    }
}

impl Column {
    /// The column times a factor.
    fn text(&self, times: f64) -> String {
        let sign = match self.is_reversed != (times < 0.0) {
            true => "-",
            false => "",
        };
        // Without a factor the unit in the header counts.
        let factor = match (times.abs() == 1.0, self.unit) {
            (true, Some(_)) => 1.0,
            _ => self.factor * times.abs(),
        };
        match factor == 1.0 {
            true => format!("{sign}{}", self.name),
            false => format!("{sign}{}*{}", self.name, factor_text(factor)),
        }
    }
}

/// A factor as a person writes it: `1e-3`, `0.0254`; 1e-3 times 1e-3 without the error of the product.
fn factor_text(factor: f64) -> String {
    let rounded: f64 = format!("{factor:.11e}").parse().unwrap_or(factor);
    match (0.01..1e4).contains(&rounded) {
        true => rounded.to_string(),
        false => format!("{rounded:e}"),
    }
}

/// The option, in quotes where a shell would split or change it.
fn option(columns: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "_=,.-*".contains(c);
    match columns.chars().all(is_plain) {
        true => format!("--columns {columns}"),
        false => format!("--columns '{columns}'"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn columns(names: &[&str], asked: &str) -> SourceColumns {
        let names: Vec<String> = names.iter().map(|name| (*name).to_string()).collect();
        let header = Header {
            names: &names,
            units: &[],
            sample: &[],
        };
        let map: crate::log::ColumnMap = match asked {
            "" => crate::log::ColumnMap::default(),
            text => text.parse().unwrap(),
        };
        SourceColumns::of(header, &map.place(header, true).unwrap()).unwrap()
    }

    #[test]
    fn a_remedy_names_the_columns_of_the_file_and_keeps_what_was_asked_for() {
        let given = columns(&["time", "position", "force"], "t=time,x=position,f=force");
        assert_eq!(
            given.option(&[(Channel::Position, 1e-3)]),
            "--columns t=time,x=position*1e-3,f=force"
        );
        let extras = columns(&["t_s", "x_m", "f_n", "x_mm"], "x=x_mm");
        assert_eq!(
            extras.option(&[(Channel::Force, -1.0)]),
            "--columns x=x_mm,f=-f_n"
        );
        let twice = columns(&["t_s", "x (mm)", "f_n"], "x=-x (mm)*1e-3");
        assert_eq!(
            twice.option(&[(Channel::Position, -1e-3)]),
            "--columns 'x=x (mm)*1e-6'"
        );
    }

    #[test]
    fn a_sign_that_was_turned_is_said_beside_the_one_that_is_asked_for() {
        let mut found = columns(&["Time (s)", "Travel (mm)", "Load (N)"], "");
        found.turn(Channel::Position);
        assert_eq!(
            found.option(&[(Channel::Force, -1.0)]),
            "--columns 'x=-Travel (mm),f=-Load (N)'"
        );
    }
}
