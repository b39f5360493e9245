//! The host's verbs against a simulated board: the core's sampling, settings and protocol code behind
//! a line in memory or a pseudo-terminal.

mod common;
#[cfg(unix)]
#[path = "common/terminal.rs"]
mod terminal_end;

use std::fs;
use std::io::{self, Write};
use std::sync::{Arc, Mutex};

use common::Folder;
use estimator_core::board::frame::Frame;
use estimator_core::board::link::{Answer, Command, Refusal};
use estimator_core::board::settings::{Key, Settings};
use estimator_core::{Fault, State, step};
use palpate::cli::config::calibrate::{self, CalibrateArgs, Person};
use palpate::link::board::BYTES_PER_MS;
use palpate::link::port::{Files, Simulated};
use palpate::link::record;
use palpate::link::world::{Hand, World};
use palpate::link::{Device, Port, SimulatedBoard};
use palpate::log::{Log, ReadOptions};

type Shared = Arc<Mutex<World>>;

fn world(hand: Hand) -> Shared {
    let mut world = World::default();
    world.hand = hand;
    Arc::new(Mutex::new(world))
}

const HELD: Hand = Hand::Holding {
    position_m: 0.0,
    force_n: 0.0,
};

fn device(world: &Shared, bytes_per_ms: usize) -> Device<Simulated> {
    let board = SimulatedBoard::new(Arc::clone(world), bytes_per_ms);
    Device::new(Simulated::at_once(board))
}

#[test]
fn settings_go_to_the_board_are_saved_and_come_back() {
    let mut device = device(&world(HELD), BYTES_PER_MS);
    assert_eq!(device.identity().unwrap().board.as_str(), "simulated");
    assert_eq!(device.settings().unwrap(), Settings::default());
    device.set(Key::EstimatorDepthM, 0.002).unwrap();
    device.order(Command::Save).unwrap();
    device.set(Key::EstimatorDepthM, 0.005).unwrap();
    assert!(device.identity().unwrap().unsaved);
    device.order(Command::Reload).unwrap();
    assert_eq!(device.get(Key::EstimatorDepthM).unwrap(), 0.002);
    let error = device
        .set(Key::EstimatorDepthM, -1.0)
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("estimator.depth_m") && error.contains("-1"),
        "{error}"
    );
    assert_eq!(device.get(Key::EstimatorDepthM).unwrap(), 0.002);
}

#[test]
fn in_contact_the_board_refuses_what_would_disturb_it_and_takes_the_rest() {
    let mut device = device(&world(Hand::Palpating), BYTES_PER_MS);
    let (mut refused, mut done) = (0, 0);
    // A question is answered 10 ms later: three seconds, of them two strokes.
    for _ in 0..300 {
        match device.ask(Command::Save).unwrap() {
            Answer::Done => done += 1,
            Answer::Refused(Refusal::InContact, 0) => refused += 1,
            other => panic!("{other:?}"),
        }
        device.set(Key::TelemetryEvery, 1.0).unwrap();
    }
    assert!(done > 10 && refused > 10, "{done} done, {refused} refused");
}

#[test]
fn an_hour_at_a_kilohertz_goes_over_two_megabaud_without_a_loss() {
    const HOUR: u32 = 3_600_000;
    let mut device = device(&world(Hand::Palpating), BYTES_PER_MS);
    // The cheapest estimator: what is tested is the link.
    device.set(Key::EstimatorMethod, 1.0).unwrap();
    let (mut last_us, mut samples, mut estimates, mut last_dropped) = (None, 0_u32, 0_u32, None);
    while samples < HOUR {
        match device.next_frame().unwrap() {
            Some(Frame::Sample(sample)) => {
                let due = last_us.map_or(sample.time_us, |last| last + 1000);
                assert_eq!(sample.time_us, due);
                last_us = Some(sample.time_us);
                samples += 1;
            }
            Some(Frame::Estimate(_)) => estimates += 1,
            Some(Frame::Health(health)) => last_dropped = Some(health.dropped),
            Some(_) | None => {}
        }
    }
    let statistics = device.statistics();
    assert_eq!((statistics.lost, statistics.garbled), (0, 0));
    assert_eq!(last_dropped, Some(0));
    assert!(samples - estimates <= 1);
}

