//! The operator's impedance, identified at the master from the hand's force and the handle's position.
//!
//! F_h = k(x_i − x) + b(v_i − v) − m·a. The intention x_i is unknown, and the motion follows from it: a fit
//! of everything would find the intention's impedance and not the hand's. People intend little above
//! 2 Hz, while contacts, friction and a small known force at the master move the handle well beyond. So
//! force and position go through the same band-pass of 3 to 20 Hz, in which −F_h = k·x + b·v + m·a holds,
//! and the core's recursive least-squares estimator with a memory fits m, b and k there.
//!
//! A change of the grip shows as residuals that are suddenly large; so does an intention that starts or stops at once,
//! which is in the band as well. The band-pass then starts anew on what is left of a parabola through the last instants,
//! which is how an intention goes on, and another hand is learned beside the one of before, until one of them explains
//! the motion ([`doubt`]). The errors have a part for what an intention in the band may have done.

mod band;
mod doubt;

use std::collections::VecDeque;
use std::f64::consts::TAU;

use estimator_core::estimate::rls::Rls;

use band::{BandPass, Course};
use doubt::{
    Doubt, Filtered, THRESHOLDS, UNITS, Verdict, by_intention, handle, is_passive, unknown,
};

pub use band::BAND_HZ;

/// Time constant of the memory (s): with 20 mN of noise on the load cell and 0.3 N of known force, as long as
/// it takes to 3 %.
const MEMORY_S: f64 = 12.0;
/// The parabola goes through as many samples before its middle and after it.
const HALF_PARABOLA: usize = 40;
/// Time constants over which residuals are compared (s).
const RECENT_S: f64 = 0.06;
const USUAL_S: f64 = 4.0;
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

/// The identifier of the hand.
#[derive(Clone, Debug)]
pub struct HandIdentifier {
    period_s: f64,
    /// By how much of a period the force is older than the position.
    force_late: f64,
    /// The damping of the handle (N s/m).
    device_ns_per_m: f64,
    force: BandPass,
    position: BandPass,
    /// The last two positions and the last force behind the band-pass.
    positions: [f64; 2],
    last_force_n: f64,
    /// The hand as far as the motion was explained.
    rls: Rls<f64, 3>,
    /// What could be another hand, since residuals were last suddenly large.
    doubt: Option<Doubt>,
    /// Mean squares of the residuals (N²), and of the speed in the band (m²/s²).
    recent_n2: f64,
    usual_n2: f64,
    speed_m2: f64,
    samples: u64,
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
    /// where both are means over the same instants, as on the boards. The damping is that of the handle (N s/m).
    pub fn new(period_s: f64, force_late: f64, device_ns_per_m: f64) -> HandIdentifier {
        HandIdentifier {
            period_s,
            force_late,
            device_ns_per_m,
            force: BandPass::new(period_s),
            position: BandPass::new(period_s),
            positions: [0.0; 2],
            last_force_n: 0.0,
            rls: unknown(),
            doubt: None,
            recent_n2: 0.0,
            usual_n2: 0.0,
            speed_m2: 0.0,
            samples: 0,
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
        self.learn(&Filtered {
            force_n: force_then,
            speed_mps: speed,
            phi: regressor,
            period_s: self.period_s,
        });
    }

    /// Whether the band-pass starts anew at this sample.
    fn restarts_now(&mut self) -> bool {
        let left_s = self.restarts_in_s.map(|left_s| left_s - self.period_s);
        self.restarts_in_s = left_s.filter(|left_s| *left_s > 0.0);
        left_s.is_some() && self.restarts_in_s.is_none()
    }

    /// Starts the band-pass anew, without the courses on which the signals are.
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
        self.doubt = Some(Doubt::restarted());
    }

    fn learn(&mut self, sample: &Filtered) {
        let innovation_n = sample.force_n - self.rls.predict(&sample.phi.into());
        let recent = (self.period_s / RECENT_S).min(1.0);
        self.recent_n2 += recent * (innovation_n * innovation_n - self.recent_n2);
        if let Some(doubt) = self.doubt.take() {
            return self.weigh(doubt, sample, innovation_n);
        }
        if self.is_settled() && self.recent_n2 > THRESHOLDS.changed * self.usual_n2 {
            return self.begin_doubt(THRESHOLDS.restarts_after_s);
        }
        if self.is_settled() && !is_passive(&self.rls) {
            return self.begin_doubt(self.period_s);
        }
        let usual = (self.period_s / USUAL_S).max(1.0 / (self.samples + 1) as f64);
        let speed_m2 = sample.speed_mps * sample.speed_mps;
        self.usual_n2 += usual * (innovation_n * innovation_n - self.usual_n2);
        self.speed_m2 += usual * (speed_m2 - self.speed_m2);
        let since_s = self.samples as f64 * self.period_s;
        fit(&mut self.rls, sample, since_s);
    }

    fn begin_doubt(&mut self, restarts_in_s: f64) {
        self.restarts_in_s = Some(restarts_in_s);
        self.doubt = Some(Doubt::new());
    }

