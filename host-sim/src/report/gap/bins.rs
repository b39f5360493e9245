//! The residuals of a log, and their means over depth or speed, which a scatter plot would hide.

use crate::gap::{Curves, Finding};
use crate::phase::Course;
use crate::stats::{highest, lowest, median};

/// A mean is taken over at least this many samples.
const FEWEST: usize = 8;
/// What is in the place of a phase where a log was left out.
pub(super) const LEFT_OUT: &str = "left out";

/// The curves of a log, and what the figures derive from them.
pub(super) struct LogCurves<'a> {
    pub(super) curves: &'a Curves,
    /// Measured force minus that of the base model (N); NaN where the sample has no weight.
    pub(super) before_n: Vec<f64>,
    /// Measured force minus that of the model with the effects (N).
    pub(super) after_n: Vec<f64>,
    /// Whether the two models differ by effects. If they do not, there is only one model to show.
    pub(super) changed: bool,
    /// What says in which phase a sample is.
    pub(super) course: Course,
    /// Median of the speeds of samples that move (m/s).
    pub(super) typical_mps: f64,
    /// From and until when (s) the log was left out.
    pub(super) left_out: Vec<(f64, f64)>,
}

/// Where the rig is in its travel: how deep it presses or, where nothing is touched, its position.
pub(super) struct Place<'a> {
    /// The word in titles.
    pub(super) name: &'static str,
    /// The name of an axis.
    pub(super) axis: &'static str,
    /// The place at every sample (m).
    pub(super) each_m: &'a [f64],
    /// The first place of the maps (m).
    pub(super) from_m: f64,
    /// The last (m).
    pub(super) to_m: f64,
}

impl<'a> LogCurves<'a> {
    /// Those of the log of this number.
    pub(super) fn of(finding: &'a Finding, number: usize) -> Option<LogCurves<'a>> {
        let curves = finding.curves.get(number)?;
        let residuals = |modelled_n: &[f64]| -> Vec<f64> {
            let pairs = curves.measured_n.iter().zip(modelled_n);
            let each = pairs.zip(&curves.allowed_n);
            each.map(|((f, force), allowed)| if *allowed > 0.0 { f - force } else { f64::NAN })
                .collect()
        };
        let speeds = curves.speed_mps.iter().map(|v| v.abs());
        let course = Course::of(&curves.depth_m, &curves.speed_mps);
        let moving = speeds.filter(|v| v.is_finite() && !course.is_still(*v));
        let episodes = finding.left_out.iter().filter(|own| own.log == number);
        Some(LogCurves {
            curves,
            before_n: residuals(&curves.before_n),
            after_n: residuals(&curves.after_n),
            changed: !finding.effects.is_empty() && curves.before_n != curves.after_n,
            course,
            typical_mps: median(moving),
            left_out: episodes.map(|own| (own.from_s, own.until_s)).collect(),
        })
    }

    /// The phases of the contact one after another, each with its first and last time (s), and where none is since the
    /// log was left out. Touch and lift-off are instants at the scale of a picture and count as loading and unloading.
    pub(super) fn phases(&self) -> Vec<(&'static str, f64, f64)> {
        let mut runs: Vec<(&'static str, f64, f64)> = Vec::new();
        let samples = self.curves.depth_m.iter().zip(&self.curves.speed_mps);
        for ((depth, speed), time) in samples.zip(&self.curves.time_s) {
            let is_in = |(from, until): &(f64, f64)| (from..=until).contains(&time);
            let now = match self.course.phase(*depth, *speed) {
                _ if self.left_out.iter().any(is_in) => LEFT_OUT,
                "touch" => "loading",
                "lift_off" => "unloading",
                other => other,
            };
            match runs.last_mut() {
                Some(last) => {
                    last.2 = *time;
                    if last.0 != now {
                        runs.push((now, *time, *time));
                    }
                }
                None => runs.push((now, *time, *time)),
            }
        }
        runs
    }

    /// The parts of the log (s) on which the RMSE was taken.
    pub(super) fn held_out(&self) -> Vec<(f64, f64)> {
        let mut parts: Vec<(f64, f64)> = Vec::new();
        let mut before = false;
        for (out, time) in self.curves.held_out.iter().zip(&self.curves.time_s) {
            match parts.last_mut() {
                Some(last) if before && *out => last.1 = *time,
                _ if *out => parts.push((*time, *time)),
                _ => {}
            }
            before = *out;
        }
        parts
    }

    /// Whether anything is touched.
    pub(super) fn touches(&self) -> bool {
        self.course.deepest_m > 0.0
    }

    /// Where the rig is.
    pub(super) fn place(&self) -> Place<'a> {
        let position_m = &self.curves.position_m;
        match self.touches() {
            true => Place {
                name: "depth",
                axis: "Depth δ",
                each_m: &self.curves.depth_m,
                from_m: 0.0,
                to_m: self.course.deepest_m,
            },
            false => Place {
                name: "position",
                axis: "Position x",
                each_m: position_m,
                from_m: lowest(position_m.iter().copied()),
                to_m: highest(position_m.iter().copied()),
            },
        }
    }

    /// The direction of motion at a sample: −1 outward, 0 still, 1 inward.
    pub(super) fn direction(&self, at: usize) -> i8 {
        let speed = self.curves.speed_mps[at];
        match self.course.is_still(speed) {
            true => 0,
            false => speed.signum() as i8,
        }
    }

    /// Mean of `residuals` (N) in `count` equal bins of `x` over the range [low, high], for the samples
    /// that are `wanted`: the middles and the means of the bins. A bin with too few samples has NaN.
    pub(super) fn means(
        &self,
        residuals: &[f64],
        x: &[f64],
        (low, high): (f64, f64),
        count: usize,
        wanted: impl Fn(usize) -> bool,
    ) -> (Vec<f64>, Vec<f64>) {
        let width = (high - low) / count as f64;
        let mut bins = vec![(0.0, 0_usize); count];
        for (at, (x, residual)) in x.iter().zip(residuals).enumerate() {
            let bin = ((x - low) / width).floor();
            if residual.is_finite() && bin >= 0.0 && bin < count as f64 && wanted(at) {
                let bin = &mut bins[bin as usize];
                *bin = (bin.0 + residual, bin.1 + 1);
            }
        }
        let middles = (0..count).map(|at| low + (at as f64 + 0.5) * width);
        let mean = |(sum, many): (f64, usize)| match many >= FEWEST {
            true => sum / many as f64,
            false => f64::NAN,
        };
        (middles.collect(), bins.into_iter().map(mean).collect())
    }
}
