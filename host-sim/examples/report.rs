//! Writes the reports of made-up palpations, to look at what a report looks like:
//! `cargo run --release -p host-sim --example report -- FOLDER`.
//!
//! The forces come from Hunt–Crossley contacts with noise, the estimates from a recursive least
//! squares on the linearised law with forgetting (24): enough to give every figure its typical
//! shape, not the estimator of Palpate.

use std::error::Error;
use std::path::Path;

use estimator_core::estimate::{Estimated, Event};
use estimator_core::law::{ContactLaw, HuntCrossley};
use estimator_core::status::Status;
use palpate::report::estimate::{
    Elastic, EstimateReport, EventKind, EventMark, FinalParameter, ForgettingLaw, Run, Segment,
    Touch, Trajectory,
};
use palpate::report::number::Measured;
use palpate::report::{Input, Provenance, Tone};
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64;

const RATE_HZ: f64 = 1000.0;
const FORGETTING: ForgettingLaw = ForgettingLaw {
    alpha_1: 0.05,
    alpha_2_per_n: 40.0,
    alpha_3_n: 0.12,
};
const NAMES: [(&str, &str); 3] = [
    ("stiffness", "N/m"),
    ("damping", "N s/m"),
    ("exponent", "1"),
];

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).ok_or("which folder?")?;
    let folder = Path::new(&folder);
    std::fs::create_dir_all(folder)?;
    let gel = law(1350.0, 36.0, 1.35, 1e-3);
    let plastic = law(11_500.0, 70.0, 1.2, 1e-3);
    let soft = Motion {
        depth_m: 4.3e-3,
        period_s: 1.0,
        touches: 6,
        seconds: 8.0,
    };
    let stiff = Motion {
        depth_m: 0.95e-3,
        ..soft
    };
    let gel_log = Log::make(&[gel], soft, 0.02);
    let plastic_log = Log::make(&[plastic], stiff, 0.02);
    write(folder, "gel", &[("", &gel_log, 0.02)])?;
    write(
        folder,
        "pair",
        &[("gel", &gel_log, 0.02), ("plastic", &plastic_log, 0.02)],
    )?;
    let change = Motion {
        depth_m: 1.0e-3,
        period_s: 1.2,
        touches: 8,
        seconds: 11.0,
    };
    write(
        folder,
        "change",
        &[("", &Log::make(&[gel, plastic], change, 0.02), 0.02)],
    )?;
    let hour = Motion {
        touches: 3000,
        seconds: 3600.0,
        ..soft
    };
    write(
        folder,
        "hour",
        &[("", &Log::make(&[gel], hour, 0.02), 0.02)],
    )?;
    let cell = law(0.02, 4e-4, 1.5, 1e-6);
    let probe = Motion {
        depth_m: 1.8e-6,
        period_s: 2.0,
        touches: 3,
        seconds: 8.0,
    };
    write(
        folder,
        "afm",
        &[("", &Log::make(&[cell], probe, 4e-10), 4e-10)],
    )?;
    Ok(())
}

fn law(stiffness: f64, damping: f64, exponent: f64, depth_m: f64) -> HuntCrossley<f64> {
    HuntCrossley::new(stiffness, damping, exponent, depth_m)
}

#[derive(Clone, Copy)]
struct Motion {
    depth_m: f64,
    period_s: f64,
    touches: usize,
    seconds: f64,
}

impl Motion {
    /// Touches with half a period between, each a bit different.
    fn at(&self, t: f64) -> (f64, f64) {
        let cycle = 1.2 * self.period_s;
        let number = ((t - 0.5) / cycle).floor();
        let phase = (t - 0.5) - number * cycle;
        let reach = self.depth_m * (0.8 + 0.2 * (number * 1.7).sin());
        let omega = std::f64::consts::TAU / cycle;
        if number < 0.0 || number >= self.touches as f64 {
            return (-0.1 * self.depth_m, 0.0);
        }
        let depth = reach * 0.55 * (1.0 - (omega * phase).cos()) - 0.1 * reach;
        (depth, reach * 0.55 * omega * (omega * phase).sin())
    }
}

