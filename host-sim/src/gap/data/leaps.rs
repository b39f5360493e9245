//! Where the position leaps as no probe moves.
//!
//! A probe does not get from one place to another between two samples while its force stands still, nor many times as
//! fast as it moves elsewhere: segments were joined, or an encoder lost counts. A cantilever's record leaps by 117 nm
//! where its hold ends; 40 samples there, up to 80 standard deviations off, made most of what remained, and whether a
//! relaxation was named of which the hold shows 15 s hung on them.

use crate::gap::data::fit_data::FitData;
use crate::log::UniformLog;
use crate::lsq::dense::{cholesky, solve};
use crate::number::{counted, quantity};
use crate::replay::position_jumps;
use crate::signal;
use crate::stats::{highest, median};

/// The force stands still if it changes by fewer of its standard deviations.
const STANDS_STILL: f64 = 6.0;
/// Nothing moves as many times as fast as ever else in one sample, whatever the force does: 7 times under the
/// cantilever, where a stop that its motor makes takes three samples or is as fast as others.
const AS_NEVER_ELSE: f64 = 5.0;
/// So many samples before and after are compared.
const AROUND: usize = 4;
/// The samples whose smoothed position may have a share of the leap: its window is narrow there.
const SMOOTHED: usize = 3;
/// What the fast modes of a material need to forget it (s): 3 time constants at 150/s.
const FORGOTTEN_S: f64 = 0.02;
/// If more than this share of a log leaps, it is something else.
const MOST: f64 = 0.02;

/// Takes the samples around each leap out of the count, and says so.
pub(crate) fn left_out<'a>(
    data: &mut [FitData],
    logs: impl Iterator<Item = &'a UniformLog>,
) -> Option<String> {
    let leaps_m: Vec<f64> = data
        .iter_mut()
        .zip(logs)
        .flat_map(|(data, log)| leave_out(data, log))
        .collect();
    (!leaps_m.is_empty()).then(|| {
        format!(
            "the position leaps by up to {} between two samples, as no probe moves: {} left out",
            quantity(highest(leaps_m.iter().copied()), 3, "m"),
            counted(leaps_m.len(), "place")
        )
    })
}

/// Takes the samples around each leap out of the count, and returns how far (m) the position leaps.
fn leave_out(data: &mut FitData, log: &UniformLog) -> Vec<f64> {
    let leaps = leaps(log);
    let before_s = SMOOTHED as f64 * log.period_s();
    let after_s = before_s + FORGOTTEN_S;
    if leaps.len() as f64 * (before_s + after_s) > MOST * data.duration_s() {
        return Vec::new();
    }
    for (at, _) in &leaps {
        let time_s = log.time_s[*at];
        let first = data.time_s.partition_point(|own| *own < time_s - before_s);
        let end = data.time_s.partition_point(|own| *own <= time_s + after_s);
        data.count[first..end].fill(0.0);
    }
    leaps.into_iter().map(|(_, leap_m)| leap_m.abs()).collect()
}

/// The logs without their leaps, if there are any: as if the probe were where its encoder said before, and the encoder
/// had lost counts.
pub(crate) fn closed(logs: &[UniformLog]) -> Option<Vec<UniformLog>> {
    let found: Vec<Vec<(usize, f64)>> = logs.iter().map(leaps).collect();
    if found.iter().all(Vec::is_empty) {
        return None;
    }
    let mut closed = logs.to_vec();
    for (log, leaps) in closed.iter_mut().zip(&found) {
        for (at, leap_m) in leaps {
            close(log, *at, *leap_m);
        }
    }
    Some(closed)
}

fn close(log: &mut UniformLog, at: usize, leap_m: f64) {
    let from_s = log.time_s[at] - 0.5 * log.period_s();
    log.position_m[at..].iter_mut().for_each(|x| *x -= leap_m);
    if let Some(taken) = &mut log.taken {
        let at = taken.time_s.partition_point(|stamp| *stamp < from_s);
        taken.position_m[at..].iter_mut().for_each(|x| *x -= leap_m);
    }
}

