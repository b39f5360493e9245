//! Models read, are refused with a reason, and come back as they were written.

use super::*;
use estimator_core::physics::law::{Law, Recovery};

fn parse(text: &str) -> Result<Model, Diagnostic> {
    let path = Path::new("m.toml");
    Model::from_toml(&TomlFile::parse(text.to_string(), path)?, path)
}

const EVERYTHING: &str = r#"
[environment]
law = "hammerstein"
stiffness = 2498.3
exponent = 1.50
relaxation = [{ fraction = 0.22, rate = 4.191 }, { fraction = 0.1, rate = 0.3 }]
surface = 1e-4
reference_depth = 2e-3
fixed = ["surface", "relaxation_rate_2"]
[environment.std_error]
stiffness = 1.2

[[effect]]
id = "coulomb_friction"
force = 0.41
std_error = { force = 0.003 }
[[effect]]
id = "effect_of_the_future"
some_length = 3
fixed = ["some_length"]

[sensors]
force_noise = 0.01
rate = 5000

[remainder]
rms = 0.026
by_phase = { loading = 0.03, hold = 0.011 }
noise = 0.003
correlation_time = 0.04
bandwidth = 20
"#;

#[test]
fn a_model_with_everything_reads_and_comes_back_as_it_was() {
    let model = parse(EVERYTHING).unwrap();
    assert_eq!(model.environment.law.name(), "quasi_linear");
    assert_eq!(
        model.environment.fit.fixed,
        ["surface", "relaxation_rate_2"]
    );
    assert_eq!(
        model.environment.fit.std_error,
        [("stiffness".to_string(), 1.2)]
    );
    assert_eq!(model.effects[0].parameter("force"), Some(0.41));
    assert_eq!(model.effects[1].line, Some(17));
    assert_eq!(model.sensors.rate_hz, 5000.0);
    assert_eq!(model.sensors.position_step_m, 1e-6);
    let left = model.remainder.unwrap();
    assert_eq!((left.rms_n, left.noise_n), (0.026, Some(0.003)));
    let by_phase_n: Vec<f64> = left.by_phase_n.into_iter().flatten().collect();
    assert_eq!(by_phase_n, [0.03, 0.011]);
    let mut back = parse(&model.to_string()).unwrap();
    for (effect, original) in back.effects.iter_mut().zip(&model.effects) {
        effect.line = original.line;
    }
    assert_eq!(back, model);
}

#[test]
fn every_law_comes_back_as_it_was() {
    for environment in [
        "law = \"free\"",
        "law = \"kelvin_voigt\"\nstiffness = 2260\ndamping = 123",
        "law = \"hunt_crossley\"\nstiffness = 1350\ndamping = 36\nexponent = 1.35",
        "law = \"hunt_crossley\"\nstiffness = 1\ndamping = 0\nexponent = 1\ndamping_exponent = 2",
        "law = \"zener\"\nstiffness = 3000\nsecond_stiffness = 900\ndamping = 40",
        "law = \"quasi_linear\"\nstiffness = 1\nelastic = \"exponential\"\nrate = 300",
        "law = \"quasi_linear\"\nstiffness = 1\nstiffening_rate = 300",
        "law = \"quasi_linear\"\nstiffness = 1\nelastic = \"power\"\nexponent = 2",
    ] {
        let model = parse(&format!("[environment]\n{environment}\n")).unwrap();
        assert_eq!(parse(&model.to_toml()).unwrap(), model, "{environment}");
    }
}

