//! The sampling task of a board: one tick takes one instant from the sensors to the queue of records. The
//! firmware on the board and in the emulator, its link proof and the host's simulated board all run
//! [`Sampler::tick`].

use crate::board::{
    budget::Sampled, budget::StageTimes, budget::Started, frame::Frame, frame::Instant,
    link::Change, protection::Latch, reflection::Packet, reflection::Rendered,
    reflection::Renderer, reflection::Speed, sensing::Codes, sensing::Watch, settings::Setup,
};
use crate::estimate::{
    Estimate, compensation::Compensation, compensation::CompensationState, estimator::State,
    estimator::step, fault::Fault, fault::Faults, params::Params, sample::Sample, status::Status,
};

/// Samples per second of every board (Hz).
pub const RATE_HZ: u32 = 1000;
/// Time between two samples (µs).
pub const PERIOD_US: u64 = 1_000_000 / RATE_HZ as u64;
/// Length of the queue of records between the sampling task and the link: 64 ms. The firmware's ring of
/// this length holds one record less.
pub const QUEUE: usize = 64;
/// Code of the full force output on the reference wiring, a PWM of 32 kHz counted at 84 MHz. The emulator
/// and the host's simulated board imitate it.
pub const FULL: u16 = 2625;

/// A reading of the sensors at one instant.
#[derive(Clone, Copy, Debug)]
pub enum Reading {
    /// The sensors gave the codes of the converters.
    Codes(Codes),
    /// A recording gave a sample that is in SI units already; only the emulator has such readings.
    Sample(Sample<f32>),
}

/// The surroundings of a tick: the board's stopwatch, and where a tick takes from and gives to.
pub trait Ports {
    /// Code of the full force output; 0 is no output.
    const FULL: u16;
    /// Counts after which the encoder's counter begins again; 0: it never does.
    const COUNTS: u32 = 0;

    /// Reads the stopwatch.
    fn now(&self) -> u32;

    /// Takes an impedance to render that has come since the last tick.
    fn packet(&mut self) -> Option<Packet>;

    /// Puts a code of at most [`Ports::FULL`] out as the force; `rest` is the code of 0 N, for hardware that rests
    /// by itself when no other code comes.
    fn put(&mut self, code: u16, rest: u16);

    /// Returns whether the hardware has put the output to rest by itself since the last call, because no code
    /// came in time.
    fn rested(&mut self) -> bool {
        false
    }

    /// Queues a record for the link and returns whether there was room.
    fn queue(&mut self, record: Record) -> bool;
}

/// The record of one instant, which the sampling task hands to the link.
#[derive(Clone, Copy, Debug)]
pub struct Record {
    /// The codes of the converters; a recording in SI units has none.
    pub codes: Option<Codes>,
    /// The sample before the compensation: a recording of it can be replayed with other settings.
    pub sample: Sample<f32>,
    /// The estimate, with the stamp of the instant that it belongs to.
    pub estimate: Estimate<f32>,
    /// The rendered force at this instant; `None` while nothing is rendered.
    pub rendered: Option<Rendered>,
    /// The parts of the record that are to be sent.
    pub due: Due,
}

/// The parts of a record that are to be sent.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Due {
    /// Codes, sample, estimate and rendered force are to be sent.
    pub shown: bool,
    /// The impedance is to be sent to the other side, as the packet with this number.
    pub reflected: Option<u16>,
    /// The packet reports its parameters at this depth (m).
    reference_depth_m: f32,
}

impl Due {
    /// Returns whether anything is to be sent.
    pub fn any(&self) -> bool {
        self.shown || self.reflected.is_some()
    }
}

impl Record {
    /// Returns the packet for the other side, if one is due.
    pub fn packet(&self) -> Option<Packet> {
        let sequence = self.due.reflected?;
        let depth_m = self.due.reference_depth_m;
        Some(Packet::of(&self.estimate, depth_m, sequence))
    }

    /// Hands over the frames that are due, in the order in which they go out.
    pub fn for_each_frame(&self, mut send: impl FnMut(&Frame)) {
        if self.due.shown {
            self.for_each_shown(&mut send);
            if let Some(rendered) = self.rendered {
                send(&Frame::Rendered(rendered));
            }
        }
        if let Some(packet) = self.packet() {
            send(&Frame::Reflection(packet));
        }
    }

