//! What a person would notice: the measures of a run against thresholds of perception.

use super::measure::Measures;
use super::measure::felt::NotCompared;
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
    /// The value; `None`: it was not determined.
    pub value: Option<f64>,
    /// Whether a person notices; `None`: that cannot be told.
    pub is_noticed: Option<bool>,
}

/// Everything that is compared.
pub fn notices(trace: &Trace, measures: &Measures) -> [Notice; 3] {
    let notice = |threshold: Threshold, value: Option<f64>| Notice {
        threshold,
        value,
        is_noticed: value.map(|value| value.abs() >= threshold.from),
    };
    // No force where there should be one, and a force where there should be none, are felt.
    let is_wrong = match measures.felt_force_not_compared {
        Some(NotCompared::NoForce | NotCompared::NotInside) => true,
        Some(NotCompared::NotReady) | None => false,
    };
    let force = notice(FORCE, measures.felt_force_rmse_share);
    [
        notice(SPRING_DELAY, lag_s(trace)),
        notice(STIFFNESS, measures.felt_stiffness_error),
        Notice {
            is_noticed: force.is_noticed.or(is_wrong.then_some(true)),
            ..force
        },
    ]
}

/// Step of the search for the lag (s).
const LAG_STEP_S: f64 = 2e-3;
/// The share of half a palpation that is searched either way: beyond it the next palpation is as near. 5 % are left.
const LONGEST: f64 = 0.95;
/// The correlation below which no lag is determined: half of the variance of the felt force is then something else.
/// Derived: √0.5.
const LEAST_CORRELATION: f64 = 0.707;
/// Lags whose correlation is within this of the best are as good: noise of 20 mN on 1 N moves it by 0.0002. Not
/// measured.
const AS_GOOD: f64 = 1e-3;

/// By how much the felt force lags behind the true one over the first material (s), negative where it is ahead: the
/// lag within half a palpation at which they are most alike. `None`: there is no contact, they are not alike, or the
/// force comes from the slave and a whole palpation later would be as alike.
pub fn lag_s(trace: &Trace) -> Option<f64> {
    let end_s = trace.changed_s.unwrap_or(f64::INFINITY);
    let longest_s = LONGEST * trace.reversal_s()?;
    if !trace.scheme.reflects() && trace.round_trip_s() > longest_s {
        return None;
    }
    let settled = super::measure::felt::scored(trace);
    let first = settled.iter().position(|scored| *scored)?;
    let from_s = trace.rows.get(first)?.time_s;
    let every = (LAG_STEP_S / trace.period_s).round().max(1.0) as usize;
    let rows = trace.between(from_s, end_s);
    let felt: Vec<f64> = rows.iter().step_by(every).map(|row| row.felt_n).collect();
    let real: Vec<f64> = rows.iter().step_by(every).map(|row| row.true_n).collect();
    let longest = ((longest_s / LAG_STEP_S) as usize).min(felt.len() / 2);
    let later = (0..=longest).map(|lag| (lag as f64, alike(&felt[lag..], &real)));
    let ahead = (1..=longest).map(|lag| (-(lag as f64), alike(&felt, &real[lag..])));
    let each: Vec<(f64, f64)> = later.chain(ahead).collect();
    let best = crate::stats::highest(each.iter().map(|(_, alike)| *alike));
    let good = each.iter().filter(|(_, alike)| *alike > best - AS_GOOD);
    let nearest = good.min_by(|a, b| a.0.abs().total_cmp(&b.0.abs()))?;
    (best >= LEAST_CORRELATION).then_some(nearest.0 * LAG_STEP_S)
}

/// The correlation of two courses from their beginnings on; 0 where one of them does not change.
fn alike(a: &[f64], b: &[f64]) -> f64 {
    let count = a.len().min(b.len());
    let (a, b) = (&a[..count], &b[..count]);
    let mean = |values: &[f64]| values.iter().sum::<f64>() / count.max(1) as f64;
    let (of_a, of_b) = (mean(a), mean(b));
    let (mut ab, mut aa, mut bb) = (0.0, 0.0, 0.0);
    for (a, b) in a.iter().zip(b) {
        let (a, b) = (a - of_a, b - of_b);
        (ab, aa, bb) = (ab + a * b, aa + a * a, bb + b * b);
    }
    match aa * bb > 0.0 {
        true => ab / (aa * bb).sqrt(),
        false => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::teleop::environment::{Environment, Material};
    use crate::teleop::{Options, Row, SchemeId, System};

    /// A palpation of 1.25 s whose felt force comes so much later (s) than the true one.
    fn lagging(lag_s: f64, scheme: SchemeId) -> Trace {
        let options = Options::default().with_scheme(scheme).with_task_for_delay();
        let mut trace = Trace::with_capacity(0, &options);
        let force =
            |time_s: f64| (1.0 - (std::f64::consts::TAU * 0.8 * time_s).cos()).max(0.7) - 0.7;
        for tick in 0..9000 {
            let time_s = 1e-3 * f64::from(tick);
            trace.push(Row {
                time_s,
                felt_n: force(time_s - lag_s),
                true_n: force(time_s),
                heard: true,
                ..Row::default()
            });
        }
        trace
    }

    #[test]
    fn a_lag_is_found_either_way_and_never_that_of_the_next_palpation() {
        for exact_s in [-0.3, -0.05, 0.0, 0.05, 0.3] {
            let found_s = lag_s(&lagging(exact_s, SchemeId::Reflection)).unwrap();
            assert!((found_s - exact_s).abs() < 0.02, "{found_s} for {exact_s}");
        }
    }

    #[test]
    fn wave_variables_across_300_ms_do_not_lag_by_a_palpation_and_across_2_s_it_is_not_determined()
    {
        let run = |delay_s: f64| {
            let mut options = Options::default().with_scheme(SchemeId::WaveVariables);
            options.environment = Environment::throughout(Material::linear(1000.0, 5.0));
            let options = options
                .with_channel(delay_s, 0.0, 0.0)
                .with_task_for_delay();
            lag_s(&System::new(&options, 1).run())
        };
        assert!(
            run(0.15).is_none_or(|lag_s| lag_s.abs() < 0.6),
            "{:?}",
            run(0.15)
        );
        assert_eq!(run(1.0), None);
    }
}
