//! The acceptance table: every method on the same simulated palpations, over many seeds.
//!
//! A case is a material, a motion and a surface drawn from its seed: gel, plastic or a material of
//! 300–20 000 N/m, λ/K 3–40 ms and n 1.05–1.7; 8 s of a sine of 0.9–1.6 Hz that leaves contact each
//! cycle, or of ramp–hold–ramp at 2, 4 or 8 depths a second; the surface within ±0.5 mm. The rig adds
//! its motor, 20 mN of noise in 5 mN steps and an encoder of 1 µm.

use estimator_core::config::{Config, Method, Surface};
use estimator_core::estimate::{Estimate, Event};
use estimator_core::law::{ContactLaw, HuntCrossley};
use estimator_core::{State, step};
use palpate::log::UniformLog;
use palpate::motion::{Motion, Segment};
use palpate::plant::{Contact, GEL, Law, PLASTIC, Rig, Stage};
use palpate::replay::samples;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Length of a case (s).
const SECONDS: f64 = 8.0;
/// Rest in free air at the start (s).
const REST_S: f64 = 0.3;

/// What is touched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Touched {
    /// The chapter's gel.
    Gel,
    /// The chapter's plastic.
    Plastic,
    /// A material drawn from the seed.
    Drawn,
}

/// How it is touched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stroke {
    /// A sine that leaves contact.
    Sine,
    /// Ramp, hold, ramp.
    Ramp,
}

/// All settings of the table.
pub(crate) const SETTINGS: [(Touched, Stroke); 6] = [
    (Touched::Gel, Stroke::Sine),
    (Touched::Gel, Stroke::Ramp),
    (Touched::Plastic, Stroke::Sine),
    (Touched::Plastic, Stroke::Ramp),
    (Touched::Drawn, Stroke::Sine),
    (Touched::Drawn, Stroke::Ramp),
];

/// One simulated palpation.
#[derive(Clone, Debug)]
pub(crate) struct Case {
    /// K (N/m), λ (N s/m), n, surface (m).
    pub(crate) truth: [f64; 4],
    /// What the sensors read.
    pub(crate) log: UniformLog,
    /// When the probe first touched (s).
    pub(crate) touched_s: f64,
}

impl Case {
    /// Draws and simulates a case.
    pub(crate) fn new(touched: Touched, stroke: Stroke, seed: u64) -> Case {
        let mut rng = Pcg64::seed_from_u64(seed);
        let law = match touched {
            Touched::Gel => GEL.law,
            Touched::Plastic => PLASTIC.law,
            Touched::Drawn => drawn(&mut rng),
        };
        let surface_m = rng.random_range(-5e-4..5e-4);
        let contact = Contact {
            law: Law::HuntCrossley(law),
            surface_m,
        };
        let peak_n = rng.random_range(5.0..14.0);
        let motion = motion(&mut rng, stroke, &law, peak_n).shifted(surface_m);
        let run = Rig::default().run(&Stage::throughout(contact), &motion, seed);
        let run = run.expect("the rig follows every material of the table");
        let touch = run.truth.position_m.iter().position(|x| *x > surface_m);
        Case {
            truth: [
                law.stiffness_n_per_m,
                law.damping_ns_per_m,
                law.exponent,
                surface_m,
            ],
            log: run.log.uniform().expect("the rig samples evenly"),
            touched_s: touch.map_or(SECONDS, |index| run.truth.time_s[index]),
        }
    }
}

fn drawn(rng: &mut Pcg64) -> HuntCrossley<f64> {
    let mut between = |low: f64, high: f64| low * (high / low).powf(rng.random());
    let stiffness = between(300.0, 20_000.0);
    let damping = stiffness * between(0.003, 0.04);
    HuntCrossley::new(stiffness, damping, rng.random_range(1.05..1.7), 1e-3)
}

/// The stroke whose fastest way in reaches `peak_n` at its deepest, or would: the cell ends at 15.4 N.
fn motion(rng: &mut Pcg64, stroke: Stroke, law: &HuntCrossley<f64>, peak_n: f64) -> Motion {
    let frequency_hz = rng.random_range(0.9..1.6);
    // Largest speed over the way.
    let quickness = match stroke {
        Stroke::Sine => std::f64::consts::PI * frequency_hz,
        Stroke::Ramp => [2.0, 4.0, 8.0][rng.random_range(0..3)],
    };
    let gap_m = |depth_m: f64| (0.4 * depth_m).clamp(1e-4, 5e-4);
    let way_m = |depth_m: f64| depth_m + gap_m(depth_m);
    let mut depth_m = 0.05;
    while law.force_n(depth_m, quickness * way_m(depth_m)) > peak_n {
        depth_m *= 0.99;
    }
    let (gap_m, way_m) = (gap_m(depth_m), way_m(depth_m));
    let mut segments = vec![Segment::Hold { seconds: REST_S }];
    match stroke {
        Stroke::Sine => segments.push(Segment::Sine {
            mean_m: 0.5 * way_m - gap_m,
            amplitude_m: 0.5 * way_m,
            frequency_hz,
            seconds: SECONDS - REST_S,
        }),
        Stroke::Ramp => {
            let speed_mps = quickness * way_m;
            for _ in 0..((SECONDS - REST_S) / (2.0 / quickness + 0.5)) as usize {
                segments.push(Segment::Ramp {
                    to_m: depth_m,
                    speed_mps,
                });
                segments.push(Segment::Hold { seconds: 0.3 });
                segments.push(Segment::Ramp {
                    to_m: -gap_m,
                    speed_mps,
                });
                segments.push(Segment::Hold { seconds: 0.2 });
            }
        }
    }
    Motion::new(-gap_m, segments).expect("the motions of the table are valid")
}

