//! A manipulator of one degree of freedom: mass, damping, friction, and an actuator with a bandwidth and a
//! largest force. Master and slave are two of them.
//!
//! m·v̇ = F_a + F_o − b·v − F_c·sgn(v), Ḟ_a = 2πf_a·(sat(F_command) − F_a). The position x grows into the
//! material, F_a is the actuator's force along it and F_o that of whoever holds or touches the device.
//! Steps are semi-implicit: damping and friction enter with the new speed, so friction can hold the device
//! at rest, and a step of 50 µs is stable up to 4·10⁴ N/m on half a kilogram and far beyond.

use std::f64::consts::TAU;

/// A manipulator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Device {
    /// m (kg)
    pub mass_kg: f64,
    /// b (N s/m)
    pub damping_ns_per_m: f64,
    /// F_c: Coulomb friction (N).
    pub friction_n: f64,
    /// The largest force of the actuator, either way (N).
    pub force_limit_n: f64,
    /// f_a: bandwidth of the actuator (Hz); infinite for an ideal one.
    pub bandwidth_hz: f64,
}

/// The state of a [`Device`], and the work that its parts have done.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DeviceState {
    /// x (m)
    pub position_m: f64,
    /// v (m/s)
    pub speed_mps: f64,
    /// F_a (N)
    pub actuator_n: f64,
    /// v̇ of the last step (m/s²).
    pub acceleration_mps2: f64,
    /// The work of the actuator so far (J).
    pub actuator_j: f64,
    /// The work of whoever holds or touches the device so far (J).
    pub outer_j: f64,
    /// What damping and friction have turned into heat so far (J).
    pub lost_j: f64,
}

impl Device {
    /// The master of the comparison: a handle on a motor with the 120 N s/m of damping that the renderer
    /// needs for the chapter's gel at 4.5 mm (110 N s/m; plastic 28).
    pub const MASTER: Device = Device {
        mass_kg: 0.4,
        damping_ns_per_m: 120.0,
        friction_n: 0.1,
        force_limit_n: 30.0,
        bandwidth_hz: 300.0,
    };

    /// The slave of the comparison: the moving mass of the simulated rig.
    pub const SLAVE: Device = Device {
        mass_kg: 0.5,
        damping_ns_per_m: 5.0,
        friction_n: 0.2,
        force_limit_n: 40.0,
        bandwidth_hz: 500.0,
    };

    /// The device without friction, with an actuator that follows at once: the linear system of theory.
    #[must_use]
    pub fn ideal(self) -> Device {
        Device {
            friction_n: 0.0,
            force_limit_n: f64::INFINITY,
            bandwidth_hz: f64::INFINITY,
            ..self
        }
    }

    /// One step of `step_s` (s) under an actuator's command (N) and an outer force (N), with a mass of
    /// the hand (kg) moving along.
    pub fn advance(
        &self,
        state: &mut DeviceState,
        command_n: f64,
        outer_n: f64,
        carried_kg: f64,
        step_s: f64,
    ) {
        let wanted_n = command_n.clamp(-self.force_limit_n, self.force_limit_n);
        state.actuator_n += self.share(step_s) * (wanted_n - state.actuator_n);
        let mass_kg = self.mass_kg + carried_kg;
        let free_mps = state.speed_mps + step_s * (state.actuator_n + outer_n) / mass_kg;
        let held_mps = step_s * self.friction_n / mass_kg;
        let sliding_mps = free_mps.signum() * (free_mps.abs() - held_mps).max(0.0);
        let speed_mps = sliding_mps / (1.0 + step_s * self.damping_ns_per_m / mass_kg);
        // The work of a force is that along the mean speed of the step: kinetic energy then balances.
        let way_m = 0.5 * (state.speed_mps + speed_mps) * step_s;
        let inertia_n = mass_kg * (speed_mps - state.speed_mps) / step_s;
        state.actuator_j += state.actuator_n * way_m;
        state.outer_j += outer_n * way_m;
        state.lost_j += (state.actuator_n + outer_n - inertia_n) * way_m;
        state.acceleration_mps2 = (speed_mps - state.speed_mps) / step_s;
        state.position_m += speed_mps * step_s;
        state.speed_mps = speed_mps;
    }

    /// The share of a change of the command that the actuator follows within a step.
    fn share(&self, step_s: f64) -> f64 {
        match self.bandwidth_hz.is_finite() {
            true => -(-TAU * self.bandwidth_hz * step_s).exp_m1(),
            false => 1.0,
        }
    }
}

impl DeviceState {
    /// At rest at a position (m).
    pub fn at_rest(position_m: f64) -> DeviceState {
        DeviceState {
            position_m,
            ..DeviceState::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEP_S: f64 = 5e-5;

    #[test]
    fn a_push_against_damping_approaches_the_closed_form() {
        // v = (F/b)(1 − e^{−bt/m}) of a constant force.
        let device = Device::MASTER.ideal();
        let mut state = DeviceState::default();
        for step in 1..=4000 {
            device.advance(&mut state, 0.0, 6.0, 0.6, STEP_S);
            let exact = 0.05 * -(-120.0 * f64::from(step) * STEP_S / 1.0).exp_m1();
            // First order in the step: 50 µs of a time constant of 8.3 ms, of which e^{−1}/2 shows.
            assert!((state.speed_mps - exact).abs() < 6e-5, "{step}");
        }
    }

    #[test]
    fn friction_holds_what_it_can_and_no_more() {
        let mut held = DeviceState::default();
        let mut moved = DeviceState::default();
        for _ in 0..1000 {
            Device::MASTER.advance(&mut held, 0.0, 0.099, 0.0, STEP_S);
            Device::MASTER.advance(&mut moved, 0.0, 0.101, 0.0, STEP_S);
        }
        assert_eq!(held.position_m, 0.0);
        assert!(moved.position_m > 0.0);
    }

    #[test]
    fn work_kinetic_energy_and_heat_balance() {
        let mut state = DeviceState::default();
        for step in 0..20_000 {
            let time_s = f64::from(step) * STEP_S;
            let hand_n = 8.0 * (9.0 * time_s).sin();
            Device::MASTER.advance(
                &mut state,
                -2.0 * (31.0 * time_s).cos(),
                hand_n,
                0.5,
                STEP_S,
            );
        }
        let kinetic_j = 0.5 * 0.9 * state.speed_mps.powi(2);
        let given_j = state.actuator_j + state.outer_j;
        assert!((given_j - kinetic_j - state.lost_j).abs() < 1e-12 * given_j.abs().max(1.0));
        assert!(state.lost_j > 0.1, "{}", state.lost_j);
    }

    #[test]
    fn the_actuator_follows_within_its_bandwidth_and_force() {
        let mut state = DeviceState::default();
        let time_constant_s = 1.0 / (TAU * 300.0);
        let steps = (time_constant_s / STEP_S).round() as u32;
        for _ in 0..steps {
            Device::MASTER.advance(&mut state, 1e3, 0.0, 0.0, STEP_S);
        }
        let exact = -(-f64::from(steps) * STEP_S / time_constant_s).exp_m1();
        assert!(
            (state.actuator_n / 30.0 - exact).abs() < 1e-12,
            "{}",
            state.actuator_n
        );
    }
}
