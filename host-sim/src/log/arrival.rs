//! Stamps of arrival: samples that were taken evenly and reach the host in bunches (USB, a network), where each is
//! stamped as it is read.
//!
//! Within a bunch the stamps are nearly equal, and the time lies in the pauses between bunches: a speed by such stamps
//! is too large by the pause over the interval (50 times, for 16 samples 20 µs apart at 1 kHz), and a damping too small
//! by as much. Position and force tell whether the sampling or only its stamps came in bunches; the line through the
//! stamps of the bunches over the numbers of their samples is the clock.

use super::record::Log;
use super::timing::snapped;
use crate::number::quantity;
use crate::stats::{median, rms};

/// A pause is longer than so many mean intervals: of an even log none is, and stamps 500 µs apart at 1 kHz are closer.
const PAUSE_INTERVALS: f64 = 1.5;
/// A longer pause (s) is one of the measurement: hosts deliver within 10 to 200 ms.
const LONGEST_PAUSE_S: f64 = 1.0;
/// Of stamps that come in bunches the median interval is this share of the mean one at most: 0.5 for stamps 500 µs apart
/// at 1 kHz. With 30 % of the samples dropped at random it is 0.7.
const DENSE_SHARE: f64 = 0.6;
/// Share of the time that lies in the pauses: 0.53 for stamps 500 µs apart at 1 kHz, 0.98 for 20 µs.
const PAUSED_SHARE: f64 = 0.33;
/// Fewer bunches than these make no clock. Derived: with 20 a line is 2 % off where a bunch is half its length late.
const FEWEST_BUNCHES: usize = 20;
/// Squares that one explanation of the motion leaves over those of the other, where it decides. Derived: 2 in rms.
const DECIDES: f64 = 4.0;
/// A lasting step of the clock by more than this share of a bunch: samples are missing. Half a bunch lies as far from
/// none as from one that was lost.
const STEP_BUNCHES: f64 = 0.5;
/// Bunches on either side of a step. Derived: 20 that are late by a third of a bunch have a median good to 1/11.
const STEP_OVER: usize = 20;

/// What the stamps of a log are with regard to bunches.
pub(super) enum Arrival {
    /// Not those of an arrival, or nothing moves that could tell.
    No,
    /// They were, and even ones have taken their place; the note to that.
    Even(String),
    /// They are, and when the samples were taken is not certain.
    Uncertain {
        /// Rows a second (Hz).
        rate_hz: f64,
        /// How many samples, in how many bunches.
        what: String,
        /// Why it is not certain.
        why: String,
    },
}

/// Samples that arrived together: from which on, and how many.
#[derive(Clone, Copy)]
struct Bunch {
    first: usize,
    count: usize,
}

/// The line through the stamps of the bunches.
struct Clock {
    start_s: f64,
    period_s: f64,
    /// How late each bunch is (s).
    late_s: Vec<f64>,
}

impl Log {
    /// Replaces stamps of arrival by even ones, if the samples were taken evenly and none is missing.
    pub(super) fn take_arrivals_as_even(&mut self) -> Arrival {
        let Some(bunches) = bunches(&self.time_s) else {
            return Arrival::No;
        };
        if !self.moves_evenly(&bunches) {
            return Arrival::No;
        }
        let Some(clock) = Clock::through(&self.time_s, &bunches) else {
            return Arrival::No;
        };
        let rate_hz = snapped(1.0 / clock.period_s);
        let size = self.len() as f64 / bunches.len() as f64;
        let what = format!(
            "{} samples come in {} bunches of nearly equal time stamps, {} of a bunch and {} to the next: the \
             stamps are those of their arrival, and position and force do not follow them",
            self.len(),
            bunches.len(),
            quantity(self.median_interval_s(), 2, "s"),
            quantity(size * clock.period_s, 2, "s"),
        );
        if let Some(why) = clock.is_uncertain(&self.time_s, &bunches, size * clock.period_s) {
            return Arrival::Uncertain { rate_hz, what, why };
        }
        let even_s = |at: usize| clock.start_s + at as f64 * clock.period_s;
        self.time_s = (0..self.len()).map(even_s).collect();
        Arrival::Even(format!(
            "{what}: the samples are taken as even, {rate_hz} a second"
        ))
    }

    fn median_interval_s(&self) -> f64 {
        median(self.time_s.windows(2).map(|pair| pair[1] - pair[0]))
    }

    /// Whether a bunch covers as much of the way to the next one as its samples would if they were even, and not as
    /// its stamps say. The position decides; where it is at rest, the force.
    fn moves_evenly(&self, bunches: &[Bunch]) -> bool {
        [&self.position_m, &self.force_n]
            .into_iter()
            .find_map(|channel| is_even(&self.time_s, channel, bunches))
            .unwrap_or(false)
    }
}

