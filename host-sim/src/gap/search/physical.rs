//! Fits whose numbers do not mean what the names of their effects say.

use estimator_core::physics::effect::{EffectId, Family, Repeats};

use crate::gap::data::{repetition::repeats_with, scales::Scales};
use crate::gap::model::{fit::Fit, shape::Term, start::repeats};
use crate::stats::rounding_step;

/// A wave is a harmonic of another if their pitches or frequencies differ by a whole factor within this.
const HARMONIC: f64 = 0.02;

/// Whether the numbers of a fit mean what the names of its effects say. What repeats with the motion is of the
/// motion, and no disturbance in time.
pub(crate) fn is_physical(fit: &Fit, scales: &Scales) -> bool {
    let terms = fit.shape.terms_at(&fit.numbers);
    let is_of_motion = |term: &Term| {
        term.id.info().repeats == Repeats::InTime
            && repeats_with(scales.motion_hz, term.row[1], scales.duration_s)
    };
    let is_physical = |term: &Term| {
        (term.id.info().is_physical)(&term.row) && !is_of_motion(term) && is_open_loop(term, scales)
    };
    let is_shown = |term: &Term| match term.id {
        EffectId::SurfaceMotion => is_shown_in_contact(term, fit, scales),
        EffectId::Backlash => has_counts(term, scales),
        _ => true,
    };
    let mut each = terms.iter().enumerate().filter(|(_, term)| !term.given);
    // All of the way where there is nothing to touch.
    let beyond_m = scales.deepest_m - fit.shape.surface_at(&fit.numbers);
    let in_contact_m = beyond_m.min(scales.travel_m);
    // Beside a material that is never touched another spring stands for it: of positions with a reversed sign a cable's of
    // -5.9 N/mm was strong.
    let is_touched =
        fit.shape.base.is_free() || fit.shape.surface_at(&fit.numbers) < scales.deepest_m;
    is_touched
        && is_late_one_way(&terms)
        && each.all(|(at, term)| {
            is_physical(term)
                && is_shown(term)
                && is_resolved(term, &terms[..at], scales, in_contact_m)
        })
}

/// Whether a surface moves to and fro often enough while it is touched: as with an encoder's error, two cycles
/// and a half, or it is any law's form. A surface that moved 1.7 times in the one touch of a foot, and one with
/// another frequency beside it, fitted the curve of its spring. Many touches each see where it is: of a breath at
/// 0.25 Hz ten presses in 10 s saw 2.5 cycles, of which one was in contact. A wave of less than half a count is the
/// encoder's: a hand that trembles at 8 Hz made one of 1.7 µm of its counts of 5 µm. One of 0.6 counts was found.
fn is_shown_in_contact(wave: &Term, fit: &Fit, scales: &Scales) -> bool {
    const FEWEST_CYCLES: f64 = 2.5;
    const FEWEST_TOUCHES: usize = 5;
    let surface_m = fit.shape.surface_at(&fit.numbers);
    let half_count_m = 0.5 * rounding_step(scales.position_noise_m);
    let is_seen = wave.row[1] * scales.time_beyond_s(surface_m) >= FEWEST_CYCLES
        || scales.passes_beyond(surface_m) >= FEWEST_TOUCHES;
    is_seen && wave.row[0].abs() >= half_count_m
}

/// Whether a play is of two counts or more. One of 1 and one of 1.7 kept a position that toggles from turning the sign of a
/// speed under a pull that differs by direction; the narrowest that was found and true had 2.2, of 34.
fn has_counts(play: &Term, scales: &Scales) -> bool {
    const FEWEST_COUNTS: f64 = 2.0;
    play.row[0] >= FEWEST_COUNTS * rounding_step(scales.position_noise_m)
}

