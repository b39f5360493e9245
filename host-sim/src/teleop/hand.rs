//! The operator's impedance, identified at the master from the hand's force and the handle's position.
//!
//! F_h = k(x_i − x) + b(v_i − v) − m·a. The intention x_i is unknown, and the motion follows from it: a fit
//! of everything would find the intention's impedance and not the hand's. People intend little above
//! 2 Hz, while contacts, friction and a small known force at the master move the handle well beyond. So
//! force and position go through the same band-pass of 3 to 20 Hz, in which −F_h = k·x + b·v + m·a holds,
//! and the core's recursive least-squares estimator with a memory fits m, b and k there. A change of the grip
//! shows as residuals that are suddenly large: the force has a step, after which the band-pass would ring for
//! 1.5 s. It then starts anew on what is left of a parabola through the last instants, which is how an intention
//! goes on, and the memory is short for a while.

use std::collections::VecDeque;
use std::f64::consts::{PI, TAU};

use estimator_core::estimate::rls::Rls;

use crate::signal::parabola;

/// The band in which the intention has no part (Hz).
pub const BAND_HZ: (f64, f64) = (3.0, 20.0);
/// Time constant of the memory (s): with 20 mN of noise on the load cell and 0.3 N of known force, as long as
/// it takes to 3 %.
const MEMORY_S: f64 = 12.0;
/// The memory while another grip is learned (s), and for how long it is that short: what a parabola leaves of an
/// intention has gone through the band-pass by then. Measured on a stiffness of 700 that becomes 1200 N/m in the
/// simulated system: within 15 % after 0.92 s; 1.04 s with 0.15 s of memory, 1.55 s without a start anew.
const SHORT_MEMORY_S: f64 = 0.08;
const RINGS_S: f64 = 0.8;
/// The band-pass starts anew so long after a change was seen (s), and the parabola goes through as many samples
/// before it, and their middle: all of them are of the new grip.
const RESTARTS_AFTER_S: f64 = 0.1;
const HALF_PARABOLA: usize = 40;
/// Time constants over which residuals are compared (s).
const RECENT_S: f64 = 0.06;
const USUAL_S: f64 = 4.0;
/// Ratio of the residuals' variances at which the grip has changed. Measured: at most 5 without a change,
/// at least 30 with one of a factor 1.5.
const CHANGED: f64 = 12.0;
/// White noise keeps 2·(20 − 3) of 1000 independent samples a second in the band.
const CORRELATION: f64 = 1000.0 / (2.0 * (BAND_HZ.1 - BAND_HZ.0));

/// An estimate of the hand: value and standard error of each parameter.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HandEstimate {
    /// m (kg)
    pub mass_kg: (f64, f64),
    /// b (N s/m)
    pub damping_ns_per_m: (f64, f64),
    /// k (N/m)
    pub stiffness_n_per_m: (f64, f64),
}

impl HandEstimate {
    /// Whether the hand is known well enough to be used: stiffness and damping to a quarter.
    pub fn is_known(&self) -> bool {
        let known = |(value, error): (f64, f64)| value > 0.0 && error < 0.25 * value;
        known(self.stiffness_n_per_m) && known(self.damping_ns_per_m)
    }
}

/// A section of second order, in the transposed direct form II.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Section {
    b: [f64; 3],
    a: [f64; 2],
    state: [f64; 2],
}

impl Section {
    /// A Butterworth section: a low pass, or a high pass.
    fn new(cutoff_hz: f64, q: f64, period_s: f64, high: bool) -> Section {
        let k = (PI * cutoff_hz * period_s).tan();
        let norm = 1.0 / (1.0 + k / q + k * k);
        let b = match high {
            true => [norm, -2.0 * norm, norm],
            false => [k * k * norm, 2.0 * k * k * norm, k * k * norm],
        };
        Section {
            b,
            a: [2.0 * (k * k - 1.0) * norm, (1.0 - k / q + k * k) * norm],
            state: [0.0; 2],
        }
    }

    fn step(&mut self, x: f64) -> f64 {
        let y = self.b[0] * x + self.state[0];
        self.state[0] = self.b[1] * x - self.a[0] * y + self.state[1];
        self.state[1] = self.b[2] * x - self.a[1] * y;
        y
    }
}

/// The band-pass: Butterworth, of eighth order towards the intention, whose 10 mm at 0.8 Hz must not reach the
/// 50 µm in the band, and of fourth order towards the noise.
#[derive(Clone, Copy, Debug)]
struct BandPass([Section; 6]);

impl BandPass {
    fn new(period_s: f64) -> BandPass {
        let high = |q| Section::new(BAND_HZ.0, q, period_s, true);
        let low = |q| Section::new(BAND_HZ.1, q, period_s, false);
        // The quality factors of Butterworth filters of eighth and fourth order.
        BandPass([
            high(0.509_796),
            high(0.601_345),
            high(0.899_976),
            high(2.562_915),
            low(0.541_196),
            low(1.306_563),
        ])
    }

    fn step(&mut self, x: f64) -> f64 {
        self.0.iter_mut().fold(x, |x, section| section.step(x))
    }
}

