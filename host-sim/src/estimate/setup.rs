//! From a log to a configuration: the scales of the contact and a stretch of free air to start in.
//!
//! What a person would set on the board by knowing the rig is read off the log here, and said.

use estimator_core::Config;
use estimator_core::estimate::{
    config::Filter, config::Surface, contact::NOISE_FLOOR, filter::MAX_HALF_WIDTH, method::Method,
};

use crate::log::UniformLog;
use crate::number::quantity;
use crate::replay::half_width;
use crate::stats::{deviation, median, range, rms};

/// A rise of the force above this share of its peak ends the free air at the start.
const FREE_SHARE: f64 = 0.02;
/// What the force does before the probe moves it may do again, and a little more, without a touch.
const IDLE_MARGIN: f64 = 1.2;
/// Fewest samples of free air that the estimator settles in.
const FEWEST_SETTLING: usize = 10;
/// Fewest samples of free air to measure something in.
const FEWEST_FREE: usize = 50;
/// The probe has moved when it has gone this share of its travel.
const STILL_SHARE: f64 = 0.01;
/// A log whose force leaves its start within so many samples begins in contact;
const AT_ONCE: usize = 1;
/// and so does one whose force is below its start by this share of what it does in all, for this share of its samples: no
/// pull lasts so long, and no resting force drifts so far.
const BELOW_FORCE: f64 = 0.1;
const BELOW_SAMPLES: f64 = 0.2;
/// The threshold of a touch over the drift of the resting force.
const DRIFT_MARGIN: f64 = 2.0;
/// A touch begins so many standard deviations of a force at rest from it, where that is more than six of the noise from
/// sample to sample: of six presses beside 20 mN of 1/f noise, 5 mN of it fast, there were 63.
const WANDER_SIGMAS: f64 = 4.0;
/// Means over so long (s) wander, of which so many must be there: hum of 50 Hz has none.
const WANDER_S: f64 = 0.02;
const FEWEST_MEANS: usize = 8;
/// A touch begins at no more than this share of the peak force.
const MOST_WANDER: f64 = 0.25;
/// Largest drift, of the peak force, that is one: a larger end is a contact.
const MOST_DRIFT: f64 = 0.05;
/// Depths and forces within these bounds are measured with the default reference of 1 mm and 1 N.
const USUAL_DEPTH_M: std::ops::Range<f64> = 5e-5..5e-2;
const USUAL_FORCE_N: std::ops::Range<f64> = 5e-2..5e2;

/// What a caller may fix; the log decides the rest.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Choices {
    /// δ₀ (m).
    pub reference_depth_m: Option<f64>,
    /// Position of the surface (m).
    pub surface_m: Option<f64>,
}

/// A configuration for a log, and what to tell about it.
#[derive(Clone, Debug, PartialEq)]
pub struct Setup {
    /// Ready to validate.
    pub config: Config,
    /// What was read off the log, a sentence each.
    pub notes: Vec<String>,
}

/// Makes a configuration for `log`, from `base` where it says nothing else.
pub fn setup(log: &UniformLog, base: Config, method: Method, choices: Choices) -> Setup {
    let mut config = Config {
        method,
        rate_hz: log.rate_hz as f32,
        ..base
    };
    let mut notes = Vec::new();
    set_filter(&mut config, log);
    if let Some(position_m) = choices.surface_m {
        config.contact.surface = Surface::Known {
            position_m: position_m as f32,
        };
    }
    if let Some(noise_n) = log.compensated.noise_n {
        config.contact.force_noise_n.get_or_insert(noise_n as f32);
    }
    if let Some(count_m) = log.position_step_m {
        let count_m = count_m as f32;
        config.contact.position_step_m.get_or_insert(count_m);
    }
    set_scales(&mut config, &mut notes, log, choices.reference_depth_m);
    set_noise_as_taken(&mut config, log);
    set_free_air(&mut config, &mut notes, log);
    set_touch(&mut config, &mut notes, log);
    // Steadiness needs 16 samples at least: a second at 16 Hz.
    let shortest_s = 16.1 / log.rate_hz as f32;
    config.judgement.window_s = config.judgement.window_s.max(shortest_s);
    Setup { config, notes }
}

