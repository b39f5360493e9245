//! A channel that is new in every few samples only and stands between: a fieldbus or a slower converter.

use crate::log::UniformLog;
use crate::number::quantity;
use crate::signal;
use crate::stats::median;

/// Fewest changes that tell anything.
const FEWEST: usize = 50;
/// The share of the changes that are as far apart as most, and of those that are a multiple of it apart: a reading may
/// be the same twice. Not measured.
const AS_MOST: f64 = 0.5;
const MULTIPLES: f64 = 0.98;
/// A change is more than two counts in the median, or it may be a slow motion over an encoder's. Derived: such a motion
/// changes by one.
const COUNTS: f64 = 2.5;

/// What a channel does that is refreshed more slowly than its log is sampled.
pub(super) fn refreshed_slowly(log: &UniformLog) -> Option<String> {
    let (name, samples) = refreshed(log)?;
    Some(format!(
        "the {name} is new once in {samples} samples only, at {}, and stands between: on average it is {} late, which \
         bends the damping; record both channels at one rate, or keep only the rows in which it is new",
        quantity(log.rate_hz / samples as f64, 3, "Hz"),
        quantity(late_s(samples, log), 2, "s"),
    ))
}

/// By how much (s) the two channels are read apart on average, where one is refreshed more slowly.
pub(crate) fn apart_s(log: &UniformLog) -> Option<f64> {
    let (_, samples) = refreshed(log)?;
    Some(late_s(samples, log))
}

/// The channel that is refreshed more slowly, and the samples from one reading to the next.
fn refreshed(log: &UniformLog) -> Option<(&'static str, usize)> {
    let channels = [("position", &log.position_m), ("force", &log.force_n)];
    let mut each = channels.into_iter();
    each.find_map(|(name, channel)| Some((name, refreshed_every(channel)?)))
}

/// How late (s) a reading is on average that is new once in so many samples.
fn late_s(samples: usize, log: &UniformLog) -> f64 {
    0.5 * (samples - 1) as f64 * log.period_s()
}

/// Samples from one reading of a channel to the next, where that is more than one.
fn refreshed_every(channel: &[f64]) -> Option<usize> {
    let is_new = |at: &usize| channel[*at] != channel[at - 1];
    let news = || (1..channel.len()).filter(is_new);
    // One that stands between is new in every other sample at most; of any other nothing is kept, an hour long.
    let count = news().count();
    if count <= FEWEST || 5 * count > 3 * channel.len() {
        return None;
    }
    let news: Vec<usize> = news().collect();
    let apart = || news.windows(2).map(|pair| pair[1] - pair[0]);
    let every = median(apart().map(|samples| samples as f64)) as usize;
    let share = |is: &dyn Fn(usize) -> bool| {
        apart().filter(|samples| is(*samples)).count() as f64 / (news.len() - 1) as f64
    };
    let change = || median(news.iter().map(|at| (channel[*at] - channel[at - 1]).abs()));
    let is_slow = every > 1
        && share(&|samples| samples == every) >= AS_MOST
        && share(&|samples| samples % every == 0) >= MULTIPLES
        && signal::step(channel).is_none_or(|step| change() > COUNTS * step);
    is_slow.then_some(every)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two seconds of a sine in counts, read anew every so many milliseconds.
    fn sine(count: f64, every: usize) -> Vec<f64> {
        let read = |at: usize| (3e-3 * (0.006 * at as f64).sin() / count).round() * count;
        (0..2000).map(|at| read(at - at % every)).collect()
    }

    #[test]
    fn a_position_that_stands_between_is_recognised_and_one_in_coarse_counts_is_none() {
        assert_eq!(refreshed_every(&sine(1e-6, 5)), Some(5));
        assert_eq!(refreshed_every(&sine(1e-6, 1)), None);
        // 18 µm a sample at most: a count is new every few samples.
        assert_eq!(refreshed_every(&sine(50e-6, 1)), None);
        assert_eq!(refreshed_every(&sine(1e-6, 5)[..100]), None);
    }

    #[test]
    fn a_slow_ramp_over_an_encoders_counts_is_no_slow_reading() {
        let ramp: Vec<f64> = (0..2000).map(|at| (at / 5) as f64 * 1e-6).collect();
        assert_eq!(refreshed_every(&ramp), None);
    }
}
