//! The page of a report: the verdict, the tables and figures that support it, the provenance.

use std::fmt::Write as _;
use std::io;
use std::path::Path;

use super::html::escape;
use super::{Figure, HeatMap, Provenance, Table};
use crate::output::write_atomically;

const STYLE: &str = include_str!("style.css");
const SCRIPT: &str = include_str!("script.js");
/// Nothing is fetched from anywhere, whatever a browser finds in the page.
const POLICY: &str = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'";
/// A page with fewer sections needs no contents.
const FEWEST_FOR_CONTENTS: usize = 4;

/// How good the result is. The page shows it by a sign and a word as well as by a colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tone {
    /// The result is as it should be.
    Good,
    /// The result is usable with a reservation.
    Warning,
    /// The result is not usable.
    Bad,
    /// There is no result to judge.
    Neutral,
}

impl Tone {
    fn class(self) -> &'static str {
        match self {
            Tone::Good => "good",
            Tone::Warning => "warning",
            Tone::Bad => "bad",
            Tone::Neutral => "neutral",
        }
    }

    fn sign(self) -> &'static str {
        match self {
            Tone::Good => "✓",
            Tone::Warning => "!",
            Tone::Bad => "✕",
            Tone::Neutral => "–",
        }
    }
}

/// A report under construction.
///
/// ```
/// use palpate::report::{Cell, Document, Section, Table, Tone};
///
/// let table = Table::new(["Parameter", "Value"])
///     .row([Cell::from("Stiffness K"), Cell::measured(1352.2, Some(3.4), "N/m")]);
/// let html = Document::new("Estimate of gel.csv")
///     .verdict(Tone::Good, "converged", "The gel is a Hunt–Crossley contact.")
///     .section(Section::new("Result").table(table))
///     .to_html();
/// assert!(html.contains("<b>1352.2</b> ± 3.4"));
/// ```
#[derive(Clone, Debug)]
pub struct Document {
    title: String,
    verdict: Option<(Tone, String, String)>,
    sections: Vec<Section>,
    provenance: Option<Provenance>,
}

impl Document {
    /// An empty report.
    pub fn new(title: impl Into<String>) -> Document {
        Document {
            title: title.into(),
            verdict: None,
            sections: Vec::new(),
            provenance: None,
        }
    }

    /// The sentence that says the result, with a badge of one or two words before it.
    pub fn verdict(
        mut self,
        tone: Tone,
        badge: impl Into<String>,
        sentence: impl Into<String>,
    ) -> Document {
        self.verdict = Some((tone, badge.into(), sentence.into()));
        self
    }

    /// Adds a section.
    pub fn section(mut self, section: Section) -> Document {
        self.sections.push(section);
        self
    }

    /// Adds a section behind the first `at`.
    pub fn section_at(mut self, at: usize, section: Section) -> Document {
        self.sections.insert(at.min(self.sections.len()), section);
        self
    }

    /// Adds what the report was made from, which stands at the end.
    pub fn provenance(mut self, provenance: Provenance) -> Document {
        self.provenance = Some(provenance);
        self
    }

    /// The whole page.
    pub fn to_html(&self) -> String {
        let title = escape(&self.title);
        let mut out = format!(
            "<!DOCTYPE html>\n<html lang=\"en\" xmlns=\"http://www.w3.org/1999/xhtml\">\n<head>\n\
             <meta charset=\"utf-8\"/>\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n\
             <meta http-equiv=\"Content-Security-Policy\" content=\"{POLICY}\"/>\n\
             <meta name=\"generator\" content=\"palpate {}\"/>\n\
             <title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n<main>\n\
             <header>\n<p class=\"brand\">Palpate</p>\n<h1>{title}</h1>\n",
            env!("CARGO_PKG_VERSION"),
        );
        if let Some((tone, badge, sentence)) = &self.verdict {
            let _ = writeln!(
                out,
                "<p class=\"verdict {}\"><span class=\"badge\"><span aria-hidden=\"true\">{}</span> \
                 {}</span> <span class=\"sentence\">{}</span></p>",
                tone.class(),
                tone.sign(),
                escape(badge),
                escape(sentence),
            );
        }
        out.push_str("</header>\n");
        self.push_contents(&mut out);
        let mut figures = 0;
        for (section, number) in self.sections.iter().zip(1..) {
            section.push_html(&mut out, number, &mut figures);
        }
        if let Some(provenance) = &self.provenance {
            provenance.push_html(&mut out);
        }
        let _ = write!(
            out,
            "</main>\n<script>\n//<![CDATA[\n{SCRIPT}//]]>\n</script>\n</body>\n</html>\n"
        );
        out
    }