#[test]
fn mistakes_are_named_with_line_and_remedy() {
    let kelvin_voigt = "[environment]\nlaw = \"kelvin_voigt\"\nstiffness = 1\n";
    for (text, line, what) in [
        (
            format!("{kelvin_voigt}damping = 1\nexponent = 1.3\n"),
            Some(5),
            "unknown key `exponent`",
        ),
        (
            format!("{kelvin_voigt}dampling = 1\n"),
            Some(4),
            "unknown key `dampling`",
        ),
        (kelvin_voigt.into(), Some(1), "`damping` is missing"),
        (
            format!("{kelvin_voigt}damping = -2\n"),
            Some(4),
            "outside its bounds",
        ),
        (
            format!("{kelvin_voigt}damping = 2\nfixed = [\"mass\"]\n"),
            Some(5),
            "not a parameter",
        ),
        (
            "[environment]\nlaw = \"kelvin_voight\"\n".into(),
            Some(2),
            "unknown law",
        ),
        (
            "[enviroment]\nlaw = \"free\"\n".into(),
            Some(1),
            "unknown key `enviroment`",
        ),
        (
            "[environment]\nlaw = \"free\"\n[remainder]\nrms = 1\ncorrelation_time = 1\n\
             by_phase = { holds = 1 }\n"
                .into(),
            Some(6),
            "unknown key `holds`",
        ),
        ("[[effect]]\nid = \"a\"\n".into(), None, "no [environment]"),
        (
            "[environment]\nlaw = \"free\"\n[[effect]]\nforce = 1\n".into(),
            Some(3),
            "`id` is missing",
        ),
        (
            "[environment]\nlaw = \"free\"\n[[effect]]\nid = \"a\"\nforce = \"b\"\n".into(),
            Some(5),
            "string",
        ),
        (
            "[environment]\nlaw = \"quasi_linear\"\nstiffness = 1\nexponent = 1\n\
             stiffening_rate = 9\n"
                .into(),
            Some(4),
            "has no exponent",
        ),
        (
            "[environment]\nlaw = \"quasi_linear\"\nstiffness = 1\nexponent = 1\n\
             relaxation = [{ fraction = 0.6, rate = 1 }, { fraction = 0.5, rate = 2 }]\n"
                .into(),
            Some(5),
            "leave nothing",
        ),
        (
            "[environment]\nlaw = \"free\"\nrecovery = \"elastic\"\n".into(),
            Some(3),
            "unknown recovery",
        ),
        (
            "[environment]\nlaw = \"free\"\n[sensors]\nrate = 0\n".into(),
            Some(4),
            "bounds",
        ),
    ] {
        let error = parse(&text).unwrap_err();
        assert_eq!(error.line, line, "{error}");
        assert!(error.what.contains(what), "{error}");
        assert!(error.remedy.is_some(), "{error}");
        assert!(error.to_string().lines().count() <= 8, "{error}");
    }
}

#[test]
fn a_model_becomes_a_contact_where_the_rig_has_its_law() {
    let gel = parse(
        "[environment]\nlaw = \"hunt_crossley\"\nstiffness = 1350\ndamping = 36\nexponent = 1.35\n",
    );
    assert_eq!(
        gel.unwrap().environment.contact(),
        Some(crate::plant::GEL.at(0.0))
    );
    let law = |text: &str| {
        let model = parse(&format!("[environment]\n{text}\n")).unwrap();
        model.environment.contact().map(|contact| contact.law)
    };
    let Some(Law::Zener(zener)) =
        law("law = \"zener\"\nstiffness = 3\nsecond_stiffness = 2\ndamping = 1")
    else {
        panic!("a Zener model is a Zener material");
    };
    assert_eq!(zener.second_stiffness_n_per_m, 2.0);
    let solid =
        "[environment]\nlaw = \"zener\"\nstiffness = 3\nsecond_stiffness = 2\ndamping = 1\n";
    let creeping = parse(&format!("{solid}recovery = \"creep\"\n")).unwrap();
    let core = creeping.environment.core().unwrap();
    assert_eq!(core.recovery, Recovery::ByCreep);
    assert_eq!(parse(&creeping.to_toml()), Ok(creeping));
    let usual = parse(solid).unwrap();
    assert_eq!(
        usual.environment.core().unwrap().recovery,
        Recovery::WithProbe
    );
    assert!(!usual.to_toml().contains("recovery"));
    let quasi_linear = "law = \"quasi_linear\"\nstiffness = 1\nexponent = 2\nrelaxation = ";
    let Some(Law::QuasiLinear(two)) = law(&format!(
        "{quasi_linear}[{{ fraction = 0.2, rate = 3 }}, {{ fraction = 0.1, rate = 0.5 }}]"
    )) else {
        panic!("a quasi-linear model is a quasi-linear material");
    };
    assert_eq!(two.modes.map(|mode| mode.fraction), [0.2, 0.1, 0.0, 0.0]);
    assert_eq!(two.modes[1].rate_per_s, 0.5);
    let five = "{ fraction = 0.1, rate = 3 },".repeat(5);
    assert_eq!(law(&format!("{quasi_linear}[{five}]")), None);
}
