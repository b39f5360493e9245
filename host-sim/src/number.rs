//! Numbers as a reader wants them: the standard error decides the digits, a prefix the size, and the kind of
//! machine that is worded the unit ([`kind::worded`]).

use crate::kind;

/// A thousandth of the smallest prefix: less of any unit is the rounding of larger numbers.
const SMALLEST: f64 = 1e-18;
/// Minus sign; a hyphen is too short beside digits.
const MINUS: char = '\u{2212}';
/// Between groups of three digits, and between number and unit: narrow, never broken.
const THIN: char = '\u{202f}';
/// More decimals than this are noise of the arithmetic, whatever the standard error claims.
const MOST_DECIMALS: i32 = 12;

/// A prefix of the SI and what it multiplies by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prefix {
    /// What stands in front of the unit.
    pub symbol: &'static str,
    /// The factor: 1e-3 for milli.
    pub factor: f64,
}

const fn prefix(symbol: &'static str, factor: f64) -> Prefix {
    Prefix { symbol, factor }
}

const NONE: Prefix = prefix("", 1.0);
const PREFIXES: [Prefix; 9] = [
    prefix("G", 1e9),
    prefix("M", 1e6),
    prefix("k", 1e3),
    NONE,
    prefix("m", 1e-3),
    prefix("µ", 1e-6),
    prefix("n", 1e-9),
    prefix("p", 1e-12),
    prefix("f", 1e-15),
];

/// The prefix under which `magnitude` reads between 1 and 1000. From 0.3 on the bare unit is kept:
/// an axis that ends at 0.9 N need not become 900 mN. Composed units (N/m) take one only from 10⁵
/// on: gel at 1 350 N/m compares better with plastic at 11 500 N/m than with 11.5 kN/m.
pub fn prefix_for(magnitude: f64, unit: &str) -> Prefix {
    let unit = kind::unit(unit);
    let composed = unit.contains([' ', '/']);
    pick(magnitude.abs(), unit, 0.3, if composed { 1e5 } else { 1e3 })
}

fn pick(magnitude: f64, unit: &str, bare_from: f64, bare_to: f64) -> Prefix {
    let in_bare = magnitude >= bare_from && magnitude < bare_to;
    if !takes_prefix(unit) || !magnitude.is_finite() || magnitude == 0.0 || in_bare {
        return NONE;
    }
    // Kilometres and kiloseconds exist, but nobody reads them.
    let largest = if matches!(unit, "m" | "s") { 1.0 } else { 1e9 };
    // A millionth: 1 µm in single precision is a little less.
    let fits = |p: &&Prefix| p.factor <= largest && magnitude >= p.factor * (1.0 - 1e-6);
    *PREFIXES
        .iter()
        .find(fits)
        .unwrap_or(&PREFIXES[PREFIXES.len() - 1])
}

/// Whether a prefix may stand in front of the unit.
fn takes_prefix(unit: &str) -> bool {
    matches!(
        unit.split([' ', '/']).next(),
        Some("N" | "m" | "s" | "W" | "J" | "Hz" | "V" | "A")
    )
}

/// A unit with a prefix; the unit `1` is not written.
pub fn unit_text(prefix: Prefix, unit: &str) -> String {
    match kind::unit(unit) {
        "1" => String::new(),
        unit => format!("{}{}", prefix.symbol, unit.replace(' ', "\u{a0}")),
    }
}

/// A value with its standard error, rounded and scaled, ready to be printed.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// The value.
    pub value: String,
    /// Its standard error; `None` where none is known.
    pub std_error: Option<String>,
    /// The unit with its prefix; empty for pure numbers.
    pub unit: String,
}