    /// The headings of a long page, each with a link.
    fn push_contents(&self, out: &mut String) {
        let headed = || {
            let numbered = self.sections.iter().zip(1..);
            numbered.filter(|(section, _): &(_, usize)| !section.heading.is_empty())
        };
        if headed().count() < FEWEST_FOR_CONTENTS {
            return;
        }
        out.push_str("<nav class=\"contents\" aria-label=\"Contents\">\n<ol>\n");
        for (section, number) in headed() {
            let heading = escape(&section.heading);
            let _ = writeln!(out, "<li><a href=\"#s{number}\">{heading}</a></li>");
        }
        if self.provenance.is_some() {
            out.push_str("<li><a href=\"#provenance\">Provenance</a></li>\n");
        }
        out.push_str("</ol>\n</nav>\n");
    }

    /// Writes the page. A reader of `path` sees the old file or the new one, never half of a file.
    pub fn write(&self, path: &Path) -> io::Result<()> {
        write_atomically(path, |out| out.write_all(self.to_html().as_bytes()))
    }
}

#[derive(Clone, Debug)]
enum Block {
    Text(String),
    List(Vec<String>),
    Table(Table),
    HeatMap(HeatMap),
    Figure(Figure),
}

impl Block {
    /// Tables stand beside each other where there is room, and so do figures.
    fn group(&self) -> Option<&'static str> {
        match self {
            Block::Table(_) | Block::HeatMap(_) => Some("tables"),
            Block::Figure(_) => Some("figures"),
            _ => None,
        }
    }
}

/// A heading with text, tables and figures below, in the order in which they were added.
#[derive(Clone, Debug)]
pub struct Section {
    heading: String,
    blocks: Vec<Block>,
}

impl Section {
    /// A section without contents. A section with an empty heading continues the one before it.
    pub fn new(heading: impl Into<String>) -> Section {
        Section {
            heading: heading.into(),
            blocks: Vec::new(),
        }
    }

    /// Adds a paragraph, unless it is empty.
    pub fn text(mut self, text: impl Into<String>) -> Section {
        let text = text.into();
        if !text.is_empty() {
            self.blocks.push(Block::Text(text));
        }
        self
    }

    /// Adds a list, unless it is empty.
    pub fn list<T: Into<String>>(mut self, items: impl IntoIterator<Item = T>) -> Section {
        let items: Vec<String> = items.into_iter().map(Into::into).collect();
        if !items.is_empty() {
            self.blocks.push(Block::List(items));
        }
        self
    }

    /// Adds a table.
    pub fn table(mut self, table: Table) -> Section {
        self.blocks.push(Block::Table(table));
        self
    }

    /// Adds a table of shaded cells.
    pub fn heat_map(mut self, map: HeatMap) -> Section {
        self.blocks.push(Block::HeatMap(map));
        self
    }

    /// Adds a figure.
    pub fn figure(mut self, figure: Figure) -> Section {
        self.blocks.push(Block::Figure(figure));
        self
    }

    /// Whether the section has no contents.
    pub fn is_empty(&self) -> bool {
        self.blocks.is_empty()
    }

    fn push_html(&self, out: &mut String, number: usize, figures: &mut usize) {
        let _ = writeln!(out, "<section id=\"s{number}\">");
        if !self.heading.is_empty() {
            let _ = writeln!(out, "<h2>{}</h2>", escape(&self.heading));
        }
        let mut group = None;
        for block in &self.blocks {
            if block.group() != group {
                if group.is_some() {
                    out.push_str("</div>\n");
                }
                if let Some(class) = block.group() {
                    let _ = writeln!(out, "<div class=\"{class}\">");
                }
                group = block.group();
            }
            push_block(block, out, figures);
        }
        out.push_str(if group.is_some() { "</div>\n" } else { "" });
        out.push_str("</section>\n");
    }
}

