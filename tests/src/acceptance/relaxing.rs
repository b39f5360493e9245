//! The acceptance table of materials that relax: Zener, quasi-linear with one mode and with two, the
//! surface within ±0.5 mm, told to the estimator or not.
//!
//! Drawn are K 300–20 000 N/m, n 1.05–1.7, one mode of c 0.15–0.6 and ν 0.3–10/s, or two of
//! 0.1–0.35 each at 2–10/s and a tenth to a fifth of that; 8 s of a sine of 0.9–1.6 Hz that leaves
//! contact each cycle, or of two presses at 2, 4 or 8 depths a second, held for about 2.5 s.
//! E5 is the chapter's press of polyurethane and its hold of 50 s. The rig adds its motor, 20 mN of
//! noise in 5 mN steps and an encoder of 1 µm.

use estimator_core::estimate::Estimate;
use estimator_core::estimate::method::Method;
use estimator_core::physics::law::{
    Elastic, Law, MOST_MODES, QuasiLinear, RelaxationMode, RelaxingLaw, Zener,
};
use palpate::log::UniformLog;
use palpate::motion::{Motion, Segment};
use palpate::plant::{Contact, Rig, Stage};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::cases::Stroke;
use super::score::{Ran, largest, run};
use crate::quantile::quantile;
use crate::tolerance::{CLOSE, STRICT, SURE};

/// Length of a case (s).
const SECONDS: f64 = 8.0;
/// Rest in free air at the start (s).
const REST_S: f64 = 0.3;

/// The material that is touched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Relaxing {
    /// The chapter's polyurethane, pressed once and held for 50 s.
    E5,
    /// A standard linear solid.
    Solid,
    /// A quasi-linear material with one mode.
    OneMode,
    /// A quasi-linear material with two modes.
    TwoModes,
}

/// A material, a motion, and the estimators side by side: name, method, whether the surface is known.
pub(crate) type Setting = (Relaxing, Stroke, &'static [(&'static str, Method, bool)]);

const SOLID: &[(&str, Method, bool)] = &[
    ("ARX, surface known", Method::ZENER_ARX, true),
    ("ARX, surface from impact", Method::ZENER_ARX, false),
    ("bank + history, surface known", Method::ZENER_BANK, true),
    ("bank + history, surface found", Method::ZENER_BANK, false),
];
const ONE_MODE: &[(&str, Method, bool)] = &[
    ("cascade, surface known", Method::HAMMERSTEIN_CASCADE, true),
    (
        "cascade, surface from impact",
        Method::HAMMERSTEIN_CASCADE,
        false,
    ),
    (
        "bank + history, surface known",
        Method::QUASI_LINEAR_BANK,
        true,
    ),
    (
        "bank + history, surface found",
        Method::QUASI_LINEAR_BANK,
        false,
    ),
];
const TWO_MODES: &[(&str, Method, bool)] = &[
    (
        "cascade, surface known",
        Method::HAMMERSTEIN_CASCADE_2,
        true,
    ),
    (
        "bank + history, surface known",
        Method::QUASI_LINEAR_BANK_2,
        true,
    ),
    (
        "bank + history, surface found",
        Method::QUASI_LINEAR_BANK_2,
        false,
    ),
];

/// All settings of the table.
pub const SETTINGS: [Setting; 7] = [
    (Relaxing::Solid, Stroke::Sine, SOLID),
    (Relaxing::Solid, Stroke::Ramp, SOLID),
    (Relaxing::E5, Stroke::Ramp, ONE_MODE),
    (Relaxing::OneMode, Stroke::Sine, ONE_MODE),
    (Relaxing::OneMode, Stroke::Ramp, ONE_MODE),
    (Relaxing::TwoModes, Stroke::Sine, TWO_MODES),
    (Relaxing::TwoModes, Stroke::Ramp, TWO_MODES),
];

/// One simulated palpation.
pub struct Case {
    /// The law's parameters in the order of its slots, without the surface.
    pub(crate) truth: Vec<f64>,
    /// Where the surface is (m).
    pub(crate) surface_m: f64,
    /// What the sensors read.
    pub log: UniformLog,
    /// When the probe first touched (s).
    pub(crate) touched_s: f64,
}

const FREE: RelaxationMode<f64> = RelaxationMode {
    fraction: 0.0,
    rate_per_s: 0.0,
};