#[test]
fn what_a_slower_line_cannot_carry_is_missing_by_the_count_that_the_board_gives() {
    // 921 600 baud carry 92 bytes a millisecond, codes with sample and estimate take 150.
    let mut device = device(&world(Hand::Palpating), 92);
    let (mut received, mut missing, mut last_us) = (0_u32, 0_u64, 0);
    while received < 30_000 {
        if let Some(Frame::Sample(sample)) = device.next_frame().unwrap() {
            missing += (sample.time_us - last_us) / 1000 - 1;
            last_us = sample.time_us;
            received += 1;
        }
    }
    assert_eq!(device.statistics().lost, 0, "what was sent has come");
    let (samples, dropped) = device.port().board().counts();
    // Those that were taken but are still on their way: the queue and the line.
    let underway = i64::from(samples) - i64::from(received) - i64::from(dropped);
    assert!((0..=80).contains(&underway), "{underway}");
    let late = i64::from(dropped) - missing as i64;
    assert!(
        (0..=80).contains(&late),
        "{late}: dropped since the last that came"
    );
    assert!(dropped > 10_000, "{dropped}");
}

/// A port whose bytes are disturbed.
struct Noisy {
    port: Simulated,
    random: u64,
    disturbed: u64,
}

impl Noisy {
    fn random(&mut self) -> u64 {
        // Knuth's MMIX generator.
        self.random = self
            .random
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        self.random >> 33
    }
}

impl Port for Noisy {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let count = self.port.read(into)?;
        let mut kept = 0;
        for index in 0..count {
            let mut byte = into[index];
            // One byte in 2000 is flipped, lost, or doubled into garbage: one frame in forty.
            if self.random().is_multiple_of(2000) {
                self.disturbed += 1;
                match self.random() % 3 {
                    0 => byte ^= 1 << (self.random() % 8),
                    1 => byte = self.random() as u8,
                    _ => continue,
                }
            }
            into[kept] = byte;
            kept += 1;
        }
        Ok(kept)
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.port.write(bytes)
    }
}

#[test]
fn no_disturbed_frame_is_taken_for_a_good_one_and_all_that_are_lost_are_counted() {
    // Two worlds with the same noise, so that the good frames are known.
    let board = SimulatedBoard::new(world(Hand::Palpating), BYTES_PER_MS);
    let mut noisy = Device::new(Noisy {
        port: Simulated::at_once(board),
        random: 7,
        disturbed: 0,
    });
    let mut twin = device(&world(Hand::Palpating), BYTES_PER_MS);
    let mut expected = std::collections::HashMap::new();
    for _ in 0..400_000 {
        if let Some(Frame::Sample(sample)) = twin.next_frame().unwrap() {
            expected.insert(sample.time_us, sample);
        }
    }
    let (mut good, mut frames) = (0, 0);
    while frames < 200_000 {
        match noisy.next_frame().unwrap() {
            Some(Frame::Sample(sample)) => {
                assert_eq!(expected.get(&sample.time_us), Some(&sample));
                (good, frames) = (good + 1, frames + 1);
            }
            Some(_) => frames += 1,
            None => {}
        }
    }
    let statistics = noisy.statistics();
    let disturbed = noisy.port().disturbed;
    assert!(good > 60_000 && disturbed > 3_000, "{good} {disturbed}");
    // A disturbance spoils a frame, or two where it makes or takes a zero; two may hit the same.
    assert!(statistics.lost > disturbed / 2 && statistics.lost <= 2 * disturbed);
    assert!(statistics.garbled > disturbed / 2);
}

/// Lays weights on as it is told, in the simulated world.
struct Helper {
    world: Shared,
    said: String,
    asked: usize,
    gravity: f64,
    /// Force that stays on the cell after the first weight (N).
    creep_n: f64,
    answer: &'static str,
}

