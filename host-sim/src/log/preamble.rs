//! The beginning of a log: comments, titles, delimiter, header and row of units.

use std::path::Path;

use super::cell::{NumberFormat, looks_like_number};
use super::channel::Channel;
use super::columns::ColumnMap;
use super::fields::{decoded, split, uncommented};
use super::{stamp, units};
use crate::diagnostic::Diagnostic;

/// Separators of cells, the surest first.
const DELIMITERS: [u8; 4] = [b'\t', b';', b',', b' '];
/// Rows of numbers that make a table; fewer only where there are no more.
const TABLE_ROWS: usize = 3;
/// Rows by which the format of the numbers is told.
const SAMPLE_ROWS: usize = 400;
/// Lines above the first row of numbers among which the header is looked for.
const HEADER_LINES: usize = 60;

/// What stands before the first row of numbers.
#[derive(Debug, PartialEq)]
pub(super) struct Preamble {
    pub(super) delimiter: u8,
    pub(super) names: Vec<String>,
    /// The cells of a row of units; empty without one.
    pub(super) units: Vec<String>,
    /// Line of the header, from 1; 0 without one.
    pub(super) header_line: usize,
    /// The header as it stands in the file.
    pub(super) header_text: String,
    /// First byte after the header.
    pub(super) data_offset: usize,
    /// Line that begins there, from 1.
    pub(super) data_line: usize,
    /// Lines above the header that are neither blank nor comments.
    pub(super) titles: usize,
    /// How the numbers are written.
    pub(super) format: NumberFormat,
    /// The first rows of the table.
    pub(super) sample: Vec<Vec<String>>,
}

#[derive(Clone, Debug)]
struct Line {
    number: usize,
    /// Without the mark of a comment.
    text: String,
    is_comment: bool,
    end: usize,
}

/// The line that a table begins with, by its index.
#[derive(Clone, Copy, Debug)]
enum Begin {
    Header(usize),
    Numbers(usize),
}

/// Finds the header in the first bytes of a file: where the columns that were asked for stand, or else
/// right above the longest table of numbers. Lines that begin with `#`, `%` or `//` are comments; a header
/// may stand in one.
pub(super) fn parse(head: &[u8], path: &Path, wanted: &ColumnMap) -> Result<Preamble, Diagnostic> {
    let lines: Vec<Line> = lines(head).filter(|line| !line.text.is_empty()).collect();
    if lines.iter().all(|line| line.is_comment) {
        return Err(Diagnostic::new("the file holds nothing but comments")
            .in_file(path)
            .remedy("write the names of the columns without # before them"));
    }
    let by_name = with_names(&lines, wanted);
    let found = by_name.or_else(|| above_numbers(&lines));
    let (at, delimiter) = match found {
        Some((Begin::Header(at), delimiter)) => (at, delimiter),
        Some((Begin::Numbers(at), delimiter)) => {
            return without_header(&lines, at, delimiter, path, wanted);
        }
        None => {
            let first = lines.iter().position(|line| !line.is_comment).unwrap_or(0);
            (first, any_delimiter(&lines[first].text))
        }
    };
    Ok(preamble(&lines, at, delimiter))
}

fn preamble(lines: &[Line], at: usize, delimiter: u8) -> Preamble {
    let header = &lines[at];
    let mut names = split(&header.text, delimiter);
    let mut last = at;
    let mut units = Vec::new();
    // A row of units, and what comments stand around it.
    for (index, line) in lines.iter().enumerate().skip(at + 1).take(8) {
        let cells = split(&line.text, delimiter);
        if are_units(&cells) && cells.len() == names.len() {
            (last, units) = (index, cells);
            break;
        }
        let is_blank = cells.iter().all(String::is_empty);
        if !(line.is_comment || is_blank) {
            break;
        }
    }
    // A header of units only: each column is called by its unit.
    if units.is_empty() && are_units(&names) {
        units.clone_from(&names);
    }
    let titles = lines[..at].iter().filter(|line| !line.is_comment).count();
    let sample = rows(&lines[last + 1..], delimiter);
    let widest = sample.iter().map(Vec::len).max().unwrap_or(0);
    if names.len() > widest && widest > 0 && are_remarks(&names[widest..]) {
        names.truncate(widest);
    }
    Preamble {
        delimiter,
        format: NumberFormat::of(&sample, delimiter),
        names,
        units,
        header_line: header.number,
        header_text: header.text.clone(),
        data_offset: lines[last].end,
        data_line: lines[last].number + 1,
        titles,
        sample,
    }
}

