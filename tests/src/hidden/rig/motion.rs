//! The motion: a profile of touches, and a position-controlled motor that tracks it.
//!
//! The motor is x″ = ω²(r − x) − 2ζωx′ behind the set point r(t), integrated by Runge–Kutta at 20 kHz;
//! the contact does not move it (the drive is stiff), as in the rigs of `data/hidden-effects`.

use super::random::Random;

/// Sub-steps a second (Hz): twenty a sample.
pub const FINE_HZ: f64 = 20_000.0;
/// Sub-steps in a sample at 1 kHz.
pub const SUBSTEPS: usize = 20;
/// How long the motion goes on after the last sample (s), for a force that leads its position.
pub(crate) const TAIL_S: f64 = 0.05;
/// Where every motion starts (m).
const START_M: f64 = -2e-3;
/// Fastest set point (m/s).
const FASTEST_MPS: f64 = 38e-3;

/// The kind of motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Profile {
    /// Touch, hold, perhaps a second depth, leave.
    Steps,
    /// Touch, two sines about a mean depth, leave.
    Sines,
    /// Steps, sines and chirps in turn.
    Mixed,
    /// One slow sine that stays in contact: poor excitation.
    Slow,
    /// A touch with two depths and one with sines, 5 s: for the rigs of every test run.
    Brief,
}

impl Profile {
    /// The name in truth.json.
    pub fn name(self) -> &'static str {
        match self {
            Profile::Steps => "steps",
            Profile::Sines => "sines",
            Profile::Mixed => "mixed",
            Profile::Slow => "slow",
            Profile::Brief => "brief",
        }
    }
}

/// A stretch of the set point.
#[derive(Clone, Debug)]
enum Stretch {
    Line {
        to_m: f64,
    },
    /// Amplitude (m), frequency (Hz), growth of the frequency (Hz/s), phase (rad) each.
    Waves([[f64; 4]; 2]),
}

/// The set point, stretch after stretch.
#[derive(Clone, Debug)]
struct SetPoint {
    ends: Vec<(f64, f64, Stretch)>,
    at_s: f64,
    at_m: f64,
}

impl SetPoint {
    fn new() -> Self {
        SetPoint {
            ends: Vec::new(),
            at_s: 0.0,
            at_m: START_M,
        }
    }

    fn push(&mut self, seconds: f64, to_m: f64, stretch: Stretch) {
        self.ends.push((self.at_s + seconds, self.at_m, stretch));
        self.at_s += seconds;
        self.at_m = to_m;
    }

    fn hold(&mut self, seconds: f64) {
        let to_m = self.at_m;
        self.push(seconds, to_m, Stretch::Line { to_m });
    }

    fn ramp(&mut self, to_m: f64, speed_mps: f64) {
        let seconds = ((to_m - self.at_m).abs() / speed_mps).max(0.02);
        self.push(seconds, to_m, Stretch::Line { to_m });
    }

    /// Two sines about where the set point is; they start at phase 0, without a jump in position.
    fn waves(&mut self, seconds: f64, waves: [[f64; 4]; 2]) {
        let to_m = self.at_m + wave_m(&waves, seconds);
        self.push(seconds, to_m, Stretch::Waves(waves));
    }

    /// r at increasing times `k/FINE_HZ/2`: nodes and midpoints.
    fn sampled(&self, count: usize) -> Vec<f64> {
        let mut index = 0;
        let mut start_s = 0.0;
        (0..count)
            .map(|k| {
                let t = k as f64 / (2.0 * FINE_HZ);
                while index + 1 < self.ends.len() && t >= self.ends[index].0 {
                    start_s = self.ends[index].0;
                    index += 1;
                }
                let (end_s, from_m, stretch) = &self.ends[index];
                let into = t.min(*end_s) - start_s;
                match stretch {
                    Stretch::Line { to_m } => from_m + (to_m - from_m) * into / (end_s - start_s),
                    Stretch::Waves(waves) => from_m + wave_m(waves, into),
                }
            })
            .collect()
    }
}

fn wave_m(waves: &[[f64; 4]; 2], t: f64) -> f64 {
    let one = |[amplitude, hz, growth, phase]: &[f64; 4]| {
        let angle = std::f64::consts::TAU * (hz + 0.5 * growth * t) * t + phase;
        amplitude * (angle.sin() - phase.sin())
    };
    waves.iter().map(one).sum()
}

