//! The simulated system against what theory says of linear ones: ideal devices and sensors, and a tick of
//! 50 µs, which adds two ticks to a round trip (a half for each held command, one for the message back).

use estimator_core::board::reflection::RenderConfig;
use estimator_core::physics::law::{ContactLaw, HuntCrossley};
use num_complex::Complex64 as Complex;
use palpate::motion::{Motion, Segment};
use palpate::teleop::environment::{Environment, Material, Touching};
use palpate::teleop::operator::{Grip, Operator};
use palpate::teleop::scheme::Servo;
use palpate::teleop::{Options, Row, SchemeId, System, Trace};
use std::f64::consts::{PI, TAU};
use tests::tolerance;

/// Ticks a second.
const RATE_HZ: f64 = 20_000.0;
/// What the ticks add to a round trip (s).
const TICKS_S: f64 = 2.0 / RATE_HZ;
const STIFFNESS: f64 = 3000.0;
const DAMPING: f64 = 8.0;

fn real(value: f64) -> Complex {
    Complex::new(value, 0.0)
}

fn imaginary(value: f64) -> Complex {
    Complex::new(0.0, value)
}

/// An ideal linear system that presses into a spring and a damper.
fn linear(scheme: SchemeId, stiffness: f64, intention: Motion) -> Options {
    let usual = Options::default();
    let hand = Grip {
        from_s: 0.0,
        mass_kg: 0.35,
        damping_ns_per_m: 9.0,
        stiffness_n_per_m: 700.0,
    };
    Options {
        environment: Environment::throughout(Material::linear(stiffness, DAMPING)),
        operator: Operator {
            intention,
            grips: vec![hand],
            force_limit_n: f64::INFINITY,
        },
        task: None,
        master: usual.master.ideal(),
        slave: usual.slave.ideal(),
        sensors: None,
        rate_hz: RATE_HZ,
        substeps: 1,
        ..usual.with_scheme(scheme)
    }
}

fn press(seconds: f64) -> Motion {
    let to_m = 20e-3;
    let ramp = Segment::Ramp {
        to_m,
        speed_mps: 0.1,
    };
    Motion::new(-1e-3, vec![ramp, Segment::Hold { seconds }]).expect("a motion")
}

/// The open loop of position–force: devices, hand, and the material behind the slave's servo.
struct PositionForceLoop {
    options: Options,
}

impl PositionForceLoop {
    /// The hand and the master: A(s).
    fn master(&self, s: Complex) -> Complex {
        let (grip, device) = (&self.options.operator.grips[0], &self.options.master);
        s * s * (grip.mass_kg + device.mass_kg)
            + s * (grip.damping_ns_per_m + device.damping_ns_per_m)
            + real(grip.stiffness_n_per_m)
    }

    /// The material as the master feels it without delay: L(s).
    fn material(&self, s: Complex) -> Complex {
        let Servo {
            stiffness_n_per_m: kp,
            damping_ns_per_m: kd,
        } = self.options.servo;
        let slave = &self.options.slave;
        let material = s * DAMPING + real(STIFFNESS);
        let servo = s * kd + real(kp);
        let own = s * s * slave.mass_kg + s * slave.damping_ns_per_m;
        material * servo / (own + servo + material)
    }

    /// The shortest delay T with A(jω) + L(jω)e^{−jωT} = 0 at any ω (s).
    fn critical_s(&self) -> f64 {
        let gain = |omega: f64| {
            let s = imaginary(omega);
            self.material(s).norm() / self.master(s).norm() - 1.0
        };
        let grid: Vec<f64> = (1..4000).map(|step| 0.25 * f64::from(step)).collect();
        let crossings = grid
            .windows(2)
            .filter(|pair| gain(pair[0]) * gain(pair[1]) < 0.0);
        let delays = crossings.map(|pair| {
            let omega = 0.5 * (pair[0] + pair[1]);
            let s = imaginary(omega);
            let phase = (self.material(s) / self.master(s)).arg() + PI;
            phase.rem_euclid(TAU) / omega
        });
        delays.fold(f64::INFINITY, f64::min)
    }
}

