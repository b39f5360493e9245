//! What the refiner finds, and what it claims.

use super::*;

const NOISE: ForceNoise<f64> = ForceNoise {
    raw: 0.02,
    filtered: 0.007,
};

fn gel(i: u32) -> Pooled<f64> {
    let angle = 7.5e-3 * f64::from(i);
    let depth = 2.1 - 2.0 * libm::cos(angle);
    let speed = 1.5 * libm::sin(angle);
    Pooled {
        position: depth,
        speed,
        force: (1.35 + 0.36 * speed) * libm::pow(depth, 1.35),
        count: 1.0,
        ..Pooled::default()
    }
}

const FOUND: Prior<f64> = Prior {
    exponent: 0.2,
    surface: 0.1,
    skew: 0.0,
    aligned: None,
    speed_rounding: 0.0,
};

fn start() -> Candidate<f64> {
    Candidate {
        stiffness: 1.2,
        damping: 0.3,
        exponent: 1.5,
        surface: 0.06,
        residual: 0.01,
    }
}

/// A refiner after so many generations, each of which has learned from these pools.
fn taught<I: Iterator<Item = Pooled<f64>>>(
    generations: u32,
    prior: &Prior<f64>,
    pools: impl Fn() -> I,
) -> Refiner<f64> {
    let mut refiner = Refiner::new(&start(), 0.0, prior);
    for _ in 0..generations {
        refiner = refiner.successor(prior);
        pools().for_each(|at| _ = refiner.learn(&at, &NOISE, 1.0));
    }
    refiner
}

/// Whether it has found K, λ, n, x₀ and τ.
fn assert_found(refiner: &Refiner<f64>, truth: [f64; 5], tolerance: f64) {
    let values = refiner.values();
    for (value, truth) in values.into_iter().zip(truth) {
        assert!((value - truth).abs() < tolerance, "{values:?}");
    }
}

/// The rate of the force of gel.
fn rate(i: u32) -> f64 {
    // The depth moves by 0.015·sin within an instant at a speed of 1.5·sin: that is 0.01 of the unit of time.
    (gel(i + 1).force - gel(i - 1).force) / 0.02
}

#[test]
fn from_a_neighbouring_cell_it_finds_all_four_in_three_generations() {
    let refiner = taught(3, &FOUND, || (0..1500).map(gel));
    // The prior of the last generation: one sample against 1500.
    assert_found(&refiner, [1.35, 0.36, 1.35, 0.0, 0.0], 1e-4);
    assert!(
        refiner.linearization_error < 1e-8,
        "{}",
        refiner.linearization_error
    );
}

#[test]
fn the_order_of_the_samples_does_not_matter() {
    let (mut forth, mut back) = (
        Refiner::new(&start(), 0.0, &FOUND),
        Refiner::new(&start(), 0.0, &FOUND),
    );
    // Errors far above the noise would lose weight by what came before them.
    let noise = ForceNoise {
        raw: 5.0,
        filtered: 2.0,
    };
    (0..800).for_each(|i| _ = forth.learn(&gel(i), &noise, 1.0));
    (0..800)
        .rev()
        .for_each(|i| _ = back.learn(&gel(i), &noise, 1.0));
    for (forth, back) in forth.values().into_iter().zip(back.values()) {
        assert!((forth - back).abs() < 1e-9, "{forth} {back}");
    }
}

#[test]
fn a_known_surface_does_not_move() {
    let mut refiner = Refiner::new(
        &Candidate {
            surface: 0.0,
            ..start()
        },
        0.0,
        &Prior::default(),
    );
    (0..3000).for_each(|i| _ = refiner.learn(&gel(i), &NOISE, 1.0));
    assert_eq!(refiner.values()[3], 0.0);
    assert_eq!(refiner.std_errors(0.0, 0.0, &NOISE)[3], 0.0);
}

#[test]
fn the_gradient_is_that_of_the_prediction() {
    let theta = [1.2, 0.3, 1.5, 0.06, 0.01];
    let at = Pooled {
        rate: 3.0,
        ..gel(200)
    };
    let gradient = predict(&theta, &at).gradient;
    for slot in 0..5 {
        let shifted = |by: f64| {
            let mut other = theta;
            other[slot] += by;
            predict(&other, &at).force
        };
        let slope = (shifted(1e-6) - shifted(-1e-6)) / 2e-6;
        // Central differences of a smooth function; without a variance within the window the
        // gradient is exact.
        assert!(
            (gradient[slot] - slope).abs() < 1e-6 * slope.abs().max(1.0),
            "slot {slot}"
        );
    }
}

