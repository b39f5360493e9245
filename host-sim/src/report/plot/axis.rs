//! Axes: a range that shows the data, a prefix for the unit, ticks at round numbers.

use std::ops::Range;

use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};

use crate::kind;
use crate::number::{fixed, prefix_for, superscript, unit_text};

/// One axis of a [`Chart`](super::Chart).
#[derive(Clone, Debug)]
pub struct Axis {
    label: String,
    unit: String,
    log: bool,
    range: Option<(f64, f64)>,
    tight: bool,
    zero: bool,
}

impl Axis {
    /// An axis for values in `unit` (without prefix: `m`, `N`, `N s/m`, `1`). The prefix, the range and
    /// the ticks follow the data.
    pub fn new(label: impl Into<String>, unit: impl Into<String>) -> Axis {
        Axis {
            label: label.into(),
            unit: unit.into(),
            log: false,
            range: None,
            tight: false,
            zero: false,
        }
    }

    /// The axis of time in seconds, which runs from the first to the last sample without margins.
    pub fn time() -> Axis {
        Axis {
            tight: true,
            ..Axis::new("Time", "s")
        }
    }

    /// Makes the axis logarithmic. Values that are not positive are not shown.
    pub fn log(mut self) -> Axis {
        self.log = true;
        self
    }

    /// Makes the axis show this range whatever the data. The range is ignored unless its ends are two
    /// different finite numbers.
    pub fn range(mut self, low: f64, high: f64) -> Axis {
        self.range = Some((low, high));
        self
    }

    /// Makes the axis show zero whatever the data.
    pub fn with_zero(mut self) -> Axis {
        self.zero = true;
        self
    }

    pub(crate) fn is_tight(&self) -> bool {
        self.tight
    }

    /// Fits the axis to the range of the data (`None` without data), with at most this number of ticks.
    pub(crate) fn resolve(&self, data: Option<(f64, f64)>, most_ticks: usize) -> Scale {
        let data = data.map(|(low, high)| match self.zero && !self.log {
            true => (low.min(0.0), high.max(0.0)),
            false => (low, high),
        });
        let chosen = self.range.filter(|(a, b)| a < b && (b - a).is_finite());
        let chosen = chosen.filter(|(low, _)| !self.log || *low > 0.0);
        if self.log {
            return self.resolve_log(chosen.or(data), chosen.is_some());
        }
        let (low, high) =
            chosen.unwrap_or_else(|| widen(data, if self.tight { 0.0 } else { 0.05 }));
        let prefix = prefix_for(low.abs().max(high.abs()), &self.unit);
        let (low, high) = (low / prefix.factor, high / prefix.factor);
        Scale {
            factor: 1.0 / prefix.factor,
            log: false,
            low,
            high,
            ticks: linear_ticks(low, high, most_ticks),
            minor: Vec::new(),
            name: self.name(&unit_text(prefix, &self.unit)),
        }
    }

    fn resolve_log(&self, data: Option<(f64, f64)>, exact: bool) -> Scale {
        let data = data.filter(|(low, _)| *low > 0.0).unwrap_or((1.0, 10.0));
        let (mut low, mut high) = (data.0.log10(), data.1.log10());
        if !exact {
            let margin = if self.tight { 0.0 } else { 0.04 * (high - low) };
            (low, high) = (low - margin, high + margin);
            if high - low < 0.3 {
                (low, high) = (low - 0.15, high + 0.15);
            }
        }
        let (ticks, minor) = log_ticks(low, high);
        Scale {
            factor: 1.0,
            log: true,
            low,
            high,
            ticks,
            minor,
            name: self.name(&kind::unit(&self.unit).replace(' ', "\u{a0}")),
        }
    }

    fn name(&self, unit: &str) -> String {
        match unit {
            "" | "1" => self.label.clone(),
            unit => format!("{} [{unit}]", self.label),
        }
    }
}

