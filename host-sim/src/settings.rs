//! The estimator's configuration as a file: TOML with the fields of [`Config`], all optional.
//!
//! ```toml
//! [filter]                 # one of
//! half_width = 8           # Savitzky–Golay: samples on either side
//! # cutoff_hz = 40.0       # state-variable filter (Hz)
//! # damping_ratio = 1.0
//!
//! [reference]
//! depth_m = 1e-3           # δ₀
//! force_n = 1.0
//!
//! [contact]
//! surface_m = 0.0          # if known
//! touch_sigma = 6.0
//! release_sigma = 3.0
//! force_noise_n = 0.02     # measured if absent
//! position_step_m = 1e-6   # one count, where samples are sums of several readings
//! settle_s = 0.2
//!
//! [forgetting]             # (24)
//! alpha_1 = 0.03           # 0.001 for kelvin_voigt
//! alpha_2_per_n = 400.0    # 8/α₃ if absent
//! alpha_3_n = 0.02         # the noise if absent
//! excitation_step = 0.03
//!
//! [initial]
//! covariance = 1e4
//! exponent = 1.3
//!
//! [judgement]
//! converged_within = 0.05
//! window_s = 0.5
//! suspect_ratio = 25.0
//!
//! [estimator]              # of a fit of the whole log, but for the surface
//! fixed = ["exponent"]     # held at their value in `initial`
//! initial = { exponent = 1.5 }
//! elastic = "exponential"  # of quasi_linear, with `stiffening_rate` (1/m) in place of the exponent
//!
//! [zener]
//! inversion = "exact"      # or "forward_euler", as printed in the chapter
//!
//! [cascade]
//! loading_speed_mps = 5e-3 # 5 reference depths a second if absent
//! weight = "force"         # of the elastic stage, or "force_squared"
//! ```

use std::path::Path;

use estimator_core::Config;
use estimator_core::estimate::config::{Filter, Inversion, Surface, Weight};
use estimator_core::physics::law::{LawId, ParameterInfo, RELAXATION, SURFACE};

use crate::batch::{Form, Held};
use crate::diagnostic::{Diagnostic, listed, nearest};
use crate::toml_reader::{Bounds, Table, TomlFile};

/// What a file of settings says.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Settings {
    /// Of the estimator that runs on the board as well.
    pub config: Config,
    /// Parameters that are held or begun with.
    pub held: Held,
    /// How the force of a relaxing law grows with depth, if it is chosen.
    pub elastic: Option<Form>,
}

impl Settings {
    /// Whether something is asked for that only a fit of the whole log has.
    pub fn needs_whole_log(&self) -> bool {
        self.batch_only().is_some()
    }

    /// Refuses what the recursive methods do not take.
    ///
    /// # Errors
    /// The key, and the method that takes it.
    pub fn refuse(&self) -> Result<(), Diagnostic> {
        match self.batch_only() {
            None => Ok(()),
            Some(key) => Err(Diagnostic::new("this needs a fit of the whole log")
                .at_key("estimator")
                .value(key)
                .remedy("add --method batch, or leave out both --law and --method")),
        }
    }

    fn batch_only(&self) -> Option<&str> {
        let mut held = self.held.fixed.iter().map(|(name, _)| name.as_str());
        let shaped = self.elastic.filter(|form| *form != Form::Power);
        held.find(|name| *name != "surface")
            .or(shaped.map(|_| "elastic"))
    }
}

/// Reads a configuration; what it does not name keeps its default. The rate is the log's.
///
/// # Errors
/// Unknown keys, wrong types, and values that [`Config::validate`] refuses, with their line.
pub fn read(path: &Path) -> Result<Settings, Diagnostic> {
    parse(&TomlFile::read(path)?)
}

