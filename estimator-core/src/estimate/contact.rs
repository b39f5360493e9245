//! Touch and lift-off, and where the surface is.
//!
//! Both are decided on raw samples: a filter smears the kink of a touch over its whole window
//! (21 ms by default, 250 µm at 12 mm/s). The thresholds are multiples of the measured noise.

use crate::estimate::config::{self, Config};
use crate::estimate::error::{ConfigError, require};
use crate::estimate::noise::Noise;
use crate::estimate::sample::Sample;
use crate::estimate::{Event, Phase};
use crate::maths::scalar::Real;

/// Raw samples kept from before a touch: at 6σ gel is already 0.1 mm deep, some 10 samples.
const PRE_TRIGGER: usize = 64;
/// Samples in a row that make a touch: one outlier is none, and the ring gives the delay back.
const TOUCH_RUN: u32 = 2;
/// Samples in a row that make a lift-off.
const RELEASE_RUN: u32 = 3;
/// The resting force follows the free-air force with this time constant (s).
const REST_TIME_S: f64 = 1.0;
/// Samples next to a contact, on either side, that the resting force is not taken from: what is
/// pushed by less than the noise is no free air. (Taken up to the touch, gel at 1.2 Hz raised the
/// resting force by 2 mN and put the surface 1.2 µm too deep.)
const REST_APART: u32 = 32;
/// Noise is never taken for less than this fraction of the reference force: a log without noise
/// would otherwise touch at its first rounding error.
pub const NOISE_FLOOR: f64 = 1e-4;

/// Coefficients of touch and lift-off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactParams<T> {
    surface: Option<T>,
    touch_sigma: T,
    release_sigma: T,
    configured_noise_n: Option<T>,
    noise_floor_n: T,
    settle_samples: u32,
    rest_gain: T,
}

impl<T: Real> ContactParams<T> {
    pub(crate) fn validate(config: &Config) -> Result<Self, ConfigError> {
        let contact = config.contact;
        require(
            (1.0..=100.0).contains(&contact.release_sigma),
            "contact.release_sigma",
            contact.release_sigma,
            "must lie between 1 and 100 standard deviations",
        )?;
        require(
            contact.touch_sigma >= contact.release_sigma && contact.touch_sigma <= 1000.0,
            "contact.touch_sigma",
            contact.touch_sigma,
            "must lie between release_sigma and 1000 standard deviations",
        )?;
        let noise = contact.force_noise_n.unwrap_or(0.0);
        require(
            (0.0..=1e6).contains(&noise),
            "contact.force_noise_n",
            noise,
            "must be a standard deviation in newtons, or absent",
        )?;
        let settle_samples = contact.settle_s * config.rate_hz;
        require(
            (10.0..=1e6).contains(&settle_samples),
            "contact.settle_s",
            contact.settle_s,
            "must cover 10 to 1 000 000 samples in free air",
        )?;
        let surface = match contact.surface {
            config::Surface::AtImpact => None,
            config::Surface::Known { position_m } => {
                require(
                    position_m.is_finite(),
                    "contact.surface.position_m",
                    position_m,
                    "must be a position in metres",
                )?;
                Some(T::from_f64(f64::from(position_m)))
            }
        };
        let from = |value: f32| T::from_f64(f64::from(value));
        Ok(ContactParams {
            surface,
            touch_sigma: from(contact.touch_sigma),
            release_sigma: from(contact.release_sigma),
            configured_noise_n: contact.force_noise_n.map(from),
            noise_floor_n: T::from_f64(NOISE_FLOOR * f64::from(config.reference.force_n)),
            settle_samples: settle_samples as u32,
            rest_gain: T::from_f64(1.0 / (REST_TIME_S * f64::from(config.rate_hz)).max(1.0)),
        })
    }

    /// Whether the surface is configured.
    pub fn surface_known(&self) -> bool {
        self.surface.is_some()
    }
}

/// A surface position with its uncertainty.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SurfacePosition<T> {
    /// Position (m).
    pub position_m: T,
    /// Standard error (m); 0 where it is known.
    pub std_error_m: T,
}

