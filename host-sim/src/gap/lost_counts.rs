//! An encoder that has lost counts: its position leaps and stays off.
//!
//! Between two samples the position leaps as no probe moves. Either the log was joined from two, and the probe is where
//! it says afterwards, or the encoder lost counts, and it is where it was. The base model says which: of a log whose
//! encoder had lost 50 µm in a press it left 11 times the noise with the leap, and the noise without it.

use std::borrow::Cow;

use super::data::leaps;
use crate::diagnostic::Diagnostic;
use crate::log::UniformLog;

/// Without the leap the base leaves less than this share: of 16 logs whose encoder had lost 10 to 250 µm it left 0.01 to
/// 0.56 times as much. Where a cantilever's hold ends in a leap it was 0.63 with one model and more with others.
const LESS: f64 = 0.6;

/// The logs without their leaps, where the base then leaves much less, and what is said of it; `left_n` is what the base
/// leaves (N rms).
///
/// # Errors
/// Those of `left_n`.
pub(super) fn taken_back(
    logs: &[UniformLog],
    left_n: impl Fn(&[UniformLog]) -> Result<f64, Diagnostic>,
) -> Result<(Cow<'_, [UniformLog]>, Option<String>), Diagnostic> {
    let Some(closed) = leaps::closed(logs) else {
        return Ok((Cow::Borrowed(logs), None));
    };
    let (with_n, without_n) = (left_n(logs)?, left_n(&closed)?);
    if without_n >= LESS * with_n {
        return Ok((Cow::Borrowed(logs), None));
    }
    let note = format!(
        "where the position leaps the encoder has lost counts, and the leap is taken back: so the base leaves {:.2} times as much",
        without_n / with_n
    );
    Ok((Cow::Owned(closed), Some(note)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::Log;

    #[test]
    fn a_leap_is_taken_back_where_the_base_leaves_less_without_it() {
        // GIVEN strokes of 1 mm, 6 µm a sample, and 50 µm that the position leaps at 2 s
        let time: Vec<f64> = (0..4000).map(|at| 1e-3 * f64::from(at)).collect();
        let way = |t: f64| 1e-3 * (6.0 * t).sin();
        let position = time
            .iter()
            .map(|t| way(*t) + if *t > 2.0 { 5e-5 } else { 0.0 });
        let force = time.iter().enumerate();
        let force =
            force.map(|(at, t)| 2e3 * way(*t) + 1e-3 * ((at * at % 97) as f64 / 48.0 - 1.0));
        let log = Log::from_channels(time.clone(), position.collect(), force.collect());
        let logs = [log.uniform().unwrap()];
        let off_m = |logs: &[UniformLog]| logs[0].position_m[3000] - way(3.0);
        // WHERE the base leaves nothing at the place before the leap THEN it is taken back to a micrometre.
        let lost = |logs: &[UniformLog]| Ok(off_m(logs).abs());
        let (closed, note) = taken_back(&logs, lost).unwrap();
        assert!(off_m(&closed).abs() < 1e-6 && note.is_some());
        // AND else it stays.
        let joined = |logs: &[UniformLog]| Ok((off_m(logs) - 5e-5).abs());
        let (kept, note) = taken_back(&logs, joined).unwrap();
        assert!((off_m(&kept) - 5e-5).abs() < 1e-9 && note.is_none());
    }
}
