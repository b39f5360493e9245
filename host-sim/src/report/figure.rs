//! A chart with its title, legend and caption.

use std::fmt::Write;

use super::{html::escape, plot::Chart, plot::Size};

/// A figure of a [`Section`](super::Section). It gets its number when the document is written.
#[derive(Clone, Debug)]
pub struct Figure {
    title: String,
    caption: String,
    legend: Vec<(String, String)>,
    svg: String,
    wide: bool,
}

impl Figure {
    /// Draws the chart. The legend stands above it, where it cannot cover data.
    pub fn new(title: impl Into<String>, chart: &Chart) -> Figure {
        let title = title.into();
        let legend = chart.legend().into_iter();
        Figure {
            svg: chart.to_svg(&title),
            title,
            caption: String::new(),
            legend: legend
                .map(|(class, name)| (class, name.to_string()))
                .collect(),
            wide: chart.width() != Size::Half,
        }
    }

    /// Adds the caption: what the figure shows, and what to know about it.
    pub fn caption(mut self, caption: impl Into<String>) -> Figure {
        self.caption = caption.into();
        self
    }

    pub(super) fn push_html(&self, out: &mut String, number: usize) {
        let class = if self.wide { "wide" } else { "half" };
        let _ = writeln!(
            out,
            "<figure class=\"{class}\">\n<div class=\"head\"><h3>{}</h3>",
            escape(&self.title),
        );
        if !self.legend.is_empty() {
            out.push_str("<ul class=\"legend\">\n");
            for (class, name) in &self.legend {
                let _ = writeln!(out, "<li>{}{}</li>", swatch(class), escape(name));
            }
            out.push_str("</ul>\n");
        }
        let _ = writeln!(
            out,
            "</div>\n<div class=\"scroll\">{}</div>\n<figcaption><b>Figure {number}.</b> {}</figcaption>\n</figure>",
            self.svg,
            escape(&self.caption),
        );
    }
}

/// A short piece of a curve, for the legend.
fn swatch(class: &str) -> String {
    let path = match class.starts_with("dots") {
        true => "M4 5h0m10 0h0m10 0h0",
        false => "M1 5h26",
    };
    format!(
        "<svg class=\"swatch\" viewBox=\"0 0 28 10\" aria-hidden=\"true\">\
         <path class=\"{class}\" d=\"{path}\"/></svg>"
    )
}