/// Units in which the three parameters are near 1: 1 kg, 10 N s/m, 1000 N/m.
const UNITS: [f64; 3] = [1.0, 10.0, 1000.0];

/// The covariance of a hand of which nothing is known.
const UNKNOWN: f64 = 1e4;

/// A signal as it would go on: value, rate and half of the acceleration, at a time 0.
#[derive(Clone, Copy, Debug, Default)]
struct Course([f64; 3]);

impl Course {
    /// Through the last samples, at the middle one of which it is 0.
    fn through(samples: &[f64], period_s: f64) -> Course {
        let half = samples.len() / 2;
        let (value, rate) = parabola(samples, half, half, period_s);
        let mean = samples.iter().sum::<f64>() / samples.len() as f64;
        // The mean of t² over −h…h periods.
        let spread_s2 = (half * (half + 1)) as f64 / 3.0 * period_s * period_s;
        Course([value, rate, (mean - value) / spread_s2])
    }

    fn at(&self, time_s: f64) -> f64 {
        let [value, rate, bend] = self.0;
        value + time_s * (rate + time_s * bend)
    }
}

/// The identifier of the hand.
#[derive(Clone, Debug)]
pub struct HandIdentifier {
    period_s: f64,
    /// By how much of a period the force is older than the position.
    force_late: f64,
    force: BandPass,
    position: BandPass,
    /// The last two positions and the last force behind the band-pass.
    positions: [f64; 2],
    last_force_n: f64,
    rls: Rls<f64, 3>,
    /// Mean squares of the residuals.
    recent: f64,
    usual: f64,
    samples: u64,
    /// For how much longer the memory is short (s).
    rings_s: f64,
    /// The last forces and positions.
    last: [VecDeque<f64>; 2],
    /// The courses of force and position without which the band-pass has started, and the time since (s).
    courses: Option<[Course; 2]>,
    time_s: f64,
    /// How long it is until the band-pass starts anew (s).
    restarts_in_s: Option<f64>,
}

impl HandIdentifier {
    /// An identifier for samples at this period (s), whose force is so much of a period older than the position: 0
    /// where both are means over the same instants, as on the boards.
    pub fn new(period_s: f64, force_late: f64) -> HandIdentifier {
        HandIdentifier {
            period_s,
            force_late,
            force: BandPass::new(period_s),
            position: BandPass::new(period_s),
            positions: [0.0; 2],
            last_force_n: 0.0,
            rls: unknown(),
            recent: 0.0,
            usual: 0.0,
            samples: 0,
            rings_s: RINGS_S,
            last: Default::default(),
            courses: None,
            time_s: 0.0,
            restarts_in_s: None,
        }
    }

    /// Takes the hand's force on the handle (N) and the handle's position (m).
    pub fn update(&mut self, force_n: f64, position_m: f64) {
        for (last, value) in self.last.iter_mut().zip([force_n, position_m]) {
            if last.len() > 2 * HALF_PARABOLA {
                last.pop_front();
            }
            last.push_back(value);
        }
        self.time_s += self.period_s;
        if self.restarts_now() {
            return self.restart();
        }
        // The band-pass starts at rest where the signals are.
        let at_rest = [force_n, position_m].map(|value| Course([value, 0.0, 0.0]));
        let [of_force, of_position] = *self.courses.get_or_insert(at_rest);
        let force = self.force.step(force_n - of_force.at(self.time_s));
        let position = self.position.step(position_m - of_position.at(self.time_s));
        let [before, last] = self.positions;
        let speed = (position - before) / (2.0 * self.period_s);
        let acceleration = (position - 2.0 * last + before) / (self.period_s * self.period_s);
        let force_then = self.last_force_n + self.force_late * (force - self.last_force_n);
        (self.positions, self.last_force_n) = ([last, position], force);
        self.samples += 1;
        let regressor = [
            -acceleration * UNITS[0],
            -speed * UNITS[1],
            -last * UNITS[2],
        ];
        self.learn(force_then, regressor);
    }

    /// Whether the band-pass starts anew at this sample.
    fn restarts_now(&mut self) -> bool {
        let left_s = self.restarts_in_s.map(|left_s| left_s - self.period_s);
        self.restarts_in_s = left_s.filter(|left_s| *left_s > 0.0);
        left_s.is_some() && self.restarts_in_s.is_none()
    }

    /// Starts the band-pass anew, without the courses on which the signals are, and forgets the hand.
    fn restart(&mut self) {
        let period_s = self.period_s;
        self.courses = Some(
            self.last
                .each_mut()
                .map(|last| Course::through(last.make_contiguous(), period_s)),
        );
        // The newest sample is so long after the middle one.
        self.time_s = (self.last[0].len() / 2) as f64 * period_s;
        self.force = BandPass::new(period_s);
        self.position = BandPass::new(period_s);
        (self.positions, self.last_force_n) = ([0.0; 2], 0.0);
        self.rls.covariance = unknown().covariance;
    }

