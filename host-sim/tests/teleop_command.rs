//! `palpate teleop` as a person runs it: what it says and writes, and what it refuses before it computes.

mod common;

use common::{Folder, complained, said};
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
