//! Non-linear least squares of a rig to courses: Levenberg–Marquardt within bounds, exact gradients.
//!
//! A kept crate has neither bounds nor the block-wise gradients of dual numbers: the Jacobian is
//! filled eight columns at a time by the rig itself, run over the whole log.

use estimator_core::maths::{Dual, Scalar};
use estimator_core::physics::effect::{EffectId, Motion};
use estimator_core::physics::rig::Reading;

use crate::dense;
use crate::gap::data::fit_data::Course;
use crate::gap::data::low_pass::LowPass;
use crate::gap::data::scales::Scales;
use crate::gap::model::shape::{Shape, Term};

/// Most steps of a fit.
pub(in crate::gap) const MOST_STEPS: usize = 40;
/// Converged: a step promises less than this share of Σ w r², or less than `STILL` of it.
const LEAST_SHARE: f64 = 3e-5;
/// 1 is worth one standard error.
const STILL: f64 = 1e-4;
/// Columns of the Jacobian per run.
const LANES: usize = 8;

/// What is fitted to what.
#[derive(Clone, Copy, Debug)]
pub(in crate::gap) struct Problem<'a> {
    pub(in crate::gap) courses: &'a [Course],
    /// 1/N² per sample, log after log; 0 leaves a sample out.
    pub(in crate::gap) weights: &'a [f64],
    /// What residuals and gradients go through, as the courses' force has.
    pub(in crate::gap) low_pass: Option<LowPass>,
}

/// A minimum.
#[derive(Clone, Debug)]
pub(in crate::gap) struct Fit {
    pub(in crate::gap) shape: Shape,
    pub(in crate::gap) numbers: Vec<f64>,
    /// Σ w r².
    pub(in crate::gap) cost: f64,
}

impl Fit {
    /// Which of its terms the base model does not have.
    pub(in crate::gap) fn added(&self) -> Vec<usize> {
        (0..self.shape.terms.len())
            .filter(|at| !self.shape.terms[*at].given)
            .collect()
    }

    /// The law with other terms, and where a fit of them starts: the environment as it stands here.
    pub(in crate::gap) fn with_terms(
        &self,
        terms: Vec<Term>,
        scales: &Scales,
    ) -> (Shape, Vec<f64>) {
        let shape = Shape::new(&self.shape.base, terms, scales);
        let mut start = shape.start();
        let environment = shape.environment_count();
        start[..environment].copy_from_slice(&self.numbers[..environment]);
        (shape, start)
    }

    /// The same without one of its terms.
    pub(in crate::gap) fn without(&self, at: usize, scales: &Scales) -> (Shape, Vec<f64>) {
        let mut terms = self.shape.terms_at(&self.numbers);
        terms.remove(at);
        self.with_terms(terms, scales)
    }
}

/// A linearisation: residuals (N), and the force's derivatives, a column per free number.
pub(in crate::gap) struct Linear {
    pub(in crate::gap) residuals: Vec<f64>,
    pub(in crate::gap) columns: Vec<Vec<f64>>,
}

/// The force (N) of a rig along a course, sample by sample.
pub(in crate::gap) fn along<S: Scalar>(
    shape: &Shape,
    numbers: &[S],
    course: &Course,
    mut each: impl FnMut(usize, Reading<S>),
) {
    let rig = shape.rig(numbers);
    let mut state = rig.at_rest();
    let delay = rig.delay_s();
    let is_delay = |term: &Term| term.id == EffectId::TimeDelay;
    let delayed = shape.terms.iter().any(is_delay);
    for at in 0..course.len() {
        let motion = if delayed {
            course.delayed(at, delay)
        } else {
            course.motion(at)
        };
        each(
            at,
            rig.step(&mut state, motion, S::from_f64(course.step_s(at))),
        );
    }
}

