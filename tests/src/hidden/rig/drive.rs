//! The mechanics around the contact, one sub-step at a time: play, spring, load path, lag.

use super::effect::{Effect, Friction, wave, wave_slope};
use super::plant::{MOST, Memory, Plant, STANDING_MPS, kept};
use super::stranger::Running;

/// The frequency at which the amplitude of a disturbance breathes (Hz).
const BREATHING_HZ: f64 = 0.31;

/// A rig in motion.
pub(super) struct Drive<'a> {
    plant: &'a Plant,
    memory: Memory,
    stranger: Option<Running>,
    spring: Option<(f64, f64, f64)>,
    /// Position of the tip in the last two sub-steps (m).
    tips: [f64; 2],
    /// Sub-steps since the touch: the parabola for the rate must not reach across it.
    touching: usize,
    plays: [f64; MOST],
    friction: f64,
    loose: [f64; 2],
    lag: [f64; 2],
    slips: [f64; MOST],
    /// z of a loop and of the one inside it (m).
    loops: [f64; 2],
    /// Force and its rate behind a load cell that resonates.
    cell: [f64; 2],
    last: f64,
    before_x: f64,
    started: bool,
}

impl<'a> Drive<'a> {
    pub(super) fn new(plant: &'a Plant, x: f64) -> Self {
        let spring = plant.hidden.iter().find_map(|effect| match effect {
            Effect::Compliance {
                stiffness,
                progressive,
                scale,
            } => Some((*stiffness, *progressive, *scale)),
            _ => None,
        });
        let mut memory = Memory::default();
        memory.depth = x - plant.material.surface;
        Drive {
            plant,
            memory,
            stranger: plant.running(0),
            spring,
            tips: [x; 2],
            touching: 0,
            plays: [x; MOST],
            friction: 0.0,
            loose: [0.0; 2],
            lag: [0.0; 2],
            slips: [0.0; MOST],
            loops: [0.0; 2],
            cell: [0.0; 2],
            last: 0.0,
            before_x: x,
            started: false,
        }
    }

    pub(super) fn step(&mut self, t: f64, x: f64, v: f64, a: f64, dt: f64) -> f64 {
        let driven = self.play(x, v);
        let moved = self.surface(t);
        let contact = match self.spring {
            None => {
                let (force, memory) =
                    self.plant
                        .contact(&self.memory, &mut self.stranger, driven, moved, dt);
                self.memory = memory;
                force
            }
            Some(spring) => self.sprung(driven.0, moved, spring, dt),
        };
        let force = contact + self.load(t, x, v, a, dt) + self.rubbing(contact, x, v);
        self.before_x = x;
        let read = self.lagged(force, dt);
        self.started = true;
        read
    }

    /// The position behind the play and its speed.
    fn play(&mut self, x: f64, v: f64) -> (f64, f64) {
        let plays = self.plant.hidden.iter().find_map(|effect| match effect {
            Effect::Backlash { plays } => Some(plays),
            _ => None,
        });
        let Some(plays) = plays else { return (x, v) };
        let (mut tip, mut speed) = (0.0, 0.0);
        for (at, (width, share)) in self.plays.iter_mut().zip(plays) {
            let held = at.clamp(x - 0.5 * width, x + 0.5 * width);
            if held != *at {
                speed += share * v;
            }
            *at = held;
            tip += share * held;
        }
        (tip, speed)
    }

    fn surface(&self, t: f64) -> (f64, f64) {
        let mut moved = (0.0, 0.0);
        for effect in &self.plant.hidden {
            if let Effect::Surface {
                amplitude,
                hz,
                phase,
                second,
            } = effect
            {
                let w = std::f64::consts::TAU * hz;
                moved.0 += amplitude * wave(w * t + phase, *second);
                moved.1 += amplitude * w * wave_slope(w * t + phase, *second);
            }
        }
        moved
    }

