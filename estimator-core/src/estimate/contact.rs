//! Detects touch and lift-off, and finds the surface.
//!
//! Both are decided on raw samples, because a filter smears the kink of a touch over its whole window
//! (17 ms by default, 200 µm at 12 mm/s). The thresholds are multiples of the measured noise.

mod count;
mod params;
mod pull;
mod resting_force;
mod surface;

pub use params::{ContactParams, NOISE_FLOOR};
pub use surface::SurfacePosition;

pub(super) use count::COUNT_ERROR;

use count::{Step, rounding_n};
use pull::Pull;
use resting_force::{RestingForce, Shift, WAY_COUNTS};
use surface::{PRE_TRIGGER, Tangent};

use crate::estimate::{Event, Phase, noise::Noise, sample::Sample};
use crate::maths::scalar::Real;

/// Consecutive samples above the threshold that make a touch: one outlier is not a touch, and the
/// kept samples undo the delay.
const TOUCH_SAMPLES: u32 = 2;
/// Consecutive samples below the threshold that make a lift-off.
const RELEASE_SAMPLES: u32 = 3;
/// Samples next to a contact, on either side, that the resting force is not taken from: a probe that
/// is pushed by less than the noise is not in free air. Up to the touch, gel at 1.2 Hz raised the
/// resting force by 2 mN, which put the surface 1.2 µm too deep.
const REST_MARGIN: u32 = 32;

/// What the contact detector knows after the newest sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact<T> {
    /// Where the probe is.
    pub phase: Phase,
    /// Whether the newest sample is the first of its phase.
    pub changed: bool,
    /// Number of consecutive samples under load: since the touch, or since the force was last lost
    /// within the material by a retreat that the material cannot follow; 0 in free air.
    pub loaded_samples: u32,
    /// Whether the load began at the surface, and not where a lost force was regained. If it did, the
    /// law also explains the force before it, as far as the probe was in the material.
    pub loaded_from_surface: bool,
    /// The surface of this contact or of the last one; `None` before the first.
    pub surface: Option<SurfacePosition<T>>,
    /// Mean force in free air (N), to be subtracted.
    pub resting_force_n: T,
    /// Standard error of the resting force (N), for white noise and the drift that was seen.
    pub resting_force_error_n: T,
    /// How fast the resting force drifts, per sample (N).
    pub resting_force_drift_n: T,
    /// Whether the resting force has been seen while the probe moved in free air.
    pub zero_seen: bool,
    /// Whether the surface has pulled at the last touch or lift-off, which no law of contact here does.
    pub pulls: bool,
    /// Whether the newest sample has shown that the resting force was wrong: what was learned with it is
    /// wrong, too.
    pub zero_was_wrong: bool,
    /// Standard deviation of the noise of the raw force (N).
    pub force_noise_n: T,
    /// One count of the encoder (m): the smallest step that it has made, or as configured where that is more; 0 before
    /// the first motion.
    pub count_m: T,
    /// Smallest step that the position has made (m): less than a count where it is a mean of several readings.
    pub position_step_m: T,
}

impl<T> Contact<T> {
    /// The touch or lift-off at the newest sample, if there is one.
    pub fn event(&self) -> Option<Event> {
        match (self.changed, self.phase) {
            (true, Phase::Contact) => Some(Event::Contact),
            (true, _) => Some(Event::Release),
            (false, _) => None,
        }
    }
}

/// State of the contact detector.
#[derive(Clone, Debug)]
pub struct ContactState<T> {
    noise: Noise<T>,
    /// Noise of the load cell itself, where the samples went through a window before they came here.
    raw_noise: Noise<T>,
    /// Position (m) and force (N) of the next sample as the sensors read them, where it went through one.
    raw: Option<(T, T)>,
    rest: RestingForce<T>,
    pull: Pull,
    /// Where the probe was at the first sample (m), and how far it went from there while settling.
    settling: Option<(T, T)>,
    /// Number of samples in free air since the last contact.
    free_samples: u32,
    position_step: Step<T>,
    /// Those of the sensors themselves.
    count: Step<T>,
    force_step: Step<T>,
    configured_count_m: Option<T>,
    /// Noise of the raw force, without the error of its counts: a tangent weighs its samples by what they scatter.
    measured_noise_n: T,
    /// The unit of the thresholds (N): the noise, or the wander of the force in free air if larger.
    wander_n: T,
    phase: Phase,
    loaded_samples: u32,
    loaded_from_surface: bool,
    /// Whether the probe has been outside since the last load began.
    outside_since_load: bool,
    /// Number of consecutive samples that speak for the other phase.
    opposing_samples: u32,
    surface: Option<SurfacePosition<T>>,
    /// Whether the probe has been outside since it last touched a surface. If it has not, a lost and
    /// regained force is a fast retreat within the material and not an impact.
    outside_since_touch: bool,
    /// Position (m) and force without the resting force (N) of the last samples.
    recent: [(T, T); PRE_TRIGGER],
    newest: usize,
}