impl Course {
    fn motion<S: Scalar>(&self, at: usize) -> Motion<S> {
        Motion {
            time_s: S::from_f64(self.time_s[at]),
            position_m: S::from_f64(self.position_m[at]),
            speed_mps: S::from_f64(self.speed_mps[at]),
            acceleration_mps2: S::from_f64(self.acceleration_mps2[at]),
        }
    }

    /// The motion a delay before a block: the cubic through positions and speeds of its neighbours.
    fn delayed<S: Scalar>(&self, at: usize, delay: S) -> Motion<S> {
        let period_s = self.step_s(at);
        let back = delay.to_f64() / period_s;
        let place = (at as f64 - back).clamp(0.0, (self.len() - 1) as f64);
        let first = (place.floor() as usize).min(self.len().saturating_sub(2));
        let second = (first + 1).min(self.len() - 1);
        let share = place - first as f64;
        let mix = |channel: &[f64]| channel[first] + share * (channel[second] - channel[first]);
        let (x0, x1) = (self.position_m[first], self.position_m[second]);
        let slopes = (
            self.speed_mps[first] * period_s,
            self.speed_mps[second] * period_s,
        );
        let (a, b) = (slopes.0 - (x1 - x0), (x1 - x0) - slopes.1);
        let position =
            mix(&self.position_m) + share * (1.0 - share) * ((1.0 - share) * a + share * b);
        let (speed, acceleration) = (mix(&self.speed_mps), mix(&self.acceleration_mps2));
        // The part of the delay that is a derivative, and nothing else.
        let further = delay - S::from_f64(delay.to_f64());
        let number = S::from_f64;
        Motion {
            time_s: number(self.time_s[at]) - delay,
            position_m: number(position) - further * number(speed),
            speed_mps: number(speed) - further * number(acceleration),
            acceleration_mps2: number(acceleration),
        }
    }
}

/// Forces (N) of free numbers, log after log.
pub(in crate::gap) fn forces(shape: &Shape, numbers: &[f64], courses: &[Course]) -> Vec<f64> {
    let mut forces = Vec::with_capacity(courses.iter().map(Course::len).sum());
    for course in courses {
        along(shape, numbers, course, |_, reading| {
            forces.push(reading.force_n)
        });
    }
    forces
}

/// The same if the motion were another.
pub(in crate::gap) fn forces_moved(
    shape: &Shape,
    numbers: &[f64],
    courses: &[Course],
    change: impl FnMut(&mut Course),
) -> Vec<f64> {
    let mut moved = courses.to_vec();
    moved.iter_mut().for_each(change);
    forces(shape, numbers, &moved)
}

