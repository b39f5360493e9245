//! The firmware in QEMU against the host. `cargo xtask test` builds what this needs and says where
//! it is.

use estimator_core::board::frame::Frame;
use estimator_core::board::link::{Answer, Command, Health, Identity, Name, Refusal};
use estimator_core::board::reflection::{Limit, Packet, Rendered};
use estimator_core::board::sampling::{Record, Sampler};
use estimator_core::board::sensing::{Codes, Watch};
use estimator_core::board::settings::store::Store;
use estimator_core::board::settings::{Key, Settings};
use estimator_core::estimate::PARAMETER_SLOTS;
use estimator_core::{Config, Estimate, Fault, Faults, Params, Sample, State, step};
use palpate::link::Device;
use palpate::link::board::{Memory, SECTOR};
use palpate::link::port::Files;
use palpate::link::record::{convert, record};
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
    every_frame_is_numbered(&run.frames);
    let frames = records(&run.frames);
    assert_eq!(frames.len(), 2 * samples.len());
    for (index, (sample, frames)) in samples.iter().zip(frames.chunks(2)).enumerate() {
        let estimate = step(&params, &mut state, *sample);
        let [Frame::Sample(input), Frame::Estimate(output)] = frames else {
            panic!("sample {index}: not a sample and its estimate: {frames:?}");
        };
        if let Some(difference) = differs(&sample_fields(sample), &sample_fields(input))
            .or_else(|| differs(&estimate_fields(&estimate), &estimate_fields(output)))
        {
            panic!("sample {index}: {difference}\nhost: {estimate:?}\nQEMU: {output:?}");
        }
    }
}

/// 16 bits of the number of frames: nothing is missing and nothing comes twice.
fn every_frame_is_numbered(frames: &[(u16, Frame)]) {
    for (index, (sequence, frame)) in frames.iter().enumerate() {
        assert_eq!(*sequence, index as u16, "{frame:?}");
    }
}

/// Without what comes once a second and what answers a command.
fn records(frames: &[(u16, Frame)]) -> Vec<Frame> {
    let records = frames.iter().map(|(_, frame)| *frame);
    records
        .filter(|frame| !matches!(frame, Frame::Health(_) | Frame::Reply(_)))
        .collect()
}

/// The same palpation as the converters of the reference wiring would give it.
fn codes(samples: &[Sample<f32>]) -> Vec<Codes> {
    let scale = |key: Key| f64::from(key.info().default);
    let code = |value: f32, per_code: Key| (f64::from(value) / scale(per_code)).round() as i32;
    let zero = scale(Key::ForceZeroCode) as i32;
    samples
        .iter()
        .map(|sample| {
            let force = zero + code(sample.force_n, Key::ForcePerCode);
            Codes {
                time_us: sample.time_us,
                force,
                force_low: force / 32 - 3,
                force_high: force / 32 + 3,
                position: code(sample.position_m, Key::PositionPerCode),
                faults: Faults::NONE,
            }
        })
        .collect()
}

/// The whole task path: codes, conversion, watch, step, queue, frames.
static FROM_CODES: LazyLock<(Vec<Codes>, Run, Budget)> = LazyLock::new(|| {
    let mut codes = codes(&palpation(SAMPLES, 2));
    // A conversion at the end of its range, an encoder that jumps, one that stands still.
    codes[40_000].force_high = 4095;
    codes[50_000..]
        .iter_mut()
        .for_each(|c| c.position += 32 * 6000);
    let held = codes[60_000].position;
    codes[60_000..61_500]
        .iter_mut()
        .for_each(|c| c.position = held);
    let held = codes[70_000].force;
    codes[70_000..71_500]
        .iter_mut()
        .for_each(|c| c.force = held);
    let frames: Vec<Frame> = codes.iter().copied().map(Frame::Codes).collect();
    let emulator = Emulator::from_env("codes").expect("set-up");
    let run = emulator.run_frames(&frames, |_| {}).expect("run");
    let budget = Budget::from_log(&run.log).expect("budget");
    println!("{budget:?}");
    (codes, run, budget)
});

