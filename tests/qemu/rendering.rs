//! A board that is slave and master at once: it sends what it identifies, and renders what it is told.

use crate::SAMPLES;
use crate::budget::{contains, within};
use crate::codes::FROM_CODES;
use crate::commands::answers;
use crate::fields::{assert_same, estimate_fields, rendered_fields};
use crate::frames::{
    codes, every_frame_is_numbered, measured_codes, records, replies, with_pauses,
};
use crate::settings::{changed, save};
use estimator_core::board::frame::Frame;
use estimator_core::board::link::{Answer, Change, Command, Refusal};
use estimator_core::board::reflection::{Limit, Packet};
use estimator_core::board::sampling::{Record, Sampler};
use estimator_core::board::sensing::Codes;
use estimator_core::board::settings::{Key, Settings, Setup};
use estimator_core::estimate::Estimated;
use estimator_core::{Config, Fault, Params, Sample, State, step};
use std::fs;
use std::sync::LazyLock;
use tests::emulator::{Budget, Emulator, Run};
use tests::signal::palpation;

struct Reflecting {
    settings: Settings,
    told: Vec<Packet>,
    codes: Vec<Codes>,
    run: Run,
    budget: Budget,
    /// The changes of the force output (force.codes).
    forces: Vec<u8>,
}

