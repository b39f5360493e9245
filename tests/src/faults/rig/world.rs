//! What the probe meets, sub-step by sub-step.

use super::FINE_HZ;
use super::material::Material;
use super::plan::World;

/// The material from a moment on.
#[derive(Clone, Copy, Debug)]
pub struct Stage {
    /// From (s).
    pub from_s: f64,
    /// What is touched from then on.
    pub material: Material,
}

/// What the integration remembers.
struct State {
    tip_m: f64,
    moved_m: f64,
    relaxed_n: f64,
    bristle_m: f64,
    attached: bool,
}

/// The force (N) at the load cell along a path relative to the surface.
pub fn forces(path: &[f64], stages: &[Stage], world: &World) -> Vec<f64> {
    let dt = 1.0 / FINE_HZ;
    let mut state = State {
        tip_m: path[0],
        moved_m: 0.0,
        relaxed_n: 0.0,
        bristle_m: 0.0,
        attached: false,
    };
    let mut stage = 0;
    let mut before = path[0];
    let mut forces = Vec::with_capacity(path.len());
    for (k, x) in path.iter().enumerate() {
        let t = k as f64 * dt;
        while stages.get(stage + 1).is_some_and(|next| next.from_s <= t) {
            stage += 1;
        }
        let material = &stages[stage].material;
        let touch = state.contact(*x, t, material, world);
        let friction = state.friction(x - before, world);
        let next = path.get(k + 1).copied().unwrap_or(*x);
        let acceleration = (next - 2.0 * x + before) / (dt * dt);
        forces.push(touch + friction + world.mass_kg * acceleration);
        before = *x;
    }
    forces
}

impl State {
    /// The force of the material (N).
    fn contact(&mut self, x: f64, t: f64, material: &Material, world: &World) -> f64 {
        let dt = 1.0 / FINE_HZ;
        let surface = self.moved_m + world.surface_m(t);
        let tip = self.follow(x, surface, material, world);
        let (depth, speed) = (
            tip - surface,
            (tip - self.tip_m) / dt - world.surface_mps(t),
        );
        self.tip_m = tip;
        let mut force = material.force_n(depth, speed);
        if world.relaxing > 0.0 {
            let due = world.relaxing * material.force_n(depth, 0.0);
            self.relaxed_n += (due - self.relaxed_n) * (dt / world.relaxing_s);
            force = (force - self.relaxed_n).max(0.0);
        }
        if world.yields_at_n < f64::INFINITY && force > world.yields_at_n {
            self.moved_m += dt * world.yields_mps * (force / world.yields_at_n - 1.0);
        }
        force - self.pull(depth, world)
    }

    /// The position of the tip (m), behind play and a spring.
    fn follow(&self, x: f64, surface: f64, material: &Material, world: &World) -> f64 {
        let play = world.play_m / 2.0;
        let x = if play > 0.0 {
            self.tip_m.clamp(x - play, x + play)
        } else {
            x
        };
        let depth = self.tip_m - surface;
        if world.compliance_m_per_n <= 0.0 || depth <= 0.0 {
            return x;
        }
        // (x − y)/c = s(y_k)ⁿ·(K·δ₀ + λ·(y − y_k)/dt): implicit in the damping, which is stiff.
        let shape = material.shape(depth);
        let held = material.numbers[0] * super::REFERENCE_M * shape;
        let drag = material.numbers[1] * shape * FINE_HZ;
        let spring = 1.0 / world.compliance_m_per_n;
        let tip = (x * spring - held + drag * self.tip_m) / (spring + drag);
        tip.min(x)
    }

    /// The force (N) by which an adhesive material pulls, which lets go of the probe late.
    fn pull(&mut self, depth: f64, world: &World) -> f64 {
        if world.adhesion_n <= 0.0 {
            return 0.0;
        }
        self.attached = depth > 0.0 || (self.attached && depth > -world.adhesion_m);
        match self.attached {
            true => world.adhesion_n * (1.0 + depth.min(0.0) / world.adhesion_m),
            false => 0.0,
        }
    }

    /// A bristle that breaks at its strength and springs back to half of it (N).
    fn friction(&mut self, moved_m: f64, world: &World) -> f64 {
        if world.friction_n <= 0.0 {
            return 0.0;
        }
        let longest = world.bristle_m;
        self.bristle_m += moved_m;
        if self.bristle_m.abs() > longest {
            self.bristle_m = 0.5 * longest * self.bristle_m.signum();
        }
        world.friction_n * self.bristle_m / longest
    }
}