/// Whether the motion of the master goes on over a long press instead of decaying: one that grows ends where
/// it leaves the material, and stays as it is.
fn goes_on(trace: &Trace) -> bool {
    let moves = |from_s: f64, to_s: f64| {
        let rows = trace.between(from_s, to_s).iter();
        rows.map(|row| row.master_mps.abs()).fold(0.0, f64::max)
    };
    let (early, late) = (moves(2.0, 3.5), moves(8.5, 10.0));
    !trace.ended || (late > 0.9 * early && late > 1e-5)
}

#[test]
fn position_force_becomes_unstable_at_the_root_of_its_characteristic_equation() {
    let options = linear(SchemeId::PositionForce, STIFFNESS, press(10.0));
    let exact_s = PositionForceLoop {
        options: options.clone(),
    }
    .critical_s();
    let unstable = |delay_s: f64| {
        let options = options
            .clone()
            .with_channel(0.5 * (delay_s - TICKS_S), 0.0, 0.0);
        goes_on(&System::new(&options, 1).run())
    };
    let (mut low, mut high) = (0.5 * exact_s, 1.5 * exact_s);
    assert!(!unstable(low) && unstable(high), "{exact_s}");
    for _ in 0..7 {
        let middle = 0.5 * (low + high);
        if unstable(middle) {
            high = middle
        } else {
            low = middle
        }
    }
    let share = low / exact_s - 1.0;
    assert!(
        tolerance::INSTABILITY_DELAY.contains(&share.abs()),
        "{share} of {exact_s} s"
    );
}

#[test]
fn wave_variables_turn_a_spring_into_the_softer_one_of_the_formula() {
    let (trip_s, stiffness) = (0.2, 2000.0);
    let slow = Segment::Sine {
        mean_m: 25e-3,
        amplitude_m: 10e-3,
        frequency_hz: 0.1,
        seconds: 12.0,
    };
    let ramp = Segment::Ramp {
        to_m: 15e-3,
        speed_mps: 0.05,
    };
    let motion = Motion::new(-1e-3, vec![ramp, slow]).expect("a motion");
    let mut options = linear(SchemeId::WaveVariables, stiffness, motion);
    options.waves.rate_per_s = f64::INFINITY;
    let options = options.with_channel(0.5 * (trip_s - TICKS_S), 0.0, 0.0);
    let trace = System::new(&options, 1).run();
    let rows = trace.between(3.0, f64::INFINITY);
    let felt = slope(rows, |row| row.master_m, |row| row.felt_n);
    let b = options.waves.impedance_ns_per_m;
    let exact = 2.0 * b * stiffness / (2.0 * b + stiffness * trip_s);
    let share = (felt / exact - 1.0).abs();
    assert!(
        tolerance::WAVE_SPRING.contains(&share),
        "{felt} for {exact} N/m"
    );
}

/// The slope of a straight line.
fn slope(rows: &[Row], x: impl Fn(&Row) -> f64, y: impl Fn(&Row) -> f64) -> f64 {
    let count = rows.len() as f64;
    let mean = |of: &dyn Fn(&Row) -> f64| rows.iter().map(of).sum::<f64>() / count;
    let (x0, y0) = (mean(&x), mean(&y));
    let top: f64 = rows.iter().map(|row| (x(row) - x0) * (y(row) - y0)).sum();
    let bottom: f64 = rows.iter().map(|row| (x(row) - x0).powi(2)).sum();
    top / bottom
}

