//! Logs of any length in bounded memory and time.
//!
//! A log of more samples than the fits can use is averaged block by block, down to 100 Hz at most;
//! of what is still longer, the stretch that moves most is taken. And where a log is mostly rest (an
//! hour's hold after a ramp of seconds), its rests are thinned as they last: samples at steps of
//! 0.3 % of the time since the rest began, so that a relaxation over three decades of time keeps all of
//! them and the ramp keeps its samples.

use std::borrow::Cow;

use rayon::prelude::*;

use crate::gap::data::fit_data::Course;
use crate::log::UniformLog;
use crate::number::setting;
use crate::signal;

/// Most samples that are looked at one by one: two minutes at 1 kHz.
const MOST: usize = 120_000;
/// Blocks are not averaged below this rate.
const SLOWEST_HZ: f64 = 100.0;
/// A log is mostly rest if this share of it stands still.
const MOSTLY: f64 = 0.75;
/// Steps within a rest, as a share of the time since it began.
const GROWTH: f64 = 3e-3;
/// Standing still: within so many samples on either side the position changes by less than this many
/// standard deviations of its noise, or less than this share of the travel. A speed would not do: a
/// position that is held by a loop trembles.
const NEAR: usize = 25;
const STILL: f64 = 6.0;
const TREMBLE: f64 = 2e-3;

