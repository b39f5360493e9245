//! Logs of any length in bounded memory and time.
//!
//! Of a log with more samples than the fits can use the stretch with the most travel is kept, as long as the search
//! still samples it 25 times a second, and averaged over blocks, down to 100 Hz at most. A log that is mostly rest (an
//! hour's hold after a ramp of seconds) is thinned instead, within its rests only: the step between samples grows as
//! 0.3 % of the time since the rest began, so that a relaxation over three decades of time keeps all of them and the
//! ramp keeps its samples.

use std::borrow::Cow;
use std::ops::Range;

use rayon::prelude::*;

use crate::gap::data::fit_data::{FitData, Spacing};
use crate::gap::data::rest_waves;
use crate::gap::thresholds::Rest;
use crate::log::{Compensated, UniformLog};
use crate::number::setting;
use crate::signal;
use crate::stats::range;

/// Most samples that are looked at one by one: two minutes at 1 kHz.
const MOST_SAMPLES: usize = 120_000;
/// Blocks are not averaged below this rate.
const SLOWEST_HZ: f64 = 100.0;
/// Longest stretch (s): the 5,000 samples of the search are then 40 ms apart. At 240 ms, as twenty minutes have them, a
/// relaxation of 2.4/s was no longer looked for, and an hour that lacked nothing remained unexplained.
const LONGEST_STRETCH_S: f64 = 200.0;
/// The first of a stretch (s) that begins in the middle of a log: what relaxes, softens or sets has come to where it is
/// before, and gets there within this time. A relaxation of 0.1/s is within 2 % then.
const LEAD_IN_S: f64 = 40.0;
/// The step between samples within a rest, as a share of the time since it began.
const STEP_GROWTH: f64 = 3e-3;
/// Whether a sample stands still is decided on so many samples on either side.
const NEAR_SAMPLES: usize = 25;

/// Returns the logs within the budget, and a note on each log that was not.
pub(crate) fn within(logs: &[UniformLog], decide: Rest) -> (Vec<Cow<'_, UniformLog>>, Vec<String>) {
    let each = logs.par_iter().map(|log| within_budget(log, decide));
    let (logs, notes): (Vec<_>, Vec<_>) = each.unzip();
    (logs, notes.into_iter().flatten().collect())
}

fn within_budget(log: &UniformLog, decide: Rest) -> (Cow<'_, UniformLog>, Option<String>) {
    if log.len() <= MOST_SAMPLES {
        return (Cow::Borrowed(log), None);
    }
    let slowest = ((log.rate_hz / SLOWEST_HZ).floor() as usize).max(1);
    let factor = |samples: usize| samples.div_ceil(MOST_SAMPLES).min(slowest);
    let stretch = (LONGEST_STRETCH_S * log.rate_hz).round() as usize;
    let whole = averaged(log, factor(log.len()));
    let mut note = format!("{} samples are more than a fit can use", log.len());
    // A log that is mostly rest stays whole here: `thin_rests` thins it.
    let shorter = if log.len() <= stretch || is_mostly_rest(&whole, decide) {
        whole
    } else {
        let from = start_of_most_travel(log, stretch);
        let cut = log.part(from..from + stretch);
        note.push_str(&format!(
            ": the stretch that moves most, from {} on for {}",
            setting(cut.time_s[0], "s"),
            setting(cut.period_s() * cut.len() as f64, "s"),
        ));
        if begins_later(&cut.time_s, log) {
            note.push_str(&format!(
                ", of which the first {} only bring the material to where it is",
                setting(LEAD_IN_S, "s")
            ));
        }
        averaged(&cut, factor(stretch))
    };
    let factor = (log.rate_hz / shorter.rate_hz).round();
    if factor > 1.0 {
        note.push_str(&format!(
            ": means of {factor} each, {} samples a second",
            setting(shorter.rate_hz, "")
        ));
    }
    let changed = shorter.len() < log.len();
    (Cow::Owned(shorter), Some(note).filter(|_| changed))
}

/// Takes the first of each log out of the count that begins later than the `whole` one.
pub(crate) fn leave_lead_in_out(logs: &mut [FitData], whole: &[UniformLog]) {
    for (log, whole) in logs.iter_mut().zip(whole) {
        if !begins_later(&log.time_s, whole) {
            continue;
        }
        let start_s = log.time_s[0];
        let lead_in = log
            .time_s
            .partition_point(|time_s| *time_s < start_s + LEAD_IN_S);
        log.count[..lead_in].fill(0.0);
    }
}

