//! Waves in a rest that is thinned, seen at the log's own rate.
//!
//! Between the samples that are kept of a long rest a wave would be the rest's own course, or an alias. A line in
//! what was measured is none: it stands out of the spectrum of all samples, and the fit then meets its frequency, at
//! the instants that are kept, as any other start.

use std::ops::Range;

use super::fit_data::FitData;
use crate::spectral;
use crate::stats::median;

/// Waves of a log that become starts.
const MOST_WAVES: usize = 2;
/// A wave has this many times the median power around it. Rests of foams and cells reach 30 times beside the lines of
/// their electronics (0.06 and 0.6 nN, 400 and 1000 times), and a wave of 55 nN in a record of cells ten million.
const STANDS_OUT: f64 = 100.0;
/// Bins of the spectrum for each of the rest.
const PADDING: usize = 4;
/// Periods between which a wave has its surroundings: Hann's window lets it into two on either side.
const SURROUNDINGS: Range<usize> = 3..16;
/// Fewest periods in the rest. What is slower is taken off as the rest's course: means over a twentieth of it, twice,
/// leave 0.95 of a wave with 20 or more.
const FEWEST_PERIODS: usize = 20;
/// Fewest measured instants of a rest.
const FEWEST: usize = 16 * FEWEST_PERIODS;

/// The frequencies (Hz) of the strongest waves in a rest of a log, none of a short one.
pub(super) fn of(log: &FitData, rest: Range<usize>) -> Vec<f64> {
    // What the motion leaves behind dies out.
    let settled = rest.start + rest.len() / 10..rest.end;
    let measured: Vec<usize> = settled.filter(|at| log.count[*at] > 0.0).collect();
    if measured.len() < FEWEST {
        return Vec::new();
    }
    let step = median(measured.windows(2).map(|two| (two[1] - two[0]) as f64));
    let series = without_course(&held(log, &measured, step as usize));
    let length = series.len();
    let windowed = series.iter().enumerate();
    let windowed = windowed.map(|(at, force)| spectral::hann(at, length) * force);
    let padded = (PADDING * length).next_power_of_two();
    let power = spectral::power(windowed, padded);
    let bin_hz = 1.0 / (padded as f64 * step * log.period_s);
    // Bins for each period in the rest.
    let width = padded / length;
    let mut found: Vec<(f64, f64)> = (FEWEST_PERIODS * width..power.len() - 1)
        .filter(|at| power[*at] >= power[at - 1] && power[*at] > power[at + 1])
        .filter(|at| power[*at] > STANDS_OUT * level(&power, *at, width))
        .map(|at| {
            (
                power[at],
                bin_hz * (at as f64 + top(&power[at - 1..=at + 1])),
            )
        })
        .collect();
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    found.truncate(MOST_WAVES);
    found.into_iter().map(|(_, hz)| hz).collect()
}

/// The forces (N) of a rest every `step` samples, each held until the next one that was measured.
fn held(log: &FitData, measured: &[usize], step: usize) -> Vec<f64> {
    let (Some(first), Some(last)) = (measured.first(), measured.last()) else {
        return Vec::new();
    };
    let mut next = 0;
    let one = |at: usize| {
        while measured.get(next + 1).is_some_and(|other| *other <= at) {
            next += 1;
        }
        log.force_n[measured[next]]
    };
    (*first..=*last).step_by(step).map(one).collect()
}

/// A series without its course: without the means over a twentieth of it, taken twice. Its ends, where there is no
/// such mean, are left out.
fn without_course(series: &[f64]) -> Vec<f64> {
    let half = series.len() / (2 * FEWEST_PERIODS);
    let course = means(&means(series, half), half);
    let inner = series.iter().skip(2 * half).zip(course);
    inner.map(|(value, course)| value - course).collect()
}

/// The means over `half` values on either side, of all values that have as many.
fn means(series: &[f64], half: usize) -> Vec<f64> {
    let width = 2 * half + 1;
    let windows = series.windows(width);
    windows
        .map(|w| w.iter().sum::<f64>() / width as f64)
        .collect()
}

/// The median power around a bin.
fn level(power: &[f64], at: usize, width: usize) -> f64 {
    let apart = width * SURROUNDINGS.start..width * SURROUNDINGS.end;
    let below = apart.clone().filter_map(|apart| at.checked_sub(apart));
    let around = below.chain(apart.map(|apart| at + apart));
    median(around.filter_map(|at| power.get(at).copied()))
}

/// How far (bins) the top of a parabola through the logarithms of three powers is from the middle one.
fn top(power: &[f64]) -> f64 {
    let [below, here, above] = [0, 1, 2].map(|at| power[at].max(f64::MIN_POSITIVE).ln());
    let bend = below - 2.0 * here + above;
    if bend < 0.0 {
        (0.5 * (below - above) / bend).clamp(-0.5, 0.5)
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::Log;
    use std::f64::consts::TAU;

    /// A rest from 1 s on, at 200 Hz, in which a force relaxes, with a wave of 3 mN in it and readings of 0.1 mN.
    fn found(seconds: usize, wave_hz: f64, is_measured: impl Fn(usize) -> bool) -> Vec<f64> {
        let time_s: Vec<f64> = (0..200 * seconds).map(|at| 5e-3 * at as f64).collect();
        let position_m = time_s.iter().map(|t| 1e-3 * t.min(1.0)).collect();
        let force = |t: &f64| {
            let wave = 3e-3 * (TAU * wave_hz * t).sin();
            let force_n = 0.5 * t.min(1.0) * (1.0 + t).powf(-0.2) + wave;
            (force_n / 1e-4).round() * 1e-4
        };
        let force_n = time_s.iter().map(force).collect();
        let log = Log::from_channels(time_s, position_m, force_n);
        let mut data = FitData::of(&log.uniform().unwrap());
        for (at, count) in data.count.iter_mut().enumerate() {
            *count = f64::from(u8::from(is_measured(at)));
        }
        of(&data, 200..data.len())
    }

    #[test]
    fn a_wave_of_a_rest_is_found_beside_its_course_whatever_was_measured_of_it() {
        // GIVEN a minute, of which every sample was measured, and every twentieth
        for hz in [
            found(60, 1.37, |_| true),
            found(60, 1.37, |at| at % 20 == 0),
        ] {
            // THEN the wave is within a tenth of a period of the rest.
            assert!((hz[0] - 1.37).abs() < 0.1 / 60.0, "{hz:?}");
        }
        // AND there is none where only the force's course is, or too few samples.
        assert!(found(60, 0.0, |_| true).is_empty());
        assert!(found(60, 1.37, |at| at % 50 == 0).is_empty());
    }
}
