//! `gap` on machines that nobody at Palpate had in mind: a stage, an ankle's spring, a cylinder, three records of which one
//! differs. Their forces are written down here, with friction, springs and noise of their own.

use crate::common::{Folder, complained, csv, flowing, grown, said, tables};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use std::f64::consts::TAU;

/// Two cross-slides: mass (kg), drag (N s/m), friction (N) over its width (m), how much more of it there is at standstill
/// and below which speed (m/s), how much more per newton of the spring, spring (N/m) with its cubic part (N/m³), and an
/// offset (N) from an instant (s) on.
#[derive(Clone, Copy)]
struct Machine {
    mass: f64,
    drag: f64,
    friction: (f64, f64),
    at_standstill: (f64, f64),
    by_load: f64,
    spring: (f64, f64),
    offset: (f64, f64),
    /// How far the friction is wound up when the log begins, −1 to 1.
    wound: f64,
    noise: f64,
    /// A hand that pushes: with so much (N) at most, from an instant (s) to another.
    hand: (f64, f64, f64),
}

const STAGE: Machine = Machine {
    mass: 3.0,
    drag: 20.0,
    friction: (2.0, 20e-6),
    at_standstill: (0.0, 5e-3),
    by_load: 0.0,
    spring: (400.0, 0.0),
    offset: (0.0, 0.0),
    wound: 0.0,
    noise: 0.05,
    hand: (0.0, 0.0, 0.0),
};

impl Machine {
    /// 20 s at 500 Hz: a second of rest, then two sines that share no period.
    fn rows(&self, seed: u64) -> Vec<[f64; 3]> {
        const RATE_HZ: f64 = 500.0;
        const FINER: usize = 20;
        let mut random = Pcg64::seed_from_u64(seed);
        let way = |t: f64| {
            let t = (t - 1.0).max(0.0);
            let grown = grown(t);
            grown * (0.02 * (TAU * 0.31 * t).sin() + 0.006 * (TAU * 1.13 * t).sin())
        };
        let (mut bent, mut last) = (self.wound * self.friction.1, 0.0);
        let (excess, slow_mps) = self.at_standstill;
        let mut row = |at: usize| {
            for step in 1..=FINER {
                let t = (at as f64 - 1.0 + step as f64 / FINER as f64) / RATE_HZ;
                let x = way(t);
                let moved: f64 = x - last;
                last = x;
                // Bristles: dz/dx = 1 − z sgn(v)/(w g(v)), where g is what slides over what sticks.
                let speed = moved * RATE_HZ * FINER as f64;
                let slides = 1.0 + excess * (-(speed / slow_mps).powi(2)).exp();
                let most = self.friction.1 * slides / (1.0 + excess);
                bent += moved * (1.0 - bent * moved.signum() / most);
                bent = bent.clamp(-self.friction.1, self.friction.1);
            }
            let t = at as f64 / RATE_HZ;
            let h = 1e-4;
            let (x, before, after) = (way(t), way(t - h), way(t + h));
            let (v, a) = (
                (after - before) / (2.0 * h),
                (after - 2.0 * x + before) / (h * h),
            );
            let noise: f64 = StandardNormal.sample(&mut random);
            let offset = if t >= self.offset.1 {
                self.offset.0
            } else {
                0.0
            };
            let spring = self.spring.0 * x + self.spring.1 * x.powi(3);
            let friction = (self.friction.0 * (1.0 + excess) + self.by_load * spring.abs()) * bent
                / self.friction.1;
            let (most, from, until) = self.hand;
            let hand = match (from..until).contains(&t) {
                true => most * (TAU / 2.0 * (t - from) / (until - from)).sin(),
                false => 0.0,
            };
            let force = self.mass * a + self.drag * v + friction + spring + offset + hand;
            [t, (x / 1e-6).round() * 1e-6, force + self.noise * noise]
        };
        (0..10_000).map(&mut row).collect()
    }
}

/// A model of the free machine with these effects.
fn model(effects: &[(&str, &str)]) -> String {
    let effects = tables(effects);
    format!("[environment]\nlaw = \"free\"\n{effects}")
}

