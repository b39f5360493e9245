//! The noise of a force from stretches of smooth motion, which need no rest and see slow noise.
//!
//! Second differences see noise that is as fast as the samples. Most forces come through a filter, and behind one of
//! 30 Hz second differences at 1 kHz see a sixteenth of their noise: a log in which nothing was missing was unexplained at
//! 15 times its noise. Over a stretch a smooth law makes of a smooth motion a cubic of time and some of the position, of
//! its change, and of both times the position; what is left of the force is noise, as far as that is faster than the
//! stretch. It grows with the length until no noise is slower. How large it is has nothing to do with how far the stretch
//! moves: what an event or a missing effect leaves has.

use std::iter::successors;
use std::ops::Range;

use crate::gap::noise::line::Line;
use crate::gap::thresholds::Floor;
use crate::log::UniformLog;
use crate::lsq::basis::{add_column, dot, project_out};
use crate::signal;
use crate::stats::{correlation, median, quantile, range, robust_deviation};

/// Samples of the shortest stretch: eight columns leave as many of them.
const SHORTEST: usize = 16;
/// Fewest stretches, side by side: the quarters of fewer say nothing.
const FEWEST: usize = 12;
/// Most stretches of a length: their median is then known to 2 % and better.
const MOST: usize = 400;
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

    /// The same where it is clearly more than second differences see.
    pub(super) fn beside(high_pass_n: f64, log: &UniformLog, decide: &Floor) -> Option<SlowNoise> {
        SlowNoise::of(log, decide).filter(|slow| slow.noise_n > decide.slower * high_pass_n)
    }

    /// The noise of the longest stretches in which no more than a part of it is slower, or of the longest of all. `None`
    /// where even in the shortest ones what is left is no noise.
    pub(super) fn of(log: &UniformLog, decide: &Floor) -> Option<SlowNoise> {
        let code_n2 = signal::step(&log.force_n).unwrap_or(0.0).powi(2) / 12.0;
        let mut lengths = successors(Some(SHORTEST), |length| Some(2 * length));
        let mut noise = || {
            let length = lengths
                .next()
                .filter(|length| FEWEST * length <= log.len())?;
            Stretches::of(log, length).filter(|all| all.are_noise(code_n2, decide))
        };
        let mut half = noise()?;
        let mut found: Option<SlowNoise> = None;
        while let Some(all) = noise() {
            let growth = (all.square_n2 / half.square_n2).sqrt();
            let own = all.extrapolated(&half, growth <= decide.most_growth);
            if own.is_all || found.is_none_or(|found| !found.is_all) {
                found = Some(own);
            }
            half = all;
        }
        found.filter(|found| !found.is_line(log, decide))
    }

    /// Whether a line makes most of it: what stays in phase is no noise.
    fn is_line(&self, log: &UniformLog, decide: &Floor) -> bool {
        let cubic = cubic(self.length);
        let lag = self.length / PARTS;
        let last = log.len().saturating_sub(self.length + lag);
        let (mut left, mut is_measured) = (vec![0.0; log.len()], vec![false; log.len()]);
        for from in (lag..=last).step_by(self.length) {
            let stretch = from..from + self.length;
            if !log.in_gap[stretch.clone()].contains(&true) {
                let residuals = residuals(log, stretch.clone(), lag, &cubic).1;
                left[stretch.clone()].copy_from_slice(&residuals);
                is_measured[stretch].fill(true);
            }
        }
        let line = Line::strongest(&left, &is_measured, decide.prominence);
        line.is_some_and(|line| line.rms_n().powi(2) > decide.disturbed * self.noise_n.powi(2))
    }
}

/// What is left in all stretches of a length.
struct Stretches {
    /// Mean square of each (N²), and how far it moves (m).
    each: Vec<(f64, f64)>,
    /// The median of the mean squares (N²).
    square_n2: f64,
    /// 3 for normal noise, 1.5 for a sine.
    kurtosis: f64,
    /// Samples for each independent one.
    correlation: f64,
    /// Samples of each.
    length: usize,
}