impl Problem<'_> {
    /// Σ w r².
    pub(in crate::gap) fn cost(&self, shape: &Shape, numbers: &[f64]) -> f64 {
        self.weighted_square(&self.residuals(shape, numbers))
    }

    /// Measured minus predicted force (N), log after log.
    pub(in crate::gap) fn residuals(&self, shape: &Shape, numbers: &[f64]) -> Vec<f64> {
        let forces = self.forces(shape, numbers).into_iter();
        let measured = self.courses.iter().flat_map(|course| &course.force_n);
        forces
            .zip(measured)
            .map(|(force, measured)| measured - force)
            .collect()
    }

    pub(in crate::gap) fn linear(&self, shape: &Shape, numbers: &[f64]) -> Linear {
        let count = self.weights.len();
        let mut linear = Linear {
            residuals: vec![0.0; count],
            columns: vec![vec![0.0; count]; numbers.len()],
        };
        let mut from = 0;
        while from < numbers.len().max(1) {
            match numbers.len() - from {
                0..=4 => self.lanes::<4>(shape, numbers, from, &mut linear),
                _ => self.lanes::<LANES>(shape, numbers, from, &mut linear),
            }
            from += LANES;
        }
        if self.low_pass.is_some() {
            // The courses' force has been filtered already: filter the prediction alone.
            let forces = self.forces(shape, numbers);
            let measured = self.courses.iter().flat_map(|course| &course.force_n);
            let residuals = linear.residuals.iter_mut().zip(measured).zip(&forces);
            residuals.for_each(|((own, measured), force)| *own = measured - force);
            linear
                .columns
                .iter_mut()
                .for_each(|column| self.filter(column));
        }
        linear
    }

    /// Forces (N), log after log, as the courses' force was filtered.
    pub(in crate::gap) fn forces(&self, shape: &Shape, numbers: &[f64]) -> Vec<f64> {
        let mut forces = forces(shape, numbers, self.courses);
        self.filter(&mut forces);
        forces
    }

    fn filter(&self, channel: &mut [f64]) {
        let Some(low_pass) = self.low_pass else {
            return;
        };
        let mut from = 0;
        for course in self.courses {
            low_pass.apply(&mut channel[from..from + course.len()], course.period_s);
            from += course.len();
        }
    }

    fn lanes<const N: usize>(
        &self,
        shape: &Shape,
        numbers: &[f64],
        from: usize,
        linear: &mut Linear,
    ) {
        let dual: Vec<Dual<f64, N>> = numbers
            .iter()
            .enumerate()
            .map(|(at, value)| match at.checked_sub(from) {
                Some(lane) if lane < N => Dual::parameter(*value, lane),
                _ => Dual::constant(*value),
            })
            .collect();
        let mut row = 0;
        for course in self.courses {
            along(shape, &dual, course, |at, reading| {
                let force = reading.force_n;
                linear.residuals[row] = course.force_n[at] - force.value;
                for (column, slope) in linear.columns[from..].iter_mut().zip(force.gradient) {
                    // A law's corner may have no slope; it then says nothing.
                    column[row] = if slope.is_finite() { slope } else { 0.0 };
                }
                row += 1;
            });
        }
    }

    /// JᵀWJ and JᵀWr.
    pub(in crate::gap) fn normal(&self, linear: &Linear) -> (Vec<f64>, Vec<f64>) {
        let n = linear.columns.len();
        let weighted: Vec<Vec<f64>> = linear
            .columns
            .iter()
            .map(|column| {
                column
                    .iter()
                    .zip(self.weights)
                    .map(|(j, w)| j * w)
                    .collect()
            })
            .collect();
        let mut curvature = vec![0.0; n * n];
        let mut downhill = vec![0.0; n];
        for row in 0..n {
            downhill[row] = dot(&weighted[row], &linear.residuals);
            for column in 0..=row {
                let entry = dot(&weighted[row], &linear.columns[column]);
                curvature[row * n + column] = entry;
                curvature[column * n + row] = entry;
            }
        }
        (curvature, downhill)
    }

    /// Walks from `start` to a minimum within the bounds of the shape.
    pub(in crate::gap) fn fit(&self, shape: &Shape, start: Vec<f64>) -> Fit {
        self.walk(shape, start, MOST_STEPS)
    }

    /// So many steps towards one.
    pub(in crate::gap) fn walk(&self, shape: &Shape, start: Vec<f64>, most_steps: usize) -> Fit {
        let mut numbers = start;
        let mut damping = 1e-3;
        let mut linear = self.linear(shape, &numbers);
        let mut cost = self.weighted_square(&linear.residuals);
        let (mut curvature, mut downhill) = self.normal(&linear);
        let mut steps = 0;
        while steps < most_steps {
            let blocked = blocked(shape, &numbers, &downhill);
            let (step, promised) = step(&curvature, &downhill, &blocked, damping);
            if promised <= STILL.max(LEAST_SHARE * cost) {
                break;
            }
            let moved = moved(shape, &numbers, &step);
            let new_cost = self.cost(shape, &moved);
            steps += 1;
            if new_cost < cost {
                let gained = (cost - new_cost) / promised;
                damping *= if gained > 0.75 { 0.1 } else { 0.5 };
                numbers = moved;
                linear = self.linear(shape, &numbers);
                cost = self.weighted_square(&linear.residuals);
                (curvature, downhill) = self.normal(&linear);
            } else if damping > 1e6 {
                break;
            } else {
                damping = (damping * 10.0).max(1e-5);
            }
        }
        Fit {
            shape: shape.clone(),
            numbers,
            cost,
        }
    }

    pub(in crate::gap) fn weighted_square(&self, residuals: &[f64]) -> f64 {
        let cost: f64 = residuals
            .iter()
            .zip(self.weights)
            .map(|(r, w)| w * r * r)
            .sum();
        if cost.is_finite() { cost } else { f64::MAX }
    }
}

