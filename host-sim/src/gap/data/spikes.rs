//! Single readings of force or position that stand alone.
//!
//! An electrical spike is one sample: the readings before and after it go on as if it were not there. Seven of them,
//! eight to thirty times the noise in 15 s at 200 Hz, made 1.18 times the noise of what is left, and their fourth
//! moment made a slow noise at rest a disturbance: of 500 harder rigs with nothing hidden 11 were unexplained, nine of
//! them with spikes. Of the position, one of 0.5 mm in 10 s was a tool's inertia of 13 g, certain. What lasts longer
//! than a sample is left to speak for itself, and so is a tap that one of ten samples a second has seen: there the
//! other channel has moved, too.

use std::borrow::Cow;

use crate::log::{Channel, UniformLog};
use crate::number::{counted, quantity};
use crate::signal;
use crate::stats::lowest;

/// A spike leaves the mean of its neighbours by this many standard deviations, which noise does once in 10⁹ samples.
const STANDS_OUT: f64 = 6.0;
/// What is left without it leaves the means by fewer.
const GOES_ON: f64 = 4.0;
/// An encoder that toggles leaves them by one count, and its spikes by more than so many.
const MOST_COUNTS: f64 = 3.0;
/// So many differences on either side are looked at.
const AROUND: usize = 3;
/// If more than this share of a log seems to be spikes, they are something else: five a second at 1 kHz are 0.5 %.
const MOST: f64 = 0.02;

/// The logs with the mean of its neighbours for each reading that stands alone, and what was done.
pub(crate) fn bridged(logs: &[UniformLog]) -> (Cow<'_, [UniformLog]>, Vec<String>) {
    let (mut bridged, mut notes) = (Cow::Borrowed(logs), Vec::new());
    for channel in [Channel::Force, Channel::Position] {
        let found: Vec<Vec<usize>> = bridged.iter().map(|log| spikes(log, channel)).collect();
        let count: usize = found.iter().map(Vec::len).sum();
        if count == 0 {
            continue;
        }
        let each = bridged.iter().zip(&found);
        let least = lowest(each.clone().flat_map(|(log, spikes)| {
            let own = raw(log, channel);
            spikes.iter().map(|at| off(own, *at).abs())
        }));
        let (name, unit) = match channel {
            Channel::Position => ("position", "m"),
            Channel::Force | Channel::Time => ("force", "N"),
        };
        notes.push(format!(
            "{} of the {name}, single readings {} and more off their neighbours: bridged",
            counted(count, "spike"),
            quantity(least, 2, unit)
        ));
        let without = each.map(|(log, spikes)| without(log, spikes, channel));
        bridged = Cow::Owned(without.collect());
    }
    (bridged, notes)
}

