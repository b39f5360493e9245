//! What is asked where the column of a channel is missing or not certain, with the flag that answers it.

use super::channel::{Channel, Header};
use super::guess::{self, Suggestion, Unclear};
use super::names;
use super::units;
use crate::diagnostic::{Diagnostic, listed, nearest};

/// The question for a channel whose column could not be guessed.
pub(super) fn of(channel: Channel, header: Header, why: &Unclear) -> Diagnostic {
    match why {
        Unclear::Nothing => missing(channel, header, None),
        Unclear::Unit(index) => unit_missing(channel, header, *index),
        Unclear::Several(indices) => several(channel, header, indices),
    }
}

/// The column that a number in `--columns` means, from 0, in a header where no column has that name.
pub(super) fn number(text: &str, header: Header) -> Option<usize> {
    let number: usize = text.parse().ok()?;
    number
        .checked_sub(1)
        .filter(|index| *index < header.names.len())
}

/// Two columns have the name that was asked for.
pub(super) fn same_name(channel: Channel, name: &str, index: usize) -> Diagnostic {
    Diagnostic::new("two columns have the same name")
        .in_column(name)
        .remedy(format!(
            "give the number of the column, such as --columns '{}={}', or rename one of them",
            channel.letter(),
            index + 1
        ))
}

/// No column has the name that was asked for, or none was and none fits.
pub(super) fn missing(channel: Channel, header: Header, asked: Option<&str>) -> Diagnostic {
    let wanted = asked.unwrap_or(channel.column());
    let names = || {
        let names = header.names.iter().map(String::as_str);
        names.filter(|name| !name.is_empty())
    };
    let mut diagnostic = Diagnostic::new(format!(
        "no column `{wanted}` for the {}",
        channel.quantity()
    ))
    .in_column(wanted)
    .note(format!("the columns are {}", listed(names())));
    if let Some(near) = nearest(wanted, names()) {
        diagnostic = diagnostic.note(format!("the nearest name is `{near}`"));
    }
    if asked.is_none() {
        for note in hints(channel, header) {
            diagnostic = diagnostic.note(note);
        }
    }
    diagnostic.remedy(remedy(channel, header, asked))
}

fn remedy(channel: Channel, header: Header, asked: Option<&str>) -> String {
    let suggestion = guess::suggestion(header);
    let is_timeless = channel == Channel::Time && asked.is_none();
    if channel == Channel::Force
        && asked.is_none()
        && let Some((index, unit)) = guess::bent(header)
    {
        let factor = match unit.factor_text {
            "" => String::new(),
            factor => format!("*{factor}"),
        };
        return format!(
            "give the spring constant K of the cantilever in N/m, as a number: --columns 'f={}{factor}*K'",
            guess::called(header, index)
        );
    }
    match suggestion {
        Some(Suggestion { as_si, .. }) if is_timeless && !as_si.contains("t=") => format!(
            "if the file has no time, give its samples per second: --rate HZ; if a column holds the time, name it: \
             --columns 't=NAME*FACTOR,{as_si}'"
        ),
        Some(Suggestion {
            as_si,
            as_usual: Some(as_usual),
            ..
        }) => format!(
            "say in which unit the position is: --columns '{as_si}' if it is in metres, --columns '{as_usual}' if it is \
             in millimetres; a factor that is wrong by 1000 makes the stiffness wrong by 1000"
        ),
        Some(Suggestion { as_si, unsure, .. }) => format!(
            "name the columns, perhaps --columns '{as_si}'{}",
            match unsure.first() {
                Some(channel) if !as_si.contains("*FACTOR") => format!(
                    " if the {} is in {}; behind another unit a factor is needed",
                    channel.noun(),
                    unit_of(*channel)
                ),
                Some(_) => ", with FACTOR what makes its unit SI".into(),
                None => String::new(),
            }
        ),
        None => "name the columns: --columns 't=NAME*FACTOR,x=NAME*FACTOR,f=NAME*FACTOR', \
                 the factors into s, m and N"
            .to_string(),
    }
}

/// Columns that are near what is wanted, and what is in the way.
fn hints(channel: Channel, header: Header) -> Vec<String> {
    let mut hints = Vec::new();
    if let Some((index, cell)) = guess::text_in(channel, header) {
        hints.push(format!(
            "`{}` holds text, such as `{cell}`: its cells must be numbers, and the unit must stand in the header",
            header.names[index]
        ));
    }
    if let Some(index) = guess::in_other_units(channel, header) {
        let name = &header.names[index];
        let letter = channel.letter();
        let (noun, unit) = (channel.noun(), unit_of(channel));
        let factor = match (names::is_relative(channel, name), channel) {
            (true, Channel::Force) => {
                "FACTOR is the area under the probe in m², times 1e6 if the stress is in MPa"
            }
            (true, _) => {
                "FACTOR is the height of the sample in m, divided by 100 if the strain is in %"
            }
            (_, Channel::Force) if names::is_deflection(name) => {
                "a cantilever's deflection is no force until it is multiplied by its spring constant"
            }
            _ => "FACTOR is what one of its units is worth",
        };
        hints.push(format!(
            "`{name}` is not in a unit of {noun}; if it holds the {noun}, a factor must turn it into {unit}: \
             --columns '{letter}={name}*FACTOR'; {factor}"
        ));
    }
    hints
}

fn unit_of(channel: Channel) -> &'static str {
    match channel {
        Channel::Time => "s",
        Channel::Position => "m",
        Channel::Force => "N",
    }
}

fn unit_missing(channel: Channel, header: Header, index: usize) -> Diagnostic {
    let name = &header.names[index];
    let examples = match channel {
        Channel::Time => "*1e-3 if it is in ms, nothing if in s",
        Channel::Position => "*1e-3 if it is in mm, *1e-6 if in µm, nothing if in m",
        Channel::Force => "*1e3 if it is in kN, *1e-3 if in mN, nothing if in N",
    };
    let why = match units::unknown(name) {
        Some(unit) => format!(
            "`{unit}` is no unit that is known here: its factor into {} is needed",
            unit_of(channel)
        ),
        None => "its unit is not said".into(),
    };
    missing(channel, header, None)
        .note(format!(
            "`{name}` may hold the {}, but {why}",
            channel.noun()
        ))
        .note(format!("in --columns, {examples}"))
}

/// Several columns may be the channel.
fn several(channel: Channel, header: Header, indices: &[usize]) -> Diagnostic {
    let names = || indices.iter().map(|index| header.names[*index].as_str());
    let first = names().next().unwrap_or_default();
    let diagnostic = Diagnostic::new(format!(
        "more than one column may hold the {}",
        channel.noun()
    ))
    .in_column(first);
    // Recordings side by side have one header each, with the same names.
    if indices.len() > 1
        && names().all(|name| name == first)
        && let Some(Suggestion { as_si: columns, .. }) = guess::suggestion(header)
    {
        let numbers: Vec<String> = indices
            .iter()
            .map(|index| (index + 1).to_string())
            .collect();
        return diagnostic
            .note(format!(
                "the columns {} are all called `{first}`: recordings side by side?",
                numbers.join(", ")
            ))
            .remedy(format!(
                "give the numbers of the columns, one recording at a time: --columns '{columns}' for the first"
            ));
    }
    let letter = channel.letter();
    let flags = names().map(|name| format!("--columns '{letter}={name}'"));
    let flags: Vec<String> = flags.take(3).collect();
    diagnostic
        .note(format!("they are {}", listed(names())))
        .remedy(format!("say which: {}", flags.join(" or ")))
}
