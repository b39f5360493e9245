//! The noise floor of the force, without a model.
//!
//! Two opinions. The high-pass one (second differences) sees white noise only. The one at rest, in
//! free air, sees the whole spectrum of what is there when nothing moves; sharp lines in it (a pump, a
//! disturbance) are no noise and are cut to their neighbours' level, and one that runs through all free
//! air is taken out first. Where the two differ the noise is coloured, and rest is right; its fast part
//! is the better known from the whole log.

use std::ops::Range;

use crate::gap::noise::line::Line;
use crate::gap::noise::spectrum::{self, Rise, Spectrum, detrended};
use crate::log::UniformLog;
use crate::signal;
use crate::stats::correlation;

/// Standard errors of a floor that it may be off by.
pub(in crate::gap) const FLOOR_ERRORS: f64 = 3.0;

/// Shortest rest that counts (samples), and the longest window of its spectrum.
const SHORTEST: usize = 128;
const LONGEST: usize = 2048;
/// Windows of the whole log (samples), and from where on (cycles per sample) noise is fast.
const WINDOW: usize = 256;
const HIGH: f64 = 1.0 / 16.0;
/// So many standard errors are no scatter.
const CERTAIN: f64 = 3.0;
/// From this ratio on it is not white.
const COLOURED: f64 = 1.06;
/// A disturbance has at least this share of the power at rest: where it has less, the floor is at
/// most 1.4 times too high.
const DISTURBED: f64 = 0.5;
/// Most lines that are looked for; some repeat with the motion.
const LINES: usize = 4;

/// What the force does when nothing happens.
#[derive(Clone, Debug, PartialEq)]
pub struct Floor {
    /// Standard deviation (N) from second differences.
    pub high_pass_n: f64,
    /// Standard deviation (N) at rest in free air, lines left out; `None` without such a rest.
    pub rest_n: Option<f64>,
    /// Root mean square (N) of the lines that were cut out of the rest.
    pub lines_n: f64,
    /// The one to trust (N).
    pub used_n: f64,
    /// Whether it is not white.
    pub coloured: bool,
    /// Standard error of the one to trust, as a share of it; 0 where all samples had a say.
    pub uncertainty: f64,
    /// Samples per independent one.
    pub correlation: f64,
    /// Which one it is, in words.
    pub why: String,
}

impl Floor {
    /// The floor of a log.
    pub fn of(log: &UniformLog) -> Floor {
        let rests = rests(log);
        let mut floor = Floor::as_it_is(log, &rests);
        if rests.is_empty() {
            return floor;
        }
        let free = in_free_air(log);
        let without = |force_n: &mut [f64], line: &Line| {
            let each = force_n.iter_mut().enumerate();
            each.for_each(|(at, own)| *own -= line.at(at));
        };
        let (mut quiet, mut searched) = (log.clone(), log.force_n.clone());
        for _ in 0..LINES {
            let Some(line) = Line::strongest(&searched, &free) else {
                break;
            };
            without(&mut searched, &line);
            let mut quieter = quiet.clone();
            without(&mut quieter.force_n, &line);
            let other = Floor::as_it_is(&quieter, &rests);
            // What repeats with the motion is not there at rest.
            if other.resting_n2() < DISTURBED * floor.resting_n2() {
                (floor, quiet) = (other, quieter);
            }
        }
        floor
    }

    /// Of what is there, disturbed or not.
    fn as_it_is(log: &UniformLog, rests: &[Range<usize>]) -> Floor {
        let high_pass_n = high_pass(log);
        let rest = rest(log, rests, high_pass_n);
        let rest_n = rest.as_ref().map(|own| own.noise_n2.sqrt());
        let (used_n, why) = match rest_n {
            None => (
                high_pass_n,
                "from second differences: there is no rest in free air",
            ),
            Some(rest) if rest > COLOURED * high_pass_n => {
                (rest, "from rest in free air: the noise is coloured")
            }
            // Both see the same; the one from all samples is the better one.
            Some(_) => (
                high_pass_n,
                "from second differences, and rest in free air agrees",
            ),
        };
        let coloured = used_n > COLOURED * high_pass_n;
        let error = |own: &Rest| 0.5 * own.error_n2 / own.noise_n2.max(f64::MIN_POSITIVE);
        Floor {
            coloured,
            correlation: if coloured {
                resting_correlation(log, rests)
            } else {
                1.0
            },
            uncertainty: rest.as_ref().filter(|_| coloured).map_or(0.0, error),
            high_pass_n,
            rest_n,
            lines_n: rest.map_or(0.0, |own| own.lines_n2.sqrt()),
            used_n,
            why: why.into(),
        }
    }

