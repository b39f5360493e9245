//! Starts of effects that repeat in time or along the travel, from the spectrum of the residuals.

use std::f64::consts::TAU;

use estimator_core::physics::effect::{EffectId, MOST_PARAMETERS, Repeats};

use crate::gap::data::fit_data::FitData;
use crate::gap::model::shape::Term;
use crate::gap::model::simulate::{forces, forces_of_changed};
use crate::gap::model::start::{is_possible, repeats, whole};
use crate::gap::search::proposals::LinearizedModel;
use crate::lsq::basis::{dot, project_out};
use crate::spectral;
use crate::stats::median;

/// Peaks of a spectrum that become starts.
const PEAKS: usize = 3;
/// The largest maxima among which the sharpest one is looked for.
const SHARP: usize = 64;
/// Bins of the log on either side of a maximum that are its surroundings.
const SURROUNDINGS: usize = 16;
/// A maximum is sharp with this many times the median power around it: noise alone reaches 11 times.
const STANDS_OUT: f64 = 30.0;

/// Periods in a log of a slow wave that moves the surface, at least and at most. A spectrum mixes it with the touches: of
/// a breath at 0.25 Hz in 10 s of presses at 0.9 to 1.4 Hz it showed what lay 0.25 Hz beside them, and two disturbances
/// were certain in its place. There each wave is fitted.
const SLOW: [usize; 2] = [2, 12];

/// A wave that a carrier modulates. In time it is carrier·A sin(2πft + φ), and `frequency_or_pitch` is
/// the frequency f (Hz); along the travel it is carrier·A sin(2πx/p + φ), and `frequency_or_pitch` is
/// the pitch p (m).
struct Wave {
    amplitude: f64,
    frequency_or_pitch: f64,
    phase: f64,
}

/// The sine and the cosine of a wave, and what they take off Σ w r².
struct FittedWave {
    sine: f64,
    cosine: f64,
    gain: f64,
}

impl Wave {
    fn of(frequency_or_pitch: f64, fitted: &FittedWave) -> Wave {
        Wave {
            amplitude: fitted.sine.hypot(fitted.cosine),
            frequency_or_pitch,
            phase: fitted.cosine.atan2(fitted.sine),
        }
    }
}

