//! The further rows of the table: skew, swap, hours of palpation, holds, precision, ARMCMC.

use estimator_core::estimate::config::{Config, Reference, Surface};
use estimator_core::estimate::method::Method;
use estimator_core::estimate::{Estimate, Event, Parameters};
use estimator_core::maths::scalar::Real;
use estimator_core::physics::law::{ContactLaw, HuntCrossley, Law, unilateral};
use estimator_core::{Sample, State, step};
use palpate::motion::{Motion, Segment};
use palpate::plant::{Contact, Encoder, GEL, PLASTIC, Rig, Run, Stage};
use palpate::replay::samples;
use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

use super::cases::{Case, SETTINGS, Stroke, Touched, motion, reach};
use super::floor::Floor;
use super::score::{Row, errors, score};
use crate::quantile::quantile;
use crate::tolerance::CLOSE;

/// Errors of λ and of the skew on plastic whose force is read up to 2 ms late or early.
#[derive(Clone, Debug, Default)]
pub struct Skew {
    damping: Vec<f64>,
    skew_s: Vec<f64>,
    over_floor: Vec<f64>,
}

impl Skew {
    /// The errors of one method.
    pub fn of(method: Method, seeds: u64) -> Skew {
        let mut found = Skew::default();
        for seed in 1..=seeds {
            let skew_s = Pcg64::seed_from_u64(seed).random_range(-2e-3..2e-3);
            let stroke = [Stroke::Sine, Stroke::Ramp][seed as usize % 2];
            let case = Case::new(Touched::Plastic, stroke, seed).skewed(skew_s, seed);
            let end = last::<f32>(
                Config {
                    method,
                    ..Config::default()
                },
                samples(&case.log),
            );
            let damping = errors(&end, &case.truth)[1];
            found.damping.push(damping);
            let floor = Floor::skewed(&case, false, 1.0);
            found.over_floor.push(damping / floor.sigma[1]);
            if method == Method::HUNT_CROSSLEY_BANK_SKEW {
                let skew = end.parameters[3].map_or(f64::INFINITY, |p| f64::from(p.value));
                found.skew_s.push((skew - skew_s).abs());
            }
        }
        found
    }

    /// The error of λ over its Cramér–Rao bound with the skew unknown, root mean square.
    pub fn over_floor(&self) -> f64 {
        let squares = self.over_floor.iter().map(|ratio| ratio * ratio);
        (squares.sum::<f64>() / self.over_floor.len() as f64).sqrt()
    }

    /// The `share`-quantiles of the relative error of λ and of the error of the skew (s).
    pub fn errors(&self, share: f64) -> (f64, f64) {
        let of = |errors: &Vec<f64>| quantile(errors, share);
        (of(&self.damping), of(&self.skew_s))
    }
}

fn last<T: Real>(config: Config, samples: impl Iterator<Item = Sample<T>>) -> Estimate<T> {
    let params = config
        .validate()
        .expect("the settings of the table are valid");
    let mut state = State::new(&params);
    let estimates = samples.map(|sample| step(&params, &mut state, sample));
    estimates.last().expect("there are samples")
}

/// How a method copes with gel that is swapped for plastic, or plastic for gel.
#[derive(Clone, Copy, Debug)]
pub struct Swap {
    /// The time (s) from the first touch of the new material until K, λ, n stay within 5 % of its values.
    pub settles_s: f64,
    /// The number of flags before the swap, and after it.
    pub flags: [u32; 2],
}

impl Swap {
    /// Runs one method over one swap, without telling it the surface.
    pub fn of(method: Method, seed: u64) -> Swap {
        let (run, swap_s, new, surface_m) = swapped(seed);
        let config = Config {
            method,
            ..Config::default()
        };
        let params = config.validate::<f32>().expect("the defaults are valid");
        let mut state = State::new(&params);
        let touched = |index: &usize| {
            run.truth.time_s[*index] > swap_s && run.truth.position_m[*index] > surface_m
        };
        let touch = (0..run.truth.time_s.len()).find(touched);
        let touched_s = run.truth.time_s[touch.expect("the new material is touched")];
        let truth = [
            new.stiffness_n_per_m,
            new.damping_ns_per_m,
            new.exponent,
            surface_m,
        ];
        let log = run.log.uniform().expect("the rig samples evenly");
        let mut swap = Swap {
            settles_s: 0.0,
            flags: [0; 2],
        };
        for (time_s, sample) in log.time_s.iter().zip(samples(&log)) {
            let estimate = step(&params, &mut state, sample);
            let after = usize::from(*time_s > swap_s);
            swap.flags[after] += u32::from(estimate.event == Some(Event::MaterialChange));
            if errors(&estimate, &truth)
                .into_iter()
                .any(|error| error > CLOSE)
            {
                swap.settles_s = (time_s - touched_s).max(0.0);
            }
        }
        swap
    }
}