    /// The contact behind a spring: the tip lies where spring and contact push alike, found by a secant
    /// within a bisection since the difference increases.
    fn sprung(&mut self, driven: f64, moved: (f64, f64), spring: (f64, f64, f64), dt: f64) -> f64 {
        let (plant, before, tips) = (self.plant, self.memory, self.tips);
        let parabola = self.touching > 1;
        let trial = |tip: f64| {
            let way = if parabola {
                1.5 * tip - 2.0 * tips[0] + 0.5 * tips[1]
            } else {
                tip - tips[0]
            };
            let speed = way / dt;
            let (force, memory) = plant.contact(&before, &mut None, (tip, speed), moved, dt);
            (force - spring_force(driven - tip, spring), memory)
        };
        let (mut low, mut high) = (driven - 8e-3, driven + 1e-3);
        let guess = driven - (self.before_x - tips[0]);
        let mut tip = guess.clamp(low, high);
        let mut step = 1e-7;
        let mut found = trial(tip);
        let (mut old_tip, mut old_error) = (tip, found.0);
        for _ in 0..60 {
            if found.0 > 0.0 {
                high = tip;
            } else {
                low = tip;
            }
            if found.0.abs() < 1e-9 || high - low < 1e-15 {
                break;
            }
            let slope = (found.0 - old_error) / (tip - old_tip);
            let next = if slope.is_finite() && slope > 0.0 {
                tip - found.0 / slope
            } else {
                step *= 4.0;
                tip - step * found.0.signum()
            };
            (old_tip, old_error) = (tip, found.0);
            tip = if next > low && next < high {
                next
            } else {
                0.5 * (low + high)
            };
            found = trial(tip);
        }
        self.memory = found.1;
        // A tip that the damper stops lies at the surface to the last bit.
        self.touching = if self.memory.depth > -1e-12 {
            self.touching + 1
        } else {
            0
        };
        self.tips = [tip, tips[0]];
        // The force of the spring: that of the contact is undetermined where a damper is met at speed.
        spring_force(driven - tip, spring)
    }

    fn load(&mut self, t: f64, x: f64, v: f64, a: f64, dt: f64) -> f64 {
        let mut sum = 0.0;
        for effect in &self.plant.hidden {
            sum += match effect {
                Effect::Friction(friction) => {
                    self.friction = rubbed(self.friction, x - self.before_x, v, friction);
                    self.friction
                }
                Effect::Inertia {
                    mass,
                    loose,
                    hz,
                    damping,
                } => {
                    mass * ((1.0 - loose) * a
                        + loose * swing(&mut self.loose, a, *hz, *damping, dt))
                }
                Effect::Iwan { elements } => {
                    let way = x - self.before_x;
                    let each = self.slips.iter_mut().zip(elements);
                    each.map(|(z, (force, slips))| {
                        *z = (*z + way / slips).clamp(-1.0, 1.0);
                        force * *z
                    })
                    .sum()
                }
                Effect::Loop {
                    stiffness,
                    beta,
                    gamma,
                    exponent,
                    inner,
                } => {
                    let way = x - self.before_x;
                    let [z, small] = &mut self.loops;
                    *z = looped(*z, way, *beta, *gamma, *exponent);
                    *small = looped(*small, way, 10.0 * beta.abs(), 10.0 * beta.abs(), 1.0);
                    stiffness * (*z + 10.0 * inner * *small)
                }
                Effect::Cable { .. } => {
                    let pulled = self.plant.flanks(x);
                    let each = pulled.iter();
                    each.map(|(x, share)| share * plain_load(effect, t, *x, v))
                        .sum()
                }
                effect => plain_load(effect, t, x, v),
            };
        }
        let depth = self.memory.depth;
        sum + self.stranger.as_mut().map_or(0.0, |s| s.load(v, depth, dt))
    }

    /// Friction that grows with the load (N).
    fn rubbing(&self, contact: f64, x: f64, v: f64) -> f64 {
        let all = &self.plant.hidden;
        let cables = all.iter().filter(|own| matches!(own, Effect::Cable { .. }));
        let load = contact + cables.map(|own| plain_load(own, 0.0, x, v)).sum::<f64>();
        let each = all.iter().map(|effect| match effect {
            Effect::LoadFriction {
                coefficient,
                smooth,
                rises,
                speed,
            } => {
                let more = 1.0 + rises * (-(v / speed).powi(2)).exp();
                coefficient * more * load.abs() * (v / smooth).tanh()
            }
            _ => 0.0,
        });
        each.sum()
    }

