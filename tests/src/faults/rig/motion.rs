//! Where the probe goes: three motions that an honest log has, and what faults make of them. Positions
//! are relative to the surface and growing into the material, one per sub-step.

use super::FINE_HZ;
use crate::hidden::rig::random::Random;
use std::f64::consts::{PI, TAU};

/// The motions by name.
pub const MOTIONS: [&str; 3] = ["sine", "ramp", "human"];
/// How far a probe retreats, of the depth.
const AIR: f64 = 0.35;
/// Time over which a ramp gathers its speed (s).
const BLEND_S: f64 = 0.03;

/// What the motion is made for.
#[derive(Clone, Copy, Debug)]
pub struct Reach {
    /// The depth of a usual press (m).
    pub depth_m: f64,
    /// The largest speed (m/s).
    pub speed_mps: f64,
    /// Length of the log (s).
    pub seconds: f64,
}

/// A path that grows.
#[derive(Clone, Debug)]
pub struct Path {
    /// The positions (m).
    pub x: Vec<f64>,
}

impl Path {
    fn from(start_m: f64) -> Self {
        Path { x: vec![start_m] }
    }

    fn end(&self) -> f64 {
        self.x[self.x.len() - 1]
    }

    fn seconds(&self) -> f64 {
        self.x.len() as f64 / FINE_HZ
    }

    fn push(&mut self, seconds: f64, at: impl Fn(f64) -> f64) {
        let steps = (seconds * FINE_HZ).round() as usize;
        self.x.extend((1..=steps).map(|k| at(k as f64 / FINE_HZ)));
    }

    fn hold(&mut self, seconds: f64) {
        let at = self.end();
        self.push(seconds, |_| at);
    }

    /// A constant speed with soft ends.
    fn ramp(&mut self, to: f64, speed_mps: f64) {
        let from = self.end();
        let (way, sign) = ((to - from).abs(), (to - from).signum());
        let blend_s = BLEND_S.min(way / speed_mps);
        let cruise_s = way / speed_mps - blend_s;
        // Where a speed that rises as a raised cosine has come after `s` seconds.
        let risen = |s: f64| speed_mps * (s / 2.0 - blend_s / TAU * (PI * s / blend_s).sin());
        self.push(cruise_s + 2.0 * blend_s, |t| {
            let gone = if t < blend_s {
                risen(t)
            } else if t < blend_s + cruise_s {
                speed_mps * (blend_s / 2.0 + t - blend_s)
            } else {
                way - risen((2.0 * blend_s + cruise_s - t).max(0.0))
            };
            from + sign * gone
        });
        let end = self.x.len() - 1;
        self.x[end] = to;
    }

    /// The smoothest way there, as a hand goes.
    fn reach(&mut self, to: f64, seconds: f64) {
        let from = self.end();
        self.push(seconds, |t| {
            let s = t / seconds;
            from + (to - from) * s * s * s * (10.0 + s * (6.0 * s - 15.0))
        });
    }

    /// Cut off, or held, to a length.
    fn until(mut self, seconds: f64) -> Self {
        let steps = (seconds * FINE_HZ) as usize;
        let end = self.end();
        self.x.resize(steps, end);
        self
    }
}

/// The motion of that number.
pub fn usual(kind: usize, reach: &Reach, random: &mut Random) -> Path {
    match kind {
        0 => sine(reach, random),
        1 => ramps(reach, random),
        _ => human(reach, random),
    }
}

/// 0.9–1.6 Hz, out of contact once a cycle, with a little 5 Hz tone.
fn sine(reach: &Reach, random: &mut Random) -> Path {
    let Reach {
        depth_m,
        speed_mps,
        seconds,
    } = *reach;
    let amplitude = depth_m * (1.0 + AIR) / 2.0;
    let fastest = speed_mps / (TAU * amplitude * 1.1);
    let hz = random.between(0.9, 1.6).min(fastest);
    let mut path = Path::from(-AIR * depth_m);
    path.hold(random.between(0.45, 0.7));
    let tone_m = 0.02 * depth_m;
    path.push(seconds, |t| {
        let swing = amplitude * (1.0 - (TAU * hz * t).cos());
        let rising = (t / 0.3).min(1.0);
        -AIR * depth_m + swing + rising * tone_m * (TAU * 5.0 * t).sin()
    });
    path.until(seconds)
}

