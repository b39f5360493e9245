//! Units as the headers of machines write them, and what makes them SI.

/// What a unit measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Quantity {
    Time,
    Length,
    Angle,
    Force,
    Torque,
    /// Anything else: a speed, a temperature, a voltage.
    Other,
}

/// A unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Unit {
    /// As it is written in sentences.
    pub(super) symbol: &'static str,
    pub(super) quantity: Quantity,
    /// What makes it SI, as a number and as `--columns` takes it; empty for 1.
    pub(super) factor: f64,
    pub(super) factor_text: &'static str,
}

const fn unit(
    symbol: &'static str,
    quantity: Quantity,
    factor: f64,
    factor_text: &'static str,
) -> Unit {
    Unit {
        symbol,
        quantity,
        factor,
        factor_text,
    }
}

use Quantity::{Angle, Force, Length, Other, Time, Torque};

/// Every unit with the ways it is written. Capitals count only where the table has two of a letter:
/// mN and MN.
#[rustfmt::skip]
const UNITS: &[(Unit, &[&str])] = &[
    (unit("s", Time, 1.0, ""), &["s", "sec", "secs", "second", "seconds", "sek", "sekunden", "seg", "segundos", "secondes"]),
    (unit("ms", Time, 1e-3, "1e-3"), &["ms", "msec", "millisecond", "milliseconds", "millis", "millisekunden"]),
    (unit("µs", Time, 1e-6, "1e-6"), &["us", "µs", "usec", "microsecond", "microseconds", "micros"]),
    (unit("ns", Time, 1e-9, "1e-9"), &["ns", "nsec", "nanosecond", "nanoseconds"]),
    (unit("min", Time, 60.0, "60"), &["min", "minutes", "minuten"]),
    (unit("h", Time, 3600.0, "3600"), &["h", "hours"]),
    (unit("m", Length, 1.0, ""), &["m", "meter", "meters", "metre", "metres"]),
    (unit("cm", Length, 1e-2, "1e-2"), &["cm"]),
    (unit("mm", Length, 1e-3, "1e-3"), &["mm", "millimeter", "millimetre", "millimeters"]),
    (unit("µm", Length, 1e-6, "1e-6"), &["um", "µm", "micron", "microns", "micrometer", "micrometers", "micrometre"]),
    (unit("nm", Length, 1e-9, "1e-9"), &["nm", "nanometer", "nanometers"]),
    (unit("in", Length, 0.0254, "0.0254"), &["in", "inch", "inches", "\""]),
    (unit("rad", Angle, 1.0, ""), &["rad", "radian", "radians"]),
    (unit("mrad", Angle, 1e-3, "1e-3"), &["mrad"]),
    (unit("°", Angle, std::f64::consts::PI / 180.0, "0.017453292519943295"), &["deg", "°", "degree", "degrees", "grad"]),
    (unit("N", Force, 1.0, ""), &["n", "newton", "newtons"]),
    (unit("kN", Force, 1e3, "1e3"), &["kn", "kilonewton"]),
    (unit("MN", Force, 1e6, "1e6"), &["MN"]),
    (unit("cN", Force, 1e-2, "1e-2"), &["cn"]),
    (unit("daN", Force, 10.0, "10"), &["dan"]),
    (unit("mN", Force, 1e-3, "1e-3"), &["mn", "millinewton"]),
    (unit("µN", Force, 1e-6, "1e-6"), &["un", "µn"]),
    (unit("nN", Force, 1e-9, "1e-9"), &["nn"]),
    (unit("pN", Force, 1e-12, "1e-12"), &["pn"]),
    (unit("gf", Force, 9.80665e-3, "9.80665e-3"), &["gf", "g", "gram", "grams", "gramm"]),
    (unit("kgf", Force, 9.80665, "9.80665"), &["kgf", "kg", "kp"]),
    (unit("ozf", Force, 0.278_013_85, "0.27801385"), &["ozf", "oz", "ounce", "ounces"]),
    (unit("lbf", Force, 4.448_221_6, "4.4482216"), &["lbf", "lb", "lbs", "pound", "pounds"]),
    (unit("N m", Torque, 1.0, ""), &["nm", "n m", "n·m", "n*m", "n.m", "n-m"]),
    (unit("mN m", Torque, 1e-3, "1e-3"), &["mnm", "mn m", "mn·m", "mn*m", "mn.m", "mn-m"]),
    (unit("N cm", Torque, 1e-2, "1e-2"), &["ncm", "n cm", "n·cm"]),
    (unit("N mm", Torque, 1e-3, "1e-3"), &["nmm", "n mm", "n·mm"]),
    (unit("kN m", Torque, 1e3, "1e3"), &["knm", "kn m", "kn·m"]),
    (unit("-", Other, 1.0, ""), &["-", "–", "1", "%", "°c", "c", "k", "v", "mv", "a", "ma", "mpa", "kpa", "pa", "gpa", "bar",
        "mm/s", "mm/min", "m/s", "µm/s", "um/s", "nm/s", "n/mm", "n/m", "n/s", "kn/mm", "mm/mm", "n/mm²", "n/mm2", "hz", "rpm",
        "j", "mj", "nmm²", "mm²", "mm2", "rad/s", "deg/s", "°/s", "m/s²", "m/s2", "cycles", "segments", "counts", "bit", "lsb", "db", "w"]),
];

