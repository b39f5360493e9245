//! Ports: bytes to a board and from it.

use std::error::Error;
use std::fs::{File, OpenOptions};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::Path;
use std::sync::{Arc, Mutex};
use std::thread::sleep;
use std::time::{Duration, Instant};

use estimator_core::board::link::{BAUD, BYTES_PER_MS};
use serialport::SerialPort;

use super::{board::SimulatedBoard, world::World};
use crate::diagnostic::Diagnostic;

/// How long [`Port::read`] waits for bytes.
const WAIT: Duration = Duration::from_millis(20);

/// Bytes to and from a board.
pub trait Port {
    /// Takes the bytes that have come, and waits a little if there are none. It returns 0 if none came.
    ///
    /// # Errors
    /// The connection is lost.
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize>;

    /// Sends all bytes.
    ///
    /// # Errors
    /// The bytes cannot be sent.
    fn write(&mut self, bytes: &[u8]) -> io::Result<()>;
}

impl Port for Box<dyn Port> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        (**self).read(into)
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        (**self).write(bytes)
    }
}

/// The name of the port behind which a board is simulated.
pub const SIMULATED: &str = "simulated";

/// Opens the port that `--port` names: `simulated`, the working directory of the emulator, or a serial
/// port.
///
/// # Errors
/// A port that cannot be opened; the [`Diagnostic`] lists the serial ports that there are.
pub fn open(name: &str) -> Result<Box<dyn Port>, Box<dyn Error>> {
    if name == SIMULATED {
        let world = Arc::new(Mutex::new(World::default()));
        let board = SimulatedBoard::new(world, BYTES_PER_MS);
        return Ok(Box::new(Simulated::in_real_time(board)));
    }
    if Path::new(name).is_dir() {
        return Ok(Box::new(Files::open(Path::new(name))?));
    }
    Ok(Box::new(Serial::open(name)?))
}

/// A serial line.
pub struct Serial(Box<dyn SerialPort>);

impl Serial {
    /// Opens the serial port at [`BAUD`].
    ///
    /// # Errors
    /// The port does not exist, is in use, or is no serial port.
    pub fn open(name: &str) -> Result<Self, Diagnostic> {
        let opened = serialport::new(name, BAUD).timeout(WAIT).open();
        opened.map(Serial).map_err(|error| {
            let there = serialport::available_ports().unwrap_or_default();
            let names: Vec<&str> = there.iter().map(|port| port.port_name.as_str()).collect();
            let there = match names.is_empty() {
                true => "there is no serial port".to_string(),
                false => format!("the serial ports are {}", names.join(", ")),
            };
            Diagnostic::new(format!("cannot open the port: {error}"))
                .value(name)
                .note(there)
                .remedy(
                    "name a serial port, the emulator's working directory, or `simulated`; on Linux \
                     a user of serial ports is in the group dialout",
                )
        })
    }
}

impl Port for Serial {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        match self.0.read(into) {
            Err(error)
                if matches!(
                    error.kind(),
                    io::ErrorKind::TimedOut | io::ErrorKind::Interrupted
                ) =>
            {
                Ok(0)
            }
            read => read,
        }
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.0.write_all(bytes)?;
        self.0.flush()
    }
}

/// The working directory of the emulator. Its frames come in a file that grows; commands go into another
/// file.
#[derive(Debug)]
pub struct Files {
    telemetry: File,
    commands: File,
}

impl Files {
    /// Opens `telemetry.frames` and `commands.frames` in `directory`. Commands reach an emulator only if
    /// `commands.frames` existed when it was started.
    ///
    /// # Errors
    /// There is no `telemetry.frames`, or `commands.frames` cannot be opened.
    pub fn open(directory: &Path) -> Result<Self, Diagnostic> {
        let wrong = |name: &str, error: &io::Error| {
            Diagnostic::new(format!("cannot open the file: {error}"))
                .in_file(&directory.join(name))
                .remedy("name the directory in which QEMU runs the firmware, `target/qemu`")
        };
        let telemetry = File::open(directory.join("telemetry.frames"))
            .map_err(|error| wrong("telemetry.frames", &error))?;
        let mut options = OpenOptions::new();
        let commands = options
            .create(true)
            .append(true)
            .open(directory.join("commands.frames"))
            .map_err(|error| wrong("commands.frames", &error))?;
        Ok(Files {
            telemetry,
            commands,
        })
    }
}

impl Port for Files {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let count = self.telemetry.read(into)?;
        if count == 0 {
            // A new run has made the file anew: it is read from its start.
            if self.telemetry.metadata()?.len() < self.telemetry.stream_position()? {
                self.telemetry.seek(SeekFrom::Start(0))?;
            }
            sleep(Duration::from_millis(2));
        }
        Ok(count)
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.commands.write_all(bytes)
    }
}

/// The longest time that passes on a simulated board between two looks of its host.
const MOST_AT_ONCE_MS: u64 = 10;
/// The same of a board in real time, which makes up what it was late: two boards that are read in turn are looked at
/// every 10 ms at best. Not measured.
const MADE_UP_AT_ONCE_MS: u64 = 40;
/// How much a board in real time makes up at most: of a second unseen the rest is left out. It could be in contact then,
/// and refuse the next command. Not measured.
const MADE_UP_MS: u64 = 200;

/// A simulated board behind a line of its own speed.
pub struct Simulated {
    board: SimulatedBoard,
    /// The start and the milliseconds so far, if the board runs in real time; those of it that were left out count.
    clock: Option<(Instant, u64)>,
}

impl Simulated {
    /// A board that runs in real time, for people. On a machine that stops it for longer than 0.2 s it is late.
    pub fn in_real_time(board: SimulatedBoard) -> Self {
        let clock = Some((Instant::now(), 0));
        Simulated { board, clock }
    }

    /// A board that goes on by 10 ms at each read, for tests.
    pub fn at_once(board: SimulatedBoard) -> Self {
        Simulated { board, clock: None }
    }

    /// The board itself.
    pub fn board(&mut self) -> &mut SimulatedBoard {
        &mut self.board
    }

    fn due_ms(&mut self) -> u64 {
        let Some((start, so_far)) = &mut self.clock else {
            return MOST_AT_ONCE_MS;
        };
        sleep(Duration::from_millis(5));
        let now = start.elapsed().as_millis() as u64;
        *so_far = (*so_far).max(now.saturating_sub(MADE_UP_MS));
        let due = (now - *so_far).min(MADE_UP_AT_ONCE_MS);
        *so_far += due;
        due
    }
}

impl Port for Simulated {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        if self.board.waiting() == 0 {
            for _ in 0..self.due_ms() {
                self.board.tick();
            }
        }
        Ok(self.board.take(into))
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.board.receive(bytes);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A host that looks at its board every 15 ms, as a bridge between two boards does.
    #[test]
    fn a_simulated_board_keeps_up_with_a_host_that_looks_every_15_ms() {
        let world = Arc::new(Mutex::new(World::default()));
        let mut port = Simulated::in_real_time(SimulatedBoard::new(world, BYTES_PER_MS));
        let (start, mut passed_ms) = (Instant::now(), 0);
        while start.elapsed() < Duration::from_millis(600) {
            sleep(Duration::from_millis(10));
            passed_ms += port.due_ms();
        }
        let real_ms = start.elapsed().as_millis() as u64;
        assert!(
            passed_ms <= real_ms && passed_ms + 100 > real_ms,
            "{passed_ms} of {real_ms}"
        );
    }
}
