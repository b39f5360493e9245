//! The environment: a contact law by name, with its parameters.

use estimator_core::physics::law::{self, HuntCrossley, KelvinVoigt, QuasiLinear, Zener};

use super::Fit;
use crate::diagnostic::{Diagnostic, listed, nearest};
use crate::plant::{Contact, Law, MODES};
use crate::toml_reader::{Bounds, Table};

/// δ₀ (m) unless a model says otherwise: that of the chapter's numbers.
const USUAL_REFERENCE_DEPTH_M: f64 = 1e-3;

/// Exponents that a contact can have: 1 a layer, 3/2 a sphere, 2 a cone; fits wander further.
const EXPONENTS: Bounds = Bounds::Within(0.1, 10.0);

/// What is touched.
#[derive(Clone, Debug, PartialEq)]
pub struct Environment {
    /// The law and its parameters.
    pub law: EnvironmentLaw,
    /// Position of the surface (m).
    pub surface_m: f64,
    /// δ₀ (m), at which stiffness and damping hold.
    pub reference_depth_m: f64,
    /// What a fit must not move and what it found.
    pub fit: Fit,
}

/// The laws that a model can name.
#[derive(Clone, Debug, PartialEq)]
pub enum EnvironmentLaw {
    /// Nothing to touch.
    Free,
    /// F = Kδ + λδ̇, (1)
    KelvinVoigt {
        /// K (N/m)
        stiffness: f64,
        /// λ (N s/m)
        damping: f64,
    },
    /// F = (Kδ₀ + λδ̇)(δ/δ₀)ⁿ, (3)
    HuntCrossley {
        /// K (N/m)
        stiffness: f64,
        /// λ (N s/m)
        damping: f64,
        /// n
        exponent: f64,
        /// q, if it is not n.
        damping_exponent: Option<f64>,
    },
    /// The standard linear solid, (2)
    Zener {
        /// κ₁ (N/m), the spring in series: F/δ at once.
        stiffness: f64,
        /// κ₂ (N/m), parallel to the damper.
        second_stiffness: f64,
        /// λ (N s/m)
        damping: f64,
    },
    /// Fung's quasi-linear law, (9)
    QuasiLinear {
        /// K (N/m) at δ₀, or m of (11).
        stiffness: f64,
        /// The elastic response.
        elastic: Elastic,
        /// Relaxation, (10), fast to slow.
        relaxation: Vec<RelaxationMode>,
    },
}

/// The elastic response of a quasi-linear law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Elastic {
    /// Kδ₀(δ/δ₀)ⁿ, (14)
    Power {
        /// n
        exponent: f64,
    },
    /// (m/b)(e^{bδ} − 1), (13)
    Exponential {
        /// b (1/m)
        stiffening_rate: f64,
    },
}

/// One term of the reduced relaxation function (10).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RelaxationMode {
    /// c
    pub fraction: f64,
    /// ν (1/s)
    pub rate: f64,
}

/// A parameter by the name that it has in files.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Key in `model.toml`; of a relaxation mode `relaxation_fraction_1`, `relaxation_rate_1`, ….
    pub name: String,
    /// Value in `unit`.
    pub value: f64,
    /// Unit as in reports.
    pub unit: &'static str,
}

const LAWS: [&str; 6] = [
    "kelvin_voigt",
    "hunt_crossley",
    "zener",
    "quasi_linear",
    "hammerstein",
    "free",
];

/// Keys of every environment.
const COMMON_KEYS: [&str; 5] = ["law", "surface", "reference_depth", "fixed", "std_error"];

fn keys_of(law: &str) -> &'static [&'static str] {
    match law {
        "kelvin_voigt" => &["stiffness", "damping"],
        "hunt_crossley" => &["stiffness", "damping", "exponent", "damping_exponent"],
        "zener" => &["stiffness", "second_stiffness", "damping"],
        "quasi_linear" | "hammerstein" => &[
            "stiffness",
            "exponent",
            "stiffening_rate",
            "elastic",
            "relaxation",
        ],
        _ => &[],
    }
}