fn push_block(block: &Block, out: &mut String, figures: &mut usize) {
    match block {
        Block::Text(text) => {
            let _ = writeln!(out, "<p>{}</p>", escape(text));
        }
        Block::List(items) => {
            out.push_str("<ul>\n");
            for item in items {
                let _ = writeln!(out, "<li>{}</li>", escape(item));
            }
            out.push_str("</ul>\n");
        }
        Block::Table(table) => table.push_html(out),
        Block::HeatMap(map) => map.push_html(out),
        Block::Figure(figure) => {
            *figures += 1;
            figure.push_html(out, *figures);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::Cell;
    use crate::report::plot::{Axis, Chart, Series};
    use std::fs;

    const EVIL: &str = "<script>alert(\"x\")</script> & 'y'";

    fn everything() -> Document {
        let chart = Chart::new(Axis::new(EVIL, EVIL), Axis::new(EVIL, "N"))
            .series(Series::measured(EVIL, vec![0.0, 1.0], vec![0.0, 1.0]))
            .series(Series::estimated("b", vec![0.0, 1.0], vec![0.0, 1.0]));
        let table = Table::new([EVIL, "v"])
            .caption(EVIL)
            .row([Cell::from(EVIL), Cell::measured(1.0, Some(0.1), EVIL)]);
        Document::new(EVIL)
            .verdict(Tone::Bad, EVIL, EVIL)
            .section(
                Section::new(EVIL)
                    .text(EVIL)
                    .list([EVIL])
                    .table(table)
                    .figure(Figure::new(EVIL, &chart).caption(EVIL)),
            )
            .provenance(
                Provenance::new(EVIL)
                    .input(super::super::Input::new(EVIL, EVIL))
                    .setting(EVIL, EVIL),
            )
    }

    #[test]
    fn no_text_of_the_caller_becomes_markup_and_the_page_is_well_formed() {
        let html = everything().to_html();
        // The page's own, and no other.
        assert_eq!(html.matches("<script").count(), 1);
        let options = roxmltree::ParsingOptions {
            allow_dtd: true,
            ..Default::default()
        };
        roxmltree::Document::parse_with_options(&html, options).unwrap();
    }

    #[test]
    fn the_page_asks_for_nothing_from_elsewhere() {
        let html = everything().to_html().replace("href=\"#", "");
        for link in ["src=", "href=", "url(", "@import", "fetch(", "XMLHttp"] {
            assert!(!html.contains(link), "{link}");
        }
        assert!(html.contains("default-src 'none'"));
    }

    #[test]
    fn a_long_page_has_contents_and_a_short_one_has_none() {
        let page = |sections: usize| {
            let section = |number| Section::new(format!("Part {number}")).text("text");
            let document = (1..=sections).map(section);
            document
                .fold(Document::new("t"), Document::section)
                .to_html()
        };
        let long = page(4);
        assert!(
            long.contains("<li><a href=\"#s3\">Part 3</a></li>"),
            "{long}"
        );
        assert!(
            long.contains("<section id=\"s3\">\n<h2>Part 3</h2>"),
            "{long}"
        );
        assert!(!page(3).contains("class=\"contents\""));
    }

    #[test]
    fn the_script_is_small() {
        // Bar: 50 kB. Measured: 20 kB.
        assert!(SCRIPT.len() < 30_000, "{}", SCRIPT.len());
    }

    #[test]
    fn the_verdict_stands_before_tables_figures_and_provenance_in_this_order() {
        let html = everything().to_html();
        let at = |what: &str| html.find(what).unwrap();
        assert!(at("class=\"verdict") < at("<table"));
        assert!(at("<table") < at("<figure"));
        assert!(at("<figure") < at("id=\"provenance\""));
    }

    #[test]
    fn writing_replaces_the_old_file_and_leaves_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("report.html");
        fs::write(&path, "old").unwrap();
        everything().write(&path).unwrap();
        assert!(fs::read_to_string(&path).unwrap().starts_with("<!DOCTYPE"));
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 1);
    }

    #[test]
    fn an_error_of_writing_names_the_file() {
        // A folder that cannot be made: there is a file of its name.
        let file = tempfile::NamedTempFile::new().unwrap();
        let path = file.path().join("report.html");
        let error = everything().write(&path).unwrap_err();
        let name = path.display().to_string();
        assert!(error.to_string().contains(&name), "{error}");
    }
}
