//! The step of the stamps.

/// Finest step that is looked for (s): below it a stamp of a day has no digits left.
const FINEST_S: i32 = -9;
/// A stamp is a multiple of a step if it is off by less than this share of it.
const WHOLE: f64 = 0.01;

/// The largest of 1, 2, 5 times a power of ten (s) that all stamps are multiples of, counted from the
/// first; `None` if there is none.
pub(in crate::log) fn of(time_s: &[f64]) -> Option<f64> {
    let first = *time_s.first()?;
    let steps = (FINEST_S..=0)
        .rev()
        .flat_map(|power| [5.0, 2.0, 1.0].map(|digit| digit * 10f64.powi(power)));
    let all_whole = |step: &f64| {
        time_s.iter().all(|stamp| {
            let steps = (stamp - first) / step;
            (steps - steps.round()).abs() < WHOLE
        })
    };
    (time_s.len() > 1).then(|| steps.into_iter().find(all_whole))?
}
