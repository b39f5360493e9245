//! Recordings, and the logs that they become.

use crate::common::Folder;
use crate::{device, world};
use estimator_core::board::link::BYTES_PER_MS;
use estimator_core::board::settings::COUNT;
use palpate::kind::Kind;
use palpate::link::port::Files;
use palpate::link::world::Hand;
use palpate::link::{Device, record};
use palpate::log::{Log, ReadOptions};
use std::fs;
use std::io::Write;

#[test]
fn a_recording_is_a_log_and_replays_to_the_boards_own_estimates() {
    let folder = Folder::new();
    let mut device = device(&world(Hand::Palpating), BYTES_PER_MS);
    let out = folder.path("run");
    let statistics = record::record(&mut device, &out, Some(4_000_000)).unwrap();
    assert_eq!((statistics.lost, statistics.garbled), (0, 0));
    let said = record::convert(&out, Kind::Linear).unwrap();
    assert!(said.contains("0 samples missing"), "{said}");
    let log = Log::read(&out.join("log.csv"), &ReadOptions::default()).unwrap();
    // 4 s, and before them a question for each setting and for what board it is, 10 ms each.
    let asked = 10 * (COUNT + 2);
    assert!((4000..4000 + asked).contains(&log.len()), "{}", log.len());
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
            let said = record::convert(&out, Kind::Linear).unwrap();
            // What was cut off in the middle of a frame is no garbled frame.
            assert!(said.contains("0 frames garbled"), "{said}");
            let log = Log::read(&out.join("log.csv"), &ReadOptions::default()).unwrap();
            assert!(log.len() + cut / 100 + 2 >= 300, "{cut}: {}", log.len());
        }
    }
    fs::write(out.join("recording.frames"), b"nothing of it").unwrap();
    assert!(record::convert(&out, Kind::Linear).is_err());
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
    record::convert(&out, Kind::Linear).unwrap();
    let length = |name: &str| {
        let log = Log::read(&out.join(name), &ReadOptions::default()).unwrap();
        log.len()
    };
    assert!(length("log.csv") > length("log-2.csv"));
}
