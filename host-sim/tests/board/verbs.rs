//! The command itself against the simulated board.

use std::fs;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use crate::common::Folder;

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
    // A file that is there is kept, as a recording is.
    let again = folder.palpate("config --port simulated backup out.toml");
    assert_eq!(again.status.code(), Some(2));
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
fn ctrl_c_ends_a_recording_with_its_log() {
    let folder = Folder::new();
    let arguments = ["record", "--port", "simulated", "--out", "run"];
    let child = folder
        .command(&arguments)
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    // GIVEN a recording of a second, which has no length of its own
    while fs::metadata(folder.path("run/recording.frames")).map_or(0, |file| file.len()) < 100_000 {
        sleep(Duration::from_millis(20));
    }
    // WHEN it is interrupted
    let process = child.id().to_string();
    let done = Command::new("kill")
        .args(["-INT", &process])
        .status()
        .unwrap();
    assert!(done.success());
    // THEN it ends well, with the log written.
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0));
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(said.contains("log.csv"), "{said}");
    assert!(folder.read("run/log.csv").lines().count() > 500);
}

#[test]
fn the_monitor_replays_a_log_at_its_own_pace_in_lines_with_units() {
    let folder = Folder::new();
    folder.write(
        "model.toml",
        "[environment]\nlaw = \"hunt_crossley\"\nstiffness = 1350.0\n\
        damping = 36.0\nexponent = 1.35\n",
    );
    folder.succeeds("simulate --model model.toml --out sim");
    let text = folder.succeeds("monitor --log sim/log.csv --speed 50 --every 1");
    // 8.6 s, a look a second of the log.
    assert_eq!(text.lines().count(), 8, "{text}");
    for word in ["N/m", "N\u{a0}s/m", "contact", "converged"] {
        assert!(text.contains(word), "no {word} in {text}");
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