impl Helper {
    fn new(world: &Shared) -> Self {
        Helper {
            world: Arc::clone(world),
            said: String::new(),
            asked: 0,
            gravity: 9.80665,
            creep_n: 0.0,
            answer: "y",
        }
    }
}

impl Person for Helper {
    fn asked(&mut self, request: &str) -> io::Result<String> {
        self.said.push_str(request);
        let number = |unit: &str| -> f64 {
            let words: Vec<&str> = request.split([' ', '\u{a0}']).collect();
            let at = words.iter().position(|word| *word == unit).unwrap();
            words[at - 1].parse().unwrap()
        };
        let mut world = self.world.lock().unwrap();
        let Hand::Holding {
            position_m,
            force_n,
        } = &mut world.hand
        else {
            panic!("the hand should hold still");
        };
        if request.contains(" kg ") {
            *force_n = number("kg") * self.gravity + self.creep_n;
        } else if request.contains("every weight") {
            *force_n = if self.asked > 0 { self.creep_n } else { 0.0 };
        } else if request.contains("Move it") {
            *position_m += number("mm") * 1e-3;
        }
        self.asked += 1;
        Ok(self.answer.into())
    }

    fn told(&mut self, text: &str) -> io::Result<()> {
        self.said.push_str(text);
        Ok(())
    }
}

fn arguments(weights: &[f64]) -> CalibrateArgs {
    CalibrateArgs {
        weights: weights.to_vec(),
        pulling: false,
        gravity: 9.80665,
        travel: None,
        yes: false,
    }
}

#[test]
fn a_calibration_finds_the_cell_and_the_encoder_and_the_fault_is_over() {
    // GIVEN a cell that is 3 % off its data sheet, and an encoder that counts down
    let world = world(HELD);
    world.lock().unwrap().m_per_code = -5e-8;
    let mut device = device(&world, BYTES_PER_MS);
    // WHEN four weights are laid on and the probe is moved by 10 mm
    let mut helper = Helper::new(&world);
    let args = CalibrateArgs {
        travel: Some(10.0),
        ..arguments(&[0.0, 0.5, 1.0, 2.0])
    };
    let said = calibrate::run(&mut device, &args, &mut helper).unwrap();
    // THEN scale and zero are found: 12 codes of noise over 1000 samples are 0.4 codes, of 25 000
    assert!(said.contains("saved"), "{said}");
    assert!(helper.said.contains("good: "), "{}", helper.said);
    assert!(helper.said.contains("zero stays"), "{}", helper.said);
    let settings = device.settings().unwrap();
    let truth = world.lock().unwrap().clone();
    let scale = f64::from(settings.get(Key::ForcePerCode)) / truth.n_per_code;
    assert!((scale - 1.0).abs() < 1e-4, "{scale}");
    assert!((f64::from(settings.get(Key::ForceZeroCode)) - truth.zero_code).abs() < 2.0);
    let counted = f64::from(settings.get(Key::PositionPerCode)) / truth.m_per_code;
    assert!((counted - 1.0).abs() < 1e-5, "{counted}");
    assert!(!device.identity().unwrap().unsaved);
    // and the board measures what lies on it, and is calibrated
    world.lock().unwrap().hand = Hand::Holding {
        position_m: 0.0,
        force_n: 7.5,
    };
    let mut forces = Vec::new();
    while forces.len() < 600 {
        if let Some(Frame::Sample(sample)) = device.next_frame().unwrap() {
            assert!(!sample.faults.has(Fault::NotCalibrated));
            forces.push(f64::from(sample.force_n));
        }
    }
    let late = &forces[100..];
    let mean = late.iter().sum::<f64>() / late.len() as f64;
    assert!((mean - 7.5).abs() < 2e-3, "{mean}");
}

