//! A table whose cells are shaded by their values, as a map of two quantities.
//!
//! It is a table and no drawing, so that every cell can be read, also by a screen reader.

use std::fmt::Write;

use super::html::escape;

/// The number of shades. The style sheet has a colour for each.
pub(crate) const SHADES: usize = 7;

/// One cell.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Shaded {
    /// The number.
    pub text: String,
    /// A smaller text under the number; it may be empty.
    pub small: String,
    /// The shade, from 0 (none) to 6.
    pub shade: usize,
}

/// Rows and columns of shaded cells.
#[derive(Clone, Debug)]
pub struct HeatMap {
    caption: String,
    corner: String,
    columns: Vec<String>,
    rows: Vec<(String, Vec<Option<Shaded>>)>,
}

impl HeatMap {
    /// A map without rows; `corner` names what the rows and the columns are.
    pub fn new<T: Into<String>>(
        corner: impl Into<String>,
        columns: impl IntoIterator<Item = T>,
    ) -> HeatMap {
        HeatMap {
            caption: String::new(),
            corner: corner.into(),
            columns: columns.into_iter().map(Into::into).collect(),
            rows: Vec::new(),
        }
    }

    /// Adds the caption, which says what the map shows.
    pub fn caption(mut self, caption: impl Into<String>) -> HeatMap {
        self.caption = caption.into();
        self
    }

    /// Adds a row; a cell that is `None` has no value.
    pub fn row(mut self, name: impl Into<String>, cells: Vec<Option<Shaded>>) -> HeatMap {
        self.rows.push((name.into(), cells));
        self
    }

    pub(super) fn push_html(&self, out: &mut String) {
        // Writing into a String cannot fail.
        let _ = write!(
            out,
            "<div class=\"scroll\"><table class=\"heat\">\n<caption>{}</caption>\n<thead><tr><th>{}</th>",
            escape(&self.caption),
            escape(&self.corner)
        );
        for column in &self.columns {
            let _ = write!(out, "<th scope=\"col\">{}</th>", escape(column));
        }
        out.push_str("</tr></thead>\n<tbody>\n");
        for (name, cells) in &self.rows {
            let _ = write!(out, "<tr><th scope=\"row\">{}</th>", escape(name));
            for cell in cells {
                let _ = match cell {
                    None => write!(out, "<td class=\"h0 missing\">–</td>"),
                    Some(cell) => write!(
                        out,
                        "<td class=\"h{}\">{}<small>{}</small></td>",
                        cell.shade.min(SHADES - 1),
                        escape(&cell.text),
                        escape(&cell.small)
                    ),
                };
            }
            out.push_str("</tr>\n");
        }
        out.push_str("</tbody>\n</table></div>\n");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_escaped_empty_ones_are_dashes_and_every_shade_has_a_rule() {
        let cell = Shaded {
            text: "<b>".into(),
            small: "&".into(),
            shade: 99,
        };
        let map = HeatMap::new("a", ["b", "c"]).row("r", vec![Some(cell), None]);
        let mut html = String::new();
        map.push_html(&mut html);
        assert!(
            html.contains("class=\"h6\">&lt;b&gt;<small>&amp;</small>"),
            "{html}"
        );
        assert!(html.contains("–</td>"), "{html}");
        roxmltree::Document::parse(&html).unwrap();
        let style = include_str!("style.css");
        assert!((0..SHADES).all(|shade| style.contains(&format!(".h{shade} "))));
    }
}
