//! `gap` where something steps or is read wrong in the log of an indenter: a zero that is set several times, a sample that
//! slips, a force in another unit or with another sign. None of it is an effect of the catalogue.

use crate::common::{Folder, complained, csv, flowing, named, pressed, said, white};
use serde_json::Value;

/// What happens to an indenter.
#[derive(Clone, Copy, Default)]
struct Happens<'a> {
    /// Instants (s) from each of which on the force is off by so much (N).
    zero_steps: &'a [(f64, f64)],
    /// Instants (s) from each of which on the surface is farther by so much (m).
    slips: &'a [(f64, f64)],
    /// From this instant (s) on the material has other numbers: it is so many times as stiff and damps so many times as much.
    swapped: Option<(f64, f64, f64)>,
    /// Coulomb's friction of the drive (N).
    friction_n: f64,
    /// The sensor's time (s) by which the force is earlier than the position, as a damper in contact shows it.
    damper_s: f64,
    /// The force (N/mm) of a stiffer layer at half of the depth.
    layer_n_per_mm: f64,
    /// A count of the encoder (m), whose readings toggle; 0 for one that reads all.
    count_m: f64,
}

/// Nine presses 2 s apart, each to a depth and with a speed of its own, on 1.35 N/mm with an exponent of 1.35 that damps.
fn rows(happens: Happens<'_>) -> Vec<[f64; 3]> {
    const PERIOD_S: f64 = 1e-3;
    /// So far from those of the force the readings' own noise is drawn.
    const AWAY: u32 = 100_000;
    let way = |t: f64| {
        let number = (t / 2.0).floor();
        let deepest = 1.5e-3 + 1.5e-3 * (0.37 * number).fract();
        let way_s = 0.15 + 0.5 * (0.61 * number).fract();
        -1e-3 + (deepest + 1e-3) * pressed((t - 2.0 * number - 0.3).max(0.0), way_s, 0.3)
    };
    let since = |steps: &[(f64, f64)], t: f64| -> f64 {
        let before = steps.iter().filter(|own| own.0 <= t);
        before.map(|own| own.1).sum()
    };
    let row = |at: u32| {
        let t = f64::from(at) * PERIOD_S;
        let v = (way(t + 1e-5) - way(t - 1e-5)) / 2e-5;
        let depth = (way(t) - since(happens.slips, t)).max(0.0) / 1e-3;
        let swapped = happens.swapped.filter(|own| own.0 <= t);
        let (stiffer, more_damped) = swapped.map_or((1.0, 1.0), |own| (own.1, own.2));
        let layer = happens.layer_n_per_mm * (depth - 1.5).max(0.0);
        let stiff = 1.35 * stiffer * depth.powf(1.35) + layer;
        let damped = (0.02 * more_damped * depth.powf(1.35)
            + 1.8 * happens.damper_s * depth.powf(0.35))
            * 1e3
            * v;
        let friction = happens.friction_n * (v / 2e-4).tanh();
        let force = (stiff + damped).max(0.0) + friction + since(happens.zero_steps, t);
        let read = match happens.count_m > 0.0 {
            true => happens.count_m * (way(t) / happens.count_m + 0.3 * white(at + AWAY)).round(),
            false => way(t),
        };
        [t, read, force + 5e-3 * white(at)]
    };
    (0..18_000).map(row).collect()
}

const MODEL: &str =
    "[environment]\nlaw = \"hunt_crossley\"\nstiffness = 1200\ndamping = 15\nexponent = 1.4\n";

/// The answer and what is said.
fn asked(log: String) -> (Value, String) {
    let folder = Folder::with("base.toml", MODEL);
    folder.write("log.csv", log);
    let done = folder.palpate("gap --model base.toml --log log.csv --out out");
    assert_eq!(done.status.code(), Some(0), "{}", complained(&done));
    let json = serde_json::from_str(&folder.read("out/gap.json")).unwrap();
    (json, flowing(&said(&done)))
}