/// The bunches; `None` if the stamps come in none.
fn bunches(time_s: &[f64]) -> Option<Vec<Bunch>> {
    let intervals = || time_s.windows(2).map(|pair| pair[1] - pair[0]);
    let whole_s = time_s.last()? - time_s.first()?;
    let mean_s = whole_s / (time_s.len() - 1).max(1) as f64;
    let is_pause = |interval_s: &f64| *interval_s > PAUSE_INTERVALS * mean_s;
    let paused_s: f64 = intervals().filter(is_pause).sum();
    let is_bunched = median(intervals()) <= DENSE_SHARE * mean_s
        && paused_s > PAUSED_SHARE * whole_s
        && intervals().all(|interval_s| interval_s < LONGEST_PAUSE_S);
    if !is_bunched {
        return None;
    }
    let mut bunches = Vec::new();
    for together in time_s.chunk_by(|a, b| !is_pause(&(b - a))) {
        let before = bunches.last();
        bunches.push(Bunch {
            first: before.map_or(0, |bunch: &Bunch| bunch.first + bunch.count),
            count: together.len(),
        });
    }
    let most_are_several = median(bunches.iter().map(|bunch| bunch.count as f64)) >= 2.0;
    (bunches.len() >= FEWEST_BUNCHES && most_are_several).then_some(bunches)
}

/// Whether a channel was sampled evenly, or at its stamps; `None` if it does not tell.
fn is_even(time_s: &[f64], channel: &[f64], bunches: &[Bunch]) -> Option<bool> {
    let (mut of_even, mut of_stamps) = (0.0, 0.0);
    for pair in bunches.windows(2) {
        let (first, next) = (pair[0].first, pair[1].first);
        let within = channel[next - 1] - channel[first];
        let whole = channel[next] - channel[first];
        let even = (next - 1 - first) as f64 / (next - first) as f64;
        let stamped = (time_s[next - 1] - time_s[first]) / (time_s[next] - time_s[first]);
        of_even += (within - even * whole).powi(2);
        of_stamps += (within - stamped * whole).powi(2);
    }
    if DECIDES * of_even < of_stamps {
        return Some(true);
    }
    (DECIDES * of_stamps < of_even).then_some(false)
}

impl Clock {
    /// The line over the last samples of the bunches, which have just been taken when a bunch arrives, or over the first
    /// ones, where bunches run into each other.
    fn through(time_s: &[f64], bunches: &[Bunch]) -> Option<Clock> {
        let over = |number: fn(&Bunch) -> usize| {
            let numbers: Vec<f64> = bunches.iter().map(|bunch| number(bunch) as f64).collect();
            let stamps: Vec<f64> = bunches.iter().map(|bunch| time_s[bunch.first]).collect();
            Clock::line(&numbers, &stamps)
        };
        let last = over(|bunch| bunch.first + bunch.count - 1)?;
        let first = over(|bunch| bunch.first)?;
        let scatter = |clock: &Clock| rms(clock.late_s.iter().copied());
        Some(match scatter(&last) <= scatter(&first) {
            true => last,
            false => first,
        })
    }

    fn line(numbers: &[f64], stamps_s: &[f64]) -> Option<Clock> {
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        let (middle, middle_s) = (mean(numbers), mean(stamps_s));
        let (mut cross, mut square) = (0.0, 0.0);
        for (number, stamp_s) in numbers.iter().zip(stamps_s) {
            cross += (number - middle) * (stamp_s - middle_s);
            square += (number - middle).powi(2);
        }
        let period_s = cross / square;
        let start_s = middle_s - period_s * middle;
        let late = |(number, stamp_s): (&f64, &f64)| stamp_s - start_s - number * period_s;
        (period_s > 0.0).then(|| Clock {
            start_s,
            period_s,
            late_s: numbers.iter().zip(stamps_s).map(late).collect(),
        })
    }