/// A table without a header: its columns are called by their numbers.
fn without_header(
    lines: &[Line],
    start: usize,
    delimiter: u8,
    path: &Path,
    wanted: &ColumnMap,
) -> Result<Preamble, Diagnostic> {
    let rows = rows(&lines[start..], delimiter);
    let count = rows.first().map_or(0, Vec::len);
    let names: Vec<String> = (1..=count).map(|number| number.to_string()).collect();
    if !wanted.names_any_of(&names) {
        let first = &lines[start];
        return Err(no_header(path, first.number, &first.text, start > 0));
    }
    // What stands above is no part of the table.
    let above = start.checked_sub(1).map(|at| &lines[at]);
    Ok(Preamble {
        delimiter,
        format: NumberFormat::of(&rows, delimiter),
        names,
        units: Vec::new(),
        header_line: 0,
        header_text: String::new(),
        data_offset: above.map_or(0, |line| line.end),
        data_line: above.map_or(1, |line| line.number + 1),
        titles: 0,
        sample: rows,
    })
}

fn rows(lines: &[Line], delimiter: u8) -> Vec<Vec<String>> {
    let data = lines.iter().filter(|line| !line.is_comment);
    data.take(SAMPLE_ROWS)
        .map(|line| split(&line.text, delimiter))
        .collect()
}

/// The first line that holds every name that was asked for.
fn with_names(lines: &[Line], wanted: &ColumnMap) -> Option<(Begin, u8)> {
    lines.iter().enumerate().find_map(|(at, line)| {
        let separators = DELIMITERS.into_iter();
        let mut holding = separators.filter(|d| wanted.are_in(&split(&line.text, *d)));
        holding
            .next()
            .map(|delimiter| (Begin::Header(at), delimiter))
    })
}

/// The header above the longest table of numbers, or else its first row; and the delimiter.
fn above_numbers(lines: &[Line]) -> Option<(Begin, u8)> {
    let table = |delimiter: u8| longest_table(lines, delimiter).map(|table| (delimiter, table));
    let tables: Vec<(u8, Table)> = DELIMITERS.into_iter().filter_map(table).collect();
    let longest = tables.iter().map(|(_, table)| table.rows).max()?;
    // A table of few columns in the preamble may have another delimiter.
    let (delimiter, table) = tables.iter().find(|(_, table)| 2 * table.rows >= longest)?;
    let Some(at) = header_above(lines, table, *delimiter) else {
        return Some((Begin::Numbers(table.start), *delimiter));
    };
    // A file in parts repeats its header: the first one counts.
    let names = split(&lines[at].text, *delimiter);
    let first = lines[..at]
        .iter()
        .position(|line| split(&line.text, *delimiter) == names);
    Some((Begin::Header(first.unwrap_or(at)), *delimiter))
}

#[derive(Clone, Copy, Debug)]
struct Table {
    /// Index of its first line.
    start: usize,
    rows: usize,
    columns: usize,
    /// Whether its first row ends with an empty cell.
    is_closed: bool,
}

/// The longest run of rows of numbers with equally many cells; fewer than [`TABLE_ROWS`] only where the file
/// has no more.
fn longest_table(lines: &[Line], delimiter: u8) -> Option<Table> {
    let mut best: Option<Table> = None;
    let mut run: Option<Table> = None;
    let mut count = 0usize;
    for (index, line) in lines
        .iter()
        .enumerate()
        .filter(|(_, line)| !line.is_comment)
    {
        count += 1;
        let columns = columns_of_numbers(&line.text, delimiter);
        run = match (columns, run) {
            (None, _) => None,
            (Some(columns), Some(run)) if run.columns == columns => Some(Table {
                rows: run.rows + 1,
                ..run
            }),
            (Some(columns), _) => Some(Table {
                start: index,
                rows: 1,
                columns,
                is_closed: split(&line.text, delimiter)
                    .last()
                    .is_some_and(String::is_empty),
            }),
        };
        if run.is_some_and(|run| best.is_none_or(|best| run.rows > best.rows)) {
            best = run;
        }
    }
    best.filter(|table| table.rows >= TABLE_ROWS.min(count.saturating_sub(1)).max(1))
}