    /// Power at rest (N²), lines and all.
    fn resting_n2(&self) -> f64 {
        self.rest_n.unwrap_or(0.0).powi(2) + self.lines_n.powi(2)
    }
}

/// Samples of the quarter of the travel that is furthest out.
fn in_free_air(log: &UniformLog) -> Vec<bool> {
    let out_m = out_m(&log.position_m);
    let each = log.position_m.iter().zip(&log.in_gap);
    each.map(|(x, gap)| *x <= out_m && !gap).collect()
}

fn out_m(position_m: &[f64]) -> f64 {
    let lowest = position_m.iter().copied().fold(f64::INFINITY, f64::min);
    lowest + 0.25 * signal::range(position_m)
}

/// Stretches in which the position stays within two counts, in the quarter of the travel that is
/// furthest out.
pub(in crate::gap) fn rests(log: &UniformLog) -> Vec<Range<usize>> {
    let position = &log.position_m;
    let out_m = out_m(position);
    let still_m = 2.5 * signal::step(position).unwrap_or(signal::noise(position) * 4.0);
    let mut rests = Vec::new();
    let mut from = 0;
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for (at, x) in position.iter().copied().enumerate() {
        let (lower, higher) = (low.min(x), high.max(x));
        if higher - lower > still_m || x > out_m || log.in_gap[at] {
            if at - from >= SHORTEST {
                rests.push(from..at);
            }
            from = at + 1;
            (low, high) = (f64::INFINITY, f64::NEG_INFINITY);
        } else {
            (low, high) = (lower, higher);
        }
    }
    if position.len() - from.min(position.len()) >= SHORTEST {
        rests.push(from..position.len());
    }
    rests
}

/// Second differences again, but their mean square within four of [`signal::noise`]'s sigmas: the
/// median of a channel with coarse steps is good to half a step only.
fn high_pass(log: &UniformLog) -> f64 {
    let coarse = log.force_noise_n();
    let limit = 4.0 * coarse * 6.0_f64.sqrt();
    let differences = log.force_n.windows(3).zip(log.in_gap.windows(3));
    let kept = differences
        .filter(|(_, gap)| !gap.contains(&true))
        .map(|(w, _)| w[2] - 2.0 * w[1] + w[0])
        .filter(|d| d.abs() <= limit);
    let fine = signal::rms(kept) / 6.0_f64.sqrt();
    if fine > 0.0 { fine } else { coarse }
}

/// What the rests say of the noise: N², and the standard error of `noise_n2`.
struct Rest {
    noise_n2: f64,
    lines_n2: f64,
    error_n2: f64,
}

fn rest(log: &UniformLog, rests: &[Range<usize>], noise_n: f64) -> Option<Rest> {
    let spectra: Vec<Spectrum> = rests
        .iter()
        .flat_map(|rest| log.force_n[settled(rest)].chunks(LONGEST))
        .filter(|own| own.len() >= SHORTEST / 2)
        .map(|window| Spectrum::of(window, noise_n))
        .collect();
    if spectra.is_empty() {
        return None;
    }
    let mut rise = Rise::default();
    spectra.iter().for_each(|own| rise.add(own));
    let weight: f64 = spectra.iter().map(|own| own.samples as f64).sum();
    let mean = |of: &dyn Fn(&Spectrum) -> f64| {
        let sum: f64 = spectra.iter().map(|own| own.samples as f64 * of(own)).sum();
        sum / weight
    };
    // Mean of estimates that are as good as their windows are long.
    let error_n2 = |lowest: f64| {
        let squares = spectra
            .iter()
            .map(|own| own.samples.pow(2) as f64 * own.above(lowest).1);
        squares.sum::<f64>().sqrt() / weight
    };
    let (seen, high) = (
        mean(&|own| own.above(0.0).0),
        mean(&|own| own.above(HIGH).0),
    );
    let below = mean(&|own| rise.below(own.samples, log.len()));
    // Fast noise is the same in motion, of which there is more; what motion has besides is no noise.
    let whole = spectrum::whole(&log.force_n, &log.in_gap, WINDOW, HIGH);
    let other = whole.filter(|own| *own < high + CERTAIN * error_n2(HIGH));
    Some(Rest {
        noise_n2: (seen + below + other.map_or(0.0, |own| own - high)).max(0.0),
        lines_n2: mean(&|own| own.lines_n2),
        // What is below is a guess, good to half of it.
        error_n2: error_n2(0.0).hypot(0.5 * below),
    })
}

