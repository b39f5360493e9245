//! Thins a series without a visible change: a log of an hour has 3.6 million samples, and a figure has some
//! hundred pixel columns.

use std::collections::HashSet;

/// The mapping from the data to the picture: the ranges of the axes and the size of the plot in pixels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct View {
    pub(crate) x: (f64, f64),
    pub(crate) y: (f64, f64),
    pub(crate) size_px: (f64, f64),
}

impl View {
    /// The same picture with `times` as many columns.
    pub(crate) fn finer(self, times: f64) -> View {
        let (width, height) = self.size_px;
        View {
            size_px: (times * width, height),
            ..self
        }
    }

    fn column(&self, x: f64) -> i64 {
        let column = (x - self.x.0) / (self.x.1 - self.x.0) * self.size_px.0;
        // A point outside the plot is needed only for the line that leads to it.
        column.floor().clamp(-1.0, self.size_px.0 + 1.0) as i64
    }

    fn pixel(&self, (x, y): Point) -> Point {
        (
            (x - self.x.0) / (self.x.1 - self.x.0) * self.size_px.0,
            (y - self.y.0) / (self.y.1 - self.y.0) * self.size_px.1,
        )
    }

    fn distance(&self, a: Point, b: Point) -> f64 {
        let (a, b) = (self.pixel(a), self.pixel(b));
        (a.0 - b.0).hypot(a.1 - b.1)
    }
}

/// A point in the units of the axes.
pub(crate) type Point = (f64, f64);
/// Points that a line joins. Values that are not finite break a series into several pieces.
pub(crate) type Piece = Vec<Point>;

/// Points of a loop that lie farther apart than this are kept [px]. It is less than half the width of the
/// line (1.6 px).
const LOOP_STEP_PX: f64 = 0.7;
/// The largest distance to which a loop is thinned [px].
const LOOP_STEP_MOST_PX: f64 = 4.0;
/// A loop with more points than this is thinned further; 8000 points are about 60 kB.
const LOOP_POINTS: usize = 8000;
/// A line that is longer than this multiple of the width of the picture fills it. The line of six touches
/// is 3 times as long as the picture is wide, a residual of white noise 30 to 60 times, a thousand touches
/// 200 times.
const DENSE_PX: f64 = 80.0;
/// Dots closer than this cover each other [px].
const DOT_CELL_PX: f64 = 1.5;

fn is_finite(point: Point) -> bool {
    point.0.is_finite() && point.1.is_finite()
}

/// Whether x never steps back, so that the extremes of each pixel column give the whole picture.
pub(crate) fn is_time_series(x: &[f64]) -> bool {
    let finite = x.iter().filter(|x| x.is_finite());
    finite.clone().zip(finite.skip(1)).all(|(a, b)| b >= a)
}

/// Thins a line over time to the first, lowest, highest and last point of each pixel column.
pub(crate) fn over_time(points: impl Iterator<Item = Point>, view: &View) -> Vec<Piece> {
    let mut pieces: Vec<Piece> = Vec::new();
    let mut column: Option<Column> = None;
    let mut broken = true;
    for point in points {
        if !is_finite(point) {
            broken = true;
            continue;
        }
        let at = view.column(point.0);
        match &mut column {
            // A gap inside a pixel column cannot be seen.
            Some(current) if current.at == at => current.add(point),
            _ => {
                if let Some(done) = column.take() {
                    done.push_to(&mut pieces);
                }
                if broken {
                    pieces.push(Vec::new());
                }
                column = Some(Column::new(at, point));
            }
        }
        broken = false;
    }
    if let Some(done) = column {
        done.push_to(&mut pieces);
    }
    pieces
}

/// The points of one pixel column that its picture needs, each with its number.
struct Column {
    at: i64,
    count: usize,
    first: Point,
    low: (usize, Point),
    high: (usize, Point),
    last: Point,
}

impl Column {
    fn new(at: i64, point: Point) -> Column {
        Column {
            at,
            count: 1,
            first: point,
            low: (0, point),
            high: (0, point),
            last: point,
        }
    }

    fn add(&mut self, point: Point) {
        if point.1 < self.low.1.1 {
            self.low = (self.count, point);
        }
        if point.1 > self.high.1.1 {
            self.high = (self.count, point);
        }
        self.last = point;
        self.count += 1;
    }

    fn push_to(self, pieces: &mut [Piece]) {
        let Some(piece) = pieces.last_mut() else {
            return;
        };
        let mut kept = [
            (0, self.first),
            self.low,
            self.high,
            (self.count - 1, self.last),
        ];
        kept.sort_by_key(|(number, _)| *number);
        let mut previous = None;
        for (number, point) in kept {
            if previous != Some(number) {
                piece.push(point);
            }
            previous = Some(number);
        }
    }
}