fn drawn(rng: &mut Pcg64, touched: Relaxing) -> (Law<f64>, Vec<f64>) {
    let mut between = |low: f64, high: f64| low * (high / low).powf(rng.random());
    let (mut stiffness, mut rate) = (between(300.0, 20_000.0), between(0.3, 10.0));
    let mut exponent = rng.random_range(1.05..1.7);
    let mut fraction = rng.random_range(0.15..0.6);
    if touched == Relaxing::E5 {
        (stiffness, exponent, fraction, rate) = (2000.0, 1.6, 0.3, 0.12);
    }
    if touched == Relaxing::Solid {
        // c = κ₁/(κ₁+κ₂), ν = (κ₁+κ₂)/λ
        let second = stiffness * (1.0 - fraction) / fraction;
        let damping = (stiffness + second) / rate;
        let law = Zener {
            stiffness_n_per_m: stiffness,
            second_stiffness_n_per_m: second,
            damping_ns_per_m: damping,
        };
        return (Law::Zener(law), vec![stiffness, second, damping]);
    }
    let mut modes: [RelaxationMode<f64>; MOST_MODES] = [FREE; MOST_MODES];
    modes[0] = RelaxationMode {
        fraction,
        rate_per_s: rate,
    };
    let mut truth = vec![stiffness, exponent, fraction, rate];
    if touched == Relaxing::TwoModes {
        let fast = rng.random_range(2.0..10.0);
        modes[0] = RelaxationMode {
            fraction: rng.random_range(0.1..0.35),
            rate_per_s: fast,
        };
        modes[1] = RelaxationMode {
            fraction: rng.random_range(0.1..0.35),
            rate_per_s: fast * rng.random_range(0.1..0.2),
        };
        truth.truncate(2);
        truth.extend(modes[..2].iter().flat_map(|m| [m.fraction, m.rate_per_s]));
    }
    let elastic = Elastic::Power {
        stiffness_n_per_m: stiffness,
        exponent,
        reference_depth_m: 1e-3,
    };
    (Law::QuasiLinear(QuasiLinear { elastic, modes }), truth)
}

fn motion(rng: &mut Pcg64, touched: Relaxing, stroke: Stroke, law: &Law<f64>) -> Motion {
    let hold = |seconds| Segment::Hold { seconds };
    let ramp = |to_m, speed_mps| Segment::Ramp { to_m, speed_mps };
    if touched == Relaxing::E5 {
        let segments = vec![
            hold(0.6),
            ramp(3.1e-3, 0.03),
            hold(50.0),
            ramp(-2e-3, 0.03),
            hold(0.5),
        ];
        return Motion::new(-2e-3, segments).expect("the chapter's motion is valid");
    }
    let peak_n = rng.random_range(5.0..14.0);
    let frequency_hz = rng.random_range(0.9..1.6);
    let quickness = [2.0, 4.0, 8.0][rng.random_range(0..3)];
    let mut depth_m = 0.05;
    while law.elastic_n(depth_m) > peak_n {
        depth_m *= 0.99;
    }
    let gap_m = (0.4 * depth_m).clamp(1e-4, 5e-4);
    let way_m = depth_m + gap_m;
    let mut segments = vec![hold(REST_S)];
    match stroke {
        Stroke::Sine => segments.push(Segment::Sine {
            mean_m: 0.5 * way_m - gap_m,
            amplitude_m: 0.5 * way_m,
            frequency_hz,
            seconds: SECONDS - REST_S,
        }),
        Stroke::Ramp => {
            let speed_mps = quickness * way_m;
            for _ in 0..2 {
                let way_s = 2.0 / quickness;
                segments.push(ramp(depth_m, speed_mps));
                segments.push(hold(0.5 * (SECONDS - REST_S) - way_s - 0.7));
                segments.push(ramp(-gap_m, speed_mps));
                segments.push(hold(0.7));
            }
        }
    }
    Motion::new(-gap_m, segments).expect("the motions of the table are valid")
}

impl Case {
    /// Draws and simulates a case.
    pub fn new(touched: Relaxing, stroke: Stroke, seed: u64) -> Case {
        let mut rng = Pcg64::seed_from_u64(seed);
        let (law, truth) = drawn(&mut rng, touched);
        let surface_m = rng.random_range(-5e-4..5e-4);
        let motion = motion(&mut rng, touched, stroke, &law).shifted(surface_m);
        let schedule = Stage::throughout(Contact {
            law,
            surface_m,
            ..Contact::FREE
        });
        let run = Rig::default().run(&schedule, &motion, seed);
        let run = run.expect("the rig follows every material of the table");
        let touch = run.truth.position_m.iter().position(|x| *x > surface_m);
        Case {
            truth,
            surface_m,
            log: run.log.uniform().expect("the rig samples evenly"),
            touched_s: touch.map_or(SECONDS, |index| run.truth.time_s[index]),
        }
    }
}

