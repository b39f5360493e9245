//! `palpate teleop` as a person runs it: what it says and writes, and what it refuses before it computes.

use crate::common::{Folder, complained, said};
use palpate::teleop::environment::{Environment, Material};
use palpate::teleop::{Grid, Options, SchemeId, compare, json};
use serde_json::Value;
use std::path::Path;

fn assert_described(written: &Value) {
    let schema = Path::new(env!("CARGO_MANIFEST_DIR")).join("schemas/teleop.schema.json");
    let schema: Value = serde_json::from_str(&std::fs::read_to_string(schema).unwrap()).unwrap();
    let validator = jsonschema::validator_for(&schema).unwrap();
    let wrong: Vec<String> = validator
        .iter_errors(written)
        .map(|error| format!("{}: {error}", error.instance_path()))
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("; "));
}

#[test]
fn a_run_says_what_was_felt_and_how_long_it_took_and_its_json_is_as_described() {
    let folder = Folder::new();
    let text = folder.succeeds("teleop --scheme reflection_both --delay-ms 20");
    for word in ["transparent", "felt", "hand", "time", "a run of"] {
        assert!(text.contains(word), "{word}: {text}");
    }
    let written = folder.succeeds("teleop --scheme reflection_both --delay-ms 20 --json");
    let written: Value = serde_json::from_str(&written).unwrap();
    assert_eq!(written["scheme"], "reflection_both");
    assert!(written["operator"]["identified"]["mass"]["value"].is_number());
    assert_described(&written);
}

#[test]
fn a_comparison_is_a_list_of_cells_as_described() {
    let grid = Grid {
        environments: vec![Environment::throughout(Material::gel())],
        schemes: vec![SchemeId::PositionForce, SchemeId::Reflection],
        round_trips_s: vec![0.1],
        jitters: vec![0.0],
        losses: vec![0.0],
        ..Grid::table(Options::default(), 1)
    };
    let cells = compare(&grid, &|_, _| {});
    assert_eq!(cells.len(), 2);
    assert_described(&Value::Array(cells.iter().map(json::cell).collect()));
}

#[test]
fn a_folder_that_cannot_be_written_into_is_refused_before_anything_is_computed() {
    let folder = Folder::with("file", "not a folder");
    let done = folder.palpate("teleop --compare --seeds 1000 --out file/below");
    assert_eq!(done.status.code(), Some(1), "{}", said(&done));
    assert!(
        complained(&done).contains("cannot write"),
        "{}",
        complained(&done)
    );
}

#[test]
fn a_bridge_says_what_has_gone_over_it_and_writes_it_where_it_is_asked_to() {
    let folder = Folder::new();
    let bridge = "teleop --slave simulated --master simulated --seconds 2 --loss 0.3 --out bridge";
    let text = folder.succeeds(bridge);
    assert!(
        text.contains("ended after 2.0") && text.contains("lost"),
        "{text}"
    );
    let written: Value = serde_json::from_str(&folder.read("bridge/teleop.json")).unwrap();
    assert_described(&written);
    assert_eq!(written["bridge"], "one_host");
    let (sent, lost) = (&written["packets"]["sent"], &written["packets"]["lost"]);
    assert!(
        sent.as_u64() > Some(50) && lost.as_u64() > Some(5),
        "{written}"
    );
}

#[test]
fn ends_that_do_not_fit_together_and_flags_of_the_simulation_are_refused() {
    let folder = Folder::with("a.key", "8f".repeat(32));
    for arguments in [
        "--listen 127.0.0.1:0 --key a.key",
        "--key a.key",
        "--seconds 3",
        "--slave simulated",
        "--slave simulated --master simulated --scheme passivity",
        "--slave simulated --master simulated --seeds 3",
    ] {
        let done = folder.palpate(&format!("teleop {arguments}"));
        assert_eq!(done.status.code(), Some(2), "{arguments}: {}", said(&done));
        let words = ["--master", "cannot be used with"];
        assert!(
            words.iter().any(|word| complained(&done).contains(word)),
            "{arguments}: {}",
            complained(&done)
        );
    }
}

