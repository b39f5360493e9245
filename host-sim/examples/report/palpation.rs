//! Made-up palpations: Hunt–Crossley contacts with noise, and a simple estimate of them.

use estimator_core::estimate::status::Status;
use estimator_core::estimate::{Estimated, Event};
use estimator_core::physics::law::{ContactLaw, HuntCrossley};
use palpate::replay::{EventKind, EventMark, Touch};
use palpate::report::estimate::{FinalParameter, ForgettingLaw};
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64;

pub(crate) const RATE_HZ: f64 = 1000.0;
pub(crate) const FORGETTING: ForgettingLaw = ForgettingLaw {
    alpha_1: 0.05,
    alpha_2_per_n: 40.0,
    alpha_3_n: 0.12,
};
pub(crate) const NAMES: [(&str, &str); 3] = [
    ("stiffness", "N/m"),
    ("damping", "N s/m"),
    ("exponent", "1"),
];

pub(crate) fn law(stiffness: f64, damping: f64, exponent: f64, depth_m: f64) -> HuntCrossley<f64> {
    HuntCrossley::new(stiffness, damping, exponent, depth_m)
}

#[derive(Clone, Copy)]
pub(crate) struct Motion {
    pub(crate) depth_m: f64,
    pub(crate) period_s: f64,
    pub(crate) touches: usize,
    pub(crate) seconds: f64,
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
pub(crate) struct Log {
    pub(crate) time_s: Vec<f64>,
    pub(crate) depth_m: Vec<f64>,
    pub(crate) speed_mps: Vec<f64>,
    pub(crate) measured_n: Vec<f64>,
    pub(crate) estimated_n: Vec<f64>,
    pub(crate) innovation_n: Vec<f64>,
    pub(crate) forgetting: Vec<f64>,
    pub(crate) status: Vec<Status>,
    pub(crate) parameters: [Vec<Option<Estimated<f64>>>; 3],
    pub(crate) touches: Vec<Touch>,
    pub(crate) events: Vec<EventMark>,
    pub(crate) change_s: Option<f64>,
    pub(crate) true_law: Option<HuntCrossley<f64>>,
}

impl Log {
    pub(crate) fn make(laws: &[HuntCrossley<f64>], motion: Motion, noise_n: f64) -> Log {
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
                    ..Touch::default()
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

    pub(crate) fn finals(&self, at: usize) -> Vec<FinalParameter<'static>> {
        let of = |((name, unit), values): (&(&'static str, &'static str), &Vec<Option<_>>)| {
            FinalParameter {
                name,
                unit,
                estimate: values[at],
                truth: None,
            }
        };
        NAMES.iter().zip(&self.parameters).map(of).collect()
    }
}

/// Recursive least squares on the gradient of the law, in the logarithms of its parameters.
pub(crate) struct Filter {
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
