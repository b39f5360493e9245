//! The cases of the acceptance table: simulated palpations, the same for every method.
//!
//! A case is a material, a motion and a surface drawn from its seed: gel, plastic or a material of
//! 300–20 000 N/m, λ/K 3–40 ms and n 1.05–1.7; 8 s of a sine of 0.9–1.6 Hz that leaves contact each
//! cycle, or of ramp–hold–ramp at 2, 4 or 8 depths a second; the surface within ±0.5 mm. The rig adds
//! its motor, 20 mN of noise in 5 mN steps and an encoder of 1 µm.

use estimator_core::physics::law::{ContactLaw, HuntCrossley, Law};
use palpate::log::UniformLog;
use palpate::motion::{Motion, Segment};
use palpate::plant::{Contact, GEL, LoadCell, PLASTIC, Rig, Sensors, Stage, Truth};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Length of a case (s).
pub(crate) const SECONDS: f64 = 8.0;
/// Rest in free air at the start (s).
const REST_S: f64 = 0.3;

/// The material that is touched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Touched {
    /// The chapter's gel.
    Gel,
    /// The chapter's plastic.
    Plastic,
    /// A material drawn from the seed.
    Drawn,
}

impl Touched {
    /// The law of the material.
    pub(crate) fn law(self, rng: &mut Pcg64) -> HuntCrossley<f64> {
        match self {
            Touched::Gel => GEL.law,
            Touched::Plastic => PLASTIC.law,
            Touched::Drawn => drawn(rng),
        }
    }
}

/// The motion of the probe.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stroke {
    /// A sine that leaves contact.
    Sine,
    /// Ramp, hold, ramp.
    Ramp,
}

/// All settings of the table.
pub const SETTINGS: [(Touched, Stroke); 6] = [
    (Touched::Gel, Stroke::Sine),
    (Touched::Gel, Stroke::Ramp),
    (Touched::Plastic, Stroke::Sine),
    (Touched::Plastic, Stroke::Ramp),
    (Touched::Drawn, Stroke::Sine),
    (Touched::Drawn, Stroke::Ramp),
];

/// One simulated palpation.
#[derive(Clone, Debug)]
pub struct Case {
    /// K (N/m), λ (N s/m), n, surface (m).
    pub(crate) truth: [f64; 4],
    /// The readings of the sensors.
    pub log: UniformLog,
    /// The true motion and force.
    pub(crate) run: Truth,
    /// The noise of the force (N rms).
    pub(crate) force_noise_n: f64,
    /// When the probe first touched (s).
    pub(crate) touched_s: f64,
}

impl Case {
    /// Draws and simulates a case.
    pub fn new(touched: Touched, stroke: Stroke, seed: u64) -> Case {
        Case::on(&Rig::default(), touched, stroke, seed)
    }

    /// Draws and simulates a case on another rig.
    pub(crate) fn on(rig: &Rig, touched: Touched, stroke: Stroke, seed: u64) -> Case {
        let mut rng = Pcg64::seed_from_u64(seed);
        let law = touched.law(&mut rng);
        let surface_m = rng.random_range(-5e-4..5e-4);
        let contact = Contact {
            law: Law::HuntCrossley(law),
            surface_m,
            ..Contact::FREE
        };
        let peak_n = rng.random_range(5.0..14.0);
        let motion = motion(&mut rng, stroke, &law, peak_n).shifted(surface_m);
        let run = rig.run(&Stage::throughout(contact), &motion, seed);
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
            run: run.truth,
            force_noise_n: rig.sensors.force_noise_n,
        }
    }

    /// The same case with its force read `skew_s` (s) later than its position.
    pub(crate) fn skewed(mut self, skew_s: f64, seed: u64) -> Case {
        let sensors = Sensors::default();
        let mut cell = LoadCell::new(sensors, seed);
        let force_n = &self.run.force_n;
        let at = |place: f64| {
            let place = place.clamp(0.0, (force_n.len() - 1) as f64);
            let (before, share) = (place.floor() as usize, place.fract());
            let after = (before + 1).min(force_n.len() - 1);
            (1.0 - share) * force_n[before] + share * force_n[after]
        };
        let late = skew_s * sensors.rate_hz;
        self.log.force_n = (0..force_n.len())
            .map(|index| cell.read_n(at(index as f64 - late)))
            .collect();
        self
    }
}

fn drawn(rng: &mut Pcg64) -> HuntCrossley<f64> {
    let mut between = |low: f64, high: f64| low * (high / low).powf(rng.random());
    let stiffness = between(300.0, 20_000.0);
    let damping = stiffness * between(0.003, 0.04);
    HuntCrossley::new(stiffness, damping, rng.random_range(1.05..1.7), 1e-3)
}

/// A stroke whose fastest way in would reach `peak_n` (N) at its deepest; the cell saturates at 15.4 N.
pub(crate) fn motion(
    rng: &mut Pcg64,
    stroke: Stroke,
    law: &HuntCrossley<f64>,
    peak_n: f64,
) -> Motion {
    let frequency_hz = rng.random_range(0.9..1.6);
    // The largest speed over the length of the way (1/s).
    let quickness = match stroke {
        Stroke::Sine => std::f64::consts::PI * frequency_hz,
        Stroke::Ramp => [2.0, 4.0, 8.0][rng.random_range(0..3)],
    };
    let (depth_m, gap_m) = reach(law, quickness, peak_n);
    let way_m = depth_m + gap_m;
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

/// The depth (m) of a stroke whose fastest way in, `quickness` ways a second, reaches `peak_n` (N) at its
/// deepest, and how far it leaves the surface (m).
pub(crate) fn reach(law: &HuntCrossley<f64>, quickness: f64, peak_n: f64) -> (f64, f64) {
    let gap_m = |depth_m: f64| (0.4 * depth_m).clamp(1e-4, 5e-4);
    let mut depth_m = 0.05;
    while law.force_n(depth_m, quickness * (depth_m + gap_m(depth_m))) > peak_n {
        depth_m *= 0.99;
    }
    (depth_m, gap_m(depth_m))
}