fn parse(file: &TomlFile) -> Result<Settings, Diagnostic> {
    let root = file.root();
    let mut config = Config::default();
    type Section = fn(&Table, &mut Config) -> Result<(), Diagnostic>;
    let sections: [(&str, Section); 8] = [
        ("filter", filter),
        ("reference", reference),
        ("contact", contact),
        ("forgetting", forgetting),
        ("initial", initial),
        ("judgement", judgement),
        ("zener", zener),
        ("cascade", cascade),
    ];
    for (key, read) in sections {
        if let Some(table) = root.table(key)? {
            read(&table, &mut config)?;
            table.finish()?;
        }
    }
    let mut settings = Settings::default();
    if let Some(table) = root.table("estimator")? {
        estimator(&table, &mut settings)?;
        table.finish()?;
    }
    begin(&mut config, &settings.held);
    settings.config = config;
    root.finish()?;
    match config.validate::<f32>() {
        Ok(_) => Ok(settings),
        Err(error) => Err(refused(&root, &error)?),
    }
}

/// The values that recursive methods can begin with too.
fn begin(config: &mut Config, held: &Held) {
    for (name, value) in &held.initial {
        let value = *value as f32;
        match name.as_str() {
            "stiffness" => config.initial.stiffness_n_per_m = value,
            "damping" => config.initial.damping_ns_per_m = value,
            "exponent" => config.initial.exponent = value,
            _ => {}
        }
    }
}

fn estimator(table: &Table, settings: &mut Settings) -> Result<(), Diagnostic> {
    let words = [("power", Form::Power), ("exponential", Form::Exponential)];
    settings.elastic = either(table, "elastic", words)?;
    if let Some(initial) = table.table("initial")? {
        for info in parameters() {
            if let Some(value) = initial.number(info.name, info.bounds)? {
                settings.held.initial.push((info.name.into(), value));
            }
        }
        initial.finish()?;
    }
    for name in table.texts("fixed")? {
        let mut names = parameters().map(|info| info.name);
        if !names.any(|known| known == name) {
            let all = parameters().map(|info| info.name);
            let near = nearest(&name, all.clone());
            let remedy = match near {
                Some(near) => format!("write \"{near}\""),
                None => format!("the parameters are {}", listed(all)),
            };
            let what = format!("no law has a parameter `{name}`");
            return Err(table.wrong("fixed", what).remedy(remedy));
        }
        let mut initial = settings.held.initial.iter();
        let Some((_, value)) = initial.find(|(own, _)| *own == name) else {
            let what = format!("`{name}` is held, and no value says where");
            let remedy = format!("add initial = {{ {name} = … }}");
            return Err(table.wrong("fixed", what).remedy(remedy));
        };
        let value = *value;
        settings.held.fixed.push((name, value));
    }
    Ok(())
}

/// Every parameter of every law, once.
fn parameters() -> impl Iterator<Item = &'static ParameterInfo> + Clone {
    let of_law = |law: &'static LawId| {
        let info = law.info();
        info.parameters.iter().chain(info.optional)
    };
    let modes = RELAXATION.iter().flatten();
    let all = LawId::ALL
        .iter()
        .flat_map(of_law)
        .chain(modes)
        .chain([&SURFACE]);
    let mut kept: Vec<&ParameterInfo> = Vec::new();
    for info in all {
        if kept.iter().all(|own| own.name != info.name) {
            kept.push(info);
        }
    }
    kept.into_iter()
}

/// The error of a value, at its line.
fn refused(root: &Table, error: &estimator_core::ConfigError) -> Result<Diagnostic, Diagnostic> {
    let (section, key) = error.field.split_once('.').unwrap_or(("", error.field));
    let key = if key == "surface.position_m" {
        "surface_m"
    } else {
        key
    };
    let what = format!("`{key}` cannot be {}", error.value);
    let diagnostic = match root.table(section)? {
        Some(table) => table.wrong(key, what),
        None => root.wrong(key, what),
    };
    Ok(diagnostic.remedy(error.expected))
}

fn set(table: &Table, key: &str, field: &mut f32) -> Result<(), Diagnostic> {
    if let Some(value) = table.number(key, Bounds::Any)? {
        *field = value as f32;
    }
    Ok(())
}