impl<T: Real> ContactState<T> {
    /// The state before the first sample.
    pub fn new(params: &ContactParams<T>) -> Self {
        ContactState {
            noise: Noise::default(),
            raw_noise: Noise::default(),
            raw: None,
            rest: RestingForce::default(),
            pull: Pull::default(),
            settling: None,
            free_samples: 0,
            position_step: Step::default(),
            count: Step::default(),
            force_step: Step::default(),
            configured_count_m: params.count_m,
            measured_noise_n: params.noise_floor_n,
            wander_n: params.noise_floor_n,
            phase: Phase::Settling,
            loaded_samples: 0,
            loaded_from_surface: false,
            outside_since_load: true,
            opposing_samples: 0,
            surface: None,
            outside_since_touch: true,
            recent: [(T::zero(), T::zero()); PRE_TRIGGER],
            newest: 0,
        }
    }

    /// Mean force in free air (N); 0 while settling.
    pub fn resting_force_n(&self) -> T {
        self.rest.mean_n
    }

    /// The surface of this contact or of the last one; `None` before the first.
    pub fn surface(&self) -> Option<SurfacePosition<T>> {
        self.surface
    }

    /// One count of the encoder (m), see [`Contact::count_m`].
    pub(super) fn count_m(&self) -> T {
        self.count.at_least(self.configured_count_m)
    }

    /// Standard deviation of the noise of the raw force (N), at least that of its counts: where they are
    /// coarser than the noise, free air shows neither.
    pub fn force_noise_n(&self) -> T {
        let count_n = self.force_step.smallest() * T::from_f64(COUNT_ERROR);
        self.measured_noise_n.max_of(count_n)
    }

    /// Standard error of the resting force (N): by chance, drift and rounding.
    fn resting_force_error_n(&self) -> T {
        let error_n = self.rest.std_error_n(self.measured_noise_n);
        match rounding_n(self.measured_noise_n, self.force_step.smallest()) {
            Some(rounding_n) => (error_n * error_n + rounding_n * rounding_n).sqrt(),
            None => error_n,
        }
    }

    /// Takes position (m) and force (N) as the sensors read them, where those of the next sample went through a
    /// window: counts and noise are theirs.
    pub fn observe_raw(&mut self, position_m: T, force_n: T) {
        self.raw = Some((position_m, force_n));
    }

    /// Takes one raw sample and decides whether the probe touches.
    pub fn update(&mut self, params: &ContactParams<T>, sample: &Sample<T>) -> Contact<T> {
        let before = self.phase;
        let raw = self.raw.take();
        let (position_m, force_n) = raw.unwrap_or((sample.position_m, sample.force_n));
        self.position_step.observe(sample.position_m);
        self.count.observe(position_m);
        self.force_step.observe(force_n);
        let mut shift = Shift::None;
        if self.phase == Phase::Settling {
            self.settle(params, sample, force_n);
        } else {
            shift = self.observe_rest(params, sample);
            self.remember(sample);
            self.decide(params, sample);
        }
        Contact {
            phase: self.phase,
            changed: self.phase != before && before != Phase::Settling,
            loaded_samples: self.loaded_samples,
            loaded_from_surface: self.loaded_from_surface,
            surface: self.surface,
            resting_force_n: self.rest.mean_n,
            resting_force_error_n: self.resting_force_error_n(),
            resting_force_drift_n: self.rest.drift_per_sample_n(),
            zero_seen: params.surface.is_some() || self.rest.seen_in_free_air(),
            pulls: self.pull.has_pulled,
            zero_was_wrong: matches!(shift, Shift::Elsewhere),
            force_noise_n: self.force_noise_n(),
            count_m: self.count_m(),
            position_step_m: self.position_step.smallest(),
        }
    }

