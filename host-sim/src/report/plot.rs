//! Charts as SVG for a [`Document`](super::Document).
//!
//! ```
//! use palpate::report::plot::{Axis, Chart, Series};
//!
//! let (time_s, force_n) = ([0.0, 0.1, 0.2], [0.0, 4.1, 0.2]);
//! let svg = Chart::new(Axis::time(), Axis::new("Force", "N"))
//!     .series(Series::measured("measured", &time_s, &force_n))
//!     .to_svg("Force over time");
//! assert!(svg.starts_with("<svg") && svg.contains("Force [N]"));
//! ```
//!
//! A chart never fails: without data it is an empty frame that says so, values that are not finite break
//! the line, and long series are thinned to the points that can be seen.

mod annotate;
mod area;
mod axis;
mod canvas;
mod chart;
mod draw;
mod ink;
mod layout;
mod marks;
mod thin;

pub use axis::Axis;
pub use chart::{Chart, Marker, Series, Size, Span};
pub use ink::{Ink, StripTone, Stroke};

impl Chart<'_> {
    /// The SVG element; a screen reader reads `title`.
    pub fn to_svg(&self, title: &str) -> String {
        draw::to_svg(self, title)
    }
}

#[cfg(test)]
mod tests {
    use super::canvas::Role;
    use super::*;

    fn chart<'a>(x: &'a [f64], y: &'a [f64]) -> Chart<'a> {
        Chart::new(Axis::time(), Axis::new("Force", "N"))
            .series(Series::estimated("estimated", x, y).band(vec![0.1; y.len()]))
            .series(Series::measured("measured", x, y))
            .series(Series::new("dots", Ink::Second, Stroke::Dots, x, y))
    }

