//! Chooses the markers of a chart that are shown.

use super::{axis::Scale, chart::Chart, chart::Marker};

/// With more major markers than this none of them is shown.
const MOST_MAJOR: usize = 200;
/// With more minor markers than this none of them is shown: they would be a grey wall, and the shading shows
/// the touches as well.
const MOST_MINOR: usize = 40;

/// Markers that are on the axis, major ones first.
pub(super) fn visible<'c>(chart: &'c Chart, x: &Scale) -> impl Iterator<Item = &'c Marker> {
    of_rank(chart, x, true).chain(of_rank(chart, x, false))
}

/// Markers of one rank that are on the axis; none if there are too many to tell apart.
pub(super) fn of_rank<'c>(
    chart: &'c Chart,
    x: &Scale,
    major: bool,
) -> impl Iterator<Item = &'c Marker> {
    let inside = |marker: &&Marker| {
        let at = x.map(marker.at);
        marker.major == major && at >= x.low && at <= x.high
    };
    let markers: Vec<&Marker> = chart.markers.iter().filter(inside).collect();
    let most = if major { MOST_MAJOR } else { MOST_MINOR };
    let shown = if markers.len() > most {
        0
    } else {
        markers.len()
    };
    markers.into_iter().take(shown)
}
