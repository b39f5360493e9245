//! How late the force is read against the position.

use estimator_core::estimate::Estimated;
use estimator_core::physics::law::LawId;

use super::reason::Reason;
use crate::number::Measured;

/// A lateness is significant beyond this many of its standard errors.
const SIGNIFICANT: f64 = 3.0;
/// It matters beyond this (s): 50 µs change the damping of a stiff plastic by 1.5 to 3 %, as 1 ms changes it
/// by 27 to 53 %.
const MATERIAL_S: f64 = 50e-6;

/// How late the force is read against the position, estimated together with the parameters of the law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lateness {
    /// Delay of the force (s); negative where it is early.
    pub late_s: Estimated<f64>,
    /// In which way it is late.
    pub form: Form,
}

/// In which way a force is late.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// It is read later (or earlier) than the position, and otherwise the same.
    Delay,
    /// It follows with a time constant, smoothed as by a filter of first order.
    Lag,
    /// The motion is too slow to tell the two apart.
    Either,
}

impl Lateness {
    /// Reason to doubt parameters that were estimated without it, if it is significant and matters.
    pub fn reason(&self) -> Option<Reason> {
        let late_s = self.late_s.value.abs();
        let counts = late_s > MATERIAL_S.max(SIGNIFICANT * self.late_s.std_error);
        counts.then_some(match self.form {
            Form::Lag => Reason::Lag,
            Form::Delay | Form::Either => Reason::Skew,
        })
    }

    /// A sentence for people, where it counts, beside the parameters of a law.
    pub(super) fn sentence(&self, law: LawId) -> Option<String> {
        let late = Measured::new(self.late_s.value.abs(), Some(self.late_s.std_error), "s");
        self.reason()?;
        let when = match self.late_s.value > 0.0 {
            true => "later",
            false => "earlier",
        };
        let carrier = carrier(law);
        let method = match law {
            LawId::HuntCrossley => "skew",
            _ => "batch",
        };
        let remedy = format!("{carrier} carries that in part: --method {method} estimates with it");
        Some(match self.form {
            Form::Lag => format!(
                "the force lags behind the contact with a time constant of {late}: a filter or a soft load \
                 cell; {carrier} carries that in part"
            ),
            Form::Delay => {
                format!("the force is read {late} {when} than the position, and {remedy}")
            }
            Form::Either => format!(
                "the force comes {late} late: it is read later than the position, or lags behind the contact by \
                 that time constant, which this motion does not tell apart; {remedy}"
            ),
        })
    }
}

/// What of a law carries a lateness that is not among its parameters, in words.
pub(crate) fn carrier(law: LawId) -> &'static str {
    match law {
        LawId::QuasiLinear => "the relaxation",
        _ => "the damping",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn late(value: f64, std_error: f64) -> Lateness {
        Lateness {
            late_s: Estimated { value, std_error },
            form: Form::Delay,
        }
    }

    #[test]
    fn what_the_motion_does_not_tell_apart_is_said_to_be_either() {
        let said = |form| {
            let late = Lateness {
                form,
                ..late(4e-4, 2e-5)
            };
            (
                late.reason(),
                late.sentence(LawId::HuntCrossley).expect("it counts"),
            )
        };
        let (reason, either) = said(Form::Either);
        assert_eq!(reason, Some(Reason::Skew));
        assert!(either.contains("does not tell apart"), "{either}");
        let (reason, lag) = said(Form::Lag);
        assert_eq!(reason, Some(Reason::Lag));
        assert!(
            lag.contains("time constant") && !lag.contains("apart"),
            "{lag}"
        );
        assert!(!said(Form::Delay).1.contains("lags"));
        // What a law has no method for, or no damping, is not spoken of.
        let relaxing = late(4e-4, 2e-5).sentence(LawId::QuasiLinear).unwrap();
        assert!(
            relaxing
                .ends_with("the relaxation carries that in part: --method batch estimates with it"),
            "{relaxing}"
        );
    }

    #[test]
    fn a_lateness_counts_where_it_is_significant_and_material() {
        assert_eq!(late(4e-4, 2e-5).reason(), Some(Reason::Skew));
        assert_eq!(late(-4e-4, 2e-5).reason(), Some(Reason::Skew));
        assert_eq!(late(4e-4, 2e-4).reason(), None);
        assert_eq!(late(4e-5, 1e-6).reason(), None);
    }
}
