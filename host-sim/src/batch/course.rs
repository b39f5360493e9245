//! What of a log the fit looks at: block means along the motion, each with the number of
//! measurements in it.
//!
//! **Gaps.** Samples that the resampling invented are not measurements. They are left out, and a law
//! with memory gets the straight line between the measurements on either side, which is what they
//! were invented from; where the depth moves within a gap they stay as points without weight.
//!
//! **What no law here has.** On the way out a contact may pull (adhesion), or let go before the depth
//! is zero because the material recovers more slowly than the probe leaves. What a law says there is
//! not what a unilateral contact does, so the samples from where the force has fallen to 3 % of the
//! touch's peak until the probe is out of the material are left out, and counted.

use std::ops::Range;

use super::blocks::{MEAN_HALF_WIDTH, Node, Use, nodes};
use super::low_pass::{Kind, LowPass};
use super::scales::{Scales, scales};
use super::thresholds::{Samples, Thresholds};
use crate::kinematics::Kinematics;
use crate::log::UniformLog;
use crate::stats::{highest, range};

/// A probe moves if it goes this share of the deepest depth.
const STILL: f64 = 0.01;
/// What was touched when a log begins was touched so long ago (s): whatever relaxes has.
const LONG_AGO_S: f64 = 1e9;

/// A log as the fit sees it.
#[derive(Clone, Debug)]
pub(super) struct Course {
    /// Block means in order of time.
    pub(super) nodes: Vec<Node>,
    /// What each sample of the log is good for.
    pub(super) uses: Vec<Use>,
    /// Sizes.
    pub(super) scales: Scales,
    /// Touches as ranges of samples.
    pub(super) touches: Vec<Range<usize>>,
    /// What decides about it.
    pub(super) thresholds: Thresholds,
}

impl Course {
    /// Lays the course of a log over its touches, as ranges of samples; `None` if nothing is touched.
    pub(super) fn of(
        log: &UniformLog,
        motion: &Kinematics,
        touches: Vec<Range<usize>>,
        thresholds: Thresholds,
    ) -> Option<Course> {
        let force_n = moving_mean(&log.force_n);
        let scales = scales(
            log,
            motion,
            &force_n,
            &touches,
            thresholds.samples.firm_touch,
        )?;
        let uses = uses(log, motion, &force_n, &touches, &scales, thresholds.samples);
        let mut course = Course {
            nodes: Vec::new(),
            uses,
            scales,
            touches,
            thresholds,
        };
        course.lay(log, motion);
        Some(course)
    }

    fn lay(&mut self, log: &UniformLog, motion: &Kinematics) {
        self.nodes = nodes(log, motion, &self.uses, &self.scales);
        if self.begins_in_contact() {
            long_ago(&mut self.nodes);
        }
    }

    /// The same of a force that went through a low-pass, which follows what a law does between means.
    pub(super) fn low_passed(
        &self,
        log: &UniformLog,
        motion: &Kinematics,
        corner_hz: f64,
    ) -> Course {
        let any = LowPass::of_power(corner_hz, Kind::butterworth(1, false));
        let mut course = self.behind(any);
        course.lay(log, motion);
        course
    }

    /// The same with another low-pass.
    pub(super) fn behind(&self, low_pass: LowPass) -> Course {
        Course {
            scales: self.scales.behind(low_pass),
            ..self.clone()
        }
    }

    /// Whether the first sample is in contact.
    pub(super) fn begins_in_contact(&self) -> bool {
        self.touches.first().is_some_and(|first| first.start == 0)
    }

    /// Whether the probe moves in free air.
    pub(super) fn approaches(&self) -> bool {
        let free = self.nodes.iter().filter(|node| node.used == Use::Free);
        let positions_m: Vec<f64> = free.map(|node| node.position_m).collect();
        range(&positions_m) > STILL * self.scales.depth_m
    }

    /// Measurements in contact that are left out, and all in contact.
    pub(super) fn left_out(&self, log: &UniformLog) -> (usize, usize) {
        let samples = self.touches.iter().cloned().flatten();
        let measured: Vec<usize> = samples.filter(|at| log.has_force(*at)).collect();
        let out = measured.iter().filter(|at| self.uses[**at] == Use::Out);
        (out.count(), measured.len())
    }

    /// Measurements in free air.
    pub(super) fn free(&self) -> f64 {
        let free = self.nodes.iter().filter(|node| node.used == Use::Free);
        free.map(|node| node.count).sum()
    }
}

/// What the first node touches was touched long ago.
pub(super) fn long_ago(nodes: &mut [Node]) {
    if let Some(first) = nodes.first_mut() {
        first.period_s = LONG_AGO_S;
    }
}

fn moving_mean(channel: &[f64]) -> Vec<f64> {
    let around = |at: usize| {
        let from = at.saturating_sub(MEAN_HALF_WIDTH);
        &channel[from..(at + MEAN_HALF_WIDTH + 1).min(channel.len())]
    };
    (0..channel.len())
        .map(|at| around(at).iter().sum::<f64>() / around(at).len() as f64)
        .collect()
}