    /// Learns what could be another hand, and decides whether it is. Nothing is learned from a sample while the
    /// band-pass waits for its start anew.
    fn weigh(&mut self, mut doubt: Doubt, sample: &Filtered, before_n: f64) {
        let other_n = sample.force_n - doubt.other.predict(&sample.phi.into());
        let Some(since_s) = doubt.compare(sample, before_n, other_n) else {
            self.doubt = Some(doubt);
            return;
        };
        fit(&mut doubt.other, sample, since_s);
        match doubt.verdict(since_s, &self.rls, self.usual_n2, self.device_ns_per_m) {
            Verdict::Open => self.doubt = Some(doubt),
            Verdict::Again => self.begin_doubt(THRESHOLDS.restarts_after_s),
            Verdict::Neither => self.begin_doubt(self.period_s),
            Verdict::Before => self.recent_n2 = self.usual_n2,
            Verdict::Other => {
                self.recent_n2 = self.usual_n2;
                self.samples = (THRESHOLDS.rings_s / self.period_s) as u64;
                self.speed_m2 = doubt.speed_m2;
                self.rls = doubt.other;
            }
        }
    }

    /// Whether residuals can be told from those of a start.
    fn is_settled(&self) -> bool {
        self.samples as f64 * self.period_s > 1.0
    }

    /// The estimate so far. While it is open which of two hands it is, it is what was learned since, with an error that
    /// reaches to the hand of before and to zero.
    pub fn estimate(&self) -> HandEstimate {
        let restarted = self.doubt.as_ref().filter(|doubt| doubt.since_s.is_some());
        let rls = restarted.map_or(&self.rls, |doubt| &doubt.other);
        let noise_n2 = self.usual_n2 * CORRELATION;
        let variances = rls.covariance.variances();
        let device = self.device_ns_per_m;
        let intended = by_intention(&self.rls, self.usual_n2, self.speed_m2, device);
        let handle = handle(device);
        let of = |i: usize| {
            let value = rls.theta[i];
            let chance = (variances[i] * noise_n2).sqrt();
            let open = match self.doubt {
                Some(_) => value.abs() + (value - self.rls.theta[i]).abs(),
                None => 0.0,
            };
            let error = chance + intended * (value.abs() + handle[i]) + open;
            (value * UNITS[i], error * UNITS[i])
        };
        HandEstimate {
            mass_kg: of(0),
            damping_ns_per_m: of(1),
            stiffness_n_per_m: of(2),
        }
    }
}

/// Fits a hand to a sample, so long after the band-pass has started (s). Nothing is forgotten for a sample that teaches
/// nothing: φᵀPφ is 3(1 − β) in the mean while the motion goes on, and next to nothing where a stiff contact holds the
/// handle.
fn fit(rls: &mut Rls<f64, 3>, sample: &Filtered, since_s: f64) {
    let phi = sample.phi.into();
    let forgets = |memory_s: f64| -(-sample.period_s / memory_s).exp_m1();
    let beta = match since_s < THRESHOLDS.rings_s {
        true => 1.0 - forgets(THRESHOLDS.short_memory_s),
        false => 1.0 - forgets(MEMORY_S).min(rls.covariance.variance(&phi) / 3.0),
    };
    rls.update(&phi, sample.force_n, beta);
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
        watched(seconds, change, |_| 0.0, |_, _| {})
    }

    /// The same with another intention (m) on top, and somebody who looks at every sample (s).
    fn watched(
        seconds: f64,
        change: Option<(f64, f64)>,
        intends: impl Fn(f64) -> f64,
        mut looks: impl FnMut(f64, &HandIdentifier),
    ) -> HandIdentifier {
        let period_s = 1e-3;
        let mut identifier = HandIdentifier::new(period_s, 0.0, 120.0);
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
            let intended = 1e-2 * (TAU * 0.8 * t).sin() + intends(t);
            identifier.update(stiffness * (intended - x) - 9.0 * v - 0.35 * a, x);
            looks(t, &identifier);
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

    /// An intention that starts and stops at once is in the band: 21 mm at 60 mm/s, from 6.00 s to 6.35 s.
    #[test]
    fn an_intention_that_starts_and_stops_at_once_leaves_the_hand_known() {
        let (mut doubted, mut standing) = (0, 0);
        let ramp = |t: f64| 60e-3 * (t - 6.0).clamp(0.0, 0.35);
        let identifier = watched(8.5, None, ramp, |t, identifier| {
            let (value, error) = identifier.estimate().stiffness_n_per_m;
            let off = (value - 700.0).abs();
            doubted += u32::from(t > 6.0 && !identifier.estimate().is_known());
            standing += u32::from(t > 2.0 && off > 0.15 * 700.0 && off > 3.0 * error);
        });
        let found = identifier.estimate();
        assert!(doubted > 1000, "it is in doubt for {doubted} samples");
        // Until residuals have shown it, two hundredths of a second.
        assert!(standing < 20, "wrong for {standing} samples");
        assert!(found.is_known(), "{found:?}");
        // The bound of a known force; one second after the doubt, what it left has not faded altogether.
        assert!(
            (found.stiffness_n_per_m.0 / 700.0 - 1.0).abs() < 0.05,
            "{found:?}"
        );
    }

    #[test]
    fn a_hand_that_does_not_move_is_not_known() {
        let mut identifier = HandIdentifier::new(1e-3, 0.0, 120.0);
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
