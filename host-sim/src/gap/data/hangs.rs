//! Where a channel hangs: it reads the same for longer than its noise repeats a value, or than the probe stands still.
//!
//! A load cell's converter that hung for 150 ms in free air was the noise floor, 0 N, and a friction was "not named" at
//! 10¹⁴ times it; in a press it left 36 times the noise, which nothing explains. The board's own code recognises it, and
//! what it marks counts as not measured.

use std::borrow::Cow;

use crate::log::{Taken, UniformLog};
use crate::number::quantity;
use crate::replay::hanging;

/// If more than this share of a log hangs, it is something else: a logger that writes each reading several times.
const MOST: f64 = 0.6;

/// The logs without the readings of channels that hang, and what was left out.
pub(crate) fn left_out(logs: &[UniformLog]) -> (Cow<'_, [UniformLog]>, Option<String>) {
    let marked: Vec<Vec<[bool; 2]>> = logs.iter().map(marks).collect();
    let of_log = |(log, hangs): (&UniformLog, &Vec<[bool; 2]>)| {
        hangs.iter().filter(|own| own.contains(&true)).count() as f64 * log.period_s()
    };
    let hung_s: f64 = logs.iter().zip(&marked).map(of_log).sum();
    if hung_s == 0.0 {
        return (Cow::Borrowed(logs), None);
    }
    let each = logs.iter().zip(&marked);
    let without = each.map(|(log, hangs)| without(log, hangs)).collect();
    let note = format!(
        "a channel hangs, it does not change at all, for {} together: left out",
        quantity(hung_s, 2, "s")
    );
    (Cow::Owned(without), Some(note))
}

/// Whether force and position hang at each sample.
fn marks(log: &UniformLog) -> Vec<[bool; 2]> {
    let hangs = hanging(log);
    let count = hangs.iter().filter(|own| own.contains(&true)).count();
    match count as f64 > MOST * log.len() as f64 {
        true => vec![[false; 2]; log.len()],
        false => hangs,
    }
}

/// The log without some of its samples.
pub(in crate::gap) fn without(log: &UniformLog, hangs: &[[bool; 2]]) -> UniformLog {
    let mut log = log.clone();
    let gaps = log.in_gap.iter_mut().zip(hangs);
    gaps.for_each(|(gap, hang)| *gap |= hang.contains(&true));
    bridge(&mut log.position_m, hangs);
    if let Some(taken) = &mut log.taken {
        let start_s = log.time_s.first().copied().unwrap_or(0.0);
        let slot = |time_s: f64| ((time_s - start_s) * log.rate_hz).round().max(0.0) as usize;
        let is_kept = |time_s: &f64| {
            let hang = hangs.get(slot(*time_s));
            !hang.is_some_and(|hang| hang.contains(&true))
        };
        let kept: Vec<bool> = taken.time_s.iter().map(is_kept).collect();
        let channel = |channel: &[f64]| {
            let each = channel.iter().zip(&kept).filter(|(_, kept)| **kept);
            each.map(|(own, _)| *own).collect()
        };
        *taken = Taken {
            time_s: channel(&taken.time_s),
            position_m: channel(&taken.position_m),
            force_n: channel(&taken.force_n),
        };
    }
    log
}

/// Puts a straight line across where the position hangs: the leap at the end of it would be a speed of 1 m/s.
fn bridge(position_m: &mut [f64], hangs: &[[bool; 2]]) {
    let mut at = 0;
    for run in hangs.chunk_by(|a, b| a[1] == b[1]) {
        let here = at..at + run.len();
        at = here.end;
        if !run[0][1] || here.start == 0 || here.end == position_m.len() {
            continue;
        }
        let (from_m, to_m) = (position_m[here.start - 1], position_m[here.end]);
        let step_m = (to_m - from_m) / (here.len() + 1) as f64;
        for (count, own) in (1..).zip(&mut position_m[here]) {
            *own = from_m + step_m * f64::from(count);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::Log;

    /// Presses at 1 kHz whose force has a noise and hangs in these samples; every other stamp late by `off_s`.
    fn log(off_s: f64, hangs: std::ops::Range<usize>) -> UniformLog {
        let time = |at: usize| 1e-3 * at as f64 + if at % 2 == 1 { off_s } else { 0.0 };
        let mut state = 11_u64;
        let mut noise_n = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            0.02 * ((state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5)
        };
        let position = |at: usize| 1e-3 * (6.0 * time(at)).sin();
        let mut force_n: Vec<f64> = (0..3000)
            .map(|at| 2e3 * position(at).max(0.0) + noise_n())
            .collect();
        let held_n = force_n[hangs.start];
        force_n[hangs].fill(held_n);
        let time_s = (0..3000).map(time).collect();
        let position_m = (0..3000).map(position).collect();
        let log = Log::from_channels(time_s, position_m, force_n);
        log.uniform().unwrap()
    }

    #[test]
    fn a_force_that_hangs_is_left_out_whether_the_probe_touches_or_not() {
        // 600 to 750 is in free air, 1250 to 1400 in a press.
        for hangs in [600..750, 1250..1400] {
            let logs = [log(0.0, hangs.clone())];
            let (without, note) = left_out(&logs);
            let note = note.unwrap_or_default();
            assert!(note.contains("for 150"), "{hangs:?}: {note}");
            let gap = |at: &usize| without[0].in_gap[*at];
            assert!((0..3000).filter(gap).eq(hangs));
        }
    }

    #[test]
    fn a_position_that_hangs_leaves_no_leap() {
        let mut log = log(0.0, 0..1);
        let held_m = log.position_m[1300];
        log.position_m[1300..1400].fill(held_m);
        let (without, note) = left_out(std::slice::from_ref(&log));
        assert!(note.is_some());
        // 6 mm/s at most are 6 µm from sample to sample.
        let steps = without[0]
            .position_m
            .windows(2)
            .map(|x| (x[1] - x[0]).abs());
        assert!(steps.fold(0.0, f64::max) < 7e-6);
    }

    #[test]
    fn of_an_uneven_log_the_samples_that_were_taken_go() {
        let logs = [log(4e-4, 1250..1400)];
        let (without, note) = left_out(&logs);
        assert!(note.is_some());
        let taken = without[0].taken.as_ref().unwrap();
        let within = |time_s: &&f64| (1.252..1.398).contains(*time_s);
        assert_eq!(taken.time_s.iter().filter(within).count(), 0);
        assert!(taken.time_s.len() >= 2848 && taken.force_n.len() == taken.time_s.len());
    }

    #[test]
    fn a_log_whose_every_reading_is_written_often_is_taken_as_it_is() {
        let mut held = log(0.0, 0..1);
        for readings in held.force_n.chunks_mut(10) {
            let first_n = readings[0];
            readings.fill(first_n);
        }
        assert_eq!(left_out(&[log(0.0, 0..1)]).1, None);
        assert_eq!(left_out(&[held]).1, None);
    }
}
