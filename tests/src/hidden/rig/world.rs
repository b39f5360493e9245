//! Sensors and sampling as they are: an encoder that toggles, a load cell that rings and bends, hum and
//! spikes, stamps that are off, samples that are missing, holds that are thinned.

use super::drive::resonated;
use super::fit::rms;
use super::motion::{FINE_HZ, TAIL_S, Track};
use super::plant::{Plant, at};
use super::random::Random;
use super::sensor::{Noise, Recorded, Sensor};

/// How true the stamps of the samples are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Stamps {
    /// The samples were taken evenly, and the stamps say so.
    Even,
    /// The samples were taken early and late by so much (s rms), and the stamps say so.
    True(f64),
    /// The samples were taken early and late, and the stamps are even.
    Hidden(f64),
    /// The samples were taken evenly, and the stamps scatter.
    Scattered(f64),
}

/// What stands between a rig and its log.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct World {
    pub(crate) rate_hz: f64,
    pub(crate) noise: Noise,
    /// Its standard deviation (N).
    pub(crate) noise_n: f64,
    /// The step of the force (N).
    pub(crate) code_n: f64,
    /// A count of the encoder (m), and its noise before it is rounded (counts).
    pub(crate) count_m: f64,
    pub(crate) toggles: f64,
    /// The mains in the force (N).
    pub(crate) hum_n: f64,
    /// Spikes a second, and their size (N).
    pub(crate) spikes_hz: f64,
    pub(crate) spike_n: f64,
    /// Frequency (Hz) and damping of the load cell, where it rings.
    pub(crate) cell: Option<(f64, f64)>,
    /// Nonlinearity of the load cell at the peak force.
    pub(crate) bends: f64,
    pub(crate) stamps: Stamps,
    /// The share of the samples that are missing.
    pub(crate) drops: f64,
    /// Whether long holds are thinned.
    pub(crate) thins: bool,
}

/// Frequency of the mains (Hz).
pub(crate) const MAINS_HZ: f64 = 50.0;
/// Noise of an encoder that toggles, in counts before rounding.
const TOGGLES: f64 = 0.15;

impl World {
    /// Clean sensors as those of the other kinds of rigs, at a rate.
    pub(crate) fn plain(sensor: Sensor, rate_hz: f64) -> World {
        World {
            rate_hz,
            noise: sensor.noise,
            noise_n: sensor.noise_n,
            code_n: sensor.code_n,
            count_m: 1e-6,
            toggles: 0.0,
            hum_n: 0.0,
            spikes_hz: 0.0,
            spike_n: 0.0,
            cell: None,
            bends: 0.0,
            stamps: Stamps::Even,
            drops: 0.0,
            thins: false,
        }
    }

    /// Draws what a bench has: most of it on some rigs, all of it on none.
    pub(crate) fn draw(sensor: Sensor, rate_hz: f64, random: &mut Random) -> World {
        let mut world = World::plain(sensor, rate_hz);
        let coloured = random.chance(0.5);
        world.noise = Noise::draw(coloured, random);
        world.count_m = *random.pick(&[1e-6, 1e-6, 2e-6, 5e-6]);
        let noise_n = world.noise_n;
        // Each is drawn, used or not, so that one probability moves no other draw.
        let hum_n = noise_n * random.between(0.3, 1.5);
        let spikes = (
            random.between(0.1, 0.5),
            noise_n * random.between(8.0, 30.0),
        );
        let cell = (
            random.log_between(250.0, 900.0),
            random.log_between(0.02, 0.2),
        );
        let bends = random.sign() * random.log_between(2e-4, 2e-3);
        let jitter_s = random.log_between(0.01, 0.12) / rate_hz;
        let drops = random.log_between(0.002, 0.05);
        world.toggles = if random.chance(0.35) { TOGGLES } else { 0.0 };
        world.hum_n = if random.chance(0.25) { hum_n } else { 0.0 };
        if random.chance(0.25) {
            (world.spikes_hz, world.spike_n) = spikes;
        }
        world.cell = random.chance(0.15).then_some(cell);
        world.bends = if random.chance(0.15) { bends } else { 0.0 };
        world.stamps = match random.unit() {
            u if u < 0.12 => Stamps::True(jitter_s),
            u if u < 0.24 => Stamps::Hidden(jitter_s),
            u if u < 0.36 => Stamps::Scattered(jitter_s),
            _ => Stamps::Even,
        };
        world.drops = if random.chance(0.15) { drops } else { 0.0 };
        world.thins = random.chance(0.1);
        world
    }

    /// What is special about it, in words.
    pub(crate) fn words(&self) -> String {
        let mut words = vec![format!("{} Hz", self.rate_hz), self.noise.name()];
        let mut say = |is: bool, what: String| {
            if is {
                words.push(what);
            }
        };
        say(
            self.count_m > 1e-6,
            format!("counts of {:.0} µm", self.count_m * 1e6),
        );
        say(self.toggles > 0.0, "toggles".into());
        say(self.hum_n > 0.0, "hum".into());
        say(self.spikes_hz > 0.0, "spikes".into());
        say(self.cell.is_some(), "rings".into());
        say(self.bends != 0.0, "bends".into());
        let (kind, jitter_s) = match self.stamps {
            Stamps::Even => ("", 0.0),
            Stamps::True(jitter_s) => ("uneven by", jitter_s),
            Stamps::Hidden(jitter_s) => ("uneven unseen by", jitter_s),
            Stamps::Scattered(jitter_s) => ("stamps off by", jitter_s),
        };
        say(jitter_s > 0.0, format!("{kind} {:.0} µs", jitter_s * 1e6));
        say(
            self.drops > 0.0,
            format!("{:.1} % missing", 100.0 * self.drops),
        );
        say(self.thins, "thinned holds".into());
        words.join(", ")
    }