/// Whether effects that make the force late do not make up for each other: a lag and the position as late do so but
/// for a differentiator, which is any damping. A lag of 31 ms and a delay of -22 ms fitted what a foam's record left,
/// 2.4 and -2.4 ms were certain, three times of 24, where 30 % of the samples or most of the holds were missing.
fn is_late_one_way(terms: &[Term]) -> bool {
    let added = terms.iter().filter(|term| !term.given);
    let late = added.filter(|term| term.id.info().family == Family::Lateness);
    let (mut most, mut least) = (0.0_f64, 0.0_f64);
    late.for_each(|term| (most, least) = (most.max(term.row[0]), least.min(term.row[0])));
    most == 0.0 || least == 0.0
}

/// Whether a log of this length tells a wave from the others of its kind: two that are nearer to each other than
/// a cycle over the log, or over its way in all and in contact, are one that swells. An encoder's error shows in contact
/// only: two of 1.5 and 1.8 cycles there followed what a lag and another error left, and the lag was a delay.
fn is_resolved(wave: &Term, others: &[Term], scales: &Scales, in_contact_m: f64) -> bool {
    let way_m = match wave.id {
        EffectId::EncoderPeriodicError => in_contact_m,
        _ => scales.travel_m,
    };
    let cycles = |term: &Term| match term.id.info().repeats {
        Repeats::InTime => term.row[1] * scales.duration_s,
        Repeats::AlongTheWay => way_m / term.row[1],
        Repeats::Never | Repeats::EveryTurn => f64::INFINITY,
    };
    let mut alike = others.iter().filter(|other| other.id == wave.id);
    !repeats(wave.id) || !alike.any(|other| (cycles(other) - cycles(wave)).abs() < 1.0)
}

/// Whether a restoring loop is one: with βℓ^ν as small as this over the travel ℓ it is a spring that bends, which
/// fitted a foot's curve with 0.2 to 0.5.
fn is_open_loop(term: &Term, scales: &Scales) -> bool {
    const LEAST: f64 = 0.75;
    let [_, beta, _, exponent, ..] = term.row;
    term.id != EffectId::BoucWen || beta * scales.travel_m.powf(exponent) > LEAST
}

/// Whether a fit has `least` waves of a kind and none that is `prominent` times as large as the next: a Fourier
/// series of something that is no wave. A true line may have harmonics, or sidebands of a modulation.
pub(crate) fn is_fourier_series(fit: &Fit, prominent: f64, least: usize) -> bool {
    let terms = fit.shape.terms_at(&fit.numbers);
    let waves = terms.iter().filter(|term| !term.given && repeats(term.id));
    waves.clone().any(|wave| {
        let alike: Vec<&Term> = waves.clone().filter(|other| other.id == wave.id).collect();
        let sizes = sizes(&alike);
        sizes.len() >= least.max(2) && sizes[0] < prominent * sizes[1]
    })
}

