//! The one short stretch of the logs that holds most of what remains.
//!
//! What happens at one turn of a motion and at others as well is no such stretch, but what the model gets wrong there: under
//! the friction of a surgical tool three turns of 20 s were left out one after the other, and without them a delay of
//! −160 ms was a strong name.

use std::collections::VecDeque;
use std::ops::Range;

use crate::gap::finding::Episode;
use crate::gap::model::{dataset::Dataset, fit::Fit, simulate::depths, weights::weights};
use crate::phase::phases_of;

/// It holds this share of what stands above the noise. Derived: most of it.
const MOST: f64 = 0.5;
/// It is at most this share of its log. A lift ran against its stop for 1.2 % of 80 s. Not measured beyond.
pub(in crate::gap) const SHORT: f64 = 0.05;
/// A part next to it belongs to it if its mean square is at least this share of its own, and so many times that of the rest.
/// Not measured; half a sine of force ends so within 5 % of its length.
const OF_INSIDE: f64 = 0.02;
const OF_OUTSIDE: f64 = 4.0;
/// Fewest samples that are looked at next to it.
const FEWEST: usize = 8;
/// It happens again if another change of phase has this share of what it has above the noise. The turns of the tool have
/// half of each other's and more; what is half as large has a quarter.
const AGAIN: f64 = 0.25;

/// The short stretch of one of the logs that holds most of what a fit leaves, if there is one.
pub(in crate::gap) fn episode(dataset: &Dataset<'_>, fit: &Fit) -> Option<Episode> {
    let weights = weights(&dataset.variances(fit));
    let problem = dataset.problem(&weights);
    let residuals = problem.residuals(&fit.shape, &fit.numbers);
    // A sample without a weight is as the noise.
    let square = |(own, weight): (&f64, &f64)| match *weight > 0.0 {
        true => own * own * weight,
        false => 1.0,
    };
    let squares: Vec<f64> = residuals.iter().zip(&weights).map(square).collect();
    let excess = excess(&squares, dataset.thresholds.explained.nothing_more)?;
    let mut start = 0;
    let stretches = dataset.logs.iter().enumerate().filter_map(|(at, log)| {
        let squares = &squares[start..start + log.len()];
        start += log.len();
        let most = (SHORT * log.len() as f64) as usize;
        let rows = shortest_with(squares, MOST * excess)?;
        let rows = whole(squares, rows, most)?;
        let episode = Episode {
            log: at,
            from_s: log.time_s[rows.start],
            until_s: log.time_s[rows.end - 1],
        };
        Some((episode, squares, rows))
    });
    let (episode, squares, rows) =
        stretches.min_by(|(a, ..), (b, ..)| a.length_s().total_cmp(&b.length_s()))?;
    let log = &dataset.logs[episode.log];
    let depths = depths(&fit.shape, &fit.numbers, std::slice::from_ref(log));
    let phases = phases_of(&depths[0], &log.speed_mps);
    (!happens_again(squares, &phases, rows)).then_some(episode)
}

/// By how much squares are above those of noise, if they are more than so many `times` as large. Half of less than nothing
/// is anywhere: a log whose closest set left 0.84 times the noise was asked four times.
fn excess(squares: &[f64], times: f64) -> Option<f64> {
    let noise = squares.len() as f64;
    let sum = squares.iter().sum::<f64>();
    (sum > times * noise).then_some(sum - noise)
}

/// Whether rows in which the phase changes, or next to them, are about as far above the noise where it changes elsewhere.
fn happens_again(squares: &[f64], phases: &[usize], rows: Range<usize>) -> bool {
    let length = rows.len();
    let near = rows.start.saturating_sub(length / 2)..rows.end + length / 2;
    let changes = (1..phases.len()).filter(|at| phases[at - 1] != phases[*at]);
    let (here, elsewhere): (Vec<usize>, Vec<usize>) = changes.partition(|at| near.contains(at));
    // A noisy speed changes its phase at every other sample: each part by two of the sums before it.
    let mut before = vec![0.0];
    before.extend(squares.iter().scan(0.0, |sum, square| {
        *sum += square - 1.0;
        Some(*sum)
    }));
    let above = |part: &Range<usize>| before[part.end] - before[part.start];
    let enough = AGAIN * above(&rows);
    let is_as_far = |from: usize| {
        let part = from..(from + length).min(squares.len());
        let is_apart = part.end <= rows.start || part.start >= rows.end;
        is_apart && above(&part) >= enough
    };
    let mut around = elsewhere.into_iter().flat_map(|at| {
        let from = at.saturating_sub(length);
        (from..=at).step_by((length / FEWEST).max(1))
    });
    !here.is_empty() && around.any(is_as_far)
}