const SOFT: &str =
    "[environment]\nlaw = \"hunt_crossley\"\nstiffness = 900.0\ndamping = 20.0\nexponent = 1.3\n";
const STIFF: &str =
    "[environment]\nlaw = \"hunt_crossley\"\nstiffness = 4000.0\ndamping = 40.0\nexponent = 1.2\n";

#[test]
fn a_second_model_takes_the_place_of_the_first_in_the_air_or_while_it_is_touched() {
    let folder = Folder::with("soft.toml", SOFT);
    folder.write("stiff.toml", STIFF);
    folder.write("during.toml", "[task]\nchanges = 5.4\n");
    let models = "teleop --model soft.toml --model stiff.toml --delay-ms 20 --json";
    for operator in ["", " --operator during.toml"] {
        let written = folder.succeeds(&format!("{models}{operator}"));
        let written: Value = serde_json::from_str(&written).unwrap();
        assert_described(&written);
        assert_eq!(written["environment"], "soft");
        let share = |key: &str| written[key].as_f64().unwrap_or(f64::INFINITY);
        assert!(
            share("felt_force_rmse_share") < 0.05,
            "{operator}: {written}"
        );
        assert!(
            share("felt_force_rmse_share_after") < 0.05,
            "{operator}: {written}"
        );
        assert!(share("resettled_s") < 1.0, "{operator}: {written}");
        assert!(share("created_energy_j") < 1e-4, "{operator}: {written}");
    }
}

#[test]
fn an_impedance_is_shaped_as_the_operators_file_says() {
    let folder = Folder::with("soft.toml", SOFT);
    // K' = 0.5·K·(K/3600)^(0.5 − 1): as stiff as it is.
    folder.write(
        "shape.toml",
        "[shape]\ngain = 0.5\npower = 0.5\nreference = 3600.0\n",
    );
    let run = "teleop --scheme reflection_shaped --model soft.toml --operator shape.toml --json";
    let written: Value = serde_json::from_str(&folder.succeeds(run)).unwrap();
    assert!(
        (written["shaping"].as_f64().unwrap() - 1.0).abs() < 1e-9,
        "{written}"
    );
    assert!(
        written["felt_force_rmse_share"].as_f64().unwrap() < 0.05,
        "{written}"
    );
}

/// Runs with `--json`.
fn written(folder: &Folder, arguments: &str) -> Value {
    let text = folder.succeeds(&format!("teleop {arguments} --json"));
    let written: Value = serde_json::from_str(&text).unwrap();
    assert_described(&written);
    written
}

#[test]
fn a_hand_that_is_kept_outside_feels_a_force_and_the_run_does_not_say_that_there_was_none() {
    let folder = Folder::with(
        "short.toml",
        "[task]\npalpates = [1.25, 1.25]\npresses = 0.5\n",
    );
    for arguments in [
        "--scheme four_channel --delay-ms 500",
        "--operator short.toml",
    ] {
        let text = folder.succeeds(&format!("teleop {arguments}"));
        assert!(text.contains("not comparable"), "{arguments}: {text}");
        assert!(!text.contains("no force"), "{arguments}: {text}");
        let written = written(&folder, arguments);
        assert!(written["felt_force_rmse_share"].is_null(), "{written}");
        assert_eq!(written["felt_force_not_compared"], "not_inside");
    }
}

const DASHPOT: &str =
    "[environment]\nlaw = \"kelvin_voigt\"\nstiffness = 1000.0\ndamping = 2000.0\nsurface = 0.0\n";

#[test]
fn what_is_only_short_or_slow_is_not_called_unstable() {
    let folder = Folder::with("short.toml", "[task]\npresses = 1.0\n");
    folder.write("slow.toml", DASHPOT);
    for arguments in ["--operator short.toml", "--model slow.toml"] {
        let text = folder.succeeds(&format!("teleop {arguments}"));
        assert!(text.contains("cannot be told"), "{arguments}: {text}");
        assert!(!text.contains("unstable"), "{arguments}: {text}");
        assert!(written(&folder, arguments)["stable"].is_null());
    }
}