/// Ramp, hold, ramp at three speeds to several depths.
fn ramps(reach: &Reach, random: &mut Random) -> Path {
    let Reach {
        depth_m,
        speed_mps,
        seconds,
    } = *reach;
    let mut path = Path::from(-AIR * depth_m);
    path.hold(random.between(0.45, 0.7));
    let first = random.between(0.0, 3.0) as usize;
    for turn in 0.. {
        if path.seconds() > seconds {
            break;
        }
        let per_s = [2.0, 4.0, 8.0][(first + turn) % 3];
        let speed = (per_s * depth_m).min(speed_mps);
        path.ramp(depth_m * random.between(0.75, 1.05), speed);
        path.hold(random.between(0.3, 0.8));
        path.ramp(-AIR * depth_m, speed);
        path.hold(random.between(0.1, 0.3));
    }
    path.until(seconds)
}

/// Presses of a hand: other depths and speeds every time, now and then held, with a tremor of 8 Hz.
fn human(reach: &Reach, random: &mut Random) -> Path {
    let Reach {
        depth_m,
        speed_mps,
        seconds,
    } = *reach;
    let mut path = Path::from(-AIR * depth_m);
    path.hold(random.between(0.45, 0.8));
    let rest = path.x.len();
    let go = |path: &mut Path, to: f64, random: &mut Random| {
        let way = (to - path.end()).abs();
        let quickest = 1.9 * way / speed_mps;
        path.reach(to, random.between(0.25, 0.6).max(quickest));
    };
    while path.seconds() < seconds {
        for _ in 0..1 + random.between(0.0, 3.0) as usize {
            let to = depth_m * random.between(0.35, 1.0);
            go(&mut path, to, random);
        }
        path.hold(random.between(0.0, 0.5));
        let back = -depth_m * random.between(0.12, AIR);
        go(&mut path, back, random);
        path.hold(random.between(0.0, 0.2));
    }
    let mut path = path.until(seconds);
    let (phase, size) = (random.phase(), 0.01 * depth_m);
    for (k, x) in path.x.iter_mut().enumerate().skip(rest) {
        let t = (k - rest) as f64 / FINE_HZ;
        *x += size * (t / 0.2).min(1.0) * ((TAU * 8.0 * t + phase).sin() + (TAU * 0.4 * t).sin());
    }
    path
}

/// A motion that a fault asks for, in parts of the usual depth.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Special {
    /// The usual motion.
    #[default]
    Usual,
    /// The usual motion, so many times as fast.
    Fast(f64),
    /// The usual motion, but only so deep.
    Shallow(f64),
    /// A slow approach, then the usual motion so small around 0.85 depths.
    Tiny(f64),
    /// The usual motion, but never shallower than this.
    NeverFree(f64),
    /// The log begins when the probe first is so deep.
    StartsAt(f64),
    /// The log begins so many seconds before the first touch.
    FreeAir(f64),
    /// Up and down at this speed (m/s).
    Slow(f64),
    /// Taps of this many seconds.
    Taps(f64),
    /// Presses to one depth: that often, and at so many depths a second.
    OneDepth(usize, f64),
    /// The usual motion, with a vibration of so many depths at 25 Hz.
    Vibration(f64),
}

/// The path of a special motion.
pub fn path(special: Special, kind: usize, reach: &Reach, random: &mut Random) -> Path {
    // As much longer as is cut off, or gone through faster.
    let longer = Reach {
        seconds: reach.seconds + 3.0,
        ..*reach
    };
    match special {
        Special::Slow(speed_mps) => slow(speed_mps, kind, reach),
        Special::Taps(seconds) => taps(seconds, reach, random),
        Special::OneDepth(often, per_s) => one_depth(often, per_s, reach),
        Special::Fast(times) => usual(kind, &longer, random).faster(times),
        Special::NeverFree(least) => usual(kind, &longer, random).never_free(least, reach.depth_m),
        Special::StartsAt(share) => {
            // Every press goes to 0.75 depths at least, but those of a hand.
            let depth = 0.74 * share * reach.depth_m;
            usual(kind, &longer, random).starting(0.0, |x| x >= depth)
        }
        Special::FreeAir(seconds) => usual(kind, &longer, random).starting(seconds, |x| x >= 0.0),
        Special::Tiny(share) => usual(kind, reach, random).tiny(share, reach.depth_m),
        Special::Shallow(share) => {
            let mut path = usual(kind, reach, random);
            path.x.iter_mut().for_each(|x| *x *= share);
            path
        }
        Special::Vibration(share) => usual(kind, reach, random).vibrating(share * reach.depth_m),
        Special::Usual => usual(kind, reach, random),
    }
    .at_most(reach.seconds, special)
}

/// How faults reshape a usual motion.
impl Path {
    /// Cut off at a length; one slow press takes as long as it takes.
    fn at_most(mut self, seconds: f64, special: Special) -> Self {
        if !matches!(special, Special::Slow(_)) {
            self.x.truncate((seconds * FINE_HZ) as usize);
        }
        self
    }