/// Five seconds of strokes into one material, five into the other.
fn swapped(seed: u64) -> (Run, f64, HuntCrossley<f64>, f64) {
    let mut rng = Pcg64::seed_from_u64(seed);
    let laws = if seed.is_multiple_of(2) {
        [GEL.law, PLASTIC.law]
    } else {
        [PLASTIC.law, GEL.law]
    };
    let surface_m = rng.random_range(-5e-4..5e-4);
    let mut segments = vec![Segment::Hold { seconds: 0.3 }];
    let mut start_m = 0.0;
    let mut swap_s = 0.3;
    for (which, law) in laws.iter().enumerate() {
        let frequency_hz = rng.random_range(0.9..1.6);
        let peak_n = rng.random_range(5.0..14.0);
        let (depth_m, gap_m) = reach(law, std::f64::consts::PI * frequency_hz, peak_n);
        if which == 0 {
            start_m = -gap_m;
        } else {
            let (to_m, speed_mps) = (-gap_m, 0.005);
            segments.push(Segment::Hold { seconds: 0.2 });
            segments.push(Segment::Ramp { to_m, speed_mps });
        }
        let seconds = (5.0 * frequency_hz).ceil() / frequency_hz;
        swap_s += if which == 0 { seconds + 0.1 } else { 0.0 };
        segments.push(Segment::Sine {
            mean_m: 0.5 * (depth_m - gap_m),
            amplitude_m: 0.5 * (depth_m + gap_m),
            frequency_hz,
            seconds,
        });
    }
    let motion = Motion::new(start_m, segments).expect("a swap is a valid motion");
    let stage = |law, until_s| Stage {
        until_s,
        contact: Contact {
            law: Law::HuntCrossley(law),
            surface_m,
            ..Contact::FREE
        },
    };
    let schedule = [stage(laws[0], swap_s), stage(laws[1], f64::INFINITY)];
    let run = Rig::default().run(&schedule, &motion.shifted(surface_m), seed);
    (
        run.expect("the rig follows gel and plastic"),
        swap_s,
        laws[1],
        surface_m,
    )
}

/// The samples of one material, stroke after stroke of changing speed and depth. They are made piece by
/// piece, since the truth of an hour does not fit into memory.
pub(crate) fn palpating(
    touched: Touched,
    seconds: f64,
    seed: u64,
) -> (HuntCrossley<f64>, impl Iterator<Item = Sample<f64>>) {
    let mut rng = Pcg64::seed_from_u64(seed);
    let law = touched.law(&mut rng);
    // All pieces have the same encoder: its zero must not jump between them.
    let encoder = Encoder::new(1e-6, seed);
    let mut rig = Rig::default();
    rig.sensors.position_step_m = 0.0;
    let contact = Contact {
        law: Law::HuntCrossley(law),
        surface_m: 0.0,
        ..Contact::FREE
    };
    let out = Segment::Ramp {
        to_m: -5e-4,
        speed_mps: 0.01,
    };
    let back = Motion::new(0.0, vec![out, Segment::Hold { seconds: 0.1 }]);
    let back = back.expect("a way out is a valid motion");
    let pieces = (seconds / 8.0).ceil() as u64;
    let piece = move |number: u64| {
        let stroke = if number.is_multiple_of(2) {
            Stroke::Sine
        } else {
            Stroke::Ramp
        };
        let peak_n = rng.random_range(5.0..14.0);
        let motion = motion(&mut rng, stroke, &law, peak_n).then(&back);
        let run = rig.run(&Stage::throughout(contact), &motion, seed + number);
        let run = run.expect("the rig follows every material of the table");
        let log = run.log.uniform().expect("the rig samples evenly");
        log.position_m
            .into_iter()
            .zip(log.force_n)
            .collect::<Vec<_>>()
    };
    let sampled = (0..pieces).flat_map(piece).zip(1u64..);
    let samples = sampled.map(move |((position_m, force_n), count)| Sample {
        time_us: 1000 * count,
        position_m: encoder.read_m(position_m),
        force_n,
        ..Sample::default()
    });
    (law, samples)
}

fn narrow(sample: Sample<f64>) -> Sample<f32> {
    Sample {
        time_us: sample.time_us,
        position_m: sample.position_m as f32,
        force_n: sample.force_n as f32,
        faults: sample.faults,
    }
}

/// The number of changes that are flagged in `seconds` of palpation in which nothing changes.
pub fn false_flags(touched: Touched, seconds: f64, seed: u64) -> usize {
    let params = Config::default()
        .validate::<f32>()
        .expect("the defaults are valid");
    let mut state = State::new(&params);
    let (_, samples) = palpating(touched, seconds, seed);
    let estimates = samples.map(|sample| step(&params, &mut state, narrow(sample)));
    estimates
        .filter(|e| e.event == Some(Event::MaterialChange))
        .count()
}

