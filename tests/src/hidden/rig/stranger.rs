//! The misfits that are in no catalogue, at work on a simulated rig.
//!
//! Each is a state machine fed at every sub-step; `strength` is in the unit that the kind needs
//! (relative for gain and stiffness, N for what adds to the force).

use super::effect::Stranger;
use super::random::Random;

/// A misfit at work.
#[derive(Clone, Debug)]
pub(crate) struct Running {
    kind: Stranger,
    strength: f64,
    random: Random,
    /// Slow random states, whose meaning depends on the kind.
    walk: [f64; 2],
    phase: f64,
    /// Seconds, or metres, until the next event.
    left: f64,
    level: f64,
    touching: bool,
    deepest: f64,
    hz: f64,
}

impl Running {
    pub(crate) fn new(kind: Stranger, strength: f64, seed: u64) -> Self {
        let mut random = Random::new(seed, 77);
        let hz = random.log_between(25.0, 80.0);
        Running {
            kind,
            strength,
            walk: [random.normal(), 0.0],
            phase: random.phase(),
            left: 0.0,
            level: 0.0,
            touching: false,
            deepest: 0.0,
            hz,
            random,
        }
    }

    /// Ornstein–Uhlenbeck of unit variance, smoothed by a second stage of the same corner.
    fn wander(&mut self, corner_hz: f64, dt: f64) -> f64 {
        let keep = (-std::f64::consts::TAU * corner_hz * dt).exp();
        self.walk[0] = keep * self.walk[0] + (1.0 - keep * keep).sqrt() * self.random.normal();
        self.walk[1] += (1.0 - keep) * (self.walk[0] - self.walk[1]);
        // The second stage of equal corners halves the variance.
        self.walk[1] * std::f64::consts::SQRT_2
    }

    /// True at the first sub-step of a touch.
    fn touches(&mut self, depth: f64) -> bool {
        let touches = depth > 0.0 && !self.touching;
        self.touching = depth > 0.0;
        touches
    }

    /// The factor on the stiffness of the contact; to be called once a sub-step, before the contact.
    pub(crate) fn stiffness(&mut self, depth: f64) -> f64 {
        match self.kind {
            Stranger::TouchStiffness => {
                if self.touches(depth) {
                    self.level = self.random.normal().clamp(-2.5, 2.5);
                }
                1.0 + (self.strength * self.level).clamp(-0.6, 0.6)
            }
            Stranger::Crackle => {
                if depth > self.deepest {
                    self.left -= depth - self.deepest;
                    self.deepest = depth;
                    if self.left < 0.0 {
                        self.left = -0.25e-3 * (1.0 - self.random.unit()).ln();
                        self.level += self.random.between(0.3, 1.0);
                    }
                }
                1.0 - (self.strength * self.level).min(0.8)
            }
            Stranger::Swap | Stranger::Fatigue => {
                if self.touches(depth) {
                    self.level += 1.0;
                }
                match self.kind {
                    // The second or the fourth touch meets it, of some two or eight.
                    Stranger::Swap if self.level > if self.hz < 40.0 { 1.0 } else { 3.0 } => {
                        1.0 + self.strength.min(1.5)
                    }
                    Stranger::Swap => 1.0,
                    _ => (1.0 + self.strength.min(0.3)).powf(-self.level),
                }
            }
            _ => 1.0,
        }
    }

    /// The damping force (N) that it adds in contact.
    pub(crate) fn damping(&self, speed: f64) -> f64 {
        match self.kind {
            Stranger::SquareDamping => self.strength * speed * speed.abs() / 1e-4,
            _ => 0.0,
        }
    }

