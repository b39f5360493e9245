use super::*;
use crate::physics::law::{ContactLaw, HuntCrossley, KelvinVoigt, RelaxingLaw, Zener};

/// Nothing of which is ever reached by the materials here.
const WIDE: RenderConfig = RenderConfig {
    rate_hz: 1000.0,
    force_n: 1e3,
    device_ns_per_m: 1e5,
    slew_n_per_s: 1e8,
    timeout_s: 0.1,
    fade_s: 0.05,
    shaping: 1.0,
};

fn renderer(params: &RenderParams, packet: &Packet) -> Renderer {
    let mut renderer = Renderer::new();
    renderer.take(params, packet).unwrap();
    renderer
}

/// A palpation: position (m) and speed (m/s) at millisecond `i`.
fn motion(i: u64) -> (f32, f32) {
    let angle = 0.011 * i as f32;
    (1e-3 - 2e-3 * libm::cosf(angle), 0.022 * libm::sinf(angle))
}

/// The same packet again and again, by its law's own `force_n`.
fn follows(law: LawKind, shaping: f32, own: &mut dyn FnMut(f32, f32) -> f32, tolerance: f32) {
    let config = RenderConfig { shaping, ..WIDE };
    let params = config.validate().unwrap();
    let (values, mut renderer) = (usual(law), Renderer::new());
    let surface_m = values[values.len() - 1];
    let mut compared = 0;
    for i in 1..3000 {
        // A packet every 20 ms, as every 20th sample makes it.
        if i % 20 == 1 {
            renderer
                .take(&params, &packet(law, values, i as u16))
                .unwrap();
        }
        let (position_m, speed_mps) = motion(i);
        let rendered = renderer.step(&params, position_m, speed_mps, i * 1000);
        let expected = own(position_m - surface_m, speed_mps).max(0.0);
        if i <= 51 {
            continue;
        }
        assert_eq!((rendered.limits, rendered.faults), (0, Faults::NONE));
        let error = (rendered.force_n - expected).abs();
        assert!(
            error <= tolerance * expected.max(1.0),
            "{i}: {rendered:?} {expected}"
        );
        compared += u32::from(expected > 0.1);
    }
    assert!(compared > 1000, "{compared}");
}

#[test]
fn within_the_limits_the_force_is_the_laws_own_to_the_bit() {
    let linear = KelvinVoigt {
        stiffness_n_per_m: 2260.0,
        damping_ns_per_m: 123.0,
    };
    follows(
        LawKind::KelvinVoigt,
        1.0,
        &mut |d, v| linear.force_n(d, v),
        0.0,
    );
    let gel = HuntCrossley::new(1350.0, 36.0, 1.35, 1e-3);
    follows(
        LawKind::HuntCrossley,
        1.0,
        &mut |d, v| gel.force_n(d, v),
        0.0,
    );
    for law in [LawKind::QuasiLinear, LawKind::QuasiLinear2] {
        let reflected = packet(law, usual(law), 1).reflected().unwrap().unwrap();
        let Impedance::QuasiLinear(own) = reflected.impedance else {
            panic!("another law");
        };
        let mut state = own.at_rest();
        // The renderer's periods are whole microseconds in f32.
        follows(
            law,
            1.0,
            &mut |d, v| own.step(&mut state, d, v, 1e-6 * 1000.0),
            0.0,
        );
    }
}

#[test]
fn a_zener_material_is_rendered_by_the_quasi_linear_law_that_it_is() {
    let own = Zener {
        stiffness_n_per_m: 3000.0_f32,
        second_stiffness_n_per_m: 900.0,
        damping_ns_per_m: 780.0,
    };
    let mut state = own.at_rest();
    // d¹ as exp(ln d) in f32: |ln d| ulp of some newtons.
    follows(
        LawKind::Zener,
        1.0,
        &mut |d, v| own.step(&mut state, d, v, 1e-3),
        1e-5,
    );
}