const MOTION: &str = "start = -0.006\n[[segment]]\nkind = \"hold\"\nseconds = 0.6\n[[segment]]\nkind = \"sine\"\n\
                      mean = 0.004\namplitude = 0.010\nfrequency = 0.8\nseconds = 6.25\n[[segment]]\nkind = \"ramp\"\n\
                      to = 0.0098\nspeed = 0.06\n[[segment]]\nkind = \"hold\"\nseconds = 3.4\n";

#[test]
fn a_second_material_that_would_never_be_there_is_refused_and_one_alone_never_changes() {
    let folder = Folder::with("soft.toml", SOFT);
    folder.write("motion.toml", MOTION);
    folder.write("own.toml", "motion = \"motion.toml\"\n");
    folder.write("late.toml", "[task]\nchanges = 500.0\n");
    folder.write("during.toml", "[task]\nchanges = 5.4\n");
    let two = "--model soft.toml --model soft.toml";
    for arguments in [
        format!("{two} --operator own.toml"),
        format!("{two} --operator late.toml"),
        "--model soft.toml --operator during.toml".into(),
    ] {
        let done = folder.palpate(&format!("teleop {arguments}"));
        assert_eq!(done.status.code(), Some(2), "{arguments}: {}", said(&done));
        assert!(
            complained(&done).contains("remedy"),
            "{}",
            complained(&done)
        );
    }
    for arguments in ["--model soft.toml", "--operator own.toml"] {
        let text = folder.succeeds(&format!("teleop {arguments}"));
        assert!(!text.contains("after the change"), "{text}");
        assert!(written(&folder, arguments)["changed_s"].is_null());
    }
}

#[test]
fn flags_that_a_table_would_leave_out_are_refused_and_a_jitter_of_no_delay_is_said() {
    let folder = Folder::new();
    for arguments in [
        "--compare --delay-ms 50",
        "--compare --jitter 0.3",
        "--compare --loss 0.1",
        "--compare --scheme passivity",
        "--compare --seed 9",
        "--seeds 3",
        "--slave simulated --master simulated --seconds nan",
        "--slave simulated --master simulated --seconds=-1",
        "--slave simulated --master simulated --seconds 0",
        "--slave simulated --master simulated --seconds inf",
    ] {
        let done = folder.palpate(&format!("teleop {arguments}"));
        assert_eq!(done.status.code(), Some(2), "{arguments}: {}", said(&done));
    }
    let text = folder.succeeds("teleop --jitter 0.3");
    assert!(text.contains("a jitter does nothing"), "{text}");
}

#[test]
fn the_json_has_both_ways_the_grip_that_was_used_the_seed_and_what_a_rate_lost() {
    let folder = Folder::with(
        "soft.toml",
        SOFT.to_owned() + "[sensors]\nforce_noise = 1.0\n",
    );
    folder.write("stiff.toml", STIFF);
    folder.write(
        "channel.toml",
        "[there]\ndelay = 0.02\nrate = 100\n[back]\ndelay = 0.05\njitter = 0.5\nloss = 0.1\n",
    );
    folder.write(
        "hand.toml",
        "[[grip]]\nstiffness = 800\n[[grip]]\nfrom = 500\nstiffness = 50\n",
    );
    let arguments =
        "--model soft.toml --model stiff.toml --operator hand.toml --channel channel.toml --seed 9";
    let run = written(&folder, arguments);
    assert_eq!(
        (&run["back"]["delay_s"], &run["back"]["loss"]),
        (&0.05.into(), &0.1.into())
    );
    assert_eq!(run["back"]["jitter"], 0.5);
    assert_eq!(run["there"]["bytes_per_s"], 100.0);
    assert_eq!(run["operator"]["stiffness"], 800.0);
    assert_eq!(run["second_environment"], "stiff");
    assert_eq!(run["seed"], 9);
    assert!(run["changed_s"].as_f64() > Some(9.0), "{run}");
    assert!(
        run["packets"]["lost_to_rate"].as_u64() > Some(1000),
        "{run}"
    );
    assert!(
        run["notes"][0].as_str().unwrap().contains("[sensors]"),
        "{run}"
    );
    assert!(
        run["effective_age_s"]["there"].as_f64() > Some(0.02),
        "{run}"
    );
}
