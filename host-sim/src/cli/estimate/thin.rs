//! The samples of a long log that its report shows: those that a figure cannot do without.
//!
//! A figure has some hundred columns of pixels, and an hour at 1 kHz 3.6 million samples. Of each of a few thousand
//! equal stretches the report keeps the samples at which a curve is highest or lowest, so that no peak is lost; and
//! every sample of the first and the last touches, whose loops it draws.

use std::ops::Range;

use estimator_core::Estimate;

use crate::replay::{Replay, Touch};

/// Up to here a log is shown whole: 3 minutes at 1 kHz.
const WHOLE: usize = 200_000;
/// Equal stretches of a longer one: twice the columns of the widest figure, on which a reader may zoom in.
pub(super) const STRETCHES: usize = 4096;
/// What the figures of loops show at either end of the touches (s).
const ENDS_S: f64 = 31.0;

/// The least and the greatest of a curve in a stretch, with their samples.
#[derive(Clone, Copy)]
struct Extremes {
    low: (f64, usize),
    high: (f64, usize),
}

impl Extremes {
    const NONE: Extremes = Extremes {
        low: (f64::INFINITY, usize::MAX),
        high: (f64::NEG_INFINITY, usize::MAX),
    };

    fn take(&mut self, value: f64, at: usize) {
        if value < self.low.0 {
            self.low = (value, at);
        }
        if value > self.high.0 {
            self.high = (value, at);
        }
    }
}

/// The stretches of so many records: the samples of a stretch, and the stretch of each.
pub(super) fn stretch_len(count: usize) -> usize {
    count.div_ceil(STRETCHES).max(1)
}

/// The records that are shown of those from `from` on, in order; `None` where all are. `curves` gives the values
/// of a record that the figures draw.
pub(super) fn kept<const N: usize>(
    replay: &Replay,
    from: usize,
    touches: &[Touch],
    curves: impl Fn(usize, &Estimate<f32>) -> [f64; N],
) -> Option<Vec<usize>> {
    let all = from..replay.records.len();
    if all.len() <= WHOLE {
        return None;
    }
    let mut kept: Vec<usize> = ends(replay, touches).into_iter().flatten().collect();
    let length = stretch_len(all.len());
    let mut extremes = [Extremes::NONE; N];
    let mut first = all.start;
    for (index, record) in all.clone().zip(replay.records.range(all.clone())) {
        if index - first >= length {
            keep(&mut kept, &mut extremes);
            kept.extend([first, index - 1]);
            first = index;
        }
        for (own, value) in extremes.iter_mut().zip(curves(index, &record)) {
            own.take(value, index);
        }
    }
    keep(&mut kept, &mut extremes);
    kept.extend([first, all.end - 1]);
    // Where the status changes the strip above a figure changes its colour.
    kept.extend(replay.records.stretches().map(|(range, _)| range.start));
    kept.retain(|index| all.contains(index));
    kept.sort_unstable();
    kept.dedup();
    Some(kept)
}

fn keep<const N: usize>(kept: &mut Vec<usize>, extremes: &mut [Extremes; N]) {
    let both = extremes.iter().flat_map(|own| [own.low.1, own.high.1]);
    kept.extend(both.filter(|index| *index != usize::MAX));
    *extremes = [Extremes::NONE; N];
}

/// The records around the first and the last touches.
fn ends(replay: &Replay, touches: &[Touch]) -> [Range<usize>; 2] {
    let index = |time_s: f64| {
        let samples = (time_s - replay.start_s) / replay.period_s;
        (samples.max(0.0) as usize + replay.delay).min(replay.records.len())
    };
    let around = |from_s: f64, to_s: f64| index(from_s)..index(to_s);
    match (touches.first(), touches.last()) {
        (Some(first), Some(last)) => [
            around(first.from_s - 1.0, first.from_s + ENDS_S),
            around(last.to_s - ENDS_S, last.to_s + 1.0),
        ],
        _ => [0..0, 0..0],
    }
}