/// What is known of the stage, all of it off.
const KNOWN: [(&str, &str); 4] = [
    ("tool_inertia", "mass = 2.5"),
    ("viscous_drag", "coefficient = 15"),
    ("coulomb_friction", "force = 1"),
    ("cable_stiffness", "stiffness = 300"),
];

/// The same as a model that was identified.
fn identified() -> String {
    model(&[
        ("tool_inertia", "mass = 3\nstd_error = { mass = 0.02 }"),
        (
            "viscous_drag",
            "coefficient = 20\nstd_error = { coefficient = 0.2 }",
        ),
        (
            "coulomb_friction",
            "force = 2\nwidth = 20e-6\nstd_error = { force = 0.01, width = 3e-7 }",
        ),
        (
            "cable_stiffness",
            "stiffness = 400\nstd_error = { stiffness = 2 }",
        ),
    ])
}

/// The answer to logs of machines, and what was said.
fn asked(model: &str, machines: &[Machine]) -> (serde_json::Value, String) {
    asked_about(model, machines, |_| true)
}

/// The same about the rows at some instants (s).
fn asked_about(
    model: &str,
    machines: &[Machine],
    is_there: impl Fn(f64) -> bool,
) -> (serde_json::Value, String) {
    let folder = Folder::with("base.toml", model);
    let mut command = "gap --model base.toml --out out".to_string();
    for (at, machine) in machines.iter().enumerate() {
        let name = format!("log{}.csv", at + 1);
        let mut rows = machine.rows(at as u64 + 1);
        rows.retain(|row| is_there(row[0]));
        folder.write(&name, csv(rows));
        command += &format!(" --log {name}");
    }
    let done = folder.palpate(&command);
    assert_eq!(done.status.code(), Some(0), "{}", complained(&done));
    let json = serde_json::from_str(&folder.read("out/gap.json")).unwrap();
    (json, flowing(&said(&done)))
}

/// The one effect that is named, which is this one and not left open.
fn alone<'a>(json: &'a serde_json::Value, id: &str, said: &str) -> &'a serde_json::Value {
    let effects = json["effects"].as_array().unwrap();
    assert_eq!(effects.len(), 1, "{said}");
    assert_eq!(effects[0]["id"], id, "{said}");
    assert_ne!(effects[0]["grade"], "open", "{said}");
    &effects[0]
}

/// A number of the base, after the fit.
fn base_number(json: &serde_json::Value, name: &str) -> f64 {
    let value = json["base"]["after"][name]["value"].as_f64();
    value.unwrap_or_else(|| panic!("no {name}"))
}

#[test]
fn a_friction_of_the_model_bends_before_it_slides_though_the_file_does_not_say_so() {
    let (json, said) = asked(&model(&KNOWN), &[STAGE]);
    // It was Bouc and Wen's loop, certain, beside a friction of 9 mN.
    assert_eq!(json["verdict"], "no_missing_effect", "{said}");
    let width = base_number(&json, "coulomb_friction.width");
    assert!((width / 20e-6 - 1.0).abs() < 0.05, "{width}");
    assert!(
        said.contains("coulomb_friction takes a width that the model does not give"),
        "{said}"
    );
    // AND one that the owner keeps out stays out.
    let mut kept = KNOWN;
    kept[2].1 = "force = 1\nwidth = 0\nfixed = [\"width\"]";
    let (json, said) = asked(&model(&kept), &[STAGE]);
    assert_ne!(json["verdict"], "no_missing_effect", "{said}");
    assert!(!said.contains("takes a width"), "{said}");
}

#[test]
fn a_spring_that_hardens_is_no_backlash_and_no_cogging() {
    let ankle = Machine {
        spring: (400.0, 400.0 / 0.04_f64.powi(2)),
        friction: (0.0, 1.0),
        ..STAGE
    };
    for known in [&KNOWN[..2], &[KNOWN[0], KNOWN[1], KNOWN[3]]] {
        let (json, said) = asked(&model(known), &[ankle]);
        let length = match known.len() {
            3 => base_number(&json, "cable_stiffness.hardening_length"),
            _ => {
                let own = &json["effects"][0]["params"]["hardening_length"]["value"];
                own.as_f64().unwrap_or(0.0)
            }
        };
        assert!((length / 0.04 - 1.0).abs() < 0.01, "{length} {said}");
        let others = json["effects"].as_array().unwrap().iter();
        let others = others.filter(|own| own["id"] != "cable_stiffness");
        assert_eq!(others.count(), 0, "{said}");
    }
}