/// An axis that is fitted to its data.
#[derive(Clone, Debug)]
pub(crate) struct Scale {
    factor: f64,
    log: bool,
    /// The ends of the axis in units of the scale: prefixed units, or log₁₀.
    pub(crate) low: f64,
    pub(crate) high: f64,
    /// The labelled ticks, each with its position and its label.
    pub(crate) ticks: Vec<(f64, String)>,
    /// The positions of grid lines without a label.
    pub(crate) minor: Vec<f64>,
    /// Label and unit.
    pub(crate) name: String,
}

impl Scale {
    /// Whether the scale is logarithmic.
    pub(crate) fn is_log(&self) -> bool {
        self.log
    }

    /// Converts a value from the unit of the data to the unit of the scale. The result is not finite where
    /// nothing can be shown.
    pub(crate) fn map(&self, value: f64) -> f64 {
        match self.log {
            true if value > 0.0 => value.log10(),
            true => f64::NAN,
            false => value * self.factor,
        }
    }
}

/// What plotters needs to know of a scale. The number of key points that plotters finds by itself has no
/// upper bound, and they stop at NaN; these key points come from [`Axis::resolve`].
impl Ranged for Scale {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (from, to): (i32, i32)) -> i32 {
        let fraction = (value - self.low) / (self.high - self.low);
        (f64::from(from) + fraction * f64::from(to - from)).round() as i32
    }

    fn key_points<H: KeyPointHint>(&self, hint: H) -> Vec<f64> {
        match hint.weight().allow_light_points() {
            true => self.minor.clone(),
            false => self.ticks.iter().map(|(at, _)| *at).collect(),
        }
    }

    fn range(&self) -> Range<f64> {
        self.low..self.high
    }
}

impl ValueFormatter<f64> for Scale {
    fn format_ext(&self, value: &f64) -> String {
        let tick = self.ticks.iter().find(|(at, _)| at == value);
        tick.map_or(String::new(), |(_, label)| label.clone())
    }
}

/// The range with a margin on either side. Without data, or for a constant, it is a range of finite
/// width.
fn widen(data: Option<(f64, f64)>, margin: f64) -> (f64, f64) {
    let Some((low, high)) = data else {
        return (0.0, 1.0);
    };
    let size = low.abs().max(high.abs());
    // Below a millionth of the value the labels would need more digits than fit.
    if high - low <= 1e-6 * size || size == 0.0 {
        let half = if size == 0.0 { 1.0 } else { 0.05 * size };
        return (low - half, high + half);
    }
    let margin = margin * (high - low);
    (low - margin, high + margin)
}

/// Multiples of 1, 2 or 5 times a power of ten, at most `most` of them.
fn linear_ticks(low: f64, high: f64, most: usize) -> Vec<(f64, String)> {
    let rough = (high - low) / most.max(1) as f64;
    let decade = 10f64.powf(rough.log10().floor());
    let nice = [1.0, 2.0, 5.0, 10.0].map(|m| m * decade);
    // Half a thousandth of a step of tolerance: 0.30000000000000004 is on an axis that ends at 0.3.
    let ends = |step: f64| {
        let first = (low / step - 5e-4).ceil() as i64;
        (first, (high / step + 5e-4).floor() as i64)
    };
    // One more than asked for where both ends are ticks.
    let fits = |step: &f64| {
        let (first, last) = ends(*step);
        last - first <= most.max(1) as i64
    };
    let step = nice.into_iter().find(fits).unwrap_or(nice[3]);
    let place = (step.log10() + 1e-9).floor() as i32;
    let (first, last) = ends(step);
    (first..=last)
        .take(2 * most.max(1) + 2)
        .map(|i| (i as f64 * step, fixed(i as f64 * step, place)))
        .collect()
}

