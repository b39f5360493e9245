//! Several logs with one table: `summary.csv`, `summary.json`, and a line each on the terminal.

use std::error::Error;
use std::io;
use std::path::{Path, PathBuf};

use rayon::prelude::*;
use serde_json::{Map, Value, json};

use super::logs;
use super::progress::Spinner;
use crate::diagnostic::Diagnostic;
use crate::json::write_json;
use crate::output::{complain, result, say, write_atomically};

/// Up to so many logs have their own text on the terminal above the table.
const MOST_TEXTS: usize = 4;

/// What a verb found in one recording.
pub(super) struct Answer {
    /// The recording.
    pub(super) path: PathBuf,
    /// What is said on the terminal.
    pub(super) text: String,
    /// The content of its JSON file.
    pub(super) json: Value,
    /// Its row in the table: a name and a value for each column.
    pub(super) row: Map<String, Value>,
}

/// An error that crosses threads: bad input, or what the system says.
pub(super) enum Failure {
    /// Exit status 2.
    Input(Diagnostic),
    /// Exit status 1.
    System(io::Error),
}

impl From<Diagnostic> for Failure {
    fn from(error: Diagnostic) -> Self {
        Failure::Input(error)
    }
}

impl From<io::Error> for Failure {
    fn from(error: io::Error) -> Self {
        Failure::System(error)
    }
}

impl From<Failure> for Box<dyn Error> {
    fn from(failure: Failure) -> Self {
        match failure {
            Failure::Input(error) => error.into(),
            Failure::System(error) => error.into(),
        }
    }
}

/// What a verb does with one file: it reads it, works on its recordings and writes their files. It is given the
/// name of the file's folder, or `None` for a file that is the only one.
pub(super) type Work<'a> = dyn Fn(&Path, Option<&str>) -> Result<Vec<Answer>, Failure> + Sync + 'a;

/// Does `work` with every log that is given, on all cores, and tells what came out: of one log its text and
/// its JSON, of several the table. A log that cannot be used does not stop the others.
///
/// # Errors
/// The failure of a single log; of several, how many failed.
pub(super) fn each(
    given: &[PathBuf],
    out: Option<&Path>,
    work: &Work,
) -> Result<(), Box<dyn Error>> {
    let files = logs::expanded(given)?;
    let spinner = Spinner::new(files.len());
    if let [file] = &files[..] {
        let answers = work(file, None)?;
        drop(spinner);
        return match &answers[..] {
            [one] => {
                say(&one.text)?;
                Ok(result(&one.json)?)
            }
            _ => Ok(told(answers.into_iter().map(Row::of).collect(), out)?),
        };
    }
    let names = logs::names(&files);
    let work_on = |(file, name): (&PathBuf, &String)| {
        let done = work(file, Some(name));
        spinner.one_more();
        match done {
            Ok(answers) => answers.into_iter().map(Row::of).collect(),
            Err(failure) => vec![Row::failed(file, failure)],
        }
    };
    let rows: Vec<Vec<Row>> = files.par_iter().zip(&names).map(work_on).collect();
    drop(spinner);
    let rows: Vec<Row> = rows.into_iter().flatten().collect();
    let failed: Vec<String> = rows.iter().filter_map(|row| row.error.clone()).collect();
    let count = rows.len();
    told(rows, out)?;
    for error in &failed {
        complain(error);
    }
    match failed.is_empty() {
        true => Ok(()),
        false => Err(
            Diagnostic::new(format!("{} of {count} logs cannot be used", failed.len()))
                .remedy("see above what each of them needs; the others are done")
                .into(),
        ),
    }
}

/// A row of the table.
struct Row {
    path: PathBuf,
    text: String,
    cells: Map<String, Value>,
    error: Option<String>,
}

impl Row {
    fn of(answer: Answer) -> Row {
        Row {
            path: answer.path,
            text: answer.text,
            cells: answer.row,
            error: None,
        }
    }

