//! The sampling task: it runs the core's tick on the board's sensors, force output and queues, and nothing
//! else. The link proof shows that it is free of panics, the reading of the sensors included.

use crate::board::{Acquired, Board, ForceOutput, Selected, Sensors};
use crate::crash;
use crate::force::Force;
use estimator_core::board::budget::{Sampled, Started};
use estimator_core::board::history::Stage;
use estimator_core::board::link::Change;
use estimator_core::board::reflection::Packet;
use estimator_core::board::sampling::{Ports, QUEUE, Record, Sampler};
use heapless::spsc::{Consumer, Producer};

/// Length of the ring of settings that wait to be taken over: one waits, and one place stays free.
pub const CHANGES: usize = 2;
/// Length of the ring of impedances that wait to be rendered. At most a thousand come in a second, and one
/// is taken at every tick.
pub const PACKETS: usize = 4;

/// The force output of the selected board.
pub type Output = Force<<Selected as Board>::Output>;

/// Everything that the sampling task owns.
pub struct Sampling {
    /// The sensors are read at every tick.
    pub sensors: <Selected as Board>::Sensors,
    /// The sampler makes estimates of readings. It stays where it was made, since it has 10 KiB.
    pub sampler: &'static mut Sampler,
    /// Records go to the telemetry task, through a ring of [`QUEUE`].
    pub outbox: Producer<'static, Record>,
    /// Settings come from the telemetry task, through a ring of [`CHANGES`].
    pub changes: Consumer<'static, Change>,
    /// Impedances to render come from the telemetry task, through a ring of [`PACKETS`].
    pub packets: Consumer<'static, Packet>,
}

/// The outcome of a tick.
pub enum Tick {
    /// A sample went through.
    Sampled(Sampled),
    /// The call was spurious.
    Nothing,
    /// The recording is used up; only the emulator has one.
    End,
}

/// The surroundings of a tick on the selected board.
struct BoardPorts<'a> {
    output: &'a mut Output,
    outbox: &'a mut Producer<'static, Record>,
    packets: &'a mut Consumer<'static, Packet>,
}

/// A ring knows its length only at run time and divides by it. The comparison with the capacity before
/// shows the compiler that it does not divide by zero, which would be a panic.
impl Ports for BoardPorts<'_> {
    const FULL: u16 = <Selected as Board>::Output::FULL;
    const COUNTS: u32 = <Selected as Board>::Sensors::COUNTS;

    fn now(&self) -> u32 {
        Selected::now()
    }

    fn packet(&mut self) -> Option<Packet> {
        crash::mark(Stage::Render);
        if self.packets.capacity() != PACKETS - 1 {
            return None;
        }
        self.packets.dequeue()
    }

    fn put(&mut self, code: u16, rest: u16) {
        self.output.put(code, rest);
        crash::mark(Stage::Estimate);
    }

    fn rested(&mut self) -> bool {
        self.output.rested()
    }

    fn queue(&mut self, record: Record) -> bool {
        self.outbox.capacity() == QUEUE - 1 && self.outbox.enqueue(record).is_ok()
    }
}

impl Sampling {
    /// Takes one instant from the sensors to the queue.
    pub fn tick(&mut self, output: &mut Output) -> Tick {
        let start = Selected::now();
        let (reading, due) = match self.sensors.sample() {
            Acquired::Reading(reading, due) => (reading, due),
            Acquired::Nothing => return Tick::Nothing,
            Acquired::End => return Tick::End,
        };
        let mut ports = BoardPorts {
            output,
            outbox: &mut self.outbox,
            packets: &mut self.packets,
        };
        let started = Started { due, start };
        Tick::Sampled(self.sampler.tick(started, reading, &mut ports))
    }

    /// Takes over other settings if some have come, and returns whether they have. This runs after the sample and
    /// after the last reading of the stopwatch, because a change is rare.
    pub fn change(&mut self) -> bool {
        if self.changes.capacity() == CHANGES - 1
            && let Some(change) = self.changes.dequeue()
        {
            self.sampler.apply(&change);
            return true;
        }
        false
    }
}