/// The same with eight effects to be taken off, as many as a board can, each of another law: what was
/// found on a rig and saved. Small, so that what is left is still a palpation.
static COMPENSATED: LazyLock<(Settings, Vec<Codes>, Run, Budget)> = LazyLock::new(|| {
    let mut settings = Settings::default();
    for (name, value) in [
        ("coulomb_friction.force", 0.05),
        ("coulomb_friction.transition_speed", 5e-4),
        ("viscous_drag.coefficient", 0.5),
        ("tool_inertia.mass", 0.02),
        ("cogging.amplitude", 0.01),
        ("cogging.pitch", 2e-3),
        ("cogging.phase", 0.3),
        ("series_compliance.stiffness", 2e5),
        ("force_lag.time_constant", 1e-3),
        ("time_delay.delay", 1.3e-3),
        ("encoder_periodic_error.amplitude", 2e-6),
        ("encoder_periodic_error.pitch", 1e-3),
    ] {
        let key = Key::from_name(&format!("compensation.{name}")).expect(name);
        settings.put(key, value);
    }
    let mut codes = codes(&palpation(SAMPLES / 4, 5));
    codes[10_000].force_high = 4095;
    codes[15_000..]
        .iter_mut()
        .for_each(|c| c.position += 32 * 6000);
    codes.drain(20_000..20_250);
    let frames: Vec<Frame> = codes.iter().copied().map(Frame::Codes).collect();
    let emulator = Emulator::from_env("compensated").expect("set-up");
    let mut store = Store::new(Memory::default(), 0, SECTOR);
    store.save(&settings).expect("memory");
    let flash = emulator.directory.join("settings.flash");
    fs::write(flash, store.release().bytes()).expect("settings.flash");
    let run = emulator.run_frames(&frames, |_| {}).expect("run");
    let budget = Budget::from_log(&run.log).expect("budget");
    println!("{budget:?}");
    (settings, codes, run, budget)
});

#[test]
fn with_what_was_saved_taken_off_the_emulator_has_the_bits_of_the_host() {
    let (settings, codes, run, _) = &*COMPENSATED;
    let mut host = Sampler::new(settings.setup().expect("eight effects"));
    every_frame_is_numbered(&run.frames);
    let frames = records(&run.frames);
    assert_eq!(frames.len(), 3 * codes.len());
    let (mut contacts, mut taken_off) = (0, 0);
    for (index, (codes, frames)) in codes.iter().zip(frames.chunks(3)).enumerate() {
        let read = host.convert(codes);
        let contact = host.compensate(read);
        let estimate = host.step(contact);
        taken_off += usize::from((contact.force_n - read.force_n).abs() > 0.02);
        contacts += usize::from(estimate.event == Some(estimator_core::estimate::Event::Contact));
        let [
            Frame::Codes(_),
            Frame::Sample(input),
            Frame::Estimate(output),
        ] = frames
        else {
            panic!("sample {index}: not codes, sample and estimate: {frames:?}");
        };
        // What is sent is what was read: it can be replayed with other settings.
        if let Some(difference) = differs(&sample_fields(&read), &sample_fields(input))
            .or_else(|| differs(&estimate_fields(&estimate), &estimate_fields(output)))
        {
            panic!("sample {index}: {difference}\nhost: {estimate:?}\nQEMU: {output:?}");
        }
    }
    assert!(contacts > 10, "{contacts}");
    assert!(taken_off > codes.len() / 4, "{taken_off}");
}

struct Reflecting {
    settings: Settings,
    told: Vec<Packet>,
    codes: Vec<Codes>,
    run: Run,
    budget: Budget,
    /// What the force output got: force.codes.
    forces: Vec<u8>,
}

/// A board that is slave and master at once: sends what it identifies at every fifth sample, and renders
/// what it is told. Its own damping is that of a handle on a motor: what it is told is limited by it.
static REFLECTING: LazyLock<Reflecting> = LazyLock::new(|| {
    let mut settings = Settings::default();
    for (key, value) in [
        (Key::ReflectionEvery, 5.0),
        (Key::RenderForceN, 8.0),
        (Key::RenderDeviceNsPerM, 8.0),
        (Key::RenderTimeoutS, 2.0),
        (Key::RenderZero, 0.1),
    ] {
        settings.put(key, value);
    }
    let told = [
        // Out of order, and what no material has, in between.
        (0, told(1_000_000, [1350.0, 36.0, 1.35, 1e-4])),
        (400, told(900_000, [9.0, 9.0, 1.0, 0.0])),
        (400, told(1_400_000, [-5.0, 36.0, 1.35, 1e-4])),
        (400, told(2_000_000, [11_500.0, 70.0, 1.2, -1e-4])),
        (400, told(2_500_000, [200.0, 1.0, 1.6, 0.0])),
    ];
    let commands = told.map(|(quiet_ms, packet)| (quiet_ms, Command::Reflect(packet)));
    let emulator = Emulator::from_env("reflecting").expect("set-up");
    let mut store = Store::new(Memory::default(), 0, SECTOR);
    store.save(&settings).expect("memory");
    let flash = emulator.directory.join("settings.flash");
    fs::write(flash, store.release().bytes()).expect("settings.flash");
    let bytes = with_pauses(&commands);
    fs::write(emulator.directory.join("commands.frames"), bytes).expect("commands");
    let codes = codes(&palpation(SAMPLES / 10, 6));
    let frames: Vec<Frame> = codes.iter().copied().map(Frame::Codes).collect();
    let run = emulator.run_frames(&frames, |_| {}).expect("run");
    let budget = Budget::from_log(&run.log).expect("budget");
    println!("{budget:?}");
    let forces = fs::read(emulator.directory.join("force.codes")).expect("force.codes");
    Reflecting {
        settings,
        told: told.map(|(_, packet)| packet).to_vec(),
        codes,
        run,
        budget,
        forces,
    }
});