impl LinearizedModel<'_> {
    /// Starts of the effects that repeat.
    pub(super) fn periodic_starts(&self, ids: &[EffectId]) -> Vec<Term> {
        let slope = self.stiffness_n_per_m();
        let mut found = Vec::new();
        let possible = |id: &&EffectId| repeats(**id) && is_possible(**id, &self.fit.shape);
        for id in ids.iter().filter(possible) {
            let info = id.info();
            let carrier = if info.stage.acts_in_free_air() {
                vec![1.0; self.roots.len()]
            } else {
                // It displaces. A surface that comes forward presses as a probe that goes in.
                slope.iter().map(|s| -s).collect()
            };
            let waves = if info.repeats == Repeats::InTime {
                let slow_hz = match info.stage.acts_in_free_air() {
                    true => None,
                    false => self.slow_hz(&carrier),
                };
                self.waves_in_time(&carrier, slow_hz)
            } else {
                self.waves_along_travel(&carrier)
            };
            for wave in waves {
                let mut row = [0.0; MOST_PARAMETERS];
                row[..3].copy_from_slice(&[wave.amplitude, wave.frequency_or_pitch, wave.phase]);
                found.push(whole(*id, row, 3));
            }
        }
        found
    }

    /// ∂F/∂x (N/m) at each sample.
    fn stiffness_n_per_m(&self) -> Vec<f64> {
        let step = self
            .scales
            .position_noise_m
            .max(1e-6 * self.scales.travel_m);
        let (shape, numbers) = (&self.fit.shape, &self.fit.numbers);
        let here = forces(shape, numbers, self.problem.logs);
        let moved = forces_of_changed(shape, numbers, self.problem.logs, |log| {
            log.position_m.iter_mut().for_each(|x| *x += step);
        });
        moved
            .iter()
            .zip(&here)
            .map(|(a, b)| (a - b) / step)
            .collect()
    }

    /// The strongest waves in time in the residuals of the first log, those of its rests, and a slow one.
    fn waves_in_time(&self, carrier: &[f64], slow_hz: Option<f64>) -> Vec<Wave> {
        let log = &self.problem.logs[0];
        let in_residuals = self.frequencies_hz(log, carrier);
        let all = in_residuals
            .iter()
            .chain(&log.rest_waves_hz)
            .chain(&slow_hz);
        all.filter_map(|hz| Some(Wave::of(*hz, &self.wave_at(carrier, *hz)?)))
            .collect()
    }

    /// The wave of a frequency (Hz) in the residuals of the first log.
    fn wave_at(&self, carrier: &[f64], hz: f64) -> Option<FittedWave> {
        let log = &self.problem.logs[0];
        self.fitted_wave(carrier, |row| TAU * hz * log.time_s[row], log.len())
    }

    /// The frequency (Hz) of the slow wave that takes most off the residuals of the first log.
    fn slow_hz(&self, carrier: &[f64]) -> Option<f64> {
        let log = &self.problem.logs[0];
        let fastest_hz = log.fastest_wave_hz()?;
        let quarters = 4 * SLOW[0]..=4 * SLOW[1];
        let all = quarters.map(|at| 0.25 * at as f64 / self.scales.duration_s);
        let waves = all.filter(|hz| *hz < fastest_hz).filter_map(|hz| {
            let gain = self.wave_at(carrier, hz)?.gain;
            Some((hz, gain))
        });
        let best = waves.max_by(|a, b| a.1.total_cmp(&b.1));
        best.map(|(hz, _)| hz)
    }

    /// The frequencies (Hz) of the strongest waves in the residuals of a log.
    fn frequencies_hz(&self, log: &FitData, carrier: &[f64]) -> Vec<f64> {
        let n = log.len();
        let Some(fastest_hz) = log.fastest_wave_hz() else {
            return Vec::new();
        };
        let weighted = (0..n).map(|at| self.residuals[at] * self.roots[at] * carrier[at]);
        let series = log.in_slots(weighted);
        let slots = series.len();
        let padded = (2 * slots).next_power_of_two();
        let bin_hz = 1.0 / (padded as f64 * log.period_s);
        let bins = ((fastest_hz / bin_hz) as usize).min(padded / 2);
        let power = &spectral::power(series, padded)[..bins];
        let lowest = (2.0 / (self.scales.duration_s * bin_hz)).ceil() as usize;
        let peaks = peaks(power, lowest.max(1), padded / slots);
        peaks.into_iter().map(|at| at as f64 * bin_hz).collect()
    }

    /// The strongest waves along the travel in the residuals of the first log.
    fn waves_along_travel(&self, carrier: &[f64]) -> Vec<Wave> {
        let log = &self.problem.logs[0];
        let travel_m = self.scales.travel_m;
        // Bins are quarter cycles over the travel, up to a pitch of 16 counts or as many as 400 cycles.
        let finest = (travel_m / (16.0 * self.scales.position_noise_m)).min(400.0);
        let quarters = (4.0 * finest) as usize;
        // On a grid of four travels, at least eight cells a pitch: 3 % of the finest is lost.
        let cells = (8 * quarters).next_power_of_two();
        let per_cell_m = 4.0 * travel_m / cells as f64;
        let mut series = vec![0.0; cells];
        let each = self.residuals.iter().zip(&self.roots).zip(carrier);
        for (((residual, root), carrier), position_m) in each.zip(&log.position_m) {
            let at = (position_m / per_cell_m).floor() as i64;
            series[at.rem_euclid(cells as i64) as usize] += residual * root * carrier;
        }
        let power = &spectral::power(series, cells)[..quarters];
        let wave = |at: usize| {
            let per_m = 0.25 * at as f64 / travel_m;
            let angle = |row: usize| TAU * per_m * log.position_m[row];
            let fitted = self.fitted_wave(carrier, angle, log.len())?;
            Some(Wave::of(1.0 / per_m, &fitted))
        };
        peaks(power, 8, 4).into_iter().filter_map(wave).collect()
    }

    /// carrier·A sin(angle + φ) that fits the residuals best, projected off the basis.
    fn fitted_wave(
        &self,
        carrier: &[f64],
        angle: impl Fn(usize) -> f64,
        n: usize,
    ) -> Option<FittedWave> {
        let mut sine = vec![0.0; self.residuals.len()];
        let mut cosine = sine.clone();
        for row in 0..n {
            let scale = self.roots[row] * carrier[row];
            let (sin, cos) = angle(row).sin_cos();
            (sine[row], cosine[row]) = (scale * sin, scale * cos);
        }
        project_out(&mut sine, &self.basis);
        project_out(&mut cosine, &self.basis);
        let (ss, sc, cc) = (
            dot(&sine, &sine),
            dot(&sine, &cosine),
            dot(&cosine, &cosine),
        );
        let (s, c) = (dot(&sine, &self.residuals), dot(&cosine, &self.residuals));
        let determinant = ss * cc - sc * sc;
        if determinant <= 1e-9 * ss * cc {
            return None;
        }
        let (sine, cosine) = (
            (s * cc - c * sc) / determinant,
            (c * ss - s * sc) / determinant,
        );
        Some(FittedWave {
            sine,
            cosine,
            gain: sine * s + cosine * c,
        })
    }
}

/// The largest local maxima from bin `lowest` on, at least two times `width` bins from each other, and beside
/// them the one that stands out most of its surroundings: what a measured record leaves is largest where it is
/// slow, and a sharp line of 27 Hz, twice as large as all of it, was the fourth of its peaks.
fn peaks(power: &[f64], lowest: usize, width: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (lowest..power.len().saturating_sub(1))
        .filter(|at| power[*at] >= power[at - 1] && power[*at] >= power[at + 1] && power[*at] > 0.0)
        .collect();
    order.sort_by(|a, b| power[*b].total_cmp(&power[*a]));
    let mut chosen: Vec<usize> = Vec::new();
    let is_apart =
        |chosen: &[usize], at: usize| chosen.iter().all(|other| other.abs_diff(at) >= 2 * width);
    for at in order.iter().copied() {
        if is_apart(&chosen, at) {
            chosen.push(at);
        }
        if chosen.len() == PEAKS {
            break;
        }
    }
    let level = |at: usize| {
        let near = at.saturating_sub(SURROUNDINGS * width)..(at + SURROUNDINGS * width);
        median(power[near.start..near.end.min(power.len())].iter().copied())
    };
    let sharp = order.iter().take(SHARP).copied();
    let sharp = sharp.filter(|at| is_apart(&chosen, *at) && power[*at] > STANDS_OUT * level(*at));
    let sharpest = sharp.max_by(|a, b| (power[*a] / level(*a)).total_cmp(&(power[*b] / level(*b))));
    chosen.extend(sharpest);
    chosen
}