    /// `raw_n` is the force (N) as the load cell read it.
    fn settle(&mut self, params: &ContactParams<T>, sample: &Sample<T>, raw_n: T) {
        self.noise.update(sample.force_n);
        self.raw_noise.update(raw_n);
        let count_m = self.count_m();
        let (from_m, way_m) = self.settling.get_or_insert((sample.position_m, T::zero()));
        *way_m = way_m.max_of((sample.position_m - *from_m).abs());
        // A force that changes under way may be a contact's: how far it wandered is no measure of free air.
        let moves = *way_m > T::from_f64(WAY_COUNTS) * count_m;
        if self.noise.samples() >= params.settle_samples {
            self.rest.settle(self.noise.mean_n(), self.noise.samples());
            let measured = self
                .noise
                .white_noise_n()
                .max_of(self.raw_noise.white_noise_n());
            let sigma = params.configured_noise_n.unwrap_or(measured);
            self.measured_noise_n = params.noise_floor_n.max_of(sigma);
            self.wander_n = match params.configured_noise_n {
                None if !moves => self.measured_noise_n.max_of(self.noise.std_dev_n()),
                _ => self.measured_noise_n,
            };
            self.phase = Phase::Free;
            self.free_samples = REST_MARGIN;
        }
        self.recent = [(sample.position_m, T::zero()); PRE_TRIGGER];
    }

    fn remember(&mut self, sample: &Sample<T>) {
        self.newest = (self.newest + 1) % PRE_TRIGGER;
        if let Some(slot) = self.recent.get_mut(self.newest) {
            *slot = (sample.position_m, sample.force_n - self.rest.mean_n);
        }
    }

    /// Asks what a sample says about the resting force; free air is left at once where zero is elsewhere.
    fn observe_rest(&mut self, params: &ContactParams<T>, sample: &Sample<T>) -> Shift {
        let force_n = sample.force_n - self.rest.mean_n;
        let below_n = params.release_sigma * self.wander_n;
        if self.phase == Phase::Free && force_n.abs() < below_n {
            self.rest.observe_free(sample.position_m);
        }
        let (noise_n, count_m) = (self.measured_noise_n, self.count_m());
        let position_m = sample.position_m;
        self.pull.observe(self.phase, force_n < -below_n);
        // A lift-off in units of the noise: how far the force wandered while settling is no drift.
        let units = (params.release_sigma, noise_n, count_m);
        let forces = (sample.force_n, force_n);
        let shift = self.rest.observe(position_m, forces, below_n, units);
        if matches!(shift, Shift::Elsewhere) && params.surface.is_none() {
            self.leave_what_was_no_contact(position_m);
        }
        shift
    }

    /// Begins again in free air: what was measured from a zero that was wrong is forgotten. Rare, and kept out of
    /// the loop.
    #[cold]
    #[inline(never)]
    fn leave_what_was_no_contact(&mut self, position_m: T) {
        // How far the force wandered while settling is not what thresholds are measured in: that was no free air.
        self.wander_n = self.measured_noise_n;
        // And what seemed to pull lay below a zero that was none.
        self.pull = Pull::default();
        self.phase = Phase::Free;
        self.opposing_samples = 0;
        self.outside_since_touch = true;
        self.outside_since_load = true;
        self.recent = [(position_m, T::zero()); PRE_TRIGGER];
    }

    fn decide(&mut self, params: &ContactParams<T>, sample: &Sample<T>) {
        let force_n = sample.force_n - self.rest.mean_n;
        let below_n = params.release_sigma * self.wander_n;
        self.decide_phase(params, sample.position_m, force_n, below_n);
        let outside = self
            .surface
            .is_some_and(|surface| sample.position_m < surface.position_m);
        self.outside_since_touch |= outside;
        self.outside_since_load |= outside;
        if self.phase == Phase::Contact && force_n > below_n {
            if self.loaded_samples == 0 {
                self.loaded_from_surface = core::mem::take(&mut self.outside_since_load);
            }
            self.loaded_samples = self.loaded_samples.saturating_add(1);
        } else {
            self.loaded_samples = 0;
        }
        self.free_samples = if self.phase == Phase::Free {
            self.free_samples.saturating_add(1)
        } else {
            0
        };
        if self.free_samples > 2 * REST_MARGIN {
            self.follow_resting_force(params);
        }
    }

    /// Changes the phase when enough consecutive samples speak for the other one; a force below `below_n` speaks
    /// for free air.
    fn decide_phase(&mut self, params: &ContactParams<T>, position_m: T, force_n: T, below_n: T) {
        let touching = self.phase == Phase::Contact;
        let opposes = match params.surface {
            Some(surface_m) => (position_m > surface_m) != touching,
            None if touching => force_n < below_n,
            None => force_n > params.touch_sigma * self.wander_n,
        };
        self.opposing_samples = if opposes {
            self.opposing_samples + 1
        } else {
            0
        };
        let (needed, other) = match touching {
            true => (RELEASE_SAMPLES, Phase::Free),
            false => (TOUCH_SAMPLES, Phase::Contact),
        };
        if self.opposing_samples >= needed {
            self.opposing_samples = 0;
            self.phase = other;
            if !touching && core::mem::take(&mut self.outside_since_touch) {
                let surface = self.locate(params);
                let count_m = self.count_m();
                let noise = (self.measured_noise_n, params.rest_gain);
                self.rest
                    .touched(surface.position_m, position_m, count_m, noise);
                self.surface = Some(surface);
            }
        }
    }

