//! The estimator in a loop of your own: read both sensors, call `step`, use what it says.
//!
//! `cargo run -p estimator-core --example embed`. The sensors here are a closed form (gel, stroked at
//! 1.2 Hz, with 20 mN of noise); on a board they are your load cell and your encoder.

use estimator_core::{Config, ConfigError, Estimate, Faults, Params, Sample, State, Status, step};

/// Gel of the chapter: K (N/m) and λ (N s/m) at 1 mm, n, and where its surface is (m).
const GEL: (f64, f64, f64, f64) = (1350.0, 36.0, 1.35, 0.18e-3);
/// Standard deviation of the load cell's noise (N).
const NOISE_N: f64 = 0.02;

/// What your drivers do: one instant of both channels, with its time stamp.
fn read_sensors(tick: u32, noise: &mut Noise) -> Sample<f32> {
    let (stiffness, damping, exponent, surface_m) = GEL;
    // Half a second in free air first: the noise and the resting force are measured there.
    let angle = core::f64::consts::TAU * 1.2e-3 * f64::from(tick.max(500) - 500);
    let position_m = -5e-4 + 1.75e-3 * (1.0 - angle.cos());
    let speed_mps = 1.75e-3 * core::f64::consts::TAU * 1.2 * angle.sin();
    let depth = (position_m - surface_m).max(0.0) / 1e-3;
    let pushed_n = (stiffness * 1e-3 + damping * speed_mps) * depth.powf(exponent);
    Sample {
        time_us: u64::from(tick + 1) * 1000,
        position_m: position_m as f32,
        force_n: (pushed_n.max(0.0) + NOISE_N * noise.next()) as f32,
        faults: Faults::NONE,
    }
}

/// Ten seconds of the loop; gives the last estimate.
fn run(config: &Config) -> Result<Estimate, ConfigError> {
    // Once, outside of the loop: a field that cannot be used is named here.
    let params: Params<f32> = config.validate()?;
    let mut state = State::new(&params);
    let mut noise = Noise(1);
    let mut last = None;
    for tick in 0..10_000 {
        let estimate = step(&params, &mut state, read_sensors(tick, &mut noise));
        if let Some(event) = estimate.event {
            println!("{:6.3} s  {}", estimate.time_us as f64 * 1e-6, event.name());
        }
        // Use parameters only while they hold: here a controller would take the stiffness over.
        if estimate.status == Status::Converged && last.is_none() {
            println!("{:6.3} s  converged", estimate.time_us as f64 * 1e-6);
        }
        if estimate.status == Status::Converged {
            last = Some(estimate);
        }
    }
    Ok(last.unwrap_or_else(|| step(&params, &mut state, read_sensors(10_000, &mut noise))))
}

fn main() -> Result<(), ConfigError> {
    let estimate = run(&Config::default())?;
    println!("{}", estimate.law.name());
    for (info, parameter) in estimate.law.parameters().iter().zip(&estimate.parameters) {
        match parameter {
            Some(own) => println!(
                "  {:10} {} ± {} {}",
                info.name, own.value, own.std_error, info.unit
            ),
            None => println!("  {:10} not observable yet", info.name),
        }
    }
    Ok(())
}

/// Noise without a crate: Knuth's MMIX generator, twelve uniform numbers make a normal one.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        let mut sum = -6.0;
        for _ in 0..12 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005);
            self.0 = self.0.wrapping_add(1_442_695_040_888_963_407);
            sum += (self.0 >> 11) as f64 / (1_u64 << 53) as f64;
        }
        sum
    }
}

#[test]
fn gel_is_found_within_one_percent() {
    let estimate = run(&Config::default()).expect("the defaults are valid");
    assert_eq!(estimate.status, Status::Converged);
    let (stiffness, damping, exponent, surface_m) = GEL;
    let value = |slot: usize| f64::from(estimate.parameters[slot].expect("observable").value);
    for (slot, truth) in [(0, stiffness), (1, damping), (2, exponent)] {
        // The README's table: 100 of 100 palpations of gel end within 1 %.
        assert!(
            (value(slot) / truth - 1.0).abs() < 0.01,
            "{slot}: {}",
            value(slot)
        );
    }
    // Its 95 % bound on gel is 2.0 µm.
    assert!((value(3) - surface_m).abs() < 4e-6, "{}", value(3));
}

#[test]
fn a_configuration_that_cannot_be_used_is_refused_by_the_field() {
    let config = Config {
        rate_hz: f32::NAN,
        ..Config::default()
    };
    assert_eq!(run(&config).unwrap_err().field, "rate_hz");
}