    /// The low-pass, exact for a force that is linear within the step.
    fn lagged(&mut self, force: f64, dt: f64) -> f64 {
        let mut read = force;
        for effect in &self.plant.hidden {
            if let Effect::Resonance { hz, damping } = effect {
                if !self.started {
                    self.cell = [force, 0.0];
                }
                read = resonated(&mut self.cell, force, *hz, *damping, dt);
            }
            if let Effect::Lag { time, order } = effect {
                let stage_s = time / *order as f64;
                let mut input = (if self.started { self.last } else { force }, force);
                self.last = force;
                for stage in self.lag.iter_mut().take(*order) {
                    let before = if self.started { *stage } else { force };
                    let (keep, rise) = kept(dt / stage_s);
                    // y = input − what has not come through yet.
                    *stage = input.1 + keep * (before - input.0) - rise * (input.1 - input.0);
                    input = (before, *stage);
                    read = *stage;
                }
            }
        }
        read
    }
}

/// z (m) after a way (m) of dz = (1 − β·sgn·|z|^{ν−1}z − γ|z|^ν) ds, by Heun's method.
fn looped(z: f64, way: f64, beta: f64, gamma: f64, exponent: f64) -> f64 {
    let slope = |z: f64| {
        let size = z.abs().powf(exponent);
        1.0 - size * (beta * way.signum() * z.signum() + gamma)
    };
    let tried = z + way * slope(z);
    z + 0.5 * way * (slope(z) + slope(tried))
}

fn spring_force(stretch: f64, (stiffness, progressive, scale): (f64, f64, f64)) -> f64 {
    stiffness * stretch * (1.0 + progressive * (stretch / scale).clamp(0.0, 3.0))
}

fn rubbed(before: f64, way: f64, v: f64, friction: &Friction) -> f64 {
    let steady = friction.steady(v);
    if friction.width > 0.0 {
        let end = steady * way.signum();
        end - (end - before) * (-way.abs() * friction.kinetic / (friction.width * steady)).exp()
    } else if friction.smooth > 0.0 {
        steady * (v / friction.smooth).tanh()
    } else if v.abs() > STANDING_MPS {
        steady * v.signum()
    } else {
        0.0
    }
}

/// The force (N) behind a load cell of second order, semi-implicit.
pub(super) fn resonated(state: &mut [f64; 2], force: f64, hz: f64, damping: f64, dt: f64) -> f64 {
    let w = std::f64::consts::TAU * hz;
    state[1] += dt * (w * w * (force - state[0]) - 2.0 * damping * w * state[1]);
    state[0] += dt * state[1];
    state[0]
}

/// The acceleration (m/s²) of a mass that hangs on a spring, semi-implicit.
fn swing(state: &mut [f64; 2], a: f64, hz: f64, damping: f64, dt: f64) -> f64 {
    let w = std::f64::consts::TAU * hz;
    let pulled = -w * w * state[0] - 2.0 * damping * w * state[1];
    state[1] += dt * (pulled - a);
    state[0] += dt * state[1];
    pulled
}

/// The force of an effect that depends on time, position and speed alone (N).
fn plain_load(effect: &Effect, t: f64, x: f64, v: f64) -> f64 {
    let tau = std::f64::consts::TAU;
    match effect {
        Effect::Load { formula, params } => formula.0(params, t, x, v),
        Effect::Drag { linear, quadratic } => linear * v + quadratic * v * v.abs(),
        Effect::AsymmetricDrag {
            coefficient,
            bend,
            speed,
        } => {
            if *bend == 0.0 {
                coefficient * v.abs()
            } else {
                coefficient * v.abs() * (v.abs() / speed).powf(*bend)
            }
        }
        Effect::Offset {
            force,
            settling,
            time,
        } => {
            if *settling == 0.0 {
                *force
            } else {
                force * (1.0 - settling * (-t / time).exp())
            }
        }
        Effect::Drift {
            rate,
            time,
            bend,
            scale,
        } => {
            if *bend > 0.0 {
                rate * scale * (t / scale).powf(*bend)
            } else if *time > 0.0 {
                -rate * time * (-t / time).exp_m1()
            } else {
                rate * t
            }
        }
        Effect::Cable {
            stiffness,
            hardening,
            scale,
        } => stiffness * x * (1.0 + hardening * (x / scale) * (x / scale)),
        Effect::Cogging {
            amplitude,
            pitch,
            phase,
            second,
        } => amplitude * wave(tau * x / pitch + phase, *second),
        Effect::Disturbance {
            amplitude,
            hz,
            phase,
            second,
            breathing,
        } => {
            let swell = 1.0 + breathing * (tau * BREATHING_HZ * t).sin();
            amplitude * swell * wave(tau * hz * t + phase, *second)
        }
        _ => 0.0,
    }
}