impl Measured {
    /// Rounds to the digits that the standard error leaves; four digits where there is none.
    pub fn new(value: f64, std_error: Option<f64>, unit: &str) -> Measured {
        let unit = kind::unit(unit);
        let error = std_error.filter(|e| e.is_finite() && *e > 0.0);
        // A surface of −0.0002168 fm is what an addition of millimetres leaves.
        let value = match error {
            None if takes_prefix(unit) && value.abs() < SMALLEST => 0.0,
            _ => value,
        };
        let size = value.abs().max(error.unwrap_or(0.0));
        let prefix = pick(size, unit, 0.1, if unit.contains('/') { 1e5 } else { 1e3 });
        let (value, error) = (value / prefix.factor, error.map(|e| e / prefix.factor));
        let place = error.map_or_else(|| last_place(value, 4), place_of_error);
        Measured {
            value: fixed(value, place),
            std_error: error.map(|e| fixed(e, place)),
            unit: unit_text(prefix, unit),
        }
    }
}

impl std::fmt::Display for Measured {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.value)?;
        if let Some(error) = &self.std_error {
            write!(f, " ± {error}")?;
        }
        if !self.unit.is_empty() {
            write!(f, "\u{a0}{}", self.unit)?;
        }
        Ok(())
    }
}

/// The text with no-break spaces before percent signs: a number is not separated from its sign.
pub fn spaced(text: &str) -> String {
    text.replace(" %", "\u{a0}%")
}

/// A value with so many significant digits and a prefix that suits it.
pub fn quantity(value: f64, digits: i32, unit: &str) -> String {
    let prefix = prefix_for(value, unit);
    let scaled = value / prefix.factor;
    Measured {
        value: fixed(scaled, last_place(scaled, digits)),
        std_error: None,
        unit: unit_text(prefix, unit),
    }
    .to_string()
}

/// A setting that a person wrote: up to four significant digits and no zeros after them.
pub fn setting(value: f64, unit: &str) -> String {
    let prefix = prefix_for(value, unit);
    let scaled = value / prefix.factor;
    let text = fixed(scaled, last_place(scaled, 4));
    let trimmed = match text.contains(['.', '·']) {
        true if !text.contains('·') => text.trim_end_matches('0').trim_end_matches('.'),
        _ => &text,
    };
    Measured {
        value: trimmed.into(),
        std_error: None,
        unit: unit_text(prefix, unit),
    }
    .to_string()
}

/// A number of things, in the plural unless it is one.
pub fn counted(count: usize, thing: &str) -> String {
    let plural = match (count, thing) {
        (1, _) => "",
        (_, thing) if thing.ends_with("ch") => "es",
        _ => "s",
    };
    format!("{count} {thing}{plural}")
}

/// Values for a column of a table: one prefix and one number of decimals for all, so that they can
/// be compared at a glance. Returns the unit for the heading, and the cells.
pub fn column(values: &[f64], digits: i32, unit: &str) -> (String, Vec<String>) {
    let finite = values.iter().filter(|v| v.is_finite());
    let largest = finite.map(|v| v.abs()).fold(0.0, f64::max);
    let prefix = prefix_for(largest, unit);
    let place = last_place(largest / prefix.factor, digits).min(0);
    let cells = values.iter().map(|v| fixed(v / prefix.factor, place));
    (unit_text(prefix, unit), cells.collect())
}

/// Power of ten of the last digit worth printing (−2: hundredths), by the rule of the Particle Data
/// Group: two digits of the error when its three leading ones are below 355, else one; 950 and
/// above rounds up to 1.0 and keeps two again.
fn place_of_error(std_error: f64) -> i32 {
    let exponent = std_error.log10().floor() as i32;
    let leading = (std_error / 10f64.powi(exponent - 2)).round();
    // 354.9999 of a power of ten that is not exact must not fall on the other side.
    if leading < 354.5 {
        exponent - 1
    } else {
        exponent
    }
}

/// Power of ten of the last of `digits` significant digits.
fn last_place(value: f64, digits: i32) -> i32 {
    if value == 0.0 || !value.is_finite() {
        return 0;
    }
    value.abs().log10().floor() as i32 - digits + 1
}