/// Whether a part begins so much later than the whole log that it needs a lead-in. Means of some samples begin half of
/// them later than what they are means of.
fn begins_later(times_s: &[f64], whole: &UniformLog) -> bool {
    match (times_s.first(), whole.time_s.first()) {
        (Some(part_s), Some(whole_s)) => part_s - whole_s >= LEAD_IN_S,
        _ => false,
    }
}

/// Averages a log over blocks of `factor` samples, and drops an incomplete block at its end.
fn averaged(log: &UniformLog, factor: usize) -> UniformLog {
    if factor == 1 {
        return log.clone();
    }
    // Times are averaged over the whole block even where half of it was not measured, so that the samples
    // stay equally spaced.
    let times = log.time_s.chunks_exact(factor);
    let gaps = log.in_gap.chunks_exact(factor);
    // Means of counts are finer than counts, and no better where the position stands or creeps.
    let position_m = signal::measured_without_toggling(&log.position_m, &log.in_gap);
    let position_step_m = log
        .position_step_m
        .or_else(|| signal::step(&log.position_m));
    UniformLog {
        position_step_m,
        rate_hz: log.rate_hz / factor as f64,
        time_s: times
            .map(|block| block.iter().sum::<f64>() / factor as f64)
            .collect(),
        position_m: block_means(&position_m, &log.in_gap, factor),
        force_n: block_means(&log.force_n, &log.in_gap, factor),
        in_gap: gaps.map(|gaps| gaps.iter().all(|gap| *gap)).collect(),
        path: log.path.clone(),
        kind: log.kind,
        notes: log.notes.clone(),
        compensated: Compensated {
            stepped_s: log.compensated.stepped_s.clone(),
            surface_steps: log.compensated.surface_steps.clone(),
            ..Compensated::default()
        },
        ..UniformLog::default()
    }
}

/// Means over the measured samples of each block, or over all of a block that has none.
fn block_means(channel: &[f64], in_gap: &[bool], factor: usize) -> Vec<f64> {
    let blocks = channel
        .chunks_exact(factor)
        .zip(in_gap.chunks_exact(factor));
    let mean = |(block, gaps): (&[f64], &[bool])| {
        let is_gap = gaps.iter().all(|gap| *gap);
        let kept = block.iter().zip(gaps).filter(|(_, gap)| is_gap || !**gap);
        let (sum, count) = kept.fold((0.0, 0.0), |(sum, count), (value, _)| {
            (sum + value, count + 1.0)
        });
        sum / count
    };
    blocks.map(mean).collect()
}

fn is_mostly_rest(log: &UniformLog, decide: Rest) -> bool {
    let still = standing_still(&log.position_m, signal::noise(&log.position_m), decide);
    still.iter().filter(|still| **still).count() as f64 > decide.mostly * log.len() as f64
}

/// For each sample, whether the position stands still there.
fn standing_still(position_m: &[f64], noise_m: f64, decide: Rest) -> Vec<bool> {
    let last = position_m.len().saturating_sub(1);
    let most_m = (decide.still_sigmas * noise_m).max(decide.still_share * range(position_m));
    let change = |at: usize| {
        position_m[(at + NEAR_SAMPLES).min(last)] - position_m[at.saturating_sub(NEAR_SAMPLES)]
    };
    (0..position_m.len())
        .map(|at| change(at).abs() <= most_m)
        .collect()
}

/// The sample at which the stretch of so many samples with the most travel begins.
fn start_of_most_travel(log: &UniformLog, samples: usize) -> usize {
    // Counts that toggle at rest travel nowhere.
    let position_m = signal::measured_without_toggling(&log.position_m, &log.in_gap);
    let steps = position_m.windows(2);
    let travel: Vec<f64> = std::iter::once(0.0)
        .chain(steps.map(|pair| (pair[1] - pair[0]).abs()))
        .scan(0.0, |sum, step| {
            *sum += step;
            Some(*sum)
        })
        .collect();
    let last = log.len() - samples;
    let travel_from = |from: &usize| travel[from + samples - 1] - travel[*from];
    (0..=last)
        .max_by(|a, b| travel_from(a).total_cmp(&travel_from(b)))
        .unwrap_or(0)
}

