//! The cells of a line, and lines that are comments.

/// What stands in a comment; `None` of another line. Bruker's JPK writes `# columns: …` and `# units: …`.
pub(super) fn uncommented(line: &str) -> Option<&str> {
    let line = line.trim();
    let text = ["#", "%", "//"]
        .into_iter()
        .find_map(|mark| line.strip_prefix(mark))?;
    let text = text.trim_start_matches(['#', '%', '/']).trim();
    let keyed = ["columns:", "units:"]
        .into_iter()
        .find_map(|key| text.strip_prefix(key));
    Some(keyed.unwrap_or(text).trim())
}

/// Whether a row of a table is a comment, by its first cell.
pub(super) fn is_comment(first_cell: &[u8]) -> bool {
    let cell = first_cell.trim_ascii_start();
    cell.starts_with(b"#") || cell.starts_with(b"%") || cell.starts_with(b"//")
}

/// UTF-8, or else Latin-1.
pub(super) fn decoded(bytes: &[u8]) -> String {
    match std::str::from_utf8(bytes) {
        Ok(text) => text.to_string(),
        Err(_) => bytes.iter().map(|byte| char::from(*byte)).collect(),
    }
}

/// The cells of a line, without blanks around them.
pub(super) fn split(line: &str, delimiter: u8) -> Vec<String> {
    if delimiter == b' ' {
        return split_at_blanks(line);
    }
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .delimiter(delimiter)
        .trim(csv::Trim::All)
        .from_reader(line.as_bytes());
    let record = reader
        .records()
        .next()
        .and_then(Result::ok)
        .unwrap_or_default();
    record.iter().map(str::to_string).collect()
}

/// Cells between runs of blanks; quotes and brackets hold theirs together, and a unit in brackets belongs to
/// the name before it.
fn split_at_blanks(line: &str) -> Vec<String> {
    let mut cells: Vec<String> = Vec::new();
    let (mut quoted, mut depth, mut open) = (false, 0usize, false);
    for c in line.chars() {
        match c {
            '"' => quoted = !quoted,
            c if c.is_whitespace() && !quoted && depth == 0 => open = false,
            c => {
                match c {
                    '(' | '[' => depth += 1,
                    ')' | ']' => depth = depth.saturating_sub(1),
                    _ => {}
                }
                let joins = !open && matches!(c, '(' | '[');
                match cells.last_mut() {
                    Some(cell) if open => cell.push(c),
                    // `Time (s)` is one name; a line of units `(s) (mm)` is not.
                    Some(cell) if joins && !cell.ends_with([')', ']']) => {
                        cell.push(' ');
                        cell.push(c);
                    }
                    _ => cells.push(c.to_string()),
                }
                open = true;
            }
        }
    }
    cells
}