/// The samples at which the position leaps, and how far (m): beside the motion before and after.
fn leaps(log: &UniformLog) -> Vec<(usize, f64)> {
    let last = log.len().saturating_sub(AROUND);
    let jumps = position_jumps(log).filter(|at| (AROUND..last).contains(at));
    let jumps: Vec<usize> = jumps.collect();
    if jumps.is_empty() {
        return Vec::new();
    }
    let still_n = STANDS_STILL * signal::loud_noise(&log.force_n);
    let step_m = |at: usize| (log.position_m[at] - log.position_m[at - 1]).abs();
    let others = (1..log.len()).filter(|at| jumps.binary_search(at).is_err());
    let fast_m = AS_NEVER_ELSE * highest(others.map(step_m));
    let level_n = |from: usize| median(log.force_n[from..from + AROUND].iter().copied());
    let is_leap =
        |at: &usize| step_m(*at) > fast_m || (level_n(*at) - level_n(at - AROUND)).abs() <= still_n;
    let leaps = jumps.iter().filter(|at| is_leap(at));
    let count_m = signal::step(&log.position_m);
    leaps
        .map(|at| (*at, leap_m(&log.position_m, *at, count_m)))
        .collect()
}

/// How far (m) a position leaps at a sample, beside a parabola through `SIDE` samples on either side: whole counts of an
/// encoder that has any. A count of 1 µm too much was 11 mN on a plastic, and a relaxation at its slowest.
fn leap_m(position_m: &[f64], at: usize, count_m: Option<f64>) -> f64 {
    const SIDE: usize = 8;
    let way_m = position_m[at] - position_m[at - 1];
    let (from, to) = (at.saturating_sub(SIDE), (at + SIDE).min(position_m.len()));
    let (mut normal, mut right) = ([0.0; 16], [0.0; 4]);
    for place in from..to {
        let u = (place as f64 - at as f64 + 0.5) / SIDE as f64;
        let row = [1.0, u, u * u, f64::from(u8::from(place >= at))];
        for i in 0..4 {
            right[i] += row[i] * (position_m[place] - position_m[at]);
            (0..4).for_each(|j| normal[4 * i + j] += row[i] * row[j]);
        }
    }
    let leap_m = cholesky(&normal, 4).map_or(way_m, |factor| solve(&factor, 4, &right)[3]);
    match count_m {
        Some(count_m) => (leap_m / count_m).round() * count_m,
        None => leap_m,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::Log;

    /// 4 s at 1 kHz of strokes of 1 mm, 6 µm a sample, into 2 N/mm, and what a time (s) adds to position (m) and
    /// force (N).
    fn log(adds: impl Fn(f64) -> (f64, f64)) -> UniformLog {
        let time: Vec<f64> = (0..4000).map(|at| 1e-3 * f64::from(at)).collect();
        let way = |t: f64| 1e-3 * (6.0 * t).sin();
        // Seen by the converter, and coarse.
        let noise_n = |at: usize| 1e-3 * (((at * at) % 97) as f64 / 48.0 - 1.0);
        let position = time.iter().map(|t| way(*t) + adds(*t).0).collect();
        let each = time.iter().enumerate();
        let force = each.map(|(at, t)| 2e3 * way(*t).max(0.0) + noise_n(at) + adds(*t).1);
        let force = force.collect();
        Log::from_channels(time, position, force).uniform().unwrap()
    }

    /// How many samples are left out, and what is said.
    fn left(log: &UniformLog) -> (usize, Option<String>) {
        let mut data = [FitData::of(log)];
        let note = left_out(&mut data, [log].into_iter());
        let out = data[0].count.iter().filter(|count| **count == 0.0);
        (out.count(), note)
    }

    #[test]
    fn where_the_position_leaps_alone_is_left_out_and_said() {
        // GIVEN 0.2 mm that the position goes between two samples, and the force does not
        let (count, note) = left(&log(|t| (if t > 2.0 { 2e-4 } else { 0.0 }, 0.0)));
        // THEN what is smoothed with it is left out, and 20 ms after it.
        assert_eq!(count, 2 * SMOOTHED + 20 + 1);
        let note = note.unwrap();
        assert!(note.contains("leaps by up to 20"), "{note}");
    }

    #[test]
    fn where_the_force_goes_along_it_is_a_motion_unless_nothing_is_as_fast() {
        // GIVEN four times the longest step elsewhere, and 33 times
        let both = |leap_m: f64| {
            left(&log(move |t| {
                if t > 2.3 {
                    (leap_m, 2e3 * leap_m)
                } else {
                    (0.0, 0.0)
                }
            }))
            .0
        };
        assert_eq!((both(2.4e-5), both(2e-4)), (0, 27));
        assert_eq!(left(&log(|_| (0.0, 0.0))), (0, None));
    }

    #[test]
    fn what_leaps_all_the_time_is_something_else() {
        let stairs = |t: f64| (2e-4 * (10.0 * t).floor(), 0.0);
        assert_eq!(left(&log(stairs)), (0, None));
    }
}
