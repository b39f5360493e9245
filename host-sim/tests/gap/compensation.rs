//! From a hidden effect to a board without bias: the board is recorded, `palpate gap` finds the effect, the
//! finding goes to the board, and the board estimates without bias on the same motion.

use std::path::Path;
use std::sync::{Arc, Mutex};

use crate::common::{Folder, complained, said};
use estimator_core::board::frame::Frame;
use estimator_core::board::link::BYTES_PER_MS;
use estimator_core::board::link::Command;
use estimator_core::board::sampling::Sampler;
use estimator_core::board::settings::Key;
use estimator_core::estimate::Phase;
use estimator_core::{Estimate, Fault, Status};
use palpate::cli::config::compensate::{self, CompensateArgs};
use palpate::link::port::Simulated;
use palpate::link::record::record;
use palpate::link::world::{Hand, World};
use palpate::link::{Device, SimulatedBoard};
use palpate::model::Model;
use palpate::motion::Motion;
use palpate::plant::{GEL, Rig, Stage};

type Shared = Arc<Mutex<World>>;

/// K (N/m), λ (N s/m), n of the gel, in the order of the law's parameters.
const TRUTH: [f64; 3] = [1350.0, 36.0, 1.35];
const BASE: &str =
    "[environment]\nlaw = \"hunt_crossley\"\nstiffness = 1200\ndamping = 30\nexponent = 1.3\n";

/// A calibrated board at a rig that hides `effects` and palpates gel.
struct Bench {
    world: Shared,
    device: Device<Simulated>,
    folder: Folder,
    length_ms: u64,
}

impl Bench {
    fn new(effects: &str) -> Bench {
        let folder = Folder::new();
        folder.write("base.toml", BASE);
        folder.write("truth.toml", format!("{BASE}{effects}"));
        let rig = Rig {
            effects: Model::read(&folder.path("truth.toml"))
                .unwrap()
                .rig()
                .unwrap()
                .effects,
            ..Rig::default()
        };
        let motion = Motion::palpation(GEL.peak_depth_m);
        let run = rig
            .run(&Stage::throughout(GEL.at(0.0)), &motion, 11)
            .unwrap();
        let recorded: Vec<_> = run
            .log
            .position_m
            .iter()
            .copied()
            .zip(run.log.force_n)
            .collect();
        let nominal = |key: Key| f64::from(key.info().default);
        let mut world = World::default();
        world.n_per_code = nominal(Key::ForcePerCode);
        world.zero_code = nominal(Key::ForceZeroCode);
        // The noise of the cell is in the recording.
        world.noise_codes = 0.0;
        let length_ms = recorded.len() as u64;
        world.recorded = recorded;
        world.hand = Hand::Repeating { from: u64::MAX };
        let world = Arc::new(Mutex::new(world));
        let board = SimulatedBoard::new(Arc::clone(&world), BYTES_PER_MS);
        let mut device = Device::new(Simulated::at_once(board));
        for key in [Key::ForceCalibrated, Key::PositionCalibrated] {
            device.set(key, 1.0).unwrap();
        }
        Bench {
            world,
            device,
            folder,
            length_ms,
        }
    }

    /// Starts the palpation again: the estimator settles in its first 0.6 s, in free air.
    fn begin(&mut self) {
        let (now, _) = self.device.port().board().counts();
        let from = u64::from(now) + 1;
        self.world.lock().unwrap().hand = Hand::Repeating { from };
        self.device.order(Command::Restart).unwrap();
    }

    /// Palpates, and gives the last estimate of the board in contact.
    fn palpated(&mut self) -> Estimate<f32> {
        self.begin();
        let (start, _) = self.device.port().board().counts();
        let mut last = None;
        while u64::from(self.device.port().board().counts().0 - start) < self.length_ms {
            match self.device.next_frame().unwrap() {
                Some(Frame::Estimate(estimate)) if estimate.phase == Phase::Contact => {
                    last = Some(estimate);
                }
                _ => {}
            }
        }
        last.expect("contact")
    }

    /// The largest error of K, λ and n in per cent, and the largest in standard errors. A parameter that the
    /// board withholds, because a bias makes it too uncertain, counts as wrong by all of it.
    fn errors(&mut self) -> (f64, f64) {
        let estimate = self.palpated();
        let pairs = TRUTH.iter().zip(estimate.parameters);
        let errors = pairs.map(|(truth, slot)| {
            let Some(found) = slot else {
                return (100.0, 0.0);
            };
            let off = (f64::from(found.value) - truth).abs();
            (100.0 * off / truth, off / f64::from(found.std_error))
        });
        errors.fold((0.0, 0.0), |worst, one| {
            (f64::max(worst.0, one.0), f64::max(worst.1, one.1))
        })
    }