    /// Hands over codes, sample and estimate, in one frame where one has room for them.
    fn for_each_shown(&self, send: &mut impl FnMut(&Frame)) {
        if let Some(codes) = self.codes {
            // Made where it is sent from: a copy of its 300 bytes costs the board 200 instructions.
            let whole = Frame::Record(Instant {
                codes,
                sample: self.sample,
                estimate: self.estimate,
            });
            if matches!(&whole, Frame::Record(instant) if instant.fits()) {
                return send(&whole);
            }
            send(&Frame::Codes(codes));
        }
        send(&Frame::Sample(self.sample));
        send(&Frame::Estimate(self.estimate));
    }

    /// Returns the faults of the instant: those of estimate and rendering, and
    /// [`Fault::EstimatorSuspect`] while the law does not explain the force.
    pub fn faults(&self) -> Faults {
        let estimator = match self.estimate.status {
            Status::ModelSuspect => self.estimate.faults.with(Fault::EstimatorSuspect),
            _ => self.estimate.faults,
        };
        estimator | self.rendered.map_or(Faults::NONE, |of| of.faults)
    }
}

/// The state of the sampling task.
#[derive(Clone, Debug)]
pub struct Sampler {
    setup: Setup,
    watch: Watch,
    compensation: Option<CompensationState<f32>>,
    state: State<f32>,
    /// Samples since the last record that was due for the host.
    unshown: u16,
    renderer: Renderer,
    latch: Latch,
    speed: Speed,
    /// Samples since the last packet for the other side.
    unreflected: u16,
    /// Number of the last packet for the other side.
    packets: u16,
}

impl Sampler {
    /// Starts before the first sample. Never inlined: each copy costs 2 KiB of flash and 10 KiB of stack.
    #[inline(never)]
    pub fn new(setup: Setup) -> Self {
        Sampler {
            setup,
            watch: Watch::default(),
            compensation: setup.compensation.as_ref().map(Compensation::at_rest),
            state: State::new(&setup.params),
            unshown: 0,
            renderer: Renderer::new(),
            latch: Latch::default(),
            speed: Speed::default(),
            unreflected: 0,
            packets: 0,
        }
    }

    /// Takes one reading through all stages: convert, render, compensate, step, queue. `started`: the
    /// stopwatch when the instant was due and when the task started. The force goes out as soon as the position is known, because a
    /// force that is late lowers the stiffness that can be rendered stably.
    #[inline]
    pub fn tick<P: Ports>(&mut self, started: Started, reading: Reading, ports: &mut P) -> Sampled {
        let acquired = ports.now();
        let (codes, sample) = match reading {
            Reading::Codes(codes) => {
                let codes = self.doubt(codes, P::COUNTS);
                (Some(codes), self.convert(&codes))
            }
            Reading::Sample(sample) => (None, sample),
        };
        let converted = ports.now();
        if let Some(packet) = ports.packet() {
            self.take(&packet);
        }
        let rested = ports.rested();
        let (rendered, code) = self.render(&sample, rested, P::FULL);
        // Nothing is rendered: the code is that of 0 N.
        let rest = match rendered {
            None => code,
            Some(_) => self.setup.output.code(0.0, P::FULL),
        };
        ports.put(code, rest);
        let put_out = ports.now();
        let contact = self.compensate(sample);
        let compensated = ports.now();
        let estimate = self.step(contact);
        let stepped = ports.now();
        let due = self.due(&estimate);
        let phase = estimate.phase;
        let record = Record {
            codes,
            sample,
            estimate,
            rendered,
            due,
        };
        let dropped = due.any() && !ports.queue(record);
        let times = StageTimes {
            started,
            acquired,
            converted,
            put_out,
            compensated,
            stepped,
            queued: ports.now(),
        };
        Sampled {
            times,
            sample,
            dropped,
            armed: self.setup.arming != 0 && self.latch.faults() == Faults::NONE,
            latch: self.latch,
            phase,
        }
    }

    /// Takes over other settings. If a setting of the rendering changes, the force starts again from 0 N
    /// with the next packet.
    #[inline(never)]
    pub fn apply(&mut self, change: &Change) {
        let (before, after) = (&self.setup, &change.setup);
        if before.render != after.render || before.output != after.output {
            self.renderer = Renderer::new();
        }
        let latch = self.latch;
        match change.restart {
            true => *self = Sampler::new(change.setup),
            false => self.setup = change.setup,
        }
        self.latch = latch;
    }

    /// Takes an impedance to render, which [`crate::board::link::Responder`] has checked.
    pub fn take(&mut self, packet: &Packet) {
        if let Some(params) = &self.setup.render
            && self.setup.arming != 0
        {
            // An impedance that cannot be rendered changes nothing.
            let _ = self.renderer.take(params, packet);
        }
    }