    /// What speaks against an even clock without a missing sample, of bunches that last so long (s).
    fn is_uncertain(&self, time_s: &[f64], bunches: &[Bunch], bunch_s: f64) -> Option<String> {
        let scatter_s = rms(self.late_s.iter().copied());
        if scatter_s > bunch_s {
            return Some(format!(
                "the bunches are {} rms off an even clock: their samples do not match the pauses between them",
                quantity(scatter_s, 2, "s")
            ));
        }
        let over = STEP_OVER.min(bunches.len() / 4);
        let typical_s = |late_s: &[f64]| median(late_s.iter().copied());
        let step = |at: &usize| {
            typical_s(&self.late_s[*at..*at + over]) - typical_s(&self.late_s[*at - over..*at])
        };
        let places = over..=bunches.len() - over;
        let at = places.max_by(|a, b| step(a).abs().total_cmp(&step(b).abs()))?;
        (step(&at).abs() > STEP_BUNCHES * bunch_s).then(|| {
            format!(
                "near {:.3} s the clock steps by {}: samples are missing there, or the rate has changed",
                time_s[bunches[at].first],
                quantity(step(&at), 2, "s")
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};

    const SEED: u64 = 29;

    /// A press at 1 kHz on 2 N/mm, 4 s, and the stamps that a host gives bunches of 8 to 24 samples: they come 2 to
    /// 5 ms after the last of them was taken, and each is read so much after the one before.
    fn arrived(apart_s: f64) -> Log {
        let mut rng = rand_pcg::Pcg64::seed_from_u64(SEED);
        let mut stamps: Vec<f64> = Vec::new();
        while stamps.len() < 4000 {
            let count = [8, 16, 16, 24][rng.random_range(0..4)].min(4000 - stamps.len());
            let taken_s = (stamps.len() + count - 1) as f64 * 1e-3;
            let arrived_s = taken_s + 0.002 + 0.003 * rng.random::<f64>();
            let before_s = stamps.last().copied().unwrap_or(0.0);
            let read_s = |at: usize| (arrived_s + at as f64 * apart_s).max(before_s);
            stamps.extend((0..count).map(read_s));
        }
        let taken = (0..4000).map(|at| f64::from(at) * 1e-3);
        of_motion(stamps, taken)
    }

    fn of_motion(stamps: Vec<f64>, taken_s: impl Iterator<Item = f64>) -> Log {
        let way = |t: f64| (1e3 * (1.0 - (std::f64::consts::TAU * t).cos())).round() * 1e-6;
        let position: Vec<f64> = taken_s.map(way).collect();
        let force = position.iter().map(|x| 2000.0 * x).collect();
        Log::from_channels(stamps, position, force)
    }

    #[test]
    fn samples_that_arrive_in_bunches_are_even_at_the_rate_of_their_rows() {
        for apart_s in [0.0, 1e-6, 2e-5, 5e-4] {
            let mut log = arrived(apart_s);
            let Arrival::Even(note) = log.take_arrivals_as_even() else {
                panic!("{apart_s}")
            };
            assert!(note.ends_with("taken as even, 1000 a second"), "{note}");
            // No sample is lost, and the grid is theirs.
            let grid = log.uniform().unwrap();
            assert_eq!((grid.len(), grid.rate_hz), (4000, 1000.0), "{apart_s}");
            assert!(grid.untouched && !grid.in_gap.contains(&true));
        }
    }

    #[test]
    fn samples_that_were_taken_in_bunches_keep_their_stamps() {
        let stamps = arrived(2e-5).time_s;
        let mut log = of_motion(stamps.clone(), stamps.clone().into_iter());
        assert!(matches!(log.take_arrivals_as_even(), Arrival::No));
        assert_eq!(log.time_s, stamps);
    }

    #[test]
    fn a_bunch_that_was_lost_makes_the_clock_uncertain() {
        let whole = arrived(2e-5);
        let lost = |channel: &[f64]| [&channel[..2000], &channel[2032..]].concat();
        let mut log = Log::from_channels(
            lost(&whole.time_s),
            lost(&whole.position_m),
            lost(&whole.force_n),
        );
        let Arrival::Uncertain { rate_hz, why, .. } = log.take_arrivals_as_even() else {
            panic!("certain")
        };
        assert!((rate_hz / 1000.0 - 1.0).abs() < 0.02, "{rate_hz}");
        assert!(why.contains("samples are missing"), "{why}");
    }

    #[test]
    fn cycles_with_rests_between_them_are_no_bunches() {
        // GIVEN 2 s at 1 kHz and 0.4 s of nothing, thirty times; and a ramp at 1 kHz with a hold at 5 Hz
        let cycles = (0..60_000).map(|at: u32| f64::from(at) * 1e-3 + 0.4 * f64::from(at / 2000));
        let thinned = (0..2000).map(|at: u32| f64::from(at) * 1e-3);
        let thinned = thinned.chain((0..300).map(|at: u32| 2.0 + 0.2 * f64::from(at)));
        for stamps in [cycles.collect::<Vec<f64>>(), thinned.collect()] {
            let mut log = of_motion(stamps.clone(), stamps.clone().into_iter());
            assert!(matches!(log.take_arrivals_as_even(), Arrival::No));
            assert_eq!(log.time_s, stamps);
        }
    }
}