    fn failed(path: &Path, failure: Failure) -> Row {
        let error: Box<dyn Error> = failure.into();
        Row {
            path: path.to_path_buf(),
            text: String::new(),
            cells: Map::new(),
            error: Some(error.to_string()),
        }
    }

    fn json(&self) -> Value {
        let mut row = Map::new();
        row.insert("log".into(), json!(self.path.display().to_string()));
        row.extend(self.cells.clone());
        row.insert("error".into(), json!(self.error));
        Value::Object(row)
    }
}

fn told(rows: Vec<Row>, out: Option<&Path>) -> io::Result<()> {
    if rows.len() <= MOST_TEXTS {
        for row in rows.iter().filter(|row| !row.text.is_empty()) {
            say(&row.text)?;
        }
    }
    let columns = columns(&rows);
    say(table(&rows, &columns))?;
    let json = json!({ "logs": rows.iter().map(Row::json).collect::<Vec<_>>() });
    if let Some(out) = out {
        write_json(&out.join("summary.json"), &json)?;
        write_csv(&out.join("summary.csv"), &rows, &columns)?;
        say(format!("summary: {}\n", out.join("summary.csv").display()))?;
    }
    result(&json)
}

/// The names of all cells, in the order in which they first appear.
fn columns(rows: &[Row]) -> Vec<String> {
    let mut columns: Vec<String> = Vec::new();
    for name in rows.iter().flat_map(|row| row.cells.keys()) {
        if !columns.contains(name) {
            columns.push(name.clone());
        }
    }
    columns
}

fn cell(value: Option<&Value>) -> String {
    match value {
        None | Some(Value::Null) => String::new(),
        Some(Value::String(text)) => text.clone(),
        Some(other) => other.to_string(),
    }
}

fn write_csv(path: &Path, rows: &[Row], columns: &[String]) -> io::Result<()> {
    write_atomically(path, |writer| {
        let mut table = csv::Writer::from_writer(writer);
        let names = columns.iter().map(String::as_str);
        table.write_record(std::iter::once("log").chain(names).chain(["error"]))?;
        for row in rows {
            let cells = columns.iter().map(|name| cell(row.cells.get(name)));
            let log = std::iter::once(row.path.display().to_string());
            let error = row
                .error
                .as_ref()
                .map_or(String::new(), |error| first_line(error));
            table.write_record(log.chain(cells).chain([error]))?;
        }
        table.flush()
    })
}

fn first_line(error: &str) -> String {
    let line = error.lines().next().unwrap_or_default();
    line.strip_prefix("error: ").unwrap_or(line).to_string()
}

/// The table in columns of blanks; standard errors stand in the files.
fn table(rows: &[Row], columns: &[String]) -> String {
    let shown: Vec<&String> = columns
        .iter()
        .filter(|name| !name.ends_with("_std_error"))
        .take(8)
        .collect();
    let short = |value: Option<&Value>| match value.and_then(Value::as_f64) {
        Some(number) => format!("{number:.4e}")
            .parse::<f64>()
            .map_or(String::new(), |n| n.to_string()),
        None => cell(value),
    };
    let mut lines = vec![
        std::iter::once("log".to_string())
            .chain(shown.iter().map(|n| n.to_string()))
            .collect(),
    ];
    lines.extend(rows.iter().map(|row| -> Vec<String> {
        let log = row.path.display().to_string();
        match &row.error {
            Some(error) => vec![log, first_line(error)],
            None => std::iter::once(log)
                .chain(shown.iter().map(|name| short(row.cells.get(*name))))
                .collect(),
        }
    }));
    let width = |at: usize| {
        let cells = lines
            .iter()
            .filter(|line| line.len() > 2)
            .filter_map(|line| line.get(at));
        cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..=shown.len()).map(width).collect();
    let mut text = String::new();
    for line in &lines {
        let cells = line
            .iter()
            .zip(&widths)
            .map(|(cell, width)| format!("{cell:<width$}"));
        text.push_str(cells.collect::<Vec<_>>().join("  ").trim_end());
        text.push('\n');
    }
    text
}