/// The largest relative difference of K, λ, n between f32 and f64 after `seconds` of palpation.
pub fn single_against_double(touched: Touched, seconds: f64, seed: u64) -> f64 {
    let samples = || palpating(touched, seconds, seed).1;
    let single = last::<f32>(Config::default(), samples().map(narrow));
    let double = last::<f64>(Config::default(), samples());
    let pairs = single.parameters.iter().zip(&double.parameters).take(3);
    pairs
        .map(|pair| match pair {
            (Some(single), Some(double)) => (f64::from(single.value) / double.value - 1.0).abs(),
            _ => f64::INFINITY,
        })
        .fold(0.0, f64::max)
}

/// The largest relative change of K, λ, n over a hold after 8 s of palpation, and the largest factor by
/// which a standard error grew.
pub fn hold(touched: Touched, seconds: f64, seed: u64) -> (f64, f64) {
    let params = Config::default()
        .validate::<f32>()
        .expect("the defaults are valid");
    let mut state = State::new(&params);
    let (law, samples) = palpating(touched, 8.0, seed);
    let estimates = samples.map(|sample| step(&params, &mut state, narrow(sample)));
    let before = estimates.last().expect("there are samples");
    let (depth_m, _) = reach(&law, 1.0, 8.0);
    let way = vec![
        Segment::Ramp {
            to_m: depth_m,
            speed_mps: 2.0 * depth_m,
        },
        Segment::Hold { seconds },
    ];
    let motion = Motion::new(-2e-4, way).expect("a hold is a valid motion");
    let contact = Contact {
        law: Law::HuntCrossley(law),
        surface_m: 0.0,
        ..Contact::FREE
    };
    let run = Rig::default().run(&Stage::throughout(contact), &motion, seed);
    let log = run
        .expect("a hold")
        .log
        .uniform()
        .expect("the rig samples evenly");
    let later = samples_after(&log, before.time_us + 100_000);
    let after = later.map(|sample| step(&params, &mut state, sample)).last();
    compare(
        &before.parameters,
        &after.expect("there are samples").parameters,
    )
}

fn samples_after(
    log: &palpate::log::UniformLog,
    time_us: u64,
) -> impl Iterator<Item = Sample<f32>> + '_ {
    samples(log).map(move |sample| Sample {
        time_us: time_us + sample.time_us,
        ..sample
    })
}

fn compare(before: &Parameters<f32>, after: &Parameters<f32>) -> (f64, f64) {
    let pairs = before.iter().zip(after).take(3);
    pairs.fold((0.0, 0.0), |(moved, grew), pair| match pair {
        (Some(then), Some(now)) => {
            let change = f64::from(now.value / then.value - 1.0).abs();
            let growth = f64::from(now.std_error / then.std_error);
            (f64::max(moved, change), f64::max(grew, growth))
        }
        _ => (f64::INFINITY, f64::INFINITY),
    })
}

/// The default method on all settings at a given noise of the force (N), without telling it the surface.
pub fn at_noise(noise_n: f64, seeds: u64) -> Row {
    let mut rig = Rig::default();
    rig.sensors.force_noise_n = noise_n;
    let mut row = Row::default();
    for (touched, stroke) in SETTINGS {
        for seed in 1..=seeds {
            let case = Case::on(&rig, touched, stroke, seed);
            row.push(score(&case, Method::HUNT_CROSSLEY_BANK, false));
        }
    }
    row
}

/// The setting of ARMCMC (Agand et al. 2023) in its own units: K = 4, B = 2.3, n = 1.7, δ₀ = 1, force
/// noise of variance 0.1, 1 kHz, 20 s, strokes of 3 at 0.5 Hz that leave contact. Gives the relative errors
/// of K, B and n.
pub fn armcmc(method: Method, seed: u64) -> [f64; 3] {
    let law = HuntCrossley::new(4.0, 2.3, 1.7, 1.0);
    let mut rng = Pcg64::seed_from_u64(seed);
    let omega = std::f64::consts::PI;
    let mut config = Config {
        method,
        reference: Reference {
            depth_m: 1.0,
            force_n: 1.0,
        },
        ..Config::default()
    };
    // ARMCMC knows the surface.
    config.contact.surface = Surface::Known { position_m: 0.0 };
    let samples = (1..=20_000u64).map(|count| {
        let angle = omega * (count.max(300) - 300) as f64 * 1e-3;
        let depth = 1.5 * (1.0 - angle.cos()) - 0.2;
        let speed = if count > 300 {
            1.5 * omega * angle.sin()
        } else {
            0.0
        };
        let noise: f64 = StandardNormal.sample(&mut rng);
        let force = unilateral(law.force_n(depth, speed)) + 0.1_f64.sqrt() * noise;
        Sample {
            time_us: 1000 * count,
            position_m: depth as f32,
            force_n: force as f32,
            ..Sample::default()
        }
    });
    errors(&last::<f32>(config, samples), &[4.0, 2.3, 1.7, 0.0])
}
