//! Where a candidate may start: sizes of the log make its numbers.

use estimator_core::physics::effect::{EffectId, MOST_PARAMETERS, Repeats};
use estimator_core::physics::law::LawId;

use crate::gap::data::scales::Scales;
use crate::gap::model::shape::{Shape, Term};

/// A term with its first `count` numbers free.
pub(in crate::gap) fn whole(id: EffectId, row: [f64; MOST_PARAMETERS], count: usize) -> Term {
    Term {
        id,
        row,
        free: std::array::from_fn(|at| at < count),
        given: false,
    }
}

/// Whether an effect can be added: it needs something to touch unless it acts in free air, and a
/// second one of a kind means nothing but in a spectrum: relaxation, harmonics.
pub(in crate::gap) fn is_possible(id: EffectId, shape: &Shape) -> bool {
    let touches = !shape.base.is_free();
    let has = shape.terms.iter().any(|term| term.id == id);
    (touches || id.info().stage.acts_in_free_air()) && (id.info().several || !has)
}

/// Whether it is a wave, in time or along the way.
pub(in crate::gap) fn repeats(id: EffectId) -> bool {
    id.info().repeats != Repeats::Never
}

/// Starts of an effect; none if it means nothing on this law.
pub(in crate::gap) fn starts(id: EffectId, shape: &Shape, s: &Scales) -> Vec<Term> {
    use EffectId as E;
    let exponential = shape.base.has("stiffening_rate");
    let linear = !exponential && !shape.base.has("exponent");
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
        E::DepthDependentDamping if shape.base.law == LawId::KelvinVoigt => {
            grid(&[&[0.3], &[0.8], &[1.5]], 1)
        }
        E::PowerLawStiffness | E::DepthDependentDamping => Vec::new(),
        E::ExponentialStiffening => {
            if exponential {
                Vec::new()
            } else {
                let mut starts = grid(&[&[0.1 / depth], &[0.5 / depth]], 1);
                starts.extend(grid(&[&[0.2 / depth, 0.5]], 2));
                starts
            }
        }
        E::Adhesion => {
            let mut starts = grid(
                &[
                    &[force, 0.03 * depth],
                    &[force, 0.1 * depth],
                    &[force, 0.3 * depth],
                ],
                2,
            );
            // A bond carries what was pulled at most.
            if -s.lowest_n > 0.5 * force {
                for share in [0.1, 0.3] {
                    starts.push(whole(id, row(&[-s.lowest_n, share * depth, 1.0]), 2));
                }
            }
            starts
        }
        E::PermanentSet => grid(&[&[0.1, 0.0], &[0.1, 0.3 * depth], &[0.1, 0.6 * depth]], 2),
        E::BuriedLayer => {
            // Down to a twentieth of the travel, most of which may be free air.
            let layer = |share: f64, rounding_m: f64, count: usize| {
                let depth_m = share * s.travel_m;
                whole(id, row(&[0.3 * stiffness, depth_m, rounding_m]), count)
            };
            let mut starts: Vec<Term> = (1..14).map(|k| layer(0.8_f64.powi(k), 0.0, 2)).collect();
            starts.extend([0.2, 0.4, 0.6].map(|share| layer(share, 0.03 * s.travel_m, 3)));
            starts
        }
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
        E::SeriesCompliance => {
            let mut starts = grid(&[&[4.0 * stiffness], &[20.0 * stiffness]], 1);
            starts.extend(grid(
                &[
                    &[2.0 * stiffness, 0.1 * s.force_n],
                    &[6.0 * stiffness, 0.3 * s.force_n],
                ],
                2,
            ));
            starts
        }
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
        E::ForceSaturation => {
            let mut starts = grid(&[&[0.97 * s.highest_n], &[0.9 * s.highest_n]], 1);
            let rounded = [s.highest_n, 0.03 * s.highest_n];
            starts.push(whole(id, row(&rounded), 2));
            starts
        }
    }
}