/// How well one method estimates one case.
#[derive(Clone, Debug)]
pub struct Score {
    /// The relative errors at the end, infinite for a parameter that is not observable.
    pub(crate) errors: Vec<f64>,
    /// The time (s) from the first touch until every parameter stays within 5 % of the truth.
    pub(crate) settles_s: f64,
    /// The error of the surface (m).
    pub(crate) surface_m: f64,
    /// Whether the truth lies in the 95 % interval of each parameter.
    pub(crate) covered: Vec<bool>,
    /// The number of false material changes.
    pub(crate) changes: u32,
}

/// Runs a method over a case, and tells it the surface if `known`.
pub fn score(case: &Case, method: Method, known: bool) -> Score {
    let surface_m = known.then_some(case.surface_m);
    let worst = |estimate: &Estimate<f32>| largest(errors(estimate, &case.truth));
    let Ran {
        end,
        unsettled_s,
        changes,
    } = run(&case.log, case.touched_s, method, surface_m, worst);
    let slot = case.truth.len();
    let surface = end.parameters[slot].map_or(f64::INFINITY, |p| f64::from(p.value));
    Score {
        errors: errors(&end, &case.truth).collect(),
        settles_s: unsettled_s - case.touched_s,
        surface_m: (surface - case.surface_m).abs(),
        covered: std::iter::zip(&end.parameters, &case.truth)
            .map(|(parameter, truth)| {
                parameter.is_some_and(|p| {
                    (f64::from(p.value) - truth).abs() < SURE * f64::from(p.std_error)
                })
            })
            .collect(),
        changes,
    }
}

fn errors(estimate: &Estimate<f32>, truth: &[f64]) -> impl Iterator<Item = f64> {
    std::iter::zip(&estimate.parameters, truth).map(|(parameter, truth)| {
        let value = parameter.map(|p| f64::from(p.value));
        value.map_or(f64::INFINITY, |value| (value / truth - 1.0).abs())
    })
}

/// A row of the table: the scores of one method in one setting.
#[derive(Clone, Debug, Default)]
pub struct Row {
    scores: Vec<Score>,
}

impl Row {
    /// Adds a score.
    pub fn push(&mut self, score: Score) {
        self.scores.push(score);
    }

    fn share(&self, is: impl Fn(&Score) -> bool) -> f64 {
        self.scores.iter().filter(|score| is(score)).count() as f64 / self.scores.len() as f64
    }

    /// The share of the runs whose parameters all end within `bound` of the truth.
    pub fn within(&self, bound: f64) -> f64 {
        self.share(|score| score.errors.iter().all(|error| *error < bound))
    }

    /// The share of the runs that flagged a change where there was none.
    pub fn changed(&self) -> f64 {
        self.share(|score| score.changes > 0)
    }

    /// The `share`-quantile of the settling times (s).
    pub(crate) fn settles_s(&self, share: f64) -> f64 {
        quantile(self.scores.iter().map(|score| score.settles_s), share)
    }

    /// The `share`-quantile of the surface's error (m).
    pub fn surface_m(&self, share: f64) -> f64 {
        quantile(self.scores.iter().map(|score| score.surface_m), share)
    }

    /// The median error of each parameter.
    pub(crate) fn medians(&self) -> Vec<f64> {
        let slots = self.scores.first().map_or(0, |score| score.errors.len());
        let of = |slot: usize| quantile(self.scores.iter().map(|score| score.errors[slot]), 0.5);
        (0..slots).map(of).collect()
    }

    /// For each parameter the share of the runs in which the truth lies in its 95 % interval.
    pub(crate) fn coverage(&self) -> Vec<f64> {
        let slots = self.scores.first().map_or(0, |score| score.covered.len());
        (0..slots)
            .map(|slot| self.share(|score| score.covered[slot]))
            .collect()
    }
}

/// A row as the table prints it.
impl std::fmt::Display for Row {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "{:>5.1} {:>6.1} {:>6.2} / {:<5.2} {:>6.1} µm  {:>6.3} ",
            100.0 * self.within(STRICT),
            100.0 * self.within(CLOSE),
            self.settles_s(0.5),
            self.settles_s(0.95),
            1e6 * self.surface_m(0.95),
            self.changed(),
        )?;
        for share in self.coverage() {
            write!(f, " {:>3.0}", 100.0 * share)?;
        }
        write!(f, "  ")?;
        for error in self.medians() {
            write!(f, " {:.2}", 100.0 * error)?;
        }
        Ok(())
    }
}
