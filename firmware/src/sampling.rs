//! What happens at every tick, and nothing else: read, convert, render, compensate, step, push. The link
//! proof holds it free of panics, the reading of the board's sensors included.

use crate::board::{Acquired, Board, ForceOutput, RATE_HZ, Selected, Sensors};
use crate::force::Force;
use crate::telemetry::QUEUE;
use estimator_core::Sample;
use estimator_core::board::budget::{Budget, Stations};
use estimator_core::board::link::Change;
use estimator_core::board::reflection::Packet;
use estimator_core::board::sampling::{Record, Sampler};
use heapless::spsc::{Consumer, Producer};

const FULL: u16 = <Selected as Board>::Output::FULL;
const PERIOD_US: u64 = 1_000_000 / RATE_HZ as u64;

/// Settings that wait to be taken over, and one more.
pub const CHANGES: usize = 2;
/// Impedances that wait to be rendered, and one more: there are a thousand a second at most, and one is
/// taken at every tick.
pub const PACKETS: usize = 4;

/// Where the force goes.
pub type Output = Force<<Selected as Board>::Output>;

/// All that the sampling task owns.
pub struct Sampling {
    /// Read at every tick.
    pub sensors: <Selected as Board>::Sensors,
    /// From codes to estimates; where it was made, since it is 10 KiB.
    pub sampler: &'static mut Sampler,
    /// To the telemetry task: of a queue of [`QUEUE`].
    pub outbox: Producer<'static, Record>,
    /// From it: other settings, of a queue of [`CHANGES`].
    pub changes: Consumer<'static, Change>,
    /// From it: impedances to render, of a queue of [`PACKETS`].
    pub packets: Consumer<'static, Packet>,
}

/// What came of a tick.
pub enum Tick {
    /// A sample, and what it took.
    Sampled(Sampled),
    /// A spurious call.
    Nothing,
    /// The recording is used up: the emulator only.
    End,
}

/// A sample that went through, for the budget.
pub struct Sampled {
    at: Stations,
    sample: Sample<f32>,
    dropped: bool,
}

impl Sampling {
    /// One instant, from the hardware to the queue. What is rendered goes out as soon as the position is
    /// known: a force that is late costs stiffness that can be rendered stably.
    pub fn tick(&mut self, output: &mut Output) -> Tick {
        let start = Selected::now();
        let (codes, sample, acquired) = match self.sensors.sample() {
            Acquired::Codes(codes) => {
                let acquired = Selected::now();
                (Some(codes), self.sampler.convert(&codes), acquired)
            }
            Acquired::Sample(sample) => (None, sample, Selected::now()),
            Acquired::Nothing => return Tick::Nothing,
            Acquired::End => return Tick::End,
        };
        let converted = Selected::now();
        if self.packets.capacity() == PACKETS - 1
            && let Some(packet) = self.packets.dequeue()
        {
            self.sampler.take(&packet);
        }
        let (rendered, code) = self.sampler.render(&sample, FULL);
        output.put(code);
        let put_out = Selected::now();
        let contact = self.sampler.compensate(sample);
        let compensated = Selected::now();
        let estimate = self.sampler.step(contact);
        let stepped = Selected::now();
        let due = self.sampler.due(&estimate);
        let record = Record {
            codes,
            sample,
            estimate,
            rendered,
            due,
        };
        let dropped = due.any() && !self.queue(record);
        let at = Stations {
            start,
            acquired,
            converted,
            put_out,
            compensated,
            stepped,
            queued: Selected::now(),
        };
        Tick::Sampled(Sampled {
            at,
            sample,
            dropped,
        })
    }

    /// Takes over other settings, if there are any. After the sample, and after the stopwatch: a
    /// change comes once in a while.
    pub fn change(&mut self) {
        if self.changes.capacity() == CHANGES - 1
            && let Some(change) = self.changes.dequeue()
        {
            self.sampler.apply(&change);
        }
    }

    /// Whether there was room. Both ends of a queue know its length only while the program runs, and
    /// divide by it: asked for it first, they cannot divide by zero, which would be a panic.
    fn queue(&mut self, record: Record) -> bool {
        self.outbox.capacity() == QUEUE - 1 && self.outbox.enqueue(record).is_ok()
    }
}

impl Sampled {
    /// Counts it.
    pub fn count(&self, budget: &mut Budget) {
        let Sampled {
            at,
            sample,
            dropped,
        } = self;
        budget.sample(at, sample, *dropped, PERIOD_US, Selected::TICK);
    }
}
