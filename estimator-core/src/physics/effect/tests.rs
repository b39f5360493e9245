use super::*;

#[test]
fn ids_and_keys_are_unique_and_lead_back_to_their_effect() {
    for (at, id) in EffectId::ALL.iter().enumerate() {
        assert_eq!(EffectId::from_name(id.name()), Some(*id));
        assert_eq!(*id as usize, at + 1, "{}", id.name());
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
    let row = [0.25, 1.5, 2.5, 3.5];
    for id in EffectId::ALL {
        let effect = Effect::new(*id, &row);
        let count = id.info().parameters.len();
        assert_eq!(effect.id(), *id);
        assert_eq!(effect.row()[..count], row[..count]);
        assert!(effect.row()[count..].iter().all(|rest| *rest == 0.0));
    }
}
