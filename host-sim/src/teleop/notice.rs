//! What a person would notice: the measures of a run against thresholds of perception.

use super::measure::Measures;
use super::trace::Trace;

/// A threshold of perception.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Threshold {
    /// What is compared.
    pub what: &'static str,
    /// From where on people notice.
    pub from: f64,
    /// Unit of the value.
    pub unit: &'static str,
    /// Where the number comes from.
    pub source: &'static str,
}

/// A delay of a spring's force is noticed from here on.
pub const SPRING_DELAY: Threshold = Threshold {
    what: "delay of the force",
    from: 0.036,
    unit: "s",
    source: "a spring's force that lags by 36 ms is noticed, a damper's by 15 ms",
};
/// A change of stiffness is noticed from here on.
pub const STIFFNESS: Threshold = Threshold {
    what: "error of the felt stiffness",
    from: 0.15,
    unit: "1",
    source: "Weber's fraction of stiffness is about 15 %",
};
/// A change of a force is noticed from here on.
pub const FORCE: Threshold = Threshold {
    what: "error of the felt force",
    from: 0.07,
    unit: "1",
    source: "Weber's fraction of force is about 7 %; 5 % is below what people feel",
};

/// A measure against its threshold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Notice {
    /// The threshold.
    pub threshold: Threshold,
    /// The value; `None`: there is none.
    pub value: Option<f64>,
}

impl Notice {
    /// Whether a person notices; a value that is missing is noticed: nothing was felt as it should be.
    pub fn is_noticed(&self) -> bool {
        self.value
            .is_none_or(|value| value.abs() >= self.threshold.from)
    }
}

/// Everything that is compared.
pub fn notices(trace: &Trace, measures: &Measures) -> [Notice; 3] {
    let notice = |threshold, value| Notice { threshold, value };
    [
        notice(SPRING_DELAY, lag_s(trace)),
        notice(STIFFNESS, measures.felt_stiffness_error),
        notice(FORCE, measures.felt_force_rmse_share),
    ]
}

/// Step of the search for the lag (s), and the longest (s).
const LAG_STEP_S: f64 = 2e-3;
const LONGEST_LAG_S: f64 = 6.0;

/// By how much the felt force lags behind the true one over the first material (s): the first lag at which
/// the square of their difference is nearly the least. `None` without a contact.
pub fn lag_s(trace: &Trace) -> Option<f64> {
    let end_s = trace.changed_s.unwrap_or(f64::INFINITY);
    let settled = super::measure::felt::scored(trace);
    let first = settled.iter().position(|scored| *scored)?;
    let from_s = trace.rows.get(first)?.time_s;
    let every = (LAG_STEP_S / trace.period_s).round().max(1.0) as usize;
    let rows = trace.between(from_s, end_s);
    let felt: Vec<f64> = rows.iter().step_by(every).map(|row| row.felt_n).collect();
    let real: Vec<f64> = rows.iter().step_by(every).map(|row| row.true_n).collect();
    let longest = ((LONGEST_LAG_S / LAG_STEP_S) as usize).min(felt.len() / 2);
    let error = |lag: usize| {
        let pairs = felt[lag..].iter().zip(&real);
        pairs.map(|(felt, real)| (felt - real).powi(2)).sum::<f64>() / (felt.len() - lag) as f64
    };
    let errors: Vec<f64> = (0..longest).map(error).collect();
    // A palpation repeats itself, and so does its error: the first lag that is nearly as good as the best.
    let power = real.iter().map(|real| real * real).sum::<f64>() / real.len() as f64;
    let good = 1.1 * crate::stats::lowest(errors.iter().copied()) + 2e-3 * power;
    let first = errors.iter().position(|error| *error <= good)?;
    Some(first as f64 * LAG_STEP_S)
}