#[test]
fn shaping_scales_stiffness_and_damping() {
    let twice = HuntCrossley::new(2700.0, 72.0, 1.35, 1e-3);
    follows(
        LawKind::HuntCrossley,
        2.0,
        &mut |d, v| twice.force_n(d, v),
        0.0,
    );
    let linear = KelvinVoigt {
        stiffness_n_per_m: 565.0,
        damping_ns_per_m: 30.75,
    };
    follows(
        LawKind::KelvinVoigt,
        0.25,
        &mut |d, v| linear.force_n(d, v),
        0.0,
    );
}

/// Held out: none of these seeds was looked at while the renderer was written.
#[test]
fn whatever_comes_in_the_force_is_finite_and_within_its_limits() {
    let mut pushing = 0;
    for seed in 7001..7201 {
        let mut random = Random(seed);
        let config = RenderConfig {
            force_n: random.between(0.5, 20.0),
            device_ns_per_m: random.between(0.1, 200.0),
            slew_n_per_s: random.between(10.0, 5e4),
            timeout_s: random.between(2e-3, 0.2),
            fade_s: random.between(2e-3, 0.2),
            shaping: random.between(0.0, 5.0),
            ..WIDE
        };
        let params = config.validate().unwrap();
        let mut renderer = Renderer::new();
        let (mut now_us, mut last, mut pushed) = (1_000_u64, Rendered::default(), 0);
        for i in 0..3000_u64 {
            let before_us = now_us;
            now_us = match random.below(200) {
                0 => now_us,
                1 => u64::from(random.bits()) << random.below(33),
                2 => now_us.wrapping_add(u64::from(random.below(300_000))),
                _ => now_us.wrapping_add(1000),
            };
            if random.below(10) == 0 {
                let law = LawKind::ALL[random.below(6) as usize];
                let mut values = usual(law).to_vec();
                let changed = random.below(values.len() as u32) as usize;
                values[changed] = match random.below(3) {
                    0 => random.any_number(),
                    _ => values[changed] * random.between(0.2, 3.0),
                };
                // Refused or not.
                let _ = renderer.take(&params, &packet(law, &values, i as u16));
            }
            let (mut position_m, mut speed_mps) = motion(i);
            if random.below(100) == 0 {
                (position_m, speed_mps) = (random.any_number(), random.any_number());
            }
            let rendered = renderer.step(&params, position_m, speed_mps, now_us);
            let force_n = rendered.force_n;
            assert!(force_n.is_finite(), "{seed}, {i}: {rendered:?}");
            assert!(
                (0.0..=config.force_n).contains(&force_n),
                "{seed}, {i}: {rendered:?}"
            );
            let elapsed_s = 1e-6 * now_us.saturating_sub(before_us) as f32;
            let most_n = config.slew_n_per_s * elapsed_s * 1.0001 + 1e-5;
            let to_zero = rendered.faults.has(Fault::RenderUnusable);
            assert!(
                to_zero || i == 0 || (force_n - last.force_n).abs() <= most_n,
                "{seed}, {i}"
            );
            assert!(!to_zero || force_n == 0.0);
            let unusable = !(position_m.is_finite() && speed_mps.is_finite());
            assert!(
                to_zero || !(unusable || i > 0 && now_us <= before_us),
                "{seed}, {i}"
            );
            pushed += u32::from(force_n > 0.1);
            last = rendered;
        }
        pushing += u32::from(pushed > 100);
    }
    // Others are shaped to next to nothing.
    assert!(pushing > 180, "{pushing}");
}

#[test]
fn another_material_another_law_or_another_surface_comes_in_without_a_step() {
    let config = RenderConfig {
        force_n: 20.0,
        ..WIDE
    };
    let params = config.validate().unwrap();
    let mut random = Random(11);
    let mut renderer = Renderer::new();
    let (mut last_n, mut changes) = (0.0_f32, 0);
    for i in 1..20_000_u64 {
        if random.below(30) == 0 {
            let law = LawKind::ALL[random.below(6) as usize];
            let mut values = usual(law).to_vec();
            values[0] *= random.between(0.2, 1.0);
            *values.last_mut().unwrap() += random.between(-1e-3, 1e-3);
            renderer
                .take(&params, &packet(law, &values, i as u16))
                .unwrap();
            changes += 1;
        }
        // The master stands still: every change of the force is one of the impedance's.
        let rendered = renderer.step(&params, 1.5e-3, 0.0, i * 1000);
        let change_n = (rendered.force_n - last_n).abs();
        // In a straight line over 50 ms from at most 20 N; what relaxes adds up to 0.03 N/ms.
        assert!(change_n < 20.0 / 50.0 + 0.03, "{i}: {change_n}");
        last_n = rendered.force_n;
    }
    assert!(changes > 500);
}