#[test]
fn a_layer_is_found_below_what_a_coarse_encoder_is_allowed() {
    let coarse = |layer_n_per_mm: f64| {
        asked(csv(rows(Happens {
            layer_n_per_mm,
            count_m: 20e-6,
            ..Happens::default()
        })))
    };
    let (json, said) = coarse(0.34);
    // GIVEN a base that leaves no more than noise and counts of 20 µm allow
    let before = json["floor_ratio"]["before"].as_f64().unwrap();
    assert!(before < 1.0, "{said}");
    // THEN the layer is named, and nothing where there is none.
    assert_eq!(named(&json), ["buried_layer"], "{said}");
    let (json, said) = coarse(0.0);
    assert_eq!(json["verdict"], "no_missing_effect", "{said}");
}

#[test]
fn a_zero_that_steps_three_times_is_taken_off_and_nothing_is_missing() {
    let (json, said) = asked(csv(rows(Happens {
        zero_steps: &[(4.1, 0.4), (8.1, -0.7), (14.1, 0.5)],
        ..Happens::default()
    })));
    assert_eq!(json["verdict"], "no_missing_effect", "{said}");
    for at in ["4.10", "8.10", "14.10"] {
        assert!(
            said.contains(&format!(" N at {at} s and stays off"))
                || said.contains(&format!(" mN at {at} s and stays off")),
            "{said}"
        );
    }
}

#[test]
fn a_friction_is_found_beside_a_zero_that_steps_twice() {
    let (json, said) = asked(csv(rows(Happens {
        zero_steps: &[(6.1, 0.4), (12.1, -0.7)],
        friction_n: 0.15,
        ..Happens::default()
    })));
    assert_eq!(named(&json), ["coulomb_friction"], "{said}");
    assert_eq!(said.matches("and stays off").count(), 2, "{said}");
}

#[test]
fn a_sample_that_slips_between_touches_is_said_and_nothing_is_missing() {
    let (json, said) = asked(csv(rows(Happens {
        slips: &[(6.1, 100e-6), (12.1, -60e-6)],
        ..Happens::default()
    })));
    assert_eq!(json["verdict"], "no_missing_effect", "{said}");
    assert_eq!(said.matches("the surface steps by").count(), 2, "{said}");
    assert!(
        said.contains("steps by 100.") || said.contains("steps by 99."),
        "{said}"
    );
}

#[test]
fn another_material_from_a_touch_on_is_no_slip() {
    let (json, said) = asked(csv(rows(Happens {
        swapped: Some((8.1, 0.8, 6.0)),
        ..Happens::default()
    })));
    assert!(!said.contains("the surface steps by"), "{said}");
    assert_ne!(json["verdict"], "no_missing_effect", "{said}");
}

#[test]
fn units_and_signs_are_asked_for_before_any_effect() {
    let rubs = || {
        rows(Happens {
            friction_n: 0.15,
            ..Happens::default()
        })
    };
    let changed = |x: f64, f: f64| {
        csv(rubs()
            .into_iter()
            .map(|[t, own_x, own_f]| [t, x * own_x, f * own_f]))
    };
    let cases = [
        (
            (1.0, -1.0),
            "the force seems to have the other sign",
            "--columns f=-f_n",
        ),
        (
            (-1.0, 1.0),
            "the position seems to have the other sign",
            "--columns x=-x_m",
        ),
        (
            (1.0, 1e3),
            "the force seems to be in millinewtons",
            "--columns f=f_n*1e-3",
        ),
        (
            (1.0, 101.97),
            "the force seems to be in grams of weight",
            "--columns f=f_n*9.80665e-3",
        ),
        (
            (1e3, 1.0),
            "the position seems to be in millimetres",
            "--columns x=x_m*1e-3",
        ),
    ];
    for ((x, f), why, remedy) in cases {
        let (json, said) = asked(changed(x, f));
        assert!(said.starts_with(why) && said.contains(remedy), "{said}");
        assert_eq!(named(&json).len(), 0, "{said}");
    }
    // AND as it is the friction is named.
    let (json, said) = asked(csv(rubs()));
    assert_eq!(named(&json), ["coulomb_friction"], "{said}");
}

#[test]
fn a_force_that_is_early_where_the_law_has_too_little_of_a_damper_is_open() {
    let (json, said) = asked(csv(rows(Happens {
        damper_s: 3e-3,
        ..Happens::default()
    })));
    let effects = json["effects"].as_array().unwrap();
    let delays = effects.iter().filter(|own| own["id"] == "time_delay");
    for delay in delays {
        assert_eq!(delay["grade"], "open", "{said}");
    }
    assert!(json["verdict"] != "no_missing_effect", "{said}");
}