/// What a replay would have recorded.
#[derive(Default)]
struct Log {
    time_s: Vec<f64>,
    depth_m: Vec<f64>,
    speed_mps: Vec<f64>,
    measured_n: Vec<f64>,
    estimated_n: Vec<f64>,
    innovation_n: Vec<f64>,
    forgetting: Vec<f64>,
    status: Vec<Status>,
    parameters: [Vec<Option<Estimated<f64>>>; 3],
    touches: Vec<Touch>,
    events: Vec<EventMark>,
    change_s: Option<f64>,
    true_law: Option<HuntCrossley<f64>>,
}

impl Log {
    fn make(laws: &[HuntCrossley<f64>], motion: Motion, noise_n: f64) -> Log {
        let mut rng = Pcg64::seed_from_u64(7);
        let mut log = Log {
            true_law: laws.last().copied(),
            ..Log::default()
        };
        let mut filter = Filter::new(laws[0], noise_n);
        let middle = 0.5 + 1.2 * motion.period_s * (motion.touches as f64 / 2.0).round();
        for i in 0..(motion.seconds * RATE_HZ) as usize {
            let t = i as f64 / RATE_HZ;
            let law = if t < middle {
                laws[0]
            } else {
                laws[laws.len() - 1]
            };
            let (depth, speed) = motion.at(t);
            let noise: f64 = rng.sample(StandardNormal);
            let force = law.force_n(depth, speed).max(0.0) + noise_n * noise;
            log.touch(t, depth, force);
            if laws.len() > 1 && t >= middle && log.change_s.is_none() && depth > 0.0 {
                log.change_s = Some(t + 0.03);
                log.event(t + 0.03, Event::MaterialChange);
                filter = Filter {
                    learned: filter.learned,
                    ..Filter::new(laws[1], noise_n)
                };
            }
            let (innovation, beta) = filter.step(depth, speed, force);
            log.record(t, depth, speed, force, innovation, beta, &filter);
        }
        log.replay();
        log
    }

    fn event(&mut self, time_s: f64, event: Event) {
        let kind = EventKind::Estimator(event);
        self.events.push(EventMark { time_s, kind });
    }

    fn touch(&mut self, t: f64, depth: f64, force: f64) {
        let was = self.depth_m.last().is_some_and(|d| *d > 0.0);
        match (was, depth > 0.0) {
            (false, true) => {
                self.event(t, Event::Contact);
                self.touches.push(Touch {
                    from_s: t,
                    to_s: t,
                    peak_force_n: force,
                    peak_depth_m: depth,
                });
            }
            (true, false) => self.event(t, Event::Release),
            _ => {}
        }
        if let (Some(touch), true) = (self.touches.last_mut(), depth > 0.0) {
            touch.to_s = t;
            touch.peak_force_n = touch.peak_force_n.max(force);
            touch.peak_depth_m = touch.peak_depth_m.max(depth);
        }
    }

    #[expect(clippy::too_many_arguments, reason = "one sample of an example")]
    fn record(
        &mut self,
        t: f64,
        depth: f64,
        speed: f64,
        force: f64,
        innovation: f64,
        beta: f64,
        filter: &Filter,
    ) {
        self.time_s.push(t);
        self.depth_m.push(depth);
        self.speed_mps.push(speed);
        self.measured_n.push(force);
        self.innovation_n.push(innovation);
        self.forgetting.push(beta);
        let estimates = filter.estimates();
        let relative = estimates.map(|e| e.std_error / e.value.abs());
        let since_change = self.change_s.map_or(f64::INFINITY, |change| t - change);
        let status = match filter.learned {
            0 => Status::NoContact,
            1..40 => Status::Unobservable,
            _ if (0.0..0.3).contains(&since_change) => Status::Changed,
            _ if relative.iter().all(|r| *r < 0.02) => Status::Converged,
            _ => Status::Converging,
        };
        self.status.push(status);
        for (slot, estimate) in self.parameters.iter_mut().zip(estimates) {
            slot.push((filter.learned >= 40).then_some(estimate));
        }
    }

    fn replay(&mut self) {
        for i in 0..self.time_s.len() {
            let value = |p: usize| self.parameters[p][i].map(|e| e.value);
            let force = match (value(0), value(1), value(2)) {
                (Some(k), Some(l), Some(n)) => {
                    let depth0 = self.true_law.map_or(1e-3, |law| law.reference_depth_m);
                    law(k, l, n, depth0).force_n(self.depth_m[i], self.speed_mps[i])
                }
                _ => f64::NAN,
            };
            self.estimated_n.push(force);
        }
    }

