//! What a load cell and a converter, as good as they are, do to the numbers of a fit.
//!
//! No noise tells how far a stiffness is off because the load cell bends, or a damping because force and position are not
//! taken at one instant: both are the same in every sample. With errors from the noise alone intervals of 95 % held 83 % of
//! the truths where the cell bent, 84 % where it rang, and 94 % elsewhere (216 of the harder rigs).

use crate::gap::data::fit_data::FitData;
use crate::stats::highest;

/// One standard deviation of what a load cell of a good class bends, as a share of the largest force. Data sheets say 0.02
/// to 0.1 % of the range, of which a log uses a part.
const BENDS: f64 = 5e-4;
/// One standard deviation of the time (s) between the instants at which force and position are taken: a load cell that
/// rings at 500 Hz with a damping ratio of 0.02 is as late.
const LATE_S: f64 = 1e-5;

/// What each of the two makes of the modelled forces (N), by one standard deviation.
pub(super) fn errors_n(logs: &[FitData], forces_n: &[f64]) -> [Vec<f64>; 2] {
    let largest_n = highest(forces_n.iter().map(|force| force.abs())).max(f64::MIN_POSITIVE);
    let bent = |force: &f64| BENDS * force * force.abs() / largest_n;
    let mut late = Vec::with_capacity(forces_n.len());
    let mut from = 0;
    for log in logs {
        let forces_n = &forces_n[from..from + log.len()];
        from += log.len();
        late.extend(slopes(&log.time_s, forces_n).map(|slope| LATE_S * slope));
    }
    [forces_n.iter().map(bent).collect(), late]
}

/// The slope of a channel at each sample, between its neighbours.
fn slopes<'a>(time_s: &'a [f64], channel: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
    let last = channel.len().saturating_sub(1);
    (0..channel.len()).map(move |at| {
        let (before, after) = (at.saturating_sub(1), (at + 1).min(last));
        let span_s = time_s[after] - time_s[before];
        match span_s > 0.0 {
            true => (channel[after] - channel[before]) / span_s,
            false => 0.0,
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::Log;

    /// A ramp to 10 N within a second at 100 Hz, and 10 N from then on.
    fn ramp() -> (FitData, Vec<f64>) {
        let time_s: Vec<f64> = (0..200).map(|at| 0.01 * f64::from(at)).collect();
        let force_n: Vec<f64> = time_s.iter().map(|t| (10.0 * t).min(10.0)).collect();
        let log = Log::from_channels(time_s, vec![0.0; 200], force_n.clone());
        (FitData::of(&log.uniform().unwrap()), force_n)
    }

    #[test]
    fn a_cell_bends_with_the_square_of_the_force_and_is_late_where_it_changes() {
        let (log, forces_n) = ramp();
        // GIVEN two logs, the second pulled
        let logs = [log.clone(), log];
        let pulled = forces_n.iter().map(|force| -force);
        let both: Vec<f64> = forces_n.iter().copied().chain(pulled).collect();
        let [bent, late] = errors_n(&logs, &both);
        let is = |error: f64, expected: f64| (error - expected).abs() < 1e-12;
        // THEN a twentieth of a percent of 10 N at the end, a quarter of that at half of it, and the other way in the
        // second log,
        assert!(is(bent[150], 5e-3) && is(bent[50], 1.25e-3) && is(bent[350], -5e-3));
        // AND 10 µs of 10 N/s, at the first sample as well, and nothing in a hold or from one log to the next.
        assert!(is(late[50], 1e-4) && is(late[0], 1e-4) && is(late[250], -1e-4));
        assert!(is(late[150], 0.0) && is(late[199], 0.0));
    }
}