fn told(time_us: u64, values: [f32; 4]) -> Packet {
    let params: Params<f32> = Config::default().validate().expect("the default is valid");
    let mut estimate = step(&params, &mut State::new(&params), Sample::default());
    for (slot, value) in estimate.parameters.iter_mut().zip(values) {
        *slot = Some(estimator_core::estimate::Estimated {
            value,
            std_error: 0.01,
        });
    }
    estimate.time_us = time_us;
    Packet::of(&estimate, 1e-3, (time_us / 1000) as u16)
}

#[test]
fn what_is_reflected_and_what_is_rendered_has_the_bits_of_the_host() {
    let Reflecting {
        settings,
        told,
        codes,
        run,
        forces,
        ..
    } = &*REFLECTING;
    let mut host = Sampler::new(settings.setup().expect("valid"));
    every_frame_is_numbered(&run.frames);
    let frames = records(&run.frames);
    let mut frames = frames.iter();
    let mut next = || {
        frames
            .next()
            .unwrap_or_else(|| panic!("frames are missing"))
    };
    let (mut taken, mut written) = (0, forces.chunks(6).map(put_out).peekable());
    let (mut last_code, mut packets, mut seen, mut pushed) = (None, 0, 0_u8, 0);
    let mut stopped = 0;
    for (index, codes) in codes.iter().enumerate() {
        assert_eq!(next(), &Frame::Codes(*codes));
        let read = host.convert(codes);
        assert!(matches!(next(), Frame::Sample(_)));
        let Frame::Estimate(estimate) = next() else {
            panic!("sample {index}: no estimate");
        };
        let Frame::Rendered(rendered) = next() else {
            panic!("sample {index}: nothing rendered");
        };
        // Which packet came when is the emulator's to say; what became of it, the host's.
        if rendered.sequence != taken {
            taken = rendered.sequence;
            let packet = told.iter().find(|packet| packet.sequence == taken);
            host.take(packet.expect("one that was told"));
        }
        let (own, code) = host.render(&read, 2625);
        let own = own.expect("rendering");
        if let Some(difference) = differs(&rendered_fields(&own), &rendered_fields(rendered)) {
            panic!("sample {index}: {difference}\nhost: {own:?}\nQEMU: {rendered:?}");
        }
        // What the output got at this tick.
        if last_code.replace(code) != Some(code) {
            assert_eq!(written.next(), Some((index as u32, code)));
        }
        let contact = host.compensate(read);
        let own_estimate = host.step(contact);
        if let Some(difference) =
            differs(&estimate_fields(&own_estimate), &estimate_fields(estimate))
        {
            panic!("sample {index}: {difference}");
        }
        let due = host.due(&own_estimate);
        let record = Record {
            codes: None,
            sample: read,
            estimate: own_estimate,
            rendered: None,
            due,
        };
        if let Some(packet) = record.packet() {
            assert_eq!(next(), &Frame::Reflection(packet), "sample {index}");
            packets += 1;
        }
        seen |= rendered.limits;
        pushed += u32::from(rendered.force_n > 0.5);
        stopped += u32::from(rendered.faults.has(Fault::RenderStopped));
    }
    assert_eq!((frames.next(), written.next()), (None, None));
    assert_eq!(packets, codes.len() / 5);
    assert!(pushed > 1000 && stopped > 1000, "{pushed} {stopped}");
    for limit in [
        Limit::Force,
        Limit::Stiffness,
        Limit::Damping,
        Limit::Blending,
        Limit::Fading,
    ] {
        assert!(seen & limit as u8 != 0, "{limit:?}");
    }
}

