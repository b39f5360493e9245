//! Encoders that stand on the edge between two counts, and read one or the other.

use std::borrow::Cow;

use super::noise::{measured, noise_beside, step};

/// Fewer toggles than this, and than one in so many samples, are motion: 40 simulated palpations with
/// a silent encoder have up to 4 in 30 000 samples, 54 with a toggling one at least 34 in 16 000.
const FEWEST_TOGGLES: usize = 8;
const SAMPLES_A_TOGGLE: usize = 2000;
/// Noise of a toggling channel, over its step: one that toggles at every sample reads 0.6.
const TOGGLING_NOISE: f64 = 0.7;
/// What a turn costs, in samples that are read a count off: what goes one count there and back is followed if it
/// stays for twice as long. Readings of an encoder on an edge, one count or the next in no order, take 10⁴ to
/// be that many more often the one.
const TURN: u32 = 50;

/// How often a channel goes one step there and back again: three changes of one step in a row, each
/// against the one before. A turning motion reverses once; an encoder that stands on the edge between
/// two counts, with a little noise, toggles.
pub fn toggles(channel: &[f64]) -> usize {
    step(channel).map_or(0, |step| toggles_of(channel, step))
}

fn toggles_of(channel: &[f64], step: f64) -> usize {
    let changes = channel.windows(2).map(|pair| (pair[1] - pair[0]) / step);
    let (mut alternating, mut before, mut toggles) = (0, 0.0, 0);
    for change in changes.map(f64::round).filter(|change| *change != 0.0) {
        let back = change.abs() == 1.0 && change == -before;
        alternating = if back { alternating + 1 } else { 0 };
        toggles += usize::from(alternating >= 2);
        before = change;
    }
    toggles
}

/// A channel without its toggles, if it toggles, so that its rate is not that of the toggling: within a count of what
/// was read, as seldom off as it may be, and turning no more often than it must. A channel that does not toggle stays
/// as it is.
pub fn without_toggling(channel: &[f64]) -> Cow<'_, [f64]> {
    match toggling(channel) {
        Some((step, _)) => Cow::Owned(with_few_turns(channel, step)),
        None => Cow::Borrowed(channel),
    }
}

/// The step of a channel that toggles, and how often it does; `None` for one that does not.
pub(crate) fn toggling(channel: &[f64]) -> Option<(f64, usize)> {
    let fewest = FEWEST_TOGGLES.max(channel.len() / SAMPLES_A_TOGGLE);
    let step = step(channel)?;
    let toggles = toggles_of(channel, step);
    // With more noise than a step, the noise and not the edge between two counts makes the changes.
    let is_toggling =
        toggles >= fewest && noise_beside(Some(step), channel) < TOGGLING_NOISE * step;
    is_toggling.then_some((step, toggles))
}

/// The channel within a step of what was read that costs least, a sample that is a step off 1 and a turn [`TURN`]:
/// the shortest path through a step less, none or one more and the way up or down at every sample.
///
/// A step of hysteresis, which follows whatever goes on in the direction of the last change, took a single reading of
/// the next count at rest for a motion: with counts of 32 µm one of 6 mm/s, known to a tenth.
fn with_few_turns(channel: &[f64], step: f64) -> Vec<f64> {
    const OFFSETS: [i64; 3] = [-1, 0, 1];
    const NEVER: u32 = u32::MAX / 2;
    /// Places of a path: up or down, and an offset.
    const PLACES: usize = 6;
    let offset = |place: usize| OFFSETS[place % 3];
    let goes_up = |place: usize| place >= 3;
    let own = |place: usize| u32::from(offset(place) != 0);
    let mut costs: [u32; PLACES] = std::array::from_fn(own);
    let mut came_from: Vec<[u8; PLACES]> = Vec::with_capacity(channel.len());
    for pair in channel.windows(2) {
        let change = ((pair[1] - pair[0]) / step).round() as i64;
        let mut froms = [0; PLACES];
        let before = std::mem::replace(&mut costs, [NEVER; PLACES]);
        for to in 0..PLACES {
            for (from, before) in before.iter().enumerate() {
                let way = change + offset(to) - offset(from);
                if (goes_up(to) && way < 0) || (!goes_up(to) && way > 0) {
                    continue;
                }
                let turn = if goes_up(to) == goes_up(from) {
                    0
                } else {
                    TURN
                };
                let cost = (before + turn).saturating_add(own(to)).min(NEVER);
                if cost < costs[to] {
                    (costs[to], froms[to]) = (cost, from as u8);
                }
            }
        }
        came_from.push(froms);
    }
    let mut place = (0..PLACES).min_by_key(|place| costs[*place]).unwrap_or(1);
    let mut path = channel.to_vec();
    for (at, value) in path.iter_mut().enumerate().rev() {
        *value += offset(place) as f64 * step;
        place = at
            .checked_sub(1)
            .map_or(place, |before| came_from[before][place].into());
    }
    // To the bit, or what rests would change in its last digits.
    for at in 1..path.len() {
        if (path[at] - path[at - 1]).abs() < 0.5 * step {
            path[at] = path[at - 1];
        }
    }
    path
}

