//! Runs a firmware in QEMU: samples in, log lines and telemetry out.

mod budget;
mod elf;
mod image;
mod live;

pub use budget::{Budget, Meter};
pub use elf::footprint;
pub use image::{FLASH_START, Image};
pub use live::{Live, wait_until};

use estimator_core::Sample;
use estimator_core::board::frame::{Decoder, Frame, MAX_ENCODED, encode};
use std::io::{BufRead, BufReader, Write};
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::Duration;
use std::{env, fs, thread};

/// A firmware that hangs is ended after this time; 100 000 samples take 6 s.
const LIMIT: Duration = Duration::from_secs(240);

/// What a run needs.
pub struct Emulator {
    /// `qemu-system-arm`.
    pub qemu: PathBuf,
    /// `defmt-lines`, which turns the log into text: tests/decoder.
    pub decoder: PathBuf,
    /// The image of the firmware.
    pub elf: PathBuf,
    /// The working directory, where the firmware reads and writes its files.
    pub directory: PathBuf,
}

/// What a run produced.
pub struct Run {
    /// The lines of the log: level, message.
    pub log: Vec<String>,
    /// The frames that the firmware sent, with their sequence numbers.
    pub frames: Vec<(u16, Frame)>,
}

impl Emulator {
    /// The emulator that `cargo xtask test` has set up, with a directory for this run that is called `name`.
    pub fn from_env(name: &str) -> Result<Self, String> {
        let directory = path_from_env("PALPATE_RUNS")?.join(name);
        fs::create_dir_all(&directory).map_err(|e| format!("{}: {e}", directory.display()))?;
        Ok(Emulator {
            qemu: path_from_env("PALPATE_QEMU")?,
            decoder: path_from_env("PALPATE_DECODER")?,
            elf: path_from_env("PALPATE_QEMU_ELF")?,
            directory,
        })
    }

    /// Runs the firmware over samples. Every line of the log also goes to `watch` as it comes.
    pub fn run(&self, samples: &[Sample<f32>], watch: impl FnMut(&str)) -> Result<Run, String> {
        let frames: Vec<Frame> = samples.iter().copied().map(Frame::Sample).collect();
        self.run_frames(&frames, watch)
    }

    /// Runs the firmware over recorded frames: samples or codes.
    pub fn run_frames(&self, frames: &[Frame], watch: impl FnMut(&str)) -> Result<Run, String> {
        let recording = self.directory.join("samples.frames");
        let telemetry = self.directory.join("telemetry.frames");
        fs::write(&recording, encoded(frames))
            .map_err(|e| format!("{}: {e}", recording.display()))?;
        let log = self.log_of_a_run(watch)?;
        let bytes = fs::read(&telemetry).map_err(|e| format!("{}: {e}", telemetry.display()))?;
        Ok(Run {
            log,
            frames: decoded(&bytes)?,
        })
    }

    /// The log of a board's image, up to a line with `last`. The image logs into its memory, where a debug
    /// probe finds it (RTT); here the emulator's monitor takes the place of the probe.
    pub fn log_in_memory(&self, last: &str) -> Result<Vec<String>, String> {
        const LOOKS: u32 = 100;
        let image = self.directory.join("memory");
        let _ = fs::remove_file(&image);
        let mut command = self.machine();
        command.args(["-monitor", "stdio"]);
        command.stdin(Stdio::piped()).stdout(Stdio::null());
        let mut qemu = command.spawn().map_err(|e| e.to_string())?;
        let mut monitor = qemu.stdin.take().ok_or("QEMU has no monitor")?;
        let mut log = Vec::new();
        for _ in 0..LOOKS {
            // The whole RAM, and time to write it.
            writeln!(monitor, "pmemsave {RAM:#x} 0x20000 \"memory\"").map_err(|e| e.to_string())?;
            thread::sleep(Duration::from_millis(100));
            let memory = fs::read(&image).unwrap_or_default();
            log = self.decode(logged(&memory).unwrap_or_default())?;
            if log.iter().any(|line| line.contains(last)) {
                break;
            }
        }
        let ended = qemu.kill().and_then(|()| qemu.wait());
        ended.map_err(|e| format!("cannot end QEMU: {e}"))?;
        Ok(log)
    }

    /// The complete lines of a log, from its bytes.
    fn decode(&self, bytes: &[u8]) -> Result<Vec<String>, String> {
        let file = self.directory.join("log");
        fs::write(&file, bytes).map_err(|e| format!("{}: {e}", file.display()))?;
        let decoded = Command::new(&self.decoder)
            .arg(&self.elf)
            .stdin(fs::File::open(&file).map_err(|e| e.to_string())?)
            .output()
            .map_err(|e| format!("{}: {e}", self.decoder.display()))?;
        let lines = String::from_utf8_lossy(&decoded.stdout);
        Ok(lines.lines().map(String::from).collect())
    }

