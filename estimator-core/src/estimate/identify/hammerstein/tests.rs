//! The cascade on presses without noise: what it finds, and what it cannot.

use super::*;
use crate::estimate::config::{Config, Weight};
use crate::physics::law::{Elastic, QuasiLinear, RelaxingLaw};

const NOISE: ForceNoise<f64> = ForceNoise {
    raw: 0.02,
    filtered: 0.005,
};

/// A ramp of `press_ms` to 3 mm and a hold, without noise or filter, scaled by 1 mm, 10 mm/s, 1 N.
fn press<const R: usize, const N: usize, const M: usize>(
    config: Config,
    modes: [RelaxationMode<f64>; M],
    press_ms: u32,
    seconds: u32,
) -> Cascade<f64, R, N> {
    let params = config.validate().unwrap().identify;
    let mut cascade = Cascade::new(&params);
    let law = QuasiLinear {
        elastic: Elastic::Power {
            stiffness_n_per_m: 2000.0,
            exponent: 1.6,
            reference_depth_m: 1e-3,
        },
        modes,
    };
    let mut memory = law.at_rest();
    for i in 1..=1000 * seconds {
        let depth_m = 3e-3 * (f64::from(i) / f64::from(press_ms)).min(1.0);
        let at = Instant {
            depth: depth_m / 1e-3,
            speed: if i <= press_ms {
                300.0 / f64::from(press_ms)
            } else {
                0.0
            },
            force: law.step(&mut memory, depth_m, 0.0, 1e-3),
            noise: NOISE,
            ..Instant::default()
        };
        // The filter's memory must lie within the contact.
        if i > params.memory_samples {
            cascade.learn(&params, &at, 1.0);
        } else {
            cascade.observe(&at, true);
        }
    }
    cascade
}

fn mode(fraction: f64, rate_per_s: f64) -> RelaxationMode<f64> {
    RelaxationMode {
        fraction,
        rate_per_s,
    }
}

#[test]
fn a_slow_mode_is_found_with_either_weight() {
    for weight in [Weight::Force, Weight::ForceSquared] {
        let mut config = Config::default();
        config.cascade.weight = weight;
        let cascade = press::<1, 2, 1>(config, [mode(0.3, 0.05)], 100, 40);
        let [found] = cascade.modes().unwrap();
        let [stiffness, exponent, ..] = cascade.estimates(&Instant::uncertain(NOISE, 0.0));
        // What relaxes on the way: cνt/(n+1) = 0.06 % at 0.1 s, of which c keeps (1−c)/c.
        assert!((found.fraction / 0.3 - 1.0).abs() < 2e-3, "{found:?}");
        assert!((found.rate_per_s / 0.05 - 1.0).abs() < 2e-3, "{found:?}");
        assert!((stiffness.value / 2.0 - 1.0).abs() < 1e-3, "{stiffness:?}");
        assert!((exponent.value - 1.6).abs() < 1e-3, "{exponent:?}");
    }
}

#[test]
fn without_a_fast_press_there_is_no_elastic_response_to_build_on() {
    let mut config = Config::default();
    config.cascade.loading_speed_mps = Some(0.05);
    let cascade = press::<1, 2, 1>(config, [mode(0.3, 0.05)], 100, 10);
    assert!(
        cascade
            .estimates(&Instant::uncertain(NOISE, 0.0))
            .iter()
            .all(|p| !p.observable())
    );
}

#[test]
fn what_does_not_relax_has_no_modes() {
    let cascade = press::<1, 2, 1>(Config::default(), [mode(0.0, 1.0)], 100, 10);
    let [stiffness, exponent, fraction, rate, ..] =
        cascade.estimates(&Instant::uncertain(NOISE, 0.0));
    assert!((stiffness.value / 2.0 - 1.0).abs() < 1e-3, "{stiffness:?}");
    assert!((exponent.value - 1.6).abs() < 1e-3, "{exponent:?}");
    assert!(!(fraction.observable() && rate.observable()));
}

#[test]
fn two_slow_modes_are_told_apart_roughly() {
    let truth = [mode(0.2, 0.3), mode(0.15, 0.02)];
    // Γ₁ knows the elastic response from the start and never sees a fast press: otherwise the
    // 0.25 % that relax on the way look like a fast mode.
    let mut config = Config::default();
    config.cascade.loading_speed_mps = Some(1.0);
    config.initial.stiffness_n_per_m = 2000.0;
    config.initial.exponent = 1.6;
    let cascade = press::<2, 4, 2>(config, truth, 100, 100);
    let found = cascade.modes().unwrap();
    // The second difference of z weighs the press most: what its first 17 ms lack, before the
    // filter's window is full, costs the fast mode 7 and 14 %, and makes the slow rate 0.035.
    let bounds = [(0.1, 0.2), (0.05, 1.0)];
    for ((found, truth), (fraction, rate)) in found.iter().zip(truth).zip(bounds) {
        assert!(
            (found.fraction / truth.fraction - 1.0).abs() < fraction,
            "{found:?}"
        );
        assert!(
            (found.rate_per_s / truth.rate_per_s - 1.0).abs() < rate,
            "{found:?}"
        );
    }
}

#[test]
fn a_surface_that_may_be_off_widens_the_elastic_errors() {
    let cascade = press::<1, 2, 1>(Config::default(), [mode(0.3, 0.05)], 100, 40);
    let (sure, unsure) = (
        cascade.estimates(&Instant::uncertain(NOISE, 0.0)),
        cascade.estimates(&Instant::uncertain(NOISE, 0.05)),
    );
    for (sure, unsure) in sure.iter().zip(&unsure).take(2) {
        assert!(
            unsure.std_error > 2.0 * sure.std_error,
            "{sure:?} {unsure:?}"
        );
    }
}