#[test]
fn a_force_that_is_read_late_is_told_from_damping() {
    let late = 0.02;
    let skewed = |i: u32| {
        let at = gel(i);
        Pooled {
            force: at.force - late * rate(i),
            rate: rate(i),
            ..at
        }
    };
    let prior = Prior {
        exponent: 0.2,
        skew: 0.05,
        ..FOUND
    };
    let refiner = taught(4, &prior, || (1..1500).map(skewed));
    assert_found(&refiner, [1.35, 0.36, 1.35, 0.0, late], 2e-4);
}

#[test]
fn a_wrong_resting_force_is_within_the_errors_that_consider_it() {
    // The bias that an offset of the force leaves is what the standard errors say of it.
    let offset = 0.01;
    let shifted = |i: u32| {
        let at = gel(i);
        let force = at.force + offset;
        Pooled { force, ..at }
    };
    let refiner = taught(4, &FOUND, || (0..1500).map(shifted));
    assert_considered(&refiner, offset, 0.0);
}

/// The errors that consider a wrong resting force and a drift are as large as what those do.
fn assert_considered(refiner: &Refiner<f64>, offset: f64, drift: f64) {
    let (without, with) = (
        refiner.std_errors(0.0, 0.0, &NOISE),
        refiner.std_errors(offset, drift, &NOISE),
    );
    for (slot, truth) in [1.35, 0.36, 1.35, 0.0].into_iter().enumerate() {
        let bias = (refiner.values()[slot] - truth).abs();
        let claimed = (with[slot] * with[slot] - without[slot] * without[slot]).sqrt();
        // Linear but for what the reference moves.
        assert!(
            (bias / claimed - 1.0).abs() < 0.1,
            "{slot}: {bias} {claimed}"
        );
    }
}

#[test]
fn an_even_drift_within_a_touch_is_within_the_errors_that_consider_it() {
    // 10 mN over each stroke of 838 instants.
    let drift = 0.01 / 838.0;
    let drifting = |i: u32| {
        let at = gel(i);
        let loaded = f64::from(i % 838);
        let force = at.force + drift * loaded;
        Pooled {
            force,
            loaded,
            ..at
        }
    };
    let refiner = taught(4, &FOUND, || (0..1676).map(drifting));
    assert_considered(&refiner, 0.0, drift);
}

/// Gel behind a spring that gives by this, and its force.
fn behind_a_spring(compliance: f64, i: u32) -> Pooled<f64> {
    let at = gel(i);
    let given_way = Pooled {
        position: at.position - compliance * at.force,
        speed: at.speed - compliance * rate(i),
        ..at
    };
    let force = (1.35 + 0.36 * given_way.speed) * libm::pow(given_way.position, 1.35);
    Pooled {
        force,
        rate: rate(i),
        ..at
    }
}

#[test]
fn a_spring_in_series_is_seen_beside_estimates_that_leave_it_out() {
    // 1 % of the depth of 4.1 at the peak of 9.1.
    let compliance = 0.0045;
    let refiner = taught(4, &FOUND, || {
        (1..1500).map(|i| behind_a_spring(compliance, i))
    });
    // Of first order: both the force and the damping that it is found with are a few per cent off.
    let (found, error) = refiner.compliance().unwrap();
    assert!((found / compliance - 1.0).abs() < 0.1, "{found}");
    assert!(found > 5.0 * error, "{found} ± {error}");
    // What it says the spring has moved, it has.
    let moved = refiner.moved_by_compliance(compliance);
    let values = refiner.values();
    for (slot, truth) in [1.35, 0.36, 1.35].into_iter().enumerate() {
        let off = values[slot] - truth;
        assert!((off - moved[slot]).abs() < 0.01, "{slot}: {off} {moved:?}");
    }
    // Damping above all, by 5 %.
    let damping = values[1] / 0.36 - 1.0;
    assert!((-0.06..-0.04).contains(&damping), "{damping}");
}

#[test]
fn without_a_spring_there_is_none() {
    let refiner = taught(4, &FOUND, || (1..1500).map(|i| behind_a_spring(0.0, i)));
    let (found, error) = refiner.compliance().unwrap();
    assert!(found.abs() < 0.1 * error, "{found} ± {error}");
}
