use super::super::compensation::{COUNT, MOST_AT_ONCE};
use super::super::store::SLOT;
use super::*;
use crate::board::settings::Bounds;
extern crate std;
use std::string::ToString;
use std::vec::Vec;

fn key(name: &str) -> Key {
    Key::from_name(name).unwrap_or_else(|| panic!("no {name}"))
}

fn with(values: &[(&str, f32)]) -> Settings {
    let mut settings = Settings::default();
    for (name, value) in values {
        settings.put(key(&std::format!("compensation.{name}")), *value);
    }
    settings
}

#[test]
fn every_parameter_of_every_effect_of_the_rig_has_its_place_and_no_other() {
    let mut named = Vec::new();
    for id in EffectId::ALL.iter().copied() {
        for (place, info) in id.info().parameters.iter().enumerate() {
            let Some(parameter) = Parameter::of(id, place) else {
                assert!(!id.belongs_to_rig() || id.info().timed, "{id:?}");
                continue;
            };
            let key = Key::Compensation(parameter);
            let name = std::format!("compensation.{}.{}", id.name(), info.name);
            assert_eq!(key.info().name, name);
            assert_eq!(key.info().unit, info.unit.ascii());
            assert_eq!(key.info().default, 0.0);
            named.push(key);
        }
    }
    assert_eq!(named.len(), COUNT);
    assert_eq!(named.len(), Parameter::ALL.len());
}

#[test]
fn the_numbers_are_stable() {
    let ids = Parameter::ALL.map(Parameter::id);
    // A further effect adds numbers behind these, a further parameter one among them.
    assert_eq!(
        ids[..27],
        [
            64, 65, 66, 68, 69, 70, 71, 240, 72, 76, 80, 84, 92, 93, 96, 97, 98, 104, 105, 108,
            112, 116, 120, 121, 124, 125, 126
        ]
    );
    assert_eq!(key("compensation.coulomb_friction.force").id(), 64);
    assert_eq!(key("compensation.stribeck_friction.width").id(), 240);
    assert_eq!(key("compensation.load_friction.width").id(), 241);
    assert_eq!(key("compensation.series_compliance.stiffness").id(), 104);
    assert_eq!(key("compensation.encoder_periodic_error.phase").id(), 126);
}

#[test]
fn a_record_holds_all_settings_and_more_numbers_of_effects_than_it_holds_are_refused() {
    let places = EffectId::ALL.iter().filter(|id| id.is_for_boards());
    let all: usize = places.map(|id| id.info().parameters.len()).sum();
    let own = Key::ALL.len() - all;
    let count = |key: &&Key| matches!(key.info().bounds, Bounds::Whole(low, high) if low >= 0.0 && high < 65_536.0);
    let counts = Key::ALL.iter().filter(count).count();
    // Eight bytes of head, five for each value, one and three for each count, four of check sum.
    let bytes = 8 + 5 * (own + MOST_AT_ONCE - counts) + 1 + 3 * counts + 4;
    assert!(bytes <= SLOT, "{own}: {bytes}");
    // GIVEN six effects with 20 numbers other than 0, THEN they can be taken off, and one more cannot.
    let mut settings = Settings::default();
    for (id, row) in [
        (EffectId::StribeckFriction, [0.3, 0.6, 2e-3, 1e-4, 0.0]),
        (EffectId::BoucWen, [4e3, 3e3, 3e3, 1.0, 0.0]),
        (EffectId::Cogging, [0.1, 1e-3, 0.3, 0.0, 0.0]),
        (EffectId::EncoderPeriodicError, [1e-5, 1e-3, 0.2, 0.0, 0.0]),
        (EffectId::CoulombFriction, [0.4, 0.0, 1e-4, 0.0, 0.0]),
        (EffectId::SeriesCompliance, [1e4, 10.0, 0.0, 0.0, 0.0]),
        (EffectId::GravityTorque, [0.5, 0.2, 0.0, 0.0, 0.0]),
    ] {
        settings.put_effect(&Effect::new(id, &row));
    }
    assert_eq!(settings.check(), Ok(()));
    settings.put_effect(&Effect::new(
        EffectId::ViscousDrag,
        &[1.0, 0.0, 0.0, 0.0, 0.0],
    ));
    let error = settings.check().unwrap_err();
    assert!(error.to_string().contains("no more than 20"), "{error}");
}

#[test]
fn nothing_is_taken_off_by_default_and_an_effect_is_once_a_parameter_is_not_zero() {
    assert_eq!(Settings::default().setup().unwrap().compensation, None);
    let setup = with(&[("coulomb_friction.force", 0.4)]).setup().unwrap();
    let ids: Vec<_> = setup.compensation.unwrap().ids().collect();
    assert_eq!(ids, [EffectId::CoulombFriction]);
    // Half of the window's 11 samples and one: 6 ms.
    assert_eq!(setup.late_us, 6000);
    let setup = with(&[("series_compliance.stiffness", 12e3)])
        .setup()
        .unwrap();
    assert_eq!(setup.late_us, 0);
}

#[test]
fn an_effect_goes_in_as_the_catalogue_has_it_and_out_again() {
    let friction = Effect::new(EffectId::CoulombFriction, &[0.5, 0.0, 0.25, 0.0, 0.0]);
    let mut settings = Settings::default();
    assert!(settings.put_effect(&friction));
    let own = Effect::new(EffectId::CoulombFriction, &[0.5, 0.0, 0.25, 0.0, 0.0]);
    assert_eq!(settings.effect(EffectId::CoulombFriction), Ok(Some(own)));
    assert_eq!(settings.without_compensation(), Settings::default());
    for id in [EffectId::Adhesion, EffectId::ForceDrift] {
        let other = Effect::new(id, &[0.5, 0.5, 0.0, 0.0, 0.0]);
        let mut settings = Settings::default();
        assert!(!settings.put_effect(&other));
        assert_eq!(settings, Settings::default());
    }
}

#[test]
fn values_that_are_no_effect_are_refused_by_name() {
    for (values, expected) in [
        (
            &[("cogging.amplitude", 0.1)][..],
            "compensation.cogging.pitch = 0: must be more than zero",
        ),
        (
            &[("coulomb_friction.width", 1e-5)],
            "compensation.coulomb_friction.force = 0: must be more than zero",
        ),
        (
            &[("tool_inertia.mass", -1.0)],
            "compensation.tool_inertia.mass = -1: must be from 0 to 1000000000",
        ),
        (
            &[("time_delay.delay", 0.065)],
            "compensation.time_delay.delay = 0.065: must be at most 64 samples long, either way",
        ),
    ] {
        assert_eq!(with(values).check().unwrap_err().to_string(), expected);
    }
}

#[test]
fn eight_effects_at_once_can_be_taken_off_and_nine_cannot() {
    let nine = [
        ("coulomb_friction.force", 0.1),
        ("viscous_drag.coefficient", 1.0),
        ("asymmetric_drag.coefficient", -1.0),
        ("tool_inertia.mass", 0.2),
        ("force_offset.force", 0.2),
        ("cable_stiffness.stiffness", 20.0),
        ("series_compliance.stiffness", 1e4),
        ("force_lag.time_constant", 4e-3),
        ("time_delay.delay", -3e-3),
    ];
    assert_eq!(with(&nine[..8]).check(), Ok(()));
    let error = with(&nine).check().unwrap_err();
    assert_eq!(error.key, key("compensation.time_delay.delay"));
    assert!(error.to_string().contains("no more than 8"), "{error}");
}
