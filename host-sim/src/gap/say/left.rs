//! What a fit leaves beyond the noise, in the whole log and in each phase of the contact.
//!
//! Held-out parts alone miss where it is most: a bond under a cantilever breaks once, and what the owner's model left
//! there was 5.8 nN on held-out parts, 22.8 nN in the whole log.

use crate::gap::noise::floor::NoiseFloor;
use crate::gap::noise::floors::largest_noise_n;
use crate::gap::say::log_residuals::LogResiduals;
use crate::model::Remainder;
use crate::phase::{PHASES, phases_of};

/// How many independent values of a phase the whole log is worth: few of its own say little of it. Not measured.
const OF_THE_WHOLE: f64 = 3.0;

/// How many samples there are, and the sum (N²) of what their squares are beyond the noise.
type Tally = (f64, f64);

/// What residuals are beyond the noise, with a value in each phase that the logs have; `None` where nothing is.
/// `correlation` samples are worth one independent one.
pub(crate) fn left(
    logs: &[LogResiduals<'_>],
    floors: &[NoiseFloor],
    correlation: f64,
) -> Option<Remainder> {
    let mut tallies: [Tally; PHASES.len()] = Default::default();
    for (log, floor) in logs.iter().zip(floors) {
        let phases = phases_of(log.depth_m, &log.log.speed_mps);
        let each = phases.into_iter().zip(log.residuals).zip(log.variances);
        for ((phase, residual), _) in each.filter(|(_, variance)| **variance > 0.0) {
            let (count, beyond_n2) = &mut tallies[phase];
            *count += 1.0;
            *beyond_n2 += residual.powi(2) - floor.noise_n().powi(2);
        }
    }
    let sum = |all: Tally, own: &Tally| (all.0 + own.0, all.1 + own.1);
    let (count, beyond_n2) = tallies.iter().fold((0.0, 0.0), sum);
    let all_n2 = beyond_n2 / f64::max(count, 1.0);
    let of_the_whole = OF_THE_WHOLE * correlation;
    let in_phase = |(count, beyond_n2): Tally| {
        let mean_n2 = (beyond_n2 + of_the_whole * all_n2) / (count + of_the_whole);
        (count > 0.0).then(|| mean_n2.max(0.0).sqrt())
    };
    let period_s = logs.first()?.log.period_s;
    (all_n2 > 0.0).then(|| Remainder {
        rms_n: all_n2.sqrt(),
        by_phase_n: tallies.map(in_phase),
        noise_n: Some(largest_noise_n(floors)),
        correlation_s: correlation * period_s,
        bandwidth_hz: None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gap::data::fit_data::FitData;
    use crate::gap::thresholds::Thresholds;
    use crate::log::{Log, UniformLog};

    /// 4 s at 1 kHz: on the way for two seconds, and at rest.
    fn log() -> UniformLog {
        let time_s: Vec<f64> = (0..4000).map(|at| 1e-3 * f64::from(at)).collect();
        let position_m = time_s.iter().map(|t| 1e-3 * t.min(2.0)).collect();
        let force_n = vec![0.0; time_s.len()];
        Log::from_channels(time_s, position_m, force_n)
            .uniform()
            .unwrap()
    }

    #[test]
    fn what_is_left_on_the_way_is_not_what_is_left_at_rest() {
        let log = log();
        let floor = NoiseFloor::of(&log, &Thresholds::default().floor);
        assert_eq!(floor.noise_n(), 0.0);
        let data = FitData::of(&log);
        // GIVEN 30 mN on the way, 10 mN at rest, and a sample of 1 N that does not count
        let mut residuals = [vec![0.03; 2000], vec![0.01; 2000]].concat();
        let mut variances = vec![1.0; 4000];
        (residuals[700], variances[700]) = (1.0, 0.0);
        let of = |correlation: f64| {
            let logs = [LogResiduals {
                log: &data,
                depth_m: &[0.0; 4000],
                residuals: &residuals,
                variances: &variances,
            }];
            let left = left(&logs, std::slice::from_ref(&floor), correlation).unwrap();
            let name = |name: &str| PHASES.iter().position(|phase| *phase == name).unwrap();
            let of = |phase: &str| left.by_phase_n[name(phase)];
            (
                left.rms_n,
                of("forward").unwrap(),
                of("hold").unwrap(),
                of("free"),
            )
        };
        // THEN that is what is left there, and 22 mN in the whole log.
        let (all, forward, hold, free) = of(1.0);
        assert!((all - 0.02236).abs() < 1e-4, "{all}");
        assert!(
            (forward - 0.03).abs() < 1e-4 && (hold - 0.01).abs() < 5e-4,
            "{forward} {hold}"
        );
        assert_eq!(free, None);
        // AND if it stays what it is for two seconds, either phase says a quarter of what is known of it.
        let (_, forward, hold, _) = of(2000.0);
        let expected = |own: f64| ((own * own + 3.0 * 5e-4) / 4.0_f64).sqrt();
        assert!((forward - expected(0.03)).abs() < 1e-4, "{forward}");
        assert!((hold - expected(0.01)).abs() < 1e-4, "{hold}");
    }
}