#[test]
fn packets_to_render_are_done_or_refused_for_their_reason() {
    let Reflecting { told, run, .. } = &*REFLECTING;
    let answers: Vec<Answer> = run
        .frames
        .iter()
        .filter_map(|(_, frame)| match frame {
            Frame::Reply(reply) => Some(reply.answer),
            _ => None,
        })
        .collect();
    let refused = |reason| Answer::Refused(reason, 0);
    assert_eq!(
        answers,
        [
            Answer::Done,
            refused(Refusal::Overtaken),
            refused(Refusal::NotRenderable),
            Answer::Done,
            Answer::Done,
        ]
    );
    assert_eq!(answers.len(), told.len());
}

/// While settings are saved the core may stand still, and the force with it.
#[test]
fn while_settings_are_saved_the_force_is_at_rest_and_then_goes_on() {
    let mut settings = Settings::default();
    for (key, value) in [
        (Key::RenderForceN, 8.0),
        (Key::RenderDeviceNsPerM, 8.0),
        (Key::RenderTimeoutS, 10.0),
        (Key::RenderZero, 0.1),
    ] {
        settings.put(key, value);
    }
    let emulator = Emulator::from_env("saving").expect("set-up");
    let mut store = Store::new(Memory::default(), 0, SECTOR);
    store.save(&settings).expect("memory");
    let flash = emulator.directory.join("settings.flash");
    fs::write(flash, store.release().bytes()).expect("settings.flash");
    // GIVEN a surface so far out that there is a force wherever the probe is
    let push = Command::Reflect(told(1_000_000, [300.0, 0.0, 1.0, -2e-2]));
    let commands = [vec![(0, push)], vec![(150, Command::Save); 10]].concat();
    let answers = answers(&emulator, &commands, &[]);
    let done = answers
        .iter()
        .skip(1)
        .filter(|answer| **answer == Answer::Done)
        .count();
    assert!((1..10).contains(&done), "{answers:?}");
    // THEN it is at rest as often as settings were saved, and not when that was refused
    let forces = fs::read(emulator.directory.join("force.codes")).expect("force.codes");
    let codes: Vec<u16> = forces.chunks(6).map(|bytes| put_out(bytes).1).collect();
    let (first, after) = codes.split_first().expect("codes");
    assert_eq!(*first, 263);
    assert_eq!(after.iter().filter(|code| **code == 263).count(), done);
    assert!(
        after.windows(2).all(|pair| pair[0] != 263 || pair[1] > 800),
        "{after:?}"
    );
}

#[test]
fn rendering_costs_what_the_budget_says() {
    let budget = &REFLECTING.budget;
    within("render", &budget.render);
    contains("stack_free", budget.stack_free);
    assert_eq!(budget.dropped, 0);
    // And none costs next to nothing.
    contains("render.none", FROM_CODES.2.render.max);
}

/// Tick and code of a change in force.codes.
fn put_out(bytes: &[u8]) -> (u32, u16) {
    let [a, b, c, d, low, high] = *bytes else {
        panic!("force.codes is cut");
    };
    (
        u32::from_le_bytes([a, b, c, d]),
        u16::from_le_bytes([low, high]),
    )
}

fn rendered_fields(rendered: &Rendered) -> Vec<Field> {
    vec![
        ("rendered.time_us", rendered.time_us),
        ("rendered.faults", u64::from(rendered.faults.bits())),
        ("rendered.limits", u64::from(rendered.limits)),
        ("rendered.sequence", u64::from(rendered.sequence)),
        ("rendered.force_n", bits(rendered.force_n)),
    ]
}

#[test]
fn eight_effects_at_once_cost_what_the_budget_says() {
    let (_, _, _, budget) = &*COMPENSATED;
    within("compensate", &budget.compensate);
    contains("stack_free", budget.stack_free);
    // And none costs next to nothing.
    contains("compensate.none", FROM_CODES.2.compensate.max);
}