/// Thins the rests of logs that are mostly rest, if they have more than `most` samples, and says so.
pub(crate) fn thin_rests(logs: &mut [FitData], most: usize, decide: Rest) -> Option<String> {
    let before: usize = logs.iter().map(FitData::len).sum();
    let still: Vec<Vec<bool>> = logs
        .iter()
        .map(|log| standing_still(&log.position_m, log.position_noise_m, decide))
        .collect();
    let resting = still.iter().flatten().filter(|still| **still).count();
    if before <= most || (resting as f64) < decide.mostly * before as f64 {
        return None;
    }
    for (log, still) in logs.iter_mut().zip(&still) {
        let kept = kept_samples(log, still);
        let longest = longest_run(still);
        let longest_rest_s = log.period_s * longest.len() as f64;
        let spacing = Spacing::Thinned {
            longest_rest_s,
            longest_step_s: STEP_GROWTH * longest_rest_s,
        };
        *log = FitData {
            spacing,
            rest_waves_hz: rest_waves::of(log, longest),
            ..log.picked(kept.iter().copied())
        };
    }
    let after: usize = logs.iter().map(FitData::len).sum();
    Some(format!(
        "{} % of the log is rest: of {before} samples {after} are fitted, all that move and those of rests at \
         steps of 0.3 % of the time since they began",
        (100.0 * resting as f64 / before as f64).round()
    ))
}

/// The longest run of samples that stand still.
fn longest_run(still: &[bool]) -> Range<usize> {
    let mut longest = 0..0;
    let mut start = 0;
    for run in still.split(|still| !still) {
        if run.len() > longest.len() {
            longest = start..start + run.len();
        }
        start += run.len() + 1;
    }
    longest
}

