//! The rig that is measured: position in, force out, in the signal order of the catalogue.
//!
//! Every sub-step of `dt` evaluates the contact at the exact position and speed of the motor. A
//! spring between motor and tip makes the contact an implicit equation, solved for the depth with a
//! second-order backward difference for its rate (stable where the damper vanishes). Relaxation
//! states and lags are integrated exactly for a force that is linear within a sub-step.

use super::drive::Drive;
use super::effect::{Effect, Stranger, wave};
use super::material::{Material, REFERENCE_M};
use super::motion::{FINE_HZ, SUBSTEPS, Track};
use super::random::Random;
use super::stranger::Running;

/// No list of modes, plays or hysteresis elements is longer.
pub(super) const MOST: usize = 8;
/// The guide stands if it is slower than this (m/s): 0.05 counts of the encoder a millisecond.
pub(super) const STANDING_MPS: f64 = 5e-5;

/// A rig: the material that is touched, and what is hidden.
#[derive(Clone, Debug)]
pub struct Plant {
    pub(crate) material: Material,
    /// The hidden effects.
    pub hidden: Vec<Effect>,
    pub(crate) stranger: Option<(Stranger, f64)>,
    /// Largest force (N) of the material alone: the scale of a converter's nonlinearity.
    pub(crate) peak_n: f64,
    /// The seed of all that is random in the rig.
    pub(crate) seed: u64,
    /// Nothing pulls the surface of what relaxes: it creeps back where the probe has left it. Else it follows the probe.
    pub creeps: bool,
}

/// The state of the contact.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Memory {
    elastic: f64,
    unrelaxed: [f64; MOST],
    hysteresis: [f64; MOST],
    deepest: f64,
    set: f64,
    pub(super) depth: f64,
    /// From the unloading curve, −1, to the loading curve, 1.
    curve: f64,
    necked: bool,
}

impl Plant {
    /// A rig that hides nothing.
    pub fn bare(material: Material) -> Self {
        Plant {
            material,
            hidden: Vec::new(),
            stranger: None,
            peak_n: 1.0,
            seed: 0,
            creeps: false,
        }
    }

    /// The force in the load path after a lag (N), at every sub-step of `dt` (s); the rest of the sensor
    /// acts on the samples ([`Plant::sensed`]).
    pub fn force(&self, x: &[f64], v: &[f64], a: &[f64], dt: f64) -> Vec<f64> {
        let mut run = Drive::new(self, x[0]);
        (0..x.len())
            .map(|k| run.step(k as f64 * dt, x[k], v[k], a[k], dt))
            .collect()
    }

    /// The force at 1 kHz without noise (N), from `every` sub-steps in a sample.
    pub fn samples(&self, track: &Track, every: usize) -> Vec<f64> {
        let thin = |series: &[f64]| -> Vec<f64> {
            series.iter().copied().step_by(SUBSTEPS / every).collect()
        };
        let dt = (SUBSTEPS / every) as f64 / FINE_HZ;
        let force = self.force(&thin(&track.x), &thin(&track.v), &thin(&track.a), dt);
        let instants = (0..track.samples).map(|k| (k * every) as f64);
        self.sensed(&force, every as f64 * 1e3, instants)
    }

    /// Delay and saturation: the samples at instants (in sub-steps, of which a second has `hz`).
    pub(crate) fn sensed(
        &self,
        force: &[f64],
        hz: f64,
        instants: impl Iterator<Item = f64>,
    ) -> Vec<f64> {
        let mut before = None;
        let mut random = Random::new(self.seed, 78);
        let mut stranger = self.running(1);
        instants
            .map(|instant| {
                let dt = before.map_or(1e-3, |before| (instant - before) / hz);
                before = Some(instant);
                let mut back = 0.0;
                let mut limits = Vec::new();
                for effect in &self.hidden {
                    match effect {
                        Effect::Delay { seconds, jitter } => {
                            back += seconds * (1.0 + jitter * random.normal());
                        }
                        Effect::Saturation { limit, sharpness } => {
                            limits.push((*limit, *sharpness))
                        }
                        _ => {}
                    }
                }
                let mut read = at(force, instant - back * hz);
                for (limit, sharpness) in limits {
                    read = limited(read, limit, sharpness);
                }
                match &mut stranger {
                    Some(stranger) => stranger.sensor(read, self.peak_n, dt),
                    None => read,
                }
            })
            .collect()
    }