/// What the contact detector says about the newest sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact<T> {
    /// Where the probe is.
    pub phase: Phase,
    /// The phase differs from the last sample's.
    pub changed: bool,
    /// Raw samples since the touch, or since the force was last lost within the material (a retreat
    /// that the material cannot follow); 0 in free air.
    pub run: u32,
    /// The run began at the surface, and not where a lost force was regained: what the force did
    /// before it is the law's as well, as far as the probe was in the material.
    pub fresh: bool,
    /// The surface of this or the last contact, once there was one.
    pub surface: Option<SurfacePosition<T>>,
    /// Force in free air (N), to be taken off.
    pub rest_n: T,
    /// Standard error of it (N), of a force that is white.
    pub rest_error_n: T,
    /// Standard deviation of the raw force (N).
    pub noise_n: T,
    /// Smallest step that the position has made (m): one count of an encoder; 0 before it moves.
    pub position_step_m: T,
}

impl<T> Contact<T> {
    /// Touch or lift-off at the newest sample.
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
    /// The noise of the cell itself, where samples went through a window before they came here.
    cell: Noise<T>,
    raw_force_n: Option<T>,
    rest_n: T,
    /// 1 over the samples that the resting force is worth.
    rest_share: T,
    /// Samples in free air since the last contact.
    free: u32,
    position_step_m: T,
    last_position_m: Option<T>,
    sigma_n: T,
    /// What thresholds are multiples of: the noise, or the wander of the free-air force if larger.
    wander_n: T,
    phase: Phase,
    run: u32,
    fresh: bool,
    /// The probe has been outside since the last run.
    left: bool,
    /// Samples in a row that speak for the other phase.
    against: u32,
    surface: Option<SurfacePosition<T>>,
    /// The probe has been outside of the last surface since it last touched. If it has not, a lost
    /// and regained force is a fast retreat within the material and not an impact.
    outside: bool,
    ring: [(T, T); PRE_TRIGGER],
    newest: usize,
}

impl<T: Real> ContactState<T> {
    /// Before the first sample.
    pub fn new(params: &ContactParams<T>) -> Self {
        ContactState {
            noise: Noise::default(),
            cell: Noise::default(),
            raw_force_n: None,
            rest_n: T::zero(),
            rest_share: T::one(),
            free: 0,
            position_step_m: T::zero(),
            last_position_m: None,
            sigma_n: params.noise_floor_n,
            wander_n: params.noise_floor_n,
            phase: Phase::Settling,
            run: 0,
            fresh: false,
            left: true,
            against: 0,
            surface: None,
            outside: true,
            ring: [(T::zero(), T::zero()); PRE_TRIGGER],
            newest: 0,
        }
    }

    /// What the force reads in free air (N).
    pub fn resting_force_n(&self) -> T {
        self.rest_n
    }

    /// Position of the surface (m), once there is one.
    pub fn surface_m(&self) -> Option<T> {
        self.surface.map(|surface| surface.position_m)
    }

    /// Standard deviation of the raw force (N).
    pub fn force_noise_n(&self) -> T {
        self.sigma_n
    }

    /// The force (N) as the cell read it, when the next sample's has gone through a window.
    pub fn observe_raw_force(&mut self, force_n: T) {
        self.raw_force_n = Some(force_n);
    }

    /// Takes one raw sample.
    pub fn update(&mut self, params: &ContactParams<T>, sample: &Sample<T>) -> Contact<T> {
        let before = self.phase;
        self.measure_step(sample.position_m);
        if self.phase == Phase::Settling {
            self.settle(params, sample);
        } else {
            self.remember(sample);
            self.decide(params, sample);
        }
        Contact {
            phase: self.phase,
            changed: self.phase != before && before != Phase::Settling,
            run: self.run,
            fresh: self.fresh,
            surface: self.surface,
            rest_n: self.rest_n,
            rest_error_n: self.sigma_n * self.rest_share.sqrt(),
            noise_n: self.sigma_n,
            position_step_m: self.position_step_m,
        }
    }

    fn measure_step(&mut self, position_m: T) {
        let last = self.last_position_m.replace(position_m);
        let moved = (position_m - last.unwrap_or(position_m)).abs();
        let first = self.position_step_m == T::zero();
        if moved > T::zero() && (first || moved < self.position_step_m) {
            self.position_step_m = moved;
        }
    }