fn filter(table: &Table, config: &mut Config) -> Result<(), Diagnostic> {
    let half_width = table.number("half_width", Bounds::Within(2.0, 32.0))?;
    let cutoff = table.number("cutoff_hz", Bounds::Positive)?;
    let damping = table.number("damping_ratio", Bounds::Positive)?;
    config.filter = match (half_width, cutoff) {
        (Some(_), Some(_)) => {
            return Err(table
                .wrong("cutoff_hz", "two filters at once")
                .remedy("half_width chooses Savitzky–Golay, cutoff_hz the state-variable filter"));
        }
        (Some(half_width), None) => Filter::SavitzkyGolay {
            half_width: half_width as u8,
        },
        (None, Some(cutoff_hz)) => Filter::StateVariable {
            cutoff_hz: cutoff_hz as f32,
            damping_ratio: damping.unwrap_or(1.0) as f32,
        },
        (None, None) => config.filter,
    };
    Ok(())
}

fn reference(table: &Table, config: &mut Config) -> Result<(), Diagnostic> {
    set(table, "depth_m", &mut config.reference.depth_m)?;
    set(table, "force_n", &mut config.reference.force_n)
}

fn contact(table: &Table, config: &mut Config) -> Result<(), Diagnostic> {
    if let Some(position) = table.number("surface_m", Bounds::Any)? {
        config.contact.surface = Surface::Known {
            position_m: position as f32,
        };
    }
    set(table, "touch_sigma", &mut config.contact.touch_sigma)?;
    set(table, "release_sigma", &mut config.contact.release_sigma)?;
    set(table, "settle_s", &mut config.contact.settle_s)?;
    let noise = table.number("force_noise_n", Bounds::Any)?;
    config.contact.force_noise_n = noise.map(|noise| noise as f32);
    let count = table.number("position_step_m", Bounds::Any)?;
    config.contact.position_step_m = count.map(|count| count as f32);
    Ok(())
}

fn forgetting(table: &Table, config: &mut Config) -> Result<(), Diagnostic> {
    set(
        table,
        "excitation_step",
        &mut config.forgetting.excitation_step,
    )?;
    let optional = |key| Ok(table.number(key, Bounds::Any)?.map(|value| value as f32));
    config.forgetting.alpha_1 = optional("alpha_1")?;
    config.forgetting.alpha_2_per_n = optional("alpha_2_per_n")?;
    config.forgetting.alpha_3_n = optional("alpha_3_n")?;
    Ok(())
}

fn initial(table: &Table, config: &mut Config) -> Result<(), Diagnostic> {
    set(table, "covariance", &mut config.initial.covariance)?;
    set(
        table,
        "stiffness_n_per_m",
        &mut config.initial.stiffness_n_per_m,
    )?;
    set(
        table,
        "damping_ns_per_m",
        &mut config.initial.damping_ns_per_m,
    )?;
    set(table, "exponent", &mut config.initial.exponent)
}

fn judgement(table: &Table, config: &mut Config) -> Result<(), Diagnostic> {
    set(
        table,
        "converged_within",
        &mut config.judgement.converged_within,
    )?;
    set(table, "window_s", &mut config.judgement.window_s)?;
    set(table, "suspect_ratio", &mut config.judgement.suspect_ratio)
}

/// One of two words for a setting; `None` if the key is absent.
fn either<T: Copy>(
    table: &Table,
    key: &str,
    words: [(&str, T); 2],
) -> Result<Option<T>, Diagnostic> {
    let Some(text) = table.text(key)? else {
        return Ok(None);
    };
    match words.iter().find(|(word, _)| *word == text) {
        Some((_, value)) => Ok(Some(*value)),
        None => Err(table
            .wrong(key, format!("unknown {key} `{text}`"))
            .remedy(format!("write \"{}\" or \"{}\"", words[0].0, words[1].0))),
    }
}

fn zener(table: &Table, config: &mut Config) -> Result<(), Diagnostic> {
    let words = [
        ("exact", Inversion::Exact),
        ("forward_euler", Inversion::ForwardEuler),
    ];
    config.inversion = either(table, "inversion", words)?.unwrap_or(config.inversion);
    Ok(())
}