/// What one method made of one case.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Score {
    /// Largest relative error of K, λ, n at the end; infinite if one is not observable.
    pub(crate) worst: f64,
    /// From first touch until K, λ, n stay within 5 % of the truth (s).
    pub(crate) settles_s: f64,
    /// Error of the surface (m), if the method gives one.
    pub(crate) surface_m: Option<f64>,
    /// Which of K, λ, n lie within 1.96 standard errors of the truth.
    pub(crate) covered: [bool; 3],
    /// False material changes.
    pub(crate) changes: u32,
}

/// Runs a method over a case, its surface told if `known`.
pub(crate) fn score(case: &Case, method: Method, known: bool) -> Score {
    let mut config = Config {
        method,
        ..Config::default()
    };
    if known {
        config.contact.surface = Surface::Known {
            position_m: case.truth[3] as f32,
        };
    }
    let params = config.validate::<f32>().expect("the defaults are valid");
    let mut state = State::new(&params);
    let mut unsettled_s = case.touched_s;
    let mut changes = 0;
    let mut end = None;
    for (time_s, sample) in case.log.time_s.iter().zip(samples(&case.log)) {
        let estimate = step(&params, &mut state, sample);
        changes += u32::from(estimate.event == Some(Event::MaterialChange));
        if errors(&estimate, &case.truth)
            .into_iter()
            .any(|error| error > 0.05)
        {
            unsettled_s = *time_s;
        }
        end = Some(estimate);
    }
    let end = end.expect("the log is not empty");
    let surface = end.parameters[3].map(|p| (f64::from(p.value) - case.truth[3]).abs());
    Score {
        worst: errors(&end, &case.truth).into_iter().fold(0.0, f64::max),
        settles_s: unsettled_s - case.touched_s,
        surface_m: surface,
        covered: std::array::from_fn(|slot| {
            end.parameters[slot].is_some_and(|p| {
                let off = (f64::from(p.value) - case.truth[slot]).abs();
                off < 1.96 * f64::from(p.std_error)
            })
        }),
        changes,
    }
}

fn errors(estimate: &Estimate<f32>, truth: &[f64; 4]) -> [f64; 3] {
    std::array::from_fn(|slot| {
        let value = estimate.parameters[slot].map(|p| f64::from(p.value));
        value.map_or(f64::INFINITY, |value| (value / truth[slot] - 1.0).abs())
    })
}

/// A row of the table: the scores of one method in one setting.
#[derive(Clone, Debug, Default)]
pub(crate) struct Row {
    scores: Vec<Score>,
}

impl Row {
    /// Adds a score.
    pub(crate) fn push(&mut self, score: Score) {
        self.scores.push(score);
    }

    /// Share of the runs whose K, λ and n all end within `bound` of the truth.
    pub(crate) fn within(&self, bound: f64) -> f64 {
        self.share(|score| score.worst < bound)
    }

    /// Share of the runs that flagged a change where there was none.
    pub(crate) fn changed(&self) -> f64 {
        self.share(|score| score.changes > 0)
    }

    fn share(&self, is: impl Fn(&Score) -> bool) -> f64 {
        self.scores.iter().filter(|score| is(score)).count() as f64 / self.scores.len() as f64
    }

    /// The `share`-quantile of the settling times (s).
    pub(crate) fn settles_s(&self, share: f64) -> f64 {
        quantile(self.scores.iter().map(|score| score.settles_s), share)
    }

    /// The `share`-quantile of the surface's error (m).
    pub(crate) fn surface_m(&self, share: f64) -> f64 {
        quantile(
            self.scores.iter().filter_map(|score| score.surface_m),
            share,
        )
    }

    /// Share of K, λ and n within 1.96 of their standard errors.
    pub(crate) fn coverage(&self) -> [f64; 3] {
        std::array::from_fn(|slot| self.share(|score| score.covered[slot]))
    }
}

/// The `share`-quantile of some values.
pub(crate) fn quantile(values: impl Iterator<Item = f64>, share: f64) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_unstable_by(f64::total_cmp);
    let at = ((values.len().max(1) - 1) as f64 * share).round() as usize;
    values.get(at).copied().unwrap_or(f64::NAN)
}
