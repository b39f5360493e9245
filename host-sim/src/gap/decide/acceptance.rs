//! Whether the names of a decision stand.

use estimator_core::physics::effect::EffectId;

use crate::gap::decide::evidence::Decision;
use crate::gap::decide::rivals::{apart, related};
use crate::gap::finding::Tried;
use crate::gap::model::fit::Fit;
use crate::gap::model::shape::Owner;
use crate::gap::search::search::added;
use crate::gap::search::significance::is_repeated;

/// Share of the base's excess that names must explain together to stand where something is left.
const CERTAIN: f64 = 0.95;
/// Or they stand if they leave at most this share of the excess, and any other set as large at least
/// so many times as much: 3.1 for the nearest effect to a crackling that is in no catalogue, 4.7 for a
/// soft limit.
const AHEAD_LEFT: f64 = 0.25;
const AHEAD: f64 = 4.0;
/// Of what is left, the share that an effect must take off at least where much is left.
const IDLE: f64 = 0.01;
/// Standard errors that the size of an effect must be, to be one.
const KNOWN: f64 = 3.0;
/// Share of the held-out squares that an effect takes off, to be worth telling from another.
const MISSED: f64 = 0.1;

/// The fit without an effect that takes nothing off.
pub(in crate::gap) fn idle(decision: &Decision) -> Option<&Fit> {
    let count = decision.variances.iter().filter(|v| **v > 0.0).count() as f64;
    let cost = decision.best.cost;
    let most = cost + apart(&decision.best, count, decision.correlation).min(IDLE * cost);
    let least = decision.without.iter();
    least
        .min_by(|a, b| a.cost.total_cmp(&b.cost))
        .filter(|fit| fit.cost < most)
}

/// An effect whose size may as well be 0, if nothing else could stand in its place or the held-out part hardly
/// misses it: of 810 names that were right one was that badly known, of 36 wrong ones ten.
pub(in crate::gap) fn unsized_effect(decision: &Decision) -> Option<usize> {
    let Decision {
        best, std_errors, ..
    } = decision;
    let is_known = |number: usize| {
        let owner = Owner::Effect(number, 0);
        let at = best.shape.free.iter().position(|own| own.owner == owner);
        at.and_then(|at| Some((best.shape.natural(at, best.numbers[at]), std_errors[at]?)))
            .is_none_or(|(size, error)| size.abs() >= KNOWN * error)
    };
    // Modes of one spectrum share theirs, and no name hangs on one of them.
    let is_one = |number: usize| !is_repeated(best.shape.terms[number].id, best);
    let judged = decision.alternatives.iter().zip(&decision.gains);
    let mut each = best.added().into_iter().zip(judged);
    each.position(|(number, (others, gain))| {
        let open = !others.is_empty() && *gain > MISSED;
        !open && is_one(number) && !is_known(number)
    })
}

/// Squares beyond the floor's, of residuals over what is allowed.
fn excess(ratio: f64) -> f64 {
    (ratio * ratio - 1.0).max(0.0)
}

/// Whether names stand though something is left.
pub(in crate::gap) fn stand(decision: &Decision, tried: &[Tried]) -> bool {
    let explained = 1.0 - excess(decision.ratio.1) / excess(decision.ratio.0).max(1e-12);
    explained >= CERTAIN || is_ahead(&added(&decision.best), tried)
}

