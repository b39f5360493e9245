//! Bad input, said on one screen: what is wrong, where, with which value, and what would be right.
//!
//! ```text
//! error: text where a number should be
//!   --> log.csv:17, column f_n
//!    | 0.016,-0.0020,abc
//!    |               ^^^
//!    = value: `abc`
//!    = remedy: write the force in newtons, or leave the row out
//! ```
//!
//! Every reader of files and arguments answers with this one type; the command maps it to exit
//! status 2. What is not the input's fault (a full disk) stays an [`std::io::Error`]: status 1.

use std::fmt;
use std::ops::{Deref, DerefMut, Range};
use std::path::{Path, PathBuf};

use crate::wrap::wrapped;

/// Widest excerpt (characters): with its margin it fits a terminal of 80 columns.
const EXCERPT_WIDTH: usize = 74;

/// Longest list of names in one note [names, characters]: three lines; a log may have hundreds of
/// columns.
const LISTED_NAMES: usize = 24;
const LISTED_WIDTH: usize = 240;

/// What is wrong with some input. Its parts are those of [`Details`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Diagnostic {
    // Boxed: every result of a reader would carry 200 bytes otherwise.
    details: Box<Details>,
}

/// The parts of a [`Diagnostic`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Details {
    /// What is wrong, in lower case and without a full stop.
    pub what: String,
    /// The file; `None` for an argument of the command line.
    pub path: Option<PathBuf>,
    /// Line in the file, from 1.
    pub line: Option<usize>,
    /// The column or key, with its kind: "column f_n", "key damping".
    pub field: Option<String>,
    /// The line itself, and what in it is meant.
    pub excerpt: Option<Excerpt>,
    /// The offending value.
    pub value: Option<String>,
    /// What else a reader needs to know, a line each.
    pub notes: Vec<String>,
    /// What would be right.
    pub remedy: Option<String>,
}

/// A line of the input with a part of it marked.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Excerpt {
    /// The line without its end.
    pub text: String,
    /// The marked bytes of `text`; empty: nothing is marked.
    pub marked: Range<usize>,
}

impl Diagnostic {
    /// A diagnostic that says only what is wrong; the other methods add to it.
    pub fn new(what: impl Into<String>) -> Self {
        Diagnostic {
            details: Box::new(Details {
                what: what.into(),
                ..Details::default()
            }),
        }
    }

    /// In which file.
    pub fn in_file(mut self, path: &Path) -> Self {
        self.path = Some(path.to_path_buf());
        self
    }

    /// At which line, from 1.
    pub fn at_line(mut self, line: usize) -> Self {
        self.line = Some(line);
        self
    }

    /// In which column of a log.
    pub fn in_column(mut self, name: &str) -> Self {
        self.field = Some(format!("column {name}"));
        self
    }

    /// Under which key of a TOML file.
    pub fn at_key(mut self, key: &str) -> Self {
        self.field = Some(format!("key {key}"));
        self
    }

    /// The line, with `marked` bytes underlined.
    pub fn excerpt(mut self, text: impl Into<String>, marked: Range<usize>) -> Self {
        self.excerpt = Some(Excerpt {
            text: text.into(),
            marked,
        });
        self
    }

    /// With which value.
    pub fn value(mut self, value: impl fmt::Display) -> Self {
        self.value = Some(value.to_string());
        self
    }

    /// What else to know.
    pub fn note(mut self, note: impl Into<String>) -> Self {
        self.notes.push(note.into());
        self
    }

    /// What would be right.
    pub fn remedy(mut self, remedy: impl Into<String>) -> Self {
        self.remedy = Some(remedy.into());
        self
    }

    /// The diagnostic below a line that others write: without "error: ".
    pub fn below(&self) -> String {
        let text = self.to_string();
        text.strip_prefix("error: ").unwrap_or(&text).to_string()
    }

    fn place(&self) -> Option<String> {
        let mut place = match (&self.path, self.line) {
            (Some(path), Some(line)) => format!("{}:{line}", shown(path)),
            (Some(path), None) => shown(path),
            (None, Some(line)) => format!("line {line}"),
            (None, None) => String::new(),
        };
        if let Some(field) = &self.field {
            if !place.is_empty() {
                place.push_str(", ");
            }
            place.push_str(field);
        }
        (!place.is_empty()).then_some(place)
    }
}

impl Deref for Diagnostic {
    type Target = Details;
    fn deref(&self) -> &Details {
        &self.details
    }
}

impl DerefMut for Diagnostic {
    fn deref_mut(&mut self) -> &mut Details {
        &mut self.details
    }
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&wrapped("error: ", &self.what))?;
        self.fmt_details(f)
    }
}

impl Diagnostic {
    /// Everything but the first line: where, with which value, and what would be right.
    fn fmt_details(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(place) = self.place() {
            write!(f, "\n  --> {}", printable(&place))?;
        }
        if let Some(excerpt) = &self.excerpt {
            let (text, indent, width) = excerpt.window();
            write!(f, "\n   | {text}")?;
            if width > 0 {
                write!(f, "\n   | {}{}", " ".repeat(indent), "^".repeat(width))?;
            }
        }
        match self.value.as_deref() {
            Some("") => f.write_str("\n   = value: nothing")?,
            Some(value) => write!(f, "\n   = value: `{}`", shortened(value))?,
            None => {}
        }
        for note in &self.notes {
            write!(f, "\n{}", wrapped("   = note: ", note))?;
        }
        if let Some(remedy) = &self.remedy {
            write!(f, "\n{}", wrapped("   = remedy: ", remedy))?;
        }
        Ok(())
    }
}