/// The number of cells of a row that holds at least two numbers and no text with digits in front.
fn columns_of_numbers(line: &str, delimiter: u8) -> Option<usize> {
    let cells = split(line, delimiter);
    let numbers = cells.iter().filter(|cell| is_value(cell)).count();
    let begun = |cell: &String| cell.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c));
    let broken = cells
        .iter()
        .any(|cell| begun(cell) && !is_value(cell) && cell.len() > 2);
    let texts = cells
        .iter()
        .filter(|cell| !cell.is_empty() && !is_value(cell));
    let sure = numbers >= 2 && !broken && texts.count() <= numbers;
    sure.then_some(cells.len())
}

fn is_value(cell: &str) -> bool {
    looks_like_number(cell) || stamp::seconds(cell).is_some() || stamp::is_date(cell)
}

/// Upward from a table: rows of numbers with a mistake belong to it; the first line of as many names is
/// its header.
fn header_above(lines: &[Line], table: &Table, delimiter: u8) -> Option<usize> {
    let from = table.start.saturating_sub(HEADER_LINES);
    let names = |at: usize| {
        let cells = split(&lines[at].text, delimiter);
        let texts = cells
            .iter()
            .filter(|cell| !cell.is_empty() && !is_value(cell))
            .count();
        // A delimiter that ends every row makes an empty cell more, a remark that is never made one less.
        let fits = cells.len() == table.columns
            || (table.is_closed && cells.len() + 1 == table.columns)
            || cells.get(table.columns..).is_some_and(are_remarks);
        fits && 2 * texts > cells.len() && !are_units(&cells)
    };
    // Units alone name the columns where nothing else does.
    let units = |at: &usize| {
        let cells = split(&lines[*at].text, delimiter);
        cells.len() == table.columns && are_units(&cells)
    };
    // Without a mistake in its first rows, the header is near.
    let above = (from..table.start).rev().find(|at| names(*at));
    above.or_else(|| table.start.checked_sub(1).filter(units))
}

/// Whether names are of remarks, whose cells may be left out at the end of a row (as LabVIEW does).
fn are_remarks(names: &[String]) -> bool {
    const REMARKS: [&str; 6] = [
        "comment",
        "comments",
        "kommentar",
        "remark",
        "remarks",
        "note",
    ];
    let is_remark = |name: &String| REMARKS.contains(&name.to_lowercase().as_str());
    names.iter().all(is_remark)
}

/// Whether every cell is a unit or empty, and one is a unit of the three channels.
fn are_units(cells: &[String]) -> bool {
    let known = |cell: &String| units::parse(cell);
    cells
        .iter()
        .all(|cell| cell.is_empty() || known(cell).is_some())
        && cells
            .iter()
            .filter_map(known)
            .any(|unit| unit.quantity != units::Quantity::Other)
        && cells.iter().all(|cell| cell.parse::<f64>().is_err())
}

fn lines(head: &[u8]) -> impl Iterator<Item = Line> {
    let mut end = 0;
    head.split_inclusive(|byte| *byte == b'\n')
        .enumerate()
        .map(move |(index, line)| {
            end += line.len();
            let text = decoded(line);
            let text = text
                .trim_start_matches('\u{feff}')
                .trim_end_matches(['\r', '\n']);
            let comment = uncommented(text);
            Line {
                number: index + 1,
                is_comment: comment.is_some(),
                // Tabs at the ends stand for empty cells.
                text: comment.unwrap_or(text.trim_matches(' ')).to_string(),
                end,
            }
        })
}

/// The delimiter that a header alone has most of.
fn any_delimiter(header: &str) -> u8 {
    let count = |delimiter: &u8| header.bytes().filter(|byte| byte == delimiter).count();
    let usual = [b',', b';', b'\t'].into_iter();
    usual
        .max_by_key(count)
        .filter(|d| count(d) > 0)
        .unwrap_or(b',')
}

