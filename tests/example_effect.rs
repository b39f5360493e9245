//! The worked example of how an effect is added, see `estimator_core::physics::effect`: an invented
//! effect in three files is hidden, found, written, compensated and set on a board.

use estimator_core::board::settings::Settings;
use estimator_core::physics::effect::EffectId;
use palpate::compensate::compensate;
use palpate::gap::{Options, Verdict, gap};
use palpate::log::{Log, ReadOptions};
use palpate::model::Model;
use std::path::Path;
use tests::hidden::rig::case::Case;
use tests::hidden::rig::draw::CATALOGUE;
use tests::hidden::rig::kind::Kind;
use tests::tolerance::{EXPLAINED, FAR};

const ID: EffectId = EffectId::TipMagnet;

#[test]
fn an_effect_of_three_files_is_hidden_found_written_compensated_and_set() {
    // GIVEN a short rig that hides it and a base that knows nothing of it
    let place = CATALOGUE.iter().position(|id| *id == ID.name()).unwrap();
    let case = Case::brief(Kind::Single, 1, place as u64);
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("example-effect");
    case.save(&folder).unwrap();
    let base = Model::read(&folder.join("base.toml")).unwrap();
    let log = Log::read(&folder.join("measured.csv"), &ReadOptions::default()).unwrap();
    let log = log.uniform().unwrap();
    // WHEN the workflow looks for what is missing
    let found = gap(&base, std::slice::from_ref(&log), &Options::default()).unwrap();
    // THEN the effect is named alone, nothing else does as well, and it explains the log
    assert_eq!(found.verdict, Verdict::MissingEffects, "{case}");
    assert_eq!(found.effects.len(), 1, "{:?}", found.effects);
    let named = &found.effects[0];
    assert_eq!((named.id, named.alternatives.as_slice()), (ID, &[][..]));
    let left = found.rmse_after_n / case.floor_n;
    assert!(EXPLAINED.contains(&left), "{left}");
    // with its true numbers.
    for (name, truth) in &case.hidden[0].params {
        let own = named
            .parameters
            .iter()
            .find(|own| own.name == *name)
            .unwrap();
        let std_error = own.std_error.unwrap();
        assert!(std_error < 0.1 * truth, "{name}: ± {std_error}");
        let error = (own.value - truth) / std_error;
        assert!(error.abs() < FAR, "{name}: {error} standard errors");
    }
    // AND model.toml says so, reads back the same, and its compensation takes the pull off.
    let path = folder.join("model.toml");
    std::fs::write(&path, found.model.to_toml()).unwrap();
    let model = Model::read(&path).unwrap();
    let effect = model.effects[0].core().unwrap();
    assert_eq!(Ok(effect), found.model.effects[0].core());
    assert_eq!(effect.id(), ID);
    let contact = compensate(&log, &model).unwrap();
    let [force_n, reach_m, ..] = effect.row();
    let each = log
        .position_m
        .iter()
        .zip(&log.force_n)
        .zip(&contact.force_n);
    for ((x, read_n), contact_n) in each {
        let pull_n = -force_n / (1.0 + (x / reach_m).powi(2));
        assert!((read_n - contact_n - pull_n).abs() < 1e-9);
    }
    // AND a board has settings for it.
    let mut settings = Settings::default();
    assert!(settings.put_effect(&effect));
    let setup = settings.setup().unwrap();
    let ids: Vec<EffectId> = setup.compensation.unwrap().ids().collect();
    assert_eq!(ids, [ID]);
}