/// Whether a set of effects that leaves something explains most of the excess, and every other set as
/// large leaves several times as much: the form of one of them is another than the catalogue's.
fn is_ahead(ids: &[EffectId], tried: &[Tried]) -> bool {
    let left_by = |own: &Tried| excess(own.ratio);
    let of = |ids: &[EffectId]| tried.iter().find(|own| own.ids == ids).map(left_by);
    let (Some(base), Some(left)) = (of(&[]), of(ids)) else {
        return false;
    };
    let others = tried
        .iter()
        .filter(|own| own.ids.len() == ids.len() && own.ids != ids)
        .filter(|own| !own.ids.iter().zip(ids).all(|(a, b)| related(*a, *b)));
    let next = others.map(left_by).fold(base, f64::min);
    left <= AHEAD_LEFT * base && next >= AHEAD * left
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gap::data::fit_data::Course;
    use crate::gap::data::scales::Scales;
    use crate::gap::finding::Verdict;
    use crate::gap::model::shape::Shape;
    use crate::gap::model::start::whole;
    use crate::log::Log;
    use crate::model::Model;
    use crate::toml_reader::TomlFile;
    use estimator_core::physics::effect::MOST_PARAMETERS;
    use std::path::Path;

    /// Cost of the best fit to as many samples.
    const SAMPLES: usize = 10_000;

    /// Force offsets of 1 N beside a contact, with standard errors (N) and what is left without each.
    fn decision(errors: &[f64], without: &[f64]) -> Decision {
        let path = Path::new("model.toml");
        let text = "[environment]\nlaw = \"kelvin_voigt\"\nstiffness = 1000.0\ndamping = 3.0\n";
        let file = TomlFile::parse(text.into(), path).unwrap();
        let model = Model::from_toml(&file, path).unwrap();
        let time: Vec<f64> = (0..2000).map(|at| f64::from(at) * 1e-3).collect();
        let position: Vec<f64> = time.iter().map(|t| 1e-3 * (6.3 * t).sin()).collect();
        let force = position.iter().map(|x| 1e3 * x.max(0.0)).collect();
        let log = Log::from_channels(time, position, force).uniform().unwrap();
        let scales = Scales::of(&[Course::of(&log)]);
        let mut row = [0.0; MOST_PARAMETERS];
        row[0] = 1.0;
        let terms = vec![whole(EffectId::ForceOffset, row, 1); errors.len()];
        let shape = Shape::new(&model.environment, terms, &scales);
        let environment = shape.environment_count();
        let fit = |cost: f64| Fit {
            numbers: shape.start(),
            shape: shape.clone(),
            cost,
        };
        let std_errors = (0..environment).map(|_| Some(1e-9));
        Decision {
            verdict: Verdict::MissingEffects,
            base: fit(2.0 * SAMPLES as f64),
            best: fit(SAMPLES as f64),
            better: None,
            std_errors: std_errors.chain(errors.iter().copied().map(Some)).collect(),
            alternatives: vec![Vec::new(); errors.len()],
            gains: vec![0.5; errors.len()],
            without: without.iter().copied().map(fit).collect(),
            rmse_n: (2.0, 1.0),
            ratio: (2.0, 1.0),
            variances: vec![1.0; SAMPLES],
            held_out: vec![false; SAMPLES],
            correlation: 1.0,
        }
    }

    #[test]
    fn an_effect_that_may_as_well_be_0_is_none_unless_another_may_stand_for_it() {
        // GIVEN a newton that is known to a quarter, and to a half
        assert_eq!(unsized_effect(&decision(&[0.25], &[2e4])), None);
        let unknown = decision(&[0.5], &[2e4]);
        assert_eq!(unsized_effect(&unknown), Some(0));
        // THEN one that a rival may replace is left to be told apart, and modes of one spectrum are not
        // judged one by one.
        let open = Decision {
            alternatives: vec![vec![EffectId::CableStiffness]],
            ..unknown
        };
        assert_eq!(unsized_effect(&open), None);
        // AND what is hardly missed is not worth that.
        let idle = Decision {
            gains: vec![0.03],
            ..open
        };
        assert_eq!(unsized_effect(&idle), Some(0));
        assert_eq!(unsized_effect(&decision(&[0.5, 0.5], &[2e4, 2e4])), None);
    }

    #[test]
    fn an_effect_that_takes_nothing_off_at_the_logs_own_rate_is_idle() {
        // GIVEN 12 independent samples' worth of Σ w r² as the bound
        assert!(idle(&decision(&[0.1], &[1.0011e4])).is_some());
        assert!(idle(&decision(&[0.1], &[1.0013e4])).is_none());
        // AND where much is left, a hundredth of it.
        let mut bad = decision(&[0.1], &[1.02e6]);
        bad.best.cost = 1e6;
        assert!(idle(&bad).is_none());
        bad.without[0].cost = 1.001e6;
        assert!(idle(&bad).is_some());
    }

    #[test]
    fn names_that_leave_much_stand_only_far_ahead_of_all_others() {
        let tried = |next: f64| {
            let of = |ids: Vec<EffectId>, ratio: f64| Tried { ids, ratio };
            vec![
                of(vec![EffectId::ForceOffset], 1.5),
                of(vec![EffectId::Backlash], next),
                of(Vec::new(), 4.0),
            ]
        };
        // GIVEN 1.25 of an excess of 15, 8 %: less than the 95 % that stand by themselves
        let left = Decision {
            ratio: (4.0, 1.5),
            ..decision(&[0.1], &[2e4])
        };
        // THEN a rival that leaves 4.3 times as much makes it stand, and one that leaves 3.4 times does not.
        assert!(stand(&left, &tried(2.53)));
        assert!(!stand(&left, &tried(2.3)));
    }
}
