//! A board at one end of the simulated system: the core's tick, as the firmware runs it.

use estimator_core::board::{
    budget::Started, link::Refusal, reflection::Packet, sampling::FULL, sampling::Ports,
    sampling::Reading, sampling::Record, sampling::Sampler, settings::Key, settings::Settings,
    settings::Setup,
};
use estimator_core::{Faults, Sample};

/// Packets a second that a board sends.
pub const PACKETS_HZ: f64 = 100.0;
/// The force of the full output (N).
const FULL_N: f32 = 30.0;

/// What a board renders with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rendering {
    /// The largest force (N).
    pub force_n: f64,
    /// The master's own damping (N s/m), which bounds what is rendered.
    pub device_ns_per_m: f64,
    /// Without a packet for so long the force fades out (s).
    pub timeout_s: f64,
    /// In which it fades out, and another impedance comes in (s).
    pub fade_s: f64,
    /// The factor on the impedance.
    pub shaping: f64,
}

impl Default for Rendering {
    /// A timeout of 0.5 s: with 30 % of jitter on 2.5 s, 20 % of loss and overtaken packets dropped, the
    /// gap between two packets at 100 Hz stays below it.
    fn default() -> Self {
        Rendering {
            force_n: 25.0,
            device_ns_per_m: super::device::Device::MASTER.damping_ns_per_m,
            timeout_s: 0.5,
            fade_s: 0.1,
            shaping: 1.0,
        }
    }
}

#[derive(Default)]
struct SimulatedPorts {
    packet: Option<Packet>,
    code: u16,
    record: Option<Record>,
}

impl Ports for SimulatedPorts {
    const FULL: u16 = FULL;

    fn now(&self) -> u32 {
        0
    }

    fn packet(&mut self) -> Option<Packet> {
        self.packet.take()
    }

    fn put(&mut self, code: u16, _rest: u16) {
        self.code = code;
    }

    fn queue(&mut self, record: Record) -> bool {
        self.record = Some(record);
        true
    }
}

/// The simulated task takes no time.
const AT_ONCE: Started = Started { due: 0, start: 0 };

/// A board without hardware and without a line: samples in, records and a force out.
pub struct Board {
    sampler: Sampler,
    ports: SimulatedPorts,
    last: Option<Packet>,
    /// Packets that were refused, for being overtaken or not renderable.
    pub refused: u64,
}

impl Board {
    /// A board that sends what it identifies.
    pub fn slave() -> Board {
        let every = 1000.0 / PACKETS_HZ;
        Board::with(&[(Key::ReflectionEvery, every as f32)])
    }

    /// A board that renders what it is told.
    pub fn master(rendering: &Rendering) -> Board {
        Board::with(&[
            (Key::RenderForceN, rendering.force_n as f32),
            (Key::RenderFullN, FULL_N),
            (Key::RenderDeviceNsPerM, rendering.device_ns_per_m as f32),
            (Key::RenderTimeoutS, rendering.timeout_s as f32),
            (Key::RenderFadeS, rendering.fade_s as f32),
            (Key::RenderShaping, rendering.shaping as f32),
        ])
    }

    fn with(changes: &[(Key, f32)]) -> Board {
        let mut settings = Settings::default();
        settings.put(Key::ForceCalibrated, 1.0);
        settings.put(Key::PositionCalibrated, 1.0);
        for (key, value) in changes {
            settings.put(*key, *value);
        }
        // Options are checked before: file.rs allows what the settings do.
        let setup = settings.setup().expect("settings within their bounds");
        Board {
            // Its operator has armed it.
            sampler: Sampler::new(Setup { arming: 1, ..setup }),
            ports: SimulatedPorts::default(),
            last: None,
            refused: 0,
        }
    }

    /// Takes a packet as the board's responder does.
    ///
    /// # Errors
    /// Why it is not rendered.
    pub fn take(&mut self, packet: Packet) -> Result<(), Refusal> {
        let overtaken = self.last.is_some_and(|last| packet.is_older_than(&last));
        let refusal = match packet.reflected() {
            _ if overtaken => Some(Refusal::Overtaken),
            Err(_) => Some(Refusal::NotRenderable),
            Ok(_) => None,
        };
        if let Some(refusal) = refusal {
            self.refused += 1;
            return Err(refusal);
        }
        self.last = Some(packet);
        self.ports.packet = Some(packet);
        Ok(())
    }

    /// One tick with a reading in SI units.
    pub fn tick(&mut self, time_us: u64, position_m: f64, force_n: f64) -> Record {
        let sample = Sample {
            time_us,
            position_m: position_m as f32,
            force_n: force_n as f32,
            faults: Faults::NONE,
        };
        self.sampler
            .tick(AT_ONCE, Reading::Sample(sample), &mut self.ports);
        // Every sample is shown: `telemetry.every` is 1.
        self.ports.record.take().expect("every sample is shown")
    }

    /// The force that is put out (N), in the steps of the output.
    pub fn force_n(&self) -> f64 {
        f64::from(self.ports.code) / f64::from(FULL) * f64::from(FULL_N)
    }
}
