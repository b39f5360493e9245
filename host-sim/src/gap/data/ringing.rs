//! Where a load cell rings after a jump of the force.
//!
//! A cell is a mass on a spring: it answers a step with an oscillation of hundreds of hertz that dies out in tens of
//! milliseconds. After a touch of a damped material at 0.1 m/s one rang by 0.3 N, 60 times its noise, for 30 ms, and
//! the log seemed to hold something that no catalogue explains. What rings is the cell's and not the contact's: those
//! samples say nothing. It is recognised without a model, as an oscillation that begins out of quiet and dies out.

use std::ops::Range;

use rayon::prelude::*;

use crate::gap::data::fit_data::FitData;
use crate::number::quantity;
use crate::stats::robust_deviation;

/// Lags (s) of the second differences: one of them is near half a period from 200 Hz to 900 Hz.
const LAGS_S: [f64; 2] = [0.8e-3, 1.6e-3];
/// A log with longer periods (s) cannot show it: the torque of a servo at 190 Hz seemed to ring for half a second.
const LONGEST_PERIOD_S: f64 = 2.1e-3;
/// Second differences stand out with this many times their standard deviation.
const STANDS_OUT: f64 = 5.0;
/// Ringing begins with this many of them: less dies out before it can be told from noise.
const BEGINS: f64 = 15.0;
/// It is quiet for so long (s) before and after: two periods of 250 Hz.
const QUIET_S: f64 = 8e-3;
/// It dies out within this time (s): 3 time constants at 250 Hz and a damping of 0.02.
const LONGEST_S: f64 = 0.1;
/// It turns at least so often: a step turns once, a spike twice, two spikes four times.
const FEWEST_TURNS: usize = 5;
/// Its first half holds this share of its squares.
const EARLY: f64 = 0.8;
/// At most this share of its samples is missing: between those there is nothing to be seen.
const MOST_MISSING: f64 = 0.1;
/// If more than this share of a log seems to ring, it is something else.
const MOST: f64 = 0.1;

/// Takes the samples at which a load cell rings out of the count, and says so.
pub(crate) fn left_out(logs: &mut [FitData]) -> Option<String> {
    let left_s: f64 = logs.par_iter_mut().map(leave_out).sum();
    (left_s > 0.0).then(|| {
        format!(
            "the force sensor rings after jumps of the force: {} in all are left out",
            quantity(left_s, 2, "s")
        )
    })
}

/// Takes the samples at which the load cell rings out of the count, and returns how long (s) that is.
fn leave_out(log: &mut FitData) -> f64 {
    let rings = ringing(log);
    let samples: usize = rings.iter().map(Range::len).sum();
    if samples as f64 > MOST * log.len() as f64 {
        return 0.0;
    }
    for rings in rings {
        log.count[rings].fill(0.0);
    }
    samples as f64 * log.period_s
}

/// The stretches in which the force rings.
fn ringing(log: &FitData) -> Vec<Range<usize>> {
    if log.period_s > LONGEST_PERIOD_S {
        return Vec::new();
    }
    let in_samples = |time_s: f64| (time_s / log.period_s).round().max(1.0) as usize;
    let lags = LAGS_S.map(in_samples);
    let differences = lags.map(|lag| standardized(&log.force_n, lag));
    let [short, long] = &differences;
    let out: Vec<f64> = short
        .iter()
        .zip(long)
        .map(|(a, b)| a.abs().max(b.abs()))
        .collect();
    let quiet = in_samples(QUIET_S);
    let longest = in_samples(LONGEST_S);
    let events = events(&out, quiet);
    events
        .into_iter()
        .filter(|event| event.len() <= longest && out[event.clone()].iter().any(|o| *o > BEGINS))
        .filter(|event| {
            let missing = log.count[event.clone()]
                .iter()
                .filter(|count| **count == 0.0);
            missing.count() as f64 <= MOST_MISSING * event.len() as f64
        })
        .filter(|event| differences.iter().any(|own| dies_out(&own[event.clone()])))
        // What no longer stands out of noise still rings.
        .map(|event| event.start..(event.end + event.len() / 2).min(log.len()))
        .collect()
}

