//! A board on the bench: machine, host and probe together, in steps of a millisecond.

use crate::chip::{Drive, MILLISECOND, Part, UNITS_PER_SECOND};
use crate::elf::Image;
use crate::host::{Host, Received};
use crate::machine::Machine;
use crate::probe::Probe;
use crate::world::World;
use estimator_core::Estimate;
use estimator_core::board::frame::Frame;
use estimator_core::board::link::{Answer, Command, Health, Refusal};
use estimator_core::board::settings::Key;
use std::env;
use std::path::PathBuf;
use std::sync::{Arc, LazyLock};

static ANALOG: LazyLock<Arc<Image>> = LazyLock::new(|| Arc::new(image("PALPATE_F405_ELF")));
static SPI: LazyLock<Arc<Image>> = LazyLock::new(|| Arc::new(image("PALPATE_F405_SPI_ELF")));

/// The image with the reference wiring.
pub fn analog() -> Arc<Image> {
    ANALOG.clone()
}

/// The image with the second set of sensors.
pub fn spi() -> Arc<Image> {
    SPI.clone()
}

fn image(variable: &str) -> Image {
    let path = env::var_os(variable).map(PathBuf::from);
    let path = path.unwrap_or_else(|| panic!("{variable} is not set: run `cargo xtask test`"));
    Image::read(&path).unwrap_or_else(|error| panic!("{error}"))
}

/// A board with everything that is connected to it.
pub struct Bench {
    /// The image that it runs.
    pub image: Arc<Image>,
    /// The board.
    pub machine: Machine,
    /// The host on its serial line.
    pub host: Host,
    /// The debug probe.
    pub probe: Probe,
    /// Whether the probe reads the log.
    pub probe_reads: bool,
}

impl Bench {
    /// A board that has just been switched on.
    pub fn new(image: Arc<Image>, part: Part, world: Box<dyn World>) -> Self {
        let machine = Machine::new(&image, part, world);
        let probe = Probe::new(&image);
        Bench {
            image,
            machine,
            host: Host::default(),
            probe,
            probe_reads: true,
        }
    }

    /// Goes on for some time (s); host and probe look every millisecond.
    pub fn run(&mut self, seconds: f64) {
        let until = self.machine.chip.now + (seconds * UNITS_PER_SECOND as f64) as u64;
        while self.machine.chip.now < until {
            let step = until.min(self.machine.chip.now + MILLISECOND);
            self.machine.run_until(step);
            self.host.listen(&mut self.machine);
            if self.probe_reads {
                self.probe.read(&mut self.machine);
            }
        }
    }

    /// Sends a command and waits for the answer, up to some time (s): the answer, and how long it took (s).
    pub fn ask(&mut self, command: Command, patience_s: f64) -> Option<(Answer, f64)> {
        let (from, start) = (self.host.frames.len(), self.machine.chip.seconds());
        let to = self.host.send(&mut self.machine, command);
        while self.machine.chip.seconds() < start + patience_s {
            self.run(1e-3);
            let answer = self.host.frames[from..]
                .iter()
                .find_map(|r| match &r.frame {
                    Frame::Reply(reply) if reply.to == to => {
                        Some((reply.answer, r.seconds() - start))
                    }
                    _ => None,
                });
            if answer.is_some() {
                return answer;
            }
        }
        None
    }

    /// The estimates that came, with their times of arrival (s).
    pub fn estimates(&self) -> impl DoubleEndedIterator<Item = (f64, &Estimate<f32>)> {
        self.host.frames.iter().filter_map(|r| match &r.frame {
            Frame::Estimate(estimate) => Some((r.seconds(), estimate)),
            _ => None,
        })
    }

    /// The states of health that came.
    pub fn healths(&self) -> impl DoubleEndedIterator<Item = &Health> {
        self.host.frames.iter().filter_map(|r| match &r.frame {
            Frame::Health(health) => Some(health),
            _ => None,
        })
    }

    /// Frames that are missing between others, by their sequence numbers.
    pub fn lost(&self) -> u64 {
        let pairs = self.host.frames.windows(2);
        let gap = |pair: &[Received]| {
            // The parts of a record have one number.
            let apart = pair[1].sequence.wrapping_sub(pair[0].sequence);
            u64::from(apart.saturating_sub(1))
        };
        pairs.map(gap).sum()
    }

    /// Arms the force output, where the firmware has that.
    pub fn arm(&mut self) {
        let answer = self.ask(Command::Arm, 1.0);
        assert!(matches!(answer, Some((Answer::Done, _))), "{answer:?}");
    }

    /// Sets settings; each has to be accepted.
    pub fn set(&mut self, settings: &[(Key, f32)]) {
        for (key, value) in settings {
            for _ in 0..50 {
                match self.ask(Command::Set(key.id(), *value), 1.0) {
                    Some((Answer::Value(..), _)) => break,
                    // The last change is still on its way.
                    Some((Answer::Refused(Refusal::Busy, _), _)) => self.run(1e-3),
                    other => panic!("{key:?} = {value}: {other:?}"),
                }
            }
        }
    }

    /// The lag of each record (s): from the sampling of its last instant to the arrival of its codes. The time
    /// of the first tick has to be known: `trace.followed` names its exception.
    pub fn lags(&self) -> Vec<(f64, f64)> {
        let Some(first_tick) = self.machine.chip.trace.entries.first() else {
            return Vec::new();
        };
        let first_tick = *first_tick as f64 / UNITS_PER_SECOND as f64;
        let codes = self.host.frames.iter().filter_map(|r| match &r.frame {
            Frame::Codes(codes) => Some((r.seconds(), 1e-6 * codes.time_us as f64)),
            _ => None,
        });
        let mut start = None;
        codes
            .map(|(at, time)| {
                let start = *start.get_or_insert(time);
                (at, at - first_tick - (time - start))
            })
            .collect()
    }

    /// The times between a time and the last instant at which the output was not at rest after it (s): 0 if it
    /// rested all the time.
    pub fn time_to_rest(&self, from_s: f64, zero: f64) -> f64 {
        let drive = &self.machine.chip.trace.drive;
        let mut last = from_s;
        for (index, (_, what)) in drive.iter().enumerate() {
            let end = drive
                .get(index + 1)
                .map_or(self.machine.chip.now, |next| next.0);
            let end = end as f64 / UNITS_PER_SECOND as f64;
            if !what.is_rest(zero) {
                last = last.max(end);
            }
        }
        last - from_s
    }

    /// What drives the output now: the share of its full range, 0 where it floats.
    pub fn share(&self) -> f64 {
        match self.machine.chip.trace.drive.last() {
            Some((_, Drive::Share(share))) => *share,
            _ => 0.0,
        }
    }

    /// The log so far.
    pub fn log(&self) -> Vec<String> {
        self.probe.log(&self.image)
    }
}