    /// Position (m) and force without the resting force (N) this many samples before the newest.
    fn before(&self, samples: usize) -> (T, T) {
        let slot = (self.newest + PRE_TRIGGER - samples) % PRE_TRIGGER;
        self.recent.get(slot).copied().unwrap_or_default()
    }

    /// Follows the resting force with the force [`REST_MARGIN`] samples ago: a touch right after it
    /// would be known by now.
    fn follow_resting_force(&mut self, params: &ContactParams<T>) {
        let (position_m, force_n) = self.before(REST_MARGIN as usize);
        if force_n.abs() < T::from_f64(3.0) * self.wander_n {
            self.rest
                .follow(position_m, force_n, params.rest_gain, self.measured_noise_n);
        }
    }

    /// Finds the position of impact: that of the last sample before the touch whose force is within 1σ
    /// of rest. Its bias is of the order of the way from there to the touch, so half of that way is the
    /// standard error. A slow approach is still in contact in the oldest of the samples kept; there the
    /// tangent says how far back the surface is.
    fn locate(&mut self, params: &ContactParams<T>) -> SurfacePosition<T> {
        if let Some(position_m) = params.surface {
            return SurfacePosition {
                position_m,
                std_error_m: T::zero(),
            };
        }
        let mut tangent = Tangent::of(&self.recent);
        if let Some(surface) = tangent.surface(self.measured_noise_n) {
            let way_m = self.before(0).0 - surface.position_m;
            tangent.force_n += self.rest.go_back(tangent.samples_for(way_m));
            return tangent.surface(self.measured_noise_n).unwrap_or(surface);
        }
        let touch = self.before(0);
        let impact = (1..PRE_TRIGGER)
            .map(|samples| self.before(samples))
            .find(|(_, force_n)| *force_n < self.wander_n)
            .unwrap_or(touch);
        SurfacePosition {
            position_m: impact.0,
            std_error_m: T::from_f64(0.5) * (touch.0 - impact.0).abs(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::config::{Config, Surface};

    const NOISE: f64 = 0.02;

    fn params(surface: Surface) -> ContactParams<f64> {
        let mut config = Config::default();
        config.contact.surface = surface;
        config.contact.force_noise_n = Some(NOISE as f32);
        ContactParams::validate(&config).unwrap()
    }

    /// Approach at 10 mm/s from −1 mm onto a spring of 2 N/mm at 0, then retract.
    fn approach(params: &ContactParams<f64>, rest_n: f64) -> (Vec<Contact<f64>>, f64) {
        let mut state = ContactState::new(params);
        let mut out = Vec::new();
        let positions = core::iter::repeat_n(-1.0, 300)
            .chain((0..300).map(|i| -1.0 + 0.01 * f64::from(i)))
            .chain((0..300).map(|i| 2.0 - 0.01 * f64::from(i)));
        for mm in positions {
            let force_n = 2.0 * mm.max(0.0) + rest_n;
            out.push(state.update(
                params,
                &Sample {
                    position_m: mm * 1e-3,
                    force_n,
                    ..Sample::default()
                },
            ));
        }
        let at = out.iter().position(|c| c.changed).unwrap();
        (out, at as f64)
    }

    extern crate std;
    use std::vec::Vec;

    #[test]
    fn the_surface_is_found_before_the_touch_and_its_error_is_covered() {
        let params = params(Surface::AtImpact);
        let (contacts, touched_at) = approach(&params, 0.7);
        // 6σ = 0.12 N is 60 µm deep: 6 samples after the surface, and one more for the run.
        assert!((406.0..=408.0).contains(&touched_at), "{touched_at}");
        let surface = contacts[420].surface.unwrap();
        assert!(surface.position_m.abs() < 11e-6, "{surface:?}");
        // The second sample above 6σ is 70 µm deep: the resting force does not follow the approach.
        assert!((34e-6..36e-6).contains(&surface.std_error_m), "{surface:?}");
    }

    #[test]
    fn the_noise_is_that_of_the_cell_where_samples_went_through_a_window() {
        let params = ContactParams::<f64>::validate(&Config::default()).unwrap();
        let noise = |i: u32| if i.is_multiple_of(2) { 0.02 } else { -0.02 };
        let settled = |observes: bool| {
            let mut state = ContactState::new(&params);
            for i in 0..300 {
                if observes {
                    state.observe_raw(0.0, noise(i));
                }
                let averaged = Sample {
                    time_us: u64::from(i) * 1000,
                    force_n: 0.01 * noise(i),
                    ..Sample::default()
                };
                state.update(&params, &averaged);
            }
            state.force_noise_n()
        };
        // Alternating signs have second differences of four times their size.
        let white = 0.08 / libm::sqrt(6.0);
        assert!((settled(true) / white - 1.0).abs() < 1e-6);
        assert!((settled(false) / white - 0.01).abs() < 1e-6);
    }

    #[test]
    fn counts_are_those_of_the_encoder_where_samples_went_through_a_window() {
        let counts = |configured: Option<f32>, observes: bool| {
            let mut config = Config::default();
            config.contact.position_step_m = configured;
            let params = ContactParams::<f64>::validate(&config).unwrap();
            let mut state = ContactState::new(&params);
            for i in 0..300_u32 {
                if observes {
                    state.observe_raw(1e-6 * f64::from(i / 3), 0.0);
                }
                let averaged = Sample {
                    time_us: u64::from(i) * 1000,
                    position_m: 1e-6 / 3.0 * f64::from(i),
                    ..Sample::default()
                };
                state.update(&params, &averaged);
            }
            state.count_m()
        };
        for (configured, observes, expected) in [
            (None, false, 1e-6 / 3.0),
            (None, true, 1e-6),
            (Some(2e-6), true, 2e-6),
            (Some(1.1e-6), true, 1e-6),
        ] {
            let found = counts(configured, observes);
            assert!((found / expected - 1.0).abs() < 1e-6, "{found} {expected}");
        }
    }

    #[test]
    fn the_resting_force_is_taken_off() {
        let (contacts, _) = approach(&params(Surface::AtImpact), -0.4);
        assert!((contacts[899].resting_force_n + 0.4).abs() < 1e-3);
        assert_eq!(contacts[899].phase, Phase::Free);
    }

    #[test]
    fn lift_off_waits_for_a_lower_force_than_touch() {
        let (contacts, _) = approach(&params(Surface::AtImpact), 0.0);
        let released = contacts.iter().rposition(|c| c.changed).unwrap();
        // Back at 3σ = 0.06 N, 30 µm before the surface (sample 800), plus a run of 3.
        assert!((798..=802).contains(&released), "{released}");
    }

    #[test]
    fn a_known_surface_needs_no_force() {
        let surface = Surface::Known { position_m: 0.0005 };
        let (contacts, touched_at) = approach(&params(surface), 0.0);
        assert!((451.0..=453.0).contains(&touched_at), "{touched_at}");
        let found = contacts[500].surface.unwrap();
        assert_eq!(
            (found.position_m, found.std_error_m),
            (f64::from(0.0005_f32), 0.0)
        );
    }

    #[test]
    fn a_force_that_is_lost_and_regained_within_the_material_is_no_new_surface() {
        let params = params(Surface::AtImpact);
        let mut state = ContactState::new(&params);
        let approach = (0..600).map(|i| f64::from(i - 400) * 1e-5);
        let mut surfaces = Vec::new();
        for (i, position_m) in approach.chain(core::iter::repeat_n(2e-3, 100)).enumerate() {
            // Twenty samples without force, 2 mm deep.
            let lost = (620..640).contains(&i);
            let force_n = if lost {
                0.0
            } else {
                2000.0 * position_m.max(0.0)
            };
            let sample = Sample {
                position_m,
                force_n,
                ..Sample::default()
            };
            let contact = state.update(&params, &sample);
            if contact.event() == Some(Event::Contact) {
                surfaces.push(contact.surface.unwrap().position_m);
            }
        }
        assert_eq!(surfaces.len(), 2);
        assert_eq!(surfaces[0], surfaces[1]);
    }

    #[test]
    fn one_outlier_is_no_touch() {
        let params = params(Surface::AtImpact);
        let mut state = ContactState::new(&params);
        for i in 0..1000 {
            let force_n = if i == 700 { 5.0 } else { 0.0 };
            let contact = state.update(
                &params,
                &Sample {
                    force_n,
                    ..Sample::default()
                },
            );
            assert_ne!(contact.phase, Phase::Contact);
        }
    }
}