/// The readings of force or position as they were taken.
fn raw(log: &UniformLog, channel: Channel) -> &[f64] {
    match (channel, &log.taken) {
        (Channel::Position, None) => &log.position_m,
        (Channel::Position, Some(taken)) => &taken.position_m,
        (_, None) => &log.force_n,
        (_, Some(taken)) => &taken.force_n,
    }
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

/// How far readings that are none alone may be from the mean of their neighbours: a spike, and what goes on without
/// spikes.
fn usual(channel: Channel, own: &[f64]) -> [f64; 2] {
    match channel {
        Channel::Position => {
            // Where the probe turns no more than it usually does; a second difference is twice that distance.
            let noise_m = 1.5_f64.sqrt() * signal::noise(own);
            let turn_m = (0.5 * signal::sharpest(own)).max(STANDS_OUT * noise_m);
            let counts_m = MOST_COUNTS * signal::step(own).unwrap_or(0.0);
            [turn_m.max(counts_m), turn_m]
        }
        Channel::Force | Channel::Time => {
            // White noise leaves the mean of two neighbours by √1.5 of its standard deviation.
            let usual_n = 1.5_f64.sqrt() * signal::loud_noise(own);
            [STANDS_OUT * usual_n, GOES_ON * usual_n]
        }
    }
}

/// The samples, of those that were taken, whose reading of a channel is a spike.
fn spikes(log: &UniformLog, channel: Channel) -> Vec<usize> {
    let other = match channel {
        Channel::Position => Channel::Force,
        Channel::Force | Channel::Time => Channel::Position,
    };
    let (own, beside) = (raw(log, channel), raw(log, other));
    let [most, goes_on] = usual(channel, own);
    let is_measured = |at: usize| log.taken.is_some() || !log.in_gap[at];
    let margin = AROUND + 1;
    let candidates = margin..own.len().saturating_sub(margin);
    let peaks: Vec<usize> = candidates
        .filter(|at| off(own, *at).abs() > most)
        .filter(|at| is_peak(own, *at))
        .collect();
    if peaks.is_empty() {
        return peaks;
    }
    let most_beside = match other {
        // Toggling counts are no motion, but a tap of a few is one.
        Channel::Position => usual(other, beside)[1],
        Channel::Force | Channel::Time => usual(other, beside)[0],
    };
    // One that is near another does not go on before that is bridged as well. Three are a wave.
    let before = |at: usize| peaks.partition_point(|own| *own < at);
    let near = |at: &usize| before(at + margin + 1) - before(at - margin);
    let few: Vec<bool> = peaks.iter().map(|at| near(at) <= 2).collect();
    let mut without = own.to_vec();
    for (at, _) in peaks.iter().zip(&few).filter(|(_, few)| **few) {
        without[*at] -= off(own, *at);
    }
    let spikes: Vec<usize> = peaks
        .iter()
        .zip(&few)
        .filter_map(|(at, few)| few.then_some(*at))
        .filter(|at| off(beside, *at).abs() <= most_beside)
        .filter(|at| (at - margin..=at + margin).all(is_measured))
        .filter(|at| goes_on_around(&without[at - margin..=at + margin], goes_on))
        .collect();
    match spikes.len() as f64 > MOST * own.len() as f64 {
        true => Vec::new(),
        false => spikes,
    }
}

/// Whether readings go on, once spikes are bridged.
fn goes_on_around(bridged: &[f64], most: f64) -> bool {
    (1..bridged.len() - 1).all(|at| off(bridged, at).abs() <= most)
}

/// The log with these samples of a channel bridged.
fn without(log: &UniformLog, spikes: &[usize], channel: Channel) -> UniformLog {
    let mut log = log.clone();
    let UniformLog {
        time_s,
        position_m,
        force_n,
        taken,
        ..
    } = &mut log;
    let is_position = channel == Channel::Position;
    let grid = if is_position { position_m } else { force_n };
    let Some(taken) = taken else {
        for at in spikes {
            grid[*at] -= off(grid, *at);
        }
        return log;
    };
    let own = match is_position {
        true => &mut taken.position_m,
        false => &mut taken.force_n,
    };
    for at in spikes {
        own[*at] -= off(own, *at);
        // What was interpolated to an even grid between the neighbours of a spike had a share of it.
        let (from_s, to_s) = (taken.time_s[at - 1], taken.time_s[at + 1]);
        let (from, to) = (own[at - 1], own[at + 1]);
        let first = time_s.partition_point(|time_s| *time_s <= from_s);
        let end = time_s.partition_point(|time_s| *time_s < to_s);
        for (time_s, value) in time_s[first..end].iter().zip(&mut grid[first..end]) {
            *value = from + (to - from) * (time_s - from_s) / (to_s - from_s);
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
        assert_eq!(spikes(&steps, Channel::Force), Vec::<usize>::new());
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
            let (bridged, notes) = bridged(&logs);
            assert!(notes[0].starts_with("1 spike of the force") && notes.len() == 1);
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
        assert!(bridged(&of(1e-3)).1.is_empty());
        // WHERE the probe has not moved it is one.
        assert_eq!(spikes(&of(0.0)[0], Channel::Force), [220]);
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
            assert!(bridged(&logs).1.is_empty());
        }
    }
}
