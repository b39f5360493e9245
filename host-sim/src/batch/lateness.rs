//! How late the force is read against the position, under the law that a log was estimated with.
//!
//! A delay τ of the force shifts the law's force by −τḞ; the other parameters can carry a part of that, the
//! damping of Kelvin–Voigt nearly all of it. So τ is estimated together with them: the law is fitted, and the
//! residuals are regressed on −Ḟ after everything that the parameters can do is taken off it,
//! d⊥ = d − J(JᵀWJ)⁻¹JᵀWd. The step is taken by shifting the motion of the log and fitting again, so that no
//! lateness is too large for a linear step. The standard error is that of Newey and West, and what an encoder's counts
//! may do: where a stroke turns its position reads the same for a while, and alike in every touch.
//!
//! **Delay or lag.** A lag T of first order leaves F − TḞ + T²F̈, a delay τ F − τḞ + ½τ²F̈. After the motion has
//! been shifted by τ a delay leaves nothing, and a lag ½τ²F̈, again less what the parameters can do. Where the
//! errors allow both, neither is said.

use std::borrow::Cow;
use std::ops::Range;

use estimator_core::estimate::{Estimated, config::Surface};

use super::blocks::Node;
use super::course::Course;
use super::family::Family;
use super::fit::{Problem, STILL};
use super::held::Held;
use super::natural::natural;
use super::regression::Regression;
use super::select::{Fixed, candidates};
use super::thresholds::Thresholds;
use super::weights::mask_surface;
use crate::estimate::{EXPLAINED, Estimation, Form, Lateness};
use crate::kinematics::{Kinematics, kinematics};
use crate::log::UniformLog;

/// Most shifts of the motion. From 3 ms of skew at 1 kHz two are enough; a damper whose force is 5 ms late took five, since
/// only where a stroke turns it shows.
const MOST_SHIFTS: usize = 8;
/// A shift by less than this share of its standard error is the last.
const SETTLED: f64 = 0.1;
/// Longest lateness (s): a longer one is another motion.
const LONGEST_S: f64 = 0.05;
/// No converter reads a force so much (s) before the position: those of the fault table differ by up to 3 ms.
const EARLIEST_S: f64 = 5e-3;
/// A late force leaves less than a relaxation below this share of what that leaves: of two laws within 2 % the simpler one is
/// taken, and a lateness is no simpler.
const LESS: f64 = 0.98;
/// When within a sample a motion turned is known to this share of one, and Kelvin and Voigt's law tells a lateness where it
/// turns: with turns on samples a force that was not late came 620 ± 160 µs late, at 1 kHz.
const OF_A_SAMPLE: f64 = 0.29;
/// A slope on F̈ that is so many of its standard errors from that of a delay, or of a lag, excludes it.
const FORM_SIGMAS: f64 = 3.0;
/// So much of a log from its first touch on (s) tells a lateness: 17 s of palpating gel give it a standard error of
/// 11 µs, and what matters is 50 µs. Of an hour the motion alone would be 350 MB.
const LONG_ENOUGH_S: f64 = 120.0;

/// Estimates how late the force is. `None` where that cannot be told: no contact, or a law that does not
/// explain the force whatever the lateness.
pub fn lateness(log: &UniformLog, estimation: &Estimation) -> Option<Lateness> {
    if estimation.outcome.skew.is_some() {
        return None;
    }
    let family = Family::of_estimation(estimation)?;
    Seen::of_estimation(log, estimation)?.lateness(family)
}

/// Whether a late force under Kelvin and Voigt's law explains a log better than the relaxation that it was estimated with.
pub(super) fn is_late_instead(log: &UniformLog, estimation: &Estimation) -> bool {
    let relaxing = Family::of_estimation(estimation).filter(|family| family.modes > 0);
    let late =
        relaxing.and_then(|family| Seen::of_estimation(log, estimation)?.late_instead(family));
    late.is_some()
}

fn fixed_as(estimation: &Estimation) -> Fixed {
    let known = match estimation.replay.config.contact.surface {
        Surface::Known { position_m } => Some(f64::from(position_m)),
        Surface::AtImpact => None,
    };
    Fixed {
        held: Held {
            fixed: known.map(|at| ("surface".into(), at)).into_iter().collect(),
            ..Held::default()
        },
        ..Fixed::default()
    }
}

/// The beginning of a long log from its first touch on, and the touches in it; the whole of another.
fn part(
    log: &UniformLog,
    touches: Vec<Range<usize>>,
) -> Option<(Cow<'_, UniformLog>, Vec<Range<usize>>)> {
    let end = touches.first()?.start + (LONG_ENOUGH_S * log.rate_hz) as usize;
    if end >= log.len() {
        return Some((Cow::Borrowed(log), touches));
    }
    let inside = touches.into_iter().filter(|touch| touch.end <= end);
    Some((Cow::Owned(log.first(end)), inside.collect()))
}