#[test]
fn when_packets_stop_the_force_fades_out_in_the_set_time_and_comes_back_without_a_step() {
    let params = WIDE.validate().unwrap();
    let mut renderer = renderer(&params, &packet(LawKind::HuntCrossley, &GEL, 1));
    let gel = HuntCrossley::new(1350.0, 36.0, 1.35, 1e-3);
    let full_n = gel.force_n(2e-3 - 2e-4, 0.0_f32);
    let mut at = |ms: u64| renderer.step(&params, 2e-3, 0.0, ms * 1000);
    let forces: Vec<_> = (1..=400).map(&mut at).collect();
    // In over 50 ms, 100 ms without a packet after the one at 1 ms, out over 50 ms.
    let of = |ms: usize| forces[ms - 1];
    assert!((of(25).force_n / full_n - 0.5).abs() < 0.01, "{:?}", of(25));
    assert_eq!(of(51).force_n, full_n);
    assert_eq!((of(101).force_n, of(101).faults), (full_n, Faults::NONE));
    assert!(of(102).faults.has(Fault::RenderStopped) && of(102).has(Limit::Fading));
    assert!(
        (of(126).force_n / full_n - 0.5).abs() < 0.02,
        "{:?}",
        of(126)
    );
    for ms in 152..=400 {
        assert_eq!(of(ms).force_n, 0.0);
        assert!(
            of(ms).faults.has(Fault::RenderStopped),
            "stands until a packet comes"
        );
    }
    renderer
        .take(&params, &packet(LawKind::HuntCrossley, &GEL, 2))
        .unwrap();
    let back: Vec<_> = (401..=451)
        .map(|ms| renderer.step(&params, 2e-3, 0.0, ms * 1000))
        .collect();
    assert_eq!(back[0].faults, Faults::NONE);
    assert!(back.windows(2).all(|pair| {
        let rise_n = pair[1].force_n - pair[0].force_n;
        (0.0..full_n / 45.0).contains(&rise_n)
    }));
    assert_eq!(back[50].force_n, full_n);
}

#[test]
fn a_position_that_is_none_and_a_time_that_stands_still_put_the_force_to_zero_at_once() {
    let params = WIDE.validate().unwrap();
    for (position_m, speed_mps, late_us) in [
        (f32::NAN, 0.0, 1000),
        (f32::INFINITY, 0.0, 1000),
        (2e-3, f32::NAN, 1000),
        (2e-3, 0.0, 0),
    ] {
        let mut renderer = renderer(&params, &packet(LawKind::HuntCrossley, &GEL, 1));
        let mut now_us = 0;
        for _ in 0..80 {
            now_us += 1000;
            renderer.step(&params, 2e-3, 0.0, now_us);
        }
        now_us += late_us;
        let broken = renderer.step(&params, position_m, speed_mps, now_us);
        assert_eq!(broken.force_n, 0.0);
        assert!(broken.faults.has(Fault::RenderUnusable));
        // AND it comes back as a new packet does: 3 N over 50 ms.
        let again = renderer.step(&params, 2e-3, 0.0, now_us + 1000);
        assert_eq!(again.faults, Faults::NONE);
        assert!(again.force_n < 3.0 / 45.0, "{again:?}");
    }
}