fn uses(
    log: &UniformLog,
    motion: &Kinematics,
    force_n: &[f64],
    touches: &[Range<usize>],
    scales: &Scales,
    decide: Samples,
) -> Vec<Use> {
    let mut uses = vec![Use::Free; log.len()];
    let mean_noise = scales.noise_n / ((2 * MEAN_HALF_WIDTH + 1) as f64).sqrt();
    for (number, touch) in touches.iter().enumerate() {
        let peak = highest(force_n[touch.clone()].iter().copied()) - scales.rest_n;
        let let_go =
            scales.rest_n + (decide.released_force * peak).max(decide.contact_sigmas * mean_noise);
        if touch.len() == log.len() {
            // It never lets go.
            uses.fill(Use::Contact(number));
            break;
        }
        let mut gone_in = false;
        for at in touch.clone() {
            let pressed = force_n[at] >= let_go;
            gone_in |= pressed;
            uses[at] = if pressed || !gone_in {
                Use::Contact(number)
            } else {
                Use::Out
            };
        }
        let next = touches.get(number + 1).map_or(log.len(), |next| next.start);
        let pulls = |at: usize| force_n[at] < scales.rest_n - decide.contact_sigmas * mean_noise;
        let out_m = scales.touch_m - decide.outside_depth * scales.depth_m;
        let out = (touch.end..next).find(|at| motion.position_m[*at] < out_m && !pulls(*at));
        let out = out.unwrap_or_else(|| {
            // It never left: the way in again begins where it was farthest out.
            let farthest = (touch.end..next)
                .min_by(|a, b| motion.position_m[*a].total_cmp(&motion.position_m[*b]));
            farthest.unwrap_or(touch.end)
        });
        uses[touch.end..out].fill(Use::Out);
    }
    uses
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::{Choices, setup};
    use crate::kinematics::kinematics;
    use crate::log::Log;
    use estimator_core::Config;
    use estimator_core::estimate::method::Method;

    /// 1 s of rest, 0.1 s to 2 mm into 2 N/mm, a hold, and back; the release pulls with 0.5 N.
    fn course(hold_s: f64, rate_hz: f64) -> (UniformLog, Course) {
        let end_s = 1.4 + hold_s;
        let time: Vec<f64> = (0..((end_s + 1.0) * rate_hz) as usize)
            .map(|i| i as f64 / rate_hz)
            .collect();
        let depth = |t: f64| 0.02 * (t - 1.0).clamp(0.0, 0.15) - 0.02 * (t - end_s).clamp(0.0, 0.2);
        let x: Vec<f64> = time.iter().map(|t| depth(*t) - 1e-3).collect();
        let force = |(t, x): (&f64, &f64)| {
            let pulls = *x < 1e-4 && *x > -4e-4 && *t > end_s;
            if pulls { -0.5 } else { 2000.0 * x.max(0.0) }
        };
        let f = time.iter().zip(&x).map(force);
        // A step of 1 mN, so that there is a noise.
        let f = f.map(|f| (f / 1e-3).round() * 1e-3).collect();
        let log = Log::from_channels(time, x, f).uniform().unwrap();
        let config = setup(
            &log,
            Config::default(),
            Method::KELVIN_VOIGT,
            Choices::default(),
        )
        .config;
        let replay = crate::replay::replay(&log, &config).unwrap();
        let course = Course::of(
            &log,
            &kinematics(&log),
            replay.contacts(),
            Thresholds::default(),
        )
        .unwrap();
        (log, course)
    }

    #[test]
    fn a_hold_weighs_by_its_logarithm_and_loses_no_sample() {
        // WHEN a hold lasts ten times as long
        let (short, long) = (course(10.0, 1000.0), course(100.0, 1000.0));
        let nodes = |course: &Course| {
            let own = course.nodes.iter();
            own.filter(|node| matches!(node.used, Use::Contact(_)))
                .count()
        };
        let more = nodes(&long.1) - nodes(&short.1);
        // THEN it has 50·ln 10 = 115 blocks more.
        assert!((100..130).contains(&more), "{more}");
        for (log, course) in [short, long] {
            let counted: f64 = course.nodes.iter().map(|node| node.count).sum();
            let used = course.uses.iter().filter(|used| **used != Use::Out).count();
            assert_eq!(counted, used as f64);
            assert_eq!(course.uses.len(), log.len());
        }
    }

    #[test]
    fn what_pulls_on_the_way_out_is_left_out() {
        let (log, course) = course(1.0, 1000.0);
        for (at, used) in course.uses.iter().enumerate() {
            assert!(
                log.force_n[at] > -0.1 || *used == Use::Out,
                "{at}: {used:?}"
            );
        }
        // The rest, the way in and the hold are all there.
        let kept = course.uses.iter().filter(|used| **used != Use::Out).count();
        assert!(
            kept as f64 > 0.95 * log.len() as f64,
            "{kept} of {}",
            log.len()
        );
    }
}
