//! Where a candidate may start: sizes of the log make its numbers.

use estimator_core::physics::effect::{ChainStage, EffectId, MOST_PARAMETERS, Repeats};
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

/// Starts of an effect; there are none if it means nothing on this law.
pub(in crate::gap) fn starts(id: EffectId, shape: &Shape, scales: &Scales) -> Vec<Term> {
    let sizes = Sizes {
        force_n: 0.05 * scales.force_n,
        depth_m: 0.5 * scales.travel_m,
        stiffness_n_per_m: scales.force_n / (0.5 * scales.travel_m),
        scales,
    };
    if !is_possible(id, shape) {
        return Vec::new();
    }
    match id.info().stage {
        ChainStage::LoadPath => sizes.of_load_path(id),
        ChainStage::PositionReading | ChainStage::Transmission | ChainStage::ForceReading => {
            sizes.of_transmission_and_reading(id)
        }
        _ => sizes.of_contact(id, shape),
    }
}

/// A term that starts with these values, all of them free; the others are absent.
fn start(id: EffectId, values: &[f64]) -> Term {
    let mut row = [0.0; MOST_PARAMETERS];
    row[..values.len()].copy_from_slice(values);
    whole(id, row, values.len())
}

/// Sizes of a log that starts are made of; a wave starts from the spectrum of the residuals instead.
struct Sizes<'a> {
    force_n: f64,
    depth_m: f64,
    stiffness_n_per_m: f64,
    scales: &'a Scales,
}

impl Sizes<'_> {
    /// Starts of what acts between the depth and the contact force.
    fn of_contact(&self, id: EffectId, shape: &Shape) -> Vec<Term> {
        use EffectId as E;
        let (force_n, depth_m, s) = (self.force_n, self.depth_m, self.scales);
        let exponential = shape.base.has("stiffening_rate");
        let viscous = shape.base.law == LawId::KelvinVoigt;
        let linear = !exponential && !shape.base.has("exponent");
        let each =
            |values: &[f64]| -> Vec<Term> { values.iter().map(|one| start(id, &[*one])).collect() };
        let pairs = |first: f64, seconds: &[f64]| -> Vec<Term> {
            seconds
                .iter()
                .map(|second| start(id, &[first, *second]))
                .collect()
        };
        match id {
            E::StressRelaxation => {
                let rates = (0..9).map(|k| 0.3 / s.duration_s * 4.0_f64.powi(k));
                let rates = rates.filter(|rate| *rate < 0.2 / s.period_s);
                rates.map(|rate| start(id, &[0.1, rate])).collect()
            }
            E::PowerLawStiffness if linear => each(&[1.15, 1.4, 1.8, 0.85]),
            E::DepthDependentDamping if viscous => each(&[0.3, 0.8, 1.5]),
            E::ExponentialStiffening if !exponential => {
                let mut starts = each(&[0.1 / depth_m, 0.5 / depth_m]);
                starts.push(start(id, &[0.2 / depth_m, 0.5]));
                starts
            }
            E::Adhesion => {
                let mut starts = pairs(force_n, &[0.03 * depth_m, 0.1 * depth_m, 0.3 * depth_m]);
                // A bond carries what was pulled at most.
                if -s.lowest_n > 0.5 * force_n {
                    let bond = |share: f64| Term {
                        row: [-s.lowest_n, share * depth_m, 1.0, 0.0],
                        ..start(id, &[0.0; 2])
                    };
                    starts.extend([0.1, 0.3].map(bond));
                }
                starts
            }
            E::PermanentSet => pairs(0.1, &[0.0, 0.3 * depth_m, 0.6 * depth_m]),
            E::BuriedLayer => {
                // Down to a twentieth of the travel, most of which may be free air.
                let stiffness = 0.3 * self.stiffness_n_per_m;
                let sharp = (1..14).map(|k| start(id, &[stiffness, 0.8_f64.powi(k) * s.travel_m]));
                let rounded = [0.2, 0.4, 0.6]
                    .map(|share| start(id, &[stiffness, share * s.travel_m, 0.03 * s.travel_m]));
                sharp.chain(rounded).collect()
            }
            E::HystereticDamping => (1..8)
                .map(|k| start(id, &[force_n, depth_m * 0.5_f64.powi(k)]))
                .collect(),
            E::CyclicSoftening => pairs(0.1, &[0.05 * depth_m, 0.2 * depth_m, 0.6 * depth_m]),
            _ => Vec::new(),
        }
    }

    /// Starts of what acts between the contact and the load cell.
    fn of_load_path(&self, id: EffectId) -> Vec<Term> {
        use EffectId as E;
        let (force_n, depth_m, s) = (self.force_n, self.depth_m, self.scales);
        let (speed, least) = (s.speed_mps, f64::MIN_POSITIVE);
        match id {
            E::CoulombFriction => {
                let sliding = |times: f64| {
                    let transition = (times * s.speed_noise_mps).max(2e-3 * speed);
                    Term {
                        row: [force_n, 0.0, transition, 0.0],
                        free: [true, false, true, false],
                        ..start(id, &[])
                    }
                };
                let sticking =
                    [3e-3, 1e-2, 3e-2].map(|width| start(id, &[force_n, width * depth_m]));
                [1.0, 4.0]
                    .map(sliding)
                    .into_iter()
                    .chain(sticking)
                    .collect()
            }
            E::StribeckFriction => {
                let transition = s.speed_noise_mps.max(3e-3 * speed);
                let at =
                    |share: f64| start(id, &[force_n, 1.5 * force_n, share * speed, transition]);
                [0.03, 0.1, 0.3].map(at).to_vec()
            }
            E::ViscousDrag | E::AsymmetricDrag => vec![start(id, &[force_n / speed])],
            E::ToolInertia => vec![start(id, &[force_n / s.acceleration_mps2.max(least)])],
            E::ForceOffset => vec![start(id, &[force_n])],
            E::ForceDrift => {
                let rate = force_n / s.duration_s;
                vec![
                    start(id, &[rate]),
                    start(id, &[rate * 3.0, 0.2 * s.duration_s]),
                    start(id, &[rate * 10.0, 0.05 * s.duration_s]),
                ]
            }
            E::CableStiffness => vec![start(id, &[force_n / s.reach_m.max(least)])],
            _ => Vec::new(),
        }
    }

    /// Starts of what acts between the motor and the tip, and between the load cell's force and its
    /// reading.
    fn of_transmission_and_reading(&self, id: EffectId) -> Vec<Term> {
        use EffectId as E;
        let (depth_m, stiffness, s) = (self.depth_m, self.stiffness_n_per_m, self.scales);
        let each = |values: [f64; 3]| values.map(|one| start(id, &[one])).to_vec();
        match id {
            E::SeriesCompliance => vec![
                start(id, &[4.0 * stiffness]),
                start(id, &[20.0 * stiffness]),
                start(id, &[2.0 * stiffness, 0.1 * s.force_n]),
                start(id, &[6.0 * stiffness, 0.3 * s.force_n]),
            ],
            E::Backlash => each([0.01 * depth_m, 0.03 * depth_m, 0.1 * depth_m]),
            E::ForceLag => each([1.5 * s.period_s, 6.0 * s.period_s, 25.0 * s.period_s]),
            E::TimeDelay => each([s.period_s, 6.0 * s.period_s, -6.0 * s.period_s]),
            E::ForceSaturation => vec![
                start(id, &[0.97 * s.highest_n]),
                start(id, &[0.9 * s.highest_n]),
                start(id, &[s.highest_n, 0.03 * s.highest_n]),
            ],
            _ => Vec::new(),
        }
    }
}
