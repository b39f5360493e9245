//! From true force and position to the rows of a log.

use super::plan::{Clock, Force, Plan, Position, Spans, Spikes};
use super::{FINE_HZ, RATE_HZ};
use crate::hidden::rig::random::Random;
use std::f64::consts::TAU;

/// The rows of a log.
#[derive(Clone, Debug, Default)]
pub struct Rows {
    /// Stamps (s).
    pub time_s: Vec<f64>,
    /// Position (m).
    pub position_m: Vec<f64>,
    /// Force (N).
    pub force_n: Vec<f64>,
}

/// One channel at a time (s), between the sub-steps.
fn at(channel: &[f64], t: f64) -> f64 {
    let place = (t * FINE_HZ).clamp(0.0, (channel.len() - 1) as f64);
    let left = (place as usize).min(channel.len() - 2);
    let share = place - left as f64;
    channel[left] + share * (channel[left + 1] - channel[left])
}

/// Reads both channels.
pub fn read(position_m: &[f64], force_n: &[f64], plan: &Plan, seed: u64) -> Rows {
    let lagged;
    let force_n = match plan.force.lag_s > 0.0 {
        true => {
            lagged = lag(force_n, plan.force.lag_s);
            &lagged
        }
        false => force_n,
    };
    let rate_hz = plan.clock.rate_hz;
    let samples = (position_m.len() as f64 / FINE_HZ * rate_hz) as usize;
    let mut load_cell = LoadCell::new(&plan.force, plan.onset_s, seed);
    let mut encoder = Encoder::new(&plan.position, plan.onset_s, seed);
    let mut clock = Instants::new(&plan.clock, seed);
    let mut rows = Rows::default();
    for index in 0..samples {
        let nominal_s = index as f64 / rate_hz;
        let (taken_s, force_s, stamp_s) = clock.next(nominal_s);
        let force = load_cell.read(at(force_n, force_s - plan.force.late_s), nominal_s);
        let position = encoder.read(at(position_m, taken_s), nominal_s);
        if clock.drops(nominal_s) {
            continue;
        }
        let stamp_s = match plan.clock.renumbered {
            true => rows.time_s.len() as f64 / rate_hz,
            false => stamp_s,
        };
        // A stamp has six digits.
        let stamp_s = (stamp_s * 1e6).round() * 1e-6;
        // Stamps that run backward are no log.
        if rows
            .time_s
            .last()
            .is_some_and(|last| stamp_s <= last + 1e-6)
        {
            continue;
        }
        rows.time_s.push(stamp_s);
        rows.position_m.push(position);
        rows.force_n.push(force);
    }
    rows
}

fn lag(force_n: &[f64], lag_s: f64) -> Vec<f64> {
    let share = 1.0 - (-1.0 / (FINE_HZ * lag_s)).exp();
    let mut held = force_n[0];
    let lagged = force_n.iter().map(|force| {
        held += share * (force - held);
        held
    });
    lagged.collect()
}

/// Whether a sample at `t` lies in one of the spans.
fn within(spans: &Spans, t: f64) -> bool {
    spans.iter().any(|span| span.contains(&t))
}

/// What is added to the sample at `t`.
fn spike(spikes: &Spikes, t: f64) -> f64 {
    let here = spikes
        .iter()
        .filter(|(when, _)| (when - t).abs() < 0.5 / RATE_HZ);
    here.map(|(_, size)| size).sum()
}

/// Load cell and converter.
struct LoadCell<'a> {
    force: &'a Force,
    onset_s: f64,
    random: Random,
    phase: f64,
    tare_n: f64,
    tared: bool,
    last: f64,
}

impl<'a> LoadCell<'a> {
    fn new(force: &'a Force, onset_s: f64, seed: u64) -> Self {
        let mut random = Random::new(seed, 11);
        LoadCell {
            force,
            onset_s,
            phase: random.phase(),
            random,
            tare_n: 0.0,
            tared: false,
            last: 0.0,
        }
    }