#[test]
fn a_sampled_spring_gives_the_energy_of_colgates_limit_and_the_renderer_stays_at_a_quarter() {
    let device = 120.0_f64;
    let config = RenderConfig {
        rate_hz: 1000.0,
        force_n: 1e6,
        device_ns_per_m: device as f32,
        slew_n_per_s: 1e9,
        timeout_s: 1.0,
        fade_s: 0.01,
        shaping: 1.0,
    };
    let (stiffest, _) = config.validate().expect("valid").most();
    let (stiffness, period_s) = (f64::from(stiffest), 1e-3);
    for frequency_hz in [3.0, 17.0, 130.0] {
        // A force that is held over a tick, on a prescribed sine: ∫F·v dt against ∫v² dt.
        let omega = TAU * frequency_hz;
        let (mut given_j, mut squares) = (0.0, 0.0);
        for tick in 0..50_000_u32 {
            let at = |t: f64| (omega * t).sin();
            let (from_s, to_s) = (f64::from(tick) * period_s, f64::from(tick + 1) * period_s);
            given_j -= stiffness * at(from_s) * (at(to_s) - at(from_s));
            squares += 0.5 * omega * omega * period_s;
        }
        let creates = given_j / squares;
        // (K/ω²T)(1 − cos ωT), which is KT/2 at low frequencies and less above.
        let exact = stiffness / (omega * omega * period_s) * (1.0 - (omega * period_s).cos());
        assert!(
            (creates / exact - 1.0).abs() < 1e-3,
            "{frequency_hz} Hz: {creates} for {exact}"
        );
        assert!(
            creates <= 0.25 * device * 1.001,
            "{creates} N s/m of {device}"
        );
    }
}

/// Components of the signals at a frequency.
struct Components {
    hand_n: Complex,
    master_mps: Complex,
    slave_mps: Complex,
    contact_n: Complex,
}

/// A system that presses with a sine on top, behind a material of a stiffness.
fn components(stiffness: f64, delay_s: f64, frequency_hz: f64) -> Components {
    let sine = Segment::Sine {
        mean_m: 20e-3,
        amplitude_m: 2e-3,
        frequency_hz,
        seconds: 6.0,
    };
    let ramp = Segment::Ramp {
        to_m: 18e-3,
        speed_mps: 0.1,
    };
    let motion = Motion::new(-1e-3, vec![ramp, sine]).expect("a motion");
    let options =
        linear(SchemeId::PositionForce, stiffness, motion).with_channel(delay_s, 0.0, 0.0);
    let trace = System::new(&options, 1).run();
    let last_s = trace.rows.last().expect("rows").time_s;
    let rows = trace.between(last_s - 2.0 + 0.5 * trace.period_s, f64::INFINITY);
    assert!(
        rows.iter().all(|row| row.contact_n > 0.0),
        "it stays in contact"
    );
    let of = |signal: &dyn Fn(&Row) -> f64| {
        rows.iter().fold(real(0.0), |sum, row| {
            let angle = TAU * frequency_hz * row.time_s;
            sum + Complex::new(angle.cos(), -angle.sin()) * signal(row)
        })
    };
    let s = imaginary(TAU * frequency_hz);
    Components {
        hand_n: of(&|row| row.hand_n),
        master_mps: s * of(&|row| row.master_m),
        slave_mps: s * of(&|row| row.slave_m),
        contact_n: of(&|row| row.contact_n),
    }
}

#[test]
fn the_hybrid_parameters_of_position_force_are_those_of_the_closed_form() {
    let (delay_s, frequency_hz) = (10e-3, 2.0);
    let (soft, stiff) = (
        components(300.0, delay_s, frequency_hz),
        components(1200.0, delay_s, frequency_hz),
    );
    // Two materials are two equations for each row of [F_h; −v_s] = H·[v_m; F_e].
    let determinant = soft.master_mps * stiff.contact_n - stiff.master_mps * soft.contact_n;
    let solved = |a: Complex, b: Complex| {
        (
            (a * stiff.contact_n - b * soft.contact_n) / determinant,
            (soft.master_mps * b - stiff.master_mps * a) / determinant,
        )
    };
    let (h11, h12) = solved(soft.hand_n, stiff.hand_n);
    let (h21, h22) = solved(soft.slave_mps * -1.0, stiff.slave_mps * -1.0);
    let options = Options::default();
    let s = imaginary(TAU * frequency_hz);
    let late = |seconds: f64| (s * -seconds).exp();
    let (master, slave, servo) = (options.master, options.slave, options.servo);
    let servo = s * servo.damping_ns_per_m + real(servo.stiffness_n_per_m);
    let own = s * s * slave.mass_kg + s * slave.damping_ns_per_m + servo;
    let tick_s = 1.0 / RATE_HZ;
    for (name, found, exact) in [
        (
            "h11",
            h11,
            s * master.mass_kg + real(master.damping_ns_per_m),
        ),
        ("h12", h12, late(delay_s + 1.5 * tick_s)),
        (
            "h21",
            h21,
            late(delay_s + 0.5 * tick_s) * (servo / own) * -1.0,
        ),
        ("h22", h22, s / own),
    ] {
        let error = (found - exact).norm() / exact.norm();
        assert!(tolerance::HYBRID.contains(&error), "{name}: {error}");
    }
}

