//! One log with one fault, and the same log without it.

use super::fault::{Fault, Scene};
use super::material::{MATERIALS, Material};
use super::motion::{MOTIONS, Reach, path};
use super::plan::{Clock, Force, Plan, Position, World};
use super::sensors::{Rows, read};
use super::world::{Stage, forces};
use super::{FINE_HZ, RATE_HZ, REFERENCE_M, SUBSTEPS};
use crate::hidden::rig::random::Random;

/// Length of a log (s).
pub const SECONDS: f64 = 10.0;
/// The surface lies within this (m).
const SURFACE_M: f64 = 3e-4;
/// A change of the force shows when it is so many standard deviations of the noise.
const SHOWS: f64 = 3.0;

/// A log with a fault, and its truth.
pub struct Case {
    /// The fault.
    pub fault: &'static Fault,
    /// 0, 1 or 2.
    pub severity: usize,
    /// Number in its cell.
    pub index: u64,
    /// The seed.
    pub seed: u64,
    /// Position of the surface (m).
    pub surface_m: f64,
    /// What the fault does.
    pub plan: Plan,
    /// The material over time.
    pub stages: Vec<Stage>,
    /// What was recorded.
    pub rows: Rows,
    /// Depth at every sub-step (m).
    path: Vec<f64>,
    /// Depth at every nominal sample (m).
    pub depth_m: Vec<f64>,
    /// The estimate counts from here on (s): from the start, or when the force shows the fault.
    pub counts_from_s: f64,
}

/// Material and motion of the log `index` of a cell: they take turns.
pub fn names(index: u64) -> (&'static str, &'static str) {
    let (kind, motion) = turns(index);
    (MATERIALS[kind].0, MOTIONS[motion])
}

fn turns(index: u64) -> (usize, usize) {
    let (kinds, motions) = (MATERIALS.len() as u64, MOTIONS.len() as u64);
    ((index % kinds) as usize, (index / kinds % motions) as usize)
}

/// The streams of a seed.
const SCENE: u64 = 1;
const MOTION: u64 = 2;
const FAULT: u64 = 3;

impl Case {
    /// The log `index` of a cell: materials and motions take turns, and the same index of other faults
    /// is the same palpation.
    pub fn new(fault: &'static Fault, severity: usize, seed: u64, index: u64) -> Case {
        let (kind, motion) = turns(index);
        let seed = seed.wrapping_mul(1_000_003).wrapping_add(index);
        let mut random = Random::new(seed, SCENE);
        let material = Material::draw(kind, &mut random);
        let surface_m = random.between(-SURFACE_M, SURFACE_M);
        let peak_n = random.between(6.0, 11.0);
        let reach = Reach {
            depth_m: material.depth_m(peak_n),
            speed_mps: 0.75 * material.speed_mps(),
            seconds: SECONDS,
        };
        let special = (fault.motion)(severity);
        let path = path(special, motion, &reach, &mut Random::new(seed, MOTION)).x;
        let mut scene = Scene {
            severity,
            material,
            depth_m: reach.depth_m,
            peak_n,
            path: &path,
            random: Random::new(seed, FAULT),
        };
        let plan = (fault.plan)(&mut scene);
        let stages = stages(material, &plan);
        let honest = World::default();
        let force = forces(&path, &stages, &plan.world);
        let shows_s = fault
            .meets
            .then(|| shows_s(&force, &forces(&path, &stages[..1], &honest), &plan));
        let position: Vec<f64> = path.iter().map(|x| x + surface_m).collect();
        let rows = read(&position, &force, &plan, seed);
        Case {
            fault,
            severity,
            index,
            seed,
            surface_m,
            stages,
            rows,
            depth_m: path.iter().step_by(SUBSTEPS).copied().collect(),
            counts_from_s: shows_s.unwrap_or(0.0),
            path,
            plan,
        }
    }

    /// What the noise of the force is multiplied by from the start on.
    pub fn noise_gain(&self) -> f64 {
        self.gain_at_start(self.plan.force.gain)
    }

    /// A gain's size if the fault is there from the start on.
    fn gain_at_start(&self, gain: f64) -> f64 {
        match self.plan.onset_s > 0.0 {
            true => 1.0,
            false => gain.abs(),
        }
    }

    /// Between two samples (s).
    pub fn period_s(&self) -> f64 {
        1.0 / self.plan.clock.rate_hz
    }

    /// K, λ and n at a time (s).
    pub fn truth(&self, time_s: f64) -> [f64; 3] {
        let stage = self.stages.iter().rev().find(|s| s.from_s <= time_s);
        stage.unwrap_or(&self.stages[0]).material.numbers
    }

    /// The same of the material at another reference depth: a claim is judged where it is made. Carried from 10 µm to
    /// 1 mm, λ is 100ⁿ times as large, and its standard error knows nothing of that of n.
    pub fn truth_at(&self, time_s: f64, depth_m: f64) -> [f64; 3] {
        let [stiffness, damping, exponent] = self.truth(time_s);
        let shape = (depth_m / REFERENCE_M).powf(exponent);
        [
            stiffness * shape * REFERENCE_M / depth_m,
            damping * shape,
            exponent,
        ]
    }

    /// The rows of the same palpation with the same noise, steps and counts, and without the fault. A position that
    /// is ten percent too large from the start on is rounded to counts of ten percent less of the way: how a ramp and
    /// a hold are rounded colours the residual, and the same ramp in other counts made 4 such logs of 100 seen, though
    /// K, λ and the surface take the scale up to the last digit.
    pub fn honest_rows(&self) -> Rows {
        let (force, position) = (&self.plan.force, &self.plan.position);
        let plan = Plan {
            force: Force {
                noise_n: force.noise_n,
                step_n: force.step_n,
                ..Force::default()
            },
            position: Position {
                count_m: position.count_m / self.gain_at_start(position.gain),
                ..Position::default()
            },
            clock: Clock {
                rate_hz: self.plan.clock.rate_hz,
                ..Clock::default()
            },
            ..Plan::default()
        };
        let force = forces(&self.path, &self.stages[..1], &plan.world);
        let position: Vec<f64> = self.path.iter().map(|x| x + self.surface_m).collect();
        read(&position, &force, &plan, self.seed)
    }

    /// Whether an estimate at this time (s) counts.
    pub fn counts(&self, time_s: f64) -> bool {
        time_s < self.plan.onset_s || time_s >= self.counts_from_s
    }
}

/// The material, and the one after a swap.
fn stages(material: Material, plan: &Plan) -> Vec<Stage> {
    let mut stages = vec![Stage {
        from_s: 0.0,
        material,
    }];
    if let Some(swap) = plan.swap {
        let [stiffness, damping, exponent] = material.numbers;
        stages.push(Stage {
            from_s: swap.from_s,
            material: Material {
                numbers: [stiffness * swap.stiffness, damping * swap.damping, exponent],
            },
        });
    }
    stages
}

/// When the force first shows the fault (s).
fn shows_s(with: &[f64], without: &[f64], plan: &Plan) -> f64 {
    let differs = SHOWS * plan.force.noise_n;
    let samples = (with.len() as f64 / FINE_HZ * RATE_HZ) as usize;
    let first = (0..samples).find(|index| {
        let at = index * SUBSTEPS;
        (with[at] - without[at]).abs() > differs
    });
    first.map_or(f64::INFINITY, |index| index as f64 / RATE_HZ)
}