    /// The position that the encoder sees (m), before it is rounded to a count.
    pub fn read_m(&self, x: f64) -> f64 {
        let error = |effect: &Effect| match effect {
            Effect::Encoder {
                amplitude,
                pitch,
                phase,
                second,
            } => amplitude * wave(std::f64::consts::TAU * x / pitch + phase, *second),
            _ => 0.0,
        };
        x + self.hidden.iter().map(error).sum::<f64>()
    }

    /// The position that the encoder sees at every sample (m), before it is rounded to a count.
    pub(crate) fn readings(&self, track: &Track) -> Vec<f64> {
        (0..track.samples)
            .map(|k| self.read_m(track.x[k * SUBSTEPS]))
            .collect()
    }

    pub(super) fn running(&self, stream: u64) -> Option<Running> {
        self.stranger
            .map(|(kind, strength)| Running::new(kind, strength, self.seed ^ (stream << 40)))
    }

    /// The relaxation modes of the base, then the hidden ones.
    fn modes(&self) -> impl Iterator<Item = (f64, f64)> {
        let hidden = self.hidden.iter().flat_map(|effect| match effect {
            Effect::Modes(modes) => modes.as_slice(),
            _ => &[],
        });
        self.material
            .mode
            .into_iter()
            .chain(hidden.copied())
            .take(MOST)
    }

    /// Elastic force (N), before it relaxes.
    fn elastic(&self, depth: f64, deepest: f64, speed: f64, curve: f64) -> f64 {
        if depth <= 0.0 {
            return 0.0;
        }
        let mut force = self.material.elastic(depth);
        let (mut layer, mut factor) = (0.0, 1.0);
        for effect in &self.hidden {
            match effect {
                Effect::Curve { terms, blunt } => {
                    let power = |d: f64, n: f64| (d / REFERENCE_M).powf(n);
                    let sum = terms
                        .iter()
                        .map(|(share, n)| share * (power(depth + blunt, *n) - power(*blunt, *n)));
                    force = self.material.stiffness * REFERENCE_M * sum.sum::<f64>();
                }
                Effect::Stiffening { rate, locking } => {
                    force *= (rate * depth).exp() / (1.0 - (locking * depth).min(0.95));
                }
                Effect::Softening {
                    fraction,
                    scale,
                    energy,
                } => {
                    force *= softened(depth, deepest, *fraction, *scale, *energy);
                }
                Effect::Layer {
                    stiffness,
                    depth: from,
                    rounding,
                } => {
                    layer += stiffness * hinge(depth - from, *rounding);
                }
                Effect::Curves {
                    fraction,
                    smooth,
                    lasting,
                    parts,
                } => {
                    let middle = 0.5 / parts.max(1e-9);
                    let side = match *lasting > 0.0 {
                        true => curve,
                        false => (speed / smooth).tanh(),
                    };
                    let more = match *parts > 0.0 {
                        true => 1.0 + parts * (depth - middle).clamp(-middle, middle),
                        false => 1.0,
                    };
                    factor *= 1.0 + fraction * more * side;
                }
                Effect::Snap {
                    force,
                    depth: at,
                    width,
                    skewed,
                } => {
                    let width = if depth > *at {
                        width * (1.0 + skewed)
                    } else {
                        *width
                    };
                    layer -= 0.5 * force * (1.0 + ((depth - at) / width).tanh());
                }
                _ => {}
            }
        }
        force * factor + layer
    }