    /// Renders the force at the position that was just read and returns it with its code, on a board whose
    /// full output has the code `full`. Without a setting for it, and while the output is not armed, the force
    /// is 0 N. `rested`: the hardware has put the output to rest, which latches as an overrun.
    #[inline(never)]
    pub fn render(
        &mut self,
        read: &Sample<f32>,
        rested: bool,
        full: u16,
    ) -> (Option<Rendered>, u16) {
        let faults = match rested {
            true => read.faults.with(Fault::Overrun),
            false => read.faults,
        };
        let admitted = self.latch.update(self.setup.arming, faults);
        let Some(params) = self.setup.render.as_ref().filter(|_| admitted) else {
            self.renderer = Renderer::new();
            self.speed = Speed::default();
            return (None, self.setup.output.code(0.0, full));
        };
        let lost = [Fault::PositionUnusable, Fault::PositionJump];
        let position_m = match lost.into_iter().any(|fault| read.faults.has(fault)) {
            true => f32::NAN,
            false => read.position_m,
        };
        if position_m.is_nan() {
            self.speed = Speed::default();
        }
        let speed_mps = self.speed.update(read.time_us, position_m);
        let rendered = self
            .renderer
            .step(params, position_m, speed_mps, read.time_us);
        let code = self.setup.output.code(rendered.force_n, full);
        (Some(rendered), code)
    }

    /// Marks a position that may be off by whole rounds of the encoder's counter, `counts` each: instants are missing
    /// before it.
    fn doubt(&self, mut codes: Codes, counts: u32) -> Codes {
        let conversion = &self.setup.conversion;
        if conversion.may_have_gone_round(&self.watch, codes.time_us, PERIOD_US, counts) {
            codes.faults = codes.faults.with(Fault::PositionJump);
        }
        codes
    }

    /// Converts codes to SI units and marks the faults that show in them.
    pub fn convert(&mut self, codes: &Codes) -> Sample<f32> {
        self.setup.conversion.sample(&mut self.watch, codes)
    }

    /// Takes the effects of the rig off a sample; without such effects in the settings it returns the
    /// sample unchanged.
    pub fn compensate(&mut self, read: Sample<f32>) -> Sample<f32> {
        let (Some(compensation), Some(state)) = (&self.setup.compensation, &mut self.compensation)
        else {
            return read;
        };
        self.state.observe_raw(read.position_m, read.force_n);
        isolated_compensation(compensation, state, read)
    }

    /// Runs the estimator's step on a sample from [`Sampler::compensate`]. The stamp of the estimate is
    /// that of the instant to which it belongs: older than the newest sample by the delays of the filter
    /// and of the compensation.
    pub fn step(&mut self, sample: Sample<f32>) -> Estimate<f32> {
        // Changed in place: a copy costs 300 instructions.
        let mut estimate = isolated_step(&self.setup.params, &mut self.state, sample);
        estimate.time_us = estimate.time_us.saturating_sub(self.setup.late_us);
        estimate
    }

    /// Decides what is sent of this instant. A record is due at every `telemetry.every`-th sample and at
    /// every event, an impedance for the other side at every `reflection.every`-th sample.
    pub fn due(&mut self, estimate: &Estimate<f32>) -> Due {
        let shown = is_due(&mut self.unshown, self.setup.every) || estimate.event.is_some();
        let every = self.setup.reflect_every;
        let reflects = every > 0 && is_due(&mut self.unreflected, every);
        if reflects {
            self.packets = self.packets.wrapping_add(1);
        }
        Due {
            shown,
            reflected: reflects.then_some(self.packets),
            reference_depth_m: self.setup.reference_depth_m,
        }
    }
}

/// Counts a sample and returns whether it is the last of `every`; the count then starts again.
fn is_due(count: &mut u16, every: u16) -> bool {
    *count = count.saturating_add(1);
    let due = *count >= every;
    if due {
        *count = 0;
    }
    due
}

/// Runs the compensation; never inlined, for the same reason as [`isolated_step`].
#[inline(never)]
fn isolated_compensation(
    compensation: &Compensation<f32>,
    state: &mut CompensationState<f32>,
    read: Sample<f32>,
) -> Sample<f32> {
    compensation.step(state, read)
}

/// Runs `step`; never inlined, because the compiler would move parts of it past the stopwatch.
#[inline(never)]
fn isolated_step(
    params: &Params<f32>,
    state: &mut State<f32>,
    sample: Sample<f32>,
) -> Estimate<f32> {
    step(params, state, sample)
}