impl Environment {
    pub(super) fn from_table(table: &Table<'_>) -> Result<Environment, Diagnostic> {
        let name = table.required_text("law", &LAWS)?;
        table.understand(keys_of(name));
        table.understand(&COMMON_KEYS);
        let law = EnvironmentLaw::from_table(name, table)?;
        let reference = table.number("reference_depth", Bounds::Positive)?;
        let mut environment = Environment {
            law,
            surface_m: table.number("surface", Bounds::Any)?.unwrap_or(0.0),
            reference_depth_m: reference.unwrap_or(USUAL_REFERENCE_DEPTH_M),
            fit: Fit::default(),
        };
        let names: Vec<String> = environment
            .parameters()
            .into_iter()
            .map(|p| p.name)
            .collect();
        environment.fit = Fit::from_table(table, &names)?;
        table.finish()?;
        Ok(environment)
    }

    /// The law's parameters, then the surface. The reference depth is a choice, no parameter.
    pub fn parameters(&self) -> Vec<Parameter> {
        let mut parameters = self.law.parameters();
        if self.law != EnvironmentLaw::Free {
            parameters.push(parameter("surface", self.surface_m, "m"));
        }
        parameters
    }

    /// The same law with other values, in the order of [`Environment::parameters`]; what is missing
    /// stays.
    #[must_use]
    pub fn with_values(&self, values: &[f64]) -> Environment {
        let mut environment = self.clone();
        let mut values = values.iter().copied();
        let mut set = |own: &mut f64| *own = values.next().unwrap_or(*own);
        match &mut environment.law {
            EnvironmentLaw::Free => return environment,
            EnvironmentLaw::KelvinVoigt { stiffness, damping } => {
                set(stiffness);
                set(damping);
            }
            EnvironmentLaw::HuntCrossley {
                stiffness,
                damping,
                exponent,
                damping_exponent,
            } => {
                set(stiffness);
                set(damping);
                set(exponent);
                damping_exponent.iter_mut().for_each(&mut set);
            }
            EnvironmentLaw::Zener {
                stiffness,
                second_stiffness,
                damping,
            } => {
                set(stiffness);
                set(second_stiffness);
                set(damping);
            }
            EnvironmentLaw::QuasiLinear {
                stiffness,
                elastic,
                relaxation,
            } => {
                set(stiffness);
                match elastic {
                    Elastic::Power { exponent } => set(exponent),
                    Elastic::Exponential { stiffening_rate } => set(stiffening_rate),
                }
                for mode in relaxation {
                    set(&mut mode.fraction);
                    set(&mut mode.rate);
                }
            }
        }
        set(&mut environment.surface_m);
        environment
    }

    /// The environment as the simulated rig can have it; `None` if it has more than [`MODES`]
    /// relaxation modes.
    pub fn contact(&self) -> Option<Contact> {
        let law = match &self.law {
            EnvironmentLaw::Free => Law::Free,
            EnvironmentLaw::KelvinVoigt { stiffness, damping } => Law::KelvinVoigt(KelvinVoigt {
                stiffness_n_per_m: *stiffness,
                damping_ns_per_m: *damping,
            }),
            EnvironmentLaw::HuntCrossley {
                stiffness,
                damping,
                exponent,
                damping_exponent,
            } => Law::HuntCrossley(HuntCrossley {
                stiffness_n_per_m: *stiffness,
                damping_ns_per_m: *damping,
                exponent: *exponent,
                damping_exponent: damping_exponent.unwrap_or(*exponent),
                reference_depth_m: self.reference_depth_m,
            }),
            EnvironmentLaw::Zener {
                stiffness,
                second_stiffness,
                damping,
            } => Law::Zener(Zener {
                stiffness_n_per_m: *stiffness,
                second_stiffness_n_per_m: *second_stiffness,
                damping_ns_per_m: *damping,
            }),
            EnvironmentLaw::QuasiLinear {
                stiffness,
                elastic,
                relaxation,
            } => Law::QuasiLinear(QuasiLinear {
                elastic: elastic.law(*stiffness, self.reference_depth_m),
                modes: modes(relaxation)?,
            }),
        };
        Some(Contact {
            law,
            surface_m: self.surface_m,
        })
    }
}

