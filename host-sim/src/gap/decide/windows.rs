//! Which parts of a log are held out: it is cut into twelve windows, and one of each three is.
//!
//! Where a motion keeps step with the windows, the middle ones meet it at the same place: of a tool's two strokes in 20 s
//! they had the middle of the way and none of its turns, and a model that left 7.2 mN m of the log left 4.2 mN m of them.
//! Then another of each three is held out, such that they see what the log sees.

use crate::gap::data::fit_data::FitData;
use crate::phase::{PHASES, phases_of};
use crate::stats::extent;

/// Windows of a log.
const WINDOWS: usize = 12;
/// Of so many one is held out.
const OF: usize = 3;
/// The one of each three, unless they see too little.
const MIDDLE: [usize; WINDOWS / OF] = [1; WINDOWS / OF];

/// Parts of the travel, each on the way forward, back, and at rest: the places of a log.
const PARTS: usize = 4;
const PLACES: usize = PHASES.len() * PARTS;
/// Windows see too little if they and the others share less of the log than this, where other windows share so much more.
/// Of 20 records and 16 simulated rigs 31 have 0.45 to 0.96; a drive's two and the tool's have 0.08 to 0.13, and others
/// reach 0.57 and more there. Of three rigs between them two are named by either, and one by the middle ones alone: the
/// others hold its touches, at which the right effect leaves twice what is allowed.
const TOO_LITTLE: f64 = 0.2;
const MUCH_MORE: f64 = 0.2;

/// For each sample, whether it is held out.
pub(super) fn held_out(logs: &[FitData]) -> Vec<bool> {
    let mut held_out = Vec::new();
    for log in logs {
        let count = log.len();
        let chosen = chosen(&Seen::of(log));
        held_out.extend((0..count).map(|at| {
            let window = at * WINDOWS / count;
            window % OF == chosen[window / OF]
        }));
    }
    held_out
}

/// Which of each three windows is held out.
fn chosen(seen: &Seen) -> [usize; WINDOWS / OF] {
    let middle = seen.share(&MIDDLE);
    if middle >= TOO_LITTLE {
        return MIDDLE;
    }
    let all = (0..OF.pow(MIDDLE.len() as u32)).map(|number| {
        let mut rest = number;
        MIDDLE.map(|_| {
            let digit = rest % OF;
            rest /= OF;
            digit
        })
    });
    let best = all.max_by(|a, b| seen.share(a).total_cmp(&seen.share(b)));
    best.filter(|best| seen.share(best) >= middle + MUCH_MORE)
        .unwrap_or(MIDDLE)
}

/// How many samples of each window are at each place.
struct Seen([[f64; PLACES]; WINDOWS]);

impl Seen {
    fn of(log: &FitData) -> Seen {
        let (lowest_m, highest_m) = extent(&log.position_m);
        let ways = phases_of(&vec![0.0; log.len()], &log.speed_mps);
        let mut counts = [[0.0; PLACES]; WINDOWS];
        for (at, (position_m, way)) in log.position_m.iter().zip(ways).enumerate() {
            let share = (position_m - lowest_m) / (highest_m - lowest_m).max(f64::MIN_POSITIVE);
            let part = ((share * PARTS as f64) as usize).min(PARTS - 1);
            counts[at * WINDOWS / log.len()][PHASES.len() * part + way] += 1.0;
        }
        Seen(counts)
    }

    /// Share of the log at places that these windows, one of each three, and the others see as often as it is there.
    fn share(&self, chosen: &[usize; WINDOWS / OF]) -> f64 {
        let (mut seen, mut all) = (0.0, 0.0);
        for place in 0..PLACES {
            let there: f64 = self.0.iter().map(|window| window[place]).sum();
            let threes = self.0.chunks(OF).zip(chosen);
            let held_out: f64 = threes.map(|(three, one)| three[*one][place]).sum();
            // What a third and the rest would have to see to be as the log.
            let (third, rest) = (OF as f64, OF as f64 / (OF - 1) as f64);
            seen += there.min(third * held_out).min(rest * (there - held_out));
            all += there;
        }
        seen / f64::max(all, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::Log;
    use std::f64::consts::TAU;

    /// 12 s at 100 Hz of strokes that rest at their ends, and which windows of a second are held out.
    fn strokes(count: f64) -> (Vec<f64>, Vec<bool>) {
        let time_s: Vec<f64> = (0..1200).map(|at| 0.01 * f64::from(at)).collect();
        let way = |t: &f64| (1.1 * (TAU * count / 12.0 * t).sin()).clamp(-1.0, 1.0);
        let position_m: Vec<f64> = time_s.iter().map(|t| 1e-2 * way(t)).collect();
        let force_n = vec![0.0; time_s.len()];
        let log = Log::from_channels(time_s, position_m.clone(), force_n);
        let data = FitData::of(&log.uniform().unwrap());
        let held_out = held_out(std::slice::from_ref(&data));
        let windows = held_out.chunks(100).map(|window| window[0]);
        (position_m, windows.collect())
    }

    #[test]
    fn windows_that_meet_each_stroke_at_the_same_place_give_way_to_others() {
        // GIVEN four strokes of three windows each, in which every third window is on the way back
        let (position_m, windows) = strokes(4.0);
        // THEN one of each three is held out, and of the ends of the way they see a third, give or take a fifth of it,
        assert!(
            windows
                .chunks(3)
                .all(|three| three.iter().filter(|out| **out).count() == 1)
        );
        let at_an_end = |at: &usize| position_m[*at].abs() > 8e-3;
        let ends: Vec<usize> = (0..1200).filter(at_an_end).collect();
        let seen = ends.iter().filter(|at| windows[*at / 100]).count();
        let share = seen as f64 / ends.len() as f64;
        assert!((0.27..0.4).contains(&share), "{share}");
        // AND where the strokes do not keep step with the windows it is the middle one of each three.
        let (_, windows) = strokes(5.3);
        let middle: Vec<bool> = (0..12).map(|at| at % 3 == 1).collect();
        assert_eq!(windows, middle);
    }
}