#[test]
fn a_bent_cell_and_a_creeping_zero_are_told() {
    for (bend_codes, creep_n, expected) in [
        (1500.0, 0.0, "usable: "),
        (9000.0, 0.0, "poor: "),
        (0.0, 0.3, "does not stay"),
    ] {
        let world = world(HELD);
        world.lock().unwrap().bend_codes = bend_codes;
        let mut device = device(&world, BYTES_PER_MS);
        let mut helper = Helper::new(&world);
        helper.creep_n = creep_n;
        helper.answer = "n";
        let weights = arguments(&[0.0, 0.5, 1.0, 1.5, 2.0]);
        let said = calibrate::run(&mut device, &weights, &mut helper).unwrap();
        assert!(helper.said.contains(expected), "{}", helper.said);
        // Declined: nothing has changed.
        assert_eq!(said, "nothing changed\n");
        assert_eq!(device.settings().unwrap(), Settings::default());
    }
}

#[test]
fn a_zero_that_has_crept_does_not_keep_the_calibration_from_the_board() {
    // GIVEN 50 mN that stay on the cell, 5 times its noise: contact, as far as the board can tell
    let world = world(HELD);
    let mut device = device(&world, BYTES_PER_MS);
    let mut helper = Helper::new(&world);
    helper.creep_n = 0.05;
    // WHEN the calibration is accepted
    let weights = arguments(&[0.0, 0.5, 1.0, 2.0]);
    let said = calibrate::run(&mut device, &weights, &mut helper).unwrap();
    // THEN it is in the board, with the zero as it is now
    assert!(said.contains("saved"), "{said}");
    let settings = device.settings().unwrap();
    let truth = world.lock().unwrap().clone();
    let crept = truth.zero_code + helper.creep_n / truth.n_per_code;
    assert!((f64::from(settings.get(Key::ForceZeroCode)) - crept).abs() < 2.0);
}

#[test]
fn two_weights_are_said_to_be_unchecked_and_no_weights_are_refused() {
    let world = world(HELD);
    let mut device = device(&world, BYTES_PER_MS);
    let mut helper = Helper::new(&world);
    calibrate::run(&mut device, &arguments(&[0.0, 1.0]), &mut helper).unwrap();
    assert!(helper.said.contains("unchecked"), "{}", helper.said);
    for (weights, expected) in [
        (&[][..], "nothing to calibrate"),
        (&[1.0][..], "too few"),
        (&[1.0, 1.0][..], "the same"),
        (&[0.0, -1.0][..], "weight that is none"),
    ] {
        let error = calibrate::run(&mut device, &arguments(weights), &mut helper).unwrap_err();
        assert!(error.to_string().contains(expected), "{error}");
    }
}

#[test]
fn a_recording_is_a_log_and_replays_to_the_boards_own_estimates() {
    let folder = Folder::new();
    let mut device = device(&world(Hand::Palpating), BYTES_PER_MS);
    let out = folder.path("run");
    let statistics = record::record(&mut device, &out, Some(4_000_000)).unwrap();
    assert_eq!((statistics.lost, statistics.garbled), (0, 0));
    let said = record::convert(&out).unwrap();
    assert!(said.contains("0 samples missing"), "{said}");
    let log = Log::read(&out.join("log.csv"), &ReadOptions::default()).unwrap();
    // 4 s, and before them the 52 questions for the settings, 10 ms each.
    assert!((4000..4630).contains(&log.len()), "{}", log.len());
    assert!(log.extra("force_code").is_some());
    // The settings that it was taken with are beside it.
    assert!(
        fs::read_to_string(out.join("settings.toml"))
            .unwrap()
            .contains("n_per_code")
    );
    // A second one does not overwrite the first.
    let error = record::record(&mut device, &out, Some(1000)).unwrap_err();
    assert!(error.to_string().contains("already"), "{error}");
}