    /// The force (N) that it adds in the load path.
    pub(crate) fn load(&mut self, v: f64, depth: f64, dt: f64) -> f64 {
        match self.kind {
            Stranger::Chatter => {
                self.phase += std::f64::consts::TAU * dt * (15.0 + 1500.0 * v.abs());
                self.phase += 6.0 * dt.sqrt() * self.random.normal();
                self.strength * (v.abs() / 10e-3) * self.phase.sin()
            }
            // A specimen that moves sideways takes the tip along only while they touch. In free air it
            // would be coloured noise, and noise is not hidden.
            Stranger::Crosstalk if depth <= 0.0 => 0.0,
            Stranger::Crosstalk => self.strength * self.wander(1.5, dt),
            Stranger::ThermalWalk => self.strength * self.wander(0.08, dt),
            Stranger::StickSlip => self.stick_slip(v, dt),
            Stranger::Ringing => self.ringing(v, depth, dt),
            Stranger::ZeroJumps => {
                if self.touches(depth) {
                    self.level = self.random.normal().clamp(-2.5, 2.5);
                }
                self.strength * self.level
            }
            Stranger::HandBumps => {
                self.event(0.9, 0.1, 0.35, dt);
                // A hand pushes softly: both flanks of a bump take 30 ms.
                self.walk[0] += dt / 0.03 * (self.level - self.walk[0]);
                self.strength * self.walk[0]
            }
            _ => 0.0,
        }
    }

    /// The force builds up with the way and drops to nothing after a random way.
    fn stick_slip(&mut self, v: f64, dt: f64) -> f64 {
        self.left -= v.abs() * dt;
        if self.left < 0.0 {
            self.left = self.random.log_between(0.05e-3, 0.6e-3);
            self.level = 0.0;
            self.walk[0] = self.random.between(0.5, 1.5);
        }
        self.level += v * dt / 0.25e-3 * self.walk[0];
        self.strength * self.level
    }

    fn ringing(&mut self, v: f64, depth: f64, dt: f64) -> f64 {
        if self.touches(depth) {
            self.level += v.abs() / 15e-3;
            self.phase = 0.0;
        }
        self.phase += std::f64::consts::TAU * self.hz * dt;
        self.level *= (-dt / 0.12).exp();
        self.strength * self.level * self.phase.sin()
    }

    /// The force (N) as the sensor reads it; `peak` is the largest force (N).
    pub(crate) fn sensor(&mut self, force: f64, peak: f64, dt: f64) -> f64 {
        match self.kind {
            Stranger::GainWalk => force * (1.0 + self.strength * self.wander(0.4, dt)),
            Stranger::ConverterWaves => {
                force + self.strength * (std::f64::consts::TAU * force / (0.23 * peak)).sin()
            }
            Stranger::Spikes => {
                self.event(0.35, 0.004, 0.02, dt);
                force + self.strength * self.level
            }
            Stranger::Dropouts => {
                self.event(0.5, 0.02, 0.08, dt);
                // A share of the force is lost while the contact of the plug is bad.
                force * (1.0 - (self.strength * self.level.abs()).min(1.0))
            }
            Stranger::Chirps => {
                // From 3 to 3 + 25 Hz in 2.5 s, and again.
                self.left += dt;
                let at = self.left % 2.5;
                self.phase += std::f64::consts::TAU * dt * (3.0 + 10.0 * at);
                force + self.strength * self.phase.sin()
            }
            Stranger::Bursts => {
                self.event(0.6, 0.1, 0.4, dt);
                force + self.strength * self.level * self.random.normal()
            }
            Stranger::Telegraph => {
                self.event(0.7, 0.2, 1.5, dt);
                force + self.strength * self.level.signum() * f64::from(self.level != 0.0)
            }
            _ => force,
        }
    }

    /// Moves on by `dt`: pauses of `pause` seconds on average, then a level for `shortest` to `longest`
    /// seconds.
    fn event(&mut self, pause: f64, shortest: f64, longest: f64, dt: f64) {
        self.left -= dt;
        if self.left < 0.0 {
            if self.level == 0.0 {
                self.level = self.random.sign() * self.random.between(0.5, 1.5);
                self.left = self.random.between(shortest, longest);
            } else {
                self.level = 0.0;
                self.left = -pause * (1.0 - self.random.unit()).ln();
            }
        }
    }
}