#[test]
fn an_offset_that_begins_with_the_motion_is_no_drift() {
    // A friction that stands may be wound up to anything, so that nothing is known of the second before.
    let cylinder = Machine {
        offset: (1.0, 1.0),
        ..STAGE
    };
    let mut known = KNOWN;
    known[2].1 = "force = 1\nwidth = 1e-5";
    let (json, said) = asked(&model(&known), &[cylinder]);
    assert!(!said.contains("force_drift ("), "{said}");
    let offset = alone(&json, "force_offset", &said)["params"]["force"]["value"].as_f64();
    assert!((offset.unwrap() - 1.0).abs() < 0.02, "{said}");
}

#[test]
fn a_spring_that_is_missing_is_found_beside_a_zero_that_steps() {
    let knocked = Machine {
        offset: (-0.6, 9.4),
        ..STAGE
    };
    let (json, said) = asked(&model(&KNOWN[..3]), &[knocked]);
    assert!(
        said.contains("the force steps by \u{2212}0.6")
            && said.contains(" N at 9.40 s and stays off"),
        "{said}"
    );
    let spring = alone(&json, "cable_stiffness", &said)["params"]["stiffness"]["value"].as_f64();
    assert!((spring.unwrap() / 400.0 - 1.0).abs() < 0.02, "{said}");
}

/// That 0.3 s at 8 s were left out, and hardly more.
fn says_what_was_left_out(json: &serde_json::Value, said: &str) {
    let left_out = json["left_out"].as_array().unwrap();
    assert_eq!(left_out.len(), 1, "{said}");
    let end = |name: &str| left_out[0][name].as_f64().unwrap();
    // Its ends, 2 % of the force, are within what the friction and the spring made up for.
    let (from, until) = (end("from_s"), end("until_s"));
    assert!((7.8..8.06).contains(&from), "{from} s\n{said}");
    assert!((8.24..8.5).contains(&until), "{until} s\n{said}");
    assert!(
        said.contains("s on the force does what it does nowhere else in the log"),
        "{said}"
    );
}

#[test]
fn a_hand_on_the_stage_hides_no_spring_and_makes_none() {
    let pushed = Machine {
        hand: (12.0, 8.0, 8.3),
        ..STAGE
    };
    // GIVEN a model without the spring: nothing was named beside the hand, and the closest set had five effects
    let (json, said) = asked(&model(&KNOWN[..3]), &[pushed]);
    assert_eq!(json["verdict"], "partly_explained", "{said}");
    let spring = alone(&json, "cable_stiffness", &said)["params"]["stiffness"]["value"].as_f64();
    assert!((spring.unwrap() / 400.0 - 1.0).abs() < 0.02, "{said}");
    says_what_was_left_out(&json, &said);
    // AND one with all there is: nothing is missing outside, and no number has changed.
    let (json, said) = asked(&identified(), &[pushed]);
    assert_eq!(json["verdict"], "unexplained", "{said}");
    assert!(
        said.contains("unexplained: nothing is missing outside 2"),
        "{said}"
    );
    assert_eq!(json["changed"].as_array().unwrap().len(), 0, "{said}");
    says_what_was_left_out(&json, &said);
}

#[test]
fn an_effect_that_has_gone_is_said_though_its_number_is_at_its_bound() {
    let bare = Machine {
        friction: (0.0, 20e-6),
        ..STAGE
    };
    let (json, said) = asked(&identified(), &[bare]);
    assert_eq!(json["verdict"], "no_missing_effect", "{said}");
    let changed = json["changed"].as_array().unwrap();
    assert_eq!(changed.len(), 1, "{said}");
    assert_eq!(changed[0]["name"], "coulomb_friction.force", "{said}");
    assert_eq!(changed[0]["gone"], true, "{said}");
    assert!(said.contains("coulomb_friction is gone"), "{said}");
}