    fn finals(&self, at: usize) -> Vec<FinalParameter<'static>> {
        let of = |((name, unit), values): (&(&'static str, &'static str), &Vec<Option<_>>)| {
            FinalParameter {
                name,
                unit,
                estimate: values[at],
            }
        };
        NAMES.iter().zip(&self.parameters).map(of).collect()
    }
}

/// Recursive least squares on the gradient of the law, in the logarithms of its parameters.
struct Filter {
    theta: [f64; 3],
    p: [[f64; 3]; 3],
    depth_m: f64,
    noise_n: f64,
    learned: usize,
    scale: f64,
}

impl Filter {
    fn new(near: HuntCrossley<f64>, noise_n: f64) -> Filter {
        let start = [
            1.6 * near.stiffness_n_per_m,
            0.4 * near.damping_ns_per_m,
            1.1,
        ];
        let mut p = [[0.0; 3]; 3];
        for (i, row) in p.iter_mut().enumerate() {
            row[i] = 1.0;
        }
        Filter {
            theta: start.map(f64::ln),
            p,
            depth_m: near.reference_depth_m,
            noise_n,
            learned: 0,
            scale: 0.02 / noise_n,
        }
    }

    fn law(&self) -> HuntCrossley<f64> {
        let [k, l, n] = self.theta.map(f64::exp);
        law(k, l, n, self.depth_m)
    }

    fn step(&mut self, depth: f64, speed: f64, force: f64) -> (f64, f64) {
        let law = self.law();
        let predicted = law.force_n(depth, speed).max(0.0);
        let error = force - predicted;
        if depth <= 0.02 * self.depth_m {
            return (error, 1.0);
        }
        self.learned += 1;
        let beta = FORGETTING.beta(error * self.scale);
        let d = depth / self.depth_m;
        let power = d.powf(law.exponent);
        let phi = [
            law.stiffness_n_per_m * self.depth_m * power,
            law.damping_ns_per_m * speed * power,
            law.exponent * d.ln() * law.force_n(depth, speed),
        ];
        let r = self.noise_n.powi(2) * 30.0;
        let pphi = self
            .p
            .map(|row| row.iter().zip(&phi).map(|(a, b)| a * b).sum::<f64>());
        let s = beta * r + phi.iter().zip(&pphi).map(|(a, b)| a * b).sum::<f64>();
        for i in 0..3 {
            self.theta[i] += (pphi[i] / s * error).clamp(-0.2, 0.2);
            for j in 0..3 {
                self.p[i][j] =
                    (self.p[i][j] - pphi[i] * pphi[j] / s) / beta.max(0.999 + 0.001 * beta);
            }
        }
        (error, beta)
    }

    fn estimates(&self) -> [Estimated<f64>; 3] {
        std::array::from_fn(|i| {
            let value = self.theta[i].exp();
            Estimated {
                value,
                std_error: value * self.p[i][i].max(0.0).sqrt(),
            }
        })
    }
}

