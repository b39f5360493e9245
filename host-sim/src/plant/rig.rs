//! Motor, material and sensors together: a motion in, a log and the truth out.

use estimator_core::physics::effect::Motion as Moved;
use estimator_core::physics::rig::{Reading, RigState};

use super::chain::{Chain, Channels, Effects, motion as moved};
use super::contact::Contact;
use super::motor::{Motor, MotorState};
use super::sensors::{Encoder, LoadCell, Sensors};
use crate::diagnostic::Diagnostic;
use crate::log::Log;
use crate::motion::Motion;

/// The rig without its material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rig {
    /// The motor that presses.
    pub motor: Motor,
    /// What is seen of it.
    pub sensors: Sensors,
    /// What it adds to a contact.
    pub effects: Effects,
    /// Integration steps per sample.
    pub substeps: u32,
}

impl Default for Rig {
    /// The default motor and sensors with 20 sub-steps: a touch then costs 38 nm on Kelvin–Voigt,
    /// whose force jumps, and less than 0.01 nm on Hunt–Crossley.
    fn default() -> Self {
        Rig {
            motor: Motor::default(),
            sensors: Sensors::default(),
            effects: Effects::none(),
            substeps: 20,
        }
    }
}

/// What lies under the probe until a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stage {
    /// End of the stage (s); the last stage lasts as long as the motion whatever it says.
    pub until_s: f64,
    /// The material.
    pub contact: Contact,
}

impl Stage {
    /// One material for the whole run.
    pub fn throughout(contact: Contact) -> [Stage; 1] {
        [Stage {
            until_s: f64::INFINITY,
            contact,
        }]
    }
}

/// What really happened, a value per sample of the log.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Truth {
    /// Time (s).
    pub time_s: Vec<f64>,
    /// Position of the probe (m).
    pub position_m: Vec<f64>,
    /// Velocity of the probe (m/s).
    pub velocity_mps: Vec<f64>,
    /// Force on the probe (N).
    pub force_n: Vec<f64>,
}

/// A run of the rig.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Run {
    /// What the sensors read.
    pub log: Log,
    /// What was true.
    pub truth: Truth,
    /// Samples whose force stood at an end of the converter's range.
    pub clipped: usize,
}

impl Rig {
    /// Follows `motion` through the materials of `schedule`, from rest. The noise is that of
    /// `seed`.
    ///
    /// # Errors
    /// An empty schedule, stages that do not follow each other in time, a material swapped while
    /// the probe is in it, or a material too stiff for the integration.
    pub fn run(&self, schedule: &[Stage], motion: &Motion, seed: u64) -> Result<Run, Diagnostic> {
        check(schedule)?;
        let highest_m = motion.highest_m();
        for stage in schedule {
            self.check_followable(&stage.contact, highest_m)?;
        }
        let samples = (motion.duration_s() * self.sensors.rate_hz).round() as usize + 1;
        let mut cell = LoadCell::new(self.sensors, seed);
        let encoder = Encoder::new(self.sensors.position_step_m, seed);
        let mut recorder = Recorder::with_capacity(samples);
        let mut stage = 0;
        let mut probe = Probe::at_rest(self, &schedule[0].contact, motion);
        for sample in 0..samples {
            let time_s = sample as f64 / self.sensors.rate_hz;
            while stage + 1 < schedule.len() && time_s >= schedule[stage].until_s {
                let (old, new) = (&schedule[stage].contact, &schedule[stage + 1].contact);
                swap(old, new, time_s, probe.motor)?;
                stage += 1;
                probe.meet(self, new);
            }
            recorder.take(time_s, &probe, &encoder, &mut cell);
            for step in 0..self.substeps {
                probe.advance(self, time_s + f64::from(step) * self.step_s(), motion);
            }
        }
        Ok(recorder.finish(cell.clipped()))
    }

    /// Length of a sub-step (s).
    fn step_s(&self) -> f64 {
        1.0 / self.sensors.rate_hz / f64::from(self.substeps)
    }

    /// Runge–Kutta diverges at 2.8 steps per time constant; up to 1 its error is that of the tests.
    fn check_followable(&self, contact: &Contact, highest_m: f64) -> Result<(), Diagnostic> {
        // Slopes of the force at the deepest point, over a step small against any contact.
        let chain = Chain::new(contact, &self.effects);
        let at_rest_n = chain.pressed_n(highest_m, 0.0);
        let stiffness = (chain.pressed_n(highest_m + 1e-9, 0.0) - at_rest_n) / 1e-9;
        let damping = chain.pressed_n(highest_m, 1e-3) - at_rest_n;
        let step_s = self.step_s();
        let motor = &self.motor;
        let decay = step_s * (motor.damping_ns_per_m + damping / 1e-3) / motor.mass_kg;
        let swing = step_s * ((motor.stiffness_n_per_m + stiffness) / motor.mass_kg).sqrt();
        if decay.max(swing) <= 1.0 {
            return Ok(());
        }
        Err(Diagnostic::new("the material is too stiff or too damped for the simulated rig")
            .note(format!(
                "at {highest_m} m: {stiffness:.3e} N/m, {:.3e} N s/m against {} kg and steps of {step_s} s",
                damping / 1e-3,
                motor.mass_kg
            ))
            .remedy("check the units of stiffness (N/m) and damping (N s/m), press less deep, or raise the rate"))
    }
}

