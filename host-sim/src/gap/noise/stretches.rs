//! The noise of a force from stretches of smooth motion, which need no rest and see slow noise.
//!
//! Second differences see noise that is as fast as the samples. Most forces come through a filter, and behind one of 30 Hz
//! second differences at 1 kHz see a sixteenth of their noise: a log in which nothing was missing was 15 times its noise.
//! Over a stretch a smooth law makes of a smooth motion a cubic of time and some of the position and its change; what is
//! left of the force is noise, as far as that is faster than the stretch. It grows with the length until no noise is
//! slower. How large it is has nothing to do with how far the stretch moves: what an event or a missing effect leaves
//! has.

use std::iter::successors;
use std::ops::Range;

use crate::gap::thresholds::Floor;
use crate::log::UniformLog;
use crate::lsq::basis::{add_column, dot, project_out};
use crate::stats::{correlation, median, quantile, range, robust_deviation};

/// Samples of the shortest stretch: six columns leave ten of them.
const SHORTEST: usize = 16;
/// Fewest stretches, side by side: the quarters of fewer say nothing.
const FEWEST: usize = 12;
/// Most stretches of a length: their median is then known to 2 % and better.
const MOST: usize = 400;
/// The growth from one length to the next scatters by as much, where noise of 10 Hz is seen in stretches of 0.5 s.
const SCATTER: f64 = 0.1;
/// Parts of a stretch over which the position's change is taken.
const PARTS: usize = 8;

/// Noise that is slower than second differences see.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SlowNoise {
    /// Standard deviation (N).
    pub(super) noise_n: f64,
    /// What of it is extrapolated to longer stretches, as a share of it.
    pub(super) error: f64,
    /// Samples for each independent one.
    pub(super) correlation: f64,
    /// Whether no more than a part of it is slower than its stretches.
    pub(super) is_all: bool,
    /// Samples of its stretches.
    length: usize,
}

impl SlowNoise {
    /// What a filter takes off the noise (N²).
    pub(super) fn taken_n2(&self, log: &UniformLog, filtered: &UniformLog) -> Option<f64> {
        let left = |log| Stretches::of(log, self.length).map(|all| all.square_n2);
        Some(left(log)? - left(filtered)?)
    }

    /// The noise of the shortest stretches that have all of it, or of those that come nearest. `None` where what is left
    /// in stretches is no noise before.
    pub(super) fn of(log: &UniformLog, decide: &Floor) -> Option<SlowNoise> {
        let mut lengths = successors(Some(SHORTEST), |length| Some(2 * length));
        let mut noise = || {
            let length = lengths
                .next()
                .filter(|length| FEWEST * length <= log.len())?;
            Stretches::of(log, length).filter(|all| all.are_noise(decide))
        };
        let mut half = noise()?;
        let (mut nearest, mut least) = (None, f64::INFINITY);
        while let Some(all) = noise() {
            let growth = (all.square_n2 / half.square_n2).sqrt();
            if growth < least {
                least = growth;
                nearest = Some(all.extrapolated(&half, growth <= decide.most_growth));
            }
            // Where it grows more again something else begins.
            let grows_again = least <= decide.most_growth && growth > least + SCATTER;
            if growth <= decide.level || grows_again {
                break;
            }
            half = all;
        }
        nearest
    }
}

/// What is left in all stretches of a length.
struct Stretches {
    /// Mean square of each (N²), and how far it moves (m).
    each: Vec<(f64, f64)>,
    /// The median of the mean squares (N²).
    square_n2: f64,
    /// Samples for each independent one.
    correlation: f64,
    /// Samples of each.
    length: usize,
}

impl Stretches {
    fn of(log: &UniformLog, length: usize) -> Option<Stretches> {
        let mut cubic = Vec::new();
        let time = |at: usize| 2.0 * at as f64 / (length - 1) as f64 - 1.0;
        for power in 0..4 {
            let column = (0..length).map(|at| time(at).powi(power)).collect();
            add_column(&mut cubic, column, &[]);
        }
        let lag = length / PARTS;
        let last = log.len().checked_sub(length + lag)?;
        let step = (length / 2).max(last / MOST);
        let is_measured = |from: &usize| !log.in_gap[*from..from + length].contains(&true);
        let starts = (lag..=last).step_by(step).filter(is_measured);
        let left: Vec<(f64, f64, f64)> = starts
            .map(|from| left(log, from..from + length, lag, &cubic))
            .collect();
        (left.len() >= FEWEST).then(|| Stretches {
            square_n2: median(left.iter().map(|own| own.0)),
            correlation: median(left.iter().map(|own| own.2)),
            each: left.into_iter().map(|own| (own.0, own.1)).collect(),
            length,
        })
    }

    /// Whether what is left is noise: as large in all stretches, and however far they move.
    fn are_noise(&self, decide: &Floor) -> bool {
        let squares = || self.each.iter().map(|own| own.0);
        let quarter = quantile(squares(), 0.25);
        if quarter <= 0.0 || quantile(squares(), 0.75) > decide.stretch_scatter * quarter {
            return false;
        }
        let mut by_way = self.each.clone();
        by_way.sort_by(|a, b| a.1.total_cmp(&b.1));
        let (near, far) = by_way.split_at(by_way.len() / 2);
        // A touch or a reversal in a few of them moves no median.
        let middle = |half: &[(f64, f64)]| {
            let logarithms = || half.iter().map(|own| own.0.max(f64::MIN_POSITIVE).ln());
            let middle = median(logarithms());
            let deviation = robust_deviation(logarithms().map(|own| own - middle));
            (middle, 1.25 * deviation / (half.len() as f64).sqrt())
        };
        let ((near, near_error), (far, far_error)) = (middle(near), middle(far));
        (far - near).abs() <= decide.stretch_sigmas * near_error.hypot(far_error)
    }

    /// The noise of endless stretches, from these and those half as long: what a stretch hides goes as one over its
    /// length.
    fn extrapolated(&self, half: &Stretches, is_all: bool) -> SlowNoise {
        let square_n2 = (2.0 * self.square_n2 - half.square_n2).max(self.square_n2);
        SlowNoise {
            noise_n: square_n2.sqrt(),
            error: 1.0 - (self.square_n2 / square_n2).sqrt(),
            correlation: self.correlation,
            is_all,
            length: self.length,
        }
    }
}

/// The mean square (N²) of what is left in a stretch, how far it moves (m), and its correlation (samples).
fn left(
    log: &UniformLog,
    stretch: Range<usize>,
    lag: usize,
    cubic: &[Vec<f64>],
) -> (f64, f64, f64) {
    let position_m = &log.position_m;
    let mut force_n = log.force_n[stretch.clone()].to_vec();
    project_out(&mut force_n, cubic);
    let beside = |columns: usize| (force_n.len() - cubic.len() - columns) as f64;
    let of_time = dot(&force_n, &force_n) / beside(0);
    let mut motion = Vec::new();
    add_column(&mut motion, position_m[stretch.clone()].to_vec(), cubic);
    let change = stretch
        .clone()
        .map(|at| position_m[at + lag] - position_m[at - lag]);
    add_column(&mut motion, change.collect(), cubic);
    let mut beside_motion = force_n.clone();
    project_out(&mut beside_motion, &motion);
    let of_motion = dot(&beside_motion, &beside_motion) / beside(motion.len());
    let (square_n2, residuals) = match of_motion < of_time {
        true => (of_motion, &beside_motion),
        false => (of_time, &force_n),
    };
    (
        square_n2,
        range(&position_m[stretch]),
        correlation(residuals),
    )
}