/// Thins a curve that may turn back: a point is kept if it is far enough from the last one that was kept.
pub(crate) fn along_path(points: impl Iterator<Item = Point> + Clone, view: &View) -> Vec<Piece> {
    let mut step = LOOP_STEP_PX;
    loop {
        let pieces = thin_path(points.clone(), view, step);
        let count = pieces.iter().map(Vec::len).sum::<usize>();
        if count <= LOOP_POINTS {
            return pieces;
        }
        // Noise that reaches from one end of the picture to the other is not thinned by any distance.
        if step > LOOP_STEP_MOST_PX {
            let every = count.div_ceil(LOOP_POINTS);
            let thinned = pieces
                .into_iter()
                .map(|p| p.into_iter().step_by(every).collect());
            return thinned.collect();
        }
        step *= 1.5;
    }
}

fn thin_path(points: impl Iterator<Item = Point>, view: &View, step: f64) -> Vec<Piece> {
    let mut pieces: Vec<Piece> = Vec::new();
    let mut kept: Option<Point> = None;
    let mut last: Option<Point> = None;
    for point in points {
        if !is_finite(point) {
            finish(&mut pieces, kept.take(), last.take());
            continue;
        }
        match kept {
            Some(previous) if view.distance(previous, point) < step => {}
            _ => {
                if kept.is_none() {
                    start(&mut pieces, point, view);
                }
                if let Some(piece) = pieces.last_mut() {
                    piece.push(point);
                }
                kept = Some(point);
            }
        }
        last = Some(point);
    }
    finish(&mut pieces, kept, last);
    pieces
}

/// Begins a new piece, unless the gap since the last one cannot be seen.
fn start(pieces: &mut Vec<Piece>, point: Point, view: &View) {
    let end = pieces.last().and_then(|piece| piece.last());
    if end.is_none_or(|end| view.distance(*end, point) > 1.0) {
        pieces.push(Vec::new());
    }
}

/// Keeps the end of a piece wherever it is, since a loop must close.
fn finish(pieces: &mut [Piece], kept: Option<Point>, last: Option<Point>) {
    if let (Some(piece), Some(last), true) = (pieces.last_mut(), last, kept != last) {
        piece.push(last);
    }
}

/// Whether a line over time goes up and down so often that it would fill its picture, so that only the area
/// between its extremes can be seen.
pub(crate) fn is_dense(pieces: &[Piece], view: &View) -> bool {
    let steps = pieces.iter().flat_map(|piece| piece.windows(2));
    let length: f64 = steps.map(|step| view.distance(step[0], step[1])).sum();
    length > DENSE_PX * view.size_px.0
}

/// Thins dots to one for each cell of the picture that has any.
pub(crate) fn dots(points: impl Iterator<Item = Point>, view: &View) -> Vec<Point> {
    let mut seen = HashSet::new();
    let cell = |point| {
        let (x, y) = view.pixel(point);
        (
            (x / DOT_CELL_PX).round() as i64,
            (y / DOT_CELL_PX).round() as i64,
        )
    };
    points
        .filter(|point| is_finite(*point) && seen.insert(cell(*point)))
        .collect()
}

/// Thins a band between two curves over time to its lowest and highest edges in each pixel column.
/// Each outline runs along the lower edge and back along the upper one.
pub(crate) fn band(
    points: impl Iterator<Item = (f64, f64, f64)> + Clone,
    view: &View,
) -> Vec<Piece> {
    let whole = |(x, low, high): (f64, f64, f64)| {
        let sum = low + high;
        (x + 0.0 * sum, low + 0.0 * sum, high + 0.0 * sum)
    };
    let points = points.map(whole);
    let low = over_time(points.clone().map(|(x, low, _)| (x, low)), view);
    let high = over_time(points.map(|(x, _, high)| (x, high)), view);
    low.into_iter()
        .zip(high)
        .map(|(low, high)| {
            let mut outline = extremes(&low, view, f64::min);
            outline.extend(extremes(&high, view, f64::max).into_iter().rev());
            outline
        })
        .collect()
}

