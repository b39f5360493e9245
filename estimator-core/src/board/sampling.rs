//! What happens to every instant on a board, and nothing else: convert, compensate, step, record. The
//! firmware's sampling task, its link proof and the host's simulated board are made of it.

use crate::board::link::Change;
use crate::board::reflection::{Packet, Rendered, Renderer, Speed};
use crate::board::sensing::{Codes, Watch};
use crate::board::settings::Setup;
use crate::estimate::Estimate;
use crate::estimate::compensation::{Compensation, CompensationState};
use crate::estimate::estimator::{State, step};
use crate::estimate::fault::Fault;
use crate::estimate::params::Params;
use crate::estimate::sample::Sample;

/// What the sampling task leaves behind at every tick.
#[derive(Clone, Copy, Debug)]
pub struct Record {
    /// What the converters said; `None` of a recording in SI units.
    pub codes: Option<Codes>,
    /// What was read, before anything was taken off: recorded, it can be replayed with other
    /// settings.
    pub sample: Sample<f32>,
    /// What came out, with the stamp of the instant that it belongs to.
    pub estimate: Estimate<f32>,
    /// What was put out at this instant; `None` while nothing is rendered.
    pub rendered: Option<Rendered>,
    /// What of it is to be sent.
    pub due: Due,
}

/// What is to be sent of an instant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Due {
    /// Codes, sample, estimate, and what was rendered.
    pub shown: bool,
    /// The impedance, for the other side: as the packet with this number.
    pub reflected: Option<u16>,
    /// Depth (m) that its parameters are reported at.
    reference_depth_m: f32,
}

impl Due {
    /// Whether there is anything.
    pub fn any(&self) -> bool {
        self.shown || self.reflected.is_some()
    }
}

impl Record {
    /// The packet for the other side, if one is due.
    pub fn packet(&self) -> Option<Packet> {
        let sequence = self.due.reflected?;
        let depth_m = self.due.reference_depth_m;
        Some(Packet::of(&self.estimate, depth_m, sequence))
    }
}

/// The sampling task's own state.
#[derive(Clone, Debug)]
pub struct Sampler {
    setup: Setup,
    watch: Watch,
    memory: Option<CompensationState<f32>>,
    state: State<f32>,
    count: u16,
    renderer: Renderer,
    speed: Speed,
    /// Samples since the last packet for the other side, and how many packets there were.
    unreflected: u16,
    packets: u16,
}

impl Sampler {
    /// Before the first sample. Never inlined: 2 KiB of flash each time, and 10 KiB of stack.
    #[inline(never)]
    pub fn new(setup: Setup) -> Self {
        Sampler {
            setup,
            watch: Watch::default(),
            memory: at_rest(&setup),
            state: State::new(&setup.params),
            count: 0,
            renderer: Renderer::new(),
            speed: Speed::default(),
            unreflected: 0,
            packets: 0,
        }
    }

    /// Takes over other settings. What is rendered starts anew if anything about it changes: from no
    /// force, with the next packet.
    #[inline(never)]
    pub fn apply(&mut self, change: &Change) {
        let (before, after) = (&self.setup, &change.setup);
        if before.render != after.render || before.output != after.output {
            self.renderer = Renderer::new();
        }
        match change.restart {
            true => *self = Sampler::new(change.setup),
            false => self.setup = change.setup,
        }
    }

    /// Takes an impedance to render, checked by [`crate::board::link::Responder`].
    pub fn take(&mut self, packet: &Packet) {
        if let Some(params) = &self.setup.render {
            // One that cannot be rendered leaves everything as it is.
            let _ = self.renderer.take(params, packet);
        }
    }

    /// What is put out at the position that was just read: the force, and the code for it on a board
    /// whose full output has the code `full`. Without a setting for it that is 0 N.
    #[inline(never)]
    pub fn render(&mut self, read: &Sample<f32>, full: u16) -> (Option<Rendered>, u16) {
        let Some(params) = &self.setup.render else {
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

    /// Codes in SI units, watched.
    pub fn convert(&mut self, codes: &Codes) -> Sample<f32> {
        self.setup.conversion.sample(&mut self.watch, codes)
    }

    /// The sample without what the rig adds; as it is if nothing is to be taken off.
    pub fn compensate(&mut self, read: Sample<f32>) -> Sample<f32> {
        let (Some(compensation), Some(memory)) = (&self.setup.compensation, &mut self.memory)
        else {
            return read;
        };
        self.state.observe_raw_force(read.force_n);
        isolated_compensation(compensation, memory, read)
    }

    /// The estimator's step, on what [`Sampler::compensate`] gave. The stamp of the estimate is that
    /// of the instant that it belongs to: the filter's delay, and the compensation's, before the
    /// newest sample.
    pub fn step(&mut self, sample: Sample<f32>) -> Estimate<f32> {
        // Changed where it is: a copy costs 300 instructions.
        let mut estimate = isolated_step(&self.setup.params, &mut self.state, sample);
        estimate.time_us = estimate.time_us.saturating_sub(self.setup.late_us);
        estimate
    }

    /// What is sent of this instant: every so many, and those in which something happens; and
    /// impedances for the other side, every so many.
    pub fn due(&mut self, estimate: &Estimate<f32>) -> Due {
        let shown = is_due(&mut self.count, self.setup.every) || estimate.event.is_some();
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

/// Counts, and starts anew at every so many.
fn is_due(count: &mut u16, every: u16) -> bool {
    *count = count.saturating_add(1);
    let due = *count >= every;
    if due {
        *count = 0;
    }
    due
}

fn at_rest(setup: &Setup) -> Option<CompensationState<f32>> {
    setup.compensation.as_ref().map(Compensation::at_rest)
}

/// The compensation, never inlined, for the same reason as the step.
#[inline(never)]
fn isolated_compensation(
    compensation: &Compensation<f32>,
    memory: &mut CompensationState<f32>,
    read: Sample<f32>,
) -> Sample<f32> {
    compensation.step(memory, read)
}

/// `step`, never inlined: the compiler would move parts of it past the stopwatch.
#[inline(never)]
fn isolated_step(
    params: &Params<f32>,
    state: &mut State<f32>,
    sample: Sample<f32>,
) -> Estimate<f32> {
    step(params, state, sample)
}
