//! Machines that turn: radians and newton metres in every text, JSON field and axis, and what they have not.

use crate::common::{Folder, complained, said};
use serde_json::Value;

/// A lever in a bearing: what the base knows, and what the rig has.
const BASE: &str = "kind = \"rotary\"\n[environment]\nlaw = \"free\"\n\
    [[effect]]\nid = \"tool_inertia\"\nmass = 0.006\n\
    [[effect]]\nid = \"viscous_drag\"\ncoefficient = 0.03\n";
const GRAVITY: &str = "[[effect]]\nid = \"gravity_torque\"\namplitude = 0.48\nphase = 0.1\n\
    [sensors]\nforce_noise = 0.002\nforce_step = 0.001\nposition_step = 1e-3\nrate = 500.0\n";
/// Two turns each way, slow and fast.
const MOTION: &str = "start = 0.0\n\
    [[segment]]\nkind = \"hold\"\nseconds = 0.5\n\
    [[segment]]\nkind = \"ramp\"\nto = 3.0\nspeed = 1.5\n\
    [[segment]]\nkind = \"hold\"\nseconds = 0.5\n\
    [[segment]]\nkind = \"ramp\"\nto = -3.0\nspeed = 3.0\n\
    [[segment]]\nkind = \"ramp\"\nto = 2.0\nspeed = 1.0\n\
    [[segment]]\nkind = \"hold\"\nseconds = 0.5\n\
    [[segment]]\nkind = \"ramp\"\nto = 0.0\nspeed = 4.0\n";

fn recorded() -> Folder {
    let folder = Folder::with("base.toml", BASE);
    folder.write("rig.toml", format!("{BASE}{GRAVITY}"));
    folder.write("motion.toml", MOTION);
    folder.succeeds("simulate --model rig.toml --motion motion.toml --seed 3 --out run");
    folder
}

#[test]
fn a_levers_weight_is_found_and_everything_is_said_in_radians_and_newton_metres() {
    // GIVEN a log of a lever that turns, whose base knows nothing of its weight
    let folder = recorded();
    assert!(folder.read("run/log.csv").starts_with("t_s,x_rad,f_nm\n"));
    let done = folder.palpate("gap --model base.toml --log run/log.csv --out gap");
    assert_eq!(done.status.code(), Some(0), "{}", complained(&done));
    // THEN the weight alone is missing, with its true numbers,
    let json: Value = serde_json::from_str(&folder.read("gap/gap.json")).unwrap();
    assert_eq!(json["verdict"], "missing_effects");
    assert_eq!(json["kind"], "rotary");
    let effects = json["effects"].as_array().unwrap();
    assert_eq!(effects.len(), 1, "{effects:?}");
    assert_eq!(effects[0]["id"], "gravity_torque");
    for (name, truth, unit) in [("amplitude", 0.48, "N m"), ("phase", 0.1, "rad")] {
        let own = &effects[0]["params"][name];
        let (value, error) = (
            own["value"].as_f64().unwrap(),
            own["std_error"].as_f64().unwrap(),
        );
        assert!(
            (value - truth).abs() < 5.0 * error && error < 0.05,
            "{name}: {own}"
        );
        assert_eq!(own["unit"], unit);
    }
    let base = &json["base"]["after"];
    assert_eq!(base["tool_inertia.mass"]["unit"], "kg m²");
    assert_eq!(base["viscous_drag.coefficient"]["unit"], "N m s/rad");
    // AND neither text nor report speaks of metres, newtons or kilograms of a machine along a line.
    let (text, report) = (said(&done), folder.read("gap/report.html"));
    assert!(text.contains("rad") && text.contains("N\u{a0}m"), "{text}");
    for linear in ["\u{a0}mm", "\u{a0}µm", "N\u{a0}s/m", "m/s", "\u{a0}kg<"] {
        assert!(!text.contains(linear), "{linear:?}: {text}");
        assert!(!report.contains(linear), "{linear:?} in the report");
    }
    // The model that is written is of a machine that turns.
    assert!(
        folder
            .read("gap/model.toml")
            .starts_with("kind = \"rotary\"\n")
    );
}