impl std::error::Error for Diagnostic {}

impl Excerpt {
    /// The part of the line that fits, and indent and width of the mark in characters.
    fn window(&self) -> (String, usize, usize) {
        let end = self.marked.end.min(self.text.len());
        let start = self.marked.start.min(end);
        let before = self.text.get(..start).unwrap_or("").chars().count();
        let marked = self.text.get(start..end).unwrap_or("").chars().count();
        let all: Vec<char> = printable(&self.text).chars().collect();
        let wanted_from =
            (before + marked.min(EXCERPT_WIDTH / 2)).saturating_sub(EXCERPT_WIDTH - 4);
        let from = wanted_from.min(all.len());
        let to = all.len().min(from + EXCERPT_WIDTH);
        let mut text: String = all[from..to].iter().collect();
        if to < all.len() {
            text.push('…');
        }
        let cut = if from > 0 { "…" } else { "" };
        let indent = before.saturating_sub(from) + cut.chars().count();
        let width = marked.min(EXCERPT_WIDTH.saturating_sub(before.saturating_sub(from)));
        (format!("{cut}{text}"), indent, width)
    }
}

/// A path as it is said; `-` is standard input.
fn shown(path: &Path) -> String {
    match path == Path::new("-") {
        true => "standard input".into(),
        false => path.display().to_string(),
    }
}

/// Control characters would move the cursor of whoever reads the error.
fn printable(text: &str) -> String {
    text.chars()
        .map(|c| match c {
            '\t' => ' ',
            c if c.is_control() => '·',
            c => c,
        })
        .collect()
}

fn shortened(value: &str) -> String {
    let value = printable(value);
    if value.chars().count() <= EXCERPT_WIDTH {
        return value;
    }
    let head: String = value.chars().take(EXCERPT_WIDTH).collect();
    format!("{head}…")
}

/// Names in backticks for a note, cut after two dozen or three lines.
pub fn listed<'a>(names: impl IntoIterator<Item = &'a str>) -> String {
    let names: Vec<&str> = names.into_iter().collect();
    let (mut shown, mut width) = (Vec::new(), 0);
    for name in names.iter().take(LISTED_NAMES) {
        let name = format!("`{}`", shortened(name));
        width += name.chars().count() + 2;
        if width > LISTED_WIDTH {
            break;
        }
        shown.push(name);
    }
    let mut text = shown.join(", ");
    if names.len() > shown.len() {
        text.push_str(&format!(" and {} more", names.len() - shown.len()));
    }
    text
}

/// The candidate that a person most likely meant by `word`, if any is near enough.
pub fn nearest<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    // 0.72: `stifness`, `dampling`, `lambda_exponent` find their key, `colour` finds none.
    const NEAR_ENOUGH: f64 = 0.72;
    let word = word.to_lowercase();
    candidates
        .into_iter()
        .map(|name| (similarity(&word, &name.to_lowercase()), name))
        .filter(|(similarity, _)| *similarity >= NEAR_ENOUGH)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, name)| name)
}

/// Jaro–Winkler, which rates short words too low: there one slip (`fn` for `f_n`) is near.
fn similarity(a: &str, b: &str) -> f64 {
    let one_slip = a.len().max(b.len()) >= 3 && strsim::osa_distance(a, b) == 1;
    strsim::jaro_winkler(a, b).max(if one_slip { 0.9 } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_prints_on_one_screen_what_where_which_value_and_the_remedy() {
        let diagnostic = Diagnostic::new("text where a number should be")
            .in_file(Path::new("log.csv"))
            .at_line(17)
            .in_column("f_n")
            .excerpt("0.016,-0.0020,abc", 14..17)
            .value("abc")
            .remedy("write the force in newtons, or leave the row out");
        let expected = "\
error: text where a number should be
  --> log.csv:17, column f_n
   | 0.016,-0.0020,abc
   |               ^^^
   = value: `abc`
   = remedy: write the force in newtons, or leave the row out";
        assert_eq!(diagnostic.to_string(), expected);
    }

    #[test]
    fn a_long_line_is_cut_around_the_mark() {
        let text = format!("{}bad{}", "1,".repeat(300), ",2".repeat(300));
        let printed = Diagnostic::new("x").excerpt(text, 600..603).to_string();
        let lines: Vec<&str> = printed.lines().collect();
        assert!(
            lines.iter().all(|line| line.chars().count() <= 82),
            "{printed}"
        );
        let mark = lines[2].find('^').map(|at| lines[2][..at].chars().count());
        let bad = lines[1]
            .find("bad")
            .map(|at| lines[1][..at].chars().count());
        assert_eq!(mark, bad, "{printed}");
    }

    #[test]
    fn control_characters_do_not_reach_the_terminal() {
        let printed = Diagnostic::new("x")
            .excerpt("a\u{1b}[2Jb", 0..1)
            .value("\u{7}")
            .to_string();
        assert!(!printed.contains(['\u{1b}', '\u{7}']));
    }

    #[test]
    fn a_misspelt_name_finds_its_neighbour_and_a_strange_one_none() {
        let keys = ["stiffness", "damping", "exponent", "surface"];
        assert_eq!(nearest("stifness", keys), Some("stiffness"));
        assert_eq!(nearest("Dampling", keys), Some("damping"));
        assert_eq!(nearest("colour", keys), None);
        assert_eq!(nearest("fn", ["t_s", "f_n"]), Some("f_n"));
    }
}