/// What the motion leaves behind has gone after a tenth of a rest.
fn settled(rest: &Range<usize>) -> Range<usize> {
    rest.start + rest.len() / 10..rest.end
}

/// Integrated autocorrelation of the longest rest (samples).
fn resting_correlation(log: &UniformLog, rests: &[Range<usize>]) -> f64 {
    let longest = rests.iter().max_by_key(|rest| rest.len());
    longest.map_or(1.0, |rest| {
        correlation(&detrended(&log.force_n[settled(rest)]))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use std::f64::consts::TAU;

    const SEED_NOISE: u64 = 23;
    const SIGMA_N: f64 = 4e-3;

    fn normals(count: usize, stream: u64) -> Vec<f64> {
        let mut rng = rand_pcg::Pcg64::seed_from_u64(SEED_NOISE + stream);
        (0..count)
            .map(|_| StandardNormal.sample(&mut rng))
            .collect()
    }

    /// First-order noise of unit variance, corner in Hz at 1 kHz.
    fn slow(corner_hz: f64, count: usize, stream: u64) -> Vec<f64> {
        let keep = (-TAU * corner_hz * 1e-3).exp();
        let mut state = 0.0;
        let each = normals(count, stream).into_iter();
        each.map(|own| {
            state = keep * state + (1.0 - keep * keep).sqrt() * own;
            state
        })
        .collect()
    }

    /// Six strokes at 1 kHz of 1 mm into 2 kN/m, half a second of rest before each and 1 s of hold in
    /// it, with a noise (N) and what else there is at a time (s) and a speed (mm a sample).
    fn log(noise_n: &[f64], else_n: impl Fn(f64, f64) -> f64, code_n: f64) -> UniformLog {
        let place = |at: usize| match at % 2500 {
            own @ 500..1000 => -(TAU * (own - 500) as f64 / 1000.0).cos(),
            1000..2000 => 1.0,
            own @ 2000.. => (TAU * (own - 2000) as f64 / 1000.0).cos(),
            _ => -1.0,
        };
        let count = noise_n.len();
        let x: Vec<f64> = (0..count).map(place).collect();
        let force = |at: usize| {
            let more = else_n(1e-3 * at as f64, x[at] - x[at.saturating_sub(1)]);
            let own = 2.0 * x[at].max(0.0) + noise_n[at] + more;
            (own / code_n).round() * code_n
        };
        UniformLog {
            rate_hz: 1000.0,
            time_s: (0..count).map(|at| 1e-3 * at as f64).collect(),
            force_n: (0..count).map(force).collect(),
            position_m: x.iter().map(|x| (1e3 * x).round() * 1e-6).collect(),
            in_gap: vec![false; count],
            ..UniformLog::default()
        }
    }

    const SAMPLES: usize = 15_000;

    fn white() -> Vec<f64> {
        let each = normals(SAMPLES, 0).into_iter();
        each.map(|own| SIGMA_N * own).collect()
    }

    fn assert_near(floor: &Floor, sigma_n: f64, most: f64) {
        let ratio = floor.used_n / sigma_n;
        assert!((ratio - 1.0).abs() < most, "{ratio}: {floor:?}");
    }

    #[test]
    fn a_noise_below_the_converters_step_is_no_spike() {
        // GIVEN coloured noise of 0.6 codes: six in ten samples at rest are the same one
        let noise: Vec<f64> = slow(90.0, SAMPLES, 0).iter().map(|n| SIGMA_N * n).collect();
        let code_n = SIGMA_N / 0.6;
        let floor = Floor::of(&log(&noise, |_, _| 0.0, code_n));
        // THEN the floor is what noise and codes make together: not that of second differences, nor what
        // four medians of the sizes leave, 0.5 of it.
        let sigma_n = signal::rms(noise).hypot(code_n / 12.0_f64.sqrt());
        assert!(
            floor.coloured && floor.high_pass_n < 0.8 * sigma_n,
            "{floor:?}"
        );
        assert_near(&floor, sigma_n, 0.05);
    }

    #[test]
    fn a_hump_is_known_from_the_whole_log_to_three_percent() {
        // GIVEN half of the power within 30 Hz of 120 Hz
        let (a, b) = (slow(30.0, SAMPLES, 1), slow(30.0, SAMPLES, 2));
        let noise: Vec<f64> = (0..SAMPLES)
            .map(|at| {
                let (sin, cos) = (TAU * 0.12 * at as f64).sin_cos();
                (0.5_f64.sqrt() * (a[at] * cos + b[at] * sin)) * SIGMA_N
            })
            .zip(white())
            .map(|(hump, white)| hump + 0.5_f64.sqrt() * white)
            .collect();
        let floor = Floor::of(&log(&noise, |_, _| 0.0, 1e-5));
        assert!(floor.coloured && floor.high_pass_n < 0.8 * SIGMA_N);
        assert_near(&floor, signal::rms(noise), 0.03);
        assert!((0.01..0.06).contains(&floor.uncertainty), "{floor:?}");
    }

    #[test]
    fn a_disturbance_is_no_noise_and_a_wander_of_its_size_is_none() {
        // GIVEN five times the noise at 2.7 Hz: one cycle and a half in a rest, where no bin shows a line
        let line = |t: f64, _: f64| 7.0 * SIGMA_N * (TAU * 2.7 * t + 1.0).sin();
        assert_near(&Floor::of(&log(&white(), line, 1e-5)), SIGMA_N, 0.03);
        // AND a noise of as much power below 6 Hz
        let wander: Vec<f64> = slow(6.0, SAMPLES, 3)
            .iter()
            .map(|own| 5.0 * SIGMA_N * own)
            .collect();
        let floor = Floor::of(&log(&wander, |_, _| 0.0, 1e-5));
        // THEN the one is taken out and the other is the floor, and known to be a rough one.
        assert_near(&floor, signal::rms(wander), 0.35);
        assert!(floor.uncertainty > 0.05, "{floor:?}");
    }

    #[test]
    fn what_repeats_with_the_motion_hides_no_disturbance() {
        let both = |t: f64, v: f64| {
            let friction = if v == 0.0 {
                0.0
            } else {
                60.0 * SIGMA_N * v.signum()
            };
            friction + 7.0 * SIGMA_N * (TAU * 2.7 * t + 1.0).sin()
        };
        assert_near(&Floor::of(&log(&white(), both, 1e-5)), SIGMA_N, 0.05);
    }

    #[test]
    fn spikes_that_last_are_no_noise() {
        // GIVEN 20 ms at 40 standard deviations every 90 ms, a fifth of every rest
        let spikes = |t: f64, _: f64| {
            let lasts = t.rem_euclid(0.09) < 0.02;
            if lasts { 40.0 * SIGMA_N } else { 0.0 }
        };
        // THEN the floor is that of the rest of the time, to a fifth (it was 17 times that).
        assert_near(&Floor::of(&log(&white(), spikes, 1e-5)), SIGMA_N, 0.2);
    }

    #[test]
    fn white_noise_is_white() {
        let floor = Floor::of(&log(&white(), |_, _| 0.0, 1e-5));
        assert!(!floor.coloured && floor.uncertainty == 0.0, "{floor:?}");
        assert_near(&floor, SIGMA_N, 0.02);
    }
}