/// One run of a board that sends what it identifies at every fifth sample and renders what it is told. Its
/// damping is that of a handle on a motor, and limits what it renders.
static REFLECTING: LazyLock<Reflecting> = LazyLock::new(|| {
    let settings = changed([
        (Key::ReflectionEvery, 5.0),
        (Key::RenderForceN, 8.0),
        (Key::RenderDeviceNsPerM, 8.0),
        (Key::RenderTimeoutS, 2.0),
        (Key::RenderZero, 0.1),
    ]);
    let told = [
        // In between a packet that is out of order, and a stiffness that no material has.
        (0, told(1_000_000, [1350.0, 36.0, 1.35, 1e-4])),
        (400, told(900_000, [9.0, 9.0, 1.0, 0.0])),
        (400, told(1_400_000, [-5.0, 36.0, 1.35, 1e-4])),
        (400, told(2_000_000, [11_500.0, 70.0, 1.2, -1e-4])),
        (400, told(2_500_000, [200.0, 1.0, 1.6, 0.0])),
    ];
    // A packet that comes before the output is armed is refused.
    let mut commands = vec![(0, Command::Reflect(told[0].1)), (50, Command::Arm)];
    commands.extend(told.map(|(quiet_ms, packet)| (quiet_ms + 50, Command::Reflect(packet))));
    let emulator = Emulator::from_env("reflecting").expect("set-up");
    save(&emulator, &settings);
    let bytes = with_pauses(&commands);
    fs::write(emulator.directory.join("commands.frames"), bytes).expect("commands");
    let codes = codes(&palpation(SAMPLES / 10, 6));
    let (run, budget) = measured_codes(&emulator, &codes);
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

/// A packet with an estimate of these parameters.
fn told(time_us: u64, values: [f32; 4]) -> Packet {
    let params: Params<f32> = Config::default().validate().expect("the default is valid");
    let mut estimate = step(&params, &mut State::new(&params), Sample::default());
    for (slot, value) in estimate.parameters.iter_mut().zip(values) {
        *slot = Some(Estimated {
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
    let setup = settings.setup().expect("valid");
    let mut host = Sampler::new(setup);
    let mut unarmed = 0;
    every_frame_is_numbered(&run.frames);
    let frames = records(&run.frames);
    let mut frames = frames.iter().peekable();
    let (mut taken, mut written) = (0, forces.chunks(6).map(put_out).peekable());
    let (mut last_code, mut packets, mut seen, mut pushed) = (None, 0, 0_u8, 0);
    let mut stopped = 0;
    for (index, codes) in codes.iter().enumerate() {
        assert_eq!(frames.next(), Some(&Frame::Codes(*codes)));
        let read = host.convert(codes);
        assert!(matches!(frames.next(), Some(Frame::Sample(_))));
        let Some(Frame::Estimate(estimate)) = frames.next() else {
            panic!("sample {index}: no estimate");
        };
        // The emulator says when it was armed: nothing is rendered before, and something at every sample since.
        let rendered = match frames.peek() {
            Some(Frame::Rendered(rendered)) => Some(rendered),
            _ => None,
        };
        if rendered.is_some() {
            frames.next();
        }
        if rendered.is_some() && unarmed == index {
            let armed = Setup { arming: 1, ..setup };
            host.apply(&Change {
                setup: armed,
                restart: false,
            });
        }
        unarmed += usize::from(rendered.is_none());
        let sequence = rendered.map_or(0, |rendered| rendered.sequence);
        // The emulator says when a packet came, the host what has to follow from it.
        if sequence != taken {
            taken = sequence;
            let packet = told.iter().find(|packet| packet.sequence == taken);
            host.take(packet.expect("one that was told"));
        }
        let (force, code) = host.render(&read, false, estimator_core::board::sampling::FULL);
        assert_eq!(force.is_some(), rendered.is_some(), "sample {index}");
        if let (Some(force), Some(rendered)) = (&force, rendered) {
            assert_same(index, force, rendered, rendered_fields);
            seen |= rendered.limits;
            pushed += u32::from(rendered.force_n > 0.5);
            stopped += u32::from(rendered.faults.has(Fault::RenderStopped));
        }
        // A change of the output at this tick.
        if last_code.replace(code) != Some(code) {
            assert_eq!(written.next(), Some((index as u32, code)));
        }
        let contact = host.compensate(read);
        let estimated = host.step(contact);
        assert_same(index, &estimated, estimate, estimate_fields);
        let due = host.due(&estimated);
        let record = Record {
            codes: None,
            sample: read,
            estimate: estimated,
            rendered: None,
            due,
        };
        if let Some(packet) = record.packet() {
            let sent = frames.next();
            assert_eq!(sent, Some(&Frame::Reflection(packet)), "sample {index}");
            packets += 1;
        }
    }
    assert!((50..200).contains(&unarmed), "{unarmed}");
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
    let answers: Vec<Answer> = replies(run).into_iter().map(|(_, answer)| answer).collect();
    let refused = |reason| Answer::Refused(reason, 0);
    assert_eq!(
        answers,
        [
            refused(Refusal::NotArmed),
            Answer::Done,
            Answer::Done,
            refused(Refusal::Overtaken),
            refused(Refusal::NotRenderable),
            Answer::Done,
            Answer::Done,
        ]
    );
    assert_eq!(answers.len(), told.len() + 2);
}

/// WHEN settings are saved, THEN the force is at rest and stays there until the output is armed again; a save that is
/// refused in contact changes nothing.
#[test]
fn a_save_puts_the_force_to_rest_and_only_an_arming_brings_it_back() {
    let settings = changed([
        (Key::RenderForceN, 8.0),
        (Key::RenderDeviceNsPerM, 8.0),
        (Key::RenderTimeoutS, 10.0),
        (Key::RenderZero, 0.1),
    ]);
    let emulator = Emulator::from_env("saving").expect("set-up");
    save(&emulator, &settings);
    // GIVEN a surface so far out that there is a force wherever the probe is
    let push = |i: u64| Command::Reflect(told(1_000_000 + 1000 * i, [300.0, 0.0, 1.0, -2e-2]));
    let mut commands = vec![(0, Command::Arm), (50, push(0))];
    for i in 1..=10 {
        // Only every second save is followed by an arming.
        commands.push((150, Command::Save));
        commands.extend((i % 2 == 0).then_some((150, Command::Arm)));
        commands.push((50, push(i)));
    }
    let answers = answers(&emulator, &commands, &[]);
    let (mut armed, mut rests) = (false, 0);
    for ((_, command), answer) in commands.iter().zip(&answers) {
        match (command, answer) {
            (Command::Arm, Answer::Done) => armed = true,
            (Command::Save, Answer::Done) => {
                rests += usize::from(armed);
                armed = false;
            }
            (Command::Save, Answer::Refused(Refusal::InContact, 0)) => {}
            (Command::Reflect(_), Answer::Done) => assert!(armed),
            (Command::Reflect(_), Answer::Refused(Refusal::NotArmed, 0)) => assert!(!armed),
            other => panic!("{other:?}"),
        }
    }
    assert!((2..10).contains(&rests), "{answers:?}");
    // THEN it is at rest as often as an armed output was saved, and not when that was refused
    let forces = fs::read(emulator.directory.join("force.codes")).expect("force.codes");
    let codes: Vec<u16> = forces.chunks(6).map(|bytes| put_out(bytes).1).collect();
    let (first, after) = codes.split_first().expect("codes");
    assert_eq!(*first, 263);
    assert_eq!(after.iter().filter(|code| **code == 263).count(), rests);
}

#[test]
fn rendering_costs_what_the_budget_says() {
    let budget = &REFLECTING.budget;
    within("render", &budget.render);
    contains("stack_free", budget.stack_free);
    assert_eq!(budget.dropped, 0);
    // Without rendering the stage costs next to nothing.
    contains("render.none", FROM_CODES.2.render.max);
}

/// The tick and the code of a change of the force output.
fn put_out(bytes: &[u8]) -> (u32, u16) {
    let [a, b, c, d, low, high] = *bytes else {
        panic!("force.codes is cut");
    };
    (
        u32::from_le_bytes([a, b, c, d]),
        u16::from_le_bytes([low, high]),
    )
}