/// The motor's motion at 20 kHz.
#[derive(Clone, Debug)]
pub struct Track {
    /// Position (m).
    pub x: Vec<f64>,
    /// Speed (m/s).
    pub v: Vec<f64>,
    /// Acceleration (m/s²).
    pub a: Vec<f64>,
    /// The number of samples at 1 kHz.
    pub samples: usize,
    motor: Motor,
}

/// x″ = ω²(r − x) − 2ζωx′
#[derive(Clone, Copy, Debug)]
struct Motor {
    /// ω/2π (Hz)
    hz: f64,
    /// ζ
    damping: f64,
}

impl Track {
    /// Draws a motion that presses to `surface_m + depth_m`.
    pub fn draw(profile: Profile, surface_m: f64, depth_m: f64, random: &mut Random) -> Self {
        let mut set = SetPoint::new();
        set.hold(random.between(0.4, 0.6));
        match profile {
            Profile::Steps => {
                let until_s = random.between(11.0, 17.0);
                while set.at_s < until_s {
                    touch_and_hold(&mut set, surface_m, depth_m, random);
                }
            }
            Profile::Sines => {
                for _ in 0..2 {
                    waves(&mut set, surface_m, depth_m, (3.5, 5.5), random);
                }
            }
            Profile::Mixed => mixed(&mut set, surface_m, depth_m, random),
            Profile::Slow => slow(&mut set, surface_m, depth_m, random),
            Profile::Brief => brief(&mut set, surface_m, depth_m, random),
        }
        set.hold(random.between(0.4, 0.7));
        let seconds = (set.at_s * 1000.0).round() / 1000.0;
        let motor = Motor {
            hz: random.between(18.0, 35.0),
            damping: random.between(0.8, 1.1),
        };
        Track::follow(&set.sampled(2 * count(seconds) + 1), seconds, motor)
    }

    /// The same motor under another set point (m), a function of time (s).
    pub(crate) fn with_set_point(&self, seconds: f64, set_m: impl Fn(f64) -> f64) -> Self {
        let nodes = 0..2 * count(seconds) + 1;
        let r: Vec<f64> = nodes.map(|k| set_m(k as f64 / (2.0 * FINE_HZ))).collect();
        Track::follow(&r, seconds, self.motor)
    }

    /// Runge–Kutta through nodes and midpoints of the set point.
    fn follow(r: &[f64], seconds: f64, motor: Motor) -> Self {
        let samples = (seconds * 1000.0).round() as usize + 1;
        let count = count(seconds);
        let (w, dt) = (std::f64::consts::TAU * motor.hz, 1.0 / FINE_HZ);
        let pull = |r: f64, x: f64, v: f64| w * w * (r - x) - 2.0 * motor.damping * w * v;
        let (mut x, mut v) = (r[0], 0.0);
        let mut track = Track {
            x: Vec::with_capacity(count),
            v: Vec::with_capacity(count),
            a: Vec::with_capacity(count),
            samples,
            motor,
        };
        for k in 0..count {
            let a1 = pull(r[2 * k], x, v);
            track.x.push(x);
            track.v.push(v);
            track.a.push(a1);
            let (v2, a2) = (
                v + 0.5 * dt * a1,
                pull(r[2 * k + 1], x + 0.5 * dt * v, v + 0.5 * dt * a1),
            );
            let (v3, a3) = (
                v + 0.5 * dt * a2,
                pull(r[2 * k + 1], x + 0.5 * dt * v2, v + 0.5 * dt * a2),
            );
            let (v4, a4) = (v + dt * a3, pull(r[2 * k + 2], x + dt * v3, v + dt * a3));
            x += dt / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4);
            v += dt / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
        }
        track
    }

    /// Goes on with another motion, after a second on the way from where this one ends to where that begins.
    pub fn go_on(&mut self, next: &Track) {
        let end = (self.seconds() * FINE_HZ).round() as usize;
        let from_m = self.x[end];
        for channel in [&mut self.x, &mut self.v, &mut self.a] {
            channel.truncate(end);
        }
        let half = 0.5 * (next.x[0] - from_m);
        let turn = std::f64::consts::PI;
        for k in 0..FINE_HZ as usize {
            let (sin, cos) = (turn * k as f64 / FINE_HZ).sin_cos();
            self.x.push(from_m + half * (1.0 - cos));
            self.v.push(turn * half * sin);
            self.a.push(turn * turn * half * cos);
        }
        self.x.extend(&next.x);
        self.v.extend(&next.v);
        self.a.extend(&next.a);
        self.samples += 1000 + next.samples - 1;
    }

    /// The largest speed (m/s).
    pub(crate) fn fastest_mps(&self) -> f64 {
        self.v.iter().fold(0.0, |top, v| v.abs().max(top))
    }

    /// The smallest and the largest position (m).
    pub(crate) fn range_m(&self) -> (f64, f64) {
        let fold = |pick: fn(f64, f64) -> f64, from| self.x.iter().copied().fold(from, pick);
        (
            fold(f64::min, f64::INFINITY),
            fold(f64::max, f64::NEG_INFINITY),
        )
    }

    /// The recorded time (s).
    pub fn seconds(&self) -> f64 {
        (self.samples - 1) as f64 * 1e-3
    }
}