    fn learn(&mut self, force: f64, phi: [f64; 3]) {
        let phi = phi.into();
        let innovation = force - self.rls.predict(&phi);
        let recent = (self.period_s / RECENT_S).min(1.0);
        let usual = (self.period_s / USUAL_S).max(1.0 / (self.samples + 1) as f64);
        self.recent += recent * (innovation * innovation - self.recent);
        if self.recent > CHANGED * self.usual && self.is_settled() {
            (self.rings_s, self.samples) = (RINGS_S, 0);
            self.restarts_in_s = Some(RESTARTS_AFTER_S);
        }
        self.rings_s -= self.period_s;
        self.usual += usual * (innovation * innovation - self.usual);
        // Nothing is forgotten for a sample that teaches nothing: φᵀPφ is 3(1 − β) in the mean while the motion
        // goes on, and next to nothing where a stiff contact holds the handle.
        let forgets = |memory_s: f64| -(-self.period_s / memory_s).exp_m1();
        let beta = match self.rings_s > 0.0 {
            true => 1.0 - forgets(SHORT_MEMORY_S),
            false => 1.0 - forgets(MEMORY_S).min(self.rls.covariance.variance(&phi) / 3.0),
        };
        self.rls.update(&phi, force, beta);
    }

    /// Whether residuals can be told from those of a start.
    fn is_settled(&self) -> bool {
        self.samples as f64 * self.period_s > 1.0
    }

    /// The estimate so far.
    pub fn estimate(&self) -> HandEstimate {
        let noise = self.usual * CORRELATION;
        let variances = self.rls.covariance.variances();
        let of = |i: usize| {
            let error = (variances[i] * noise).sqrt();
            (self.rls.theta[i] * UNITS[i], error * UNITS[i])
        };
        HandEstimate {
            mass_kg: of(0),
            damping_ns_per_m: of(1),
            stiffness_n_per_m: of(2),
        }
    }
}

fn unknown() -> Rls<f64, 3> {
    Rls::new([0.0; 3].into(), UNKNOWN)
}

/// A small known force at the master, which shows the hand where it does not move by itself: three sines of
/// equal amplitude within the band.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Excitation {
    /// The largest force (N).
    pub force_n: f64,
}

/// Frequencies of the sines (Hz): where stiffness, damping and mass have their parts.
const TONES_HZ: [f64; 3] = [3.7, 6.1, 11.3];

impl Excitation {
    /// The force at a time (s).
    pub fn at(&self, time_s: f64) -> f64 {
        let sum: f64 = TONES_HZ.iter().map(|hz| (TAU * hz * time_s).sin()).sum();
        self.force_n * sum / TONES_HZ.len() as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A hand that moves by itself within the band, whose force is the closed form.
    fn identified(seconds: f64, change: Option<(f64, f64)>) -> HandIdentifier {
        let period_s = 1e-3;
        let mut identifier = HandIdentifier::new(period_s, 0.0);
        for sample in 0..(seconds / period_s) as u32 {
            let t = f64::from(sample) * period_s;
            let (mut x, mut v, mut a) = (0.0, 0.0, 0.0);
            for (amplitude, hz) in [(2e-4, 3.7), (1e-4, 6.1), (5e-5, 11.3)] {
                let omega = TAU * hz;
                x += amplitude * (omega * t).sin();
                v += amplitude * omega * (omega * t).cos();
                a -= amplitude * omega * omega * (omega * t).sin();
            }
            let stiffness = match change {
                Some((at_s, to)) if t >= at_s => to,
                _ => 700.0,
            };
            // An intention of 10 mm at 0.8 Hz, in phase with no part of the motion.
            let intended = 1e-2 * (TAU * 0.8 * t).sin();
            identifier.update(stiffness * (intended - x) - 9.0 * v - 0.35 * a, x);
        }
        identifier
    }

    #[test]
    fn a_hand_in_the_band_is_identified_under_an_intention_a_hundred_times_as_large() {
        let found = identified(6.0, None).estimate();
        for ((value, _), exact) in [
            (found.mass_kg, 0.35),
            (found.damping_ns_per_m, 9.0),
            (found.stiffness_n_per_m, 700.0),
        ] {
            assert!((value / exact - 1.0).abs() < 0.02, "{found:?}");
        }
        assert!(found.is_known());
    }

    #[test]
    fn a_change_of_the_grip_is_followed_within_a_second() {
        let found = identified(7.0, Some((6.0, 1400.0))).estimate();
        assert!(
            (found.stiffness_n_per_m.0 / 1400.0 - 1.0).abs() < 0.15,
            "{found:?}"
        );
    }

    #[test]
    fn a_hand_that_does_not_move_is_not_known() {
        let mut identifier = HandIdentifier::new(1e-3, 0.0);
        for _ in 0..5000 {
            identifier.update(3.0, 1e-3);
        }
        assert!(!identifier.estimate().is_known());
    }

    #[test]
    fn the_excitation_stays_below_its_force() {
        let excitation = Excitation { force_n: 0.3 };
        let forces = (0..10_000).map(|ms| excitation.at(f64::from(ms) * 1e-3));
        let most = forces.map(f64::abs).fold(0.0, f64::max);
        assert!((0.2..=0.3).contains(&most), "{most}");
    }
}