/// Gives the default filter the width that the log asks for. A filter of a person's own is kept, and means
/// were made for the default.
fn set_filter(config: &mut Config, log: &UniformLog) {
    if config.filter == Config::default().filter && log.recognised.is_empty() {
        config.filter = Filter::SavitzkyGolay {
            half_width: half_width(log).min(MAX_HALF_WIDTH) as u8,
        };
    }
}

fn set_scales(
    config: &mut Config,
    notes: &mut Vec<String>,
    log: &UniformLog,
    reference_depth_m: Option<f64>,
) {
    let (depth_m, force_n) = reach(log);
    let own_depth = (config.reference.depth_m - Config::default().reference.depth_m).abs() > 1e-9;
    if let Some(depth) = reference_depth_m {
        config.reference.depth_m = depth as f32;
    } else if !own_depth && depth_m > 0.0 && !USUAL_DEPTH_M.contains(&depth_m) {
        // A lever of many turns, or degrees read as radians, is still measured at one.
        let depth = decade_below(depth_m).min(1.0);
        config.reference.depth_m = depth as f32;
        notes.push(format!(
            "reference depth {}, since the log reaches {} deep: stiffness and damping hold there \
             (--reference-depth sets another)",
            quantity(depth, 1, "m"),
            quantity(depth_m, 2, "m")
        ));
    }
    if force_n > 0.0 && !USUAL_FORCE_N.contains(&force_n) {
        config.reference.force_n = decade_below(force_n) as f32;
    }
    let reference = config.reference;
    config.initial.stiffness_n_per_m = reference.force_n / reference.depth_m;
}

fn decade_below(value: f64) -> f64 {
    10f64.powi(value.log10().floor() as i32)
}

/// How deep (m) and how hard (N) the log presses, roughly: from where the force leaves its start to
/// where it is largest.
fn reach(log: &UniformLog) -> (f64, f64) {
    if begins_in_contact(log) {
        return (range(&log.position_m), range(&log.force_n));
    }
    let Some(touch) = free_samples(log) else {
        return (0.0, 0.0);
    };
    let rest = rest_n(log);
    let force = |index: &usize| middle(&log.force_n, *index);
    let peak = (touch..log.len()).max_by(|a, b| force(a).total_cmp(&force(b)));
    let peak = peak.unwrap_or(touch);
    (
        (middle(&log.position_m, peak) - middle(&log.position_m, touch)).abs(),
        force(&peak) - rest,
    )
}

/// The median of a sample and its neighbours: one spike is neither a peak nor a touch.
fn middle(channel: &[f64], at: usize) -> f64 {
    let value = channel[at];
    let before = channel[at.saturating_sub(1)];
    let after = channel.get(at + 1).copied().unwrap_or(value);
    before.min(after).max(before.max(after).min(value))
}

/// The force that the log starts with (N).
fn rest_n(log: &UniformLog) -> f64 {
    median(log.force_n.iter().take(10).copied())
}

/// Samples before the force first leaves its start; `None` if it never does.
fn free_samples(log: &UniformLog) -> Option<usize> {
    let rest = rest_n(log);
    let away = |index: usize| (middle(&log.force_n, index) - rest).abs();
    let peak = (0..log.len()).map(away).fold(0.0, f64::max);
    let idle = idle_n(log, rest);
    let leaves = (FREE_SHARE * peak)
        .max(6.0 * log.force_noise_n())
        .max(IDLE_MARGIN * idle);
    (0..log.len()).position(|index| away(index) > leaves)
}

/// Where the probe is (m) when the force first leaves its start; `None` of a log that begins in contact, or has none.
fn first_touch_m(log: &UniformLog) -> Option<f64> {
    let touch = free_samples(log).filter(|_| !begins_in_contact(log))?;
    Some(log.position_m[touch])
}

/// A probe is in free air where it is farther out than its first touch by this share of its travel.
const OUTSIDE: f64 = 0.1;

