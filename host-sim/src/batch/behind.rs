//! The fit behind the low-pass that a force went through before it was logged.
//!
//! A law behind a filter is fitted where the noise at rest shows one and more than noise is left without; it is the answer
//! where less is left with it. How far the parameters would go behind another kind of filter that leaves as little is among
//! their standard errors. (To look for a filter wherever no law explains a force took 10 to 40 times as long on measured
//! records, and found 2 more of 120.)

use super::assemble::Given;
use super::course::Course;
use super::filtered::{Filtered, filtered, tuned};
use super::fit::STILL;
use super::options::Options;
use super::result::Batch;
use super::select::{Candidate, Fixed};
use crate::estimate::delay_s;

/// A low-pass is one if it leaves less than this share of what is left without it.
const LESS: f64 = 0.95;
/// The laws are compared so often at most, each time behind the corner that suits the best of them.
const MOST_TURNS: usize = 4;
/// Where a corner is looked for, of where the noise shows it: what a sample is rounded to hides a low one, and 20 Hz were told
/// as 11.
const ELSEWHERE: [f64; 3] = [1.0, 2.0, 0.5];
/// Another kind that leaves at most so many times as much may be it.
const RIVAL: f64 = 1.3;
/// Kelvin and Voigt's law tells a delay from a damper only at its bends: what a kind of filter that is none of these differs in
/// delay, of its own. One after Bessel was found as one of order 4 after Butterworth, and 8.1 ± 0.06 N s/m were 9.6.
const OF_ITS_DELAY: f64 = 0.2;

impl Given<'_> {
    /// The fit behind a low-pass, in place of one without.
    pub(super) fn behind_low_pass(
        &self,
        fitted: &Batch,
        empty: &Batch,
        options: &Options,
        fixed: &Fixed,
    ) -> Option<Batch> {
        let shown_hz = self.log.low_pass_hz?;
        let without_n = fitted.force_rmse_n?;
        if without_n <= fitted.allowed_n {
            return None;
        }
        let corners_hz = ELSEWHERE.map(|share| share * shown_hz);
        // A delay is the filter's.
        let fixed = &Fixed {
            without_skew: true,
            ..fixed.clone()
        };
        let fine = self.course.low_passed(self.log, self.motion, corners_hz[0]);
        let kinds = filtered(
            &fine,
            &options.families,
            fixed,
            &corners_hz,
            (fitted.noise_n, without_n),
        );
        let (mut found, others) = kinds.split_first().map(|(own, others)| (*own, others))?;
        for _ in 0..MOST_TURNS {
            let course = fine.behind(found.low_pass);
            let given = self.behind(&course, found);
            let tried = given.tried(options, fixed);
            let best = given.best(&tried, fixed)?;
            let (turned, _) = tuned(&fine, found.low_pass, best.clone(), fixed)?;
            if turned.is_at(&found) {
                let mut own = given.told(empty.clone(), best, &tried, options, fixed);
                given.widen_by_kinds(&mut own, best, others, fixed);
                return (own.force_rmse_n? < LESS * without_n).then_some(own);
            }
            found = turned;
        }
        None
    }

    /// What may delay a force (s) besides what a fit has.
    pub(super) fn unknown_delay_s(&self) -> f64 {
        match self.filtered {
            Some(own) => OF_ITS_DELAY * own.low_pass.delay_s(),
            None => delay_s(self.log).unwrap_or(0.0),
        }
    }

    fn behind<'a>(&'a self, course: &'a Course, filtered: Filtered) -> Given<'a> {
        Given {
            course,
            filtered: Some(filtered),
            // A force that was passed forth and back leaves its baseline before the surface.
            departure: None,
            ..*self
        }
    }

    /// Adds how far the parameters of a law would go behind other kinds of filters that leave as little.
    fn widen_by_kinds(
        &self,
        own: &mut Batch,
        best: &Candidate,
        others: &[Filtered],
        fixed: &Fixed,
    ) {
        let least_n = self.rmse(best);
        for other in others {
            let course = self.course.behind(other.low_pass);
            let given = self.behind(&course, *other);
            let stay = fixed.of(best.fit.family, &course.scales);
            let candidate = Candidate {
                fit: given.problem(best, &stay).fit(best.fit.free.clone(), STILL),
                ..best.clone()
            };
            if given.rmse(&candidate) > RIVAL * least_n {
                continue;
            }
            for parameter in given.parameters(&candidate, fixed) {
                let both = own.value(parameter.name).zip(parameter.estimate);
                if let Some((own_value, there)) = both {
                    own.widen(parameter.name, own_value.value - there.value);
                }
            }
        }
    }
}