/// The samples to keep: all that move, and ever fewer of a rest the longer it lasts.
fn kept_samples(log: &FitData, still: &[bool]) -> Vec<usize> {
    let mut kept = Vec::new();
    let (mut began, mut next) = (0, 0.0);
    for (at, still) in still.iter().enumerate() {
        if !still {
            kept.push(at);
            (began, next) = (at, at as f64);
        } else if at as f64 >= next && log.count[at] > 0.0 {
            kept.push(at);
            next = at as f64 + f64::max(1.0, STEP_GROWTH * (at - began) as f64);
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::Log;
    use crate::stats::{rms, rounding_step};

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
    fn an_hour_at_a_kilohertz_becomes_its_busiest_minutes_at_500_hz() {
        // GIVEN strokes of 1 mm, of 4 mm in the last half hour
        let hour = log(
            3_600_000,
            1000.0,
            |t| if t < 1800.0 { 1e-3 } else { 4e-3 } * (6.3 * t).sin(),
        );
        let logs = [hour];
        let (shorter, notes) = within(&logs, Rest::default());
        // THEN 100 000 means of two samples, of the last half hour, and the note says so.
        assert_eq!(shorter[0].len(), 100_000);
        assert!((shorter[0].rate_hz - 500.0).abs() < 1e-9);
        assert!(shorter[0].time_s[0] >= 1799.0, "{}", shorter[0].time_s[0]);
        let note = &notes[0];
        assert!(
            note.contains("3600000 samples") && note.contains("means of 2"),
            "{note}"
        );
        assert!(note.contains("moves most"), "{note}");
    }

    #[test]
    fn a_stretch_from_the_middle_has_a_lead_in() {
        // GIVEN 10 minutes at 500 Hz, of which all but the first 200 s, or those, move most
        for (late, counted_from_s) in [(true, LEAD_IN_S), (false, 0.0)] {
            let amplitude_m = |t: f64| if (t > 200.0) == late { 4e-3 } else { 1e-3 };
            let whole = [log(300_000, 500.0, |t| amplitude_m(t) * (6.3 * t).sin())];
            let (shorter, notes) = within(&whole, Rest::default());
            let mut data = [FitData::of(&shorter[0])];
            leave_lead_in_out(&mut data, &whole);
            // THEN what relaxes comes to where it is before the first sample that counts; at the start of the log it is.
            let first = data[0].count.iter().position(|count| *count > 0.0).unwrap();
            let after_s = data[0].time_s[first] - data[0].time_s[0];
            assert!((after_s - counted_from_s).abs() < 0.01, "{after_s}");
            assert_eq!(
                notes[0].contains("bring the material"),
                late,
                "{}",
                notes[0]
            );
        }
    }

    #[test]
    fn a_log_within_the_budget_is_not_touched() {
        let logs = [log(30_000, 1000.0, |t| 2e-3 * (6.3 * t).sin())];
        let (same, notes) = within(&logs, Rest::default());
        assert!(matches!(same[0], Cow::Borrowed(_)) && notes.is_empty());
        let mut data = [FitData::of(&same[0])];
        assert_eq!(thin_rests(&mut data, 5_000, Rest::default()), None);
        assert_eq!(data[0].spacing, Spacing::Even);
    }

    #[test]
    fn a_fast_log_keeps_its_count_and_its_speed() {
        // GIVEN 4 mm at 3 Hz and 20 kHz in counts of 1 µm, 10 s
        let turn = 18.85;
        let time: Vec<f64> = (0..200_000).map(|at| f64::from(at) * 5e-5).collect();
        let read = |t: &f64| (4e3 * (turn * t).sin()).round() * 1e-6;
        let position = time.iter().map(read).collect();
        let log = Log::from_channels(time.clone(), position, vec![0.0; time.len()]);
        let log = log.uniform().unwrap();
        let (logs, _) = within(std::slice::from_ref(&log), Rest::default());
        assert_eq!(logs[0].len(), 100_000);
        // THEN means of two are still in counts of 1 µm, not of half of that, and their speed is good to 0.1 %.
        let data = FitData::of(&logs[0]);
        let whole = rounding_step(data.position_noise_m);
        assert!((whole / 1e-6 - 1.0).abs() < 1e-6, "{whole:e}");
        let errors = (200..99_800).map(|at| {
            let true_mps = 4e-3 * turn * (turn * data.time_s[at]).cos();
            data.speed_mps[at] - true_mps
        });
        let error_mps = rms(errors);
        assert!(error_mps < 5e-5, "{error_mps:e}");
    }

    #[test]
    fn means_leave_out_what_was_not_measured() {
        let mut long = log(MOST_SAMPLES * 2, 1000.0, |t| t * 1e-3);
        long.in_gap[1] = true;
        long.force_n[1] = 1e6;
        long.in_gap[4] = true;
        long.in_gap[5] = true;
        let short = averaged(&long, 2);
        assert_eq!(short.force_n[0], long.force_n[0]);
        assert_eq!(short.in_gap[..4], [false, false, true, false]);
        assert!(short.force_n[2].is_finite());
        // The grid stays even.
        assert!((short.time_s[1] - short.time_s[0] - 2e-3).abs() < 1e-12);
    }

    #[test]
    fn an_hours_hold_after_a_ramp_keeps_the_ramp_and_every_decade() {
        // GIVEN 8 s of ramp, an hour of rest, 8 s back, at 50 Hz
        let long = log(180_800, 50.0, |t| 1e-4 * t.min(8.0).min(3616.0 - t));
        let logs = [long];
        let (within, _) = within(&logs, Rest::default());
        // (The rate is below 100 Hz already, and the log rests: it stays whole.)
        assert_eq!(within[0].len(), 180_800);
        let mut data = [FitData::of(&within[0])];
        let note = thin_rests(&mut data, 30_000, Rest::default()).unwrap();
        assert!(note.contains("% of the log is rest"), "{note}");
        let thinned = &data[0];
        let between = |from: f64, to: f64| {
            thinned
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
        let sum: f64 = (1..thinned.len()).map(|at| thinned.step_s(at)).sum();
        assert!((sum - (thinned.time_s[thinned.len() - 1] - thinned.time_s[0])).abs() < 1e-6);
        // No wave is looked for: it would be the course of the hold.
        assert_eq!(thinned.fastest_wave_hz(), None);
    }

    #[test]
    fn waves_go_on_through_short_rests_and_the_motion_still_repeats() {
        // GIVEN 17 strokes of 0.25 s to and fro, with a second of rest at either end, at 2 kHz
        let way = |t: f64| match t.rem_euclid(2.5) {
            into if into < 0.25 => 4e-3 * into,
            into if into < 1.25 => 1e-3,
            into if into < 1.5 => 4e-3 * (1.5 - into),
            _ => 0.0,
        };
        let mut data = [FitData::of(&log(88_000, 2000.0, way))];
        let before = crate::gap::data::repetition::of(&data[0]);
        thin_rests(&mut data, 30_000, Rest::default()).unwrap();
        assert!(data[0].len() < 60_000, "{}", data[0].len());
        // THEN steps of up to 3 ms show waves of up to 40 Hz,
        let fastest_hz = data[0].fastest_wave_hz().unwrap();
        assert!((35.0..50.0).contains(&fastest_hz), "{fastest_hz}");
        // and it is still known that lines at 0.4 Hz and its harmonics are the motion's.
        let after = crate::gap::data::repetition::of(&data[0]);
        for hz in [before.unwrap(), after.unwrap()] {
            assert!((hz - 0.4).abs() < 2e-3, "{hz}");
        }
    }
}
