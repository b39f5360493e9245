//! What has changed on a rig since its model was identified.

use super::parameter::ParameterEstimate;
use crate::gap::model::known::{Number, numbers};
use crate::gap::thresholds::{Changes, Thresholds};
use crate::model::Model;
use crate::number::{Measured, quantity};

/// A parameter that another log gave another value.
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    /// Value and standard error in the model file.
    pub was: (f64, f64),
    /// The parameter as the present log has it.
    pub now: ParameterEstimate,
    /// Whether its effect does nothing any more.
    pub is_gone: bool,
}

/// What has changed since a model was identified.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ChangesSince {
    /// The numbers that are clearly others.
    pub counted: Vec<Change>,
    /// The number that is certainly another, and by the largest share too small to count: records of one rig differ as much.
    pub little: Option<Change>,
    /// The number that is off by enough and by the most standard errors too few to count.
    pub likely: Option<Change>,
}

/// From so many standard errors of the difference a number is likely to be another: a stiffness that had grown by 20 % was
/// 4.6 away, since the model's own error was 3 %, and "nothing has changed" kept it back.
const LIKELY_SIGMAS: f64 = 3.0;

/// What is larger by this share is said by how many times.
const TENFOLD: f64 = 9.0;

impl Change {
    /// How much larger its magnitude is, as a share of what it was.
    pub fn share(&self) -> f64 {
        (self.now.value - self.was.0) / self.was.0
    }

    fn in_words(&self) -> String {
        let Change { was, now, .. } = self;
        if let Some(effect) = effect_of(&now.name).filter(|_| self.is_gone) {
            return format!(
                "{effect} is gone: {} is {}, and was {}",
                now.name,
                Measured::new(now.value, now.std_error, now.unit),
                Measured::new(was.0, Some(was.1), now.unit),
            );
        }
        let share = self.share();
        let percent = match 100.0 * share.abs() {
            percent if percent < 9.95 => format!("{percent:.1}"),
            percent => format!("{percent:.0}"),
        };
        let how = match share {
            _ if self.has_no_size() => {
                let by = quantity(now.value - was.0, 2, now.unit);
                format!("is another than in the model, by {by}")
            }
            TENFOLD.. => format!("is {:.0} times as large as in the model", 1.0 + share),
            ..-1.0 => "has another sign than in the model".into(),
            ..0.0 => format!("is {percent} % smaller than in the model"),
            _ => format!("is {percent} % larger than in the model"),
        };
        format!(
            "{} {how}: {}, was {} ({:.0} standard errors)",
            now.name,
            Measured::new(now.value, now.std_error, now.unit),
            Measured::new(was.0, Some(was.1), now.unit),
            self.std_errors(),
        )
    }

    /// Whether its zero is where somebody put it, so that a share of it says nothing: a phase of 0.0017 rad was 5250 % larger.
    fn has_no_size(&self) -> bool {
        self.now.name.ends_with(".phase")
    }

    /// By how many standard errors of the difference it is another.
    pub fn std_errors(&self) -> f64 {
        let now = self.now.std_error.unwrap_or(0.0);
        (self.now.value - self.was.0).abs() / self.was.1.hypot(now)
    }
}

/// The parameters that an identified model knows with a standard error and that a refit, `now`, gives another
/// value; `None` where the model was never identified. A parameter that was fixed, or is at a bound, says
/// nothing.
pub(crate) fn changes(
    model: &Model,
    now: &[ParameterEstimate],
    decide: &Changes,
) -> Option<ChangesSince> {
    let known = numbers(model);
    let of_the_rig = known.iter().enumerate();
    let of_the_rig = of_the_rig.filter(|(_, number)| !number.is_of_the_start());
    let changes = of_the_rig.filter_map(|(at, number)| {
        // Modes of a spectrum share their names, and stand in the order of the model.
        let is_same = |other: &&Number| other.name == number.name;
        let earlier = known[..at].iter().filter(is_same).count();
        let mut now = now.iter().filter(|now| now.name == number.name);
        let now = now.nth(earlier)?;
        now.std_error?;
        Some(Change {
            was: (number.value, number.std_error?),
            now: now.clone(),
            is_gone: false,
        })
    });
    // What an effect does is shared among its numbers: one means little beside another that is at its bound.
    let beside_a_bound = |name: &str| {
        let own = effect_of(name);
        own.is_some()
            && now
                .iter()
                .any(|other| other.at_bound && effect_of(&other.name) == own)
    };
    let is_identified = known.iter().any(|number| number.std_error.is_some());
    is_identified.then(|| {
        let judged = changes.filter(|change| !beside_a_bound(&change.now.name));
        let (certain, uncertain): (Vec<Change>, Vec<Change>) =
            judged.partition(|change| change.std_errors() > decide.sigmas);
        let is_large = |change: &Change| change.share().abs() > decide.share;
        let (counted, little): (Vec<Change>, Vec<Change>) = certain.into_iter().partition(is_large);
        let likely = uncertain.into_iter().filter(is_large);
        let likely = likely.filter(|change| change.std_errors() >= LIKELY_SIGMAS);
        let by_share = |a: &Change, b: &Change| a.share().abs().total_cmp(&b.share().abs());
        let by_errors = |a: &Change, b: &Change| a.std_errors().total_cmp(&b.std_errors());
        ChangesSince {
            counted,
            little: little.into_iter().max_by(by_share),
            likely: likely.max_by(by_errors),
        }
    })
}

