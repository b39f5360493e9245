//! Where a candidate starts, and what it promises: its force, projected off what the model can do
//! already, against the residuals.

use std::f64::consts::TAU;

use estimator_core::effect::{EffectId, MOST_PARAMETERS, Place};
use rayon::prelude::*;
use rustfft::FftPlanner;
use rustfft::num_complex::Complex;

use super::course::Scales;
use super::fit::{Fit, Problem, dot, forces};
use super::shape::{Shape, Term};
use crate::model::EnvironmentLaw;

/// A candidate with numbers to start from.
#[derive(Clone, Debug)]
pub(super) struct Proposal {
    pub(super) term: Term,
    /// What it takes off Σ w r², to first order.
    pub(super) gain: f64,
}

/// A fit, linearised, and an orthonormal basis of what its numbers can do.
pub(super) struct Ground<'a> {
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
    pub(super) fn new(problem: Problem<'a>, fit: &'a Fit, scales: &'a Scales) -> Ground<'a> {
        let linear = problem.linear(&fit.shape, &fit.numbers);
        let roots: Vec<f64> = problem.weights.iter().map(|w| w.sqrt()).collect();
        let weighted = |column: &[f64]| -> Vec<f64> {
            column.iter().zip(&roots).map(|(c, w)| c * w).collect()
        };
        let mut basis: Vec<Vec<f64>> = Vec::new();
        for column in &linear.columns {
            let mut own = weighted(column);
            let before = dot(&own, &own);
            remove(&mut own, &basis);
            remove(&mut own, &basis);
            let size = dot(&own, &own);
            if size > 1e-10 * before && size > 0.0 {
                let scale = 1.0 / size.sqrt();
                own.iter_mut().for_each(|value| *value *= scale);
                basis.push(own);
            }
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
    pub(super) fn proposals(&self, ids: &[EffectId]) -> Vec<Vec<Proposal>> {
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
                Some(own) if own.len() < 3 => own.push(proposal),
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
        let signed = is_signed(term.id);
        let mut gain = along * along / left;
        if share < 0.0 && !signed {
            // The wrong way; the base may turn it round, but rarely.
            gain *= 0.05;
        }
        if is_proportional(term.id) {
            let share = if signed { share } else { share.max(0.05) };
            let factor = share.signum() * share.abs().clamp(0.02, 50.0);
            for (at, own) in term.row.iter_mut().enumerate() {
                if is_size(term.id, at) {
                    *own *= factor;
                }
            }
            if term.id == EffectId::StressRelaxation || term.id == EffectId::CyclicSoftening {
                term.row[0] = term.row[0].min(0.6);
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
        let mut moved = self.problem.courses.to_vec();
        for course in &mut moved {
            course.position_m.iter_mut().for_each(|x| *x += step);
        }
        let shape = &self.fit.shape;
        let here = forces(shape, &self.fit.numbers, self.problem.courses);
        let moved = forces(shape, &self.fit.numbers, &moved);
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
        // Enough blocks to see a pitch, no more.
        let stride = (n / 3000).max(1);
        let power: Vec<f64> = (0..quarters)
            .into_par_iter()
            .map(|at| {
                if at < 8 {
                    return 0.0;
                }
                let per_m = TAU * 0.25 * at as f64 / travel_m;
                let (mut re, mut im, mut size) = (0.0, 0.0, 0.0);
                for row in (0..n).step_by(stride) {
                    let own = self.roots[row] * carrier[row];
                    let (sin, cos) = (per_m * course.position_m[row]).sin_cos();
                    re += self.residuals[row] * own * cos;
                    im += self.residuals[row] * own * sin;
                    size += own * own;
                }
                (re * re + im * im) / size.max(f64::MIN_POSITIVE)
            })
            .collect();
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

pub(super) fn remove(own: &mut [f64], basis: &[Vec<f64>]) {
    for one in basis {
        let share = dot(own, one);
        own.iter_mut()
            .zip(one)
            .for_each(|(value, b)| *value -= share * b);
    }
}

/// Effects whose force may have either sign.
fn is_signed(id: EffectId) -> bool {
    use EffectId as E;
    matches!(
        id,
        E::AsymmetricDrag
            | E::ForceOffset
            | E::ForceDrift
            | E::CableStiffness
            | E::TimeDelay
            | E::Cogging
            | E::PeriodicDisturbance
    )
}

/// Effects whose force is proportional to their sizes.
fn is_proportional(id: EffectId) -> bool {
    use EffectId as E;
    !matches!(
        id,
        E::PowerLawStiffness
            | E::DepthDependentDamping
            | E::SeriesCompliance
            | E::ForceSaturation
            | E::SurfaceMotion
            | E::EncoderPeriodicError
            | E::Cogging
            | E::PeriodicDisturbance
    )
}

/// The parameters that are sizes.
fn is_size(id: EffectId, at: usize) -> bool {
    at == 0 || (id == EffectId::StribeckFriction && at == 1)
}

/// A term with its first `count` numbers free.
pub(super) fn whole(id: EffectId, row: [f64; MOST_PARAMETERS], count: usize) -> Term {
    Term {
        id,
        row,
        free: std::array::from_fn(|at| at < count),
        given: false,
    }
}

/// Whether an effect can be added: it needs something to touch unless it acts on the load path, and
/// a second one of a kind means nothing but in a spectrum.
pub(super) fn is_possible(id: EffectId, shape: &Shape) -> bool {
    use EffectId as E;
    let touches = shape.base.law != EnvironmentLaw::Free;
    let own = matches!(id.info().place, Place::LoadPath | Place::ForceReading);
    let twice = matches!(
        id,
        E::StressRelaxation | E::PeriodicDisturbance | E::Cogging
    );
    let has = shape.terms.iter().any(|term| term.id == id);
    (touches || own) && (twice || !has)
}

/// Starts of an effect; none if it means nothing on this law.
pub(super) fn starts(id: EffectId, shape: &Shape, s: &Scales) -> Vec<Term> {
    use EffectId as E;
    let law = &shape.base.law;
    let linear = matches!(
        law,
        EnvironmentLaw::KelvinVoigt { .. } | EnvironmentLaw::Zener { .. }
    );
    if !is_possible(id, shape) {
        return Vec::new();
    }
    let row = |values: &[f64]| {
        let mut row = [0.0; MOST_PARAMETERS];
        row[..values.len()].copy_from_slice(values);
        row
    };
    let grid = |values: &[&[f64]], count: usize| -> Vec<Term> {
        values
            .iter()
            .map(|own| whole(id, row(own), count))
            .collect()
    };
    let force = 0.05 * s.force_n;
    let depth = 0.5 * s.travel_m;
    let stiffness = s.force_n / depth;
    let speed = s.speed_mps;
    match id {
        E::StressRelaxation => {
            let rates = (0..9).map(|k| 0.3 / s.duration_s * 4.0_f64.powi(k));
            let rates = rates.filter(|rate| *rate < 0.2 / s.period_s);
            rates.map(|rate| whole(id, row(&[0.1, rate]), 2)).collect()
        }
        E::PowerLawStiffness if linear => grid(&[&[1.15], &[1.4], &[1.8], &[0.85]], 1),
        E::DepthDependentDamping if matches!(law, EnvironmentLaw::KelvinVoigt { .. }) => {
            grid(&[&[0.3], &[0.8], &[1.5]], 1)
        }
        E::PowerLawStiffness | E::DepthDependentDamping => Vec::new(),
        E::ExponentialStiffening => {
            let exponential = matches!(
                law,
                EnvironmentLaw::QuasiLinear {
                    elastic: crate::model::Elastic::Exponential { .. },
                    ..
                }
            );
            if exponential {
                Vec::new()
            } else {
                grid(&[&[0.1 / depth], &[0.5 / depth]], 1)
            }
        }
        E::Adhesion => grid(
            &[
                &[force, 0.03 * depth],
                &[force, 0.1 * depth],
                &[force, 0.3 * depth],
            ],
            2,
        ),
        E::PermanentSet => grid(&[&[0.1, 0.0], &[0.1, 0.3 * depth], &[0.1, 0.6 * depth]], 2),
        E::BuriedLayer => (2..10)
            .map(|k| {
                whole(
                    id,
                    row(&[0.3 * stiffness, 0.1 * f64::from(k) * s.travel_m]),
                    2,
                )
            })
            .collect(),
        E::HystereticDamping => (1..8)
            .map(|k| whole(id, row(&[force, depth * 0.5_f64.powi(k)]), 2))
            .collect(),
        E::CyclicSoftening => grid(
            &[
                &[0.1, 0.05 * depth],
                &[0.1, 0.2 * depth],
                &[0.1, 0.6 * depth],
            ],
            2,
        ),
        E::CoulombFriction => {
            let mut starts: Vec<Term> = [1.0, 4.0]
                .iter()
                .map(|times| Term {
                    free: [true, false, true, false],
                    ..whole(
                        id,
                        row(&[force, 0.0, (times * s.speed_noise_mps).max(2e-3 * speed)]),
                        3,
                    )
                })
                .collect();
            for width in [3e-3, 1e-2, 3e-2] {
                starts.push(whole(id, row(&[force, width * depth, 0.0]), 2));
            }
            starts
        }
        E::StribeckFriction => [0.03, 0.1, 0.3]
            .iter()
            .map(|share| Term {
                free: [true; 4],
                ..whole(
                    id,
                    row(&[
                        force,
                        1.5 * force,
                        share * speed,
                        s.speed_noise_mps.max(3e-3 * speed),
                    ]),
                    4,
                )
            })
            .collect(),
        E::ViscousDrag | E::AsymmetricDrag => grid(&[&[force / speed]], 1),
        E::ToolInertia => grid(&[&[force / s.acceleration_mps2.max(f64::MIN_POSITIVE)]], 1),
        E::ForceOffset => grid(&[&[force]], 1),
        E::ForceDrift => {
            let rate = force / s.duration_s;
            let mut starts = grid(&[&[rate, 0.0]], 1);
            starts.extend(grid(
                &[
                    &[rate * 3.0, 0.2 * s.duration_s],
                    &[rate * 10.0, 0.05 * s.duration_s],
                ],
                2,
            ));
            starts
        }
        E::CableStiffness => grid(&[&[force / s.reach_m.max(f64::MIN_POSITIVE)]], 1),
        E::Cogging | E::PeriodicDisturbance | E::SurfaceMotion | E::EncoderPeriodicError => {
            Vec::new()
        }
        E::SeriesCompliance => grid(&[&[4.0 * stiffness], &[20.0 * stiffness]], 1),
        E::Backlash => grid(&[&[0.01 * depth], &[0.03 * depth], &[0.1 * depth]], 1),
        E::ForceLag => grid(
            &[
                &[1.5 * s.period_s],
                &[6.0 * s.period_s],
                &[25.0 * s.period_s],
            ],
            1,
        ),
        E::TimeDelay => grid(
            &[&[s.period_s], &[6.0 * s.period_s], &[-6.0 * s.period_s]],
            1,
        ),
        E::ForceSaturation => grid(&[&[0.97 * s.highest_n], &[0.9 * s.highest_n]], 1),
    }
}
