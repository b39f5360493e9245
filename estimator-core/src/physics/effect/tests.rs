use super::*;

#[test]
fn ids_and_keys_are_unique_and_lead_back_to_their_effect() {
    assert!(EffectId::ALL.is_sorted_by_key(|id| *id as u8));
    for id in EffectId::ALL {
        assert_eq!(EffectId::from_name(id.name()), Some(*id));
        let info = id.info();
        assert!(info.parameters.len() <= MOST_PARAMETERS);
        for (at, parameter) in info.parameters.iter().enumerate() {
            let same = |other: &&ParameterInfo| other.name == parameter.name;
            assert_eq!(info.parameters.iter().position(|p| same(&p)), Some(at));
        }
    }
}

#[test]
fn a_row_of_values_goes_in_and_comes_out() {
    let row = [0.25, 1.5, 2.5, 3.5, 4.5];
    for id in EffectId::ALL {
        let effect = Effect::new(*id, &row);
        let count = id.info().parameters.len();
        assert_eq!(effect.id(), *id);
        assert_eq!(effect.row()[..count], row[..count]);
        assert!(effect.row()[count..].iter().all(|rest| *rest == 0.0));
    }
}

#[test]
fn optional_forms_are_0_by_default_and_an_extension_names_a_relative() {
    for id in EffectId::ALL {
        let info = id.info();
        assert_eq!(info.fits.len(), info.parameters.len());
        for (fit, parameter) in info.fits.iter().zip(info.parameters) {
            let is_optional = matches!(fit.role, Role::Form(..) | Role::Switch(_));
            assert_eq!(
                parameter.default,
                is_optional.then_some(0.0),
                "{}",
                parameter.name
            );
        }
        if let Some(name) = info.simpler {
            let simpler = EffectId::from_name(name).expect("an effect of the catalogue");
            assert_eq!(simpler.info().family, info.family);
            assert!(info.family.is_nested());
        }
    }
}

#[test]
fn an_example_is_within_its_bounds_and_a_start_has_no_more_values_than_parameters() {
    for id in EffectId::ALL {
        let info = id.info();
        for (value, parameter) in info.example.iter().zip(info.parameters) {
            assert!(
                parameter.bounds.allow(*value),
                "{} {}",
                id.name(),
                parameter.name
            );
        }
        let fits = |starts: &Starts| starts.values.len() <= info.parameters.len();
        assert!(info.starts.iter().all(fits), "{}", id.name());
        // A wave starts from a spectrum.
        assert_eq!(
            info.starts.is_empty(),
            info.repeats.has_spectrum(),
            "{}",
            id.name()
        );
    }
}

#[test]
fn what_a_board_compensates_belongs_to_the_rig_and_counts_no_time() {
    for id in EffectId::ALL.iter().copied() {
        let info = id.info();
        assert_eq!(id.belongs_to_rig(), info.stage.belongs_to_rig());
        assert_eq!(id.is_for_boards(), id.belongs_to_rig() && !info.timed);
        assert_eq!(id.needs_derivative(), info.needs_derivative);
    }
}

#[test]
fn an_unloading_curve_keeps_some_of_the_force_and_every_example_means_what_it_says() {
    for info in EffectId::ALL.iter().map(|id| id.info()) {
        assert!((info.is_physical)(&info.example), "{}", info.name);
    }
    for id in [EffectId::LoadingCurve, EffectId::CyclicSoftening] {
        let with = |share: f64| (id.info().is_physical)(&[share, 1e-3, 0.0, 0.0, 0.0]);
        // At 0.8 the way in takes nine times the force of the way out, at 0.95 39 times.
        assert_eq!((with(0.8), with(0.95)), (true, false));
    }
}