/// The stretches of free air of a log, as far as a position tells: samples that lie side by side and have a force. `None` of a
/// log without a first touch.
pub(super) fn outside(log: &UniformLog) -> Option<Vec<Vec<usize>>> {
    let outside_m = first_touch_m(log)? - OUTSIDE * range(&log.position_m);
    let is_out = |at: &usize| log.position_m[*at] < outside_m && log.has_force(*at);
    let all: Vec<usize> = (0..log.len()).filter(is_out).collect();
    Some(
        all.chunk_by(|a, b| b - a == 1)
            .map(<[usize]>::to_vec)
            .collect(),
    )
}

/// Whether too little free air was seen at the start to know what the force rests at.
pub(super) fn has_no_zero(log: &UniformLog) -> bool {
    begins_in_contact(log) || free_samples(log).is_some_and(|free| free / 2 < FEWEST_SETTLING)
}

/// Whether the first sample is in contact: the force leaves it at once, or is far below it for long, as no free air is.
pub(super) fn begins_in_contact(log: &UniformLog) -> bool {
    let at_once = free_samples(log).is_some_and(|free| free <= AT_ONCE);
    let below_n = (BELOW_FORCE * range(&log.force_n)).max(6.0 * log.force_noise_n());
    let low_n = rest_n(log) - below_n;
    let below = log.force_n.iter().filter(|force| **force < low_n).count();
    at_once || below as f64 >= BELOW_SAMPLES * log.len() as f64
}

/// Samples before the probe moves; none where they are too few to measure something in.
fn idle(log: &UniformLog) -> usize {
    let still_m = STILL_SHARE * range(&log.position_m);
    let moved = |position: &f64| (position - log.position_m[0]).abs() > still_m;
    let idle = log.position_m.iter().position(moved);
    idle.filter(|idle| *idle >= FEWEST_FREE).unwrap_or(0)
}

/// How far the force strays from its start while the probe has not moved yet (N): hum and noise.
fn idle_n(log: &UniformLog, rest: f64) -> f64 {
    let strays = log.force_n[..idle(log)]
        .iter()
        .map(|force| (force - rest).abs());
    strays.fold(0.0, f64::max)
}

/// How far the force goes by itself while the probe has not moved yet (N), more slowly than a touch is noticed.
fn wander_n(log: &UniformLog) -> f64 {
    let width = ((WANDER_S * log.rate_hz) as usize).max(1);
    let means = log.force_n[..idle(log)].chunks_exact(width);
    let means: Vec<f64> = means
        .map(|own| own.iter().sum::<f64>() / width as f64)
        .collect();
    match means.len() >= FEWEST_MEANS {
        true => WANDER_SIGMAS * deviation(&means),
        false => 0.0,
    }
}

/// By how much the resting force has risen (N) at the end of a log that ends out of contact.
fn drift_n(log: &UniformLog) -> Option<f64> {
    let touch_m = log.position_m[free_samples(log)?];
    let (depth_m, force_n) = reach(log);
    let end_m = *log.position_m.last()?;
    let tail = log.len() - (log.len() / 100).clamp(1, 100);
    let drift = median(log.force_n[tail..].iter().copied()) - rest_n(log);
    (end_m < touch_m - 0.1 * depth_m && drift < MOST_DRIFT * force_n).then_some(drift)
}

