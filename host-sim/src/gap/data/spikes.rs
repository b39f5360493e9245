//! Single readings of the force that stand alone.
//!
//! An electrical spike is one sample: the readings before and after it go on as if it were not there. Seven of them,
//! eight to thirty times the noise in 15 s at 200 Hz, made 1.18 times the noise of what is left, and their fourth
//! moment made a slow noise at rest a disturbance: of 500 harder rigs with nothing hidden 11 were unexplained, nine of
//! them with spikes. What lasts longer than a sample is left to speak for itself, and so is a tap that one of ten
//! samples a second has seen: there the probe has moved, too.

use std::borrow::Cow;

use crate::log::UniformLog;
use crate::number::{counted, quantity};
use crate::signal;
use crate::stats::lowest;

/// A spike leaves the mean of its neighbours by this many standard deviations, which noise does once in 10⁹ samples.
const STANDS_OUT: f64 = 6.0;
/// What is left without it leaves the means by fewer.
const GOES_ON: f64 = 4.0;
/// So many differences on either side are looked at.
const AROUND: usize = 3;
/// If more than this share of a log seems to be spikes, they are something else.
const MOST: f64 = 0.005;

/// The logs with the mean of its neighbours for each reading of the force that stands alone, and what was done.
pub(crate) fn bridged(logs: &[UniformLog]) -> (Cow<'_, [UniformLog]>, Option<String>) {
    let found: Vec<Vec<usize>> = logs.iter().map(spikes).collect();
    let count: usize = found.iter().map(Vec::len).sum();
    if count == 0 {
        return (Cow::Borrowed(logs), None);
    }
    let each = logs.iter().zip(&found);
    let least_n = lowest(each.clone().flat_map(|(log, spikes)| {
        let force_n = raw_n(log);
        spikes.iter().map(|at| off(force_n, *at).abs())
    }));
    let without = each.map(|(log, spikes)| without(log, spikes)).collect();
    let note = format!(
        "{} of the force, single readings {} and more off their neighbours: bridged",
        counted(count, "spike"),
        quantity(least_n, 2, "N")
    );
    (Cow::Owned(without), Some(note))
}

/// The forces (N) as they were taken.
fn raw_n(log: &UniformLog) -> &[f64] {
    log.taken
        .as_ref()
        .map_or(&log.force_n, |taken| &taken.force_n)
}

/// The positions (m) as they were taken.
fn raw_m(log: &UniformLog) -> &[f64] {
    log.taken
        .as_ref()
        .map_or(&log.position_m, |taken| &taken.position_m)
}

/// How far a reading is from the mean of its neighbours.
fn off(channel: &[f64], at: usize) -> f64 {
    channel[at] - 0.5 * (channel[at - 1] + channel[at + 1])
}

/// Whether a reading leaves both its neighbours on one side, by half at least of how far it is from their mean: the
/// first one after a step, as where a probe snaps in, leaves only the one before.
fn is_peak(channel: &[f64], at: usize) -> bool {
    let sides = [at - 1, at + 1].map(|other| channel[at] - channel[other]);
    let half = 0.5 * off(channel, at);
    sides.iter().all(|side| side * half > half * half)
}

/// How far the position (m) is from the mean of its neighbours where the probe turns no more than it usually does.
fn usual_turn_m(position_m: &[f64]) -> f64 {
    let noise_m = 1.5_f64.sqrt() * signal::noise(position_m);
    // A second difference is twice that distance.
    (0.5 * signal::sharpest(position_m)).max(STANDS_OUT * noise_m)
}

/// The samples, of those that were taken, that are spikes.
fn spikes(log: &UniformLog) -> Vec<usize> {
    let force_n = raw_n(log);
    let is_measured = |at: usize| log.taken.is_some() || !log.in_gap[at];
    // White noise leaves the mean of two neighbours by √1.5 of its standard deviation.
    let usual_n = 1.5_f64.sqrt() * signal::loud_noise(force_n);
    let (position_m, turn_m) = (raw_m(log), usual_turn_m(raw_m(log)));
    let margin = AROUND + 1;
    let candidates = margin..force_n.len().saturating_sub(margin);
    let spikes: Vec<usize> = candidates
        .filter(|at| off(force_n, *at).abs() > STANDS_OUT * usual_n)
        .filter(|at| is_peak(force_n, *at))
        .filter(|at| off(position_m, *at).abs() <= turn_m)
        .filter(|at| (at - margin..=at + margin).all(is_measured))
        .filter(|at| stands_alone(&force_n[at - margin..=at + margin], GOES_ON * usual_n))
        .collect();
    match spikes.len() as f64 > MOST * force_n.len() as f64 {
        true => Vec::new(),
        false => spikes,
    }
}

/// Whether readings go on as if the one in their middle were not there.
fn stands_alone(around_n: &[f64], most_n: f64) -> bool {
    let middle = around_n.len() / 2;
    let mut bridged = around_n.to_vec();
    bridged[middle] -= off(around_n, middle);
    (1..bridged.len() - 1).all(|at| off(&bridged, at).abs() <= most_n)
}

