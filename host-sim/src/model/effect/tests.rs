//! Effects of a model become the core's, or are refused with line, key, value and remedy.

use std::path::Path;

use estimator_core::physics::effect::{self, EffectId, SeriesCompliance};
use estimator_core::physics::rig::MOST_EFFECTS;

use super::super::Model;
use super::*;
use crate::kind::Kind;
use crate::toml_reader::TomlFile;

const AIR: &str = "[environment]\nlaw = \"free\"\n";

fn parse(effects: &str) -> Result<Model, Diagnostic> {
    let path = Path::new("m.toml");
    Model::from_toml(&TomlFile::parse(format!("{AIR}{effects}"), path)?, path)
}

#[test]
fn every_effect_of_the_catalogue_goes_from_the_core_to_a_file_and_back() {
    for id in EffectId::ALL {
        let core = effect::Effect::new(*id, &[0.5, 0.25, 0.125, 0.0625, 0.0]);
        // A machine that turns has every effect.
        let mut model = parse("").unwrap().of_kind(Kind::Rotary);
        model.effects.push(core.into());
        let path = Path::new("m.toml");
        let file = TomlFile::parse(model.to_toml(), path).unwrap();
        let rig = Model::from_toml(&file, path).unwrap().rig().unwrap();
        assert_eq!(rig.effects().collect::<Vec<_>>(), [&core], "{}", id.name());
    }
}

#[test]
fn what_is_not_given_is_usual_and_what_is_given_counts() {
    let rig = parse("[[effect]]\nid = \"coulomb_friction\"\nforce = 0.4\n")
        .unwrap()
        .rig()
        .unwrap();
    let row = rig.effects().next().unwrap().row();
    assert_eq!(row, [0.4, 0.0, 0.0, 0.0, 0.0]);
    let spring = parse("[[effect]]\nid = \"series_compliance\"\nstiffness = 12e3\n").unwrap();
    assert_eq!(
        spring.rig().unwrap().effects().next(),
        Some(&effect::Effect::SeriesCompliance(SeriesCompliance {
            hardening_n: 0.0,
            stiffness_n_per_m: 12e3
        }))
    );
}

#[test]
fn mistakes_in_an_effect_are_named_with_line_key_value_and_remedy() {
    for (effect, line, key, value, remedy) in [
        (
            "id = \"culomb_friction\"\nforce = 1",
            3,
            "id",
            Some("culomb_friction"),
            "coulomb_friction",
        ),
        (
            "id = \"tool_inertia\"\nmas = 1",
            5,
            "mas",
            Some("mas"),
            "write `mass`",
        ),
        ("id = \"tool_inertia\"", 3, "mass", None, "greater than 0"),
        (
            "id = \"tool_inertia\"\nmass = -0.1",
            5,
            "mass",
            Some("-0.1"),
            "greater than 0",
        ),
        (
            "id = \"permanent_set\"\nfraction = 1.5\nyield_depth = 0",
            5,
            "fraction",
            Some("1.5"),
            "between 0 and 1",
        ),
        (
            "id = \"tool_inertia\"\nmass = 1\nfixed = [\"force\"]",
            6,
            "fixed",
            Some("force"),
            "one of them",
        ),
    ] {
        let model = parse(&format!("[[effect]]\n{effect}\n"));
        let error = model.and_then(|model| model.rig().map(|_| ())).unwrap_err();
        assert_eq!(error.line, Some(line), "{error}");
        assert!(error.field.as_ref().unwrap().ends_with(key), "{error}");
        assert_eq!(error.value.as_deref(), value, "{error}");
        assert!(error.remedy.as_ref().unwrap().contains(remedy), "{error}");
        assert_eq!(error.path.as_deref(), Some(Path::new("m.toml")));
    }
}

#[test]
fn an_effect_made_by_a_program_is_checked_as_one_that_was_read() {
    let made = |name: &str, value: f64| Effect {
        id: "tool_inertia".into(),
        parameters: vec![(name.into(), value)],
        ..Effect::default()
    };
    assert!(made("mass", 0.2).core().is_ok());
    for (effect, what) in [
        (made("mass", -1.0), "outside its bounds"),
        (made("mass", f64::NAN), "outside its bounds"),
        (made("force", 1.0), "not a parameter"),
        (
            Effect {
                parameters: Vec::new(),
                ..made("", 0.0)
            },
            "`mass` is missing",
        ),
    ] {
        let error = effect.core().unwrap_err();
        assert!(error.what.contains(what), "{error}");
    }
}

#[test]
fn too_many_effects_and_ones_that_cannot_repeat_are_refused() {
    let offset = "[[effect]]\nid = \"force_offset\"\nforce = 0.1\n";
    assert!(parse(&offset.repeat(MOST_EFFECTS)).unwrap().rig().is_ok());
    let error = parse(&offset.repeat(MOST_EFFECTS + 1))
        .unwrap()
        .rig()
        .unwrap_err();
    assert!(error.what.contains("more than 8 effects"), "{error}");
    assert_eq!(error.line, Some(3 + 3 * MOST_EFFECTS));
    let lag = "[[effect]]\nid = \"force_lag\"\ntime_constant = 0.1\n";
    let error = parse(&lag.repeat(2)).unwrap().rig().unwrap_err();
    assert!(error.what.contains("a second time"), "{error}");
}
