//! Whether residuals that are suddenly large are another hand, or an intention that starts or stops at once.
//!
//! Both look alike while the band-pass rings. Afterwards the hand of before explains the motion again if it was an
//! intention, and what was learned since explains it better if the hand is another one. Until that is decided, neither
//! is known. What nothing explains is not learned from.

use estimator_core::estimate::rls::Rls;

use super::band::BAND_HZ;

/// Units in which the three parameters are near 1: 1 kg, 10 N s/m, 1000 N/m.
pub(super) const UNITS: [f64; 3] = [1.0, 10.0, 1000.0];

/// The covariance of a hand of which nothing is known.
const UNKNOWN: f64 = 1e4;

/// What decides about a doubt. Measured on 72 runs of the simulated system: three hands with and without a known
/// force, palpation, ramps with holds and a saw tooth, changes of the grip. Standing errors of more than 15 % and
/// three claimed ones: in up to 100 % of a run's time with one estimate that starts anew, in at most 0.1 % with these.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct DoubtThresholds {
    /// Ratio of the residuals' variances at which a doubt begins. Measured: at most 5 without a change, at least 30 with
    /// a grip that changes by a factor of 1.5.
    pub changed: f64,
    /// The memory while another hand is learned (s), and for how long it is that short: what a parabola leaves of an
    /// intention has gone through the band-pass by then. Measured on a stiffness of 700 that becomes 1200 N/m: within
    /// 15 % after 0.9 s; 1.04 s with 0.15 s of memory, 1.55 s without a start anew.
    pub short_memory_s: f64,
    pub rings_s: f64,
    /// The band-pass starts anew so long after a change was seen (s). Derived: the 81 samples of the parabola are then of
    /// the new grip, but for 20 ms.
    pub restarts_after_s: f64,
    /// From when on residuals of the other hand can tell that something happens again (s): its first ones are its start.
    pub listens_s: f64,
    /// When it can be decided (s): 0.2 s of the band's slowest waves (3 Hz) after the ringing. Not measured.
    pub decides_s: f64,
    /// When the band-pass starts anew once more, because nothing explains the motion (s). Not measured.
    pub gives_up_s: f64,
    /// Over how long the two are compared (s): two of the band's fastest waves. Not measured.
    pub weighed_s: f64,
    /// A hand explains the motion if its residuals are at most so many times the usual ones. Derived: a tenth of a second of
    /// the band has 3.4 independent values, whose mean square is four times the expected one in 1 % of all cases.
    pub explains: f64,
    /// By how much the other hand's residuals are to be smaller. At 1.0 noise decides; without it, a stiffness of 700 that
    /// became 400 N/m was kept, 75 % wrong.
    pub better: f64,
    /// The largest share of the motion that may be the intention's for a hand to be adopted. Derived: it makes the damping
    /// of 9 N s/m wrong by 120·0.005 = 0.6, which is 7 %. At 0.05 ringing was taken for a hand of 5400 N/m.
    pub intended: f64,
}

pub(super) const THRESHOLDS: DoubtThresholds = DoubtThresholds {
    changed: 12.0,
    short_memory_s: 0.08,
    rings_s: 0.8,
    restarts_after_s: 0.1,
    listens_s: 0.3,
    decides_s: 1.0,
    gives_up_s: 1.6,
    weighed_s: 0.1,
    explains: 4.0,
    better: 1.5,
    intended: 0.005,
};

pub(super) fn unknown() -> Rls<f64, 3> {
    Rls::new([0.0; 3].into(), UNKNOWN)
}

/// Whether mass, damping and stiffness are those of a passive hand. A motion that the intention alone makes has the
/// handle's impedance with its sign turned: −120 N s/m.
pub(super) fn is_passive(rls: &Rls<f64, 3>) -> bool {
    rls.theta.iter().all(|value| *value > 0.0)
}

/// The part of an estimate that an intention in the band can be, as a share of the handle's impedance.
///
/// What the intention pushes moves the handle by its share w of the motion, and the fit finds (1 − w)·hand − w·handle: the
/// bias is w/(1 − w) of found and handle's impedance together. The share is at most that of the residual through the
/// handle's damping, σ²/(B²·v²), and at least that of a damping below zero.
pub(super) fn by_intention(
    rls: &Rls<f64, 3>,
    residual_n2: f64,
    speed_m2: f64,
    device_ns_per_m: f64,
) -> f64 {
    let negative = (-rls.theta[1] * UNITS[1] / device_ns_per_m).max(0.0);
    let moved = residual_n2 / (device_ns_per_m.powi(2) * speed_m2.max(1e-18));
    let share = moved.max(negative).min(0.99);
    share / (1.0 - share)
}