#[test]
fn from_codes_to_frames_the_emulator_has_the_bits_of_the_host() {
    let setup = Settings::default().setup().expect("the default is valid");
    let (mut watch, mut state) = (Watch::default(), State::new(&setup.params));
    let (codes, run, _) = &*FROM_CODES;
    every_frame_is_numbered(&run.frames);
    let frames = records(&run.frames);
    assert_eq!(frames.len(), 3 * codes.len());
    let mut seen = Faults::NONE;
    for (index, (codes, frames)) in codes.iter().zip(frames.chunks(3)).enumerate() {
        let sample = setup.conversion.sample(&mut watch, codes);
        let estimate = step(&setup.params, &mut state, sample);
        seen = seen | estimate.faults;
        let [
            Frame::Codes(given),
            Frame::Sample(input),
            Frame::Estimate(output),
        ] = frames
        else {
            panic!("sample {index}: not codes, sample and estimate: {frames:?}");
        };
        assert_eq!(given, codes, "sample {index}");
        if let Some(difference) = differs(&sample_fields(&sample), &sample_fields(input))
            .or_else(|| differs(&estimate_fields(&estimate), &estimate_fields(output)))
        {
            panic!("sample {index}: {difference}\nhost: {estimate:?}\nQEMU: {output:?}");
        }
    }
    for fault in [
        Fault::NotCalibrated,
        Fault::ForceSaturated,
        Fault::PositionJump,
        Fault::PositionStuck,
        Fault::ForceStuck,
    ] {
        assert!(seen.has(fault), "{fault:?}");
    }
}

#[test]
fn health_comes_once_a_second_and_counts_what_happened() {
    let (codes, run, budget) = &*FROM_CODES;
    let healths: Vec<&Health> = run
        .frames
        .iter()
        .filter_map(|(_, frame)| match frame {
            Frame::Health(health) => Some(health),
            _ => None,
        })
        .collect();
    assert_eq!(healths.len(), codes.len() / 1000);
    let last = healths.last().expect("one");
    assert_eq!(u64::from(last.samples), budget.samples);
    assert_eq!(
        (last.dropped, last.overruns, last.missed, last.garbled),
        (0, 0, 0, 0)
    );
    assert!(last.faults.has(Fault::NotCalibrated));
    // The counters grow, and the costs are those of the log.
    assert!(
        healths
            .windows(2)
            .all(|pair| pair[0].samples < pair[1].samples)
    );
    assert_eq!(u64::from(last.step.max), budget.step.max);
}

#[test]
fn every_stage_costs_what_the_budget_says() {
    let (_, _, budget) = &*FROM_CODES;
    within("convert", &budget.convert);
    within("queue", &budget.queue);
    within("encode", &budget.encode);
}

#[test]
fn the_stack_never_comes_near_its_end() {
    // Painted before the program starts, read back at the end of the run.
    let (_, _, budget) = &*FROM_CODES;
    contains("stack_free", budget.stack_free);
    contains("stack_free", REPLAY.budget.stack_free);
}

/// Commands as a host would send them; `quiet` zeros are an idle line, of which the emulator takes 64
/// in 32 ms.
fn with_pauses(commands: &[(usize, Command)]) -> Vec<u8> {
    let frames: Vec<Frame> = commands.iter().map(|(_, c)| Frame::Command(*c)).collect();
    let mut bytes = Vec::new();
    for (sequence, ((quiet_ms, _), frame)) in commands.iter().zip(frames).enumerate() {
        bytes.extend(std::iter::repeat_n(0, 2 * quiet_ms));
        let mut out = [0; estimator_core::board::frame::MAX_ENCODED];
        let length = estimator_core::board::frame::encode(&frame, sequence as u16, &mut out);
        bytes.extend_from_slice(&out[..length]);
    }
    bytes
}

fn answers(emulator: &Emulator, commands: &[(usize, Command)], garbage: &[u8]) -> Vec<Answer> {
    let bytes = [garbage, &with_pauses(commands)[..]].concat();
    fs::write(emulator.directory.join("commands.frames"), bytes).expect("commands");
    let run = emulator.run(&palpation(8_000, 3), |_| {}).expect("run");
    every_frame_is_numbered(&run.frames);
    let replies = run.frames.iter().filter_map(|(_, frame)| match frame {
        Frame::Reply(reply) => Some(*reply),
        _ => None,
    });
    let replies: Vec<_> = replies.collect();
    for (index, reply) in replies.iter().enumerate() {
        assert_eq!(usize::from(reply.to), index);
    }
    replies.into_iter().map(|reply| reply.answer).collect()
}