/// The number of sub-steps of a motion.
fn count(seconds: f64) -> usize {
    ((seconds + TAIL_S) * FINE_HZ).round() as usize + 1
}

fn leave(set: &mut SetPoint, surface_m: f64, random: &mut Random) {
    let out_m = surface_m - random.between(0.9e-3, 2.2e-3);
    set.ramp(out_m, random.log_between(6e-3, FASTEST_MPS));
    set.hold(random.between(0.2, 0.6));
}

fn touch_and_hold(set: &mut SetPoint, surface_m: f64, depth_m: f64, random: &mut Random) {
    let into = |random: &mut Random| surface_m + depth_m * random.between(0.45, 1.0);
    let first = into(random);
    set.ramp(first, random.log_between(5e-3, FASTEST_MPS));
    set.hold(random.between(0.7, 2.2));
    if random.chance(0.6) {
        let second = into(random);
        set.ramp(second, random.log_between(5e-3, FASTEST_MPS));
        set.hold(random.between(0.5, 1.5));
    }
    leave(set, surface_m, random);
}

/// Two sines, or one chirp, about a mean depth; amplitudes leave a little depth at the top.
fn waves(
    set: &mut SetPoint,
    surface_m: f64,
    depth_m: f64,
    lasting_s: (f64, f64),
    random: &mut Random,
) {
    let mean_m = surface_m + depth_m * random.between(0.45, 0.6);
    set.ramp(mean_m, random.log_between(6e-3, 20e-3));
    let seconds = random.between(lasting_s.0, lasting_s.1);
    let largest_m = 0.38 * depth_m;
    let chirp = random.chance(0.3);
    let slow_hz = random.log_between(0.4, 1.5);
    let fast_hz = if chirp {
        0.0
    } else {
        random.log_between(1.5, 5.0)
    };
    let growth = if chirp { random.between(0.4, 1.2) } else { 0.0 };
    let top_hz = slow_hz + growth * seconds;
    let share = if chirp { 1.0 } else { random.between(0.5, 0.8) };
    let capped = |amplitude: f64, hz: f64| {
        amplitude.min(FASTEST_MPS / (std::f64::consts::TAU * hz.max(0.1)))
    };
    // The second speed shares the limit with the first.
    let slow = [
        capped(share * largest_m, 1.3 * top_hz),
        slow_hz,
        growth,
        0.0,
    ];
    let fast = [
        capped((1.0 - share) * largest_m, 2.0 * fast_hz),
        fast_hz,
        0.0,
        0.0,
    ];
    set.waves(seconds, [slow, fast]);
    leave(set, surface_m, random);
}

fn mixed(set: &mut SetPoint, surface_m: f64, depth_m: f64, random: &mut Random) {
    let until_s = random.between(19.0, 25.0);
    while set.at_s < until_s {
        touch_and_hold(set, surface_m, depth_m, random);
        if set.at_s < until_s {
            waves(set, surface_m, depth_m, (3.5, 5.5), random);
        }
    }
}

fn brief(set: &mut SetPoint, surface_m: f64, depth_m: f64, random: &mut Random) {
    for (share, speed_mps, seconds) in [(0.55, 8e-3, 0.5), (1.0, 25e-3, 0.5)] {
        set.ramp(surface_m + share * depth_m, speed_mps);
        set.hold(seconds);
    }
    leave(set, surface_m, random);
    waves(set, surface_m, depth_m, (1.5, 2.0), random);
}

fn slow(set: &mut SetPoint, surface_m: f64, depth_m: f64, random: &mut Random) {
    let mean_m = surface_m + 0.55 * depth_m;
    set.ramp(mean_m, random.between(4e-3, 8e-3));
    let hz = random.between(0.1, 0.3);
    let wave = [0.4 * depth_m, hz, 0.0, 0.0];
    set.waves(random.between(10.0, 15.0), [wave, [0.0; 4]]);
    set.ramp(surface_m - 1e-3, random.between(4e-3, 8e-3));
}
