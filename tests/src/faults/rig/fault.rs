//! The faults, a row each, with three severities.

mod channel;
mod contact;
mod motion;
mod sampling;

use super::material::Material;
use super::motion::Special;
use super::plan::{Plan, Spans, Spikes};
use super::{FINE_HZ, RATE_HZ};
use crate::hidden::rig::random::Random;

/// A fault.
pub struct Fault {
    /// Its name.
    pub name: &'static str,
    /// What the three severities are.
    pub severities: &'static str,
    /// The motion that it is about.
    pub motion: fn(usize) -> Special,
    /// What it does.
    pub plan: fn(&mut Scene) -> Plan,
    /// Whether it changes what the probe meets: then nothing counts until the force shows it.
    pub meets: bool,
    /// Whether it passes, so that the estimate may be asked to recover.
    pub passes: bool,
}

/// What a fault may know of its log.
pub struct Scene<'a> {
    /// 0, 1 or 2.
    pub severity: usize,
    /// The material.
    pub material: Material,
    /// The depth of a usual press (m).
    pub depth_m: f64,
    /// The force of a usual press at rest (N).
    pub peak_n: f64,
    /// Depth at each sub-step (m).
    pub path: &'a [f64],
    /// The draws of the fault.
    pub random: Random,
}

/// A row that leaves the motion alone.
const fn row(name: &'static str, severities: &'static str, plan: fn(&mut Scene) -> Plan) -> Fault {
    Fault {
        name,
        severities,
        motion: |_| Special::Usual,
        plan,
        meets: false,
        passes: false,
    }
}

impl Fault {
    const fn meets(self) -> Fault {
        Fault {
            meets: true,
            ..self
        }
    }

    const fn passes(self) -> Fault {
        Fault {
            passes: true,
            ..self
        }
    }
}

/// All faults; the first is none.
pub fn all() -> impl Iterator<Item = &'static Fault> {
    channel::FORCE
        .iter()
        .chain(channel::POSITION)
        .chain(sampling::ROWS)
        .chain(contact::ROWS)
        .chain(motion::ROWS)
}

/// The fault of that name.
pub fn named(name: &str) -> Option<&'static Fault> {
    all().find(|fault| fault.name == name)
}

impl Scene<'_> {
    /// The value of this severity.
    fn of<T: Copy>(&self, values: [T; 3]) -> T {
        values[self.severity]
    }

    fn seconds(&self) -> f64 {
        self.path.len() as f64 / FINE_HZ
    }

    /// The depth (m) at a time (s).
    fn depth_at(&self, t: f64) -> f64 {
        self.path[((t * FINE_HZ) as usize).min(self.path.len() - 1)]
    }

    /// The first sample from `from` on at which a depth is as wanted; the nearest end if there is none.
    fn when(&self, from: f64, wanted: impl Fn(f64) -> bool) -> f64 {
        let first = (from * RATE_HZ) as usize;
        let last = (self.seconds() * RATE_HZ) as usize;
        let found = (first..last).find(|index| wanted(self.depth_at(*index as f64 / RATE_HZ)));
        found.unwrap_or(first) as f64 / RATE_HZ
    }

    /// A time around the middle of the log.
    fn middle(&mut self) -> f64 {
        self.seconds() * self.random.between(0.45, 0.6)
    }

    /// A time around the middle at which the probe presses.
    fn pressing(&mut self) -> f64 {
        let (from, depth) = (self.middle(), self.depth_m);
        self.when(from, |at| at > 0.4 * depth)
    }

    /// A time around the middle at which the probe is in free air.
    fn in_air(&mut self) -> f64 {
        let (from, depth) = (self.middle(), self.depth_m);
        self.when(from, |at| at < -0.1 * depth)
    }

    /// A time in the first press.
    fn first_press(&mut self) -> f64 {
        let depth = self.depth_m * self.random.between(0.05, 0.5);
        self.when(0.0, |at| at > depth)
    }

    /// One span in which the probe presses.
    fn span(&mut self, seconds: f64) -> Spans {
        let from = self.pressing();
        vec![from..from + seconds]
    }

    /// Spans from the second second on, some seconds apart.
    fn spans(&mut self, seconds: f64, apart_s: f64) -> Spans {
        let mut spans = Spans::new();
        let mut at = 1.5;
        while at < self.seconds() {
            spans.push(at..at + seconds);
            at += seconds + apart_s * self.random.between(0.5, 1.5);
        }
        spans
    }

    /// Spikes at random times, so many a second, of both signs.
    fn spikes(&mut self, size: f64, a_second: f64) -> Spikes {
        let number = (self.seconds() * a_second) as usize;
        let mut spikes = Spikes::new();
        for _ in 0..number {
            let at = self.random.between(0.25, self.seconds());
            let at = (at * RATE_HZ).round() / RATE_HZ;
            spikes.push((at, size * self.random.sign()));
        }
        spikes
    }
}