/// Σ aᵢbᵢ in four strands.
pub(in crate::gap) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 4];
    let (long, rest) = (a.len() / 4 * 4, a.len().min(b.len()));
    for (x, y) in a[..long].chunks_exact(4).zip(b[..long].chunks_exact(4)) {
        for lane in 0..4 {
            sums[lane] += x[lane] * y[lane];
        }
    }
    let tail: f64 = (long..rest).map(|at| a[at] * b[at]).sum();
    sums.iter().sum::<f64>() + tail
}

/// Free numbers at a bound that the gradient pushes against.
pub(in crate::gap) fn blocked(shape: &Shape, numbers: &[f64], downhill: &[f64]) -> Vec<bool> {
    let each = shape.free.iter().zip(numbers).zip(downhill);
    each.map(|((free, number), down)| {
        (*number <= free.lowest && *down < 0.0) || (*number >= free.highest && *down > 0.0)
    })
    .collect()
}

/// Numbers after a step, within bounds; a logarithm moves by a factor of 7 at most, and one that
/// would pass its bound goes nine tenths of the way there.
fn moved(shape: &Shape, numbers: &[f64], step: &[f64]) -> Vec<f64> {
    let each = shape.free.iter().zip(numbers).zip(step);
    each.map(|((free, number), step)| {
        let step = if free.logarithmic {
            step.clamp(-2.0, 2.0)
        } else {
            *step
        };
        (number + step).clamp(free.lowest, free.highest)
    })
    .collect()
}

/// The step of damped normal equations without the blocked numbers, and what it promises.
fn step(curvature: &[f64], downhill: &[f64], blocked: &[bool], damping: f64) -> (Vec<f64>, f64) {
    let n = downhill.len();
    let mut damping = damping;
    let right: Vec<f64> = (0..n)
        .map(|i| if blocked[i] { 0.0 } else { downhill[i] })
        .collect();
    loop {
        // In units of the columns' own sizes, so that one ridge suits all.
        let size: Vec<f64> = (0..n)
            .map(|i| curvature[i * n + i].max(f64::MIN_POSITIVE).sqrt())
            .collect();
        let mut scaled: Vec<f64> = (0..n * n)
            .map(|at| {
                let (row, column) = (at / n, at % n);
                if blocked[row] || blocked[column] {
                    0.0
                } else {
                    curvature[at] / (size[row] * size[column])
                }
            })
            .collect();
        for i in 0..n {
            scaled[i * n + i] = 1.0 + damping + 1e-12;
        }
        if let Some(factor) = dense::cholesky(&scaled, n) {
            let right: Vec<f64> = right.iter().zip(&size).map(|(g, s)| g / s).collect();
            let mut step = dense::solve(&factor, n, &right);
            for (at, own) in step.iter_mut().enumerate() {
                *own = if blocked[at] || curvature[at * n + at] <= 0.0 {
                    0.0
                } else {
                    *own / size[at]
                };
            }
            let along: f64 = step.iter().zip(downhill).map(|(s, g)| s * g).sum();
            let promised = 2.0 * along - dense::quadratic(curvature, &step);
            return (step, promised.max(0.0));
        }
        damping = (damping * 10.0).max(1e-9);
        if damping > 1e12 {
            return (vec![0.0; n], 0.0);
        }
    }
}