impl Stretches {
    fn of(log: &UniformLog, length: usize) -> Option<Stretches> {
        let cubic = cubic(length);
        let lag = length / PARTS;
        let last = log.len().checked_sub(length + lag)?;
        let step = (length / 2).max(last / MOST);
        let is_measured = |from: &usize| !log.in_gap[*from..from + length].contains(&true);
        let starts = (lag..=last).step_by(step).filter(is_measured);
        let left: Vec<Left> = starts
            .map(|from| Left::of(log, from..from + length, lag, &cubic))
            .collect();
        let mean = |of: fn(&Left) -> f64| left.iter().map(of).sum::<f64>() / left.len() as f64;
        (left.len() >= FEWEST).then(|| Stretches {
            square_n2: median(left.iter().map(|own| own.square_n2)),
            kurtosis: mean(|own| own.fourth_n4) / mean(|own| own.second_n2).powi(2),
            correlation: median(left.iter().map(|own| own.correlation)),
            each: left.iter().map(|own| (own.square_n2, own.way_m)).collect(),
            length,
        })
    }

    /// Whether what is left is noise: as large in all stretches, however far they move, and normal, unless the codes of a
    /// converter (their variance in N²) make it.
    fn are_noise(&self, code_n2: f64, decide: &Floor) -> bool {
        let squares = || self.each.iter().map(|own| own.0);
        let quarter = quantile(squares(), 0.25);
        let is_even = quantile(squares(), 0.75) <= decide.stretch_scatter * quarter;
        let is_code = self.square_n2 < 2.0 * code_n2;
        let is_normal = is_code || self.kurtosis >= decide.least_kurtosis;
        if quarter <= 0.0 || !is_even || !is_normal {
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

/// What is left in a stretch.
struct Left {
    /// Its mean square (N²), as of so many samples as the columns leave.
    square_n2: f64,
    /// Means of its second and fourth powers (N², N⁴).
    second_n2: f64,
    fourth_n4: f64,
    /// How far the stretch moves (m).
    way_m: f64,
    /// Samples for each independent one.
    correlation: f64,
}

impl Left {
    fn of(log: &UniformLog, stretch: Range<usize>, lag: usize, cubic: &[Vec<f64>]) -> Left {
        let (square_n2, residuals) = residuals(log, stretch.clone(), lag, cubic);
        let mean = |power: i32| {
            let powers = residuals.iter().map(|own| own.powi(power));
            powers.sum::<f64>() / residuals.len() as f64
        };
        Left {
            square_n2,
            second_n2: mean(2),
            fourth_n4: mean(4),
            way_m: range(&log.position_m[stretch]),
            correlation: correlation(&residuals),
        }
    }
}

/// A cubic of time: four orthonormal columns.
fn cubic(length: usize) -> Vec<Vec<f64>> {
    let mut columns = Vec::new();
    let time = |at: usize| 2.0 * at as f64 / (length - 1) as f64 - 1.0;
    for power in 0..4 {
        let column = (0..length).map(|at| time(at).powi(power)).collect();
        add_column(&mut columns, column, &[]);
    }
    columns
}

/// The mean square (N²) of what is left in a stretch, as of so many samples as the columns leave, and that (N).
fn residuals(
    log: &UniformLog,
    stretch: Range<usize>,
    lag: usize,
    cubic: &[Vec<f64>],
) -> (f64, Vec<f64>) {
    let position_m = &log.position_m;
    let mut force_n = log.force_n[stretch.clone()].to_vec();
    project_out(&mut force_n, cubic);
    let beside = |columns: usize| (force_n.len() - cubic.len() - columns) as f64;
    let of_time = dot(&force_n, &force_n) / beside(0);
    let middle_m = position_m[stretch.start.midpoint(stretch.end)];
    let place = |at: usize| position_m[at] - middle_m;
    let change = |at: usize| position_m[at + lag] - position_m[at - lag];
    let columns: [&dyn Fn(usize) -> f64; 4] =
        [&place, &change, &|at| place(at) * place(at), &|at| {
            place(at) * change(at)
        }];
    let mut motion = Vec::new();
    for column in columns {
        add_column(&mut motion, stretch.clone().map(column).collect(), cubic);
    }
    let mut beside_motion = force_n.clone();
    project_out(&mut beside_motion, &motion);
    let of_motion = dot(&beside_motion, &beside_motion) / beside(motion.len());
    match of_motion < of_time {
        true => (of_motion, beside_motion),
        false => (of_time, force_n),
    }
}
