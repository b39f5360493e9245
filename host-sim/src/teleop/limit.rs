//! Up to which round trip a scheme comes to rest.
//!
//! A scheme that does not at one delay may at a longer one, so a bisection between the ends of the range finds any of
//! its limits. Here every delay of a grid is tried from the shortest on, until the first at which it does not.

use super::measure::run;
use super::measure::stability::Rest;
use super::operator::Task;
use super::options::Options;
use crate::motion::{Motion, Segment};

/// The round trips that are tried (s), besides that of the run itself.
const TRIED_S: [f64; 10] = [0.0, 0.01, 0.03, 0.06, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0];
/// Halvings of the logarithm between the last round trip at which it rests and the first at which it does not. Steps of
/// the grid are at most threefold, and the first tenfold: within 4 and 7 %. Derived: 3^(1/32), 10^(1/32).
const HALVINGS: u32 = 5;
/// What stands for no delay there (s): the tick of the schemes, below which a delay is none.
const SHORTEST_S: f64 = 1e-3;

/// Up to which round trip a scheme comes to rest.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Limit {
    /// It comes to rest at every round trip that was tried up to this one (s); `None`: at none.
    pub rests_to_s: Option<f64>,
    /// The shortest that was tried at which it does not (s); `None`: there is none.
    pub ends_at_s: Option<f64>,
    /// Whether it comes to rest again at the run's own round trip, which is longer.
    pub rests_again: bool,
}

/// Finds the limit of a scheme on the channel of a run, its delays made longer and shorter.
pub fn limit(options: &Options, own: Rest, seed: u64) -> Limit {
    let own_s = options.round_trip_s();
    let rests = |round_trip_s: f64| match own.known() {
        // What the run itself says.
        Some(rests) if round_trip_s == own_s => rests,
        _ => run(&pressing(options, round_trip_s), seed).1.rests() != Rest::Moves,
    };
    let mut tried = TRIED_S.to_vec();
    tried.push(own_s);
    tried.sort_by(f64::total_cmp);
    tried.dedup();
    let (mut low, mut high) = (None, None);
    for trip_s in tried {
        match rests(trip_s) {
            true => low = Some(trip_s),
            false => {
                high = Some(trip_s);
                break;
            }
        }
    }
    if let (Some(low), Some(high)) = (&mut low, &mut high) {
        for _ in 0..HALVINGS {
            let middle = (low.max(SHORTEST_S) * *high).sqrt();
            *(if rests(middle) { &mut *low } else { &mut *high }) = middle;
        }
    }
    Limit {
        rests_to_s: low,
        ends_at_s: high,
        rests_again: high.is_some_and(|high| high < own_s) && own == Rest::Rests,
    }
}

/// The same options at another round trip, with a press that is long enough for it: what cannot be told of it then only
/// is slow.
fn pressing(options: &Options, round_trip_s: f64) -> Options {
    let usual = Task::default();
    let mut options = options.clone().with_round_trip(round_trip_s);
    if let Some(task) = &mut options.task {
        task.presses_s = task.presses_s.max(usual.presses_s);
        return options.with_task_for_delay();
    }
    let motion = &mut options.operator.intention;
    if motion.position(motion.duration_s()).0 <= 0.0 {
        let (to_m, speed_mps) = (0.7 * usual.inside_m, 0.06);
        let press = Motion::new(0.0, vec![Segment::Ramp { to_m, speed_mps }]);
        *motion = motion.then(&press.expect("a ramp is a motion"));
    }
    options.with_longer_press(usual.presses_s + 2.0 * round_trip_s)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::teleop::SchemeId;
    use crate::teleop::environment::{Environment, Material};

    fn on(material: Material, scheme: SchemeId) -> Options {
        let mut options = Options::default().with_scheme(scheme);
        options.environment = Environment::throughout(material);
        options.with_channel(0.5, 0.0, 0.0).with_task_for_delay()
    }

    /// By a spring between master and slave a spring and a damper do not come to rest at 30 ms, and do at 100 ms and 1 s.
    #[test]
    fn a_limit_is_the_first_and_says_that_the_run_itself_rests_again() {
        let options = on(Material::linear(1000.0, 5.0), SchemeId::PositionPosition);
        let own = run(&options, 1).1.rests();
        assert_eq!(own, Rest::Rests);
        let found = limit(&options, own, 1);
        assert!(
            found.rests_to_s.is_some_and(|to_s| to_s < 0.03),
            "{found:?}"
        );
        assert!(
            found.ends_at_s.is_some_and(|at_s| at_s <= 0.03),
            "{found:?}"
        );
        assert!(found.rests_again);
    }

    #[test]
    fn a_limit_never_reaches_a_round_trip_at_which_the_run_itself_moves() {
        let options = on(Material::gel(), SchemeId::PositionForce);
        let own = run(&options, 1).1.rests();
        assert_eq!(own, Rest::Moves);
        let found = limit(&options, own, 1);
        assert!(found.ends_at_s.is_some_and(|at_s| at_s <= 1.0), "{found:?}");
        assert!(found.rests_to_s < found.ends_at_s && !found.rests_again);
    }

    /// A motion of one's own whose press is as long as a round trip of 5 s is not.
    #[test]
    fn a_motion_that_ends_in_a_short_press_or_in_none_does_not_limit_the_round_trip() {
        let mut options = on(Material::gel(), SchemeId::Reflection);
        options.task = None;
        let palpates = Segment::Sine {
            mean_m: 4e-3,
            amplitude_m: 10e-3,
            frequency_hz: 0.8,
            seconds: 6.25,
        };
        options.operator.intention = Motion::new(-6e-3, vec![palpates]).expect("a motion");
        let found = limit(&options.with_round_trip(0.1), Rest::CannotTell, 1);
        assert_eq!((found.rests_to_s, found.ends_at_s), (Some(5.0), None));
    }
}