#[test]
fn a_run_of_the_emulator_that_is_over_is_recorded_from_its_first_sample() {
    // GIVEN the directory of a run that answers nothing any more
    let folder = Folder::new();
    let run = folder.path("run");
    let mut board = device(&world(Hand::Palpating), BYTES_PER_MS);
    record::record(&mut board, &run, Some(1_000_000)).unwrap();
    let bytes = fs::read(run.join("recording.frames")).unwrap();
    fs::create_dir(folder.path("qemu")).unwrap();
    folder.write("qemu/telemetry.frames", &bytes);
    // WHEN it is recorded
    let mut device = Device::new(Files::open(&folder.path("qemu")).unwrap());
    let again = folder.path("again");
    record::record(&mut device, &again, None).unwrap();
    // THEN nothing was lost while settings were asked for
    assert_eq!(fs::read(again.join("recording.frames")).unwrap(), bytes);
    assert!(!again.join("settings.toml").exists());
}

#[test]
fn what_the_board_estimated_is_what_the_host_estimates_from_the_same_samples() {
    let mut device = device(&world(Hand::Palpating), BYTES_PER_MS);
    let params = Settings::default().config().validate::<f32>().unwrap();
    let mut state = State::new(&params);
    let (mut sample, mut compared) = (None, 0);
    while compared < 5000 {
        match device.next_frame().unwrap() {
            Some(Frame::Sample(next)) => sample = Some(next),
            Some(Frame::Estimate(estimate)) => {
                let own = step(&params, &mut state, sample.take().unwrap());
                assert_eq!(own.parameters, estimate.parameters);
                assert_eq!(own.force_n.to_bits(), estimate.force_n.to_bits());
                compared += 1;
            }
            _ => {}
        }
    }
}

#[test]
fn a_recording_that_was_cut_anywhere_still_makes_a_log() {
    let folder = Folder::new();
    let mut device = device(&world(Hand::Palpating), BYTES_PER_MS);
    let out = folder.path("run");
    record::record(&mut device, &out, Some(300_000)).unwrap();
    let whole = fs::read(out.join("recording.frames")).unwrap();
    // Cut at the end, as by a power cut, and at the start, as by plugging in late.
    for cut in [1, 7, 30, 100, 149, 1000, whole.len() / 2] {
        let pieces = [&whole[..whole.len() - cut], &whole[cut..]];
        for piece in pieces {
            fs::write(out.join("recording.frames"), piece).unwrap();
            let said = record::convert(&out).unwrap();
            // What was cut off in the middle of a frame is no garbled frame.
            assert!(said.contains("0 frames garbled"), "{said}");
            let log = Log::read(&out.join("log.csv"), &ReadOptions::default()).unwrap();
            assert!(log.len() + cut / 100 + 2 >= 300, "{cut}: {}", log.len());
        }
    }
    fs::write(out.join("recording.frames"), b"nothing of it").unwrap();
    assert!(record::convert(&out).is_err());
}

#[test]
fn a_board_that_was_reset_makes_a_log_for_each_of_its_lives() {
    let folder = Folder::new();
    let out = folder.path("run");
    fs::create_dir_all(&out).unwrap();
    let mut file = fs::File::create(out.join("recording.frames")).unwrap();
    for length_us in [200_000, 100_000] {
        let mut device = device(&world(Hand::Palpating), BYTES_PER_MS);
        let life = folder.path(&format!("life-{length_us}"));
        record::record(&mut device, &life, Some(length_us)).unwrap();
        file.write_all(&fs::read(life.join("recording.frames")).unwrap())
            .unwrap();
    }
    record::convert(&out).unwrap();
    let length = |name: &str| {
        let log = Log::read(&out.join(name), &ReadOptions::default()).unwrap();
        log.len()
    };
    assert!(length("log.csv") > length("log-2.csv"));
}

#[test]
fn a_backup_is_restored_to_the_bit_through_the_command_itself() {
    let folder = Folder::with(
        "board.toml",
        "[force]\nlowest_code = 5000\nhighest_code = 60000\n",
    );
    let done = folder.palpate("config --port simulated restore board.toml");
    let said = String::from_utf8(done.stdout).unwrap();
    assert!(said.contains("2 changed, saved"), "{said}");
    let done = folder.palpate("config --port simulated backup out.toml");
    assert!(done.status.success());
    assert!(
        folder
            .read("out.toml")
            .contains("n_per_code = 0.00076293945")
    );
    folder.write("bad.toml", "[force]\nlowest_code = 70000000\n");
    let done = folder.palpate("config --port simulated restore bad.toml");
    assert_eq!(done.status.code(), Some(2));
}

