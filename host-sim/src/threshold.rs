//! Thresholds as data: numbers that decide, one struct for each decision, each number with its reason.
//!
//! [`thresholds!`](thresholds) makes all that a threshold needs from one place: the field, its
//! documentation, its default, and its name. A threshold without a reason, or one that a sweep cannot
//! reach by its name, does not compile.
//!
//! A threshold is changed by a factor. `over` says from where the factor counts where that is not 0: a
//! residual of 1.12 times the noise means 0.12 more than noise alone, and half more of that is 1.18.

use crate::diagnostic::{Diagnostic, listed, nearest};

/// A threshold of a workflow.
#[derive(Debug)]
pub struct Threshold<'a> {
    /// As a sweep calls it: the decision, a dot, the field.
    pub name: String,
    /// Why it is there, and how its value was found.
    pub reason: String,
    /// Its value.
    pub value: &'a mut f64,
    /// The value from which a factor counts.
    pub origin: f64,
}

/// Thresholds that can be reached by name.
pub trait Adjustable: Default {
    /// Each of them, in the order of their documentation.
    fn all(&mut self) -> Vec<Threshold<'_>>;

    /// Multiplies what one of them has over its origin.
    ///
    /// # Errors
    /// No threshold has this name.
    fn set(&mut self, name: &str, factor: f64) -> Result<(), Diagnostic> {
        let mut all = self.all();
        match all.iter_mut().find(|threshold| threshold.name == name) {
            Some(Threshold { value, origin, .. }) => {
                **value = *origin + factor * (**value - *origin)
            }
            None => return Err(unknown(name, &all)),
        }
        Ok(())
    }
}

fn unknown(name: &str, all: &[Threshold]) -> Diagnostic {
    fn last(name: &str) -> &str {
        name.rsplit('.').next().unwrap_or_default()
    }
    let names = || all.iter().map(|threshold| threshold.name.as_str());
    let near = nearest(name, names()).or(names().find(|own| last(own) == last(name)));
    let diagnostic = Diagnostic::new(format!("no threshold is called `{name}`"))
        .note(format!("the thresholds are {}", listed(names())));
    match near {
        Some(near) => diagnostic.remedy(format!("write \"{near}\"")),
        None => diagnostic.remedy("name one of them"),
    }
}

/// Declares decisions, `Decision { name: value, … } …`, or gathers them to the thresholds of a workflow,
/// `Thresholds of { name: Decision, … }`.
macro_rules! thresholds {
    ($(#[doc = $what:literal])+ $all:ident of { $($name:ident: $decision:ident,)+ }) => {
        $(#[doc = $what])+
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        pub struct $all { $(
            #[doc = concat!("See [`", stringify!($decision), "`].")]
            pub $name: $decision,
        )+ }
        impl $crate::threshold::Adjustable for $all {
            fn all(&mut self) -> Vec<$crate::threshold::Threshold<'_>> {
                let mut all = Vec::new();
                $(for mut threshold in $crate::threshold::Adjustable::all(&mut self.$name) {
                    threshold.name = format!("{}.{}", stringify!($name), threshold.name);
                    all.push(threshold);
                })+
                all
            }
        }
    };
    ($($(#[doc = $what:literal])+ $decision:ident { $(
        $(#[doc = $reason:literal])+
        $name:ident: $value:literal $(over $origin:literal)?,
    )+ })+) => { $(
        $(#[doc = $what])+
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct $decision { $($(#[doc = $reason])+ pub $name: f64,)+ }
        impl Default for $decision {
            fn default() -> Self {
                $decision { $($name: $value,)+ }
            }
        }
        impl $crate::threshold::Adjustable for $decision {
            fn all(&mut self) -> Vec<$crate::threshold::Threshold<'_>> {
                vec![$($crate::threshold::Threshold {
                    name: stringify!($name).into(),
                    reason: concat!($($reason),+).trim().into(),
                    value: &mut self.$name,
                    origin: 0.0 $(+ $origin)?,
                },)+]
            }
        }
    )+ };
}
pub(crate) use thresholds;

#[cfg(test)]
#[allow(
    unreachable_pub,
    reason = "thresholds are public; those of the tests have nobody to reach them"
)]
mod tests {
    use super::*;

    thresholds! {
        /// Whether there is a signal.
        Signal {
            /// Below it there is noise alone:
            /// measured on nothing.
            ratio: 1.2 over 1.0,
            /// Fewer samples say nothing.
            fewest_samples: 16.0,
        }
    }
    thresholds! {
        /// All of them.
        Both of { signal: Signal, other: Signal, }
    }

    #[test]
    fn a_threshold_has_the_name_the_reason_and_the_value_of_its_field() {
        let mut both = Both::default();
        let all = both.all();
        let names: Vec<&str> = all.iter().map(|t| t.name.as_str()).collect();
        let expected = ["signal.ratio", "signal.fewest_samples", "other.ratio"];
        assert_eq!(names[..3], expected);
        assert_eq!(
            all[0].reason,
            "Below it there is noise alone: measured on nothing."
        );
        assert_eq!((*all[1].value, all.len()), (16.0, 4));
    }

    #[test]
    fn a_factor_counts_from_the_origin_and_changes_no_other() {
        let mut both = Both::default();
        both.set("other.ratio", 1.5).unwrap();
        both.set("signal.fewest_samples", 0.75).unwrap();
        assert!((both.other.ratio - 1.3).abs() < 1e-12);
        assert_eq!((both.signal.ratio, both.signal.fewest_samples), (1.2, 12.0));
    }

    #[test]
    fn an_unknown_name_is_answered_with_the_nearest_ones() {
        let mut both = Both::default();
        for (name, near) in [("signal.ratoi", "signal.ratio"), ("ratio", "other.ratio")] {
            let error = both.set(name, 2.0).unwrap_err().to_string();
            assert!(error.contains(name) && error.contains(near), "{error}");
        }
        let error = both.set("colour", 2.0).unwrap_err().to_string();
        assert!(error.contains("other.fewest_samples"), "{error}");
        assert_eq!(both, Both::default());
    }
}