/// What a lateness is told from.
pub(super) struct Seen<'a> {
    log: Cow<'a, UniformLog>,
    touches: Vec<Range<usize>>,
    motion: Kinematics,
    pub(super) fixed: Fixed,
}

impl<'a> Seen<'a> {
    /// A log with its touches, and what of a law is fixed.
    pub(super) fn of(
        log: &'a UniformLog,
        touches: Vec<Range<usize>>,
        fixed: Fixed,
    ) -> Option<Seen<'a>> {
        let (log, touches) = part(log, touches)?;
        Some(Seen {
            motion: kinematics(&log).completed(),
            log,
            touches,
            fixed: Fixed {
                without_skew: true,
                ..fixed
            },
        })
    }

    pub(super) fn of_estimation(
        log: &'a UniformLog,
        estimation: &'a Estimation,
    ) -> Option<Seen<'a>> {
        let contacts = estimation.replay.contacts();
        Seen::of(estimation.log(log), contacts, fixed_as(estimation))
    }

    /// How late the force is under a law.
    pub(super) fn lateness(&self, family: Family) -> Option<Lateness> {
        let (late, _) = self.under(family).lateness()?;
        Some(late)
    }

    /// How late the force is under Kelvin and Voigt's law, where that leaves less than the relaxation of another law does: a
    /// damper whose force is read 5 ms late is nearly a relaxation of 11 ms, and 1000 N/m were 1486 ± 16.
    pub(super) fn late_instead(&self, family: Family) -> Option<Lateness> {
        if family.modes == 0 {
            return None;
        }
        let (late, left) = self.under(Family::KELVIN_VOIGT).lateness()?;
        late.reason()?;
        let relaxing = self.under(family).left_punctually()?;
        (left < LESS * relaxing).then_some(late)
    }

    /// The course of the log with the motion of an earlier instant.
    pub(super) fn course(&self, late_s: f64) -> Option<Course> {
        let motion = self.motion.delayed(late_s / self.log.period_s());
        Course::of(
            &self.log,
            &motion,
            self.touches.clone(),
            Thresholds::default(),
        )
    }

    fn under(&self, family: Family) -> Search<'_> {
        Search { seen: self, family }
    }
}

/// The search for a lateness under a law.
struct Search<'a> {
    seen: &'a Seen<'a>,
    family: Family,
}

impl Search<'_> {
    /// The best fit of the law to a course.
    fn fitted(&self, course: &Course) -> Option<Vec<f64>> {
        let mut candidates = candidates(course, &[self.family], &self.seen.fixed);
        Some(candidates.pop()?.fit.free)
    }

    /// Root mean square of what the law leaves over the noise if the force is not late.
    fn left_punctually(&self) -> Option<f64> {
        let course = self.seen.course(0.0)?;
        let one = Shifted::new(self, &course, self.fitted(&course)?);
        Some(one.problem(&course).remainder(&one.free))
    }

    /// How late the force is, and root mean square of what the law then leaves over the noise.
    fn lateness(&self) -> Option<(Lateness, f64)> {
        let turned_s = match self.family {
            Family::KELVIN_VOIGT => OF_A_SAMPLE * self.seen.log.period_s(),
            _ => 0.0,
        };
        let mut late_s = 0.0;
        let mut free: Option<Vec<f64>> = None;
        for _ in 0..MOST_SHIFTS {
            let course = self.seen.course(late_s)?;
            let fit = match free.take() {
                None => self.fitted(&course)?,
                Some(free) => free,
            };
            let one = Shifted::new(self, &course, fit);
            let remainder = one.problem(&course).remainder(&one.free);
            let found = one.regression(&course, 1)?;
            let std_error = found.std_error.hypot(turned_s);
            if found.slope.abs() < SETTLED * std_error {
                let form = one.form(&course, late_s);
                let value = late_s + found.slope;
                let late_s = Estimated { value, std_error };
                let is_told = remainder <= EXPLAINED && !self.is_a_mode(late_s.value);
                return is_told.then_some((Lateness { late_s, form }, remainder));
            }
            late_s += found.slope;
            if late_s.abs() > LONGEST_S {
                return None;
            }
            free = Some(one.free);
        }
        None
    }

    /// Whether an early force is one more mode of a law that relaxes: what relaxes as a power of time was 20 ms early
    /// under two of eight modes.
    fn is_a_mode(&self, late_s: f64) -> bool {
        self.family.modes > 0 && late_s < -EARLIEST_S
    }
}