#[test]
fn a_gap_lets_the_force_jump_no_further_and_a_clock_that_starts_anew_puts_no_timeout_off() {
    let config = RenderConfig {
        slew_n_per_s: 100.0,
        ..WIDE
    };
    let params = config.validate().unwrap();
    let mut renderer = renderer(&params, &packet(LawKind::HuntCrossley, &GEL, 1));
    for ms in 1..=80 {
        renderer.step(&params, -1e-3, 0.0, 1_000_000_000 + ms * 1000);
    }
    // 15 ms are missing, and the hand is 2 mm deep: 3 N; 0.2 N come at once.
    let after = renderer.step(&params, 2e-3, 0.0, 1_000_095_000);
    assert!(after.force_n > 0.0 && after.force_n < 0.2001, "{after:?}");
    assert!(after.has(Limit::Slew));
    // The clock starts anew: 100 ms of timeout and 50 of fading later there is nothing left.
    let restarted: Vec<_> = (1..=200)
        .map(|ms| renderer.step(&params, 2e-3, 0.0, ms * 1000))
        .collect();
    assert!(restarted[0].faults.has(Fault::RenderUnusable));
    assert!(restarted[90].force_n > 1.0, "{:?}", restarted[90]);
    assert_eq!(restarted[160].force_n, 0.0);
}

/// Plastic at a master of 5 N s/m, that renders 2500 N/m and 12.5 N s/m.
#[test]
fn no_slope_and_no_damping_is_more_than_the_master_can_render() {
    let config = RenderConfig {
        device_ns_per_m: 5.0,
        ..WIDE
    };
    let params = config.validate().unwrap();
    let (stiffest, most_damping) = params.most();
    assert_eq!(stiffest, 2500.0);
    assert!((most_damping - 12.5).abs() < 1e-5);
    let soft = [300.0, 2.0, 1.6, 0.0];
    for values in [
        PLASTIC,
        GEL,
        soft,
        [2600.0, 40.0, 1.0, 0.0],
        [900.0, 40.0, 0.7, 0.0],
    ] {
        let law = HuntCrossley::new(values[0], values[1], values[2], 1e-3);
        let force = |depth_m: f32, speed_mps: f32| {
            let mut renderer = renderer(&params, &packet(LawKind::HuntCrossley, &values, 1));
            let at = values[3] + depth_m;
            (0..60).fold(Rendered::default(), |_, i| {
                renderer.step(&params, at, speed_mps, 1000 * (i + 1))
            })
        };
        let (mut last_n, mut limited, mut own) = (0.0, 0, 0);
        for i in 1..400 {
            let depth_m = 1e-5 * i as f32;
            let still = force(depth_m, 0.0);
            let slope = (still.force_n - last_n) / 1e-5;
            // 0.5 µN of rounding at 10 N, over 10 µm.
            assert!(
                slope <= stiffest * 1.001 + 0.2,
                "{values:?} at {depth_m}: {slope}"
            );
            // Steps of 10 µm next to a surface where n < 1 are steep: no more than the law's own.
            let exact_n = law.force_n(values[3] + depth_m - values[3], 0.0);
            assert!(
                still.force_n <= exact_n * 1.000_01,
                "{values:?} at {depth_m}"
            );
            last_n = still.force_n;
            let moving = force(depth_m, 0.01);
            let damping = (moving.force_n - still.force_n) / 0.01;
            assert!(
                damping <= most_damping * 1.001 + 1e-3,
                "{values:?}: {damping}"
            );
            if still.has(Limit::Stiffness) {
                limited += 1;
            } else {
                assert_eq!(still.force_n, exact_n);
                own += 1;
            }
            let unlimited = (law.force_n(values[3] + depth_m - values[3], 0.01) - exact_n) / 0.01;
            if !still.has(Limit::Stiffness) {
                assert_eq!(
                    moving.has(Limit::Damping),
                    unlimited > most_damping * 1.0001
                );
            }
        }
        assert_eq!(
            limited == 0,
            values == soft,
            "{values:?}: {limited} limited, {own} not"
        );
    }
}

