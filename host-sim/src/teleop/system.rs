//! The whole system in time: operator, master, channel, slave, environment.
//!
//! Sensors, schemes and channels have ticks, as the boards do; devices, hand and contact are integrated in
//! sub-steps between them. Every tick ends in a row of the [`Trace`].

use estimator_core::board::reflection::Limit;
use estimator_core::physics::effect::Motion;
use estimator_core::{Estimate, Status};

use super::channel::{Channel, Counts};
use super::device::DeviceState;
use super::environment::Touching;
use super::hand::HandEstimate;
use super::options::Options;
use super::scheme::{MasterCommand, Message, Reflecting, Scheme, Sensed, SlaveCommand};
use super::trace::{Parameters, Row, Trace};
use crate::plant::{Encoder, LoadCell};
use estimator_core::board::reflection::SPEED_TIME_S;

/// Load cell, encoder and speed of one end.
struct Sensing {
    cell: Option<LoadCell>,
    encoder: Option<Encoder>,
    last_m: Option<f64>,
    speed_mps: f64,
    offset_us: u64,
}

impl Sensing {
    fn new(options: &Options, seed: u64, offset_us: u64) -> Sensing {
        Sensing {
            cell: options.sensors.map(|sensors| LoadCell::new(sensors, seed)),
            encoder: options
                .sensors
                .map(|sensors| Encoder::new(sensors.position_step_m, seed)),
            last_m: None,
            speed_mps: 0.0,
            offset_us,
        }
    }

    /// What the sensors say of a device under an outer force (N).
    fn read(&mut self, time_s: f64, period_s: f64, device: &DeviceState, force_n: f64) -> Sensed {
        let position_m = match &self.encoder {
            Some(encoder) => encoder.read_m(device.position_m),
            None => device.position_m,
        };
        // The boards' own speed filter.
        let last_m = self.last_m.replace(position_m).unwrap_or(position_m);
        self.speed_mps = match self.encoder {
            Some(_) => {
                (position_m - last_m + SPEED_TIME_S_F64 * self.speed_mps)
                    / (period_s + SPEED_TIME_S_F64)
            }
            None => device.speed_mps,
        };
        Sensed {
            time_us: (time_s * 1e6).round() as u64 + self.offset_us,
            period_s,
            position_m,
            speed_mps: self.speed_mps,
            force_n: self
                .cell
                .as_mut()
                .map_or(force_n, |cell| cell.read_n(force_n)),
            actuator_n: device.actuator_n,
        }
    }
}

const SPEED_TIME_S_F64: f64 = SPEED_TIME_S as f64;

/// The forces that act between two ticks.
#[derive(Clone, Copy, Debug, Default)]
struct Forces {
    /// Of the hand on the handle (N), as the master's load cell has it.
    hand_n: f64,
    /// Of the material on the slave (N), and as the slave's load cell has it.
    contact_n: f64,
    read_n: f64,
}

/// A run under way.
pub struct System<'a> {
    options: &'a Options,
    scheme: Box<dyn Scheme>,
    channels: [Channel<Message>; 2],
    sensing: [Sensing; 2],
    master: DeviceState,
    slave: DeviceState,
    contact: Touching,
    /// The same material at the master's position.
    felt_true: Touching,
    forces: Forces,
    true_n: f64,
    changed_s: Option<f64>,
    /// Energy into the material so far (J).
    material_j: f64,
    /// Contact of the slave with the material that is there now (s), and since when it was long enough
    /// for a change to be noticed (µs, by the slave's clock).
    touched_s: f64,
    known_us: Option<u64>,
    /// Sum of the ages of what each end applies (s), and in how many ticks.
    ages: [(f64, u32); 2],
}

/// An estimator has noticed another material after this much contact (s): 50 ms on the chapter's, and twice
/// that for good measure. Before, its estimates are those of the old one.
const NOTICED_S: f64 = 0.1;