    /// Runs `palpate record` and `palpate gap`, and gives the named effects.
    fn gap(&mut self) -> String {
        self.begin();
        let out = self.folder.path("run");
        let us = (self.length_ms - 1000) * 1000;
        record(&mut self.device, &out, Some(us)).unwrap();
        palpate::link::record::convert(&out, palpate::kind::Kind::Linear).unwrap();
        let done = self
            .folder
            .palpate("gap --model base.toml --log run/log.csv --out gap");
        assert_eq!(done.status.code(), Some(0), "{}", complained(&done));
        said(&done)
    }

    fn compensate(&mut self, model: Option<&Path>) -> String {
        let args = CompensateArgs {
            model: model.map(Path::to_path_buf),
            off: model.is_none(),
        };
        let plan = compensate::plan(&args).unwrap();
        compensate::run(&mut self.device, plan.as_ref()).unwrap()
    }
}

#[test]
fn what_gap_finds_in_a_recording_of_the_board_takes_the_bias_off_the_board() {
    for (id, parameters) in [
        ("coulomb_friction", "force = 0.4\ntransition_speed = 5e-4"),
        ("series_compliance", "stiffness = 12000"),
        ("force_lag", "time_constant = 4e-3"),
    ] {
        // GIVEN a board whose rig hides an effect
        let mut bench = Bench::new(&format!("[[effect]]\nid = \"{id}\"\n{parameters}\n"));
        let (before, _) = bench.errors();
        // WHEN its recording goes through gap, and what was found back to the board
        let found = bench.gap();
        assert!(found.contains(id), "{found}");
        let model = bench.folder.path("gap/model.toml");
        let said = bench.compensate(Some(&model));
        assert!(said.contains(id) && said.contains("saved"), "{said}");
        // THEN the board's estimates are unbiased, and its standard errors say so
        let (after, sigmas) = bench.errors();
        println!("{id}: {before:.2} % before, {after:.2} % after, {sigmas:.1} standard errors");
        assert!(before > 5.0, "{id} hidden: {before} %");
        assert!(after < 0.5, "{id} compensated: {after} %");
        assert!(sigmas < 4.0, "{id} compensated: {sigmas} standard errors");
        assert_ne!(bench.palpated().status, Status::ModelSuspect);
        // AND without the compensation it is as before
        let said = bench.compensate(None);
        assert!(said.contains("nothing is compensated any more"), "{said}");
        let (again, _) = bench.errors();
        assert!((again - before).abs() < 1.0, "{id}: {again} % again");
    }
}

#[test]
fn samples_go_out_as_they_were_read_and_replay_to_the_boards_estimates() {
    let mut bench = Bench::new("[[effect]]\nid = \"force_lag\"\ntime_constant = 4e-3\n");
    let model = bench.folder.path("truth.toml");
    bench.compensate(Some(&model));
    let settings = bench.device.settings().unwrap();
    let setup = settings.setup().unwrap();
    let (mut host, late_us) = (Sampler::new(setup), setup.late_us);
    // GIVEN a board that has settled, WHEN it restarts, THEN a host that starts with it is in step
    let settled = |device: &mut Device<Simulated>| match device.next_frame().unwrap() {
        Some(Frame::Estimate(estimate)) => estimate.phase == Phase::Free,
        _ => false,
    };
    while !settled(&mut bench.device) {}
    bench.begin();
    let (mut sample, mut compared, mut started) = (None, 0, false);
    let mut contacts = 0;
    while compared < 8000 {
        match bench.device.next_frame().unwrap() {
            Some(Frame::Sample(next)) => sample = Some(next),
            Some(Frame::Estimate(estimate)) => {
                let read = sample.take().unwrap();
                assert!(!read.faults.has(Fault::NotCalibrated));
                started |= estimate.phase == Phase::Settling;
                if !started {
                    continue;
                }
                // What a filter of 8 samples, and the compensation, are late.
                assert_eq!(read.time_us - estimate.time_us, 8000 + late_us);
                let contact = host.compensate(read);
                let host = host.step(contact);
                assert_eq!(host.parameters, estimate.parameters, "{}", read.time_us);
                assert_eq!(host.force_n.to_bits(), estimate.force_n.to_bits());
                assert_eq!(host.time_us, estimate.time_us);
                contacts += usize::from(estimate.phase == Phase::Contact);
                compared += 1;
            }
            _ => {}
        }
    }
    assert!(contacts > 3000, "{contacts}");
}