/// The shortest rows whose squares are above the noise by so much.
fn shortest_with(squares: &[f64], excess: f64) -> Option<Range<usize>> {
    let mut best: Option<Range<usize>> = None;
    // Where rows may begin, with what is above the noise before them: one with more before it than a later one is no start.
    let mut starts: VecDeque<(usize, f64)> = VecDeque::from([(0, 0.0)]);
    let mut before = 0.0;
    for (at, square) in squares.iter().enumerate() {
        before += square - 1.0;
        while let Some((start, _)) = starts.front().filter(|own| before - own.1 >= excess) {
            let rows = *start..at + 1;
            if best.as_ref().is_none_or(|best| rows.len() < best.len()) {
                best = Some(rows);
            }
            starts.pop_front();
        }
        while starts.back().is_some_and(|own| own.1 >= before) {
            starts.pop_back();
        }
        starts.push_back((at + 1, before));
    }
    best
}

/// The rows, and those around them that are far from the noise as well; `None` if that is more than so many.
fn whole(squares: &[f64], rows: Range<usize>, most: usize) -> Option<Range<usize>> {
    let sum = |rows: Range<usize>| squares[rows].iter().sum::<f64>();
    let inside = sum(rows.clone());
    let outside = (sum(0..squares.len()) - inside) / (squares.len() - rows.len()).max(1) as f64;
    let far = (OF_INSIDE * inside / rows.len() as f64).max(OF_OUTSIDE * outside);
    let is_far = |rows: Range<usize>| sum(rows.clone()) > far * rows.len() as f64;
    let part = (rows.len() / 4).max(FEWEST);
    let Range { mut start, mut end } = rows;
    while start > 0 && is_far(start.saturating_sub(part)..start) {
        start = start.saturating_sub(part);
    }
    while end < squares.len() && is_far(end..(end + part).min(squares.len())) {
        end = (end + part).min(squares.len());
    }
    (end - start <= most).then_some(start..end)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A thousand squares of 1, with half a sine of up to 400 at 300 to 340.
    fn squares() -> Vec<f64> {
        let wave = |at: i32| (std::f64::consts::PI * f64::from(at - 300) / 40.0).sin();
        let square = |at: i32| match (300..340).contains(&at) {
            true => 1.0 + (20.0 * wave(at)).powi(2),
            false => 1.0,
        };
        (0..1000).map(square).collect()
    }

    #[test]
    fn the_shortest_rows_with_half_of_it_are_in_its_middle() {
        let squares = squares();
        // Half of the area of a squared half sine is in the middle 26 % of it, 10.6 of 40 rows.
        let excess = excess(&squares, 1.02).unwrap();
        let rows = shortest_with(&squares, 0.5 * excess).unwrap();
        assert_eq!(rows.len(), 11);
        assert!((312..317).contains(&rows.start), "{rows:?}");
        assert_eq!(shortest_with(&squares, 1.01 * excess), None);
    }

    #[test]
    fn nothing_stands_out_of_what_is_no_more_than_noise() {
        assert_eq!(excess(&[0.7; 1000], 1.02), None);
        assert_eq!(excess(&[1.01; 1000], 1.02), None);
        let above = excess(&[1.5; 1000], 1.02).unwrap();
        assert!((above - 500.0).abs() < 1e-9);
    }

    #[test]
    fn what_is_around_them_belongs_to_them_until_it_is_as_the_rest() {
        let squares = squares();
        let all = whole(&squares, 315..326, 50).unwrap();
        assert!(
            (292..=301).contains(&all.start) && (339..=348).contains(&all.end),
            "{all:?}"
        );
        assert_eq!(whole(&squares, 315..326, 30), None);
    }

    #[test]
    fn what_is_at_another_turn_as_well_happens_again() {
        let mut squares = squares();
        let turns_at = |turns: &[usize]| -> Vec<usize> {
            let after = |at: usize| turns.iter().filter(|turn| at >= **turn).count();
            (0..1000).map(after).collect()
        };
        let rows = 300..340;
        // GIVEN a turn at each of 100 rows, of which one has it
        let turns = turns_at(&[120, 220, 320, 420, 520]);
        assert!(!happens_again(&squares, &turns, rows.clone()));
        // THEN one that is half as large makes it a matter of turns, wherever that is beside its turn,
        let another: Vec<f64> = squares[300..340].iter().map(|own| 0.3 * own).collect();
        squares[480..520].copy_from_slice(&another);
        assert!(happens_again(&squares, &turns, rows.clone()));
        // AND not where no turn is, there or here.
        assert!(!happens_again(
            &squares,
            &turns_at(&[320, 700]),
            rows.clone()
        ));
        assert!(!happens_again(&squares, &turns_at(&[200, 500]), rows));
    }
}