    fn settle(&mut self, params: &ContactParams<T>, sample: &Sample<T>) {
        self.noise.update(sample.force_n);
        if let Some(force_n) = self.raw_force_n.take() {
            self.cell.update(force_n);
        }
        if self.noise.seen() >= params.settle_samples {
            self.rest_n = self.noise.mean_n();
            self.rest_share = T::one() / T::from_f64(f64::from(self.noise.seen()));
            let measured = self.noise.sigma_n().max_of(self.cell.sigma_n());
            let sigma = params.configured_noise_n.unwrap_or(measured);
            self.sigma_n = params.noise_floor_n.max_of(sigma);
            self.wander_n = match params.configured_noise_n {
                Some(_) => self.sigma_n,
                None => self.sigma_n.max_of(self.noise.spread_n()),
            };
            self.phase = Phase::Free;
            self.free = REST_APART;
        }
        self.ring = [(sample.position_m, T::zero()); PRE_TRIGGER];
    }

    fn remember(&mut self, sample: &Sample<T>) {
        self.newest = (self.newest + 1) % PRE_TRIGGER;
        if let Some(slot) = self.ring.get_mut(self.newest) {
            *slot = (sample.position_m, sample.force_n - self.rest_n);
        }
    }

    fn decide(&mut self, params: &ContactParams<T>, sample: &Sample<T>) {
        let force = sample.force_n - self.rest_n;
        let touching = self.phase == Phase::Contact;
        let other = match params.surface {
            Some(surface) => (sample.position_m > surface) != touching,
            None if touching => force < params.release_sigma * self.wander_n,
            None => force > params.touch_sigma * self.wander_n,
        };
        self.against = if other { self.against + 1 } else { 0 };
        if self.against >= if touching { RELEASE_RUN } else { TOUCH_RUN } {
            self.against = 0;
            self.phase = if touching {
                Phase::Free
            } else {
                Phase::Contact
            };
            if !touching && self.outside {
                self.surface = Some(self.locate(params));
                self.outside = false;
            }
        }
        let out = self
            .surface
            .is_some_and(|surface| sample.position_m < surface.position_m);
        self.outside |= out;
        self.left |= out;
        let pressed = force > params.release_sigma * self.wander_n;
        if self.phase == Phase::Contact && pressed {
            if self.run == 0 {
                self.fresh = core::mem::take(&mut self.left);
            }
            self.run = self.run.saturating_add(1);
        } else {
            self.run = 0;
        }
        self.free = if self.phase == Phase::Free {
            self.free.saturating_add(1)
        } else {
            0
        };
        if self.free > 2 * REST_APART {
            self.follow_rest(params);
        }
    }

    /// Takes the force of a while ago: had that been next to a touch, it would be known by now.
    fn follow_rest(&mut self, params: &ContactParams<T>) {
        let then = (self.newest + PRE_TRIGGER - REST_APART as usize) % PRE_TRIGGER;
        let Some(&(_, force)) = self.ring.get(then) else {
            return;
        };
        if force.abs() < T::from_f64(3.0) * self.wander_n {
            let next = self.rest_share / (T::one() + self.rest_share);
            self.rest_share = params.rest_gain.max_of(next);
            self.rest_n += self.rest_share * force;
        }
    }

    /// The position of impact: back from the touch to the last sample whose force is within 1σ of
    /// rest. What is left is a bias of the order of the way from there to the touch, so half of
    /// that way is the standard error.
    fn locate(&self, params: &ContactParams<T>) -> SurfacePosition<T> {
        if let Some(position_m) = params.surface {
            return SurfacePosition {
                position_m,
                std_error_m: T::zero(),
            };
        }
        let (recent, older) = (
            self.ring.get(..=self.newest),
            self.ring.get(self.newest + 1..),
        );
        let mut back = recent
            .unwrap_or(&[])
            .iter()
            .rev()
            .chain(older.unwrap_or(&[]).iter().rev());
        let touch = back.next().copied().unwrap_or_default();
        let impact = back
            .find(|(_, force)| *force < self.wander_n)
            .copied()
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
    use crate::estimate::config::Surface;

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
        let settled = |hears: bool| {
            let mut state = ContactState::new(&params);
            for i in 0..300 {
                if hears {
                    state.observe_raw_force(noise(i));
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
    fn the_resting_force_is_taken_off() {
        let (contacts, _) = approach(&params(Surface::AtImpact), -0.4);
        assert!((contacts[899].rest_n + 0.4).abs() < 1e-3);
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