/// `value` rounded to a multiple of 10^place, digits grouped, with a real minus; a dash if it is
/// not finite. Very large and very small numbers are written with a power of ten.
pub fn fixed(value: f64, place: i32) -> String {
    if !value.is_finite() {
        return "–".into();
    }
    if value != 0.0 && (value.abs() >= 1e9 || place < -MOST_DECIMALS) {
        return scientific(value, place);
    }
    let text = match u32::try_from(place) {
        Ok(zeros) => {
            let step = 10f64.powi(zeros as i32);
            format!("{:.0}", (value / step).round() * step)
        }
        Err(_) => format!("{value:.*}", (-place) as usize),
    };
    group(&text)
}

fn scientific(value: f64, place: i32) -> String {
    let exponent = value.abs().log10().floor() as i32;
    let decimals = (exponent - place).clamp(0, MOST_DECIMALS) as usize;
    let mantissa = group(&format!("{:.*}", decimals, value / 10f64.powi(exponent)));
    format!("{mantissa}·10{}", superscript(exponent))
}

/// An integer as superscript digits.
pub fn superscript(exponent: i32) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let digit = |c: char| c.to_digit(10).map_or('⁻', |d| DIGITS[d as usize]);
    exponent.to_string().chars().map(digit).collect()
}

/// Thin spaces between thousands from five digits on, and a real minus that zero does not get.
fn group(text: &str) -> String {
    let (negative, digits) = match text.strip_prefix('-') {
        Some(rest) => (rest.contains(|c| ('1'..='9').contains(&c)), rest),
        None => (false, text),
    };
    let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
    let mut out = String::new();
    if negative {
        out.push(MINUS);
    }
    for (i, c) in whole.chars().enumerate() {
        if i > 0 && whole.len() > 4 && (whole.len() - i).is_multiple_of(3) {
            out.push(THIN);
        }
        out.push(c);
    }
    if !fraction.is_empty() {
        out.push('.');
        out.push_str(fraction);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(value: f64, std_error: f64, unit: &str) -> String {
        Measured::new(value, Some(std_error), unit).to_string()
    }

    #[test]
    fn the_standard_error_decides_the_digits_on_both_sides_of_each_limit() {
        assert_eq!(shown(0.827, 0.119, "1"), "0.83 ± 0.12");
        assert_eq!(shown(0.827, 0.354, "1"), "0.83 ± 0.35");
        assert_eq!(shown(0.827, 0.356, "1"), "0.8 ± 0.4");
        assert_eq!(shown(0.827, 0.949, "1"), "0.8 ± 0.9");
        assert_eq!(shown(0.827, 0.951, "1"), "0.8 ± 1.0");
        assert_eq!(shown(1.35412, 0.00082, "1"), "1.3541 ± 0.0008");
    }

    #[test]
    fn an_error_of_tens_rounds_the_value_to_tens() {
        assert_eq!(shown(11523.0, 120.0, "N/m"), "11\u{202f}520 ± 120\u{a0}N/m");
        assert_eq!(shown(11525.2, 40.0, "N/m"), "11\u{202f}530 ± 40\u{a0}N/m");
    }

    #[test]
    fn values_below_a_tenth_take_a_prefix_and_pure_numbers_never() {
        assert_eq!(shown(0.00213, 0.00002, "m"), "2.130 ± 0.020\u{a0}mm");
        assert_eq!(shown(3.2e-6, 4.0e-7, "N s/m"), "3.2 ± 0.4\u{a0}µN\u{a0}s/m");
        assert_eq!(shown(0.0021, 0.0002, "1"), "0.00210 ± 0.00020");
        assert_eq!(shown(0.0021, 0.0004, "1"), "0.0021 ± 0.0004");
    }

    #[test]
    fn without_an_error_four_digits_and_no_plus_minus() {
        assert_eq!(Measured::new(36.0 / 7.0, None, "1").to_string(), "5.143");
        for senseless in [0.0, f64::NAN, f64::INFINITY, -1.0] {
            assert_eq!(shown(36.0 / 7.0, senseless, "1"), "5.143");
        }
    }

    #[test]
    fn what_is_not_finite_is_a_dash_and_zero_has_no_sign() {
        assert_eq!(Measured::new(f64::NAN, None, "1").to_string(), "–");
        assert_eq!(fixed(-0.0004, -2), "0.00");
        assert_eq!(fixed(-0.04, -2), "−0.04");
        assert_eq!(Measured::new(0.0, None, "N").to_string(), "0\u{a0}N");
        for noise in [-2.168e-19, 9e-19] {
            assert_eq!(Measured::new(noise, None, "m").to_string(), "0\u{a0}m");
        }
        assert_eq!(Measured::new(2e-15, None, "m").to_string(), "2.000\u{a0}fm");
    }

    #[test]
    fn the_prefix_follows_the_data_of_an_afm_and_of_a_rig() {
        assert_eq!(prefix_for(2.4e-6, "m").symbol, "µ");
        assert_eq!(prefix_for(4.5e-3, "m").symbol, "m");
        assert_eq!(prefix_for(37e-9, "N").symbol, "n");
        assert_eq!(prefix_for(0.9, "N").symbol, "");
        assert_eq!(prefix_for(0.2, "N").symbol, "m");
        assert_eq!(prefix_for(12e3, "N").symbol, "k");
        assert_eq!(prefix_for(1000.0, "N").symbol, "k");
        assert_eq!(prefix_for(999.0, "N").symbol, "");
    }

    #[test]
    fn a_column_has_one_unit_and_one_number_of_decimals() {
        let (unit, cells) = column(&[0.000_754, 0.010_2, f64::NAN], 3, "N");
        assert_eq!(
            (unit.as_str(), cells.join(" ").as_str()),
            ("mN", "0.8 10.2 –")
        );
        assert_eq!(column(&[], 3, "N"), ("N".into(), vec![]));
        assert_eq!(column(&[1234.4, 2.0], 3, "1").1, ["1234", "2"]);
    }

    #[test]
    fn a_setting_has_no_trailing_zeros() {
        assert_eq!(setting(0.05, "1"), "0.05");
        assert_eq!(setting(40.0, "1"), "40");
        assert_eq!(setting(1e-3, "m"), "1\u{a0}mm");
        assert_eq!(setting(0.0, "N"), "0\u{a0}N");
    }

    #[test]
    fn one_thing_is_no_plural() {
        assert_eq!(counted(1, "touch"), "1 touch");
        assert_eq!(counted(0, "touch"), "0 touches");
        assert_eq!(counted(3, "gap"), "3 gaps");
    }

    #[test]
    fn a_micrometre_in_single_precision_is_no_thousand_nanometres() {
        assert_eq!(setting(f64::from(1e-6_f32), "m"), "1\u{a0}µm");
        assert_eq!(setting(f64::from(1e-3_f32), "m"), "1\u{a0}mm");
    }

    #[test]
    fn no_kiloseconds_and_nothing_in_front_of_one_per_second() {
        assert_eq!(prefix_for(3600.0, "s"), NONE);
        assert_eq!(prefix_for(1e-3, "s").symbol, "m");
        assert_eq!(prefix_for(1e-3, "1/s"), NONE);
        assert_eq!(prefix_for(f64::NAN, "N"), NONE);
        assert_eq!(prefix_for(0.0, "N"), NONE);
    }

    #[test]
    fn very_large_and_very_small_numbers_get_a_power_of_ten() {
        assert_eq!(fixed(3.25e12, 11), "3.2·10¹²");
        assert_eq!(fixed(-4.2e-15, -16), "−4.2·10⁻¹⁵");
    }
}