/// The handle's impedance as a mass at the upper end of the band, a damping, and a stiffness at its lower end, in units.
pub(super) fn handle(device_ns_per_m: f64) -> [f64; 3] {
    let (low, high) = (
        std::f64::consts::TAU * BAND_HZ.0,
        std::f64::consts::TAU * BAND_HZ.1,
    );
    let sizes = [
        device_ns_per_m / high,
        device_ns_per_m,
        device_ns_per_m * low,
    ];
    [0, 1, 2].map(|i| sizes[i] / UNITS[i])
}

/// What may be another hand: what is learned since, beside what was known before.
#[derive(Clone, Debug)]
pub(super) struct Doubt {
    pub other: Rls<f64, 3>,
    /// Time since the band-pass started anew (s); `None` before.
    pub since_s: Option<f64>,
    /// Mean squares of the residuals of the hand before and of the other one (N²), the least of the latter, and that of the
    /// speed in the band (m²/s²).
    before_n2: f64,
    other_n2: f64,
    least_n2: f64,
    pub speed_m2: f64,
}

/// What has become of a doubt at a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Verdict {
    /// It goes on.
    Open,
    /// The hand is the one of before.
    Before,
    /// It is the other one.
    Other,
    /// Something has happened again.
    Again,
    /// Nothing explains the motion.
    Neither,
}

/// A sample behind the band-pass.
#[derive(Clone, Copy, Debug)]
pub(super) struct Filtered {
    pub force_n: f64,
    pub speed_mps: f64,
    pub phi: [f64; 3],
    pub period_s: f64,
}

impl Doubt {
    pub(super) fn new() -> Doubt {
        Doubt {
            other: unknown(),
            since_s: None,
            before_n2: 0.0,
            other_n2: 0.0,
            least_n2: f64::INFINITY,
            speed_m2: 0.0,
        }
    }

    /// The doubt of a band-pass that has just started anew.
    pub(super) fn restarted() -> Doubt {
        Doubt {
            since_s: Some(0.0),
            ..Doubt::new()
        }
    }

    /// Takes the residuals of a sample (N) of both hands; gives the time since the band-pass started anew (s).
    pub(super) fn compare(
        &mut self,
        sample: &Filtered,
        before_n: f64,
        other_n: f64,
    ) -> Option<f64> {
        let since_s = self.since_s? + sample.period_s;
        self.since_s = Some(since_s);
        let share = sample.period_s / THRESHOLDS.weighed_s;
        let speed_mps = sample.speed_mps;
        self.before_n2 += share * (before_n * before_n - self.before_n2);
        self.other_n2 += share * (other_n * other_n - self.other_n2);
        self.speed_m2 += share * (speed_mps * speed_mps - self.speed_m2);
        if since_s > THRESHOLDS.listens_s {
            self.least_n2 = self.least_n2.min(self.other_n2);
        }
        Some(since_s)
    }

    /// Decides between the hand of before and the other one, where residuals have a usual mean square (N²).
    pub(super) fn verdict(
        &self,
        since_s: f64,
        before: &Rls<f64, 3>,
        usual_n2: f64,
        device_ns_per_m: f64,
    ) -> Verdict {
        let DoubtThresholds {
            changed, better, ..
        } = THRESHOLDS;
        let most_n2 = THRESHOLDS.explains * usual_n2;
        if self.other_n2 > most_n2.max(changed * self.least_n2) {
            return Verdict::Again;
        }
        if since_s < THRESHOLDS.decides_s {
            return Verdict::Open;
        }
        if self.before_n2 <= most_n2.min(better * self.other_n2) && is_passive(before) {
            return Verdict::Before;
        }
        let explains = self.other_n2 <= most_n2 && better * self.other_n2 < self.before_n2;
        let intended = by_intention(&self.other, self.other_n2, self.speed_m2, device_ns_per_m);
        match explains && is_passive(&self.other) && intended < THRESHOLDS.intended {
            true => Verdict::Other,
            false if since_s > THRESHOLDS.gives_up_s => Verdict::Neither,
            false => Verdict::Open,
        }
    }
}