/// The motor, what it presses into, and what reaches the sensors of both.
struct Probe {
    motor: MotorState,
    chain: Chain,
    state: RigState<f64>,
    /// The contact now.
    reading: Reading<f64>,
    channels: Channels,
    /// Position (m) and force (N) at the sensors now.
    arrived: (f64, f64),
}

impl Probe {
    fn at_rest(rig: &Rig, contact: &Contact, motion: &Motion) -> Probe {
        let chain = Chain::new(contact, &rig.effects);
        let motor = MotorState::at_rest(motion.position(0.0).0);
        let mut state = chain.at_rest();
        let reading = chain.step(&mut state, moved(0.0, motor, 0.0), rig.step_s());
        let mut channels = Channels::new(&rig.effects, rig.step_s());
        let arrived = channels.push(motor.position_m, reading.force_n);
        Probe {
            motor,
            chain,
            state,
            reading,
            channels,
            arrived,
        }
    }

    /// Another material, while this one is not touched.
    fn meet(&mut self, rig: &Rig, contact: &Contact) {
        self.chain = Chain::new(contact, &rig.effects);
        self.state = self.state.renewed();
    }

    /// One sub-step from `from_s` (s).
    fn advance(&mut self, rig: &Rig, from_s: f64, motion: &Motion) {
        let step_s = rig.step_s();
        let (chain, before, at_start) = (&self.chain, &self.state, self.reading.touch.force_n);
        let contact_n = |elapsed_s: f64, moved: Moved<f64>| match elapsed_s > 0.0 {
            true => chain.trial_n(before, moved, elapsed_s),
            false => at_start,
        };
        self.motor = rig.motor.advance(
            self.motor,
            from_s,
            step_s,
            |at_s| motion.position(at_s),
            |elapsed_s, position_m, velocity_mps| {
                let state = MotorState {
                    position_m,
                    velocity_mps,
                };
                contact_n(elapsed_s, moved(from_s + elapsed_s, state, 0.0))
            },
        );
        let to_s = from_s + step_s;
        // The contact knows no acceleration, so its force gives the acceleration that inertia takes.
        let acceleration_mps2 = match chain.has_inertia() {
            false => 0.0,
            true => {
                let force_n = contact_n(step_s, moved(to_s, self.motor, 0.0));
                let drive_n = rig.motor.drive_n(self.motor, motion.position(to_s));
                (drive_n - force_n) / rig.motor.mass_kg
            }
        };
        let moved = moved(to_s, self.motor, acceleration_mps2);
        self.reading = chain.step(&mut self.state, moved, step_s);
        self.arrived = self
            .channels
            .push(self.motor.position_m, self.reading.force_n);
    }
}

fn check(schedule: &[Stage]) -> Result<(), Diagnostic> {
    if schedule.is_empty() {
        return Err(Diagnostic::new("the rig has nothing under its probe")
            .remedy("give at least one stage; free air is one"));
    }
    match schedule
        .windows(2)
        .find(|pair| pair[0].until_s >= pair[1].until_s)
    {
        None => Ok(()),
        Some(pair) => Err(
            Diagnostic::new("the stages do not follow each other in time")
                .value(pair[1].until_s)
                .note(format!("the stage before ends at {} s", pair[0].until_s))
                .remedy("order the stages by their ends"),
        ),
    }
}

fn swap(old: &Contact, new: &Contact, time_s: f64, state: MotorState) -> Result<(), Diagnostic> {
    if !old.touches(state.position_m) && !new.touches(state.position_m) {
        return Ok(());
    }
    Err(Diagnostic::new(format!(
        "the material is swapped at {time_s} s while the probe is in it"
    ))
    .value(format!("{:.6} m", state.position_m))
    .remedy("swap while the probe is above both surfaces"))
}

struct Recorder {
    truth: Truth,
    position_m: Vec<f64>,
    force_n: Vec<f64>,
}

impl Recorder {
    fn with_capacity(samples: usize) -> Recorder {
        let channel = || Vec::with_capacity(samples);
        Recorder {
            truth: Truth {
                time_s: channel(),
                position_m: channel(),
                velocity_mps: channel(),
                force_n: channel(),
            },
            position_m: channel(),
            force_n: channel(),
        }
    }

    fn take(&mut self, time_s: f64, probe: &Probe, encoder: &Encoder, cell: &mut LoadCell) {
        let (position_m, force_n) = probe.arrived;
        self.position_m.push(encoder.read_m(position_m));
        self.force_n.push(cell.read_n(force_n));
        self.truth.time_s.push(time_s);
        self.truth.position_m.push(probe.motor.position_m);
        self.truth.velocity_mps.push(probe.motor.velocity_mps);
        self.truth.force_n.push(probe.reading.touch.force_n);
    }

    fn finish(self, clipped: usize) -> Run {
        let mut log = Log::from_channels(self.truth.time_s.clone(), self.position_m, self.force_n);
        if clipped > 0 {
            log.notes.push(format!(
                "{clipped} of {} force samples stand at an end of the converter's range",
                log.len()
            ));
        }
        Run {
            log,
            truth: self.truth,
            clipped,
        }
    }
}

#[cfg(test)]
mod tests;

#[cfg(test)]
mod effect_tests;