impl<'a> System<'a> {
    /// The system at rest. The noise and the channels are those of `seed`.
    pub fn new(options: &'a Options, seed: u64) -> System<'a> {
        let start_m = options.operator.intention.position(0.0).0;
        let [there, back] = options.channels;
        // A millisecond before the first sample there is none, and no time 0.
        System {
            options,
            scheme: options.make(),
            channels: [
                Channel::new(there, seed ^ 0x7468_6572_6500),
                Channel::new(back, seed ^ 0x0062_6163_6b00),
            ],
            sensing: [
                Sensing::new(options, seed, 1000),
                Sensing::new(
                    options,
                    seed ^ 0x736c_6176_6500,
                    1000 + options.clock_offset_us,
                ),
            ],
            master: DeviceState::at_rest(start_m),
            slave: DeviceState::at_rest(start_m),
            contact: Touching::at_rest(&options.environment.first),
            felt_true: Touching::at_rest(&options.environment.first),
            forces: Forces::default(),
            true_n: 0.0,
            changed_s: None,
            material_j: 0.0,
            touched_s: 0.0,
            known_us: None,
            ages: [(0.0, 0); 2],
        }
    }

    /// Runs to the end of the intended motion.
    pub fn run(mut self) -> Trace {
        let ticks = (self.options.duration_s() * self.options.rate_hz).round() as usize;
        let mut trace = Trace::with_capacity(ticks, self.options);
        for tick in 0..ticks {
            let time_s = tick as f64 / self.options.rate_hz;
            trace.push(self.tick(time_s));
            if !self.is_finite() {
                break;
            }
        }
        trace.ages_s = self
            .ages
            .map(|(sum_s, ticks)| (ticks > 0).then(|| sum_s / f64::from(ticks)));
        trace.finish(self.changed_s, self.counts())
    }

    /// One tick and the sub-steps after it; gives the row of the tick.
    pub fn tick(&mut self, time_s: f64) -> Row {
        let period_s = self.options.period_s();
        self.change(time_s);
        self.compare(time_s, period_s);
        let of_master = self.sensing[0].read(time_s, period_s, &self.master, self.forces.hand_n);
        let of_slave = self.sensing[1].read(time_s, period_s, &self.slave, self.forces.read_n);
        self.count_contact(&of_slave);
        let arrived = newest(&mut self.channels[1], time_s);
        let master = self.scheme.master(&of_master, arrived);
        send(&mut self.channels[0], time_s, master.message);
        let arrived = newest(&mut self.channels[0], time_s);
        let slave = self.scheme.slave(&of_slave, arrived);
        send(&mut self.channels[1], time_s, slave.message);
        self.count_ages(time_s);
        let row = self.row(time_s, &master);
        let step_s = period_s / f64::from(self.options.substeps);
        for step in 0..self.options.substeps {
            self.advance(time_s, f64::from(step) * step_s, step_s, &master, &slave);
        }
        row
    }

    fn count_contact(&mut self, of_slave: &Sensed) {
        if self.forces.contact_n > 0.0 {
            self.touched_s += of_slave.period_s;
        }
        if self.known_us.is_none() && self.touched_s >= NOTICED_S {
            self.known_us = Some(of_slave.time_us);
        }
    }

    fn count_ages(&mut self, time_s: f64) {
        for (sum, channel) in self.ages.iter_mut().zip(&self.channels) {
            if let Some(age_s) = channel.age_s(time_s) {
                *sum = (sum.0 + age_s, sum.1 + 1);
            }
        }
    }

    fn counts(&self) -> [Counts; 2] {
        [self.channels[0].counts(), self.channels[1].counts()]
    }

    /// Whether the system is still one: beyond a metre it is not.
    fn is_finite(&self) -> bool {
        self.master.position_m.abs() < 1.0 && self.slave.position_m.abs() < 1.0
    }

    /// Changes the material when it is due.
    fn change(&mut self, time_s: f64) {
        let environment = &self.options.environment;
        let Some(second) = &environment.second else {
            return;
        };
        let due = self.changed_s.is_none() && time_s >= environment.change_s;
        let touches = self.forces.contact_n > 0.0 || self.slave.position_m > 0.0;
        if due && (environment.while_touching || !touches) {
            self.changed_s = Some(time_s);
            (self.touched_s, self.known_us) = (0.0, None);
            self.contact.meet(second);
            self.felt_true.meet(second);
        }
    }

    /// What the material would be at the master's position.
    fn compare(&mut self, time_s: f64, period_s: f64) {
        let moved = Motion {
            time_s,
            position_m: self.master.position_m,
            speed_mps: self.master.speed_mps,
            acceleration_mps2: self.master.acceleration_mps2,
        };
        self.true_n = self.felt_true.step(moved, period_s).touch.force_n;
    }

    fn advance(
        &mut self,
        tick_s: f64,
        within_s: f64,
        step_s: f64,
        master: &MasterCommand,
        slave: &SlaveCommand,
    ) {
        let options = self.options;
        let time_s = tick_s + within_s;
        let grip = options.operator.grip(time_s);
        let intended = options.operator.intention.position(time_s);
        let at = (self.master.position_m, self.master.speed_mps);
        let hand_n = options.operator.force_n(&grip, intended, at.0, at.1);
        let device = &options.master;
        device.advance(
            &mut self.master,
            -master.force_n,
            hand_n,
            grip.mass_kg,
            step_s,
        );
        self.forces.hand_n = hand_n - grip.mass_kg * self.master.acceleration_mps2;
        let drive_n = self.drive_n(slave, within_s);
        let contact_n = self.forces.contact_n;
        options
            .slave
            .advance(&mut self.slave, drive_n, -contact_n, 0.0, step_s);
        let moved = Motion {
            time_s: time_s + step_s,
            position_m: self.slave.position_m,
            speed_mps: self.slave.speed_mps,
            acceleration_mps2: self.slave.acceleration_mps2,
        };
        let reading = self.contact.step(moved, step_s);
        self.forces.contact_n = reading.touch.force_n;
        self.forces.read_n = reading.force_n;
        self.material_j += reading.touch.force_n * self.slave.speed_mps * step_s;
    }

    /// What the slave's drive is told (N).
    fn drive_n(&self, command: &SlaveCommand, within_s: f64) -> f64 {
        let servo = &self.options.servo;
        let own = (servo.stiffness_n_per_m, servo.damping_ns_per_m);
        let (stiffness, damping) = command.compliance.unwrap_or(own);
        let wanted_m = command.position_m + command.speed_mps * within_s;
        let pulls_n = stiffness * (wanted_m - self.slave.position_m)
            + damping * (command.speed_mps - self.slave.speed_mps);
        // A guard limits the push into the material; out of it the slave has its whole force.
        (pulls_n + command.forward_n).min(command.force_limit_n)
    }

    fn row(&self, time_s: f64, master: &MasterCommand) -> Row {
        let reflecting = self.scheme.reflecting().unwrap_or_default();
        let hand_j = self.master.outer_j;
        Row {
            time_s,
            master_m: self.master.position_m,
            master_mps: self.master.speed_mps,
            felt_n: -self.master.actuator_n,
            command_n: master.force_n,
            hand_n: self.forces.hand_n,
            slave_m: self.slave.position_m,
            slave_mps: self.slave.speed_mps,
            contact_n: self.forces.contact_n,
            true_n: self.true_n,
            hand_j,
            felt_j: -self.master.actuator_j,
            lost_j: self.master.lost_j,
            material_j: self.material_j,
            slave_j: self.slave.actuator_j,
            slave_lost_j: self.slave.lost_j,
            exchanged_j: reflecting.exchanged_j,
            limits: reflecting.rendered.limits,
            heard: self.heard(&reflecting),
            identified: reflecting.estimate.as_ref().map(parameters),
            hand: reflecting.hand.map(hand),
            guarded: reflecting.guarded,
            faults: reflecting.rendered.faults.bits(),
            refused: reflecting.refused,
        }
    }

    /// Whether what the master renders was converged, and identified after the last change.
    fn heard(&self, reflecting: &Reflecting) -> bool {
        let Some(packet) = &reflecting.heard else {
            return false;
        };
        let known = self
            .known_us
            .is_some_and(|known_us| packet.time_us > known_us);
        let faded = reflecting.rendered.has(Limit::Fading);
        // A law that does not explain the force has its parameters all the same, and they are rendered.
        let has_ended = matches!(packet.status, Status::Converged | Status::ModelSuspect);
        has_ended && known && !faded
    }
}

/// Stiffness, damping and exponent with their standard errors, where the law has them.
fn parameters(estimate: &Estimate<f32>) -> Parameters {
    let mut found = [None; 3];
    for (slot, info) in estimate.parameters.iter().zip(estimate.law.parameters()) {
        let place = match info.name {
            "stiffness" => 0,
            "damping" => 1,
            "exponent" => 2,
            _ => continue,
        };
        found[place] = slot.map(|known| (f64::from(known.value), f64::from(known.std_error)));
    }
    found
}

fn hand(of: HandEstimate) -> Parameters {
    [
        Some(of.stiffness_n_per_m),
        Some(of.damping_ns_per_m),
        Some(of.mass_kg),
    ]
}

/// The newest message that has arrived.
fn newest(channel: &mut Channel<Message>, now_s: f64) -> Option<Message> {
    let mut last = None;
    while let Some(message) = channel.receive(now_s) {
        last = Some(message);
    }
    last
}

fn send(channel: &mut Channel<Message>, now_s: f64, message: Option<Message>) {
    if let Some(message) = message {
        channel.send(now_s, message, message.bytes());
    }
}