/// Lifts the threshold of a touch above what the resting force does by itself: else one that has not come back to zero
/// would be taken for another touch.
fn set_touch(config: &mut Config, notes: &mut Vec<String>, log: &UniformLog) {
    let usual = Config::default().contact;
    let own = config.contact.touch_sigma != usual.touch_sigma
        || config.contact.release_sigma != usual.release_sigma;
    if own || config.contact.surface != Surface::AtImpact {
        return;
    }
    let floor_n = NOISE_FLOOR * f64::from(config.reference.force_n);
    let sigma_n = config.contact.force_noise_n.map_or(0.0, f64::from);
    let sigma_n = sigma_n.max(log.force_noise_n()).max(floor_n);
    let drift = drift_n(log).unwrap_or(0.0);
    let (_, peak_n) = reach(log);
    let wander = wander_n(log).min(MOST_WANDER * peak_n);
    let over_n = wander.max(DRIFT_MARGIN * drift);
    let times = (over_n / (f64::from(usual.touch_sigma) * sigma_n)) as f32;
    if times <= 1.0 {
        return;
    }
    // 1000 is the largest multiple that the estimator takes.
    config.contact.touch_sigma = (times * usual.touch_sigma).min(1000.0);
    config.contact.release_sigma = (times * usual.release_sigma).min(100.0);
    let wanders = wander >= over_n;
    if wanders {
        // The board's own measure of a wander ends with the settling, and is forgotten where the zero goes elsewhere.
        config.contact.force_noise_n.get_or_insert(sigma_n as f32);
    }
    notes.push(match wanders {
        false => format!(
            "the resting force rises by {} over the log: a touch begins at twice that",
            quantity(drift, 2, "N")
        ),
        true => format!(
            "the force wanders before the probe moves: a touch begins at {}",
            quantity(wander, 2, "N")
        ),
    });
}

/// Gives the noise of the samples as they were taken, where those of the log lie between them: of a loop of 2 ms and a
/// half the noise was 10 mN for 20, and a fit that left it was suspect at 1.7 times that.
fn set_noise_as_taken(config: &mut Config, log: &UniformLog) {
    let Some(taken) = &log.taken else { return };
    let free = free_samples(log).unwrap_or(log.len()) / 2;
    let until_s = log.time_s.get(free).copied().unwrap_or(0.0);
    let count = taken.time_s.partition_point(|time_s| *time_s <= until_s);
    // What comes and goes at rest is noise, too: hum, and slow noise.
    let at_rest = &taken.force_n[..count];
    let mean_n = at_rest.iter().sum::<f64>() / count.max(1) as f64;
    let at_rest_n = match count >= FEWEST_FREE {
        true => rms(at_rest.iter().map(|force| force - mean_n)),
        false => 0.0,
    };
    let noise_n = log.force_noise_n().max(at_rest_n);
    config.contact.force_noise_n.get_or_insert(noise_n as f32);
}

