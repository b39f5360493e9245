//! The firmware in QEMU against the host. `cargo xtask test` builds what this needs and says where
//! it is.

use estimator_core::estimate::PARAMETER_SLOTS;
use estimator_core::frame::Frame;
use estimator_core::{Config, Estimate, Fault, Faults, Params, Sample, State, step};
use std::ops::RangeInclusive;
use std::path::PathBuf;
use std::sync::LazyLock;
use std::{env, fs};
use tests::emulator::{Budget, Emulator, Meter, Run, footprint};
use tests::signal::palpation;

/// 100 s.
const SAMPLES: usize = 100_000;

struct Replay {
    samples: Vec<Sample<f32>>,
    run: Run,
    budget: Budget,
}

/// One run for all tests.
static REPLAY: LazyLock<Replay> = LazyLock::new(|| {
    let samples = with_faults(palpation(SAMPLES, 1));
    let emulator = Emulator::from_env("replay").expect("set-up");
    let run = emulator.run(&samples, |_| {}).expect("run");
    let budget = Budget::from_log(&run.log).expect("budget");
    println!("{budget:?}");
    Replay {
        samples,
        run,
        budget,
    }
});

/// What a board may deliver on a bad day, all of it between the first and the second contact and
/// again late in the run.
fn with_faults(mut samples: Vec<Sample<f32>>) -> Vec<Sample<f32>> {
    for start in [2_500, 80_000] {
        samples[start].force_n = f32::NAN;
        samples[start + 10].position_m = f32::INFINITY;
        samples[start + 20].time_us = samples[start].time_us;
        samples[start + 30].faults = Faults::NONE.with(Fault::ForceSaturated);
        samples[start + 40].force_n = f32::MAX;
        samples[start + 50].position_m = -0.0;
        samples[start + 60].force_n = f32::from_bits(1);
    }
    // 250 ms are missing.
    samples.drain(90_000..90_250);
    samples
}

#[test]
fn every_frame_from_the_emulator_has_the_bits_of_the_host() {
    let params: Params<f32> = Config::default().validate().expect("the default is valid");
    let mut state = State::new(&params);
    let Replay { samples, run, .. } = &*REPLAY;
    assert_eq!(run.frames.len(), 2 * samples.len());
    for (index, (sample, frames)) in samples.iter().zip(run.frames.chunks(2)).enumerate() {
        let estimate = step(&params, &mut state, *sample);
        let [
            (first, Frame::Sample(input)),
            (second, Frame::Estimate(output)),
        ] = frames
        else {
            panic!("sample {index}: not a sample and its estimate: {frames:?}");
        };
        // 16 bits of the number of frames.
        assert_eq!(*first, (2 * index) as u16);
        assert_eq!(*second, (2 * index + 1) as u16);
        if let Some(difference) = differs(&sample_fields(sample), &sample_fields(input))
            .or_else(|| differs(&estimate_fields(&estimate), &estimate_fields(output)))
        {
            panic!("sample {index}: {difference}\nhost: {estimate:?}\nQEMU: {output:?}");
        }
    }
}

#[test]
fn the_run_is_about_contact_in_both_materials_and_every_fault_shows() {
    let estimates = || {
        REPLAY
            .run
            .frames
            .iter()
            .filter_map(|(_, frame)| match frame {
                Frame::Estimate(estimate) => Some(estimate),
                Frame::Sample(_) => None,
            })
    };
    let contacts =
        estimates().filter(|e| e.event == Some(estimator_core::estimate::Event::Contact));
    assert!((60..400).contains(&contacts.count()));
    for fault in [
        Fault::ForceUnusable,
        Fault::PositionUnusable,
        Fault::TimeNotAdvancing,
        Fault::SampleMissed,
        Fault::ForceSaturated,
    ] {
        assert!(estimates().any(|e| e.faults.has(fault)), "{fault:?}");
    }
}

#[test]
fn the_tick_is_one_kilohertz_and_nothing_is_dropped() {
    let budget = &REPLAY.budget;
    let samples = REPLAY.samples.len() as u64;
    assert_eq!((budget.samples, budget.ticks), (samples, samples));
    assert_eq!(budget.dropped, 0);
    // 1 instruction is 1 ns: a tick of 1 ms is 1 000 000 of them. QEMU rounds a period of SysTick
    // down to whole nanoseconds: 999 999.
    assert_eq!(budget.tick, 1_000_000);
    contains("tick.mean", budget.period.mean);
    contains("tick.min", budget.period.min);
    contains("tick.max", budget.period.max);
}

