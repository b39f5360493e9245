//! TOML tables read key by key, with errors that name line, key, value and remedy.
//!
//! A [`Table`] remembers which keys were asked for; [`Table::finish`] refuses every other, with the
//! nearest key that would have been understood.

mod bounds;
mod wrong_file;

pub use bounds::Bounds;

use std::cell::RefCell;
use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};

use toml_edit::{Document, Item, TableLike, Value};

use crate::diagnostic::{Diagnostic, listed, nearest};

/// A parsed TOML file.
#[derive(Debug)]
pub struct TomlFile {
    path: PathBuf,
    document: Document<String>,
}

impl TomlFile {
    /// Reads and parses a file.
    ///
    /// # Errors
    /// A file that cannot be read or is no TOML, with the line.
    pub fn read(path: &Path) -> Result<TomlFile, Diagnostic> {
        let text =
            fs::read_to_string(path).map_err(|error| wrong_file::unreadable(path, &error))?;
        match wrong_file::not_toml(&text) {
            None => TomlFile::parse(text, path),
            Some(wrong) => Err(wrong.in_file(path)),
        }
    }

    /// Parses a text; `path` is for its errors.
    ///
    /// # Errors
    /// Text that is no TOML, with the line.
    pub fn parse(text: String, path: &Path) -> Result<TomlFile, Diagnostic> {
        match Document::parse(text.clone()) {
            Ok(document) => Ok(TomlFile {
                path: path.to_path_buf(),
                document,
            }),
            Err(error) => Err(mark(
                Diagnostic::new(format!("not TOML: {}", error.message().trim())),
                path,
                &text,
                error.span(),
            )
            .remedy(wrong_file::FORM)),
        }
    }

    /// The table of everything.
    pub fn root(&self) -> Table<'_> {
        Table::new(self, self.document.as_table(), String::new(), None)
    }

    fn diagnostic(&self, what: impl Into<String>, span: Option<Range<usize>>) -> Diagnostic {
        mark(Diagnostic::new(what), &self.path, self.document.raw(), span)
    }
}

/// Adds file, line and the marked line.
fn mark(diagnostic: Diagnostic, path: &Path, text: &str, span: Option<Range<usize>>) -> Diagnostic {
    let diagnostic = diagnostic.in_file(path);
    let Some(span) = span else {
        return diagnostic;
    };
    let from = span.start.min(text.len());
    let start = text[..from].rfind('\n').map_or(0, |at| at + 1);
    let end = text[from..].find('\n').map_or(text.len(), |at| from + at);
    let line = text[..from].matches('\n').count() + 1;
    let marked = from - start..span.end.clamp(from, end) - start;
    diagnostic
        .at_line(line)
        .excerpt(text[start..end].trim_end(), marked)
}

/// A table of a [`TomlFile`] and the keys that are understood in it: those that were asked for.
pub struct Table<'a> {
    file: &'a TomlFile,
    items: &'a dyn TableLike,
    name: String,
    span: Option<Range<usize>>,
    understood: RefCell<Vec<String>>,
}

impl<'a> Table<'a> {
    fn new(
        file: &'a TomlFile,
        items: &'a dyn TableLike,
        name: String,
        span: Option<Range<usize>>,
    ) -> Self {
        Table {
            file,
            items,
            name,
            span,
            understood: RefCell::new(Vec::new()),
        }
    }

    /// A number, if the key is there.
    ///
    /// # Errors
    /// Not a number, or outside `bounds`.
    pub fn number(&self, key: &str, bounds: Bounds) -> Result<Option<f64>, Diagnostic> {
        self.ask(key)
            .map(|item| self.as_number(key, item, bounds))
            .transpose()
    }

    /// A number that must be there.
    ///
    /// # Errors
    /// Missing, not a number, or outside `bounds`.
    pub fn required_number(&self, key: &str, bounds: Bounds) -> Result<f64, Diagnostic> {
        let number = self.number(key, bounds)?;
        number.ok_or_else(|| self.missing(key, &bounds::say(bounds)))
    }

    /// A list of numbers, if the key is there.
    ///
    /// # Errors
    /// Not a list of numbers within `bounds`.
    pub fn numbers(&self, key: &str, bounds: Bounds) -> Result<Option<Vec<f64>>, Diagnostic> {
        let convert = |value: &Value| self.value_as_number(key, value, bounds);
        self.list(key, "a list of numbers", convert)
    }