#[test]
fn commands_are_answered_refused_with_a_reason_and_settings_outlive_the_run() {
    let emulator = Emulator::from_env("commands").expect("set-up");
    let _ = fs::remove_file(emulator.directory.join("settings.flash"));
    let width = Key::EstimatorHalfWidth.id();
    let identity = Identity {
        board: Name::new("qemu"),
        firmware: Name::new("0.1.0"),
        layout: estimator_core::board::settings::store::LAYOUT,
        rate_hz: 1000,
        tick: 1_000_000,
        unsaved: false,
    };
    let first = answers(
        &emulator,
        &[
            (0, Command::Identify),
            (0, Command::Get(width)),
            (0, Command::Set(width, 12.0)),
            (50, Command::Set(width, 99.0)),
            (50, Command::Set(200, 1.0)),
            (50, Command::Unknown(77)),
            (50, Command::Save),
            (50, Command::Set(width, 16.0)),
            (1000, Command::Get(width)),
            (0, Command::Identify),
        ],
        &[1, 2, 3, 0],
    );
    let value = |value| Answer::Value(width, value);
    assert_eq!(
        first[..8],
        [
            Answer::Identity(identity),
            value(8.0),
            value(12.0),
            Answer::Refused(Refusal::Unusable, width),
            Answer::Refused(Refusal::UnknownSetting, 200),
            Answer::Refused(Refusal::UnknownCommand, 0),
            Answer::Done,
            value(16.0),
        ]
    );
    let unsaved = Identity {
        unsaved: true,
        ..identity
    };
    assert_eq!(first[8..], [value(16.0), Answer::Identity(unsaved)]);
    // The next run has what was saved, not what was changed after it.
    let many: Vec<_> = (0..40).map(|_| (50, Command::Save)).collect();
    let second = answers(
        &emulator,
        &[
            &[(0, Command::Get(width)), (1500, Command::Identify)],
            &many[..],
        ]
        .concat(),
        &[],
    );
    assert_eq!(second[..2], [value(12.0), Answer::Identity(identity)]);
    let count = |answer| second.iter().filter(|a| **a == answer).count();
    let (done, refused) = (
        count(Answer::Done),
        count(Answer::Refused(Refusal::InContact, 0)),
    );
    assert_eq!(done + refused, 40, "{second:?}");
    assert!(done > 0 && refused > 0, "{second:?}");
}

/// While it runs, over the files that it reads and writes.
#[test]
fn the_hosts_verbs_reach_the_emulator_while_it_runs() {
    let emulator = Emulator::from_env("live").expect("set-up");
    let directory = emulator.directory.clone();
    for name in ["commands.frames", "telemetry.frames"] {
        fs::write(directory.join(name), []).expect("empty files");
    }
    let _ = fs::remove_file(directory.join("settings.flash"));
    let out = directory.join("recorded");
    let _ = fs::remove_dir_all(&out);
    let codes = codes(&palpation(SAMPLES, 4));
    let frames: Vec<Frame> = codes.into_iter().map(Frame::Codes).collect();
    let running = std::thread::spawn(move || emulator.run_frames(&frames, |_| {}));
    let mut device = Device::new(Files::open(&directory).expect("the emulator's directory"));
    // It takes a moment to start.
    let identity = (0..20)
        .find_map(|_| device.identity().ok())
        .expect("an answer");
    assert_eq!(identity.board.as_str(), "qemu");
    assert_eq!(device.settings().expect("settings"), Settings::default());
    let unusable = device.set(Key::TelemetryEvery, 0.0).expect_err("refused");
    assert!(
        unusable.to_string().contains("telemetry.every"),
        "{unusable}"
    );
    let statistics = record(&mut device, &out, Some(2_000_000)).expect("a recording");
    assert_eq!((statistics.lost, statistics.garbled), (0, 0));
    let said = convert(&out).expect("a log");
    assert!(said.contains("0 samples missing"), "{said}");
    let run = running.join().expect("no panic").expect("run");
    every_frame_is_numbered(&run.frames);
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
                _ => None,
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
    assert_eq!((budget.dropped, budget.overruns), (0, 0));
    // The 250 ms that the recording lacks, and the two instants whose time stands still.
    assert_eq!(budget.missed, 252);
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

/// The emulator's clocks never become ready. WHEN the board's image starts there, THEN it comes to say
/// so, instead of waiting for ever.
#[test]
fn a_board_whose_clocks_do_not_start_says_so() {
    let elf = PathBuf::from(env::var_os("PALPATE_F405_ELF").expect("PALPATE_F405_ELF"));
    let emulator = Emulator {
        elf,
        ..Emulator::from_env("no-clock").expect("set-up")
    };
    let log = emulator.log_in_memory("PLL").expect("log");
    assert_eq!(log.len(), 2, "{log:?}");
    assert!(log[0].contains("on f405"), "{log:?}");
    assert!(log[1].contains("the PLL does not lock"), "{log:?}");
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