fn no_header(path: &Path, line: usize, text: &str, has_titles: bool) -> Diagnostic {
    let what = match has_titles {
        true => "no line above these numbers has a name for each of their columns",
        false => "the first line holds numbers, not the names of the columns",
    };
    Diagnostic::new(what)
        .in_file(path)
        .at_line(line)
        .excerpt(text, 0..text.len())
        .remedy(format!(
            "put a header above it: {}, or name the columns by their numbers: --columns 't=1,x=2,f=3' if they are in \
             s, m and N, --columns 't=1,x=2*1e-3,f=3' if the position is in mm",
            Channel::ALL.map(Channel::column).join(",")
        ))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(text: &str) -> Preamble {
        parse(text.as_bytes(), Path::new("a.csv"), &ColumnMap::default()).unwrap()
    }

    #[test]
    fn the_delimiter_is_the_one_that_header_and_row_agree_on() {
        assert_eq!(parsed("t_s,x_m,f_n\n0,1,2\n").delimiter, b',');
        assert_eq!(parsed("t_s;x_m;f_n\n0,001;0,1;2,0\n").delimiter, b';');
        let numpy = "# made by numpy\n# t_s x_m f_n\n0 1 2\n";
        assert_eq!(parsed(numpy).delimiter, b' ');
        assert_eq!(parsed("t s, x m, f n\n0, 1, 2\n").delimiter, b',');
        assert_eq!(parsed("Time [s, rel]\tx\tF\n0\t1\t2\n").delimiter, b'\t');
        assert_eq!(parsed("Zeit\tWeg\tKraft\n0,1\t1,5\t2,5\n").delimiter, b'\t');
        assert_eq!(parsed("a  b   c\n0,1   1,5 2,5\n").delimiter, b' ');
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
        let percent = parsed("% Zeit, Weg, Kraft\n% s, mm, N\n0,1,2\n1,1,2\n");
        assert_eq!(percent.names, ["Zeit", "Weg", "Kraft"]);
        assert_eq!(percent.units, ["s", "mm", "N"]);
    }

    #[test]
    fn a_preamble_of_a_machine_and_a_row_of_units_are_recognised() {
        let text = "\"Prüfprotokoll\"\n\"Kunde\";\"Uni\"\n\"Breite\";12,5\n\nPrüfzeit;Standardweg;Standardkraft\n\
                    s;mm;N\n0,00;0,001;0,5\n0,01;0,002;0,5\n0,02;0,003;0,6\n";
        let found = parsed(text);
        assert_eq!(found.names, ["Prüfzeit", "Standardweg", "Standardkraft"]);
        assert_eq!(found.units, ["s", "mm", "N"]);
        assert_eq!(
            (found.header_line, found.data_line, found.titles),
            (5, 7, 3)
        );
        assert!(found.format.decimal_comma);
    }

    #[test]
    fn a_header_of_units_alone_names_the_columns() {
        let found = parsed("ms,mm,N\n0,1.5,2\n1,1.5,2\n2,1.5,2\n");
        assert_eq!(found.names, ["ms", "mm", "N"]);
        assert_eq!(found.units, ["ms", "mm", "N"]);
        assert_eq!((found.header_line, found.data_line), (1, 2));
    }

    #[test]
    fn a_small_table_of_results_above_is_not_the_log() {
        let rows: String = (0..9).map(|i| format!("0.{i},1.5,2.5\n")).collect();
        let text = format!(
            "Results\nSpecimen,Max\n1,2.5\n2,2.6\n3,2.7\n\nTime,Extension,Load\n(s),(mm),(N)\n{rows}"
        );
        assert_eq!(parsed(&text).names, ["Time", "Extension", "Load"]);
    }

    #[test]
    fn a_header_in_latin_1_keeps_its_micro_sign() {
        let text = b"t_s;Weg [\xb5m];Kraft\n0;1;2\n";
        let found = parse(text, Path::new("a.csv"), &ColumnMap::default()).unwrap();
        assert_eq!(found.names[1], "Weg [µm]");
    }

    #[test]
    fn blanks_within_a_name_with_a_unit_do_not_separate() {
        let found = parsed("Time (s)   Position (mm)  Force (N)\n 0.0  1.0   2.0\n 0.1  1.0 2.0\n");
        assert_eq!(found.names, ["Time (s)", "Position (mm)", "Force (N)"]);
    }

    #[test]
    fn numbers_without_a_header_are_refused_unless_the_columns_are_numbered() {
        let text = b"0,1,2\n1,1,2\n";
        let error = parse(text, Path::new("a.csv"), &ColumnMap::default()).unwrap_err();
        assert_eq!(error.line, Some(1));
        assert!(error.remedy.as_ref().unwrap().contains("t_s,x_m,f_n"));
        let numbered: ColumnMap = "t=1,x=2,f=3".parse().unwrap();
        let found = parse(text, Path::new("a.csv"), &numbered).unwrap();
        assert_eq!((found.names.len(), found.data_offset), (3, 0));
    }
}
