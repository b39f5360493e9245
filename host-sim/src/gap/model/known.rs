//! What an identified model knows of its numbers, as readings of them beside a log's.
//!
//! A base that is refitted without it follows an effect that is new as far as it can: behind a force that was made 2.3 ms
//! late a cantilever's layer had 26 % less stiffness, and 16 % less of its fastest relaxation, four standard errors.

use estimator_core::physics::effect::{EffectId, Repeats};

use crate::gap::model::shape::{Owner, Shape};
use crate::model::Model;

/// A number is known to half of what a change must be to count (5 %): records of one rig differ as much.
const RELATIVE: f64 = 0.025;

/// A number of a model that is a property of the rig: where the rig stands, its surface, is none.
pub(in crate::gap) struct Number {
    place: Place,
    /// As in a finding's base.
    pub(in crate::gap) name: String,
    pub(in crate::gap) value: f64,
    /// If a fit found one.
    pub(in crate::gap) std_error: Option<f64>,
}

/// What is known of the numbers of a model.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::gap) struct Known {
    each: Vec<KnownNumber>,
    /// How many samples are worth one independent one: as many times counts what is known.
    correlation: f64,
}

/// What is known of a number of the base.
#[derive(Clone, Copy, Debug, PartialEq)]
struct KnownNumber {
    place: Place,
    value: f64,
    std_error: f64,
}

/// Where a number stands in the base.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Place {
    /// Number of a parameter of the environment.
    Environment(usize),
    /// An effect, how many of its kind stand before it, and a parameter.
    Given(EffectId, usize, usize),
}

/// What is known of a free number, in the units of Σ w r²'s root: the residual is what is known less what it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::gap) struct Reading {
    /// The free number.
    pub(in crate::gap) number: usize,
    /// The residual.
    pub(in crate::gap) residual: f64,
    /// How much it falls as the number grows by one.
    pub(in crate::gap) slope: f64,
}

impl Known {
    /// What a model knows, a reading as good as a sample; `None` where it was never identified.
    pub(in crate::gap) fn of(model: &Model) -> Option<Known> {
        let numbers = numbers(model).into_iter();
        let of_the_rig = numbers.filter(|number| !number.is_of_the_start());
        let each: Vec<KnownNumber> = of_the_rig
            .filter_map(|number| {
                Some(KnownNumber {
                    place: number.place,
                    value: number.value,
                    std_error: number.std_error?,
                })
            })
            .collect();
        (!each.is_empty()).then_some(Known {
            each,
            correlation: 1.0,
        })
    }

    /// The same where as many times more samples are worth one.
    pub(in crate::gap) fn with_correlation(&self, correlation: f64) -> Known {
        Known {
            correlation,
            ..self.clone()
        }
    }

    /// How many samples are worth one independent one.
    pub(in crate::gap) fn correlation(&self) -> f64 {
        self.correlation
    }

    /// The same without what is known of a free number of a shape.
    pub(in crate::gap) fn but(&self, shape: &Shape, number: usize) -> Known {
        let mut but = self.clone();
        but.each
            .retain(|known| known.place.free_number(shape) != Some(number));
        but
    }

    /// What is known of the free numbers of a shape.
    pub(in crate::gap) fn readings(&self, shape: &Shape, numbers: &[f64]) -> Vec<Reading> {
        let each = self.each.iter();
        each.filter_map(|known| {
            let number = known.place.free_number(shape)?;
            let free = &shape.free[number];
            let error = known.std_error.hypot(RELATIVE * known.value);
            let scale = if free.logarithmic { known.value } else { 1.0 };
            let slope = self.correlation.sqrt() * scale / error;
            let off = free.number(known.value) - numbers[number];
            slope.is_finite().then_some(Reading {
                number,
                residual: slope * off,
                slope,
            })
        })
        .collect()
    }
}

/// The numbers of a model, in its order.
pub(in crate::gap) fn numbers(model: &Model) -> Vec<Number> {
    let of_law = model.environment.parameters().into_iter().enumerate();
    let of_law = of_law
        .filter(|(_, own)| own.name != "surface")
        .map(|(at, own)| Number {
            place: Place::Environment(at),
            std_error: model.environment.fit.error_of(&own.name),
            name: own.name,
            value: own.value,
        });
    let of_effects = model.effects.iter().enumerate().flat_map(|(at, effect)| {
        let earlier = model.effects[..at].iter();
        let earlier = earlier.filter(|other| other.id == effect.id).count();
        effect.parameters.iter().filter_map(move |(name, value)| {
            let id = EffectId::from_name(&effect.id)?;
            let infos = id.info().parameters;
            let parameter = infos.iter().position(|info| info.name == name)?;
            Some(Number {
                place: Place::Given(id, earlier, parameter),
                name: format!("{}.{name}", effect.id),
                value: *value,
                std_error: effect.fit.error_of(name),
            })
        })
    });
    of_law.chain(of_effects).collect()
}

impl Number {
    /// Whether it only says when a log was started: the phase of a hum, or of a surface that breathes.
    pub(in crate::gap) fn is_of_the_start(&self) -> bool {
        let Place::Given(id, _, parameter) = self.place else {
            return false;
        };
        let info = id.info();
        info.parameters[parameter].name == "phase" && info.repeats == Repeats::InTime
    }
}