/// The logs within the budget, and a note on each that was not.
pub(in crate::gap) fn within(logs: &[UniformLog]) -> (Vec<Cow<'_, UniformLog>>, Vec<String>) {
    let each: Vec<(Cow<'_, UniformLog>, Option<String>)> = logs.par_iter().map(one).collect();
    let (logs, notes): (Vec<_>, Vec<_>) = each.into_iter().unzip();
    (logs, notes.into_iter().flatten().collect())
}

fn one(log: &UniformLog) -> (Cow<'_, UniformLog>, Option<String>) {
    if log.len() <= MOST {
        return (Cow::Borrowed(log), None);
    }
    let slowest = ((log.rate_hz / SLOWEST_HZ).floor() as usize).max(1);
    let factor = log.len().div_ceil(MOST).min(slowest);
    let mut shorter = averaged(log, factor);
    let mut note = format!("{} samples are more than a fit can use", log.len());
    if factor > 1 {
        note.push_str(&format!(
            ": means of {factor} each, {} samples a second",
            setting(shorter.rate_hz, "")
        ));
    }
    if shorter.len() > MOST && !rests(&shorter) {
        let from = busiest(&shorter);
        cut(&mut shorter, from);
        note.push_str(&format!(
            "; of those the stretch that moves most, from {} on for {}",
            setting(shorter.time_s[0], "s"),
            setting(shorter.period_s() * shorter.len() as f64, "s"),
        ));
    }
    // A log that is mostly rest, at its slowest rate: its rests are thinned later on.
    let changed = shorter.len() < log.len();
    (Cow::Owned(shorter), Some(note).filter(|_| changed))
}

/// Means over blocks; of a block with measured samples, over those. What is left at the end is
/// dropped.
fn averaged(log: &UniformLog, factor: usize) -> UniformLog {
    if factor == 1 {
        return log.clone();
    }
    let mean = |channel: &[f64]| -> Vec<f64> {
        let blocks = channel
            .chunks_exact(factor)
            .zip(log.in_gap.chunks_exact(factor));
        blocks
            .map(|(block, gaps)| {
                let whole = gaps.iter().all(|gap| *gap);
                let kept = block.iter().zip(gaps).filter(|(_, gap)| whole || !**gap);
                let (sum, count) = kept.fold((0.0, 0.0), |(sum, count), (value, _)| {
                    (sum + value, count + 1.0)
                });
                sum / count
            })
            .collect()
    };
    // Time is the block's own even where half of it was not measured: the grid stays even.
    let time = log
        .time_s
        .chunks_exact(factor)
        .map(|block| block.iter().sum::<f64>() / factor as f64);
    UniformLog {
        rate_hz: log.rate_hz / factor as f64,
        time_s: time.collect(),
        position_m: mean(&log.position_m),
        force_n: mean(&log.force_n),
        in_gap: log
            .in_gap
            .chunks_exact(factor)
            .map(|gaps| gaps.iter().all(|gap| *gap))
            .collect(),
        path: log.path.clone(),
        notes: log.notes.clone(),
        ..UniformLog::default()
    }
}

/// Whether a log mostly stands still.
fn rests(log: &UniformLog) -> bool {
    let still = still(&log.position_m, signal::noise(&log.position_m));
    still.iter().filter(|own| **own).count() as f64 > MOSTLY * log.len() as f64
}

/// Where a position stands still.
fn still(position_m: &[f64], noise_m: f64) -> Vec<bool> {
    let last = position_m.len().saturating_sub(1);
    let most_m = (STILL * noise_m).max(TREMBLE * signal::range(position_m));
    let moved = |at: usize| position_m[(at + NEAR).min(last)] - position_m[at.saturating_sub(NEAR)];
    (0..position_m.len())
        .map(|at| moved(at).abs() <= most_m)
        .collect()
}

/// Where the stretch of the most travel begins.
fn busiest(log: &UniformLog) -> usize {
    let travel: Vec<f64> = std::iter::once(0.0)
        .chain(log.position_m.windows(2).map(|own| (own[1] - own[0]).abs()))
        .scan(0.0, |sum, step| {
            *sum += step;
            Some(*sum)
        })
        .collect();
    let last = log.len() - MOST;
    let gained = |from: &usize| travel[from + MOST - 1] - travel[*from];
    (0..=last)
        .max_by(|a, b| gained(a).total_cmp(&gained(b)))
        .unwrap_or(0)
}

fn cut(log: &mut UniformLog, from: usize) {
    for channel in [&mut log.time_s, &mut log.position_m, &mut log.force_n] {
        *channel = channel[from..from + MOST].to_vec();
    }
    log.in_gap = log.in_gap[from..from + MOST].to_vec();
}

/// Thins the rests of courses that are mostly rest, if there are more samples than `most`.
pub(in crate::gap) fn shorten(courses: &mut [Course], most: usize) -> Option<String> {
    let before: usize = courses.iter().map(Course::len).sum();
    let still: Vec<Vec<bool>> = courses
        .iter()
        .map(|own| still(&own.position_m, own.position_noise_m))
        .collect();
    let resting = still.iter().flatten().filter(|own| **own).count();
    if before <= most || (resting as f64) < MOSTLY * before as f64 {
        return None;
    }
    for (course, still) in courses.iter_mut().zip(&still) {
        let places = places(course, still);
        *course = Course {
            even: false,
            ..course.picked(places.iter().copied())
        };
    }
    let after: usize = courses.iter().map(Course::len).sum();
    Some(format!(
        "{} % of the log is rest: of {before} samples {after} are fitted, all that move and those of rests at \
         steps of 0.3 % of the time since they began",
        (100.0 * resting as f64 / before as f64).round()
    ))
}

/// Samples to keep: those that move, and of a rest ever fewer.
fn places(course: &Course, still: &[bool]) -> Vec<usize> {
    let mut places = Vec::new();
    let (mut began, mut next) = (0, 0.0);
    for (at, still) in still.iter().enumerate() {
        if !still {
            places.push(at);
            (began, next) = (at, at as f64);
        } else if at as f64 >= next && course.count[at] > 0.0 {
            places.push(at);
            next = at as f64 + f64::max(1.0, GROWTH * (at - began) as f64);
        }
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    fn log(samples: usize, rate_hz: f64, position: impl Fn(f64) -> f64) -> UniformLog {
        let time_s: Vec<f64> = (0..samples).map(|at| at as f64 / rate_hz).collect();
        UniformLog {
            rate_hz,
            position_m: time_s
                .iter()
                .map(|t| (position(*t) / 1e-6).round() * 1e-6)
                .collect(),
            force_n: time_s
                .iter()
                .map(|t| 2000.0 * position(*t).max(0.0))
                .collect(),
            in_gap: vec![false; samples],
            time_s,
            ..UniformLog::default()
        }
    }

    #[test]
    fn an_hour_at_a_kilohertz_becomes_its_busiest_twenty_minutes_at_100_hz() {
        // GIVEN strokes of 1 mm, of 4 mm in the last half hour
        let hour = log(
            3_600_000,
            1000.0,
            |t| if t < 1800.0 { 1e-3 } else { 4e-3 } * (6.3 * t).sin(),
        );
        let logs = [hour];
        let (shorter, notes) = within(&logs);
        // THEN 120 000 means of ten samples, of the last half hour, and the note says so.
        assert_eq!(shorter[0].len(), MOST);
        assert!((shorter[0].rate_hz - 100.0).abs() < 1e-9);
        assert!(shorter[0].time_s[0] >= 1799.0, "{}", shorter[0].time_s[0]);
        let note = &notes[0];
        assert!(
            note.contains("3600000 samples") && note.contains("means of 10"),
            "{note}"
        );
        assert!(note.contains("moves most"), "{note}");
    }

    #[test]
    fn a_log_within_the_budget_is_not_touched() {
        let logs = [log(30_000, 1000.0, |t| 2e-3 * (6.3 * t).sin())];
        let (same, notes) = within(&logs);
        assert!(matches!(same[0], Cow::Borrowed(_)) && notes.is_empty());
        let mut courses = [Course::of(&same[0])];
        assert_eq!(shorten(&mut courses, 5_000), None);
        assert!(courses[0].even);
    }

    #[test]
    fn means_leave_out_what_was_not_measured() {
        let mut own = log(MOST * 2, 1000.0, |t| t * 1e-3);
        own.in_gap[1] = true;
        own.force_n[1] = 1e6;
        own.in_gap[4] = true;
        own.in_gap[5] = true;
        let short = averaged(&own, 2);
        assert_eq!(short.force_n[0], own.force_n[0]);
        assert_eq!(short.in_gap[..4], [false, false, true, false]);
        assert!(short.force_n[2].is_finite());
        // The grid stays even.
        assert!((short.time_s[1] - short.time_s[0] - 2e-3).abs() < 1e-12);
    }

    #[test]
    fn an_hours_hold_after_a_ramp_keeps_the_ramp_and_every_decade() {
        // GIVEN 8 s of ramp, an hour of rest, 8 s back, at 50 Hz
        let own = log(180_800, 50.0, |t| 1e-4 * t.min(8.0).min(3616.0 - t));
        let logs = [own];
        let (within, _) = within(&logs);
        // (The rate is below 100 Hz already, and the log rests: it stays whole.)
        assert_eq!(within[0].len(), 180_800);
        let mut courses = [Course::of(&within[0])];
        let note = shorten(&mut courses, 30_000).unwrap();
        assert!(note.contains("% of the log is rest"), "{note}");
        let course = &courses[0];
        let between = |from: f64, to: f64| {
            course
                .time_s
                .iter()
                .filter(|t| (from..to).contains(*t))
                .count()
        };
        // THEN 50 a second while it moves, 460 in every factor of 4 of the hold (ln 4/0.003), fewer
        // where 0.3 % is less than two samples,
        assert!(between(0.5, 7.5) >= 345 && between(3608.5, 3615.5) >= 345);
        for from in [8.0, 80.0, 800.0] {
            let count = between(8.0 + from, 8.0 + 4.0 * from);
            assert!((250..470).contains(&count), "{from}: {count}");
        }
        // and the steps between samples add up to the time.
        let sum: f64 = (1..course.len()).map(|at| course.step_s(at)).sum();
        assert!((sum - (course.time_s[course.len() - 1] - course.time_s[0])).abs() < 1e-6);
    }
}