/// A fit on the course of a shifted motion.
struct Shifted<'a> {
    search: &'a Search<'a>,
    stay: Vec<usize>,
    weights: Vec<f64>,
    free: Vec<f64>,
}

impl<'a> Shifted<'a> {
    fn new(search: &'a Search<'a>, course: &Course, start: Vec<f64>) -> Shifted<'a> {
        let mut shifted = Shifted {
            search,
            stay: search.seen.fixed.of(search.family, &course.scales),
            weights: course.noise_weights(),
            free: start,
        };
        let fit = shifted.problem(course).fit(shifted.free.clone(), STILL);
        if search.family == Family::KELVIN_VOIGT {
            mask_surface(&mut shifted.weights, course, &fit);
        }
        shifted.free = fit.free;
        shifted
    }

    fn problem<'b>(&'b self, course: &'b Course) -> Problem<'b> {
        Problem {
            family: self.search.family,
            nodes: &course.nodes,
            weights: &self.weights,
            scales: &course.scales,
            fixed: &self.stay,
        }
    }

    /// Residuals on −Ḟ (order 1) or F̈ (order 2).
    fn regression(&self, course: &Course, order: usize) -> Option<Regression> {
        let column = self.derivative(course, order);
        let problem = self.problem(course);
        problem.regression(&self.free, &column, &self.errors_of_counts(course))
    }

    /// What the error of a count, which stays for as long as the position reads the same, does to the force (N) at every
    /// node that counts; 0 where the position has no counts.
    fn errors_of_counts(&self, course: &Course) -> Vec<f64> {
        let error_m = course.scales.position_noise_m;
        let read = self.counting(course, &self.forces(course, |node| *node));
        let off = self.counting(course, &self.forces(course, |node| node.deeper(error_m)));
        let nodes = course.nodes.iter().zip(&self.weights);
        let counting = nodes.filter(|(_, weight)| **weight > 0.0);
        let each = counting.zip(read.iter().zip(off));
        each.map(|((node, _), (read, off))| match node.held > 1.0 {
            true => off - read,
            false => 0.0,
        })
        .collect()
    }

    /// Force (N) of the law at every node, with its motion as `seen`.
    fn forces(&self, course: &Course, seen: impl Fn(&Node) -> Node) -> Vec<f64> {
        let nodes: Vec<Node> = course.nodes.iter().map(seen).collect();
        let law = natural(self.search.family, &self.free, &course.scales);
        let mut forces = Vec::with_capacity(nodes.len());
        law.along(self.search.family, &nodes, |_, force| forces.push(force));
        forces
    }

    /// Those of the nodes that count.
    fn counting(&self, course: &Course, all: &[f64]) -> Vec<f64> {
        debug_assert_eq!(course.nodes.len(), all.len());
        let each = all.iter().zip(&self.weights);
        each.filter(|(_, weight)| **weight > 0.0)
            .map(|(own, _)| *own)
            .collect()
    }

    /// Which of the two the residuals are those of: a slope of 0 on F̈ is a delay's, and of ½τ² a lag's.
    fn form(&self, course: &Course, late_s: f64) -> Form {
        let of_lag = 0.5 * late_s * late_s;
        if late_s < 0.0 {
            return Form::Delay;
        }
        let Some(found) = self.regression(course, 2) else {
            return Form::Either;
        };
        let within = FORM_SIGMAS * found.std_error;
        match (found.slope > within, of_lag - found.slope > within) {
            (true, _) if 2.0 * found.slope > of_lag => Form::Lag,
            (_, true) => Form::Delay,
            _ => Form::Either,
        }
    }

    /// −Ḟ (N/s) or F̈ (N/s²) of the law at every node that counts, by differences of a shifted motion.
    fn derivative(&self, course: &Course, order: usize) -> Vec<f64> {
        let step_s = course.scales.period_s;
        let force =
            |shift_s: f64| self.counting(course, &self.forces(course, |node| node.at(shift_s)));
        let (before, now, after) = (force(-step_s), force(0.0), force(step_s));
        let each = before.iter().zip(&now).zip(&after);
        each.map(|((before, now), after)| match order {
            1 => (before - after) / (2.0 * step_s),
            _ => (before - 2.0 * now + after) / (step_s * step_s),
        })
        .collect()
    }
}

impl Node {
    /// The node with its motion a little later or earlier.
    fn at(&self, shift_s: f64) -> Node {
        let bend = self.acceleration_mps2 * shift_s;
        Node {
            position_m: self.position_m + (self.speed_mps + 0.5 * bend) * shift_s,
            speed_mps: self.speed_mps + bend,
            ..*self
        }
    }

    /// The node so much (m) deeper.
    fn deeper(&self, by_m: f64) -> Node {
        Node {
            position_m: self.position_m + by_m,
            ..*self
        }
    }
}