fn write(folder: &Path, name: &str, logs: &[(&str, &Log, f64)]) -> Result<(), Box<dyn Error>> {
    let curves: Vec<[Vec<f64>; 3]> = logs.iter().map(|(_, log, _)| elastic(log)).collect();
    let finals: Vec<_> = logs
        .iter()
        .map(|(_, log, _)| log.finals(log.time_s.len() - 1))
        .collect();
    let before: Vec<_> = logs
        .iter()
        .map(|(_, log, _)| {
            log.change_s
                .map(|t| log.finals((t * RATE_HZ) as usize - 200))
        })
        .collect();
    let segments: Vec<Vec<Segment>> = (0..logs.len())
        .map(|i| segments(logs[i].1, before[i].as_deref(), &finals[i]))
        .collect();
    let trajectories: Vec<Vec<Trajectory>> =
        logs.iter().map(|(_, log, _)| trajectories(log)).collect();
    let runs: Vec<Run> = (0..logs.len())
        .map(|i| {
            let (name, log, noise_n) = logs[i];
            let [depth_m, estimated_n, true_n] = &curves[i];
            let scale = 0.02 / noise_n;
            Run {
                name,
                law: "hunt_crossley",
                time_s: &log.time_s,
                depth_m: &log.depth_m,
                speed_mps: &log.speed_mps,
                measured_n: &log.measured_n,
                estimated_n: &log.estimated_n,
                innovation_n: &log.innovation_n,
                forgetting: &log.forgetting,
                status: &log.status,
                noise_n: Some(noise_n),
                forgetting_law: Some(ForgettingLaw {
                    alpha_2_per_n: FORGETTING.alpha_2_per_n * scale,
                    alpha_3_n: FORGETTING.alpha_3_n / scale,
                    ..FORGETTING
                }),
                parameters: &trajectories[i],
                finals: &finals[i],
                segments: &segments[i],
                touches: &log.touches,
                events: &log.events,
                elastic: Some(Elastic {
                    depth_m,
                    estimated_n,
                    true_n,
                }),
                force_rmse_n: Some(1.07 * noise_n),
                settled_at_s: Some(0.81),
                reference_depth_m: log.true_law.map(|law| law.reference_depth_m),
            }
        })
        .collect();
    let report = EstimateReport {
        title: &format!("Estimate of {name}.csv"),
        tone: Tone::Good,
        badge: "converged",
        verdict: &format!(
            "A Hunt–Crossley contact: {}; it explains the force down to the noise of the load cell.",
            sentence(&finals[finals.len() - 1])
        ),
        runs: &runs,
        notes: &["The log is sampled at 1000 Hz without gaps.".into(), "Damping is identified mostly from the loading strokes: the speed while unloading is lower.".into()],
        provenance: Provenance::new(format!("palpate estimate {name}.csv --law auto --out report"))
            .input(Input::new(format!("{name}.csv"), "sha256:ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"))
            .setting("Filter", "Savitzky–Golay, half width 10 samples")
            .setting("Method", "two-stage Hunt–Crossley, (25)–(37)"),
    };
    let path = folder.join(format!("{name}.html"));
    report.document().write(&path)?;
    println!(
        "{} {} kB",
        path.display(),
        std::fs::metadata(&path)?.len() / 1024
    );
    Ok(())
}

fn sentence(finals: &[FinalParameter]) -> String {
    let part = |p: &FinalParameter| {
        let e = p.estimate?;
        Some(format!(
            "{} {}",
            p.name,
            Measured::new(e.value, Some(e.std_error), p.unit)
        ))
    };
    finals
        .iter()
        .filter_map(part)
        .collect::<Vec<_>>()
        .join(", ")
}

fn trajectories(log: &Log) -> Vec<Trajectory<'_>> {
    let of = |((name, unit), values): (&(&'static str, &'static str), _)| Trajectory {
        name,
        unit,
        values,
    };
    NAMES
        .iter()
        .zip(log.parameters.iter().map(Vec::as_slice))
        .map(of)
        .collect()
}

fn segments<'a>(
    log: &Log,
    before: Option<&'a [FinalParameter<'a>]>,
    finals: &'a [FinalParameter<'a>],
) -> Vec<Segment<'a>> {
    let end = log.time_s[log.time_s.len() - 1];
    match (log.change_s, before) {
        (Some(t), Some(before)) => vec![
            Segment {
                from_s: log.touches[0].from_s,
                to_s: t,
                parameters: before,
            },
            Segment {
                from_s: t,
                to_s: end,
                parameters: finals,
            },
        ],
        _ => vec![Segment {
            from_s: log.touches[0].from_s,
            to_s: end,
            parameters: finals,
        }],
    }
}

/// Depth, estimated and true elastic force.
fn elastic(log: &Log) -> [Vec<f64>; 3] {
    let end = log
        .touches
        .iter()
        .map(|t| t.peak_depth_m)
        .fold(0.0, f64::max);
    let depths: Vec<f64> = (0..=100).map(|i| end * f64::from(i) / 100.0).collect();
    let value = |p: usize| {
        log.parameters[p]
            .last()
            .copied()
            .flatten()
            .map_or(0.0, |e| e.value)
    };
    let truth = log.true_law.unwrap_or(law(0.0, 0.0, 1.0, 1e-3));
    let estimate = law(value(0), value(1), value(2), truth.reference_depth_m);
    let force = |law: HuntCrossley<f64>| depths.iter().map(|d| law.force_n(*d, 0.0)).collect();
    [depths.clone(), force(estimate), force(truth)]
}