#[test]
fn the_energy_of_every_part_balances() {
    for scheme in SchemeId::ALL {
        let options = Options::default()
            .with_scheme(scheme)
            .with_channel(0.01, 0.0, 0.0);
        let options = options.with_task_for_delay();
        let trace = System::new(&options, 3).run();
        let (mut moved_j, mut worst_j) = (0.0_f64, 0.0_f64);
        let kinetic = |mass_kg: f64, speed_mps: f64| 0.5 * mass_kg * speed_mps.powi(2);
        let carried_kg = options.master.mass_kg + options.operator.grips[0].mass_kg;
        for row in &trace.rows {
            let master_j = kinetic(carried_kg, row.master_mps);
            let slave_j = kinetic(options.slave.mass_kg, row.slave_mps);
            let masters = row.hand_j - row.felt_j - row.lost_j - master_j;
            let slaves = row.slave_j - row.material_j - row.slave_lost_j - slave_j;
            moved_j = moved_j.max(row.hand_j.abs()).max(row.slave_j.abs());
            worst_j = worst_j.max(masters.abs()).max(slaves.abs());
        }
        let share = worst_j / moved_j;
        assert!(
            tolerance::ENERGY_BALANCE.contains(&share),
            "{}: {share}",
            scheme.name()
        );
    }
}

/// The work of the hand is what its intention puts in, less what its spring stores and its damper loses; the work on a
/// material is what it stores and what its damping loses.
#[test]
fn the_energies_of_the_hand_and_of_the_material_balance() {
    let options = Options {
        environment: Environment::throughout(Material::gel()),
        ..Options::default()
    };
    let options = options.with_channel(0.01, 0.0, 0.0).with_task_for_delay();
    let trace = System::new(&options, 3).run();
    let grip = options.operator.grips[0];
    let (stored, gel) = (
        Touching::at_rest(&Material::gel()),
        HuntCrossley::new(1350.0, 36.0, 1.35, 1e-3),
    );
    let (mut intended_j, mut damper_j, mut heat_j) = (0.0, 0.0, 0.0);
    let (mut moved_j, mut worst_j) = (0.0_f64, 0.0_f64);
    let (mut last, mut first_j) = ([0.0; 3], None);
    for row in &trace.rows {
        let (x, v) = options.operator.intention.position(row.time_s);
        let (stretch_m, slip_mps) = (x - row.master_m, v - row.master_mps);
        let pull_n = grip.stiffness_n_per_m * stretch_m + grip.damping_ns_per_m * slip_mps;
        let depth_m = row.slave_m.max(0.0);
        let damping_n = gel.force_n(depth_m, row.slave_mps) - gel.force_n(depth_m, 0.0);
        // Powers between ticks by the trapezium: 1e-4 of a motion that is over 20 Hz only in its starts.
        let powers = [
            pull_n * v,
            grip.damping_ns_per_m * slip_mps.powi(2),
            damping_n * row.slave_mps,
        ];
        let works = [0, 1, 2].map(|i| 0.5 * (powers[i] + last[i]) * trace.period_s);
        (intended_j, damper_j, heat_j) = (
            intended_j + works[0],
            damper_j + works[1],
            heat_j + works[2],
        );
        last = powers;
        let spring_j = 0.5 * grip.stiffness_n_per_m * stretch_m.powi(2);
        let at_first_j = *first_j.get_or_insert(spring_j);
        let hand_j = intended_j - damper_j - (spring_j - at_first_j) - row.hand_j;
        let material_j = row.material_j - stored.stored_j(row.slave_m) - heat_j;
        moved_j = moved_j.max(intended_j.abs());
        worst_j = worst_j.max(hand_j.abs()).max(material_j.abs());
    }
    let share = worst_j / moved_j;
    assert!(
        tolerance::ENERGY_BALANCE.contains(&share),
        "{share} of {moved_j} J"
    );
}
