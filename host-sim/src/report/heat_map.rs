//! A table whose cells are shaded by their values, as a map of two quantities.
//!
//! It is a table and no drawing, so that every cell can be read, also by a screen reader. The shade follows the
//! logarithm of the value, and a scale below the map says which shade is which value.

use std::fmt::Write;

use super::html::escape;

/// One cell.
#[derive(Clone, Debug, PartialEq)]
pub struct Shaded {
    /// The number.
    pub text: String,
    /// A smaller text under the number; it may be empty.
    pub small: String,
    /// What the cell is shaded by, in the unit of the scale. `None` is beyond every value, such as a system that
    /// does not come to rest, and hatched.
    pub value: Option<f64>,
}

/// What the shades mean: none at `from` and below, the darkest at `to` and above, by the logarithm in between.
#[derive(Clone, Debug, PartialEq)]
pub struct HeatScale {
    /// What is shaded.
    pub name: &'static str,
    /// The value of no shade, greater than 0.
    pub from: f64,
    /// The value of the darkest shade.
    pub to: f64,
    /// The values that the scale names, from the first to the last, each with its text.
    pub ticks: Vec<(f64, String)>,
    /// What a hatched cell means; empty where there are none.
    pub beyond: &'static str,
}

/// Above this share of the scale light letters are easier to read.
const DEEP: f64 = 0.62;

impl HeatScale {
    /// The share of the way from no shade to the darkest.
    fn share(&self, value: f64) -> f64 {
        let share = (value / self.from).ln() / (self.to / self.from).ln();
        share.clamp(0.0, 1.0)
    }

    fn push_html(&self, out: &mut String) {
        let _ = write!(
            out,
            "<div class=\"scale\"><span>{}, logarithmic:</span> <span class=\"bar\">",
            escape(self.name)
        );
        for (at, text) in &self.ticks {
            let left = 100.0 * self.share(*at);
            let _ = write!(
                out,
                "<span style=\"left:{left:.0}%\">{}</span>",
                escape(text)
            );
        }
        out.push_str("</span>");
        if !self.beyond.is_empty() {
            let _ = write!(out, " <span>hatched: {}</span>", escape(self.beyond));
        }
        out.push_str("</div>\n");
    }
}

/// Rows and columns of shaded cells.
#[derive(Clone, Debug)]
pub struct HeatMap {
    caption: String,
    corner: String,
    scale: HeatScale,
    columns: Vec<String>,
    rows: Vec<(String, Vec<Option<Shaded>>)>,
}

impl HeatMap {
    /// A map without rows; `corner` names what the rows and the columns are.
    pub fn new<T: Into<String>>(
        corner: impl Into<String>,
        columns: impl IntoIterator<Item = T>,
        scale: HeatScale,
    ) -> HeatMap {
        HeatMap {
            caption: String::new(),
            corner: corner.into(),
            scale,
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
            "<div class=\"map\">\n<div class=\"scroll\"><table class=\"heat\">\n<caption><span>{}</span></caption>\n<thead><tr><th>{}</th>",
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
                self.push_cell(cell.as_ref(), out);
            }
            out.push_str("</tr>\n");
        }
        out.push_str("</tbody>\n</table></div>\n");
        self.scale.push_html(out);
        out.push_str("</div>\n");
    }

    fn push_cell(&self, cell: Option<&Shaded>, out: &mut String) {
        let Some(cell) = cell else {
            out.push_str("<td class=\"missing\">–</td>");
            return;
        };
        let _ = match cell.value.map(|value| self.scale.share(value)) {
            None => write!(out, "<td class=\"beyond\">"),
            Some(share) if share > DEEP => {
                write!(out, "<td class=\"deep\" style=\"--s:{share:.2}\">")
            }
            Some(share) => write!(out, "<td style=\"--s:{share:.2}\">"),
        };
        let _ = write!(
            out,
            "<span>{}</span><small>{}</small></td>",
            escape(&cell.text),
            escape(&cell.small)
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scale() -> HeatScale {
        HeatScale {
            name: "error",
            from: 1.0,
            to: 100.0,
            ticks: vec![(1.0, "1".into()), (100.0, "100".into())],
            beyond: "<never>",
        }
    }

    fn cell(value: Option<f64>) -> Option<Shaded> {
        Some(Shaded {
            text: "<b>".into(),
            small: "&".into(),
            value,
        })
    }

    fn html(cells: Vec<Option<Shaded>>) -> String {
        let mut html = String::new();
        HeatMap::new("a", ["b"; 4], scale())
            .row("r", cells)
            .push_html(&mut html);
        roxmltree::Document::parse(&html).unwrap();
        html
    }

    #[test]
    fn texts_are_escaped_an_empty_cell_is_a_dash_and_one_beyond_all_is_hatched() {
        let html = html(vec![cell(Some(1.0)), None, cell(None)]);
        assert!(
            html.contains("<span>&lt;b&gt;</span><small>&amp;</small>"),
            "{html}"
        );
        assert!(html.contains("–</td>"), "{html}");
        assert!(html.contains("<td class=\"beyond\">"), "{html}");
        assert!(html.contains("hatched: &lt;never&gt;"), "{html}");
    }

    #[test]
    fn ten_times_the_value_is_the_same_step_of_shade_anywhere() {
        let html = html(vec![
            cell(Some(0.1)),
            cell(Some(1.0)),
            cell(Some(10.0)),
            cell(Some(1e4)),
        ]);
        for shade in ["--s:0.00", "--s:0.50", "--s:1.00"] {
            assert!(html.contains(shade), "{shade} {html}");
        }
    }
}
