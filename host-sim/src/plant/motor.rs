//! A linear electric motor under position control.
//!
//! m·ẍ = sat( kp(x_ref − x) + kd(v_ref − v) ) − F_contact: a moving mass, a PD controller with the
//! velocity of the reference fed forward, the force that the coil can give, and the reaction of
//! what it presses against. The controller is continuous; a sampled one at 10 kHz and more, as in
//! any drive, adds less than a degree at the loop's bandwidth.

use std::f64::consts::TAU;

/// The motor and its controller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motor {
    /// m: moving mass (kg).
    pub mass_kg: f64,
    /// kp: position gain (N/m).
    pub stiffness_n_per_m: f64,
    /// kd: velocity gain (N s/m).
    pub damping_ns_per_m: f64,
    /// The coil's largest force, either way (N).
    pub force_limit_n: f64,
}

/// Where the motor is and how fast.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MotorState {
    /// x (m)
    pub position_m: f64,
    /// v (m/s)
    pub velocity_mps: f64,
}

/// A position and a velocity to follow (m), (m/s).
pub type Setpoint = (f64, f64);

impl Motor {
    /// A motor whose free closed loop has the natural frequency `bandwidth_hz` (Hz) and the damping
    /// ratio `damping_ratio`.
    pub fn with_bandwidth(
        mass_kg: f64,
        bandwidth_hz: f64,
        damping_ratio: f64,
        force_limit_n: f64,
    ) -> Motor {
        let omega = TAU * bandwidth_hz;
        Motor {
            mass_kg,
            stiffness_n_per_m: mass_kg * omega * omega,
            damping_ns_per_m: 2.0 * damping_ratio * omega * mass_kg,
            force_limit_n,
        }
    }

    /// The coil's force (N).
    pub fn drive_n(&self, state: MotorState, setpoint: Setpoint) -> f64 {
        let (position_m, velocity_mps) = setpoint;
        let wanted_n = self.stiffness_n_per_m * (position_m - state.position_m)
            + self.damping_ns_per_m * (velocity_mps - state.velocity_mps);
        wanted_n.clamp(-self.force_limit_n, self.force_limit_n)
    }

    /// One step of the classical Runge–Kutta method over `step_s` (s) from time `time_s`.
    ///
    /// `setpoint` maps a time to what the motor follows, `contact_n` the time since the step began,
    /// position and velocity to the force against it. Of fourth order as long as both are smooth; at a touch the error of that
    /// one step is of second order.
    pub fn advance(
        &self,
        state: MotorState,
        time_s: f64,
        step_s: f64,
        setpoint: impl Fn(f64) -> Setpoint,
        contact_n: impl Fn(f64, f64, f64) -> f64,
    ) -> MotorState {
        let half_s = 0.5 * step_s;
        let middle = setpoint(time_s + half_s);
        let slope = |state: MotorState, elapsed_s: f64, setpoint: Setpoint| MotorState {
            position_m: state.velocity_mps,
            velocity_mps: (self.drive_n(state, setpoint)
                - contact_n(elapsed_s, state.position_m, state.velocity_mps))
                / self.mass_kg,
        };
        let k1 = slope(state, 0.0, setpoint(time_s));
        let k2 = slope(state.moved(k1, half_s), half_s, middle);
        let k3 = slope(state.moved(k2, half_s), half_s, middle);
        let k4 = slope(state.moved(k3, step_s), step_s, setpoint(time_s + step_s));
        let sixth_s = step_s / 6.0;
        state
            .moved(k1, sixth_s)
            .moved(k2, 2.0 * sixth_s)
            .moved(k3, 2.0 * sixth_s)
            .moved(k4, sixth_s)
    }
}

impl Default for Motor {
    /// Half a kilogram at 100 Hz, ζ = 0.7, 80 N: 10 N of contact push it back by 0.05 mm.
    fn default() -> Self {
        Motor::with_bandwidth(0.5, 100.0, 0.7, 80.0)
    }
}

impl MotorState {
    /// At rest at `position_m` (m).
    pub fn at_rest(position_m: f64) -> MotorState {
        MotorState {
            position_m,
            velocity_mps: 0.0,
        }
    }

    fn moved(self, slope: MotorState, step_s: f64) -> MotorState {
        MotorState {
            position_m: self.position_m + step_s * slope.position_m,
            velocity_mps: self.velocity_mps + step_s * slope.velocity_mps,
        }
    }
}

#[cfg(test)]
mod tests;
