//! From a log to a configuration: the scales of the contact and a stretch of free air to start in.
//!
//! What a person would set on the board by knowing the rig is read off the log here, and said.

use estimator_core::Config;
use estimator_core::config::{Method, Surface};

use crate::log::UniformLog;
use crate::signal;

/// A rise of the force above this share of its peak ends the free air at the start.
const FREE_SHARE: f64 = 0.02;
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
    if let Some(position_m) = choices.surface_m {
        config.contact.surface = Surface::Known {
            position_m: position_m as f32,
        };
    }
    set_scales(&mut config, &mut notes, log, choices.reference_depth_m);
    set_free_air(&mut config, &mut notes, log);
    // Steadiness needs 16 samples at least: a second at 16 Hz.
    let shortest_s = 16.1 / log.rate_hz as f32;
    config.judgement.window_s = config.judgement.window_s.max(shortest_s);
    Setup { config, notes }
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
        let depth = decade_below(depth_m);
        config.reference.depth_m = depth as f32;
        notes.push(format!(
            "reference depth {depth:.0e} m, since the log reaches {depth_m:.1e} m deep: stiffness \
             and damping hold there (--reference-depth sets another)"
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
    let Some(touch) = free_samples(log) else {
        return (0.0, 0.0);
    };
    let rest = rest_n(log);
    let peak = (touch..log.len()).max_by(|a, b| log.force_n[*a].total_cmp(&log.force_n[*b]));
    let peak = peak.unwrap_or(touch);
    (
        (log.position_m[peak] - log.position_m[touch]).abs(),
        log.force_n[peak] - rest,
    )
}

/// The force that the log starts with (N).
fn rest_n(log: &UniformLog) -> f64 {
    signal::median(log.force_n.iter().take(10).copied().collect())
}

/// Samples before the force first leaves its start; `None` if it never does.
fn free_samples(log: &UniformLog) -> Option<usize> {
    let rest = rest_n(log);
    let peak = log
        .force_n
        .iter()
        .map(|f| (f - rest).abs())
        .fold(0.0, f64::max);
    let leaves = (FREE_SHARE * peak).max(6.0 * log.force_noise_n());
    log.force_n.iter().position(|f| (f - rest).abs() > leaves)
}

/// Fits the settling time into the free air at the start of the log; where that is too short to
/// measure the noise in, the noise of the whole log stands in.
fn set_free_air(config: &mut Config, notes: &mut Vec<String>, log: &UniformLog) {
    let wanted = (f64::from(config.contact.settle_s) * log.rate_hz) as usize;
    // Half of the free air: its end is where the force has already left its start.
    let free = free_samples(log).unwrap_or(log.len()) / 2;
    if free >= wanted && wanted >= 50 {
        return;
    }
    // 10 samples are what the estimator asks for at least; a thousandth more survives rounding.
    let samples = free.clamp(10, wanted.max(10));
    config.contact.settle_s = (1.001 * samples as f64 / log.rate_hz) as f32;
    if config.contact.force_noise_n.is_none() && samples < 50 {
        let noise = log.force_noise_n();
        config.contact.force_noise_n = Some(noise as f32);
        notes.push(format!(
            "{samples} samples of free air at the start are too few to measure the noise in: \
             {noise:.2e} N from the whole log"
        ));
    }
    if free < 10 {
        notes.push(
            "the log starts in contact: resting force and surface are those of its first samples"
                .into(),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::Log;

    /// 1 s of rest, then a ramp of 1 s to `depth_m` against `stiffness` N/m.
    fn ramp(depth_m: f64, stiffness: f64, rest_s: f64) -> UniformLog {
        let time: Vec<f64> = (0..2000).map(|i| f64::from(i) * 1e-3).collect();
        let depth = |t: &f64| depth_m * (t - rest_s).max(0.0);
        let position: Vec<f64> = time.iter().map(depth).collect();
        let force = position.iter().map(|x| stiffness * x).collect();
        Log::from_channels(time, position, force).uniform().unwrap()
    }

    fn of(log: &UniformLog) -> Setup {
        setup(
            log,
            Config::default(),
            Method::HuntCrossleyTwoStage,
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
        assert!(setup.notes[0].contains("1e-6 m"), "{:?}", setup.notes);
        assert!(setup.config.validate::<f32>().is_ok());
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
    fn a_reference_depth_that_was_asked_for_is_kept() {
        let choices = Choices {
            reference_depth_m: Some(5e-4),
            ..Choices::default()
        };
        let log = ramp(2e-6, 1.0, 1.0);
        let setup = setup(&log, Config::default(), Method::KelvinVoigt, choices);
        assert_eq!(setup.config.reference.depth_m, 5e-4);
    }
}