#[test]
fn the_verbs_refuse_a_port_that_is_not_there_with_status_2() {
    let folder = Folder::new();
    for line in [
        "config --port /no/such/port show",
        "monitor --port /no/such/port",
        "record --port /no/such/port --out x",
        "record --convert nothing",
        "config --port simulated get force.scale",
        "config --port simulated set estimator.half_width 1",
        "monitor --port simulated --every 0",
    ] {
        let output = folder.palpate(line);
        assert_eq!(output.status.code(), Some(2), "{line}");
        assert!(!output.stderr.is_empty());
    }
}

#[test]
fn the_monitor_says_what_is_touched_and_what_is_wrong() {
    let folder = Folder::new();
    let output = folder.palpate("monitor --port simulated --every 0.5 --looks 5");
    let text = String::from_utf8(output.stdout).unwrap();
    assert_eq!(text.lines().count(), 5, "{text}");
    for word in ["contact", "stiffness", "fault 12", "lost 0"] {
        assert!(text.contains(word), "no {word} in {text}");
    }
}

/// Over a real serial device of the system: a pseudo-terminal, with the board at its other end.
#[cfg(unix)]
mod terminal {
    use super::*;
    use palpate::cli::config::compensate::{self, CompensateArgs};
    use palpate::link::port::Serial;
    use serialport::{SerialPort, TTYPort};
    use std::path::Path;
    use std::sync::atomic::{AtomicBool, Ordering};

    /// Between two touches of the hand, which touches once a second.
    fn compensated(device: &mut Device<Serial>, model: &Path) {
        let args = CompensateArgs {
            model: Some(model.to_path_buf()),
            off: false,
        };
        let plan = compensate::plan(&args).unwrap();
        let said = (0..100).find_map(|_| compensate::run(device, plan.as_ref()).ok());
        let said = said.expect("free air within a second");
        assert!(said.contains("tool_inertia"), "{said}");
    }

    #[test]
    fn settings_telemetry_and_a_recording_go_over_a_pseudo_terminal() {
        let (master, slave) = TTYPort::pair().unwrap();
        let name = slave.name().unwrap();
        // It holds a lock on the port.
        drop(slave);
        let stop = Arc::new(AtomicBool::new(false));
        let board = SimulatedBoard::new(world(Hand::Palpating), BYTES_PER_MS);
        let board = terminal_end::serve(master, board, Arc::clone(&stop));
        let mut device = Device::new(Serial::open(&name).unwrap());
        assert_eq!(device.identity().unwrap().board.as_str(), "simulated");
        assert_eq!(device.settings().unwrap(), Settings::default());
        device.set(Key::TelemetryEvery, 2.0).unwrap();
        assert_eq!(device.get(Key::TelemetryEvery).unwrap(), 2.0);
        let model =
            "[environment]\nlaw = \"free\"\n[[effect]]\nid = \"tool_inertia\"\nmass = 0.25\n";
        let rig = Folder::with("rig.toml", model);
        compensated(&mut device, &rig.path("rig.toml"));
        let mass = Key::from_name("compensation.tool_inertia.mass").unwrap();
        assert_eq!(device.get(mass).unwrap(), 0.25);
        let folder = Folder::new();
        let out = folder.path("run");
        let statistics = record::record(&mut device, &out, Some(500_000)).unwrap();
        assert_eq!((statistics.lost, statistics.garbled), (0, 0));
        record::convert(&out).unwrap();
        let log = Log::read(&out.join("log.csv"), &ReadOptions::default()).unwrap();
        // Every second sample of half a second, and what came while the settings were asked for.
        assert!((240..2000).contains(&log.len()), "{}", log.len());
        stop.store(true, Ordering::Relaxed);
        drop(device);
        drop(board.join().unwrap());
    }
}