/// The same of a channel in which some samples are invented: those are put between their neighbours anew. With them
/// the channel has no step, and an encoder that toggles between two counts at 5 kHz moves at 0.1 m/s.
pub(crate) fn measured_without_toggling<'a>(
    channel: &'a [f64],
    invented: &[bool],
) -> Cow<'a, [f64]> {
    if !invented.contains(&true) {
        return without_toggling(channel);
    }
    let taken: Vec<usize> = (0..channel.len()).filter(|at| !invented[*at]).collect();
    let Cow::Owned(followed) = without_toggling(&measured(channel, invented)) else {
        return Cow::Borrowed(channel);
    };
    let mut whole = channel.to_vec();
    for (places, values) in taken.windows(2).zip(followed.windows(2)) {
        let slope = (values[1] - values[0]) / (places[1] - places[0]) as f64;
        let between = whole[places[0]..=places[1]].iter_mut().enumerate();
        between.for_each(|(at, value)| *value = values[0] + slope * at as f64);
    }
    Cow::Owned(whole)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, Normal};

    const SEED_NOISE: u64 = 11;

    #[test]
    fn a_toggling_channel_is_silenced_and_every_other_left_alone() {
        // GIVEN a slow press to 100 counts and back, with 0.15 counts of noise before rounding
        let mut rng = rand_pcg::Pcg64::seed_from_u64(SEED_NOISE);
        let normal = Normal::new(0.0, 0.15).unwrap();
        let way = |i: i32| 0.05 * f64::from(2000 - (i - 2000).abs());
        let silent: Vec<f64> = (0..4000).map(|i| way(i).round() * 1e-6).collect();
        let noisy = (0..4000).map(|i| (way(i) + normal.sample(&mut rng)).round() * 1e-6);
        let noisy: Vec<f64> = noisy.collect();
        // WHEN its toggles are counted, THEN there are some in every count, and none without noise.
        assert!(toggles(&noisy) > 100, "{}", toggles(&noisy));
        assert_eq!(toggles(&silent), 0);
        // AND one that does not is left bit for bit as it was,
        assert!(matches!(without_toggling(&silent), Cow::Borrowed(_)));
        // and of the other stays a staircase within a count of what was read.
        let followed = without_toggling(&noisy);
        assert_eq!(toggles(&followed), 0);
        assert!(followed[..2000].windows(2).all(|pair| pair[1] >= pair[0]));
        let worst = followed.iter().zip(&noisy).map(|(a, b)| (a - b).abs());
        assert!(worst.fold(0.0, f64::max) < 1.001e-6);
        // AND it does so between samples that were invented, three of every ten.
        let invented: Vec<bool> = (0..4000).map(|at| at % 10 > 6).collect();
        let mut with_gaps = noisy.clone();
        for at in (6..3990).step_by(10) {
            let slope = (noisy[at + 4] - noisy[at]) / 4.0;
            (1..4).for_each(|k| with_gaps[at + k] = noisy[at] + slope * k as f64);
        }
        assert_eq!(toggles(&with_gaps), 0, "there is no step in it");
        let followed = measured_without_toggling(&with_gaps, &invented);
        let rising = followed[..2000].windows(2);
        assert!(
            rising
                .map(|pair| pair[1] - pair[0])
                .all(|change| change > -1e-12)
        );
        let worst = followed.iter().zip(&with_gaps).map(|(a, b)| (a - b).abs());
        assert!(worst.fold(0.0, f64::max) < 1.001e-6);
    }

    #[test]
    fn a_reading_of_the_next_count_at_rest_is_no_motion() {
        // GIVEN a rest that is read a count off now and then, to either side, 10 counts up, and half a second on an edge
        let is_up = |at: usize| ((at * 2_654_435_761) >> 16).is_multiple_of(2);
        let off = |at: usize| match at % 97 {
            0 => 1.0,
            50 => -1.0,
            _ if at > 1010 => f64::from(u8::from(is_up(at))),
            _ => 0.0,
        };
        let way = |at: usize| (at as f64 - 1000.0).clamp(0.0, 10.0);
        let read: Vec<f64> = (0..1500).map(|at| 1e-6 * (way(at) + off(at))).collect();
        let followed = without_toggling(&read);
        // THEN it rests, and goes up once.
        assert!(followed[..1000].iter().all(|x| x.abs() < 1e-12));
        assert!(followed.windows(2).all(|pair| pair[1] > pair[0] - 1e-12));
        assert!((followed[1499] - 1e-5).abs() < 1.001e-6);
    }

    #[test]
    fn a_palpation_of_many_counts_a_sample_is_followed_as_it_is() {
        // GIVEN 2 mm at 1.5 Hz in counts of 1 µm, and a rest with toggles
        let way = |at: usize| 1e3 * (1.0 - (9.42e-3 * at as f64).cos());
        let read: Vec<f64> = (0..2000)
            .map(|at| 1e-6 * way(at).round())
            .chain((0..400).map(|at| 1e-6 * f64::from(at % 3 == 0)))
            .collect();
        let followed = without_toggling(&read);
        assert_eq!(toggles(&followed), 0);
        // THEN only where it turns it is a count off, 30 samples of each crest.
        let off = followed[..2000]
            .iter()
            .zip(&read)
            .filter(|(a, b)| a != b)
            .count();
        assert!(off < 150, "{off}");
    }
}