#[test]
fn what_was_before_the_log_and_what_is_missing_from_it_are_no_effects() {
    let nothing_new = |(json, said): (serde_json::Value, String)| {
        assert_eq!(json["verdict"], "no_missing_effect", "{said}");
        assert_eq!(json["changed"].as_array().unwrap().len(), 0, "{said}");
    };
    // GIVEN a stage that stands as a motion before the log left it: its friction pulls with all it has
    let wound = Machine {
        wound: -1.0,
        ..STAGE
    };
    nothing_new(asked(&identified(), &[wound]));
    // AND a log of which 0.3 s are missing in the middle of a stroke.
    let is_there = |t: f64| !(6.2..6.5).contains(&t);
    nothing_new(asked_about(&identified(), &[STAGE], is_there));
}

#[test]
fn the_record_that_differs_from_the_others_is_named() {
    let late = Machine {
        offset: (0.5, 0.0),
        ..STAGE
    };
    let (_, said) = asked(&model(&KNOWN), &[STAGE, late, STAGE]);
    assert!(
        said.contains("unexplained: the logs are not of one rig as it was"),
        "{said}"
    );
    assert!(
        said.contains("not `log2.csv`: ask what is missing there alone"),
        "{said}"
    );
    // AND where each is explained by itself, what is another.
    let softer = Machine {
        spring: (300.0, 0.0),
        ..STAGE
    };
    let (_, said) = asked(&model(&KNOWN), &[STAGE, softer]);
    assert!(
        said.contains("something has changed between them: cable_stiffness.stiffness is"),
        "{said}"
    );
}

#[test]
fn a_friction_that_sticks_with_more_than_it_slides_with_is_stribecks_beside_the_models_own() {
    // GIVEN a stage that takes 3.2 N to move and 2 N to keep moving, and a model with a friction of 1 N
    let machine = Machine {
        at_standstill: (0.6, 5e-3),
        ..STAGE
    };
    let (json, said) = asked(&model(&KNOWN), &[machine]);
    // THEN what there is more at standstill is named alone, and what slides stays the model's.
    let found = alone(&json, "stribeck_friction", &said);
    let of = |name: &str| found["params"][name]["value"].as_f64().unwrap();
    assert_eq!(of("kinetic_force"), 0.0);
    // Two springs of bristles in parallel are not quite one.
    let (more_n, slow_mps) = (of("static_force"), of("speed"));
    assert!((more_n / 1.2 - 1.0).abs() < 0.15, "{more_n} N\n{said}");
    assert!(
        (slow_mps / 5e-3 - 1.0).abs() < 0.15,
        "{slow_mps} m/s\n{said}"
    );
    let slides_n = base_number(&json, "coulomb_friction.force");
    assert!((slides_n / 2.0 - 1.0).abs() < 0.05, "{slides_n} N\n{said}");
    // AND all of it where the model has no friction.
    let (json, said) = asked(&model(&[KNOWN[0], KNOWN[1], KNOWN[3]]), &[machine]);
    let found = alone(&json, "stribeck_friction", &said);
    let of = |name: &str| found["params"][name]["value"].as_f64().unwrap();
    for (name, truth) in [
        ("kinetic_force", 2.0),
        ("static_force", 3.2),
        ("speed", 5e-3),
    ] {
        let value = of(name);
        assert!((value / truth - 1.0).abs() < 0.15, "{name} {value}\n{said}");
    }
}

#[test]
fn a_friction_that_grows_with_the_load_may_stick_before_it_slides() {
    // GIVEN a stage whose guide rubs with a tenth of the spring's force more, and a model that knows the rest
    let machine = Machine {
        by_load: 0.1,
        ..STAGE
    };
    let (json, said) = asked(&model(&KNOWN), &[machine]);
    // THEN it is named alone, with its size: sliding only it was unexplained.
    let found = alone(&json, "load_friction", &said);
    let share = found["params"]["coefficient"]["value"].as_f64().unwrap();
    assert!((share / 0.1 - 1.0).abs() < 0.1, "{share}\n{said}");
}