/// The unit that a text is, with or without brackets: `(kN)`, `[mm]`, `sec`. `Nm` is a torque and `nm`
/// a length.
pub(super) fn parse(text: &str) -> Option<Unit> {
    let text = unbracketed(text);
    let text = text.replace('\u{3bc}', "µ");
    match text.as_str() {
        "Nm" => return Some(torque()),
        "mNm" | "mN m" => return by_name("mnm"),
        "MN" => return by_name("MN"),
        "S" => return by_name("s"),
        _ => {}
    }
    by_name(&text.to_lowercase())
}

/// 1 N m.
pub(super) fn torque() -> Unit {
    unit("N m", Torque, 1.0, "")
}

/// The unit of a column with a name of our own logs.
pub(super) fn own(name: &str) -> Option<Unit> {
    match name {
        "t_s" => by_name("s"),
        "x_m" => by_name("m"),
        "f_n" => by_name("n"),
        "x_rad" => by_name("rad"),
        "f_nm" => Some(torque()),
        _ => None,
    }
}

fn by_name(name: &str) -> Option<Unit> {
    // `nm` in small letters stands among torques, too: the length comes first in the table.
    let found = UNITS.iter().find(|(_, names)| names.contains(&name));
    found.map(|(unit, _)| *unit)
}

/// The text without blanks and one pair of brackets around it.
pub(super) fn unbracketed(text: &str) -> &str {
    let text = text.trim();
    let pairs = [('(', ')'), ('[', ']'), ('<', '>'), ('{', '}')];
    let inside = pairs.into_iter().find_map(|(open, close)| {
        text.strip_prefix(open)
            .and_then(|rest| rest.strip_suffix(close))
    });
    inside.map_or(text, str::trim)
}

/// Splits `Load (kN)`, `Standardweg [mm]`, `Weg / mm`, `pos_mm`, `Time, s` into a name and a unit. A unit that
/// nobody knows, in brackets, is of another quantity.
pub(super) fn split(header: &str) -> (&str, Option<Unit>) {
    let text = header.trim();
    if let Some((name, inside)) = last_bracket(text) {
        if let Some(unit) = parse(inside) {
            return (name.trim(), Some(unit));
        }
        // Brackets around a remark: `Load (raw)`. With a slash or a percent it is a unit of something else.
        let other = inside
            .contains(['/', '%', '²', '^'])
            .then(|| unit("?", Other, 1.0, ""));
        return (if other.is_some() { name.trim() } else { text }, other);
    }
    let separated = text.rfind(['_', '/', ',', ' ', '.', '-']);
    let Some((at, length)) = separated.map(|at| (at, 1)) else {
        return (
            text,
            parse(text).filter(|unit| unit.quantity == Time && text.len() > 1),
        );
    };
    let (name, last) = (&text[..at], &text[at + length..]);
    let name = name.trim_end_matches(['_', '/', ',', ' ']);
    let name = name.strip_suffix(" in").unwrap_or(name);
    match parse(last) {
        Some(unit) if unit.quantity != Other && !name.is_empty() => (name, Some(unit)),
        _ => (text, None),
    }
}

/// What stands in brackets behind a name and is no unit that is known here: `foo` of `Load (foo)`.
pub(super) fn unknown(header: &str) -> Option<&str> {
    let (_, inside) = last_bracket(header.trim())?;
    (parse(inside).is_none() && !inside.is_empty()).then_some(inside)
}

/// What stands before the last pair of brackets, and what in it.
fn last_bracket(text: &str) -> Option<(&str, &str)> {
    let (open, close) = match text.chars().last()? {
        ')' => ('(', ')'),
        ']' => ('[', ']'),
        '>' => ('<', '>'),
        '}' => ('{', '}'),
        _ => return None,
    };
    let from = text.rfind(open)?;
    Some((
        &text[..from],
        text[from + 1..].trim_end_matches(close).trim(),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_unit_is_found_however_a_header_writes_it() {
        for (header, name, symbol) in [
            ("Load (kN)", "Load", "kN"),
            ("Standardweg [mm]", "Standardweg", "mm"),
            ("Weg / mm", "Weg", "mm"),
            ("Weg in mm", "Weg", "mm"),
            ("Time, s", "Time", "s"),
            ("pos_mm", "pos", "mm"),
            (
                "Position(Linear:Position) (mm)",
                "Position(Linear:Position)",
                "mm",
            ),
            ("Load (ozf)", "Load", "ozf"),
            ("Kraft [µN]", "Kraft", "µN"),
            ("Kraft [\u{3bc}N]", "Kraft", "µN"),
            ("Force (MN)", "Force", "MN"),
            ("Force (mN)", "Force", "mN"),
            ("Torque (Nm)", "Torque", "N m"),
            ("Depth (nm)", "Depth", "nm"),
            ("millis", "millis", "ms"),
        ] {
            let (found, unit) = split(header);
            assert_eq!((found, unit.unwrap().symbol), (name, symbol), "{header}");
        }
    }

    #[test]
    fn what_is_no_unit_stays_part_of_the_name() {
        for header in ["Load (raw)", "Extension", "f_z", "x1"] {
            assert_eq!(split(header), (header, None));
        }
        assert_eq!(split("Speed (mm/s)").1.unwrap().quantity, Other);
        assert_eq!(split("Rate (furlongs/s)").1.unwrap().quantity, Other);
    }
}
