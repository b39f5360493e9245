use super::*;
use crate::maths::Dual;
use crate::physics::effect::EffectId;
use crate::physics::effect::MOST_PARAMETERS;
use crate::physics::law::{
    Elastic, HuntCrossley, KelvinVoigt, QuasiLinear, Recovery, RelaxationMode, RelaxingLaw, Zener,
};

const PERIOD_S: f64 = 1e-3;

const GEL: HuntCrossley<f64> = HuntCrossley {
    stiffness_n_per_m: 1350.0,
    damping_ns_per_m: 36.0,
    exponent: 1.35,
    damping_exponent: 1.35,
    reference_depth_m: 1e-3,
};

/// 1.5 mm at 1.5 Hz about 0.8 mm, so that it leaves the material in each cycle.
fn palpation(at: usize) -> Motion<f64> {
    let (t, w) = (at as f64 * PERIOD_S, 9.42);
    Motion {
        time_s: t,
        position_m: 8e-4 - 1.5e-3 * libm::cos(w * t),
        speed_mps: 1.5e-3 * w * libm::sin(w * t),
        acceleration_mps2: 1.5e-3 * w * w * libm::cos(w * t),
    }
}

fn forces(rig: &Rig<f64>, count: usize) -> [f64; 2000] {
    let mut state = rig.at_rest();
    core::array::from_fn(|at| {
        if at < count {
            rig.step(&mut state, palpation(at), PERIOD_S).force_n
        } else {
            0.0
        }
    })
}

fn agrees<L: RelaxingLaw<f64> + Copy>(law: L)
where
    Environment<f64>: From<L>,
{
    let surface_m = 1e-4;
    for recovery in [Recovery::WithProbe, Recovery::ByCreep] {
        let rig = Rig::bare(Environment::from(law).at(surface_m).recovering(recovery));
        let (mut state, mut own) = (rig.at_rest(), law.at_rest());
        for at in 0..2000 {
            let motion = palpation(at);
            let depth_m = motion.position_m - surface_m;
            let speed_mps = motion.speed_mps;
            let exact = recovery.step(&law, &mut own, depth_m, speed_mps, PERIOD_S);
            let exact = exact.max(0.0);
            let found = rig.step(&mut state, motion, PERIOD_S).force_n;
            // Two ways to add up the same terms.
            assert!(
                (found - exact).abs() < 1e-12 * (1.0 + exact),
                "{recovery:?}, {at}: {found} {exact}"
            );
        }
    }
}

#[test]
fn without_effects_it_is_the_law_and_does_not_pull() {
    agrees(GEL);
    agrees(KelvinVoigt {
        stiffness_n_per_m: 2500.0,
        damping_ns_per_m: 17.0,
    });
    agrees(Zener {
        stiffness_n_per_m: 2000.0,
        second_stiffness_n_per_m: 900.0,
        damping_ns_per_m: 300.0,
    });
    let modes = [(0.2, 3.0), (0.15, 0.1)];
    agrees(QuasiLinear {
        elastic: Elastic::Exponential {
            stiffness_n_per_m: 800.0,
            stiffening_rate_per_m: 300.0,
        },
        modes: modes.map(|(fraction, rate_per_s)| RelaxationMode {
            fraction,
            rate_per_s,
        }),
    });
}

/// The row's example, with the optional forms that have gradients, and of a size that shows at 2 mm.
fn usual(id: EffectId) -> [f64; MOST_PARAMETERS] {
    match id {
        EffectId::ExponentialStiffening => [200.0, 0.0, 0.0, 0.0, 0.0],
        EffectId::Adhesion => [0.2, 4e-4, 0.0, 0.3, 2e-3],
        EffectId::BuriedLayer => [2000.0, 1.5e-3, 0.0, 0.0, 0.0],
        EffectId::SeriesCompliance => [12_000.0, 4.0, 0.0, 0.0, 0.0],
        EffectId::ForceSaturation => [3.0, 0.0, 0.0, 0.0, 0.0],
        EffectId::EncoderPeriodicError => [1e-5, 4e-4, 0.2, 0.0, 0.0],
        _ => id.info().example,
    }
}

/// A rig with what the effect changes.
fn bare(id: EffectId) -> Rig<f64> {
    let rig = Rig::bare(base(id));
    match id.needs() {
        Some(other) => rig.with(Effect::new(other, &usual(other))),
        None => rig,
    }
}