#[test]
fn what_a_machine_that_turns_has_not_is_refused_with_a_reason() {
    let folder = recorded();
    folder.write(
        "linear.toml",
        "kind = \"linear\"\n[environment]\nlaw = \"free\"\n",
    );
    folder.write(
        "weight.toml",
        "[environment]\nlaw = \"free\"\n[[effect]]\nid = \"gravity_torque\"\namplitude = 0.5\nphase = 0.0\n",
    );
    for (call, why) in [
        (
            "gap --model linear.toml --log run/log.csv",
            "kind = \"rotary\"",
        ),
        (
            "gap --model weight.toml --log run/log.csv --columns x=x_rad*1,f=f_nm*1",
            "does not turn",
        ),
        (
            "estimate --method batch --indenter sphere:0.003 run/log.csv",
            "Young's modulus",
        ),
        ("teleop --model rig.toml", "along a line"),
    ] {
        let done = folder.palpate(call);
        assert_eq!(done.status.code(), Some(2), "{call}");
        assert!(
            complained(&done).contains(why),
            "{call}: {}",
            complained(&done)
        );
    }
}

#[test]
fn check_suspects_degrees_and_not_a_swing_of_a_radian() {
    let folder = recorded();
    let text = said(&folder.palpate("check run/log.csv --out checked"));
    assert!(
        text.contains("rad") && !text.contains("millimetres"),
        "{text}"
    );
    let json: Value = serde_json::from_str(&folder.read("checked/check.json")).unwrap();
    assert_eq!(json["kind"], "rotary");
    // The same file with its angles in degrees under the name of radians.
    let text = said(&folder.palpate("check run/log.csv --columns x=x_rad*57.2958"));
    assert!(text.contains("degrees given as radians?"), "{text}");
}

#[test]
fn monitor_and_effects_speak_of_radians_where_a_machine_turns() {
    let folder = recorded();
    // A log says by its columns that its machine turns.
    let said_of = |call: &str| {
        let done = folder.palpate(call);
        assert_eq!(done.status.code(), Some(0), "{call}: {}", complained(&done));
        said(&done)
    };
    let watched = said_of("monitor --log run/log.csv --speed 1000 --looks 5");
    assert!(
        watched.contains("N\u{a0}m") && watched.contains("rad"),
        "{watched}"
    );
    // A board has no name for its units: the flag says the kind, for monitor and for record.
    let board = said_of("monitor --port simulated --kind rotary --looks 3");
    assert!(board.contains("N\u{a0}m"), "{board}");
    said_of("record --port simulated --kind rotary --seconds 0.2 --out board");
    let header = folder.read("board/log.csv");
    assert!(header.starts_with("t_s,x_rad,f_nm"), "{header}");
    let linear = said_of("effects coulomb_friction");
    assert!(linear.contains("force (N, more than zero)"), "{linear}");
    // The motions that a plan advises are as long as angles are.
    let planned = said_of("gap --plan --model rig.toml --out plan");
    assert!(planned.contains("rad"), "{planned}");
    let of_plan = planned + &folder.read("plan/plan.json");
    for length in [" mm", " µm", "\u{a0}mm", "\u{a0}µm"] {
        assert!(!of_plan.contains(length), "{of_plan}");
    }
    let rotary = said_of("effects --kind rotary");
    assert!(rotary.contains("force (N m, more than zero)"), "{rotary}");
    // An effect that a machine along a line cannot have is shown on one that turns.
    let weight = said_of("effects gravity_torque");
    for word in ["amplitude (N m", "torsion spring", "N m/rad", "N m s/rad"] {
        assert!(
            weight.replace('\u{a0}', " ").contains(word),
            "no {word}: {weight}"
        );
    }
    assert!(!weight.contains("1350"), "{weight}");
    let json: Value = serde_json::from_str(&said_of("effects gravity_torque --json")).unwrap();
    assert_eq!(json["effects"][0]["kinds"], serde_json::json!(["rotary"]));
    assert_eq!(json["effects"][0]["parameters"][0]["unit"], "N m");
}
