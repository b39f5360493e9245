use ratatui::Terminal;
use ratatui::backend::TestBackend;

use super::*;
use crate::motion::Motion;
use crate::plant::{GEL, Rig, Stage};
use crate::replay::samples;
use estimator_core::board::frame::Frame as Sent;
use estimator_core::{Config, State, step};

/// Eight seconds of palpating gel, as a board would send it, with its health.
fn palpated() -> Scene {
    let motion = Motion::palpation(GEL.peak_depth_m);
    let run = Rig::default()
        .run(&Stage::throughout(GEL.at(0.0)), &motion, 1)
        .unwrap();
    let log = run.log.uniform().unwrap();
    let params = Config::default().validate::<f32>().unwrap();
    let mut state = State::new(&params);
    let mut scene = Scene::new("simulated");
    for sample in samples(&log).take(6200) {
        scene.take(&Sent::Sample(sample), 200_000);
        scene.take(&Sent::Estimate(step(&params, &mut state, sample)), 200_000);
    }
    let health = Health {
        stack_free: 36_000,
        ..Health::default()
    };
    scene.take(&Sent::Health(health), 200_000);
    scene
}

fn drawn(scene: &Scene, width: u16, height: u16) -> String {
    let mut terminal = Terminal::new(TestBackend::new(width, height)).unwrap();
    let statistics = Statistics {
        frames: 6200,
        ..Statistics::default()
    };
    terminal
        .draw(|frame| draw(frame, scene, &statistics))
        .unwrap();
    let buffer = terminal.backend().buffer();
    let rows = buffer.content.chunks(width.into());
    let text = rows.map(|row| {
        let row: String = row.iter().map(|cell| cell.symbol()).collect();
        format!("{}\n", row.trim_end())
    });
    text.collect()
}

/// The picture as it stands in a file; `PALPATE_ACCEPT=1` puts the present one there.
#[test]
fn the_picture_at_three_sizes_is_the_one_that_was_looked_at() {
    let mut scene = palpated();
    scene.mark();
    for (width, height) in [(80, 24), (120, 40), (44, 14)] {
        let picture = drawn(&scene, width, height);
        let name = format!("src/cli/monitor/screen/{width}x{height}.txt");
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(name);
        if std::env::var_os("PALPATE_ACCEPT").is_some() {
            std::fs::write(&path, &picture).unwrap();
        }
        let accepted = std::fs::read_to_string(&path).unwrap_or_default();
        assert!(picture == accepted, "{}:\n{picture}", path.display());
    }
}

#[test]
fn what_matters_is_there_at_every_size_and_no_size_is_too_small() {
    let scene = palpated();
    for (width, height) in [(80, 24), (120, 40), (44, 14), (38, 8)] {
        let picture = drawn(&scene, width, height);
        for word in ["contact", "N/m"] {
            assert!(
                picture.contains(word),
                "{width}×{height}: no {word}\n{picture}"
            );
        }
        assert!(
            picture.contains("stiffness") || picture.contains("K 13"),
            "{picture}"
        );
    }
    for (width, height) in [(1, 1), (3, 2), (10, 3), (200, 5), (5, 60)] {
        drawn(&scene, width, height);
    }
    drawn(&Scene::new("nothing"), 80, 24);
}

#[test]
fn a_fault_stands_by_name_with_its_setting_and_a_recording_with_its_folder() {
    let mut scene = palpated();
    scene.faults = scene.faults.with(estimator_core::Fault::ForceSaturated);
    scene.recording = Some((0.0, "out/recording-1".into()));
    scene.is_paused = true;
    let picture = drawn(&scene, 110, 30);
    for word in [
        "fault",
        "force.highest_code",
        "into out/recording-1",
        "paused",
        "end recording",
    ] {
        assert!(picture.contains(word), "no {word} in\n{picture}");
    }
}

#[test]
fn the_screen_says_how_old_the_estimate_is() {
    let params = Config::default().validate::<f32>().unwrap();
    let mut state = State::new(&params);
    let sample = estimator_core::Sample {
        time_us: 1_000_000,
        ..Default::default()
    };
    // 8 samples of filter, and 6 ms of a compensation.
    let mut estimate = step(&params, &mut state, sample);
    estimate.time_us -= 6000;
    let mut scene = Scene::new("simulated");
    scene.take(&Sent::Sample(sample), 1);
    scene.take(&Sent::Estimate(estimate), 1);
    let picture = drawn(&scene, 80, 24);
    assert!(picture.contains("estimates 14 ms old"), "{picture}");
}
