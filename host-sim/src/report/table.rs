//! Tables: each row has its name on the left, and numbers are aligned on the right.

use std::fmt::Write;

use super::html::escape;
use crate::number::{Measured, quantity};

/// One cell.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// A text.
    Text(String),
    /// A number that is already formatted.
    Number(String),
    /// A value with its standard error.
    Measured(Measured),
    /// The reason why there is no value.
    Missing(String),
}

impl Cell {
    /// A value with its standard error and unit; the standard error decides the digits.
    pub fn measured(value: f64, std_error: Option<f64>, unit: &str) -> Cell {
        Cell::Measured(Measured::new(value, std_error, unit))
    }

    /// A value with this number of significant digits.
    pub fn quantity(value: f64, digits: i32, unit: &str) -> Cell {
        Cell::Number(quantity(value, digits, unit))
    }

    /// A count.
    pub fn count(count: usize) -> Cell {
        Cell::Number(crate::number::fixed(count as f64, 0))
    }

    fn is_number(&self) -> bool {
        !matches!(self, Cell::Text(_))
    }

    fn html(&self) -> String {
        match self {
            Cell::Text(text) | Cell::Number(text) => escape(text).into_owned(),
            Cell::Missing(why) => format!("<span class=\"missing\">{}</span>", escape(why)),
            Cell::Measured(measured) => {
                let mut out = format!("<b>{}</b>", escape(&measured.value));
                if let Some(error) = &measured.std_error {
                    let _ = write!(out, " ± {}", escape(error));
                }
                if !measured.unit.is_empty() {
                    let unit = escape(&measured.unit);
                    let _ = write!(out, " <span class=\"unit\">{unit}</span>");
                }
                out
            }
        }
    }
}

impl From<&str> for Cell {
    fn from(text: &str) -> Cell {
        Cell::Text(text.into())
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Cell {
        Cell::Text(text)
    }
}

/// A table; the first cell of a row names it.
#[derive(Clone, Debug)]
pub struct Table {
    caption: String,
    columns: Vec<String>,
    rows: Vec<Vec<Cell>>,
    most_rows: usize,
}

/// Rows beyond the most that a table shows, up to which it shows them all: 16 touches where 14 are the most.
const SHOWN_BEYOND: usize = 5;

impl Table {
    /// A table with these columns and no rows.
    pub fn new<T: Into<String>>(columns: impl IntoIterator<Item = T>) -> Table {
        Table {
            caption: String::new(),
            columns: columns.into_iter().map(Into::into).collect(),
            rows: Vec::new(),
            most_rows: usize::MAX,
        }
    }

    /// Adds a column.
    pub fn column(mut self, heading: impl Into<String>) -> Table {
        self.columns.push(heading.into());
        self
    }

    /// Adds the caption, which says what the table shows.
    pub fn caption(mut self, caption: impl Into<String>) -> Table {
        self.caption = caption.into();
        self
    }

    /// Adds a row. Cells that are missing stay empty, and surplus cells are shown.
    pub fn row(mut self, cells: impl IntoIterator<Item = Cell>) -> Table {
        self.rows.push(cells.into_iter().collect());
        self
    }

    /// Adds rows.
    pub fn rows<R: IntoIterator<Item = Cell>>(
        mut self,
        rows: impl IntoIterator<Item = R>,
    ) -> Table {
        self.rows
            .extend(rows.into_iter().map(|row| row.into_iter().collect()));
        self
    }

    /// Sets the largest number of rows. A longer table shows its first and last rows, and how many rows
    /// were left out.
    pub fn at_most(mut self, rows: usize) -> Table {
        self.most_rows = rows.max(2);
        self
    }

    pub(super) fn push_html(&self, out: &mut String) {
        out.push_str("<div class=\"scroll\"><table>\n");
        if !self.caption.is_empty() {
            let _ = writeln!(
                out,
                "<caption><span>{}</span></caption>",
                escape(&self.caption)
            );
        }
        out.push_str("<thead><tr>");
        for (i, column) in self.columns.iter().enumerate() {
            let class = if self.is_numeric(i) {
                " class=\"num\""
            } else {
                ""
            };
            let _ = write!(out, "<th scope=\"col\"{class}>{}</th>", escape(column));
        }
        out.push_str("</tr></thead>\n<tbody>\n");
        let (head, left_out) = self.split();
        for row in &self.rows[..head] {
            push_row(row, out);
        }
        if left_out > 0 {
            let span = self.columns.len().max(1);
            let _ = writeln!(
                out,
                "<tr class=\"left-out\"><td colspan=\"{span}\">… {left_out} more …</td></tr>"
            );
        }
        for row in &self.rows[head + left_out..] {
            push_row(row, out);
        }
        out.push_str("</tbody>\n</table></div>\n");
    }

    /// The number of rows before the gap, and the number of rows that are left out in it.
    fn split(&self) -> (usize, usize) {
        match self.rows.len().checked_sub(self.most_rows) {
            // A gap is worth its line only if it saves a few.
            Some(surplus) if surplus > SHOWN_BEYOND => (self.most_rows.div_ceil(2), surplus),
            _ => (self.rows.len(), 0),
        }
    }

    fn is_numeric(&self, column: usize) -> bool {
        column > 0
            && self
                .rows
                .iter()
                .filter_map(|row| row.get(column))
                .any(Cell::is_number)
    }
}

fn push_row(row: &[Cell], out: &mut String) {
    out.push_str("<tr>");
    for (i, cell) in row.iter().enumerate() {
        let html = cell.html();
        let _ = match (i, cell.is_number()) {
            (0, _) => write!(out, "<th scope=\"row\">{html}</th>"),
            (_, true) => write!(out, "<td class=\"num\">{html}</td>"),
            (_, false) => write!(out, "<td>{html}</td>"),
        };
    }
    out.push_str("</tr>\n");
}

#[cfg(test)]
mod tests {
    use super::*;

    fn html(table: &Table) -> String {
        let mut out = String::new();
        table.push_html(&mut out);
        out
    }

    #[test]
    fn a_value_that_is_not_observable_says_so() {
        let table = Table::new(["a", "b"]).row([
            Cell::from("Damping"),
            Cell::Missing("not observable".into()),
        ]);
        assert!(html(&table).contains("not observable</span></td>"));
    }

    #[test]
    fn a_long_table_shows_its_ends_and_counts_the_rest() {
        let rows = |n: usize| (0..n).map(|i| [Cell::count(i)]);
        let long = html(&Table::new(["n"]).rows(rows(30)).at_most(11));
        assert_eq!(long.matches("<tr><th scope=\"row\"").count(), 11);
        assert!(long.contains("… 19 more …"));
        assert!(long.contains(">0<") && long.contains(">29<"));
        let just = html(&Table::new(["n"]).rows(rows(12)).at_most(11));
        assert_eq!(just.matches("<tr><th scope=\"row\"").count(), 12);
    }

    #[test]
    fn a_table_without_rows_or_columns_is_still_a_table() {
        let empty = html(&Table::new(Vec::<String>::new()));
        assert!(roxmltree::Document::parse(&empty).is_ok());
    }
}