    /// Records a rig under a motion. The floor is what sensors and encoder add to the force.
    pub(crate) fn record(&self, plant: &Plant, track: &Track, random: &mut Random) -> Recorded {
        let instants_s = self.instants(track.seconds(), random);
        let fine = plant.force(&track.x, &track.v, &track.a, 1.0 / FINE_HZ);
        let steps = || instants_s.iter().map(|t| (t * FINE_HZ).max(0.0));
        let ideal = plant.sensed(&fine, FINE_HZ, steps());
        let read = match self.cell {
            Some(_) => plant.sensed(&self.rung(&fine), FINE_HZ, steps()),
            None => ideal.clone(),
        };
        let noise = self.noise.samples(ideal.len(), 1.0 / self.rate_hz, random);
        let peak_n = plant.peak_n;
        let mut rows = Vec::with_capacity(ideal.len());
        let mut wrong = Vec::with_capacity(ideal.len());
        for (k, t) in instants_s.iter().enumerate() {
            let bent = read[k] * (1.0 + self.bends * (read[k] / peak_n));
            let force = bent + self.noise_n * noise[k] + self.disturbed(*t, random);
            let force = (force / self.code_n).round() * self.code_n;
            let x = plant.read_m(at(&track.x, t * FINE_HZ));
            let count = (x / self.count_m + self.toggles * random.normal()).round();
            let stamp = match self.stamps {
                Stamps::Hidden(_) => k as f64 / self.rate_hz,
                Stamps::Scattered(jitter_s) => t + jitter_s * random.normal(),
                _ => *t,
            };
            let slope = slope(plant, x);
            wrong.push(force - ideal[k] - slope * (count * self.count_m - x));
            rows.push([stamp, count * self.count_m, force]);
        }
        Recorded {
            rows: self.kept(rows, random),
            floor_n: rms(&wrong),
        }
    }

    /// When the samples are taken (s); stamps never run backward.
    fn instants(&self, seconds: f64, random: &mut Random) -> Vec<f64> {
        let jitter_s = match self.stamps {
            Stamps::True(jitter_s) | Stamps::Hidden(jitter_s) => jitter_s,
            _ => 0.0,
        };
        let count = (seconds * self.rate_hz) as usize;
        let last_s = seconds + TAIL_S;
        (0..count)
            .map(|k| {
                // No sample trades places with its neighbour.
                let off = (jitter_s * self.rate_hz * random.normal()).clamp(-0.45, 0.45);
                ((k as f64 + off) / self.rate_hz).clamp(0.0, last_s)
            })
            .collect()
    }

    /// The force behind a load cell that rings.
    fn rung(&self, fine: &[f64]) -> Vec<f64> {
        let Some((hz, damping)) = self.cell else {
            return fine.to_vec();
        };
        let mut state = [fine[0], 0.0];
        let behind = |force: &f64| resonated(&mut state, *force, hz, damping, 1.0 / FINE_HZ);
        fine.iter().map(behind).collect()
    }

    /// Hum and spikes (N).
    fn disturbed(&self, t: f64, random: &mut Random) -> f64 {
        let turn = std::f64::consts::TAU * MAINS_HZ * t;
        let spike = random.chance(self.spikes_hz / self.rate_hz);
        let size_n = self.spike_n * random.sign() * random.between(0.3, 1.0);
        let hum_n = self.hum_n * (turn.sin() + 0.25 * (3.0 * turn + 0.7).sin());
        hum_n + if spike { size_n } else { 0.0 }
    }

    /// The samples that reach the file.
    fn kept(&self, rows: Vec<[f64; 3]>, random: &mut Random) -> Vec<[f64; 3]> {
        let mut rest = Rest::default();
        let mut last_s = f64::NEG_INFINITY;
        rows.into_iter()
            .filter(|[t, x, _]| {
                let there = !random.chance(self.drops);
                let wanted = !self.thins || rest.keeps(*t, *x, 5.0 * self.count_m);
                // A stamp of a microsecond is as fine as files have.
                let after = *t > last_s + 1e-6;
                let keep = there && wanted && after;
                last_s = if keep { *t } else { last_s };
                keep
            })
            .collect()
    }
}

/// A rest that is thinned: after half a second a sample is kept every thirtieth of the time since it began.
#[derive(Default)]
struct Rest {
    from_s: f64,
    at_m: f64,
    next_s: f64,
}

impl Rest {
    fn keeps(&mut self, t: f64, x: f64, still_m: f64) -> bool {
        if (x - self.at_m).abs() > still_m {
            *self = Rest {
                from_s: t,
                at_m: x,
                next_s: t,
            };
        }
        let since = t - self.from_s;
        if since < 0.5 {
            return true;
        }
        let keep = t >= self.next_s;
        if keep {
            self.next_s = t + since / 30.0;
        }
        keep
    }
}

/// The stiffness (N/m) of the bare material at a position (m).
fn slope(plant: &Plant, x: f64) -> f64 {
    let depth = x - plant.material.surface;
    (plant.material.elastic(depth + 1e-7) - plant.material.elastic(depth)) / 1e-7
}