/// The extreme point of each pixel column.
fn extremes(piece: &Piece, view: &View, extreme: fn(f64, f64) -> f64) -> Piece {
    let mut out: Piece = Vec::new();
    for &(x, y) in piece {
        match out.last_mut() {
            Some(last) if view.column(last.0) == view.column(x) => last.1 = extreme(last.1, y),
            _ => out.push((x, y)),
        }
    }
    // The last column ends where the data ends, not where its first point is.
    if let (Some(end), Some(&(x, y))) = (out.last().copied(), piece.last())
        && end.0 < x
    {
        out.push((x, y));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    const VIEW: View = View {
        x: (0.0, 100.0),
        y: (-1.0, 1.0),
        size_px: (500.0, 200.0),
    };

    fn count(pieces: &[Piece]) -> usize {
        pieces.iter().map(Vec::len).sum()
    }

    #[test]
    fn a_spike_of_one_sample_in_a_million_survives() {
        let n = 1_000_000;
        let points = (0..n).map(|i| {
            let y = match i {
                345_678 => 0.9,
                777_777 => -0.8,
                _ => 0.01 * (i as f64).sin(),
            };
            (100.0 * i as f64 / n as f64, y)
        });
        let pieces = over_time(points, &VIEW);
        let all: Vec<f64> = pieces.iter().flatten().map(|p| p.1).collect();
        assert!(all.contains(&0.9) && all.contains(&-0.8));
        assert_eq!(pieces.len(), 1);
        assert!(count(&pieces) <= 4 * 502, "{}", count(&pieces));
        assert!(count(&pieces) > 2 * 498, "{}", count(&pieces));
    }

    #[test]
    fn few_points_are_kept_as_they_are_and_in_order() {
        let points: Vec<Point> = (0..40).map(|i| (i as f64, (i as f64).cos())).collect();
        assert_eq!(over_time(points.iter().copied(), &VIEW), vec![points]);
    }

    #[test]
    fn a_value_that_is_not_finite_breaks_the_line_and_a_gap_below_a_pixel_does_not() {
        let gap = [
            (0.0, 0.0),
            (1.0, f64::NAN),
            (2.0, 0.0),
            (3.0, f64::INFINITY),
        ];
        assert_eq!(
            over_time(gap.into_iter(), &VIEW),
            vec![vec![(0.0, 0.0)], vec![(2.0, 0.0)]]
        );
        let every_other = (0..100_000).map(|i| {
            let y = if i % 2 == 0 { 0.5 } else { f64::NAN };
            (i as f64 / 1000.0, y)
        });
        assert!(over_time(every_other, &VIEW).len() <= 502);
    }

    #[test]
    fn a_loop_keeps_its_turning_points_within_the_step() {
        let turns = 30;
        let points = (0..100_000).map(move |i| {
            let phase = i as f64 / 100_000.0 * turns as f64 * std::f64::consts::TAU;
            (50.0 + 49.0 * phase.cos(), 0.9 * phase.sin())
        });
        let pieces = along_path(points, &VIEW);
        assert!(count(&pieces) <= LOOP_POINTS && count(&pieces) > 1000);
        let highest = pieces.iter().flatten().map(|p| p.1).fold(-1.0, f64::max);
        assert!((0.85..=0.9).contains(&highest), "{highest}");
    }

    #[test]
    fn the_end_of_a_path_is_kept_however_short_the_last_step() {
        let points = [(0.0, 0.0), (10.0, 0.0), (10.01, 0.0)];
        assert_eq!(along_path(points.into_iter(), &VIEW), vec![points.to_vec()]);
    }

    #[test]
    fn a_thousand_touches_are_dense_and_ten_are_not() {
        let touches = |n: f64| {
            let points = (0..200_000).map(move |i| {
                let phase = i as f64 / 200_000.0;
                (
                    100.0 * phase,
                    0.9 * (n * std::f64::consts::TAU * phase).sin(),
                )
            });
            is_dense(&over_time(points, &VIEW), &VIEW)
        };
        assert!(touches(1000.0) && !touches(10.0));
    }

    #[test]
    fn a_band_spans_the_extremes_of_both_edges() {
        let points = (0..10_000).map(|i| {
            let x = i as f64 / 100.0;
            (
                x,
                if i == 5_003 { -0.9 } else { -0.1 },
                if i == 20 { 0.8 } else { 0.1 },
            )
        });
        let pieces = band(points, &VIEW);
        assert_eq!(pieces.len(), 1);
        assert!(pieces[0].iter().any(|p| p.1 == -0.9));
        assert!(pieces[0].iter().any(|p| p.1 == 0.8));
        assert!(count(&pieces) < 2 * 510);
    }

    #[test]
    fn a_band_breaks_where_either_edge_is_unknown() {
        let points = [
            (0.0, 0.0, 1.0),
            (10.0, f64::NAN, 1.0),
            (20.0, 0.0, 1.0),
            (30.0, 0.0, f64::INFINITY),
            (40.0, 0.0, 1.0),
        ];
        assert_eq!(band(points.into_iter(), &VIEW).len(), 3);
    }

    #[test]
    fn a_hundred_thousand_dots_on_one_spot_are_one() {
        let points = (0..100_000).map(|i| (50.0 + 1e-7 * i as f64, 0.0));
        assert_eq!(dots(points, &VIEW).len(), 1);
    }

    #[test]
    fn nothing_gives_nothing() {
        assert!(over_time(std::iter::empty(), &VIEW).is_empty());
        assert!(along_path(std::iter::empty(), &VIEW).is_empty());
        assert!(band(std::iter::empty(), &VIEW).is_empty());
        assert!(is_time_series(&[]) && is_time_series(&[1.0, f64::NAN, 1.0]));
        assert!(!is_time_series(&[1.0, 0.5]));
    }
}