impl Elastic {
    fn law(self, stiffness_n_per_m: f64, reference_depth_m: f64) -> law::Elastic<f64> {
        match self {
            Elastic::Power { exponent } => law::Elastic::Power {
                stiffness_n_per_m,
                exponent,
                reference_depth_m,
            },
            Elastic::Exponential { stiffening_rate } => law::Elastic::Exponential {
                stiffness_n_per_m,
                stiffening_rate_per_m: stiffening_rate,
            },
        }
    }
}

/// The modes of a model, and ones of fraction 0; `None` if there are more than the rig has.
fn modes(relaxation: &[RelaxationMode]) -> Option<[law::RelaxationMode<f64>; MODES]> {
    let mut modes = [law::RelaxationMode {
        fraction: 0.0,
        rate_per_s: 0.0,
    }; MODES];
    for (index, own) in relaxation.iter().enumerate() {
        *modes.get_mut(index)? = law::RelaxationMode {
            fraction: own.fraction,
            rate_per_s: own.rate,
        };
    }
    Some(modes)
}

impl EnvironmentLaw {
    /// Its name in files.
    pub const fn name(&self) -> &'static str {
        match self {
            EnvironmentLaw::Free => "free",
            EnvironmentLaw::KelvinVoigt { .. } => "kelvin_voigt",
            EnvironmentLaw::HuntCrossley { .. } => "hunt_crossley",
            EnvironmentLaw::Zener { .. } => "zener",
            EnvironmentLaw::QuasiLinear { .. } => "quasi_linear",
        }
    }

    fn from_table(name: &str, table: &Table<'_>) -> Result<EnvironmentLaw, Diagnostic> {
        let stiffness = |key: &str| table.required_number(key, Bounds::Positive);
        let damping = || table.required_number("damping", Bounds::NotNegative);
        Ok(match name {
            "free" => EnvironmentLaw::Free,
            "kelvin_voigt" => EnvironmentLaw::KelvinVoigt {
                stiffness: stiffness("stiffness")?,
                damping: damping()?,
            },
            "hunt_crossley" => EnvironmentLaw::HuntCrossley {
                stiffness: stiffness("stiffness")?,
                damping: damping()?,
                exponent: table.required_number("exponent", EXPONENTS)?,
                damping_exponent: table.number("damping_exponent", Bounds::Within(0.0, 10.0))?,
            },
            "zener" => EnvironmentLaw::Zener {
                stiffness: stiffness("stiffness")?,
                second_stiffness: stiffness("second_stiffness")?,
                damping: table.required_number("damping", Bounds::Positive)?,
            },
            "quasi_linear" | "hammerstein" => EnvironmentLaw::QuasiLinear {
                stiffness: stiffness("stiffness")?,
                elastic: elastic(table)?,
                relaxation: relaxation(table)?,
            },
            other => return Err(unknown_law(table, other)),
        })
    }

    fn parameters(&self) -> Vec<Parameter> {
        match self {
            EnvironmentLaw::Free => Vec::new(),
            EnvironmentLaw::KelvinVoigt { stiffness, damping } => vec![
                parameter("stiffness", *stiffness, "N/m"),
                parameter("damping", *damping, "N s/m"),
            ],
            EnvironmentLaw::HuntCrossley {
                stiffness,
                damping,
                exponent,
                damping_exponent,
            } => {
                let mut parameters = vec![
                    parameter("stiffness", *stiffness, "N/m"),
                    parameter("damping", *damping, "N s/m"),
                    parameter("exponent", *exponent, "1"),
                ];
                parameters.extend(damping_exponent.map(|q| parameter("damping_exponent", q, "1")));
                parameters
            }
            EnvironmentLaw::Zener {
                stiffness,
                second_stiffness,
                damping,
            } => vec![
                parameter("stiffness", *stiffness, "N/m"),
                parameter("second_stiffness", *second_stiffness, "N/m"),
                parameter("damping", *damping, "N s/m"),
            ],
            EnvironmentLaw::QuasiLinear {
                stiffness,
                elastic,
                relaxation,
            } => {
                let mut parameters = vec![parameter("stiffness", *stiffness, "N/m")];
                parameters.push(match elastic {
                    Elastic::Power { exponent } => parameter("exponent", *exponent, "1"),
                    Elastic::Exponential { stiffening_rate } => {
                        parameter("stiffening_rate", *stiffening_rate, "1/m")
                    }
                });
                for (index, mode) in relaxation.iter().enumerate() {
                    let name = |what: &str| format!("relaxation_{what}_{}", index + 1);
                    parameters.push(parameter(&name("fraction"), mode.fraction, "1"));
                    parameters.push(parameter(&name("rate"), mode.rate, "1/s"));
                }
                parameters
            }
        }
    }
}

