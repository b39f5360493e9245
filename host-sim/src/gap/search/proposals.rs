//! Where a candidate starts, and what it promises: its force, projected off what the model can do
//! already, against the residuals.

use std::f64::consts::TAU;

use estimator_core::physics::effect::{EffectId, MOST_PARAMETERS, Role, Sign};
use rayon::prelude::*;
use rustfft::FftPlanner;
use rustfft::num_complex::Complex;

use crate::gap::data::scales::Scales;
use crate::gap::model::basis::{extend, remove};
use crate::gap::model::fit::{Fit, Problem, blocked, dot, forces, forces_moved};
use crate::gap::model::shape::{Shape, Term};
use crate::gap::model::start::{is_possible, starts, whole};

/// A candidate with numbers to start from.
#[derive(Clone, Debug)]
pub(in crate::gap) struct Proposal {
    pub(in crate::gap) term: Term,
    /// What it takes off Σ w r², to first order.
    pub(in crate::gap) gain: f64,
}

/// A fit, linearised, and an orthonormal basis of what its numbers can do.
pub(in crate::gap) struct Ground<'a> {
    problem: Problem<'a>,
    fit: &'a Fit,
    scales: &'a Scales,
    forces: Vec<f64>,
    /// √w r, and the basis in the same units.
    residuals: Vec<f64>,
    basis: Vec<Vec<f64>>,
    roots: Vec<f64>,
}

