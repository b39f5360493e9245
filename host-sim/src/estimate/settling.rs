//! A force that settles when a log begins: an amplifier that has just been switched on, a filter that starts from zero.
//!
//! The probe rests in free air and the force goes to where it rests. What is estimated would take the first samples for
//! the resting force: of logs with an exponential of 0.1 to 1 N and 20 to 100 ms two of fifteen ended in `no_contact`, and
//! of those behind a low-pass that started from zero beside an offset two of twelve. That part is left out.

use super::beginning::is_free_from;
use crate::log::UniformLog;
use crate::number::quantity;
use crate::stats::{lowest, median, range, robust_deviation};

/// The probe rests until it has moved by this share of its travel, and is outermost within this share.
const STILL: f64 = 0.01;
const OUTERMOST: f64 = 0.05;
/// Samples of the means that are looked at.
const MEAN: usize = 7;
/// The last third of the rest says where the force rests, and by how much its means scatter; it is settled within so many
/// standard deviations of them.
const LAST: f64 = 1.0 / 3.0;
const SETTLED_SIGMAS: f64 = 4.0;
/// A log begins with a transient if its first mean is off by so many of them,
const OFF_SIGMAS: f64 = 8.0;
/// and by this share of what the force does in all: less is lost in the errors of its zero.
const OFF_SHARE: f64 = 2e-3;
/// Fewest samples of rest, and of those that are left of it.
const FEWEST: usize = 40;
const FEWEST_LEFT: usize = 20;

/// A log without the transient of the force that it begins with, and a note that says so; `None` of another.
pub fn settled(log: &UniformLog) -> Option<UniformLog> {
    let (samples, off_n) = transient(log)?;
    let mut rest = log.part(samples..log.len());
    if !is_free_from(&rest, 0) {
        return None;
    }
    rest.notes.push(format!(
        "the force settles by {} in the first {} while the probe rests in free air, as an amplifier or a filter does that \
         has just been switched on: that part is left out",
        quantity(off_n.abs(), 2, "N"),
        quantity(samples as f64 * log.period_s(), 2, "s")
    ));
    Some(rest)
}

/// Samples until the force has settled, and by how much it does (N).
fn transient(log: &UniformLog) -> Option<(usize, f64)> {
    let travel_m = range(&log.position_m);
    let start_m = *log.position_m.first()?;
    let outermost_m = lowest(log.position_m.iter().copied());
    let moved = |x_m: &f64| (x_m - start_m).abs() > STILL * travel_m;
    let still = log.position_m.iter().position(moved)?;
    if still < FEWEST || start_m > outermost_m + OUTERMOST * travel_m {
        return None;
    }
    let windows = log.force_n[..still].windows(MEAN);
    let means: Vec<f64> = windows
        .map(|own| own.iter().sum::<f64>() / MEAN as f64)
        .collect();
    let last = &means[means.len() - (LAST * means.len() as f64) as usize..];
    let level_n = median(last.iter().copied());
    let scatter_n = robust_deviation(last.iter().map(|own| own - level_n));
    let scatter_n = scatter_n.max(log.force_noise_n() / (MEAN as f64).sqrt());
    let off_n = means.first()? - level_n;
    let least_n = (OFF_SIGMAS * scatter_n).max(OFF_SHARE * range(&log.force_n));
    let is_off = |own: &f64| (own - level_n).abs() > SETTLED_SIGMAS * scatter_n;
    let end = means.iter().rposition(is_off)? + MEAN;
    (off_n.abs() > least_n && end + FEWEST_LEFT <= still).then_some((end, off_n))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::Log;

    /// 0.6 s of rest and two presses of 1 mm into 2 N/mm at 1 kHz, 0.5 mm away; 1 mN of noise, and a force more.
    fn log(more_n: impl Fn(f64) -> f64, gap_m: f64) -> UniformLog {
        let time: Vec<f64> = (0..3000).map(|at| 1e-3 * f64::from(at)).collect();
        let way = |t: &f64| 1.5e-3 * (2.618 * (t - 0.6).max(0.0)).sin().powi(2) - gap_m;
        let x: Vec<f64> = time.iter().map(way).collect();
        let noise = |t: f64| 1e-3 * (t * 1.7e4).sin() * (t * 370.0).cos();
        let force = |(t, x): (&f64, &f64)| 2000.0 * x.max(0.0) + noise(*t) + more_n(*t);
        let force = time.iter().zip(&x).map(force).collect();
        Log::from_channels(time, x, force).uniform().unwrap()
    }

    #[test]
    fn a_force_that_settles_before_anything_moves_is_left_out() {
        let decays = |t: f64| 0.5 - 0.8 * (-t / 0.05).exp();
        let rest = settled(&log(decays, 5e-4)).expect("it settles");
        // 0.8 N are less than 2 mN after 0.3 s.
        assert!((0.2..0.4).contains(&rest.time_s[0]), "{}", rest.time_s[0]);
        // Its first mean, of 7 ms.
        assert!(rest.notes[0].contains("by 0.75"), "{:?}", rest.notes);
    }

    #[test]
    fn a_force_that_rests_is_kept_and_so_is_one_that_relaxes_in_contact() {
        assert_eq!(settled(&log(|_| 0.5, 5e-4)), None);
        // GIVEN a probe that is inside from the beginning and never leaves
        let relaxes = |t: f64| 0.8 * (-t / 0.05).exp();
        assert_eq!(settled(&log(relaxes, -5e-4)), None);
    }
}
