//! How a file was understood, in one sentence.

use super::problem::Table;
use crate::kind::Kind;
use crate::log::channel::{Channel, Origin};
use crate::log::orientation::Orientation;
use crate::log::record::{Log, ReadOptions};

/// The sentence; `None` for a log that is written as ours are.
pub(super) fn understood(
    table: &Table,
    encoding: Option<&str>,
    options: &ReadOptions,
    orientation: Orientation,
    logs: &[Log],
) -> Option<String> {
    let mut facts = Vec::new();
    let is_own = table
        .placed
        .iter()
        .flatten()
        .all(|placed| placed.origin == Origin::Own);
    if !is_own {
        let channels = Channel::ALL
            .into_iter()
            .filter_map(|channel| column(table, channel));
        facts.push(channels.collect::<Vec<_>>().join(", "));
    }
    if let Some(rate_hz) = options.rate_hz {
        facts.push(format!("sampled evenly at {rate_hz} Hz"));
    }
    facts.extend(signs(orientation).map(str::to_string));
    if logs.iter().any(|log| log.kind == Some(Kind::Rotary)) {
        facts.push("a machine that turns: angles in rad, torques in N m".into());
    }
    let preamble = table.preamble;
    if preamble.titles > 0 {
        facts.push(format!("the header in line {}", preamble.header_line));
    }
    if !preamble.units.is_empty() && preamble.units != preamble.names {
        facts.push(format!("units in line {}", preamble.data_line - 1));
    }
    if preamble.format.decimal_comma {
        facts.push("commas inside numbers read as decimal points".into());
    }
    if preamble.format.thousands {
        facts.push("separated thousands".into());
    }
    if let Some(encoding) = encoding {
        facts.push(format!("text in {encoding}"));
    }
    if logs.len() > 1 {
        facts.push(format!("{} recordings in the file", logs.len()));
    }
    (!facts.is_empty()).then(|| format!("read as: {}", facts.join("; ")))
}

fn column(table: &Table, channel: Channel) -> Option<String> {
    let placed = table.placed[channel as usize]?;
    let name = table.name(channel as usize);
    let unit = match placed.unit {
        Some(unit) => format!(" in {}", unit.symbol),
        None if placed.factor != 1.0 => format!(" × {}", placed.factor),
        None => String::new(),
    };
    Some(format!("{} from `{name}`{unit}", channel.noun()))
}

fn signs(orientation: Orientation) -> Option<&'static str> {
    match orientation {
        Orientation::AsIs | Orientation::One => None,
        Orientation::Both => {
            Some("both signs reversed, since the file counts compression as negative")
        }
        Orientation::Position => {
            Some("the sign of the position reversed, so that it grows into the material")
        }
        Orientation::Force => {
            Some("the sign of the force reversed, so that it pushes the probe out")
        }
    }
}
