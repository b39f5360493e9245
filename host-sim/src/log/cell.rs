//! What stands in one cell of a table.

/// What a cell holds.
pub(super) enum Cell {
    /// A finite number.
    Number(f64),
    /// Nothing, what is not finite, or no reading.
    Missing,
    /// Neither.
    Text,
}

/// What is as large is no reading: instruments that speak SCPI write 9.9E37 for a value out of range, and 9.91E37 for none.
const NO_READING: f64 = 1e30;

/// How a file writes its numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct NumberFormat {
    /// A comma alone is the decimal point, and no separator of thousands.
    pub(super) decimal_comma: bool,
    /// A point alone separates thousands, and is no decimal point.
    pub(super) thousands_point: bool,
    /// Thousands are separated.
    pub(super) thousands: bool,
}

/// How often the cells of a file, or of one of its columns, have one separator.
#[derive(Clone, Copy, Debug, Default)]
struct Separated {
    /// With three digits behind and no leading zero: a thousand or a number of three decimals.
    groups: usize,
    /// Otherwise: a decimal point.
    decimals: usize,
    /// Without any separator, and other than zero, up to 999 and beyond.
    plain: usize,
    large: usize,
}

impl Separated {
    fn of<'a>(cells: impl Iterator<Item = &'a str>, separator: char) -> Separated {
        let mut counts = Separated::default();
        for cell in cells {
            let separators = cell.matches([',', '.']).count();
            let digits = cell.chars().filter(char::is_ascii_digit).count();
            match (separators, cell.matches(separator).count()) {
                (0, _) if digits > 3 => counts.large += 1,
                (0, _) if cell != "0" => counts.plain += 1,
                (1, 1) if is_group(cell, separator) => counts.groups += 1,
                (1, 1) => counts.decimals += 1,
                _ => {}
            }
        }
        counts
    }

    /// Whoever separates thousands writes 999 and 1,000 into one column, and no 1000; three decimals stand in
    /// every cell.
    fn are_thousands(&self) -> bool {
        self.decimals + self.large == 0 && self.plain > 0 && self.groups > 0
    }
}

impl NumberFormat {
    /// The format that the first rows of a file have in common.
    pub(super) fn of(rows: &[Vec<String>], delimiter: u8) -> NumberFormat {
        let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
        let column = |at: usize| {
            let cells = rows.iter().filter_map(move |row| row.get(at));
            cells
                .map(String::as_str)
                .filter(|cell| looks_like_number(cell))
        };
        let all = || (0..columns).flat_map(column);
        let any_thousands =
            |mark: char| (0..columns).any(|at| Separated::of(column(at), mark).are_thousands());
        let several = || all().filter(|cell| cell.matches([',', '.']).count() > 1);
        // Of 1.234,5 the last mark is the decimal one; 1.234.567 has none.
        let decimal_last = |mark: char| {
            let mixed = several().filter(|cell| cell.contains(',') && cell.contains('.'));
            let mut marks = mixed.filter_map(|cell| cell.chars().rfind(|c| matches!(c, ',' | '.')));
            marks.any(|last| last == mark)
        };
        let both = several().next().is_some();
        let (commas, points) = (Separated::of(all(), ','), Separated::of(all(), '.'));
        let decimal_comma = match commas.decimals > 0 || decimal_last(',') {
            true => true,
            false => {
                let may_be = commas.groups > 0 && points.groups + points.decimals == 0 && !both;
                may_be && !any_thousands(',') && (delimiter != b',' || commas.large > 0)
            }
        };
        let thousands_point = points.decimals == 0
            && points.groups > 0
            && !decimal_last('.')
            && (decimal_comma || any_thousands('.'));
        NumberFormat {
            decimal_comma,
            thousands_point,
            thousands: both || thousands_point || (commas.groups > 0 && !decimal_comma),
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
    let plain = match format.thousands_point && text.contains('.') {
        true => None,
        false => text.parse::<f64>().ok(),
    };
    match plain.or_else(|| other_number(text, format)) {
        Some(value) if value.abs() < NO_READING => Cell::Number(value),
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
        (0, 1) if format.thousands_point && is_group(&plain, '.') => None,
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
    let mut groups = mantissa.split([',', '.', '\'', '’', ' ', '\u{a0}', '\u{202f}']);
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
            (&["999", "1,234"], "1,234", 1234.0),
            (&["999", "1.234"], "1.234", 1234.0),
            (&["9.990", "1.234"], "1.234", 1.234),
            (&["9,990", "1,234"], "1,234", 1.234),
            (&["0,5", "1.234"], "1.234", 1234.0),
            (&["1,234.5", "0.5"], "12,345.25", 12345.25),
            (&["1.234,5", "0,5"], "12.345,25", 12345.25),
            (&["1 234,5", "0,5"], "-1 234,5", -1234.5),
            (&["1'234.5"], "1'234.5", 1234.5),
            (&["1.5e-3"], "−1.5E-03", -1.5e-3),
            (&["1,5e-3"], "2,5E-03", 2.5e-3),
            (&["1,234,567"], "1,234,567", 1_234_567.0),
            (&["0,001"], ",5", 0.5),
        ] {
            let rows: Vec<Vec<String>> = cells.iter().map(|cell| vec![cell.to_string()]).collect();
            let format = NumberFormat::of(&rows, b';');
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