    fn read(&mut self, force_n: f64, t: f64) -> f64 {
        let noise = self.random.normal();
        let begun = t >= self.onset_s;
        let mut reading = force_n + self.force.noise_n * noise;
        reading += self.force.hum_n * (TAU * 50.0 * t + self.phase).sin();
        reading += spike(&self.force.spikes, t);
        if begun {
            reading += self.force.offset_n + self.force.drift_nps * (t - self.onset_s);
            reading *= self.force.gain;
        }
        if begun && self.force.tared && !self.tared {
            (self.tared, self.tare_n) = (true, reading);
        }
        reading = self.convert(reading - self.tare_n, t);
        if !within(&self.force.stuck, t) {
            self.last = reading;
        }
        self.last
    }

    fn convert(&self, reading: f64, t: f64) -> f64 {
        let step = self.force.step_n;
        let limit = self.force.limit_n;
        let mut code = (reading.clamp(-limit, limit) / step).round() as i64;
        if let Some(bit) = self.force.stuck_bit {
            code |= 1 << bit;
        }
        for (when, bit) in &self.force.flips {
            if (when - t).abs() < 0.5 / RATE_HZ {
                code ^= 1 << bit;
            }
        }
        code as f64 * step
    }
}

/// The encoder, with a random phase of its counts.
struct Encoder<'a> {
    position: &'a Position,
    onset_s: f64,
    random: Random,
    phase: f64,
    zero_m: f64,
    restarted: bool,
    last: f64,
}

impl<'a> Encoder<'a> {
    fn new(position: &'a Position, onset_s: f64, seed: u64) -> Self {
        let mut random = Random::new(seed, 12);
        Encoder {
            position,
            onset_s,
            phase: random.unit(),
            random,
            zero_m: 0.0,
            restarted: false,
            last: 0.0,
        }
    }

    fn read(&mut self, position_m: f64, t: f64) -> f64 {
        let begun = t >= self.onset_s;
        let mut at_m = position_m + spike(&self.position.spikes, t);
        if begun {
            at_m = at_m * self.position.gain + self.position.jump_m;
        }
        if begun && self.position.restarted && !self.restarted {
            (self.restarted, self.zero_m) = (true, at_m);
        }
        let count_m = self.position.count_m;
        let noise = match self.position.noise_counts > 0.0 {
            true => self.position.noise_counts * self.random.normal(),
            false => 0.0,
        };
        let counts = ((at_m - self.zero_m) / count_m + noise + self.phase).floor();
        if !within(&self.position.stuck, t) {
            self.last = counts * count_m;
        }
        self.last
    }
}

/// When the samples are taken.
struct Instants<'a> {
    clock: &'a Clock,
    random: Random,
}

impl<'a> Instants<'a> {
    fn new(clock: &'a Clock, seed: u64) -> Self {
        let random = Random::new(seed, 13);
        Instants { clock, random }
    }

    /// When both channels are taken, when the force is, and the stamp (s).
    fn next(&mut self, nominal_s: f64) -> (f64, f64, f64) {
        let clock = self.clock;
        let mut jitter = |size: f64| match size > 0.0 {
            true => size * self.random.normal(),
            false => 0.0,
        };
        let (both, force, stamp) = (
            jitter(clock.both_s),
            jitter(clock.force_s),
            jitter(clock.stamps_s),
        );
        let late = match clock.late > 0.0 && self.random.chance(clock.late) {
            true => self.random.between(0.0, clock.late_s),
            false => 0.0,
        };
        let taken_s = nominal_s + both + late;
        let stamp_s = (nominal_s + stamp) * clock.speed;
        (taken_s, taken_s + force, stamp_s)
    }

    fn drops(&mut self, nominal_s: f64) -> bool {
        let share = self.clock.dropped_share;
        (share > 0.0 && self.random.chance(share)) || within(&self.clock.dropped, nominal_s)
    }
}