    /// Positions (m) behind each flank of a play in front of the cable, and their shares.
    pub(super) fn flanks(&self, x: f64) -> Vec<(f64, f64)> {
        let all = self.hidden.iter().find_map(|effect| match effect {
            Effect::Flanks(flanks) => Some(flanks),
            _ => None,
        });
        match all {
            Some(flanks) => {
                let beyond = |width: f64| x - x.clamp(-0.5 * width, 0.5 * width);
                flanks
                    .iter()
                    .map(|(width, share)| (beyond(*width), *share))
                    .collect()
            }
            None => vec![(x, 1.0)],
        }
    }

    /// Where between two curves a material is that takes a way to change them.
    fn curve(&self, before: &Memory, way: f64) -> f64 {
        let lasting = self.hidden.iter().find_map(|effect| match effect {
            Effect::Curves { lasting, .. } if *lasting > 0.0 => Some(*lasting),
            _ => None,
        });
        match lasting {
            Some(lasting) => (before.curve + 2.0 * way / lasting).clamp(-1.0, 1.0),
            None => 0.0,
        }
    }

    fn damping(&self, depth: f64) -> f64 {
        let shape = |effect: &Effect| match effect {
            Effect::DampingDepth {
                exponent,
                levelling,
            } => {
                let u = depth / REFERENCE_M;
                Some((u / (1.0 + levelling * u)).powf(*exponent))
            }
            _ => None,
        };
        let factor = self.hidden.iter().find_map(shape).unwrap_or(1.0);
        self.material.damping(depth) * factor
    }

    /// The contact force (N) with the tip at `tip`, and the state of the contact after the step.
    pub(super) fn contact(
        &self,
        before: &Memory,
        stranger: &mut Option<Running>,
        (tip, speed): (f64, f64),
        (moved, moved_speed): (f64, f64),
        dt: f64,
    ) -> (f64, Memory) {
        let mut now = *before;
        let from_surface = tip - self.material.surface;
        let mut depth_speed = speed - moved_speed;
        now.deepest = before.deepest.max(from_surface);
        now.set = self.set(before, now.deepest, dt);
        if now.set > before.set {
            depth_speed -= (now.set - before.set) / dt;
        }
        let depth = from_surface - moved - now.set;
        let factor = stranger.as_mut().map_or(1.0, |s| s.stiffness(depth));
        now.curve = self.curve(before, depth.max(0.0) - before.depth.max(0.0));
        now.elastic = factor * self.elastic(depth, now.deepest, depth_speed, now.curve);
        let dent = self.dent(before, dt);
        let reached = now.elastic > dent || dent == 0.0;
        now.elastic = now.elastic.max(dent);
        let mut force = now.elastic;
        for (unrelaxed, (fraction, rate)) in now.unrelaxed.iter_mut().zip(self.modes()) {
            // Exact for an elastic force that is linear within the step.
            let (keep, rise) = kept(rate * dt);
            *unrelaxed = keep * *unrelaxed + rise * (now.elastic - before.elastic);
            force -= fraction * (now.elastic - *unrelaxed);
        }
        if depth > 0.0 && reached {
            force += self.damping(depth) * depth_speed;
            force += stranger.as_ref().map_or(0.0, |s| s.damping(depth_speed));
            force += self.hysteresis(&mut now, depth - before.depth);
        } else {
            now.hysteresis = [0.0; MOST];
        }
        now.depth = depth;
        let pushed = if depth > 0.0 && reached {
            force.max(0.0)
        } else {
            0.0
        };
        (pushed - self.adhesion(&mut now, depth, depth_speed), now)
    }

    /// Whether its surface creeps back, and anything relaxes.
    pub(crate) fn keeps_a_dent(&self) -> bool {
        self.creeps && self.modes().next().is_some()
    }

    /// The elastic force (N) at which what relaxes has no force left: where its surface is if nothing presses.
    fn dent(&self, before: &Memory, dt: f64) -> f64 {
        if !self.creeps {
            return 0.0;
        }
        let (mut relaxed, mut at_once) = (0.0, 1.0);
        for (unrelaxed, (fraction, rate)) in before.unrelaxed.iter().zip(self.modes()) {
            let (keep, rise) = kept(rate * dt);
            relaxed -= fraction * (keep * unrelaxed - rise * before.elastic);
            at_once -= fraction * (1.0 - rise);
        }
        (relaxed / at_once).max(0.0)
    }