/// Second differences over a lag, in units of their usual size; 0 where they have none.
fn standardized(force_n: &[f64], lag: usize) -> Vec<f64> {
    let mut differences = vec![0.0; force_n.len()];
    for at in lag..force_n.len().saturating_sub(lag) {
        differences[at] = force_n[at + lag] - 2.0 * force_n[at] + force_n[at - lag];
    }
    let usual_n = robust_deviation(differences.iter().copied());
    if usual_n > 0.0 {
        differences.iter_mut().for_each(|own| *own /= usual_n);
    } else {
        differences.fill(0.0);
    }
    differences
}

/// The stretches that stand out, each with `quiet` samples before and after it that do not.
fn events(out: &[f64], quiet: usize) -> Vec<Range<usize>> {
    let mut events: Vec<Range<usize>> = Vec::new();
    for at in (0..out.len()).filter(|at| out[*at] > STANDS_OUT) {
        match events.last_mut() {
            Some(last) if at < last.end + quiet => last.end = at + 1,
            _ => events.push(at..at + 1),
        }
    }
    events
}

/// Whether standardized differences turn often, and most at the beginning.
fn dies_out(differences: &[f64]) -> bool {
    let clear = differences.iter().filter(|own| own.abs() > STANDS_OUT);
    let signs: Vec<bool> = clear.map(|own| *own > 0.0).collect();
    let turns = signs.windows(2).filter(|pair| pair[0] != pair[1]).count();
    let squares = |part: &[f64]| part.iter().map(|own| own * own).sum::<f64>();
    let early = squares(&differences[..differences.len() / 2]);
    turns >= FEWEST_TURNS && early >= EARLY * squares(differences)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::Log;
    use rand::SeedableRng;
    use rand_distr::{Distribution, Normal};
    use std::f64::consts::TAU;

    const SEED_RINGING: u64 = 31;

    /// 4 s at a rate (Hz) with a noise of 3 mN and what else there is at a time (s).
    fn log(rate_hz: f64, force_n: impl Fn(f64) -> f64) -> FitData {
        let mut rng = rand_pcg::Pcg64::seed_from_u64(SEED_RINGING);
        let normal = Normal::new(0.0, 3e-3).unwrap();
        let time: Vec<f64> = (0..(4.0 * rate_hz) as usize)
            .map(|at| at as f64 / rate_hz)
            .collect();
        let force = time.iter().map(|t| force_n(*t) + normal.sample(&mut rng));
        let force = force.collect();
        let position = time.iter().map(|t| 1e-3 * t.sin()).collect();
        FitData::of(&Log::from_channels(time, position, force).uniform().unwrap())
    }

    /// A step of 1.7 N at 1 s, and behind a cell of 310 Hz, damped by 3 %, what it rings with an amplitude (N).
    fn touch(t: f64, rings_n: f64) -> f64 {
        let since = t - 1.0;
        if since < 0.0 {
            return 0.0;
        }
        let rings = (-0.03 * TAU * 310.0 * since).exp() * (TAU * 310.0 * since).cos();
        1.7 + 50.0 * since - rings_n * rings
    }

    #[test]
    fn a_touch_that_rings_is_left_out_and_a_touch_is_not() {
        for rate_hz in [1000.0, 5000.0] {
            let mut rings = log(rate_hz, |t| touch(t, 0.3));
            let left_s = leave_out(&mut rings);
            // THEN it is left out until it is below the noise: 0.3 N in 4.6 of 17 ms.
            assert!((0.03..0.15).contains(&left_s), "{left_s} s at {rate_hz} Hz");
            let last = rings.count.iter().rposition(|count| *count == 0.0).unwrap();
            assert!((1.04..1.15).contains(&(last as f64 / rate_hz)), "{last}");
            assert_eq!(leave_out(&mut log(rate_hz, |t| touch(t, 0.0))), 0.0);
        }
    }

    #[test]
    fn what_does_not_die_out_is_no_ringing() {
        let from_1s = |t: f64, force: f64| if t < 1.0 { 0.0 } else { force };
        // A wave that sets in, and two spikes.
        let wave = leave_out(&mut log(1000.0, |t| {
            from_1s(t, 0.3 * (TAU * 130.0 * t).sin())
        }));
        let spikes = |t: f64| f64::from([1.0, 1.004].iter().any(|at| (t - at).abs() < 4e-4));
        assert_eq!((wave, leave_out(&mut log(1000.0, spikes))), (0.0, 0.0));
    }
}