    fn log_of_a_run(&self, mut watch: impl FnMut(&str)) -> Result<Vec<String>, String> {
        let mut qemu = self.start_qemu()?;
        let output = qemu.stdout.take().ok_or("QEMU has no output")?;
        let mut decoder = Command::new(&self.decoder)
            .arg(&self.elf)
            .stdin(output)
            .stdout(Stdio::piped())
            .spawn()
            .map_err(|e| format!("{}: {e}", self.decoder.display()))?;
        let lines = decoder.stdout.take().ok_or("the decoder has no output")?;
        let (done, wait) = channel();
        let guard = thread::spawn(move || end_after_limit(qemu, &wait));
        let mut log = Vec::new();
        for line in BufReader::new(lines).lines() {
            let line = line.map_err(|e| format!("log of the firmware: {e}"))?;
            watch(&line);
            log.push(line);
        }
        drop(done);
        let qemu = guard.join().map_err(|_| "watching QEMU failed")?;
        let decoded = decoder.wait().map_err(|e| e.to_string())?.success();
        let told = log.join("\n");
        qemu.map_err(|error| format!("{error}; the firmware said:\n{told}"))?;
        decoded
            .then_some(log)
            .ok_or_else(|| format!("log of another firmware; so far:\n{told}"))
    }

    /// QEMU with a clock that counts instructions. With `shift=0` an instruction takes a nanosecond, and with
    /// `sleep=off` nothing else takes time, so that every run is the same to the instruction.
    fn machine(&self) -> Command {
        let mut qemu = Command::new(&self.qemu);
        qemu.current_dir(&self.directory)
            .args(["-M", "netduinoplus2", "-display", "none"])
            .args(["-serial", "none"])
            .args(["-icount", "shift=0,sleep=off"])
            .arg("-kernel")
            .arg(&self.elf)
            .stdout(Stdio::piped());
        qemu
    }

    fn start_qemu(&self) -> Result<Child, String> {
        self.machine()
            .args(["-monitor", "none"])
            .args(["-semihosting-config", "enable=on,target=native"])
            .stdin(Stdio::null())
            .spawn()
            .map_err(|e| format!("{}: {e}", self.qemu.display()))
    }
}

/// The address of the RAM.
const RAM: usize = 0x2000_0000;

/// The bytes that a program has logged by RTT and that have not been fetched. Its control block holds a
/// name, two counts, and for the first channel its name, memory and size, and how far it is written.
fn logged(memory: &[u8]) -> Option<&[u8]> {
    const NAME: &[u8] = b"SEGGER RTT";
    let block = memory.windows(NAME.len()).position(|at| at == NAME)?;
    let word = |index: usize| {
        let bytes = memory.get(block + 4 * index..)?.first_chunk()?;
        Some(u32::from_le_bytes(*bytes) as usize)
    };
    let (start, written) = (word(7)?.checked_sub(RAM)?, word(9)?);
    memory.get(start..start + written)
}

/// Waits for QEMU, which ends with its firmware.
fn end_after_limit(mut qemu: Child, wait: &Receiver<()>) -> Result<(), String> {
    if wait.recv_timeout(LIMIT) == Err(RecvTimeoutError::Timeout) {
        qemu.kill().map_err(|e| format!("cannot end QEMU: {e}"))?;
        return Err(format!("QEMU did not end within {} s", LIMIT.as_secs()));
    }
    let status = qemu.wait().map_err(|e| e.to_string())?;
    status
        .success()
        .then_some(())
        .ok_or_else(|| format!("QEMU ended with {status}"))
}

fn path_from_env(name: &str) -> Result<PathBuf, String> {
    env::var_os(name)
        .map(PathBuf::from)
        .ok_or_else(|| format!("{name} is not set: run `cargo xtask test`, which sets it"))
}

/// The bytes of frames that are numbered from 0.
pub fn encoded(frames: &[Frame]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut out = [0; MAX_ENCODED];
    for (sequence, frame) in frames.iter().enumerate() {
        let length = encode(frame, sequence as u16, &mut out);
        bytes.extend_from_slice(&out[..length]);
    }
    bytes
}

/// The frames of a stream; a record comes as its parts, each with the record's number.
fn decoded(bytes: &[u8]) -> Result<Vec<(u16, Frame)>, String> {
    let mut decoder = Decoder::new();
    let mut frames = Vec::new();
    for frame in bytes.iter().filter_map(|byte| decoder.push(*byte)) {
        let (sequence, frame) = frame.map_err(|e| format!("telemetry: {e}"))?;
        frames.extend(frame.parts().map(|part| (sequence, part)));
    }
    Ok(frames)
}
