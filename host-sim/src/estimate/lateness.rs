//! How late the force is read against the position.

use estimator_core::estimate::Estimated;

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
    /// Whether the force is smoothed as by a lag of first order, rather than only delayed.
    pub is_lag: bool,
}

impl Lateness {
    /// Reason to doubt parameters that were estimated without it, if it is significant and matters.
    pub fn reason(&self) -> Option<Reason> {
        let late_s = self.late_s.value.abs();
        let counts = late_s > MATERIAL_S.max(SIGNIFICANT * self.late_s.std_error);
        counts.then_some(match self.is_lag {
            true => Reason::Lag,
            false => Reason::Skew,
        })
    }

    /// A sentence for people, where it counts.
    pub(super) fn sentence(&self) -> Option<String> {
        let late = Measured::new(self.late_s.value.abs(), Some(self.late_s.std_error), "s");
        Some(match self.reason()? {
            Reason::Lag => format!(
                "the force lags behind the contact with a time constant of {late}: a filter or a soft load \
                 cell; the damping carries that in part"
            ),
            _ => format!(
                "the force is read {late} {} than the position, and the damping carries that in part: \
                 --method skew estimates with it",
                if self.late_s.value > 0.0 {
                    "later"
                } else {
                    "earlier"
                }
            ),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn late(value: f64, std_error: f64) -> Lateness {
        Lateness {
            late_s: Estimated { value, std_error },
            is_lag: false,
        }
    }

    #[test]
    fn a_lateness_counts_where_it_is_significant_and_material() {
        assert_eq!(late(4e-4, 2e-5).reason(), Some(Reason::Skew));
        assert_eq!(late(-4e-4, 2e-5).reason(), Some(Reason::Skew));
        assert_eq!(late(4e-4, 2e-4).reason(), None);
        assert_eq!(late(4e-5, 1e-6).reason(), None);
    }
}