fn complaint(model: &str) -> String {
    let folder = Folder::with("m.toml", model);
    let done = folder.palpate("config --port simulated compensate m.toml");
    assert_eq!(done.status.code(), Some(2), "{}", said(&done));
    complained(&done)
}

#[test]
fn what_a_board_cannot_take_off_is_refused_before_anything_is_sent() {
    let effect = |id: &str, rest: &str| format!("[[effect]]\nid = \"{id}\"\n{rest}\n");
    for (effects, words) in [
        (
            effect("time_delay", "delay = 0.2"),
            &["effect.time_delay.delay", "64 samples"][..],
        ),
        (
            effect("coulomb_fricton", "force = 1"),
            &["coulomb_friction"],
        ),
        (
            effect("viscous_drag", "coefficient = 8") + &effect("viscous_drag", "coefficient = 1"),
            &["viscous_drag a second time", "one place"],
        ),
        (effect("tool_inertia", "mass = 2e9"), &["tool_inertia.mass"]),
    ] {
        let said = complaint(&format!("{BASE}{effects}"));
        assert!(words.iter().all(|word| said.contains(word)), "{said}");
    }
    let folder = Folder::new();
    for line in [
        "config --port simulated compensate",
        "config --port simulated compensate nothing.toml",
        "config --port simulated compensate m.toml --off",
    ] {
        assert_eq!(folder.palpate(line).status.code(), Some(2), "{line}");
    }
}

#[test]
fn effects_of_the_material_and_of_time_stay_and_are_named_as_such() {
    let folder = Folder::new();
    let effect = |id: &str, rest: &str| format!("[[effect]]\nid = \"{id}\"\n{rest}\n");
    let stay = effect("adhesion", "force = 0.1\nneck_length = 1e-4")
        + &effect("force_drift", "rate = 0.01");
    folder.write("stay.toml", format!("{BASE}{stay}"));
    let cogging = effect("cogging", "amplitude = 0.2\npitch = 2e-3\nphase = 0.3");
    folder.write("both.toml", format!("{BASE}{stay}{cogging}"));
    // GIVEN a model of which nothing can be taken off THEN that is said, and is no failure
    let done = folder.palpate("config --port simulated compensate stay.toml");
    let text = said(&done);
    assert_eq!(done.status.code(), Some(0), "{}", complained(&done));
    for words in [
        "belongs to the material: `adhesion`",
        "start of the log",
        "`force_drift`",
        "nothing sent",
    ] {
        assert!(text.contains(words), "no `{words}` in {text}");
    }
    // AND of a model that has both, the rest is taken off
    let done = folder.palpate("config --port simulated compensate both.toml");
    let text = said(&done);
    for words in [
        "cogging",
        "3 settings changed, saved",
        "encoder's zero",
        "`adhesion`",
    ] {
        assert!(text.contains(words), "no `{words}` in {text}");
    }
    let done = folder.palpate("config --port simulated compensate --off");
    assert!(said(&done).contains("nothing was compensated"));
}

#[test]
fn a_board_in_contact_refuses_and_keeps_what_it_has() {
    let mut bench = Bench::new("");
    let model = "[environment]\nlaw = \"free\"\n[[effect]]\nid = \"tool_inertia\"\nmass = 0.2\n";
    bench.folder.write("rig.toml", model);
    let path = bench.folder.path("rig.toml");
    bench.begin();
    loop {
        if let Some(Frame::Estimate(estimate)) = bench.device.next_frame().unwrap()
            && estimate.phase == Phase::Contact
        {
            break;
        }
    }
    let args = CompensateArgs {
        model: Some(path),
        off: false,
    };
    let plan = compensate::plan(&args).unwrap();
    // 52 questions of 10 ms, and a touch that lasts 0.6 s: asked twice, one of them is in contact.
    let mut refused = false;
    for _ in 0..4 {
        let before = bench.device.settings().unwrap();
        match compensate::run(&mut bench.device, plan.as_ref()) {
            // Sent, and to be sent anew.
            Ok(_) => bench.device.order(Command::Defaults).map(drop).unwrap(),
            Err(error) => {
                assert!(error.to_string().contains("in contact"), "{error}");
                assert_eq!(bench.device.settings().unwrap(), before);
                refused = true;
            }
        }
    }
    assert!(refused);
}
