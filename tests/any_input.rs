//! Whatever comes in, only finite numbers come out, no memory is allocated, and the estimator finds the
//! material again once the input is good.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use estimator_core::estimate::config::{Config, Filter, Surface};
use estimator_core::estimate::method::Method;
use estimator_core::physics::law::{ContactLaw, HuntCrossley};
use estimator_core::{Estimate, Faults, Sample, State, Status, step};
use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg64;
use tests::tolerance;

const SEED_GARBAGE: u64 = 21;
const SEED_LONG: u64 = 22;

/// An allocator that counts the allocations of each thread.
struct Counting;

thread_local! {
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
}

// SAFETY: every call is passed on to the system's allocator unchanged.
#[allow(unsafe_code)]
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.with(|count| count.set(count.get() + 1));
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

fn allocations() -> u64 {
    ALLOCATIONS.with(Cell::get)
}

/// Every method behind both filters, with the surface known and from the impact.
fn configurations() -> Vec<Config> {
    let filters = [
        Filter::SavitzkyGolay { half_width: 10 },
        Filter::StateVariable {
            cutoff_hz: 40.0,
            damping_ratio: 1.0,
        },
    ];
    let mut all = Vec::new();
    let methods = [
        Method::KELVIN_VOIGT,
        Method::HUNT_CROSSLEY_TWO_STAGE,
        Method::ZENER_ARX,
        Method::HAMMERSTEIN_CASCADE,
        Method::HAMMERSTEIN_CASCADE_2,
        Method::ZENER_BANK,
        Method::QUASI_LINEAR_BANK,
        Method::QUASI_LINEAR_BANK_2,
        Method::HUNT_CROSSLEY_LOG_LINEAR,
        Method::HUNT_CROSSLEY_BANK_SKEW,
    ];
    for method in methods {
        for filter in filters {
            for surface in [Surface::AtImpact, Surface::Known { position_m: 0.0 }] {
                let mut config = Config {
                    method,
                    filter,
                    ..Config::default()
                };
                config.contact.surface = surface;
                all.push(config);
            }
        }
    }
    all
}

/// The sample `i` of gel under strokes of 3 mm at 1.2 Hz that leave it each time, in steps of 5 mN and 1 µm.
fn palpation(i: u64) -> Sample<f32> {
    let gel = HuntCrossley::new(1350.0_f64, 36.0, 1.35, 1e-3);
    let omega = std::f64::consts::TAU * 1.2;
    let angle = omega * (i.max(500) - 500) as f64 * 1e-3;
    let position_m = -5e-4 + 1.75e-3 * (1.0 - angle.cos());
    let force_n = gel.force_n(position_m, 1.75e-3 * omega * angle.sin());
    Sample {
        time_us: (i + 1) * 1000,
        position_m: ((position_m / 1e-6).floor() * 1e-6) as f32,
        force_n: ((force_n / 5e-3).round() * 5e-3) as f32,
        faults: Faults::NONE,
    }
}

/// A sample made of anything: ordinary numbers, huge and tiny ones, any bit pattern at all.
fn garbage(rng: &mut Pcg64, time_us: u64) -> Sample<f32> {
    let mut number = || match rng.random_range(0..5) {
        0 => f32::from_bits(rng.next_u32()),
        1 => rng.random_range(-1e6..1e6),
        2 => rng.random_range(-20.0..20.0),
        3 => rng.random_range(-5e-3..5e-3),
        _ => [
            0.0,
            -0.0,
            f32::NAN,
            f32::INFINITY,
            f32::MAX,
            f32::MIN_POSITIVE,
            1e-42,
        ][rng.random_range(0..7)],
    };
    let (position_m, force_n) = (number(), number());
    let time_us = match rng.random_range(0..50) {
        0 => rng.next_u64(),
        1 => time_us.saturating_sub(5000),
        2 => time_us + 90_000,
        _ => time_us,
    };
    Sample {
        time_us,
        position_m,
        force_n,
        faults: Faults::from_bits(rng.random_range(0..128)),
    }
}

#[test]
fn nothing_that_is_not_finite_comes_out_of_any_bit_pattern() {
    for (number, config) in configurations().into_iter().enumerate() {
        let params = config.validate::<f32>().unwrap();
        let mut rng = Pcg64::seed_from_u64(SEED_GARBAGE + number as u64);
        let mut state = State::new(&params);
        for i in 0..100_000 {
            // Stretches of palpation between the garbage, so that there is something to spoil.
            let sample = match (i / 4000) % 2 {
                0 => palpation(i),
                _ => garbage(&mut rng, (i + 1) * 1000),
            };
            let estimate = step(&params, &mut state, sample);
            assert!(
                estimate.is_finite(),
                "sample {i} of {config:?}: {sample:?} gave {estimate:?}"
            );
            let errors = estimate.parameters.iter().flatten().map(|p| p.std_error);
            assert!(
                errors.into_iter().all(|e| e >= 0.0),
                "sample {i}: {estimate:?}"
            );
        }
    }
}