    fn set(&self, before: &Memory, deepest: f64, dt: f64) -> f64 {
        let end = |effect: &Effect| match effect {
            Effect::Set {
                fraction,
                yield_depth,
                delay,
            } => Some((fraction * (deepest - yield_depth).max(0.0), *delay)),
            _ => None,
        };
        match self.hidden.iter().find_map(end) {
            Some((end, delay)) if delay > 0.0 => end + (before.set - end) * (-dt / delay).exp(),
            Some((end, _)) => end,
            None => 0.0,
        }
    }

    fn hysteresis(&self, now: &mut Memory, way: f64) -> f64 {
        let mut sum = 0.0;
        let all = self.hidden.iter().filter_map(|effect| match effect {
            Effect::Hysteresis { elements, jenkins } => Some((elements, *jenkins)),
            _ => None,
        });
        for (elements, jenkins) in all {
            for (z, (force, yields)) in now.hysteresis.iter_mut().zip(elements) {
                *z = if jenkins {
                    (*z + way / yields).clamp(-1.0, 1.0)
                } else {
                    // ż = (δ̇/d)(1 − z·sgn δ̇), exact along the way.
                    way.signum() - (way.signum() - *z) * (-way.abs() / yields).exp()
                };
                sum += force * *z;
            }
        }
        sum
    }

    fn adhesion(&self, now: &mut Memory, depth: f64, speed: f64) -> f64 {
        let mut pull = 0.0;
        for effect in &self.hidden {
            if let Effect::Attraction { force, range } = effect {
                pull += force / (1.0 + (-depth).max(0.0) / range).powi(2);
            }
            if let Effect::Adhesion {
                force,
                neck,
                loading,
                shape,
            } = effect
            {
                if depth > 0.0 {
                    now.necked = true;
                    // From the loading share to the whole within 0.5 mm/s of turning back.
                    let back = 0.5 * (1.0 - (speed / 0.5e-3).tanh());
                    pull += force * (loading + (1.0 - loading) * back);
                } else if now.necked && depth > -neck {
                    pull += force * (1.0 + depth / neck).powf(*shape);
                } else {
                    now.necked = false;
                }
            }
        }
        pull
    }
}

/// e^{−u}, and the share (1−e^{−u})/u that is left of a linear rise.
pub(super) fn kept(u: f64) -> (f64, f64) {
    ((-u).exp(), if u < 1e-9 { 1.0 } else { -(-u).exp_m1() / u })
}

fn softened(depth: f64, deepest: f64, fraction: f64, scale: f64, energy: f64) -> f64 {
    let below = (deepest - depth).max(0.0);
    if energy == 0.0 {
        1.0 - fraction * (1.0 - (-below / scale).exp())
    } else {
        let lost = (1.0 - (depth / deepest.max(depth)).powf(energy)) * deepest / (energy * scale);
        // erf to 3·10⁻⁴ in a tanh: the material is invented anyway.
        1.0 - fraction
            * (std::f64::consts::FRAC_2_SQRT_PI * lost * (1.0 + 0.0894 * lost * lost)).tanh()
    }
}

fn hinge(over: f64, rounding: f64) -> f64 {
    if rounding == 0.0 || over > 30.0 * rounding {
        over.max(0.0)
    } else {
        rounding * (over / rounding).exp().ln_1p()
    }
}

fn limited(force: f64, limit: f64, sharpness: f64) -> f64 {
    if force <= 0.0 || sharpness.is_infinite() {
        force.min(limit)
    } else {
        force / (1.0 + (force / limit).powf(sharpness)).powf(1.0 / sharpness)
    }
}

/// The series between its sub-steps, linear; constant beyond both ends.
pub(super) fn at(series: &[f64], index: f64) -> f64 {
    let index = index.clamp(0.0, (series.len() - 1) as f64);
    let low = (index as usize).min(series.len() - 2);
    let share = index - low as f64;
    series[low] + share * (series[low + 1] - series[low])
}