fn cascade(table: &Table, config: &mut Config) -> Result<(), Diagnostic> {
    let words = [
        ("force", Weight::Force),
        ("force_squared", Weight::ForceSquared),
    ];
    config.cascade.weight = either(table, "weight", words)?.unwrap_or(config.cascade.weight);
    let speed = table.number("loading_speed_mps", Bounds::Positive)?;
    config.cascade.loading_speed_mps = speed.map(|speed| speed as f32);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(text: &str) -> Result<Settings, Diagnostic> {
        parse(&TomlFile::parse(text.into(), Path::new("estimator.toml"))?)
    }

    fn of(text: &str) -> Result<Config, Diagnostic> {
        all(text).map(|settings| settings.config)
    }

    #[test]
    fn parameters_are_held_at_their_initial_value() {
        let text = "[estimator]\nfixed = [\"exponent\"]\n\
                    initial = { exponent = 1.5, stiffness = 900.0 }\nelastic = \"power\"\n";
        let settings = all(text).unwrap();
        assert_eq!(settings.held.value("exponent"), Some(1.5));
        assert_eq!(settings.held.value("stiffness"), None);
        assert_eq!(settings.config.initial.stiffness_n_per_m, 900.0);
        assert!(settings.needs_whole_log() && settings.refuse().is_err());
        let surface = "[estimator]\nfixed = [\"surface\"]\ninitial = { surface = 1e-4 }\n";
        assert!(!all(surface).unwrap().needs_whole_log());
    }

    #[test]
    fn what_is_held_wrongly_is_refused_with_the_remedy() {
        for (text, remedy) in [
            ("[estimator]\nfixed = [\"exponant\"]\n", "\"exponent\""),
            (
                "[estimator]\nfixed = [\"exponent\"]\n",
                "initial = { exponent",
            ),
            ("[estimator]\ninitial = { exponant = 1.5 }\n", "exponent"),
            ("[estimator]\nelastic = \"fung\"\n", "exponential"),
            ("[estimator]\nheld = 1\n", "fixed"),
        ] {
            let error = all(text).unwrap_err().to_string();
            assert!(error.contains(remedy), "{text}: {error}");
        }
    }

    #[test]
    fn an_empty_file_is_the_defaults() {
        assert_eq!(of("").unwrap(), Config::default());
    }

    #[test]
    fn the_filter_of_the_chapter_is_chosen_by_its_corner() {
        let config = of("[filter]\ncutoff_hz = 40.0\n").unwrap();
        let chosen = Filter::StateVariable {
            cutoff_hz: 40.0,
            damping_ratio: 1.0,
        };
        assert_eq!(config.filter, chosen);
    }

    #[test]
    fn the_inversion_and_the_weight_are_chosen_by_name() {
        let text = "[zener]\ninversion = \"forward_euler\"\n[cascade]\nweight = \"force_squared\"\n\
                    loading_speed_mps = 0.01\n";
        let config = of(text).unwrap();
        assert_eq!(config.inversion, Inversion::ForwardEuler);
        assert_eq!(config.cascade.weight, Weight::ForceSquared);
        assert_eq!(config.cascade.loading_speed_mps, Some(0.01));
        let error = of("[zener]\ninversion = \"tustin\"\n").unwrap_err();
        assert_eq!(error.line, Some(2), "{error}");
        assert!(error.to_string().contains("forward_euler"), "{error}");
    }

    #[test]
    fn a_value_that_cannot_be_used_is_shown_at_its_line() {
        let error = of("[contact]\nsettle_s = 0.2\n\n[forgetting]\nalpha_1 = 1.7\n").unwrap_err();
        assert_eq!(error.line, Some(5), "{error}");
        assert!(
            error
                .to_string()
                .contains("between 0 (never forget) and 0.5"),
            "{error}"
        );
    }

    #[test]
    fn an_unknown_key_names_the_nearest() {
        let error = of("[forgetting]\nalpha1 = 0.1\n").unwrap_err().to_string();
        assert!(error.contains("alpha_1"), "{error}");
    }

    #[test]
    fn two_filters_at_once_are_refused() {
        assert!(of("[filter]\nhalf_width = 10\ncutoff_hz = 40.0\n").is_err());
    }
}