/// The decades, thinned to at most ten, with the multiples by 2 and 5 if there are fewer than two decades.
fn log_ticks(low: f64, high: f64) -> (Vec<(f64, String)>, Vec<f64>) {
    let (first, last) = (low.floor() as i32, high.ceil() as i32);
    let every = (last - first) / 10 + 1;
    let within = |at: f64| at >= low - 1e-9 && at <= high + 1e-9;
    let between: &[i32] = if high - low < 2.0 { &[1, 2, 5] } else { &[1] };
    let mut ticks = Vec::new();
    let mut minor = Vec::new();
    for exponent in first..=last {
        for digit in 1..10 {
            let at = f64::from(exponent) + f64::from(digit).log10();
            let labelled = between.contains(&digit) && (exponent - first) % every == 0;
            match within(at) {
                true if labelled => ticks.push((at, decade_label(digit, exponent))),
                true if last - first <= 4 => minor.push(at),
                _ => {}
            }
        }
    }
    (ticks, minor)
}

fn decade_label(digit: i32, exponent: i32) -> String {
    match exponent {
        -4..=4 => fixed(f64::from(digit) * 10f64.powi(exponent), exponent.min(0)),
        _ if digit == 1 => format!("10{}", superscript(exponent)),
        _ => format!("{digit}·10{}", superscript(exponent)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(scale: &Scale) -> Vec<&str> {
        scale.ticks.iter().map(|(_, text)| text.as_str()).collect()
    }

    #[test]
    fn ticks_are_round_and_carry_the_digits_of_their_step() {
        let axis = Axis::new("x", "1").range(0.0, 0.3);
        assert_eq!(
            labels(&axis.resolve(None, 6)),
            ["0.00", "0.05", "0.10", "0.15", "0.20", "0.25", "0.30"]
        );
        let axis = Axis::new("x", "1").range(-1.0, 1.0);
        assert_eq!(
            labels(&axis.resolve(None, 4)),
            ["−1.0", "−0.5", "0.0", "0.5", "1.0"]
        );
    }

    #[test]
    fn the_unit_takes_the_prefix_of_the_data() {
        let depth = Axis::new("Depth", "m").resolve(Some((0.0, 4.5e-3)), 6);
        assert_eq!(depth.name, "Depth [mm]");
        assert!((depth.map(4.5e-3) - 4.5).abs() < 1e-12);
        let force = Axis::new("Force", "N").resolve(Some((-2e-9, 40e-9)), 6);
        assert_eq!(force.name, "Force [nN]");
        assert_eq!(Axis::new("n", "1").resolve(Some((1.0, 2.0)), 6).name, "n");
    }

    #[test]
    fn no_data_a_constant_and_a_hair_above_a_constant_all_have_ticks() {
        let axis = Axis::new("x", "N/m");
        for data in [
            None,
            Some((0.0, 0.0)),
            Some((1350.0, 1350.0)),
            Some((1350.0, 1350.0 + 1e-9)),
            Some((-1e-30, -1e-30)),
            Some((1e15, 1e15)),
        ] {
            let scale = axis.resolve(data, 6);
            assert!(scale.low < scale.high, "{data:?}");
            assert!((2..=8).contains(&scale.ticks.len()), "{data:?} {scale:?}");
        }
    }

    #[test]
    fn a_time_axis_ends_where_the_data_ends() {
        let scale = Axis::time().resolve(Some((0.0, 50.0)), 8);
        assert_eq!((scale.low, scale.high), (0.0, 50.0));
        assert_eq!(scale.name, "Time [s]");
    }

    #[test]
    fn a_log_axis_shows_decades_and_hides_what_is_not_positive() {
        let axis = Axis::new("x", "N").log();
        let scale = axis.resolve(Some((1e-4, 1e3)), 6);
        assert_eq!(
            labels(&scale),
            ["0.0001", "0.001", "0.01", "0.1", "1", "10", "100", "1000"]
        );
        assert!(scale.map(0.0).is_nan() && scale.map(-1.0).is_nan());
        assert_eq!(
            labels(&axis.resolve(Some((1.0, 10.0)), 6)),
            ["1", "2", "5", "10"]
        );
        assert!(!axis.resolve(Some((5.0, 5.0)), 6).ticks.is_empty());
        assert!(!axis.resolve(Some((-5.0, 5.0)), 6).ticks.is_empty());
    }
}
