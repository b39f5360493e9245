//! What stands in one cell of a table.

/// What a cell holds.
pub(super) enum Cell {
    /// A finite number.
    Number(f64),
    /// Nothing, or what is not finite.
    Missing,
    /// Neither.
    Text,
}

/// How a file writes its numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct NumberFormat {
    /// A comma alone is the decimal point, and no separator of thousands.
    pub(super) decimal_comma: bool,
    /// Thousands are separated.
    pub(super) thousands: bool,
}

impl NumberFormat {
    /// The format that some cells of a file have in common.
    pub(super) fn of<'a>(cells: impl Iterator<Item = &'a str>, delimiter: u8) -> NumberFormat {
        let (mut decimal, mut grouped, mut points, mut both, mut large_plain) =
            (false, false, false, false, false);
        for cell in cells.filter(|cell| looks_like_number(cell)) {
            let (commas, dots) = (cell.matches(',').count(), cell.matches('.').count());
            points |= dots == 1 && commas == 0;
            large_plain |=
                commas + dots == 0 && cell.chars().filter(char::is_ascii_digit).count() > 3;
            match (commas, dots) {
                (0, 0 | 1) => {}
                (1.., 1..) => {
                    both = true;
                    decimal |= cell.rfind(',') > cell.rfind('.');
                }
                (1, 0) if is_group(cell, ',') => grouped = true,
                (1, 0) => decimal = true,
                _ => both = true,
            }
        }
        // `1,234` beside `12,5` is a decimal comma; beside `0.5` or `1,234,567` it is a thousand. Whoever
        // writes 1,234 for a thousand writes no 1234.
        let has_decimal_comma =
            decimal || (grouped && !points && !both && (delimiter != b',' || large_plain));
        NumberFormat {
            decimal_comma: has_decimal_comma,
            thousands: both || (grouped && !has_decimal_comma),
        }
    }
}

/// Whether what follows the only separator is a group of three digits behind a number that leads with no zero.
fn is_group(cell: &str, separator: char) -> bool {
    let digits = cell.trim_start_matches(['+', '-']);
    digits.split_once(separator).is_some_and(|(left, right)| {
        right.len() == 3
            && right.bytes().all(|b| b.is_ascii_digit())
            && (1..=3).contains(&left.len())
            && !left.starts_with('0')
    })
}

/// Reads a cell.
pub(super) fn number(cell: &[u8], format: NumberFormat) -> Cell {
    let cell = cell.trim_ascii();
    if cell.is_empty() {
        return Cell::Missing;
    }
    let Ok(text) = std::str::from_utf8(cell) else {
        return Cell::Text;
    };
    match text
        .parse::<f64>()
        .ok()
        .or_else(|| other_number(text, format))
    {
        Some(value) if value.is_finite() => Cell::Number(value),
        Some(_) => Cell::Missing,
        None if matches!(text, "-" | "--" | "n/a" | "N/A" | "#N/A" | "NaN") => Cell::Missing,
        None => Cell::Text,
    }
}

/// A number with a decimal comma, separated thousands or a printed minus.
fn other_number(text: &str, format: NumberFormat) -> Option<f64> {
    if !looks_like_number(text) {
        return None;
    }
    let plain: String = text
        .chars()
        .filter(|c| !matches!(c, ' ' | '\u{a0}' | '\u{202f}' | '\'' | '’'))
        .map(|c| if c == '−' { '-' } else { c })
        .collect();
    let last = plain.rfind([',', '.']);
    let (commas, dots) = (plain.matches(',').count(), plain.matches('.').count());
    let decimal = match (commas, dots) {
        (0, 0) => None,
        (1.., 1..) => last,
        (1, 0) if format.decimal_comma => last,
        (0, 1) => last,
        // Several of a kind, or a comma in front of a thousand.
        (1, 0) if is_group(&plain, ',') => None,
        (1, 0) => last,
        _ => None,
    };
    let kept = plain.char_indices().filter_map(|(at, c)| match c {
        ',' | '.' if Some(at) == decimal => Some('.'),
        ',' | '.' => None,
        c => Some(c),
    });
    kept.collect::<String>().parse().ok()
}

/// Whether a text is a number in some way of writing, or a word for a missing one.
pub(super) fn looks_like_number(text: &str) -> bool {
    let text = text.trim();
    if text.parse::<f64>().is_ok() {
        return true;
    }
    let body = text.trim_start_matches(['+', '-', '−']);
    let mantissa = match body.find(['e', 'E']) {
        Some(at) if body[at + 1..].parse::<i32>().is_ok() => &body[..at],
        Some(_) => return false,
        None => body,
    };
    let mut groups =
        mantissa.split(|c| matches!(c, ',' | '.' | '\'' | '’' | ' ' | '\u{a0}' | '\u{202f}'));
    let first = groups.next().unwrap_or_default();
    let is_digits = |group: &str| !group.is_empty() && group.bytes().all(|b| b.is_ascii_digit());
    let separators: Vec<char> = mantissa.chars().filter(|c| !c.is_ascii_digit()).collect();
    let rest: Vec<&str> = groups.collect();
    let decimal_at_end = separators.last().is_some_and(|c| matches!(c, ',' | '.'));
    let thousands = match decimal_at_end {
        true => rest.len().saturating_sub(1),
        false => rest.len(),
    };
    (is_digits(first) || (first.is_empty() && rest.len() == 1 && decimal_at_end))
        && !rest.is_empty()
        && rest.iter().all(|group| is_digits(group))
        && rest.iter().take(thousands).all(|group| group.len() == 3)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(text: &str, format: NumberFormat) -> Option<f64> {
        match number(text.as_bytes(), format) {
            Cell::Number(value) => Some(value),
            _ => None,
        }
    }

    #[test]
    fn numbers_are_read_as_their_file_writes_them() {
        for (cells, text, wanted) in [
            (&["0,5", "1,234"][..], "1,234", 1.234),
            (&["0.5", "1,234"], "1,234", 1234.0),
            (&["1,234.5", "0.5"], "12,345.25", 12345.25),
            (&["1.234,5", "0,5"], "12.345,25", 12345.25),
            (&["1 234,5", "0,5"], "-1 234,5", -1234.5),
            (&["1'234.5"], "1'234.5", 1234.5),
            (&["1.5e-3"], "−1.5E-03", -1.5e-3),
            (&["1,5e-3"], "2,5E-03", 2.5e-3),
            (&["1,234,567"], "1,234,567", 1_234_567.0),
            (&["0,001"], ",5", 0.5),
        ] {
            let format = NumberFormat::of(cells.iter().copied(), b';');
            assert_eq!(value(text, format), Some(wanted), "{text} in {cells:?}");
        }
    }

    #[test]
    fn what_is_no_number_is_none() {
        for text in [
            "1,2,3",
            "001 1",
            "12:30",
            "0.5 N",
            "1.2.3",
            "2024-01-01",
            ",",
            "",
            "e5",
            "1,,2",
        ] {
            assert!(!looks_like_number(text), "{text}");
        }
    }
}
