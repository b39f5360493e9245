//! What a run of the simulated system is made of.

use super::channel::ChannelConfig;
use super::device::Device;
use super::environment::{Environment, Material};
use super::hand::Excitation;
use super::operator::{Operator, Task};
use super::scheme::four_channel::FourChannel;
use super::scheme::passivity::Passivity;
use super::scheme::position_force::PositionForce;
use super::scheme::position_position::{Coupling, PositionPosition};
use super::scheme::reflection::{Reflection, ReflectionOptions};
use super::scheme::shape::Shape;
use super::scheme::wave_variables::{WaveVariables, Waves};
use super::scheme::{Scheme, Servo};
use crate::motion::{Motion, Segment};
use crate::plant::Sensors;

/// A scheme by its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SchemeId {
    /// A spring between master and slave.
    PositionPosition,
    /// The slave follows, the master feels the slave's load cell.
    PositionForce,
    /// Position and force both ways.
    FourChannel,
    /// Wave variables.
    WaveVariables,
    /// Position–force with time-domain passivity.
    Passivity,
    /// Reflection of the environment's impedance.
    Reflection,
    /// Reflection of both sides' impedances.
    ReflectionBoth,
    /// Reflection of a changed impedance.
    ReflectionShaped,
}

impl SchemeId {
    /// All schemes, the oldest first.
    pub const ALL: [SchemeId; 8] = [
        SchemeId::PositionPosition,
        SchemeId::PositionForce,
        SchemeId::FourChannel,
        SchemeId::WaveVariables,
        SchemeId::Passivity,
        SchemeId::Reflection,
        SchemeId::ReflectionBoth,
        SchemeId::ReflectionShaped,
    ];

    /// The name in files and on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            SchemeId::PositionPosition => "position_position",
            SchemeId::PositionForce => "position_force",
            SchemeId::FourChannel => "four_channel",
            SchemeId::WaveVariables => "wave_variables",
            SchemeId::Passivity => "passivity",
            SchemeId::Reflection => "reflection",
            SchemeId::ReflectionBoth => "reflection_both",
            SchemeId::ReflectionShaped => "reflection_shaped",
        }
    }

    /// The scheme with a name.
    pub fn from_name(name: &str) -> Option<SchemeId> {
        SchemeId::ALL.into_iter().find(|id| id.name() == name)
    }

    /// Whether it reflects impedances.
    pub const fn reflects(self) -> bool {
        matches!(
            self,
            SchemeId::Reflection | SchemeId::ReflectionBoth | SchemeId::ReflectionShaped
        )
    }
}

/// Everything but the seed.
#[derive(Clone, Debug)]
pub struct Options {
    /// The scheme.
    pub scheme: SchemeId,
    /// The way from master to slave, and back.
    pub channels: [ChannelConfig; 2],
    /// How far the slave's clock is ahead of the master's (µs).
    pub clock_offset_us: u64,
    /// Who moves the master.
    pub operator: Operator,
    /// What the operator does, unless a motion of its own says it.
    pub task: Option<Task>,
    /// What the slave touches.
    pub environment: Environment,
    /// The master.
    pub master: Device,
    /// The slave.
    pub slave: Device,
    /// The slave's servo.
    pub servo: Servo,
    /// Load cells and encoders of both; `None`: what they say is the truth.
    pub sensors: Option<Sensors>,
    /// Ticks a second of the schemes.
    pub rate_hz: f64,
    /// Steps of the integration per tick.
    pub substeps: u32,
    /// The spring of the schemes that have one.
    pub coupling: Coupling,
    /// How waves are made.
    pub waves: Waves,
    /// How impedances are reflected.
    pub reflection: ReflectionOptions,
}

/// Load cells of ±50 N and 20 mN of noise, in the steps of 12 bits whose 32 conversions are summed; encoders
/// of 1 µm.
const SENSORS: Sensors = Sensors {
    force_noise_n: 0.02,
    force_step_n: 0.0,
    force_min_n: 0.0,
    position_step_m: 1e-6,
    rate_hz: 1000.0,
};

impl Default for Options {
    fn default() -> Self {
        Options {
            scheme: SchemeId::Reflection,
            channels: [ChannelConfig::default(); 2],
            clock_offset_us: 0,
            operator: Operator::default(),
            task: Some(Task::default()),
            environment: Environment::changing(Material::gel(), Material::plastic()),
            master: Device::MASTER,
            slave: Device::SLAVE,
            // 60 Hz on half a kilogram, ζ = 0.7.
            servo: Servo {
                stiffness_n_per_m: 71e3,
                damping_ns_per_m: 264.0,
            },
            sensors: Some(SENSORS),
            rate_hz: 1000.0,
            substeps: 20,
            coupling: Coupling::default(),
            waves: Waves::default(),
            reflection: ReflectionOptions::default(),
        }
    }
}