impl Place {
    /// The free number of a shape that stands there.
    fn free_number(self, shape: &Shape) -> Option<usize> {
        let owner = match self {
            Place::Environment(at) => Owner::Environment(at),
            Place::Given(id, earlier, parameter) => {
                let terms = shape.terms.iter().enumerate();
                let mut own = terms.filter(|(_, term)| term.given && term.id == id);
                Owner::Effect(own.nth(earlier)?.0, parameter)
            }
        };
        shape.free.iter().position(|free| free.owner == owner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gap::data::{fit_data::FitData, scales::Scales};
    use crate::gap::model::{given::given, problem::Problem};
    use crate::log::Log;
    use crate::toml_reader::TomlFile;
    use std::path::Path;

    /// A spring that is known to 1 %, and two modes of relaxation of which the second is known.
    const IDENTIFIED: &str = "[environment]\nlaw = \"kelvin_voigt\"\nstiffness = 1000.0\ndamping = 3.0\nsurface = 0.0\n\
        std_error = { stiffness = 10.0, surface = 1e-6 }\n\
        [[effect]]\nid = \"stress_relaxation\"\nfraction = 0.2\nrate = 5.0\n\
        [[effect]]\nid = \"stress_relaxation\"\nfraction = 0.1\nrate = 50.0\nstd_error = { rate = 5.0 }\n";

    fn model(text: &str) -> Model {
        let path = Path::new("model.toml");
        Model::from_toml(&TomlFile::parse(text.into(), path).unwrap(), path).unwrap()
    }

    /// Half a second of presses of a millimetre into a spring of 1100 N/m.
    fn pressed() -> [FitData; 1] {
        let time_s: Vec<f64> = (0..500).map(|at| f64::from(at) * 1e-3).collect();
        let depth = |t: &f64| 1e-3 * (12.0 * t).sin();
        let positions: Vec<f64> = time_s.iter().map(depth).collect();
        let forces = positions.iter().map(|x| 1100.0 * x.max(0.0)).collect();
        let log = Log::from_channels(time_s, positions, forces);
        [FitData::of(&log.uniform().unwrap())]
    }

    fn shape(model: &Model, logs: &[FitData]) -> Shape {
        Shape::new(&model.environment, given(model).unwrap(), &Scales::of(logs))
    }

    #[test]
    fn what_a_file_gives_an_error_of_is_known_but_where_the_surface_is() {
        let model = model(IDENTIFIED);
        let known = Known::of(&model).unwrap().with_correlation(4.0);
        let shape = shape(&model, &pressed());
        let readings = known.readings(&shape, &shape.start());
        let owners: Vec<Owner> = readings
            .iter()
            .map(|own| shape.free[own.number].owner)
            .collect();
        assert_eq!(owners, [Owner::Environment(0), Owner::Effect(1, 1)]);
        // THEN logarithms are known to a share: 1 % and 2.5 %, 10 % and 2.5 %, each reading as good as four samples.
        for (reading, share) in readings.iter().zip([0.01_f64, 0.1]) {
            let expected = 2.0 / share.hypot(RELATIVE);
            assert!((reading.slope / expected - 1.0).abs() < 1e-9, "{reading:?}");
            assert_eq!(reading.residual, 0.0);
        }
        // AND a number that is let go is not held, and nothing is where nothing was identified.
        let but = known.but(&shape, readings[0].number);
        assert_eq!(but.readings(&shape, &shape.start()).len(), 1);
        let never = IDENTIFIED.replace("std_error", "fixed = []  # ");
        assert_eq!(Known::of(&self::model(&never)), None);
    }

    #[test]
    fn the_phase_of_what_repeats_in_time_says_when_a_log_was_started() {
        let waves = "[environment]\nlaw = \"kelvin_voigt\"\nstiffness = 1000.0\ndamping = 3.0\n\
            [[effect]]\nid = \"periodic_disturbance\"\namplitude = 0.1\nfrequency = 9.0\nphase = 1.0\n\
            [[effect]]\nid = \"surface_motion\"\namplitude = 1e-4\nfrequency = 0.3\nphase = 1.0\n\
            [[effect]]\nid = \"cogging\"\namplitude = 0.1\npitch = 1e-3\nphase = 1.0\n";
        let numbers = numbers(&model(waves));
        let is_of_the_start = |name: &str| {
            let own = numbers.iter().find(|number| number.name == name);
            own.unwrap().is_of_the_start()
        };
        assert!(is_of_the_start("periodic_disturbance.phase"));
        assert!(is_of_the_start("surface_motion.phase"));
        assert!(!is_of_the_start("periodic_disturbance.amplitude"));
        assert!(!is_of_the_start("cogging.phase") && !is_of_the_start("stiffness"));
    }

    #[test]
    fn a_number_that_is_known_and_seen_comes_out_between() {
        let law = &IDENTIFIED[..IDENTIFIED.find("[[").unwrap()];
        let model = model(&format!("{law}fixed = [\"damping\", \"surface\"]\n"));
        let logs = pressed();
        let shape = shape(&model, &logs);
        let stiffness = |known: Option<&Known>, weight: f64| {
            let weights = vec![weight; 500];
            let problem = Problem {
                logs: &logs,
                weights: &weights,
                low_pass: None,
                known,
            };
            let fit = problem.fit(&shape, shape.start());
            shape.environment_at(&fit.numbers)[0]
        };
        let known = Known::of(&model).unwrap();
        // With 1 mN each the samples say it, with 100 N what is known. With 0.33 N either says as much: 250 samples of
        // 0.6 N² on average are worth 1360, and 2.7 % are worth 1380.
        let free = stiffness(None, 1e6);
        let sharp = stiffness(Some(&known), 1e6);
        assert!((sharp / free - 1.0).abs() < 1e-4, "{sharp} {free}");
        let blunt = stiffness(Some(&known), 1e-4);
        assert!((blunt / 1000.0 - 1.0).abs() < 1e-3, "{blunt}");
        let both = stiffness(Some(&known), 9.0);
        assert!((1030.0..1070.0).contains(&both), "{both} {free}");
    }
}
