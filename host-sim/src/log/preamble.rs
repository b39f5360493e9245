//! The beginning of a log: comments, delimiter and header.

use std::path::Path;

use super::columns::Channel;
use crate::diagnostic::Diagnostic;

/// What stands before the first row of numbers.
#[derive(Debug, PartialEq)]
pub(super) struct Preamble {
    pub(super) delimiter: u8,
    pub(super) names: Vec<String>,
    /// Line of the header, from 1.
    pub(super) header_line: usize,
    /// The header as it stands in the file.
    pub(super) header_text: String,
    /// First byte after the header.
    pub(super) data_offset: usize,
}

struct Line {
    number: usize,
    text: String,
    end: usize,
}

/// Finds the header in the first bytes of a file.
///
/// Lines that begin with `#` are comments, except one right before numbers with as many fields:
/// that is how numpy writes a header.
pub(super) fn parse(head: &[u8], path: &Path) -> Result<Preamble, Diagnostic> {
    let mut comment = None;
    let mut rows = Vec::new();
    for line in lines(head) {
        match line.text.trim().strip_prefix('#') {
            Some(_) if rows.is_empty() => comment = Some(line),
            Some(_) => {}
            None if line.text.trim().is_empty() => {}
            None => rows.push(line),
        }
        if rows.len() == 2 {
            break;
        }
    }
    let Some(first) = rows.first() else {
        return Err(Diagnostic::new("the file holds nothing but comments")
            .in_file(path)
            .remedy("write the names of the columns without # before them"));
    };
    let delimiter = delimiter(&first.text, &rows.last().unwrap_or(first).text);
    let fields = split(&first.text, delimiter);
    let (header, names) = if !all_numbers(&fields) {
        (first, fields)
    } else {
        let above = comment
            .as_ref()
            .map(|line| (line, split(uncommented(&line.text), delimiter)));
        match above {
            Some((line, names)) if names.len() == fields.len() => (line, names),
            _ => return Err(no_header(path, first.number, &first.text)),
        }
    };
    Ok(Preamble {
        delimiter,
        names,
        header_line: header.number,
        header_text: header.text.clone(),
        data_offset: header.end,
    })
}

fn lines(head: &[u8]) -> impl Iterator<Item = Line> {
    let mut end = 0;
    head.split_inclusive(|byte| *byte == b'\n')
        .enumerate()
        .map(move |(index, line)| {
            end += line.len();
            let text = decoded(line);
            Line {
                number: index + 1,
                text: text
                    .trim_start_matches('\u{feff}')
                    .trim_end_matches(['\r', '\n'])
                    .to_string(),
                end,
            }
        })
}

/// UTF-8, or else Latin-1: the µ of many a machine's header.
pub(super) fn decoded(bytes: &[u8]) -> String {
    match std::str::from_utf8(bytes) {
        Ok(text) => text.to_string(),
        Err(_) => bytes.iter().map(|byte| char::from(*byte)).collect(),
    }
}

fn uncommented(line: &str) -> &str {
    line.trim().trim_start_matches('#').trim_start()
}

/// The delimiter that gives header and first row the same number of fields, and most of them; a
/// blank only if no other does.
fn delimiter(header: &str, row: &str) -> u8 {
    let fields = |line: &str, delimiter: u8| line.bytes().filter(|b| *b == delimiter).count();
    let usual = [b'\t', b';', b','];
    let agrees = |d: &u8| fields(header, *d) >= 1 && fields(header, *d) == fields(row, *d);
    let agreeing = usual.into_iter().filter(agrees);
    agreeing
        .max_by_key(|d| fields(header, *d))
        .or(Some(b' ').filter(agrees))
        .or_else(|| usual.into_iter().max_by_key(|d| fields(header, *d)))
        .unwrap_or(b',')
}

fn split(line: &str, delimiter: u8) -> Vec<String> {
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

fn all_numbers(fields: &[String]) -> bool {
    fields
        .iter()
        .all(|field| field.replace(',', ".").parse::<f64>().is_ok())
}

fn no_header(path: &Path, line: usize, text: &str) -> Diagnostic {
    Diagnostic::new("the first line holds numbers, not the names of the columns")
        .in_file(path)
        .at_line(line)
        .excerpt(text, 0..text.len())
        .remedy(format!(
            "put a header above it: {}",
            Channel::ALL.map(Channel::column).join(",")
        ))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(text: &str) -> Preamble {
        parse(text.as_bytes(), Path::new("a.csv")).unwrap()
    }

    #[test]
    fn the_delimiter_is_the_one_that_header_and_row_agree_on() {
        assert_eq!(parsed("t_s,x_m,f_n\n0,1,2\n").delimiter, b',');
        assert_eq!(parsed("t_s;x_m;f_n\n0,001;0,1;2,0\n").delimiter, b';');
        assert_eq!(
            parsed("# made by numpy\n# t_s x_m f_n\n0 1 2\n").delimiter,
            b' '
        );
        assert_eq!(parsed("t s, x m, f n\n0, 1, 2\n").delimiter, b',');
        assert_eq!(parsed("Time [s, rel]\tx\tF\n0\t1\t2\n").delimiter, b'\t');
    }

    #[test]
    fn comments_byte_order_mark_and_quotes_do_not_disturb() {
        let found = parsed("\u{feff}# rig 3\r\n\r\n\"t_s\", x_m ,f_n\r\n0,1,2\r\n");
        assert_eq!(found.names, ["t_s", "x_m", "f_n"]);
        assert_eq!(found.header_line, 3);
    }

    #[test]
    fn a_header_as_numpy_writes_it_is_a_header() {
        let found = parsed("# made by numpy\n# t_s,x_m,f_n\n0,1,2\n1,1,2\n");
        assert_eq!(found.names, ["t_s", "x_m", "f_n"]);
        assert_eq!(found.data_offset, 30);
    }

    #[test]
    fn a_header_in_latin_1_keeps_its_micro_sign() {
        let found = parse(b"t_s;Weg [\xb5m];Kraft\n0;1;2\n", Path::new("a.csv")).unwrap();
        assert_eq!(found.names[1], "Weg [µm]");
    }

    #[test]
    fn numbers_without_a_header_are_refused() {
        let error = parse(b"0,1,2\n1,1,2\n", Path::new("a.csv")).unwrap_err();
        assert_eq!(error.line, Some(1));
        assert!(error.remedy.as_ref().unwrap().contains("t_s,x_m,f_n"));
    }
}