/// Fits the settling time into the free air at the start of the log; where that is too short to
/// measure the noise in, the noise of the whole log stands in.
fn set_free_air(config: &mut Config, notes: &mut Vec<String>, log: &UniformLog) {
    let wanted = (f64::from(config.contact.settle_s) * log.rate_hz) as usize;
    // Half of the free air: its end is where the force has already left its start.
    let before = free_samples(log).unwrap_or(log.len());
    let free = before / 2;
    if free >= wanted && wanted >= FEWEST_FREE && !begins_in_contact(log) {
        return;
    }
    // A thousandth more survives rounding. At 100 Hz it takes longer than usual to see the noise.
    let samples = free.clamp(FEWEST_SETTLING, wanted.max(FEWEST_FREE));
    config.contact.settle_s = (1.001 * samples as f64 / log.rate_hz) as f32;
    if config.contact.force_noise_n.is_none() && samples < FEWEST_FREE {
        let noise = log.force_noise_n();
        config.contact.force_noise_n = Some(noise as f32);
        notes.push(format!(
            "{samples} samples of free air at the start are too few to measure the noise in: {} from \
             the whole log",
            quantity(noise, 3, "N")
        ));
    }
    if begins_in_contact(log) {
        notes.push(
            "the log starts in contact: no free air before it shows the resting force".into(),
        );
    } else if free < FEWEST_SETTLING {
        let what = format!("only {before} samples before the force rises");
        notes.push(format!(
            "{what}: resting force and surface are those of its first samples"
        ));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::Log;
    use rand::SeedableRng;
    use rand_distr::{Distribution, Normal};

    const SEED: u64 = 3;

    /// 1 s of rest, then a ramp of 1 s to `depth_m` against `stiffness` N/m.
    fn ramp(depth_m: f64, stiffness: f64, rest_s: f64) -> UniformLog {
        ramp_at(1000.0, depth_m, stiffness, rest_s)
    }

    /// The same at another rate.
    fn ramp_at(rate_hz: f64, depth_m: f64, stiffness: f64, rest_s: f64) -> UniformLog {
        let count = (2.0 * rate_hz) as u32;
        let time: Vec<f64> = (0..count).map(|i| f64::from(i) / rate_hz).collect();
        let depth = |t: &f64| depth_m * (t - rest_s).max(0.0);
        let position: Vec<f64> = time.iter().map(depth).collect();
        let force = position.iter().map(|x| stiffness * x).collect();
        Log::from_channels(time, position, force).uniform().unwrap()
    }

    fn of(log: &UniformLog) -> Setup {
        setup(
            log,
            Config::default(),
            Method::HUNT_CROSSLEY_TWO_STAGE,
            Choices::default(),
        )
    }

    #[test]
    fn millimetres_and_newtons_keep_the_defaults() {
        let setup = of(&ramp(2e-3, 2000.0, 1.0));
        assert_eq!(setup.config.reference, Config::default().reference);
        assert_eq!(
            setup.config.contact.settle_s,
            Config::default().contact.settle_s
        );
        assert!(setup.notes.is_empty(), "{:?}", setup.notes);
    }

    #[test]
    fn micrometres_and_micronewtons_get_their_own_scales_and_say_so() {
        let setup = of(&ramp(2e-6, 1.0, 1.0));
        assert!((setup.config.reference.depth_m - 1e-6).abs() < 1e-12);
        assert!((setup.config.reference.force_n - 1e-6).abs() < 1e-12);
        assert!(
            setup.notes[0].contains("reference depth 1\u{a0}µm"),
            "{:?}",
            setup.notes
        );
        assert!(setup.config.validate::<f32>().is_ok());
    }

    #[test]
    fn one_spike_of_the_force_sets_no_scale() {
        let mut log = ramp(2e-3, 2000.0, 1.0);
        log.force_n[900] = 1000.0;
        assert_eq!(of(&log).config.reference, Config::default().reference);
    }

    #[test]
    fn the_noise_is_that_of_the_samples_and_not_of_what_lies_between_them() {
        // GIVEN a second of rest and strokes of 1 mm with a noise of 1 mN rms, sampled up to 0.3 ms before or after every
        // millisecond
        let instant = |i: i32| 1e-3 * f64::from(i) + 3e-4 * (f64::from(i * i % 97) / 48.0 - 1.0);
        let place = |t: f64| 1e-3 * (9.42 * (t - 1.0).max(0.0)).sin();
        let mut rng = rand_pcg::Pcg64::seed_from_u64(SEED);
        let noise = Normal::new(0.0, 1e-3).unwrap();
        let time: Vec<f64> = (0..4000).map(instant).collect();
        let position: Vec<f64> = time.iter().map(|t| place(*t)).collect();
        let force = position
            .iter()
            .map(|x| 1e3 * x.max(0.0) + noise.sample(&mut rng))
            .collect();
        let log = Log::from_channels(time, position, force);
        let log = log.uniform().unwrap();
        assert!(log.taken.is_some());
        let found = of(&log).config.contact.force_noise_n.unwrap();
        // What differences of a motion add; of the interpolated samples it was half.
        assert!((found / 1e-3 - 1.0).abs() < 0.2, "{found}");
    }

    #[test]
    fn at_a_hundred_hertz_a_long_free_air_is_enough_to_measure_the_noise_in() {
        let setup = of(&ramp_at(100.0, 1e-3, 1000.0, 2.0));
        assert!(setup.config.contact.settle_s >= 0.5, "{setup:?}");
        assert!(
            setup.notes.iter().all(|note| !note.contains("too few")),
            "{setup:?}"
        );
    }

    #[test]
    fn a_log_that_starts_in_contact_says_so() {
        let mut log = ramp(2e-3, 2000.0, 0.0);
        // 20 Hz in the material from the first sample on.
        for (time, force) in log.time_s.iter().zip(&mut log.force_n) {
            *force = 5.0 + 5.0 * (125.7 * time).sin();
        }
        let setup = of(&log);
        assert!(
            setup.notes.iter().any(|n| n.contains("starts in contact")),
            "{:?}",
            setup.notes
        );
        assert!(setup.config.validate::<f32>().is_ok());
    }

    #[test]
    fn hum_before_the_probe_moves_is_free_air_and_no_contact() {
        // GIVEN 20 mN of 50 Hz hum on a ramp that begins after half a second
        let mut log = ramp(2e-3, 2000.0, 0.5);
        for (time, force) in log.time_s.iter().zip(&mut log.force_n) {
            *force += 0.02 * (314.2 * time).sin();
        }
        // THEN the settling time is the default, and nobody speaks of a contact.
        let setup = of(&log);
        let usual = Config::default().contact;
        assert_eq!(setup.config.contact, usual);
        assert!(setup.notes.is_empty(), "{:?}", setup.notes);
    }

    #[test]
    fn a_touch_begins_above_the_drift_of_the_resting_force() {
        // GIVEN 0.3 mm through air and 0.7 mm into 1.5 N/mm and back, read in codes of 4 mN, and a force that ends higher
        let pressed = |drift_n: f64| {
            let mut log = ramp(2e-3, 2000.0, 0.5);
            for index in 0..2000 {
                let way_m = log.position_m[index.min(1999 - index)];
                log.position_m[index] = way_m;
                let drift_n = if index < 1000 { 0.0 } else { drift_n };
                let code = (1500.0 * (way_m - 3e-4).max(0.0) / 4e-3).round();
                log.force_n[index] = 4e-3 * code + drift_n;
            }
            of(&log).config.contact
        };
        let usual = Config::default().contact;
        // WHEN it drifts by 10 mN, THEN a touch takes 20 mN: 17.3 times the noise of 4 mN/√12.
        let lifted = pressed(0.01);
        assert!((17.2..=17.4).contains(&lifted.touch_sigma), "{lifted:?}");
        assert!((8.6..=8.7).contains(&lifted.release_sigma), "{lifted:?}");
        // Without drift, or with one that must be a contact, nothing changes.
        assert_eq!(pressed(0.0).touch_sigma, usual.touch_sigma);
        assert_eq!(pressed(0.5).touch_sigma, usual.touch_sigma);
    }

    #[test]
    fn a_touch_begins_above_how_far_the_force_wanders_at_rest() {
        // GIVEN 2 mN of noise from sample to sample, and of 20 mN rms that lasts for 25 ms
        let wandering = |slow_n: f64| {
            let mut log = ramp(2e-3, 2000.0, 0.5);
            let mut rng = rand_pcg::Pcg64::seed_from_u64(SEED);
            let noise = Normal::new(0.0, 1.0).unwrap();
            let mut own_n = 0.0;
            for force in &mut log.force_n {
                own_n = 0.96 * own_n + 0.28 * slow_n * noise.sample(&mut rng);
                *force += own_n + 2e-3 * noise.sample(&mut rng);
            }
            of(&log)
        };
        // THEN a touch begins above 60 mN, and it is said; AND as ever where the noise is that of samples.
        let setup = wandering(20e-3);
        let contact = setup.config.contact;
        let begins_n = contact.touch_sigma * contact.force_noise_n.expect("as it was measured");
        assert!((0.05..0.1).contains(&begins_n), "{contact:?}");
        assert!(setup.notes[0].contains("wanders"), "{:?}", setup.notes);
        let usual = Config::default().contact;
        assert_eq!(wandering(0.0).config.contact, usual);
    }

    #[test]
    fn a_reference_depth_that_was_asked_for_is_kept() {
        let choices = Choices {
            reference_depth_m: Some(5e-4),
            ..Choices::default()
        };
        let log = ramp(2e-6, 1.0, 1.0);
        let setup = setup(&log, Config::default(), Method::KELVIN_VOIGT, choices);
        assert_eq!(setup.config.reference.depth_m, 5e-4);
    }
}