/// The log with these samples bridged.
fn without(log: &UniformLog, spikes: &[usize]) -> UniformLog {
    let mut log = log.clone();
    let Some(taken) = &mut log.taken else {
        for at in spikes {
            log.force_n[*at] -= off(&log.force_n, *at);
        }
        return log;
    };
    for at in spikes {
        taken.force_n[*at] -= off(&taken.force_n, *at);
        // What was interpolated to an even grid between the neighbours of a spike had a share of it.
        let (from_s, to_s) = (taken.time_s[at - 1], taken.time_s[at + 1]);
        let (from_n, to_n) = (taken.force_n[at - 1], taken.force_n[at + 1]);
        let first = log.time_s.partition_point(|time_s| *time_s <= from_s);
        let end = log.time_s.partition_point(|time_s| *time_s < to_s);
        for (time_s, force_n) in log.time_s[first..end]
            .iter()
            .zip(&mut log.force_n[first..end])
        {
            *force_n = from_n + (to_n - from_n) * (time_s - from_s) / (to_s - from_s);
        }
    }
    log
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::Log;

    #[test]
    fn a_step_of_the_force_is_no_spike() {
        let peak = |around: [f64; 3]| is_peak(&around, 1);
        // A snap-in, a release after a pull that grows, and a reading that stands alone, on a slope as well.
        assert!(!peak([0.0, -0.4, -0.38]) && !peak([-0.3, -0.4, 0.0]));
        assert!(peak([0.0, 1.0, 0.1]) && peak([0.0, 1.0, 0.4]) && peak([0.3, -1.0, 0.2]));
        // Steps of 12 to 16 times what noise leaves its neighbours by were spikes, at their first reading.
        let steps = log(0.0, |at| if at % 200 >= 150 { 0.19 } else { 0.0 });
        assert_eq!(spikes(&steps), Vec::<usize>::new());
    }

    /// Two seconds of strokes at 500 Hz with 10 mN of noise, and what is added to the force at a sample; every third
    /// stamp is off by `off_s`.
    fn log(off_s: f64, adds_n: impl Fn(usize) -> f64) -> UniformLog {
        let time = |at: usize| at as f64 * 2e-3 + if at % 3 == 1 { off_s } else { 0.0 };
        let position = |t: f64| 1e-3 * (9.0 * t).sin();
        // A congruential generator: twelve of its numbers are nearly normal.
        let mut state = 17_u64;
        let mut noise_n = || {
            let mut next = || {
                state = state
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1);
                (state >> 11) as f64 / (1_u64 << 53) as f64
            };
            0.01 * ((0..12).map(|_| next()).sum::<f64>() - 6.0)
        };
        let force = |at: usize| 2e3 * position(time(at)).max(0.0) + noise_n() + adds_n(at);
        let force_n = (0..1000).map(force).collect();
        let time_s: Vec<f64> = (0..1000).map(time).collect();
        let position_m = time_s.iter().map(|t| position(*t)).collect();
        let log = Log::from_channels(time_s, position_m, force_n);
        log.uniform().unwrap()
    }

    #[test]
    fn a_reading_that_stands_alone_is_bridged_and_said() {
        for off_s in [0.0, 4e-4] {
            let spike = log(off_s, |at| if at == 300 { 0.3 } else { 0.0 });
            let logs = [spike];
            let (bridged, note) = bridged(&logs);
            assert!(note.unwrap().starts_with("1 spike of the force"));
            // THEN it is off by noise, √1.5 of it, and so is all that was interpolated from it.
            let [log] = &bridged[..] else { panic!() };
            let honest = self::log(off_s, |_| 0.0);
            let pairs = log.force_n.iter().zip(&honest.force_n);
            let worst = pairs
                .map(|(own, own_n)| (own - own_n).abs())
                .fold(0.0, f64::max);
            assert!(worst < 0.05, "{worst}");
        }
    }

    #[test]
    fn a_tap_that_one_sample_has_seen_is_no_spike() {
        // GIVEN rest at 10 Hz but for one press that is over within a sample
        let taps = |size: f64| (0..400).map(move |at| if at == 220 { size } else { 0.0 });
        let noise = |at: usize| 1e-6 * ((at * at) as f64).sin();
        let channel = |size: f64, noisy: f64| {
            let each = taps(size).enumerate();
            each.map(|(at, own)| own + noisy * noise(at)).collect()
        };
        let time_s: Vec<f64> = (0..400).map(|at| 0.1 * f64::from(at)).collect();
        let of = |size_m: f64| {
            let log = Log::from_channels(time_s.clone(), channel(size_m, 1.0), channel(0.5, 1e3));
            [log.uniform().unwrap()]
        };
        assert_eq!(bridged(&of(1e-3)).1, None);
        // WHERE the probe has not moved it is one.
        assert_eq!(spikes(&of(0.0)[0]), [220]);
    }

    #[test]
    fn a_step_two_readings_and_a_wave_are_no_spikes() {
        let step = |at: usize| if at >= 300 { 0.3 } else { 0.0 };
        let two = |at: usize| if (300..302).contains(&at) { 0.3 } else { 0.0 };
        let wave = |at: usize| match at.checked_sub(300) {
            Some(since) => 0.3 * (-(since as f64) / 8.0).exp() * (2.0 * since as f64).cos(),
            None => 0.0,
        };
        for logs in [[log(0.0, step)], [log(0.0, two)], [log(0.0, wave)]] {
            assert_eq!(bridged(&logs).1, None);
        }
    }
}
