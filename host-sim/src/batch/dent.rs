//! Whether a material was touched again before it had recovered.

use super::course::Course;
use super::family::Family;
use super::fit::Problem;
use super::lateness::Seen;
use super::select::{Candidate, candidates};
use crate::estimate::Estimation;
use crate::log::UniformLog;

/// A surface that recovers by creep is another force where that changes Σ w r² of a perfect fit by more than this: no
/// parameter moves by more than a standard error else.
const DENT: f64 = 1.0;
/// What a surface that recovers by creep takes off the Bayesian information criterion before a recursion that knows the other
/// one is doubted: very strong evidence is 10. It was 70 and more where a damping was wrong by 20 %, and at most
/// −3 where the surface had followed the probe.
const EVIDENT: f64 = 10.0;

impl Course {
    /// Whether it makes a difference to a law how the surface comes back between touches.
    pub(super) fn leaves_a_dent(&self, candidate: &Candidate) -> bool {
        let Some(creeping) = candidate.fit.family.creeping() else {
            return false;
        };
        let problem = Problem {
            family: candidate.fit.family,
            nodes: &self.nodes,
            weights: &candidate.weights,
            scales: &self.scales,
            fixed: &[],
        };
        let with_probe = problem.forces(&candidate.fit.free);
        let other = Problem {
            family: creeping,
            ..problem
        };
        let (mut own, mut change) = (with_probe.into_iter(), 0.0);
        other.along(&candidate.fit.free, |_, weight, force| {
            let by_n = force - own.next().unwrap_or(force);
            change += weight * by_n * by_n;
        });
        change > DENT
    }
}

/// Those that creep, with a surface that recovers so.
pub(super) fn creeping(families: &[Family]) -> Vec<Family> {
    let own = families.iter();
    own.filter_map(|family| family.creeping()).collect()
}

/// Whether the law of an estimate was touched again before it had recovered, so that its surface was not where a recursion
/// takes it to be: where a dent that fills by creep alone explains the log better.
pub fn is_dented(log: &UniformLog, estimation: &Estimation) -> bool {
    let seen = || {
        let family = Family::of_estimation(estimation)?.with_probe();
        let seen = Seen::of_estimation(log, estimation)?;
        Some((family, seen.course(0.0)?, seen))
    };
    if estimation.outcome.touches.len() < 2 || !estimation.outcome.law.law().info().relaxes {
        return false;
    }
    let Some((family, course, seen)) = seen() else {
        return false;
    };
    let own = candidates(&course, &[family], &seen.fixed);
    if !own.iter().any(|own| course.leaves_a_dent(own)) {
        return false;
    }
    let families: Vec<Family> = [family].into_iter().chain(family.creeping()).collect();
    let both = candidates(&course, &families, &seen.fixed);
    let score = |family: Family| {
        let own = both.iter().find(|own| own.fit.family == family);
        own.map(|own| own.score)
    };
    let gained = score(family).zip(family.creeping().and_then(score));
    gained.is_some_and(|(with_probe, creeping)| with_probe - creeping > EVIDENT)
}
