//! The forgetting factor β of (24), over the error of the force and over time.

use super::{figures::Layout, figures::annotate, run::Run};
use crate::kind;
use crate::number::setting;
use crate::report::Figure;
use crate::report::plot::{Axis, Chart, Ink, Series, Size, Stroke};

/// What β is, which the figures show.
pub(super) const EQUATION: &str = "How much of the past an estimate keeps: β = 1 − α₁ {(1/π) arctan[α₂ (|F − F̂| − \
    α₃)] + ½}. The larger the error |F − F̂| of the predicted force, the faster the past is forgotten; at β = 1 \
    everything is remembered, or nothing is being learned.";

/// β over |F − F̂| and over time.
pub(super) fn figures(run: &Run, layout: &Layout) -> Vec<Figure> {
    let mut figures = Vec::new();
    figures.extend(beta_over_error(run, layout));
    if !run.forgetting.is_empty() {
        let chart = Chart::new(Axis::time(), Axis::new("β", "1"))
            .size(if figures.is_empty() {
                layout.over_time
            } else {
                Size::Half
            })
            .series(Series::new(
                "",
                Ink::First,
                Stroke::Thin,
                &run.time_s[..],
                &run.forgetting[..],
            ));
        figures.push(
            Figure::new(layout.title(run, "β over time", ""), &annotate(chart, run))
                .caption("The factor that was used at each sample."),
        );
    }
    figures
}

fn beta_over_error(run: &Run, layout: &Layout) -> Option<Figure> {
    let law = run.forgetting_law?;
    let errors: Vec<f64> = run.innovation_n.iter().map(|e| e.abs()).collect();
    let largest = errors
        .iter()
        .copied()
        .filter(|e| e.is_finite())
        .fold(0.0, f64::max);
    let end = (3.0 * law.alpha_3_n).max(1.05 * largest);
    let curve_x: Vec<f64> = (0..=300).map(|i| end * f64::from(i) / 300.0).collect();
    let curve_y: Vec<f64> = curve_x.iter().map(|e| law.beta(*e)).collect();
    let chart = Chart::new(
        Axis::new("Force error |F − F̂|", "N").range(0.0, end),
        Axis::new("β", "1"),
    )
    .series(Series::new(
        "β by the equation above",
        Ink::Muted,
        Stroke::Solid,
        curve_x,
        curve_y,
    ))
    .series(Series::new(
        "visited",
        Ink::First,
        Stroke::Dots,
        errors,
        &run.forgetting[..],
    ));
    let caption = format!(
        "The factor over the error, with α₁ = {}, α₂ = {} per {} and α₃ = {}. Dots at β = 1 are samples that the \
         estimator did not learn from.",
        setting(law.alpha_1, "1"),
        setting(law.alpha_2_per_n, "1"),
        kind::unit("N"),
        setting(law.alpha_3_n, "N"),
    );
    let title = layout.title(run, "β over the force error", "");
    Some(Figure::new(title, &chart).caption(caption))
}