/// A master of 0.1 kg flies into a wall that is far too stiff for it, position sampled as the board
/// samples it: the mean of the millisecond before. GIVEN its damping, THEN what is rendered gives no
/// energy back; told a hundred times the damping that it has, it does.
#[test]
fn a_wall_returns_no_more_energy_than_came_in() {
    let bounce = |device: f32, told: f32| {
        let config = RenderConfig {
            device_ns_per_m: told,
            ..WIDE
        };
        let params = config.validate().unwrap();
        let wall = packet(LawKind::KelvinVoigt, &[1e6, 0.0, 0.0], 1);
        let mut renderer = renderer(&params, &wall);
        const STEPS: u32 = 50;
        let (dt, mass) = (1e-3 / STEPS as f32, 0.1);
        // Until the packet has come in.
        for i in 1..=60 {
            renderer.step(&params, -1e-3, 0.0, i * 1000);
        }
        let (mut position, mut speed, mut force, mut fastest) = (-1e-4_f32, 0.1_f32, 0.0, 0.0_f32);
        let (mut filter, mut ms) = (Speed::default(), 60);
        let mut touched = false;
        while ms < 90 {
            let mut mean = 0.0;
            for _ in 0..STEPS {
                speed += (-force - device * speed) / mass * dt;
                position += speed * dt;
                mean += position / STEPS as f32;
            }
            ms += 1;
            let seen = filter.update(ms * 1000, mean);
            force = renderer.step(&params, mean, seen, ms * 1000).force_n;
            touched |= force > 0.0;
            if touched && force == 0.0 {
                fastest = fastest.max(-speed);
            }
        }
        assert!(touched);
        fastest
    };
    for device in [0.5, 2.0, 5.0] {
        let out = bounce(device, device);
        assert!(out < 0.1, "{device}: {out} m/s for 0.1 m/s");
        let told_too_much = bounce(device, 100.0 * device);
        assert!(told_too_much > 0.1, "{device}: {told_too_much}");
    }
}

#[test]
fn a_speed_is_that_of_a_ramp_and_survives_what_is_no_position() {
    let mut speed = Speed::default();
    let mut at = |i: u64, m: f32| speed.update(i * 1000, m);
    for i in 1..60 {
        at(i, 1e-4 * i as f32);
    }
    let steady = at(60, 6e-3);
    // f32 positions of 6 mm: 0.5 nm in 0.1 mm.
    assert!((steady - 0.1).abs() < 1e-5, "{steady}");
    assert_eq!(at(61, f32::NAN), steady);
    assert_eq!(at(60, 1.0), steady);
    // After a gap it stands still.
    assert_eq!(at(90, 6e-3), 0.0);
}

#[test]
fn every_field_is_checked_and_not_a_number_is_never_valid() {
    type Change = fn(&mut RenderConfig) -> &mut f32;
    let fields: [(&str, Change); 7] = [
        ("rate_hz", |c| &mut c.rate_hz),
        ("force_n", |c| &mut c.force_n),
        ("device_ns_per_m", |c| &mut c.device_ns_per_m),
        ("slew_n_per_s", |c| &mut c.slew_n_per_s),
        ("timeout_s", |c| &mut c.timeout_s),
        ("fade_s", |c| &mut c.fade_s),
        ("shaping", |c| &mut c.shaping),
    ];
    for (field, of) in fields {
        for bad in [f32::NAN, f32::INFINITY, -1.0] {
            let mut config = WIDE;
            *of(&mut config) = bad;
            assert_eq!(config.validate().unwrap_err().field, field);
        }
    }
}

#[test]
fn an_output_has_its_zero_its_sign_and_its_ends() {
    let push = Output {
        zero: 0.0,
        full_n: 10.0,
    };
    let codes = [0.0, 5.0, 10.0, 11.0, -1.0, f32::NAN].map(|n| push.code(n, 2625));
    assert_eq!(codes, [0, 1313, 2625, 2625, 0, 0]);
    let middle = Output {
        zero: 0.5,
        full_n: -20.0,
    };
    let codes = [0.0, 5.0, 10.0, f32::INFINITY].map(|n| middle.code(n, 1000));
    assert_eq!(codes, [500, 250, 0, 500]);
    assert!(middle.carries(10.0) && !middle.carries(10.1) && push.carries(10.0));
}