impl<'a> Ground<'a> {
    pub(in crate::gap) fn new(
        problem: Problem<'a>,
        fit: &'a Fit,
        scales: &'a Scales,
    ) -> Ground<'a> {
        let linear = problem.linear(&fit.shape, &fit.numbers);
        let roots: Vec<f64> = problem.weights.iter().map(|w| w.sqrt()).collect();
        let weighted = |column: &[f64]| -> Vec<f64> {
            column.iter().zip(&roots).map(|(c, w)| c * w).collect()
        };
        let (_, downhill) = problem.normal(&linear);
        let blocked = blocked(&fit.shape, &fit.numbers, &downhill);
        let mut basis: Vec<Vec<f64>> = Vec::new();
        // What a bound keeps from moving can do nothing: a damping of 0 that a lag would have negative.
        for (column, _) in linear.columns.iter().zip(&blocked).filter(|own| !own.1) {
            extend(&mut basis, weighted(column), &[]);
        }
        let mut residuals = weighted(&linear.residuals);
        remove(&mut residuals, &basis);
        Ground {
            problem,
            fit,
            scales,
            forces: problem.forces(&fit.shape, &fit.numbers),
            residuals,
            basis,
            roots,
        }
    }

    /// The two best starts of every effect, the best effects first.
    pub(in crate::gap) fn proposals(&self, ids: &[EffectId]) -> Vec<Vec<Proposal>> {
        let mut starts: Vec<Term> = ids
            .iter()
            .flat_map(|id| starts(*id, &self.fit.shape, self.scales))
            .collect();
        starts.extend(self.periodic(ids));
        let mut scored: Vec<Proposal> = starts
            .into_par_iter()
            .map(|term| self.score(term))
            .collect();
        scored.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        let mut ranked: Vec<Vec<Proposal>> = Vec::new();
        for proposal in scored {
            match ranked
                .iter_mut()
                .find(|own| own[0].term.id == proposal.term.id)
            {
                Some(own) if own.len() < 2 => own.push(proposal),
                Some(_) => {}
                None => ranked.push(vec![proposal]),
            }
        }
        ranked
    }

    /// The gain of a start, its size fitted where the force is proportional to one.
    fn score(&self, mut term: Term) -> Proposal {
        let mut terms = self.fit.shape.terms_at(&self.fit.numbers);
        terms.push(term.clone());
        let shape = Shape {
            terms,
            ..self.fit.shape.clone()
        };
        let changed = self.problem.forces(&shape, &self.fit.numbers);
        let mut change: Vec<f64> = changed
            .iter()
            .zip(&self.forces)
            .zip(&self.roots)
            .map(|((with, without), root)| root * (with - without))
            .collect();
        let size = dot(&change, &change);
        remove(&mut change, &self.basis);
        let left = dot(&change, &change);
        // A change that the model can make as well promises nothing.
        if !left.is_finite() || left <= 1e-9 * size || left <= 0.0 {
            return Proposal { term, gain: 0.0 };
        }
        let along = dot(&change, &self.residuals);
        let share = along / left;
        let facts = term.id.info();
        let signed = facts.sign == Sign::Either;
        let mut gain = along * along / left;
        if share < 0.0 && !signed {
            // The wrong way; the base may turn it round, but rarely.
            gain *= 0.05;
        }
        if facts.is_proportional(&term.row) {
            let share = if signed { share } else { share.max(0.05) };
            let factor = share.signum() * share.abs().clamp(0.02, 50.0);
            for (value, fit) in term.row.iter_mut().zip(facts.fits) {
                match fit.role {
                    Role::Size => *value *= factor,
                    Role::SizeUpTo(most) => *value = (*value * factor).min(most),
                    Role::Shape | Role::Form(..) | Role::Switch(_) => {}
                }
            }
        }
        Proposal { term, gain }
    }

    /// Starts of what repeats in time or along the way, from the residuals' own spectrum.
    fn periodic(&self, ids: &[EffectId]) -> Vec<Term> {
        let slope = self.slope();
        let mut found = Vec::new();
        for id in ids.iter().filter(|id| is_possible(**id, &self.fit.shape)) {
            let carrier = match id {
                EffectId::PeriodicDisturbance | EffectId::Cogging => vec![1.0; self.roots.len()],
                // A surface that comes forward presses as a probe that goes in.
                EffectId::SurfaceMotion | EffectId::EncoderPeriodicError => {
                    slope.iter().map(|s| -s).collect()
                }
                _ => continue,
            };
            let waves = match id {
                EffectId::PeriodicDisturbance | EffectId::SurfaceMotion => self.in_time(&carrier),
                _ => self.along_the_way(&carrier),
            };
            for (period, amplitude, phase) in waves {
                let mut row = [0.0; MOST_PARAMETERS];
                row[..3].copy_from_slice(&[amplitude, period, phase]);
                found.push(whole(*id, row, 3));
            }
        }
        found
    }

    /// ∂F/∂x (N/m) block by block.
    fn slope(&self) -> Vec<f64> {
        let step = self
            .scales
            .position_noise_m
            .max(1e-6 * self.scales.travel_m);
        let shape = &self.fit.shape;
        let (numbers, courses) = (&self.fit.numbers, self.problem.courses);
        let here = forces(shape, numbers, courses);
        let moved = forces_moved(shape, numbers, courses, |course| {
            course.position_m.iter_mut().for_each(|x| *x += step);
        });
        moved
            .iter()
            .zip(&here)
            .map(|(a, b)| (a - b) / step)
            .collect()
    }

    /// The three strongest lines of carrier·sin(2πft + φ) in the residuals: f (Hz), amplitude, φ.
    fn in_time(&self, carrier: &[f64]) -> Vec<(f64, f64, f64)> {
        let course = &self.problem.courses[0];
        let n = course.len();
        if !course.even {
            return Vec::new();
        }
        let padded = (2 * n).next_power_of_two();
        let mut bins: Vec<Complex<f64>> = (0..padded)
            .map(|at| match at < n {
                true => Complex::new(self.residuals[at] * self.roots[at] * carrier[at], 0.0),
                false => Complex::new(0.0, 0.0),
            })
            .collect();
        FftPlanner::new()
            .plan_fft_forward(padded)
            .process(&mut bins);
        let bin_hz = 1.0 / (padded as f64 * course.period_s);
        let lowest = (2.0 / (self.scales.duration_s * bin_hz)).ceil() as usize;
        let power: Vec<f64> = bins[..padded / 2]
            .iter()
            .map(|bin| bin.norm_sqr())
            .collect();
        let peaks = peaks(&power, lowest.max(1), padded / n);
        let wave = |at: usize| {
            let hz = at as f64 * bin_hz;
            let (amplitude, phase) = self.wave(carrier, |row| TAU * hz * course.time_s[row], n)?;
            Some((hz, amplitude, phase))
        };
        peaks.into_iter().filter_map(wave).collect()
    }

    /// The three strongest of carrier·sin(2πx/p + φ): p (m), amplitude, φ.
    fn along_the_way(&self, carrier: &[f64]) -> Vec<(f64, f64, f64)> {
        let course = &self.problem.courses[0];
        let n = course.len();
        let travel_m = self.scales.travel_m;
        // Cycles over the travel, in quarters; up to a pitch of 16 counts or as many as 400 cycles.
        let finest = (travel_m / (16.0 * self.scales.position_noise_m)).min(400.0);
        let quarters = (4.0 * finest) as usize;
        // On a grid of four travels, at least eight cells a pitch: 3 % of the finest is lost.
        let cells = (8 * quarters).next_power_of_two();
        let per_cell_m = 4.0 * travel_m / cells as f64;
        let mut bins = vec![Complex::new(0.0, 0.0); cells];
        let each = self.residuals.iter().zip(&self.roots).zip(carrier);
        for (((residual, root), carrier), position_m) in each.zip(&course.position_m) {
            let at = (position_m / per_cell_m).floor() as i64;
            bins[at.rem_euclid(cells as i64) as usize].re += residual * root * carrier;
        }
        FftPlanner::new().plan_fft_forward(cells).process(&mut bins);
        let power: Vec<f64> = bins[..quarters].iter().map(|bin| bin.norm_sqr()).collect();
        let wave = |at: usize| {
            let per_m = 0.25 * at as f64 / travel_m;
            let angle = |row: usize| TAU * per_m * course.position_m[row];
            let (amplitude, phase) = self.wave(carrier, angle, n)?;
            Some((1.0 / per_m, amplitude, phase))
        };
        peaks(&power, 8, 4).into_iter().filter_map(wave).collect()
    }

    /// Amplitude and phase of carrier·A sin(angle + φ) that fit the residuals best, projected.
    fn wave(&self, carrier: &[f64], angle: impl Fn(usize) -> f64, n: usize) -> Option<(f64, f64)> {
        let mut pair = [vec![0.0; self.roots.len()], vec![0.0; self.roots.len()]];
        for row in 0..n {
            let own = self.roots[row] * carrier[row];
            let (sin, cos) = angle(row).sin_cos();
            (pair[0][row], pair[1][row]) = (own * sin, own * cos);
        }
        pair.iter_mut().for_each(|own| remove(own, &self.basis));
        let (ss, sc, cc) = (
            dot(&pair[0], &pair[0]),
            dot(&pair[0], &pair[1]),
            dot(&pair[1], &pair[1]),
        );
        let (s, c) = (
            dot(&pair[0], &self.residuals),
            dot(&pair[1], &self.residuals),
        );
        let determinant = ss * cc - sc * sc;
        if determinant <= 1e-9 * ss * cc {
            return None;
        }
        let (a, b) = (
            (s * cc - c * sc) / determinant,
            (c * ss - s * sc) / determinant,
        );
        Some((a.hypot(b), b.atan2(a)))
    }
}

/// The three largest local maxima, at least `apart` bins from each other.
fn peaks(power: &[f64], lowest: usize, apart: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (lowest..power.len().saturating_sub(1))
        .filter(|at| power[*at] >= power[at - 1] && power[*at] >= power[at + 1] && power[*at] > 0.0)
        .collect();
    order.sort_by(|a, b| power[*b].total_cmp(&power[*a]));
    let mut chosen: Vec<usize> = Vec::new();
    for at in order {
        if chosen.iter().all(|other| other.abs_diff(at) >= 2 * apart) {
            chosen.push(at);
        }
        if chosen.len() == 3 {
            break;
        }
    }
    chosen
}