/// A linear contact where the effect is one of a linear law.
fn base(id: EffectId) -> Environment<f64> {
    if !id.info().laws.are_linear() {
        return GEL.into();
    }
    KelvinVoigt {
        stiffness_n_per_m: 1350.0,
        damping_ns_per_m: 36.0,
    }
    .into()
}

#[test]
fn every_effect_changes_the_force_where_it_should() {
    for id in EffectId::ALL.iter().copied() {
        let bare = bare(id);
        let with = bare.with(Effect::new(id, &usual(id)));
        let (plain, changed) = (forces(&bare, 2000), forces(&with, 2000));
        let largest = plain
            .iter()
            .zip(&changed)
            .fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
        if id == EffectId::TimeDelay {
            assert_eq!(largest, 0.0, "a delay is the caller's");
            assert_eq!((with.delay_s(), bare.delay_s()), (Some(8e-3), None));
        } else {
            assert!(
                (5e-3..20.0).contains(&largest),
                "{}: {largest} N",
                id.name()
            );
        }
        // Within 0.3 mm of the material nothing of the contact's own acts before the first touch.
        let before = (plain[20] - changed[20]).abs() > 1e-9;
        let path = matches!(
            id.info().stage,
            crate::physics::effect::ChainStage::LoadPath
        );
        assert_eq!(before, path, "{}", id.name());
    }
}

#[test]
fn gradients_agree_with_central_differences() {
    for id in EffectId::ALL.iter().copied() {
        let row = usual(id);
        let count = id.info().parameters.len();
        type One = Dual<f64, 1>;
        for parameter in (0..count).filter(|at| row[*at] != 0.0) {
            let h = 1e-6 * row[parameter];
            let at = |value: f64| {
                let mut row = row;
                row[parameter] = value;
                forces(&bare(id).with(Effect::new(id, &row)), 1200)
            };
            let (more, less) = (at(row[parameter] + h), at(row[parameter] - h));
            let dual: [One; MOST_PARAMETERS] = core::array::from_fn(|i| {
                let one = One::parameter(row[i], 0);
                if i == parameter {
                    one
                } else {
                    One::constant(row[i])
                }
            });
            let rig = Rig {
                environment: lift(base(id)),
                effects: Effects::none(),
            };
            let rig = bare(id).effects().fold(rig, |rig, other| {
                rig.with(Effect::new(other.id(), &other.row().map(One::constant)))
            });
            let rig = rig.with(Effect::new(id, &dual));
            let mut state = rig.at_rest();
            let (mut errors, mut size) = (0.0, 0.0);
            for step in 0..1200 {
                let motion = palpation(step);
                let motion = Motion {
                    time_s: One::constant(motion.time_s),
                    position_m: One::constant(motion.position_m),
                    speed_mps: One::constant(motion.speed_mps),
                    acceleration_mps2: One::constant(motion.acceleration_mps2),
                };
                let reading = rig.step(&mut state, motion, One::constant(PERIOD_S));
                let slope = (more[step] - less[step]) / (2.0 * h);
                // A sample that a corner passes between the two is no slope.
                let error = (reading.force_n.gradient[0] - slope).abs();
                if error < 1e-3 * slope.abs() + 1e-3 / row[parameter].abs() {
                    errors += error;
                    size += slope.abs();
                } else {
                    errors += 1e-4 * slope.abs();
                }
            }
            let name = id.info().parameters[parameter].name;
            assert!(
                errors <= 1e-4 * size,
                "{} {name}: {errors} of {size}",
                id.name()
            );
        }
    }
}

/// The same environment in dual numbers that depend on nothing.
fn lift(from: Environment<f64>) -> Environment<Dual<f64, 1>> {
    let number = Dual::constant;
    Environment {
        elastic: from.elastic.map(|elastic| match elastic {
            Elastic::Power {
                stiffness_n_per_m,
                exponent,
                reference_depth_m,
            } => Elastic::Power {
                stiffness_n_per_m: number(stiffness_n_per_m),
                exponent: number(exponent),
                reference_depth_m: number(reference_depth_m),
            },
            Elastic::Exponential { .. } => unreachable!("no base here is exponential"),
        }),
        damping: from.damping.map(|own| Damping {
            coefficient_ns_per_m: number(own.coefficient_ns_per_m),
            exponent: number(own.exponent),
            reference_depth_m: number(own.reference_depth_m),
        }),
        surface_m: number(from.surface_m),
        ..Environment::free()
    }
}