    fn parse(svg: &str) -> roxmltree::Document<'_> {
        roxmltree::Document::parse(svg).unwrap()
    }

    fn count(svg: &str, class: &str) -> usize {
        let document = parse(svg);
        let has = |n: &roxmltree::Node| n.attribute("class") == Some(class);
        document.descendants().filter(has).count()
    }

    #[test]
    fn whatever_the_data_the_svg_is_well_formed_and_has_numbers_only() {
        let (nan, inf) = (f64::NAN, f64::INFINITY);
        for (x, y) in [
            (&[][..], &[][..]),
            (&[1.0], &[2.0]),
            (&[0.0, 1.0], &[3.0, 3.0]),
            (&[1.0, 1.0], &[0.0, 5.0]),
            (&[nan, nan], &[nan, nan]),
            (&[0.0, 1.0, 2.0], &[1.0, inf, -inf]),
            (&[-1e300, 1e300], &[-1e300, 1e300]),
            (&[0.0, 1e-300], &[1e-300, 0.0]),
            (&[0.0, 1.0], &[1e9, 1e9 + 1.0]),
            (&[2.0, 1.0, 3.0], &[1.0, 2.0, 3.0]),
        ] {
            let svg = chart(x, y).size(Size::Wide).to_svg("t");
            parse(&svg);
            assert!(!svg.contains("NaN") && !svg.contains("inf"), "{x:?} {y:?}");
        }
    }

    #[test]
    fn an_axis_that_leaves_the_data_out_clips_it_near_the_plot() {
        let (x, y) = ([0.0, 1.0, 2.0], [0.0, 1e12, 0.0]);
        let axis = Axis::new("Force", "N").range(0.0, 1.0);
        let chart = Chart::new(Axis::time(), axis).series(Series::estimated("", &x, &y));
        parse(&chart.to_svg("t"));
    }

    #[test]
    fn without_data_the_chart_says_so() {
        assert!(chart(&[], &[]).to_svg("t").contains(">no data</text>"));
        assert!(!chart(&[0.0], &[1.0]).to_svg("t").contains("no data"));
    }

    #[test]
    fn a_gap_in_the_data_is_a_gap_in_the_line() {
        let x = [0.0, 1.0, 2.0, 3.0, 4.0];
        let svg = chart(&x, &[1.0, 2.0, f64::NAN, 2.0, 1.0]).to_svg("t");
        assert_eq!(count(&svg, "line a"), 2);
        assert_eq!(count(&svg, "band a"), 2);
        assert_eq!(count(&svg, "line dashed m"), 2);
    }

    #[test]
    fn a_hundred_thousand_points_take_less_than_80_kb() {
        let x: Vec<f64> = (0..100_000).map(f64::from).collect();
        let y: Vec<f64> = x.iter().map(|x| (x * x).sin()).collect();
        let bare = Chart::new(Axis::time(), Axis::new("y", "1"));
        let line = bare.clone().size(Size::Wide);
        let line = line.series(Series::estimated("", &x, &y)).to_svg("t");
        let path = bare.series(Series::estimated("", &y, &x)).to_svg("t");
        // Measured: 11 kB (an envelope) and 54 kB.
        assert!((5_000..60_000).contains(&line.len()), "{}", line.len());
        assert!((5_000..80_000).contains(&path.len()), "{}", path.len());
    }

    #[test]
    fn events_have_labels_where_there_is_room_and_major_ones_come_first() {
        let x = [0.0, 100.0];
        let marker = |at: f64, label: &str, major| Marker {
            at,
            label: label.into(),
            major,
        };
        let events = [
            marker(10.0, "contact", false),
            marker(50.0, "release", false),
            marker(50.5, "material change", true),
            marker(80.0, "contact", false),
            marker(500.0, "outside", true),
        ];
        let svg = chart(&x, &x).markers(events).to_svg("t");
        assert_eq!(count(&svg, "event-label major"), 1);
        // The release has no room, so of each minor kind only the first is labelled.
        assert_eq!(count(&svg, "event-label"), 1);
        assert_eq!((count(&svg, "event"), count(&svg, "event major")), (3, 1));
        assert!(!svg.contains("outside"));
    }

    #[test]
    fn touches_are_shaded_and_joined_where_no_gap_can_be_seen() {
        let x = [0.0, 100.0];
        let far = [(10.0, 20.0), (30.0, 40.0), (90.0, 1e9), (f64::NAN, 5.0)];
        assert_eq!(count(&chart(&x, &x).touches(far).to_svg("t"), "touch"), 3);
        let near = (0..10_000).map(|i| (0.01 * f64::from(i), 0.01 * f64::from(i) + 0.009));
        assert_eq!(count(&chart(&x, &x).touches(near).to_svg("t"), "touch"), 1);
    }

    #[test]
    fn a_strip_names_its_states_where_there_is_room() {
        let x = [0.0, 100.0];
        let span = |from, to, tone| Span {
            from,
            to,
            label: "converged".into(),
            tone,
        };
        let spans = [
            span(0.0, 2.0, StripTone::Warning),
            span(2.0, 2.01, StripTone::Bad),
            span(2.01, 100.0, StripTone::Good),
        ];
        let svg = chart(&x, &x).strip(spans).to_svg("t");
        assert_eq!(count(&svg, "strip warning") + count(&svg, "strip good"), 2);
        assert_eq!(count(&svg, "strip bad"), 0);
        assert_eq!(count(&svg, "strip-label"), 1);
    }

    #[test]
    fn a_single_curve_needs_no_legend() {
        let x = [0.0, 1.0];
        let one = Chart::new(Axis::time(), Axis::time()).series(Series::estimated("a", &x, &x));
        assert!(one.legend().is_empty());
        let names: Vec<_> = chart(&x, &x)
            .legend()
            .into_iter()
            .map(|(_, n)| n.to_string())
            .collect();
        assert_eq!(names, ["estimated", "measured", "dots"]);
    }

    #[test]
    fn every_class_that_a_chart_writes_has_a_rule() {
        let style = include_str!("style.css");
        let inks = [Ink::Measured, Ink::Muted].into_iter().chain(Ink::RANKS);
        for ink in inks {
            let strokes = [Stroke::Solid, Stroke::Dashed, Stroke::Dots, Stroke::Thin];
            let roles = strokes.map(|stroke| Role::line(ink, stroke));
            for role in roles
                .into_iter()
                .chain([Role::band(ink), Role::envelope(ink)])
            {
                for class in role.class().split(' ') {
                    assert!(style.contains(&format!(".{class}")), "{class}");
                }
            }
        }
    }
}
