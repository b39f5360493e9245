//! The parts of a long log that the figures of loops show.

use super::run::Run;
use crate::replay::Touch;

/// With more touches than this, or with a longer contact, the loops would cover each other.
const MOST_TOUCHES: usize = 8;
const MOST_CONTACT_S: f64 = 120.0;
/// The number of touches that are shown of either end of a long log, and the longest stretch of them.
const SHOWN_TOUCHES: usize = 3;
const SHOWN_S: f64 = 30.0;

/// A touch of a smaller share of the deepest is chatter at the surface, and shows no loop. Not measured: 0.02 of a figure's
/// width is as wide as its curve.
const CHATTER: f64 = 0.02;

/// A part of a run with its name.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Window {
    pub(super) from_s: f64,
    pub(super) to_s: f64,
    /// The name; empty for the whole run.
    pub(super) name: String,
}

impl Window {
    /// The indices of the samples in the window.
    pub(super) fn of(&self, time_s: &[f64]) -> std::ops::Range<usize> {
        let inside = |t: &f64| *t >= self.from_s && *t <= self.to_s;
        let from = time_s.iter().position(inside).unwrap_or(0);
        let to = time_s
            .iter()
            .rposition(inside)
            .map_or(from, |last| last + 1);
        from..to
    }
}

/// The whole run, or its first and last touches.
pub(super) fn windows(run: &Run) -> Vec<Window> {
    let touches = &shown(run)[..];
    let contact_s: f64 = touches.iter().map(|t| t.to_s - t.from_s).sum();
    if touches.len() <= MOST_TOUCHES && contact_s <= MOST_CONTACT_S {
        return vec![Window {
            from_s: f64::NEG_INFINITY,
            to_s: f64::INFINITY,
            name: String::new(),
        }];
    }
    let shown = SHOWN_TOUCHES.min(touches.len());
    let first = &touches[..shown];
    let last = &touches[touches.len() - shown..];
    vec![
        cut(first, "first", |from, to| (from, to.min(from + SHOWN_S))),
        cut(last, "last", |from, to| (from.max(to - SHOWN_S), to)),
    ]
}

/// The touches that show a loop; all of them where none is deeper than another.
pub(super) fn shown(run: &Run) -> Vec<Touch> {
    let deepest_m = crate::stats::highest(run.touches.iter().map(|touch| touch.peak_depth_m));
    let deep = run
        .touches
        .iter()
        .filter(|touch| touch.peak_depth_m >= CHATTER * deepest_m);
    let deep: Vec<Touch> = deep.copied().collect();
    match deep.is_empty() {
        true => run.touches.to_vec(),
        false => deep,
    }
}

fn cut(touches: &[Touch], which: &str, shorten: fn(f64, f64) -> (f64, f64)) -> Window {
    let from = touches.first().map_or(0.0, |t| t.from_s);
    let to = touches.last().map_or(0.0, |t| t.to_s);
    let (from_s, to_s) = shorten(from, to);
    let name = match (from, to) == (from_s, to_s) && touches.len() > 1 {
        true => format!("{which} {} touches", touches.len()),
        false => format!("{which} {:.0} s of contact", to_s - from_s),
    };
    Window { from_s, to_s, name }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn touches(n: usize, long_s: f64) -> Vec<Touch> {
        let touch = |i: usize| Touch {
            from_s: i as f64 * (long_s + 1.0),
            to_s: i as f64 * (long_s + 1.0) + long_s,
            peak_force_n: 1.0,
            peak_depth_m: 1e-3,
            ..Touch::default()
        };
        (0..n).map(touch).collect()
    }

    fn names(touches: &[Touch]) -> Vec<String> {
        let run = Run {
            touches: touches.into(),
            ..Run::default()
        };
        windows(&run).into_iter().map(|w| w.name).collect()
    }

    #[test]
    fn a_short_log_is_shown_whole_and_a_long_one_at_its_ends() {
        assert_eq!(names(&[]), [""]);
        assert_eq!(names(&touches(8, 1.0)), [""]);
        assert_eq!(
            names(&touches(9, 1.0)),
            ["first 3 touches", "last 3 touches"]
        );
    }

    /// A probe that chatters at the surface before it leaves: the loops are those of the touches before.
    #[test]
    fn touches_of_no_depth_are_no_loops() {
        let mut all = touches(20, 1.0);
        for chatter in &mut all[15..] {
            chatter.peak_depth_m = 0.0;
        }
        let run = Run {
            touches: (&all).into(),
            ..Run::default()
        };
        let last = windows(&run).pop().unwrap();
        assert_eq!((last.from_s, last.to_s), (all[12].from_s, all[14].to_s));
    }

    #[test]
    fn one_endless_touch_is_cut() {
        let one = touches(1, 3600.0);
        assert_eq!(
            names(&one),
            ["first 30 s of contact", "last 30 s of contact"]
        );
        let run = Run {
            touches: (&one).into(),
            ..Run::default()
        };
        let last = &windows(&run)[1];
        assert_eq!((last.from_s, last.to_s), (3570.0, 3600.0));
    }

    #[test]
    fn a_window_outside_the_samples_is_empty() {
        let window = Window {
            from_s: 5.0,
            to_s: 6.0,
            name: String::new(),
        };
        assert!(window.of(&[]).is_empty());
        assert!(window.of(&[1.0, 2.0]).is_empty());
        assert_eq!(window.of(&[1.0, 5.0, 5.5, 7.0]), 1..3);
    }
}