    /// So many times as fast.
    fn faster(self, times: f64) -> Self {
        let last = self.x.len() - 2;
        let between = |place: f64| {
            let left = (place as usize).min(last);
            self.x[left] + (place - left as f64) * (self.x[left + 1] - self.x[left])
        };
        let steps = (last as f64 / times) as usize;
        Path {
            x: (0..steps).map(|k| between(k as f64 * times)).collect(),
        }
    }

    /// Never shallower than a share of the depth, and without the rest in free air.
    fn never_free(mut self, least: f64, depth: f64) -> Self {
        self.x.drain(..(0.8 * FINE_HZ) as usize);
        let share = (1.0 - least) / (1.0 + AIR);
        for x in &mut self.x {
            *x = least * depth + share * (*x + AIR * depth);
        }
        self
    }

    /// From so many seconds before the first position that is wanted.
    fn starting(mut self, before_s: f64, wanted: impl Fn(f64) -> bool) -> Self {
        let at = self.x.iter().position(|x| wanted(*x)).unwrap_or(0);
        let before = (before_s * FINE_HZ) as usize;
        self.x.drain(..at.saturating_sub(before));
        self
    }

    /// A slow approach to 0.85 depths, and from there the motion as a share of itself.
    fn tiny(mut self, share: f64, depth: f64) -> Self {
        let approach_s = 3.0;
        for (k, x) in self.x.iter_mut().enumerate() {
            let gone = ((k as f64 / FINE_HZ - 0.5) / approach_s).clamp(0.0, 1.0);
            *x = depth * (-AIR + 1.2 * gone) + share * (*x + AIR * depth) * gone.powi(8);
        }
        self
    }

    /// With a vibration at 25 Hz.
    fn vibrating(mut self, amplitude_m: f64) -> Self {
        for (k, x) in self.x.iter_mut().enumerate().skip((0.5 * FINE_HZ) as usize) {
            let t = k as f64 / FINE_HZ - 0.5;
            *x += amplitude_m * (t / 0.2).min(1.0) * (TAU * 25.0 * t).sin();
        }
        self
    }
}

/// Down and up, again and again; the sine's largest speed is this speed.
fn slow(speed_mps: f64, kind: usize, reach: &Reach) -> Path {
    let depth = reach.depth_m;
    let mut path = Path::from(-0.07 * depth);
    path.hold(0.6);
    // One press to the end at least, however long, and not more than 30 s.
    let once_s = 2.0 * 1.07 * depth / speed_mps * if kind == 1 { 1.0 } else { PI / 2.0 };
    let seconds = reach.seconds.max(once_s + 1.0).min(30.0);
    while path.seconds() < seconds {
        match kind {
            1 => {
                path.ramp(depth, speed_mps);
                path.ramp(-0.07 * depth, speed_mps);
            }
            _ => {
                let share = if kind == 0 { 1.0 } else { 0.8 };
                let amplitude = depth * (share + 0.07) / 2.0;
                let hz = speed_mps / (TAU * amplitude);
                path.push(1.0 / hz, |t| {
                    -0.07 * depth + amplitude * (1.0 - (TAU * hz * t).cos())
                });
            }
        }
    }
    path.until(seconds)
}

/// Half sines into the material.
fn taps(seconds: f64, reach: &Reach, random: &mut Random) -> Path {
    let mut path = Path::from(-AIR * reach.depth_m);
    path.hold(0.6);
    while path.seconds() < reach.seconds {
        let most = 0.8 * reach.speed_mps * seconds / PI;
        let depth = (random.between(0.3, 0.6) * reach.depth_m).min(most);
        // A raised cosine that is deeper than zero for these seconds.
        let (low, hz) = (-depth, 1.0 / (2.0 * seconds));
        path.reach(low, 0.3);
        path.push(1.0 / hz, |t| low + depth * (1.0 - (TAU * hz * t).cos()));
    }
    path.until(reach.seconds)
}

/// The same press again and again, the last one held.
fn one_depth(often: usize, per_s: f64, reach: &Reach) -> Path {
    let depth = reach.depth_m;
    let speed = (per_s * depth).min(reach.speed_mps);
    let mut path = Path::from(-AIR * depth);
    path.hold(0.6);
    for turn in 0..often {
        path.ramp(0.9 * depth, speed);
        if turn + 1 < often {
            path.hold(0.4);
            path.ramp(-AIR * depth, speed);
            path.hold(0.2);
        }
    }
    path.until(reach.seconds)
}