/// The sizes of waves of one kind, the largest first, without the harmonics of that one: a motor's cogging has
/// a second one, half as large.
fn sizes(alike: &[&Term]) -> Vec<f64> {
    let mut waves: Vec<[f64; 2]> = alike
        .iter()
        .map(|wave| [wave.row[0].abs(), wave.row[1]])
        .collect();
    waves.sort_by(|a, b| b[0].total_cmp(&a[0]));
    let first = waves.first().map_or(1.0, |wave| wave[1]);
    let is_harmonic = |wave: &[f64; 2]| {
        let times = (first / wave[1]).max(wave[1] / first);
        times > 1.5 && (times - times.round()).abs() < HARMONIC
    };
    let each = waves.iter().filter(|wave| !is_harmonic(wave));
    each.map(|wave| wave[0]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gap::data::fit_data::FitData;
    use crate::gap::model::start::whole;
    use crate::log::Log;
    use crate::stats::rounding_deviation;
    use estimator_core::physics::effect::MOST_PARAMETERS;

    #[test]
    fn a_harmonic_is_no_wave_of_its_own_and_others_are() {
        let wave = |amplitude: f64, pitch_m: f64| {
            let mut row = [0.0; MOST_PARAMETERS];
            row[..2].copy_from_slice(&[amplitude, pitch_m]);
            whole(EffectId::Cogging, row, 3)
        };
        // GIVEN a cogging with half as much of the second harmonic, and a small wave beside it
        let own = [
            wave(24.8, 0.3797e-3),
            wave(53.2, 0.7651e-3),
            wave(8.1, 1.037e-3),
        ];
        let all: Vec<&Term> = own.iter().collect();
        // THEN the largest is 6.6 times as large as the next that is not of it.
        assert_eq!(sizes(&all), [53.2, 8.1]);
    }

    /// A ramp to 0.1 m and back over 10 s.
    fn scales() -> Scales {
        let time: Vec<f64> = (0..2000).map(|at| f64::from(at) * 5e-3).collect();
        let position = time
            .iter()
            .map(|t| 0.02 * (5.0 - (t - 5.0).abs()))
            .collect();
        let force = time.iter().map(|t| t.sin()).collect();
        let log = Log::from_channels(time, position, force).uniform().unwrap();
        Scales::of(&[FitData::of(&log)])
    }

    #[test]
    fn what_makes_a_force_late_is_not_taken_back() {
        let late = |id, size: f64| whole(id, [size, 0.0, 0.0, 0.0, 0.0], 1);
        let (lag, delay) = (EffectId::ForceLag, EffectId::TimeDelay);
        assert!(is_late_one_way(&[late(lag, 3e-3), late(delay, 2e-3)]));
        assert!(is_late_one_way(&[late(delay, -2e-3)]));
        assert!(!is_late_one_way(&[late(lag, 31e-3), late(delay, -22e-3)]));
    }

    #[test]
    fn a_log_resolves_two_waves_of_a_kind_that_are_a_cycle_apart() {
        let wave = |id, second: f64| whole(id, [1.0, second, 0.0, 0.0, 0.0], 3);
        let disturbance = |hz| wave(EffectId::PeriodicDisturbance, hz);
        let scales = scales();
        let resolves = |wave: &Term, first: &[Term]| is_resolved(wave, first, &scales, 0.03);
        let first = [disturbance(0.40)];
        // GIVEN 10 s THEN 0.40 and 0.41 Hz are one that swells, 0.40 and 0.52 Hz are two.
        assert!(!resolves(&disturbance(0.41), &first));
        assert!(resolves(&disturbance(0.52), &first));
        // AND 0.1 m tells a pitch of 20 mm from one of 12 mm and not from one of 18 mm.
        let first = [wave(EffectId::Cogging, 20e-3)];
        assert!(!resolves(&wave(EffectId::Cogging, 18e-3), &first));
        assert!(resolves(&wave(EffectId::Cogging, 12e-3), &first));
        // AND 30 mm in contact do not tell an encoder's 12 mm from 16 mm, but from 8 mm.
        let error = |pitch_m| wave(EffectId::EncoderPeriodicError, pitch_m);
        assert!(!resolves(&error(16e-3), &[error(12e-3)]));
        assert!(resolves(&error(8e-3), &[error(12e-3)]));
        // AND what is no wave may stand twice.
        let mode = wave(EffectId::StressRelaxation, 0.4);
        assert!(resolves(&mode, std::slice::from_ref(&mode)));
    }

    #[test]
    fn a_play_of_a_count_is_none() {
        let scales = Scales {
            position_noise_m: rounding_deviation(5e-6),
            ..scales()
        };
        let play = |width_m: f64| {
            let play = whole(EffectId::Backlash, [width_m, 0.0, 0.0, 0.0, 0.0], 1);
            has_counts(&play, &scales)
        };
        assert!(play(11e-6) && !play(8.5e-6));
    }

    #[test]
    fn the_time_beyond_a_position_is_that_of_the_samples_there() {
        // A quarter of the way is taken in a quarter of the time; one of 33 quantiles is 0.3 s.
        let beyond_s = scales().time_beyond_s(0.075);
        assert!((beyond_s - 2.5).abs() < 0.31, "{beyond_s}");
        // It goes there once, and never beyond where it turns.
        assert_eq!([0.075, 0.1].map(|at| scales().passes_beyond(at)), [1, 0]);
    }
}