    /// A text, if the key is there.
    ///
    /// # Errors
    /// Not a text.
    pub fn text(&self, key: &str) -> Result<Option<&'a str>, Diagnostic> {
        self.ask(key)
            .map(|item| {
                let text = item.as_str();
                text.ok_or_else(|| self.wrong_type(key, item, "text in double quotes"))
            })
            .transpose()
    }

    /// A text that must be there; `such_as` are examples for the error.
    ///
    /// # Errors
    /// Missing, or not a text.
    pub fn required_text(&self, key: &str, such_as: &[&str]) -> Result<&'a str, Diagnostic> {
        self.text(key)?.ok_or_else(|| {
            self.missing(key, &format!("one of {}", listed(such_as.iter().copied())))
        })
    }

    /// A list of texts, empty if the key is missing.
    ///
    /// # Errors
    /// Not a list of texts.
    pub fn texts(&self, key: &str) -> Result<Vec<String>, Diagnostic> {
        let convert = |value: &Value| {
            let text = value.as_str().map(str::to_string);
            text.ok_or_else(|| self.wrong_value(key, value, "text in double quotes"))
        };
        Ok(self
            .list(key, "a list of texts", convert)?
            .unwrap_or_default())
    }

    /// A table below this one, if the key is there.
    ///
    /// # Errors
    /// Not a table.
    pub fn table(&self, key: &str) -> Result<Option<Table<'a>>, Diagnostic> {
        let Some(item) = self.ask(key) else {
            return Ok(None);
        };
        let Some(items) = item.as_table_like() else {
            return Err(self.wrong_type(key, item, &format!("a table, [{key}]")));
        };
        Ok(Some(Table::new(
            self.file,
            items,
            self.path_of(key),
            item.span(),
        )))
    }

    /// A list of tables (`[[key]]` or `[{…}, …]`), empty if the key is missing.
    ///
    /// # Errors
    /// Not a list of tables.
    pub fn tables(&self, key: &str) -> Result<Vec<Table<'a>>, Diagnostic> {
        let Some(item) = self.ask(key) else {
            return Ok(Vec::new());
        };
        let wanted = format!("a list of tables, [[{key}]]");
        let name = |index: usize| format!("{}[{}]", self.path_of(key), index + 1);
        if let Some(tables) = item.as_array_of_tables() {
            let tables = tables.iter().enumerate();
            return Ok(tables
                .map(|(index, table)| Table::new(self.file, table, name(index), table.span()))
                .collect());
        }
        let array = item
            .as_array()
            .ok_or_else(|| self.wrong_type(key, item, &wanted))?;
        let inline = array.iter().enumerate().map(|(index, value)| {
            let table = value.as_inline_table();
            let table = table.ok_or_else(|| self.wrong_value(key, value, &wanted))?;
            Ok(Table::new(self.file, table, name(index), table.span()))
        });
        inline.collect()
    }

    /// Names keys that will be asked for, so that an error before that lists them too.
    pub fn understand(&self, keys: &[&str]) {
        let mut understood = self.understood.borrow_mut();
        for key in keys {
            if !understood.iter().any(|known| known == key) {
                understood.push((*key).to_string());
            }
        }
    }

    /// The keys that are not understood so far, in the order of the file.
    pub fn remaining_keys(&self) -> Vec<String> {
        let understood = self.understood.borrow();
        let keys = self.items.iter().map(|(key, _)| key.to_string());
        keys.filter(|key| !understood.contains(key)).collect()
    }

    /// Refuses keys that nobody asked for.
    ///
    /// # Errors
    /// The first such key, the nearest one that is understood here, and all of them.
    pub fn finish(&self) -> Result<(), Diagnostic> {
        match self.remaining_keys().first() {
            None => Ok(()),
            Some(key) => Err(self.unknown(key)),
        }
    }

    /// An error about the value of `key` in this table.
    pub fn wrong(&self, key: &str, what: impl Into<String>) -> Diagnostic {
        let item = self.items.get(key);
        let span = item.and_then(Item::span).or_else(|| self.key_span(key));
        let diagnostic = self
            .file
            .diagnostic(what, span.or_else(|| self.span.clone()));
        let diagnostic = diagnostic.at_key(&self.path_of(key));
        match item.and_then(Item::as_value) {
            Some(value) => diagnostic.value(plain(value)),
            None => diagnostic,
        }
    }

    /// An error about this table as a whole.
    pub fn wrong_table(&self, what: impl Into<String>) -> Diagnostic {
        self.file.diagnostic(what, self.span.clone())
    }

    /// Line of this table in the file, from 1; `None` for the root.
    pub fn line(&self) -> Option<usize> {
        self.wrong_table("").line
    }

    fn ask(&self, key: &str) -> Option<&'a Item> {
        self.understand(&[key]);
        self.items.get(key)
    }

    fn list<T>(
        &self,
        key: &str,
        wanted: &str,
        convert: impl Fn(&Value) -> Result<T, Diagnostic>,
    ) -> Result<Option<Vec<T>>, Diagnostic> {
        let Some(item) = self.ask(key) else {
            return Ok(None);
        };
        let array = item
            .as_array()
            .ok_or_else(|| self.wrong_type(key, item, wanted))?;
        array
            .iter()
            .map(convert)
            .collect::<Result<_, _>>()
            .map(Some)
    }

    fn as_number(&self, key: &str, item: &Item, bounds: Bounds) -> Result<f64, Diagnostic> {
        match item.as_value() {
            Some(value) => self.value_as_number(key, value, bounds),
            None => Err(self.wrong_type(key, item, &bounds::say(bounds))),
        }
    }

    fn value_as_number(&self, key: &str, value: &Value, bounds: Bounds) -> Result<f64, Diagnostic> {
        let whole = || value.as_integer().map(|whole| whole as f64);
        match value.as_float().or_else(whole) {
            None => Err(self.wrong_value(key, value, &bounds::say(bounds))),
            Some(number) if bounds.allow(number) => Ok(number),
            Some(_) => {
                let mut diagnostic = self.wrong_value(key, value, &bounds::say(bounds));
                diagnostic.what = "a number outside its bounds".into();
                Err(diagnostic)
            }
        }
    }

    fn wrong_type(&self, key: &str, item: &Item, wanted: &str) -> Diagnostic {
        match item.as_value() {
            Some(value) => self.wrong_value(key, value, wanted),
            None => self
                .wrong(key, another_type(item.type_name()))
                .remedy(format!("`{key}` is {wanted}")),
        }
    }

    fn wrong_value(&self, key: &str, value: &Value, wanted: &str) -> Diagnostic {
        self.file
            .diagnostic(another_type(value.type_name()), value.span())
            .at_key(&self.path_of(key))
            .value(plain(value))
            .remedy(format!("`{key}` is {wanted}"))
    }

    /// A key that must be there is not; if a misspelt one is, that is the error.
    fn missing(&self, key: &str, wanted: &str) -> Diagnostic {
        let remaining = self.remaining_keys();
        if let Some(misspelt) = nearest(key, remaining.iter().map(String::as_str)) {
            return self.unknown(misspelt);
        }
        self.file
            .diagnostic(format!("the key `{key}` is missing"), self.span.clone())
            .at_key(&self.path_of(key))
            .remedy(format!("add `{key}`, {wanted}"))
    }

    fn unknown(&self, key: &str) -> Diagnostic {
        let understood = self.understood.borrow();
        let known = || understood.iter().map(String::as_str);
        let place = match self.name.as_str() {
            "" => "the file".to_string(),
            name => format!("`{name}`"),
        };
        let diagnostic = self
            .file
            .diagnostic(
                format!("unknown key `{key}` in {place}"),
                self.key_span(key),
            )
            .at_key(&self.path_of(key))
            .value(key)
            .note(format!("the keys here are {}", listed(known())));
        match nearest(key, known()) {
            Some(near) => diagnostic.remedy(format!("write `{near}`, or remove it")),
            None => diagnostic.remedy("remove it"),
        }
    }

    fn key_span(&self, key: &str) -> Option<Range<usize>> {
        self.items.key(key).and_then(toml_edit::Key::span)
    }

    fn path_of(&self, key: &str) -> String {
        match self.name.as_str() {
            "" => key.to_string(),
            name => format!("{name}.{key}"),
        }
    }
}