impl ChangesSince {
    /// With what is gone, before what is another; the other numbers of an effect that is gone mean nothing.
    pub(crate) fn with_gone(mut self, gone: Vec<Change>) -> ChangesSince {
        let is_kept = |own: &Change| {
            let effect = effect_of(&own.now.name);
            effect.is_none()
                || gone
                    .iter()
                    .all(|other| effect_of(&other.now.name) != effect)
        };
        self.counted.retain(is_kept);
        self.little = self.little.filter(is_kept);
        self.likely = self.likely.filter(is_kept);
        self.counted.splice(0..0, gone);
        self
    }
}

/// The effect that a number is of; `None` for one of the law.
fn effect_of(name: &str) -> Option<&str> {
    name.split_once('.').map(|(effect, _)| effect)
}

/// What has changed since the base model was identified, a sentence each; nothing where it never was.
pub fn changes_in_words(changed: Option<&ChangesSince>) -> Vec<String> {
    let Some(ChangesSince {
        counted,
        little,
        likely,
    }) = changed
    else {
        return Vec::new();
    };
    let likely = likely
        .iter()
        .map(|likely| format!("perhaps {}", likely.in_words()));
    if counted.is_empty() {
        let rule = Thresholds::default().changes;
        let nothing = format!(
            "nothing: no number is another than in the model by more than {:.0} % of it and {} standard errors",
            100.0 * rule.share,
            rule.sigmas
        );
        let nothing = match little {
            Some(little) => format!("{nothing}; by less {}", little.in_words()),
            None => nothing,
        };
        return std::iter::once(nothing).chain(likely).collect();
    }
    counted.iter().map(Change::in_words).chain(likely).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::toml_reader::TomlFile;
    use std::path::Path;

    /// A drive that was identified: a friction of 20.5 ± 0.15 N, a drag of which no error is known.
    fn identified() -> Model {
        let toml = "[environment]\nlaw = \"free\"\n\
            [[effect]]\nid = \"coulomb_friction\"\nforce = 20.5\nstd_error = { force = 0.15 }\n\
            [[effect]]\nid = \"viscous_drag\"\ncoefficient = 203.0\n";
        let path = Path::new("model.toml");
        Model::from_toml(&TomlFile::parse(toml.into(), path).unwrap(), path).unwrap()
    }

    fn friction(value: f64, std_error: Option<f64>) -> ParameterEstimate {
        ParameterEstimate {
            name: "coulomb_friction.force".into(),
            value,
            std_error,
            at_bound: false,
            unit: "N",
        }
    }

    fn changed(model: &Model, now: ParameterEstimate) -> Option<usize> {
        let decide = Thresholds::default().changes;
        changes(model, &[now], &decide).map(|changes| changes.counted.len())
    }

    #[test]
    fn a_number_has_changed_if_it_is_off_by_its_errors_and_by_more_than_a_record_differs() {
        let model = identified();
        assert_eq!(changed(&model, friction(26.0, Some(0.14))), Some(1));
        // Half a newton is three standard errors and 2.4 %, as another record of the same drive has it.
        assert_eq!(changed(&model, friction(21.0, Some(0.1))), Some(0));
        // As much more with an error of 3 N, or where it is not free, is nothing.
        assert_eq!(changed(&model, friction(26.0, Some(3.0))), Some(0));
        assert_eq!(changed(&model, friction(26.0, None)), Some(0));
    }

    #[test]
    fn modes_that_share_a_name_are_compared_each_with_its_own() {
        let toml = "[environment]\nlaw = \"kelvin_voigt\"\nstiffness = 1.0\ndamping = 0.1\n"
            .to_string()
            + &mode(0.579, 94.0, "std_error = { fraction = 0.015 }\n")
            + &mode(0.2, 20.0, "")
            + &mode(0.091, 5.3, "std_error = { fraction = 0.008 }\n");
        let path = Path::new("model.toml");
        let model = Model::from_toml(&TomlFile::parse(toml, path).unwrap(), path).unwrap();
        let now = [0.57, 0.2, 0.16].map(|value| ParameterEstimate {
            name: "stress_relaxation.fraction".into(),
            unit: "",
            ..friction(value, Some(0.01))
        });
        let changes = changes(&model, &now, &Thresholds::default().changes)
            .unwrap()
            .counted;
        assert_eq!(changes.len(), 1);
        assert_eq!((changes[0].was.0, changes[0].now.value), (0.091, 0.16));
    }

    fn mode(fraction: f64, rate: f64, error: &str) -> String {
        format!(
            "[[effect]]\nid = \"stress_relaxation\"\nfraction = {fraction}\nrate = {rate}\n{error}"
        )
    }

    #[test]
    fn a_model_that_was_never_identified_has_not_changed() {
        let mut model = identified();
        model.effects[0].fit.std_error.clear();
        assert_eq!(changed(&model, friction(26.0, Some(0.14))), None);
    }

    #[test]
    fn nothing_that_has_changed_says_what_would_have_counted() {
        let words = changes_in_words(Some(&ChangesSince::default()));
        assert!(
            words[0].ends_with("more than 5 % of it and 5 standard errors"),
            "{words:?}"
        );
        // AND what is certain though it does not count.
        let little = Change {
            was: (400.0, 0.25),
            now: friction(380.0, Some(0.27)),
            is_gone: false,
        };
        let words = changes_in_words(Some(&ChangesSince {
            little: Some(little),
            ..ChangesSince::default()
        }));
        assert!(
            words[0]
                .contains("; by less coulomb_friction.force is 5.0 % smaller than in the model"),
            "{words:?}"
        );
    }

    #[test]
    fn a_number_that_is_off_by_hardly_enough_errors_is_said_and_not_counted() {
        let model = identified();
        let decide = Thresholds::default().changes;
        let likely = |now: ParameterEstimate| {
            let changes = changes(&model, &[now], &decide).unwrap();
            assert_eq!(changes.counted, []);
            changes_in_words(Some(&changes)).pop().unwrap()
        };
        // GIVEN a friction of 20.5 ± 0.15 N that is 24 ± 0.9 N now: 3.8 standard errors
        assert_eq!(
            likely(friction(24.0, Some(0.9))),
            "perhaps coulomb_friction.force is 17 % larger than in the model: 24.0 ± 0.9\u{a0}N, was 20.50 ± 0.15\u{a0}N \
             (4 standard errors)"
        );
        // AND with an error of 1.3 N, 2.7 standard errors, nothing is said.
        assert!(likely(friction(24.0, Some(1.3))).starts_with("nothing: "));
    }

    #[test]
    fn a_phase_is_another_by_an_angle_and_what_is_tenfold_by_so_many_times() {
        let said = |name: &str, unit: &'static str, was: f64, now: f64| {
            let change = Change {
                was: (was, 0.001),
                now: ParameterEstimate {
                    name: name.into(),
                    unit,
                    ..friction(now, Some(0.0025))
                },
                is_gone: false,
            };
            change.in_words()
        };
        let phase = said("gravity_torque.phase", "rad", 0.0017, 0.0908);
        assert!(phase.contains("by 0.089\u{a0}rad: "), "{phase}");
        let beta = said("bouc_wen.beta", "1/m^ν", 113.0, 1960.0);
        assert!(
            beta.contains("is 17 times as large as in the model"),
            "{beta}"
        );
    }

    #[test]
    fn a_number_beside_one_at_its_bound_has_not_changed() {
        let model = identified();
        let other = |at_bound: bool| ParameterEstimate {
            name: "coulomb_friction.width".into(),
            at_bound,
            ..friction(1e-3, None)
        };
        let changed = |at_bound: bool| {
            let now = [friction(26.0, Some(0.14)), other(at_bound)];
            let changes = changes(&model, &now, &Thresholds::default().changes);
            changes.unwrap().counted.len()
        };
        assert_eq!((changed(false), changed(true)), (1, 0));
    }

    #[test]
    fn a_change_is_a_share_of_what_it_was_in_errors_of_the_difference() {
        let change = Change {
            was: (-40.0, 0.3),
            now: friction(-50.0, Some(0.4)),
            is_gone: false,
        };
        assert_eq!((change.share(), change.std_errors()), (0.25, 20.0));
    }

    #[test]
    fn of_an_effect_that_is_gone_no_other_number_counts() {
        let change = |now: ParameterEstimate, is_gone: bool| Change {
            was: (20.5, 0.15),
            now,
            is_gone,
        };
        let all = ChangesSince {
            counted: vec![change(friction(0.1, Some(0.2)), false)],
            little: None,
            likely: Some(change(friction(0.1, Some(0.2)), false)),
        };
        let gone = change(friction(0.0, None), true);
        let all = all.with_gone(vec![gone.clone()]);
        assert_eq!((&all.counted, &all.likely), (&vec![gone], &None));
        assert_eq!(
            changes_in_words(Some(&all)),
            [
                "coulomb_friction is gone: coulomb_friction.force is 0\u{a0}N, and was 20.50 ± 0.15\u{a0}N"
            ]
        );
    }
}
