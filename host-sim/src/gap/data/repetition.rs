//! The frequency at which a motion repeats itself, if it does.
//!
//! Whatever depends on the motion repeats with it, so that a line at that frequency or at a harmonic of it
//! says nothing about a disturbance in time.

use super::fit_data::FitData;
use crate::spectral;

/// Cells of a period: a tenth harmonic is three of them.
const CELLS: usize = 32;
/// A motion repeats if less than this share of its variance is left within the cells: a sine leaves 0.3 % of
/// it there, strokes at three speeds half.
const LEFT: f64 = 0.03;
/// Fewest periods. Two that are alike to [`LEFT`] are no chance, and a surgical tool that turned to and fro twice in
/// 20 s was told of a line at three times its frequency.
const FEWEST_PERIODS: f64 = 1.9;
/// The highest harmonic that counts.
const HARMONICS: f64 = 10.0;
/// How far a line may be from a harmonic, over the width 1/T that the log resolves.
const NEAR: f64 = 0.25;

/// The frequency (Hz) at which the motion of a log repeats.
pub(super) fn of(log: &FitData) -> Option<f64> {
    let duration_s = log.duration_s();
    let middle_m = log.position_m.iter().sum::<f64>() / log.len() as f64;
    let moved = || log.position_m.iter().map(|x| x - middle_m);
    let variance = moved().map(|x| x * x).sum::<f64>() / log.len() as f64;
    if duration_s <= 0.0 || variance <= 0.0 {
        return None;
    }
    // Where waves are looked for in time it has to be known.
    if log.fastest_wave_hz().is_none() && log.rest_waves_hz.is_empty() {
        return None;
    }
    let series = log.held_in_slots(moved());
    let padded = (4 * series.len()).next_power_of_two();
    let power = spectral::power(series, padded);
    let strongest = (1..padded / 2).max_by(|a, b| power[*a].total_cmp(&power[*b]))?;
    let peak_hz = strongest as f64 / (padded as f64 * log.period_s);
    let near = |hz: f64| (-20..=20).map(move |step| hz + 0.03 * f64::from(step) / duration_s);
    let candidates = [1.0, 2.0, 3.0].into_iter().flat_map(|m| near(peak_hz / m));
    let repeating = candidates
        .filter(|hz| hz * duration_s >= FEWEST_PERIODS)
        .map(|hz| (hz, left_in_cells(log, middle_m, hz) / variance));
    let (hz, left) = repeating.min_by(|a, b| a.1.total_cmp(&b.1))?;
    (left < LEFT).then_some(hz)
}

/// The mean square (m²) of the positions around the means of the cells of a period.
fn left_in_cells(log: &FitData, middle_m: f64, hz: f64) -> f64 {
    let mut cells = [[0.0_f64; 3]; CELLS];
    for (time, position) in log.time_s.iter().zip(&log.position_m) {
        let phase = (time * hz).rem_euclid(1.0);
        let cell = &mut cells[((phase * CELLS as f64) as usize).min(CELLS - 1)];
        let x = position - middle_m;
        cell.iter_mut()
            .zip([1.0, x, x * x])
            .for_each(|(sum, term)| *sum += term);
    }
    let left = cells.iter().filter(|cell| cell[0] > 0.0);
    let squares: f64 = left.map(|[n, x, xx]| xx - x * x / n).sum();
    squares / log.len() as f64
}

/// Whether a line repeats with a motion that repeats at `motion_hz` in a log of a duration.
pub(crate) fn repeats_with(motion_hz: Option<f64>, line_hz: f64, duration_s: f64) -> bool {
    motion_hz.is_some_and(|hz| {
        let harmonic = (line_hz / hz).round().clamp(1.0, HARMONICS);
        (line_hz - harmonic * hz).abs() * duration_s < NEAR
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::Log;
    use std::f64::consts::TAU;

    fn found(position: impl Fn(f64) -> f64) -> Option<f64> {
        let time: Vec<f64> = (0..20_000).map(|at| 1e-3 * f64::from(at)).collect();
        let x = time.iter().map(|t| position(*t)).collect();
        let force = vec![0.0; time.len()];
        let log = Log::from_channels(time, x, force).uniform().unwrap();
        of(&FitData::of(&log))
    }

    #[test]
    fn a_sine_and_strokes_of_one_speed_repeat_and_a_chirp_and_two_sines_do_not() {
        let sine = found(|t| 1e-3 * (TAU * 0.31 * t).sin()).unwrap();
        assert!((sine - 0.31).abs() < 2e-3, "{sine}");
        // A trapezoid: strokes with rests at both ends.
        let stroke = |t: f64| 1e-3 * (2.0 * (TAU * 0.5 * t).sin()).clamp(-1.0, 1.0);
        let strokes = found(stroke).unwrap();
        assert!((strokes - 0.5).abs() < 2e-3, "{strokes}");
        // Two turns in the 20 s of the log repeat, and one and a half do not.
        assert!(found(|t| (TAU * 0.1 * t).sin()).is_some_and(|hz| (hz - 0.1).abs() < 2e-3));
        assert_eq!(found(|t| (TAU * 0.075 * t).sin()), None);
        assert_eq!(found(|t| 1e-3 * (TAU * (0.2 + 0.05 * t) * t).sin()), None);
        let two = |t: f64| (TAU * 0.31 * t).sin() + (TAU * 0.7212 * t).sin();
        assert_eq!(found(|t| 1e-3 * two(t)), None);
    }

    #[test]
    fn the_third_harmonic_repeats_with_the_motion_and_a_line_between_does_not() {
        assert!(repeats_with(Some(0.299), 0.895, 60.0));
        assert!(!repeats_with(Some(0.299), 0.75, 60.0));
        assert!(!repeats_with(None, 0.895, 60.0));
    }
}
