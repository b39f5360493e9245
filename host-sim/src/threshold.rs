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
    pub name: &'static str,
    /// Why it is there, and how its value was found.
    pub reason: &'static str,
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
        let names: Vec<&'static str> = all.iter().map(|threshold| threshold.name).collect();
        let Some(found) = all.iter_mut().find(|threshold| threshold.name == name) else {
            return Err(unknown(name, &names));
        };
        *found.value = found.origin + factor * (*found.value - found.origin);
        Ok(())
    }
}

/// A name without a decision is compared with the fields alone; the note lists the decision of the nearest.
fn unknown(name: &str, names: &[&'static str]) -> Diagnostic {
    let compared = |own: &&'static str| match own.split_once('.') {
        Some((_, field)) if !name.contains('.') => field,
        _ => own,
    };
    let near = nearest(name, names.iter().map(compared));
    let near = near.and_then(|near| names.iter().find(|own| compared(own) == near));
    let decision = near.map_or("", |near| near.split('.').next().unwrap_or_default());
    let alike = names
        .iter()
        .copied()
        .filter(|own| own.starts_with(decision));
    Diagnostic::new(format!("no threshold is called `{name}`"))
        .note(format!("near it are {}", listed(alike)))
        .remedy(near.map_or("name one of them".into(), |near| {
            format!("write \"{near}\"")
        }))
}

/// Declares the thresholds of a workflow, `Thresholds { decision: Decision { name: value, … } … }`.
macro_rules! thresholds {
    ($(#[doc = $whole:literal])+ $all:ident { $(
        $(#[doc = $what:literal])+
        $room:ident: $decision:ident { $(
            $(#[doc = $reason:literal])+
            $name:ident: $value:literal $(over $origin:literal)?,
        )+ }
    )+ }) => {
        $(#[doc = $whole])+
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        pub struct $all { $($(#[doc = $what])+ pub $room: $decision,)+ }
        impl $crate::threshold::Adjustable for $all {
            fn all(&mut self) -> Vec<$crate::threshold::Threshold<'_>> {
                vec![$($($crate::threshold::Threshold {
                    name: concat!(stringify!($room), ".", stringify!($name)),
                    reason: concat!($($reason),+).trim(),
                    value: &mut self.$room.$name,
                    origin: 0.0 $(+ $origin)?,
                },)+)+]
            }
        }
        $(
            $(#[doc = $what])+
            #[derive(Clone, Copy, Debug, PartialEq)]
            pub struct $decision { $($(#[doc = $reason])+ pub $name: f64,)+ }
            impl Default for $decision {
                fn default() -> Self {
                    $decision { $($name: $value,)+ }
                }
            }
        )+
    };
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
        /// All of them.
        Both {
            /// Whether there is a signal.
            signal: Signal {
                /// Below it there is noise alone:
                /// measured on nothing.
                ratio: 1.2 over 1.0,
                /// Fewer samples say nothing.
                fewest_samples: 16.0,
            }
            /// Whether there is another one.
            other: Other {
                /// Below it there is none.
                prominence: 1.2 over 1.0,
            }
        }
    }

    #[test]
    fn a_threshold_has_the_name_the_reason_and_the_value_of_its_field() {
        let mut both = Both::default();
        let all = both.all();
        let names: Vec<&str> = all.iter().map(|t| t.name).collect();
        let expected = ["signal.ratio", "signal.fewest_samples", "other.prominence"];
        assert_eq!(names, expected);
        assert_eq!(
            all[0].reason,
            "Below it there is noise alone: measured on nothing."
        );
        assert_eq!(
            (*all[1].value, all[1].origin, all[2].origin),
            (16.0, 0.0, 1.0)
        );
    }

    #[test]
    fn a_factor_counts_from_the_origin_and_changes_no_other() {
        let mut both = Both::default();
        both.set("other.prominence", 1.5).unwrap();
        both.set("signal.fewest_samples", 0.75).unwrap();
        assert!((both.other.prominence - 1.3).abs() < 1e-12);
        assert_eq!((both.signal.ratio, both.signal.fewest_samples), (1.2, 12.0));
    }

    #[test]
    fn an_unknown_name_is_answered_with_the_nearest_ones() {
        let mut both = Both::default();
        for (name, near) in [
            ("signal.ratoi", "\"signal.ratio\""),
            ("prominance", "\"other.prominence\""),
        ] {
            let error = both.set(name, 2.0).unwrap_err().to_string();
            assert!(error.contains(name) && error.contains(near), "{error}");
        }
        let error = both.set("colour", 2.0).unwrap_err().to_string();
        assert!(error.contains("`signal.fewest_samples`"), "{error}");
        assert_eq!(both, Both::default());
    }
}