#[test]
fn a_step_costs_what_the_budget_says() {
    let budget = &REPLAY.budget;
    within("step", &budget.step);
    within("task", &budget.task);
}

#[test]
fn the_images_take_the_flash_and_ram_that_the_budget_says() {
    for (variable, key) in [("PALPATE_QEMU_ELF", "qemu"), ("PALPATE_F405_ELF", "f405")] {
        let elf = PathBuf::from(env::var_os(variable).expect(variable));
        let (flash, ram) = footprint(&elf).expect("footprint");
        println!("{key}: {flash} bytes of flash, {ram} bytes of RAM");
        contains(&format!("{key}.flash"), flash);
        contains(&format!("{key}.ram"), ram);
    }
}

fn within(key: &str, meter: &Meter) {
    contains(&format!("{key}.mean"), meter.mean);
    contains(&format!("{key}.max"), meter.max);
}

/// Both sides: a cost that is suddenly much lower is as suspect as one that is higher.
fn contains(key: &str, value: u64) {
    let allowed = bounds(key);
    assert!(
        allowed.contains(&value),
        "{key} = {value} is outside {allowed:?} of tests/budget.toml"
    );
}

fn bounds(key: &str) -> RangeInclusive<u64> {
    static TEXT: LazyLock<String> = LazyLock::new(|| {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/budget.toml");
        fs::read_to_string(path).expect("tests/budget.toml")
    });
    let pair = TEXT
        .lines()
        .find_map(|line| line.strip_prefix(key)?.trim_start().strip_prefix("= ["))
        .and_then(|rest| rest.split_once(']')?.0.split_once(','))
        .unwrap_or_else(|| panic!("no `{key} = [low, high]` in tests/budget.toml"));
    let number = |text: &str| text.trim().replace('_', "").parse().expect(key);
    number(pair.0)..=number(pair.1)
}

type Field = (&'static str, u64);

/// The first field in which two records differ, with both values.
fn differs(host: &[Field], qemu: &[Field]) -> Option<String> {
    let (host, qemu) = host.iter().zip(qemu).find(|(host, qemu)| host != qemu)?;
    let (a, b) = (f32::from_bits(host.1 as u32), f32::from_bits(qemu.1 as u32));
    Some(format!(
        "{} differs: host {:#x} ({a}), QEMU {:#x} ({b})",
        host.0, host.1, qemu.1
    ))
}

fn bits(value: f32) -> u64 {
    u64::from(value.to_bits())
}

fn sample_fields(sample: &Sample<f32>) -> Vec<Field> {
    vec![
        ("sample.time_us", sample.time_us),
        ("sample.faults", u64::from(sample.faults.bits())),
        ("sample.position_m", bits(sample.position_m)),
        ("sample.force_n", bits(sample.force_n)),
    ]
}

/// In the order in which they are calculated, as far as there is one: the first that differs is
/// closest to the cause.
fn estimate_fields(estimate: &Estimate<f32>) -> Vec<Field> {
    let innovation = &estimate.innovation;
    let mut fields = vec![
        ("time_us", estimate.time_us),
        ("faults", u64::from(estimate.faults.bits())),
        ("depth_m", bits(estimate.depth_m)),
        ("speed_mps", bits(estimate.speed_mps)),
        ("force_n", bits(estimate.force_n)),
        ("phase", estimate.phase as u64),
        ("event", estimate.event.map_or(0, |event| event as u64)),
        ("law", u64::from(estimate.law.code())),
        ("prediction_n", bits(innovation.prediction_n)),
        ("variance_n2", bits(innovation.variance_n2)),
        ("test_ratio", bits(innovation.test_ratio)),
        ("forgetting", bits(estimate.forgetting)),
    ];
    macro_rules! parameter {
        ($slot:literal) => {
            [
                concat!("parameter ", $slot, " observable"),
                concat!("parameter ", $slot),
                concat!("parameter ", $slot, " std_error"),
            ]
        };
    }
    let names: [[&str; 3]; PARAMETER_SLOTS] = [
        parameter!(0),
        parameter!(1),
        parameter!(2),
        parameter!(3),
        parameter!(4),
        parameter!(5),
        parameter!(6),
        parameter!(7),
        parameter!(8),
        parameter!(9),
        parameter!(10),
        parameter!(11),
    ];
    for (slot, parameter) in estimate.parameters.iter().enumerate() {
        let known = parameter.unwrap_or_default();
        let [observable, value, std_error] = names[slot];
        fields.push((observable, u64::from(parameter.is_some())));
        fields.push((value, bits(known.value)));
        fields.push((std_error, bits(known.std_error)));
    }
    fields.push(("status", u64::from(estimate.status.code())));
    fields
}