/// A value without quotes and the blanks around it.
fn plain(value: &Value) -> String {
    match value.as_str() {
        Some(text) => text.to_string(),
        None => value.to_string().trim().to_string(),
    }
}

/// What is wrong with a value of this type, as TOML names it.
fn another_type(name: &str) -> String {
    let article = if name.starts_with(['a', 'i']) {
        "an"
    } else {
        "a"
    };
    format!("{article} {name} where something else should be")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> TomlFile {
        TomlFile::parse(text.to_string(), Path::new("m.toml")).unwrap()
    }

    #[test]
    fn an_unknown_key_is_named_with_its_line_and_the_nearest_one() {
        let file = parse("# rig 3\n[sensors]\nforce_noize = 1.0\n");
        let table = file.root().table("sensors").unwrap().unwrap();
        assert_eq!(table.number("force_noise", Bounds::Positive).unwrap(), None);
        let error = table.finish().unwrap_err();
        let expected = "\
error: unknown key `force_noize` in `sensors`
  --> m.toml:3, key sensors.force_noize
   | force_noize = 1.0
   | ^^^^^^^^^^^
   = value: `force_noize`
   = note: the keys here are `force_noise`
   = remedy: write `force_noise`, or remove it";
        assert_eq!(error.to_string(), expected);
    }

    #[test]
    fn a_misspelt_required_key_is_the_error_not_the_missing_one() {
        let file = parse("stifness = 3.0\n");
        let error = file
            .root()
            .required_number("stiffness", Bounds::Positive)
            .unwrap_err();
        assert!(error.what.contains("unknown key `stifness`"), "{error}");
        let error = parse("colour = 1")
            .root()
            .required_number("mass", Bounds::Any)
            .unwrap_err();
        assert!(error.what.contains("`mass` is missing"), "{error}");
    }

    #[test]
    fn wrong_types_and_bounds_are_named_with_value_and_remedy() {
        let file = parse("a = \"soft\"\nb = -1\nc = nan\nd = [1.0, \"x\"]\n[t]\n");
        let root = file.root();
        for (error, line, value, remedy) in [
            (
                root.number("a", Bounds::Any).unwrap_err(),
                1,
                Some("soft"),
                "a finite number",
            ),
            (
                root.number("b", Bounds::Positive).unwrap_err(),
                2,
                Some("-1"),
                "greater than 0",
            ),
            (
                root.number("c", Bounds::Any).unwrap_err(),
                3,
                Some("nan"),
                "finite",
            ),
            (
                root.numbers("d", Bounds::Any).unwrap_err(),
                4,
                Some("x"),
                "finite",
            ),
            (
                root.number("t", Bounds::Any).unwrap_err(),
                5,
                None,
                "finite",
            ),
            (root.text("b").unwrap_err(), 2, Some("-1"), "text"),
            (root.tables("b").err().unwrap(), 2, Some("-1"), "[[b]]"),
        ] {
            assert_eq!(error.line, Some(line), "{error}");
            assert_eq!(error.value.as_deref(), value, "{error}");
            assert!(error.remedy.as_ref().unwrap().contains(remedy), "{error}");
        }
    }

    #[test]
    fn whole_numbers_are_numbers_and_tables_come_in_both_forms() {
        let file = parse("x = 3\nmodes = [{ rate = 1 }, { rate = 2 }]\n[[e]]\nrate = 7\n");
        let root = file.root();
        assert_eq!(root.number("x", Bounds::Any).unwrap(), Some(3.0));
        let rates = |key: &str| -> Vec<f64> {
            let tables = root.tables(key).unwrap();
            tables
                .iter()
                .map(|t| t.required_number("rate", Bounds::Any).unwrap())
                .collect()
        };
        assert_eq!(rates("modes"), [1.0, 2.0]);
        assert_eq!(rates("e"), [7.0]);
        assert_eq!(root.tables("e").unwrap()[0].line(), Some(3));
        root.finish().unwrap();
    }

    #[test]
    fn what_is_no_toml_is_named_with_its_line() {
        let error = TomlFile::parse("a = 1\nb = = 2\n".into(), Path::new("m.toml")).unwrap_err();
        assert_eq!(error.line, Some(2), "{error}");
        assert!(error.what.starts_with("not TOML"));
    }
}