/// What the shaped scheme of the comparison does, if nothing else is said: seven tenths of the impedance.
const SHAPED_GAIN: f64 = 0.7;
/// The known force of the two-sided scheme (N).
const EXCITATION_N: f64 = 0.3;

impl Options {
    /// The same with a scheme, and with what belongs to it where nothing else is said.
    #[must_use]
    pub fn with_scheme(mut self, scheme: SchemeId) -> Options {
        self.scheme = scheme;
        self
    }

    /// The same with a delay each way (s), its jitter and the loss as shares.
    #[must_use]
    pub fn with_channel(mut self, delay_s: f64, jitter: f64, loss: f64) -> Options {
        for channel in &mut self.channels {
            (channel.delay_s, channel.jitter, channel.loss) = (delay_s, jitter, loss);
        }
        self
    }

    /// The round trip (s).
    pub fn round_trip_s(&self) -> f64 {
        self.channels[0].delay_s + self.channels[1].delay_s
    }

    /// The same with another round trip (s), of which each way has the share that it had.
    #[must_use]
    pub fn with_round_trip(mut self, round_trip_s: f64) -> Options {
        let own_s = self.round_trip_s();
        for channel in &mut self.channels {
            let share = if own_s > 0.0 {
                channel.delay_s / own_s
            } else {
                0.5
            };
            channel.delay_s = share * round_trip_s;
        }
        self
    }

    /// The same with a task that is as much longer as the round trip asks for, and with the material
    /// changing when it says, or when its hand has slid off.
    #[must_use]
    pub fn with_task_for_delay(mut self) -> Options {
        let round_trip_s = self.round_trip_s();
        if let Some(task) = self.task {
            let task = task.with_round_trip(round_trip_s);
            self.environment.change_s = task.changes_s.unwrap_or(task.slides_off_s());
            self.environment.while_touching = task.changes_s.is_some();
            self.operator.intention = task.motion();
        }
        self
    }

    /// The same with a press at the end that lasts so much longer (s).
    #[must_use]
    pub fn with_longer_press(&self, seconds: f64) -> Options {
        let mut options = self.clone();
        let hold = Motion::new(0.0, vec![Segment::Hold { seconds }]);
        let hold = hold.expect("a hold is a motion");
        options.operator.intention = options.operator.intention.then(&hold);
        options
    }

    /// How long a run lasts (s).
    pub fn duration_s(&self) -> f64 {
        self.operator.intention.duration_s()
    }

    /// Time between two ticks (s).
    pub fn period_s(&self) -> f64 {
        1.0 / self.rate_hz
    }

    /// The factors that the shaped scheme puts on the impedances of the first and the second material; 1 for the
    /// others.
    pub fn shaping(&self) -> [f64; 2] {
        let shape = self.reflection_options().shape;
        let Environment { first, second, .. } = &self.environment;
        [first, second.as_ref().unwrap_or(first)]
            .map(|material| shape.factor(material.secant_n_per_m()))
    }

    /// The scheme, at its start.
    pub fn make(&self) -> Box<dyn Scheme> {
        match self.scheme {
            SchemeId::PositionPosition => Box::new(PositionPosition::new(self.coupling)),
            SchemeId::PositionForce => Box::new(PositionForce::default()),
            SchemeId::FourChannel => Box::new(FourChannel::new(self.coupling)),
            SchemeId::WaveVariables => Box::new(WaveVariables::new(self.waves, self.servo)),
            SchemeId::Passivity => Box::new(Passivity::default()),
            SchemeId::Reflection | SchemeId::ReflectionBoth | SchemeId::ReflectionShaped => {
                Box::new(Reflection::new(self.reflection_options()))
            }
        }
    }

    /// What the scheme makes of the options: the plain one shapes nothing, the shaped one something.
    fn reflection_options(&self) -> ReflectionOptions {
        let mut options = self.reflection;
        options.rendering.device_ns_per_m = self.master.damping_ns_per_m.max(1e-3);
        options.both = self.scheme == SchemeId::ReflectionBoth;
        match self.scheme {
            SchemeId::ReflectionShaped if options.shape == Shape::default() => {
                options.shape.gain = SHAPED_GAIN;
            }
            SchemeId::ReflectionShaped => {}
            _ => options.shape = Shape::default(),
        }
        if options.both && options.excitation.is_none() && !options.excites {
            options.excitation = Some(Excitation {
                force_n: EXCITATION_N,
            });
        }
        options
    }
}