#[test]
fn a_spring_behind_a_spring_is_softer() {
    // 2000 N/m behind 8000 N/m, no damping: 1600 N/m.
    let rig = Rig::bare(Environment::from(KelvinVoigt {
        stiffness_n_per_m: 2000.0,
        damping_ns_per_m: 0.0,
    }))
    .with(Effect::new(
        EffectId::SeriesCompliance,
        &[8000.0, 0.0, 0.0, 0.0, 0.0],
    ));
    for (at, force) in forces(&rig, 2000).iter().enumerate() {
        let exact = 1600.0 * palpation(at).position_m.max(0.0);
        assert!((force - exact).abs() < 1e-9, "{at}: {force} {exact}");
    }
}

#[test]
fn a_spring_that_hardens_gives_way_by_the_logarithm_of_its_force() {
    // 2000 N/m behind 8000 N/m that double by 2 N: x = F/K + (F_h/k) ln(1 + F/F_h).
    let (stiffness, own, hardening_n) = (2000.0, 8000.0, 2.0);
    let rig = Rig::bare(Environment::from(KelvinVoigt {
        stiffness_n_per_m: stiffness,
        damping_ns_per_m: 0.0,
    }))
    .with(Effect::new(
        EffectId::SeriesCompliance,
        &[own, hardening_n, 0.0, 0.0, 0.0],
    ));
    let mut highest_n = 0.0_f64;
    for (at, force) in forces(&rig, 2000).iter().enumerate() {
        let given_way = hardening_n / own * libm::log1p(force / hardening_n);
        let error = force / stiffness + given_way - palpation(at).position_m.max(0.0);
        assert!(error.abs() < 1e-10, "{at}: {force} N, {error} m");
        highest_n = highest_n.max(*force);
    }
    // Stiffer than 1600 N/m at its highest, softer than 2000.
    let deepest_m = (0..2000).fold(0.0, |most: f64, at| most.max(palpation(at).position_m));
    let overall = highest_n / deepest_m;
    assert!((1650.0..1950.0).contains(&overall), "{overall} N/m");
}

#[test]
fn surfaces_that_close_pull_less_than_surfaces_that_part() {
    // GIVEN 0.2 N of which 0.05 N are missing on the way in, and nothing else but a spring
    let spring = Rig::bare(Environment::from(KelvinVoigt {
        stiffness_n_per_m: 2000.0,
        damping_ns_per_m: 0.0,
    }));
    let rig = spring.with(Effect::new(
        EffectId::Adhesion,
        &[0.2, 1e-4, 0.0, 0.25, 0.0],
    ));
    let pull_n = |position_m: f64, speed_mps: f64, state: &mut RigState<f64>| {
        let motion = Motion {
            time_s: 0.0,
            position_m,
            speed_mps,
            acceleration_mps2: 0.0,
        };
        let force_n = rig.step(state, motion, PERIOD_S).force_n;
        2000.0 * position_m.max(0.0) - force_n
    };
    let mut state = rig.at_rest();
    for (position_m, speed_mps, expected_n) in [
        (-5e-5, 1e-3, 0.0),
        (1e-3, 1e-3, 0.15),
        (1e-3, 0.0, 0.175),
        (5e-4, -1e-3, 0.2),
        (-5e-5, -1e-3, 0.1),
        (-2e-4, -1e-3, 0.0),
        (-5e-5, -1e-3, 0.0),
    ] {
        let pull_n = pull_n(position_m, speed_mps, &mut state);
        assert!(
            (pull_n - expected_n).abs() < 1e-12,
            "{position_m} m, {speed_mps} m/s: {pull_n} N"
        );
    }
}