fn parameter(name: &str, value: f64, unit: &'static str) -> Parameter {
    Parameter {
        name: name.to_string(),
        value,
        unit,
    }
}

/// `exponent`, or `stiffening_rate` (also as `elastic = "exponential"` with `rate`).
fn elastic(table: &Table<'_>) -> Result<Elastic, Diagnostic> {
    let exponential = match table.text("elastic")? {
        None => None,
        Some("power") => Some(false),
        Some("exponential") => Some(true),
        Some(other) => {
            return Err(table
                .wrong("elastic", format!("unknown elastic response `{other}`"))
                .remedy(
                    "write \"power\" (with exponent) or \"exponential\" (with stiffening_rate)",
                ));
        }
    };
    let rate = table.number("stiffening_rate", Bounds::Positive)?;
    let rate = match exponential {
        Some(true) => rate.or(table.number("rate", Bounds::Positive)?),
        _ => rate,
    };
    match (exponential, rate) {
        (Some(false), Some(_)) => Err(table
            .wrong("stiffening_rate", "a power law has no stiffening rate")
            .remedy("remove it, or write elastic = \"exponential\"")),
        (_, Some(_)) if table.number("exponent", EXPONENTS)?.is_some() => Err(table
            .wrong("exponent", "an exponential response has no exponent")
            .remedy("remove it, or remove the stiffening rate")),
        (_, Some(stiffening_rate)) => Ok(Elastic::Exponential { stiffening_rate }),
        (Some(true), None) => {
            let stiffening_rate = table.required_number("stiffening_rate", Bounds::Positive)?;
            Ok(Elastic::Exponential { stiffening_rate })
        }
        (_, None) => {
            let exponent = table.required_number("exponent", EXPONENTS)?;
            Ok(Elastic::Power { exponent })
        }
    }
}

fn relaxation(table: &Table<'_>) -> Result<Vec<RelaxationMode>, Diagnostic> {
    let mode = |table: &Table<'_>| -> Result<RelaxationMode, Diagnostic> {
        let mode = RelaxationMode {
            fraction: table.required_number("fraction", Bounds::Fraction)?,
            rate: table.required_number("rate", Bounds::Positive)?,
        };
        table.finish()?;
        Ok(mode)
    };
    let modes = table.tables("relaxation")?;
    let modes = modes.iter().map(mode).collect::<Result<Vec<_>, _>>()?;
    let sum: f64 = modes.iter().map(|mode| mode.fraction).sum();
    if sum >= 1.0 {
        return Err(table
            .wrong(
                "relaxation",
                "the relaxation fractions leave nothing at rest",
            )
            .value(sum)
            .remedy("their sum must be less than 1: the rest is the force that stays"));
    }
    Ok(modes)
}

fn unknown_law(table: &Table<'_>, name: &str) -> Diagnostic {
    let diagnostic = table
        .wrong("law", format!("unknown law `{name}`"))
        .note(format!("the laws are {}", listed(LAWS)));
    match nearest(name, LAWS) {
        Some(near) => diagnostic.remedy(format!("write \"{near}\"")),
        None => diagnostic.remedy("write one of them"),
    }
}