/// The last estimate after good samples, a second of bad ones, and good ones again.
fn spoiled(config: Config, bad: impl Fn(u64) -> Sample<f32>) -> Estimate<f32> {
    let params = config.validate::<f32>().unwrap();
    let mut state = State::new(&params);
    let samples = (0..8000).map(palpation).chain((8000..9000).map(bad));
    let samples = samples.chain((9000..24_000).map(palpation));
    samples
        .map(|sample| step(&params, &mut state, sample))
        .last()
        .unwrap()
}

#[test]
fn the_gel_is_found_again_after_every_kind_of_bad_second() {
    let mut config = Config::default();
    config.contact.surface = Surface::Known { position_m: 0.0 };
    config.contact.force_noise_n = Some(0.02);
    type Bad = fn(u64) -> Sample<f32>;
    let kinds: [(&str, Bad); 6] = [
        ("not a number", |i| Sample {
            force_n: f32::NAN,
            ..palpation(i)
        }),
        ("a broken cable", |i| Sample {
            force_n: 1e5,
            ..palpation(i)
        }),
        ("a stuck encoder", |i| Sample {
            position_m: 1e-3,
            ..palpation(i)
        }),
        ("an encoder that jumps", |i| Sample {
            position_m: (i % 7) as f32,
            ..palpation(i)
        }),
        ("time that stands still", |i| Sample {
            time_us: 8_000_000,
            ..palpation(i)
        }),
        ("force and position exchanged", |i| {
            let sample = palpation(i);
            Sample {
                position_m: sample.force_n,
                force_n: sample.position_m,
                ..sample
            }
        }),
    ];
    for (kind, bad) in kinds {
        let end = spoiled(config, bad);
        let truth = [1350.0, 36.0, 1.35];
        for (parameter, truth) in end.parameters.iter().zip(truth) {
            let error = parameter.map_or(f32::INFINITY, |p| (p.value / truth - 1.0).abs());
            // 15 s after the bad second, as close as 15 s after the first touch.
            assert!(
                error < tolerance::CLOSE as f32,
                "after {kind}: {:?}",
                end.parameters
            );
        }
    }
}

#[test]
fn a_ten_minute_hold_leaves_the_estimates_where_they_were() {
    // GIVEN gel, palpated until the deepest point of the ninth stroke, 0.5 s + 8.5/1.2 s,
    const DEEPEST: u64 = 7583;
    let mut config = Config::default();
    config.contact.surface = Surface::Known { position_m: 0.0 };
    config.contact.force_noise_n = Some(0.02);
    let params = config.validate::<f32>().unwrap();
    let mut state = State::new(&params);
    let before = (0..DEEPEST)
        .map(|i| step(&params, &mut state, palpation(i)))
        .last()
        .unwrap();
    // WHEN it is held there for ten minutes, with noise of 0.02 N and of a count
    let mut rng = Pcg64::seed_from_u64(SEED_LONG);
    let held = palpation(DEEPEST);
    let mut end = before;
    for i in DEEPEST..DEEPEST + 600_000 {
        let count = 1e-6 * rng.random_range(-1..=1) as f32;
        let noise_n = 0.0346 * rng.random_range(-1.0..1.0_f32);
        let sample = Sample {
            time_us: (i + 1) * 1000,
            position_m: held.position_m + count,
            force_n: held.force_n + noise_n,
            faults: Faults::NONE,
        };
        end = step(&params, &mut state, sample);
    }
    // THEN nothing has moved, and the standard errors have kept their size.
    for (now, then) in end.parameters.iter().zip(before.parameters).take(3) {
        let (Some(now), Some(then)) = (now, then) else {
            panic!(
                "not observable: {:?}, then {:?}",
                before.parameters, end.parameters
            );
        };
        assert!(
            f64::from((now.value / then.value - 1.0).abs()) < tolerance::HELD.end,
            "{then:?} -> {now:?}"
        );
        assert!(
            (0.3..3.0).contains(&(now.std_error / then.std_error)),
            "{then:?} -> {now:?}"
        );
    }
    assert_ne!(end.status, Status::NoContact);
}

#[test]
fn a_hundred_thousand_steps_ask_for_no_memory() {
    for config in configurations() {
        let params = config.validate::<f32>().unwrap();
        let mut state = State::new(&params);
        let before = allocations();
        let mut contacts = 0;
        for i in 0..100_000 {
            contacts += u32::from(step(&params, &mut state, palpation(i)).event.is_some());
        }
        assert_eq!(allocations(), before, "{config:?}");
        assert!(
            contacts > 100,
            "the run touched and learned: {contacts} events"
        );
    }
    // The counter does count.
    let before = allocations();
    drop(std::hint::black_box(Box::new(1)));
    assert_eq!(allocations(), before + 1);
}