#[test]
fn a_damper_behind_a_spring_takes_its_time() {
    // GIVEN λ = 40 behind 4000 N/m and nothing else, pressed at 10 mm/s: F = λv(1 − e^{−t k/λ}).
    let rig = Rig::bare(Environment::from(KelvinVoigt {
        stiffness_n_per_m: 1e-9,
        damping_ns_per_m: 40.0,
    }))
    .with(Effect::new(
        EffectId::SeriesCompliance,
        &[4000.0, 0.0, 0.0, 0.0, 0.0],
    ));
    // WHEN it touches at a sample, or between two: over all of the first period the spring would be ahead of the tip, and
    // the force was all of λv.
    for share in [0.0, 1e-9, 0.02, 0.3, 0.7, 0.98] {
        let mut state = rig.at_rest();
        for at in -2..60 {
            let time_s = (f64::from(at) + share) * PERIOD_S;
            let motion = Motion {
                time_s,
                position_m: 1e-2 * time_s,
                speed_mps: 1e-2,
                acceleration_mps2: 0.0,
            };
            let force = rig.step(&mut state, motion, PERIOD_S).force_n;
            let exact = 0.4 * (1.0 - libm::exp(-100.0 * time_s.max(0.0)));
            // Second order: (k h/λ)² = 1 %, of 0.4 N, at its worst.
            let off = (force - exact).abs();
            assert!(off < 4e-3, "{share}, {at}: {force} {exact}");
        }
    }
}

#[test]
fn a_bond_pulls_as_far_as_a_hold_has_relaxed_and_tears() {
    // GIVEN a gel that relaxes by half and is bonded up to 0.2 N, pressed by 1 mm, held for 3 s and left
    let rig = Rig::bare(Environment::from(GEL))
        .with(Effect::new(
            EffectId::StressRelaxation,
            &[0.5, 5.0, 0.0, 0.0, 0.0],
        ))
        .with(Effect::new(EffectId::Adhesion, &[0.2, 1e-4, 1.0, 0.0, 0.0]));
    let mut state = rig.at_rest();
    let (mut lowest_n, mut torn_at_m, mut last_n) = (0.0, 0.0, 0.0);
    for at in 0..5000 {
        let (position_m, speed_mps) = match at {
            0..1000 => (-1e-3 + 2e-6 * f64::from(at), 2e-3),
            1000..4000 => (1e-3, 0.0),
            _ => (1e-3 - 2e-6 * f64::from(at - 4000), -2e-3),
        };
        let motion = Motion {
            time_s: f64::from(at) * PERIOD_S,
            position_m,
            speed_mps,
            acceleration_mps2: 0.0,
        };
        let Reading { force_n, touch } = rig.step(&mut state, motion, PERIOD_S);
        // THEN it pulls neither before touch nor while it is pressed, unlike −F_a in all contact,
        assert!(at >= 4000 || force_n >= 0.0, "{at}: {force_n} N");
        if force_n < lowest_n {
            (lowest_n, torn_at_m) = (force_n, touch.depth_m);
        }
        last_n = force_n;
    }
    // then up to F_a, before the depth at which the gel was touched, and not for ever.
    assert!((lowest_n + 0.2).abs() < 1e-9, "{lowest_n} N");
    assert!((1e-5..5e-4).contains(&torn_at_m), "{torn_at_m} m");
    assert_eq!(last_n, 0.0);
}

#[test]
fn one_pace_serves_a_whole_log() {
    // GIVEN a law that relaxes, one more mode behind a spring, and a lag
    let effect =
        |id: EffectId, values: [f64; 2]| Effect::new(id, &[values[0], values[1], 0.0, 0.0, 0.0]);
    let law = Zener {
        stiffness_n_per_m: 1400.0,
        second_stiffness_n_per_m: 1867.0,
        damping_ns_per_m: 98.0,
    };
    let rig = Rig::bare(Environment::from(law))
        .with(effect(EffectId::StressRelaxation, [0.3, 5.0]))
        .with(effect(EffectId::SeriesCompliance, [1e4, 0.0]))
        .with(effect(EffectId::ForceLag, [5e-3, 0.0]));
    let (pace, other) = (rig.pace(PERIOD_S), rig.pace(2.0 * PERIOD_S));
    let (mut kept, mut each, mut wrong) = (rig.at_rest(), rig.at_rest(), rig.at_rest());
    let mut largest_n = 0.0_f64;
    for at in 0..2000 {
        let force_n = rig.step_at(&pace, &mut kept, palpation(at)).force_n;
        // THEN it is what each step by itself gives, to the bit, and another period's is not.
        assert_eq!(
            force_n,
            rig.step(&mut each, palpation(at), PERIOD_S).force_n
        );
        let off_n = rig.step_at(&other, &mut wrong, palpation(at)).force_n - force_n;
        largest_n = largest_n.max(off_n.abs());
    }
    assert!(largest_n > 0.1, "{largest_n} N");
}
