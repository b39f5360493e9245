//! Runs a firmware in QEMU: samples in, log lines and telemetry out.

use estimator_core::Sample;
use estimator_core::frame::{Decoder, Frame, MAX_ENCODED, encode};
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::Duration;
use std::{env, fs, thread};

/// 100 000 samples take 6 s; a firmware that hangs is ended after this.
const LIMIT: Duration = Duration::from_secs(240);

/// What a run needs.
pub struct Emulator {
    /// `qemu-system-arm`.
    pub qemu: PathBuf,
    /// `defmt-lines`, see tests/decoder.
    pub decoder: PathBuf,
    /// The firmware.
    pub elf: PathBuf,
    /// Working directory: the firmware reads and writes its files here.
    pub directory: PathBuf,
}

/// What a run gave.
pub struct Run {
    /// The log, a line each: level, message.
    pub log: Vec<String>,
    /// The frames that came back, with their sequence numbers.
    pub frames: Vec<(u16, Frame)>,
}

impl Emulator {
    /// The emulator that `cargo xtask test` has set up, with a directory of its own called `name`.
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

    /// Runs the firmware over the samples. Every log line also goes to `watch` as it comes.
    pub fn run(&self, samples: &[Sample<f32>], watch: impl FnMut(&str)) -> Result<Run, String> {
        let frames: Vec<Frame> = samples.iter().copied().map(Frame::Sample).collect();
        self.run_frames(&frames, watch)
    }

    /// The same over samples or codes.
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

    /// `shift=0`: an instruction is a nanosecond; `sleep=off`: and nothing else is, so that every
    /// run takes the same path to the instruction.
    fn start_qemu(&self) -> Result<Child, String> {
        Command::new(&self.qemu)
            .current_dir(&self.directory)
            .args(["-M", "netduinoplus2", "-display", "none"])
            .args(["-monitor", "none", "-serial", "none"])
            .args(["-icount", "shift=0,sleep=off"])
            .args(["-semihosting-config", "enable=on,target=native"])
            .arg("-kernel")
            .arg(&self.elf)
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .spawn()
            .map_err(|e| format!("{}: {e}", self.qemu.display()))
    }
}

/// Waits for QEMU, which ends when its firmware does.
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

/// Frames one after another, numbered from 0.
pub fn encoded(frames: &[Frame]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut out = [0; MAX_ENCODED];
    for (sequence, frame) in frames.iter().enumerate() {
        let length = encode(frame, sequence as u16, &mut out);
        bytes.extend_from_slice(&out[..length]);
    }
    bytes
}

fn decoded(bytes: &[u8]) -> Result<Vec<(u16, Frame)>, String> {
    let mut decoder = Decoder::new();
    bytes
        .iter()
        .filter_map(|byte| decoder.push(*byte))
        .map(|frame| frame.map_err(|e| format!("telemetry: {e}")))
        .collect()
}

/// The counters of a firmware's sampling task, from the line that it logs.
#[derive(Debug)]
pub struct Budget {
    /// Samples that went through `step`.
    pub samples: u64,
    /// Times that the task ran.
    pub ticks: u64,
    /// Records that found the queue full.
    pub dropped: u64,
    /// Times that the task took longer than a tick.
    pub overruns: u64,
    /// Instants that no sample was taken of.
    pub missed: u64,
    /// Bytes of stack that were never used.
    pub stack_free: u64,
    /// What a tick should take, in the board's unit.
    pub tick: u64,
    /// Between two starts of the task.
    pub period: Meter,
    /// From the codes to SI units.
    pub convert: Meter,
    /// What the rig adds is taken off.
    pub compensate: Meter,
    /// `step`.
    pub step: Meter,
    /// From the estimate to the queue.
    pub queue: Meter,
    /// The whole task.
    pub task: Meter,
    /// Encoding a record, at low priority.
    pub encode: Meter,
}

/// Smallest, mean and largest of a series.
#[derive(Debug)]
pub struct Meter {
    /// Smallest.
    pub min: u64,
    /// Mean, rounded down.
    pub mean: u64,
    /// Largest.
    pub max: u64,
}

impl Budget {
    /// From the last line of a log that has one.
    pub fn from_log(log: &[String]) -> Result<Self, String> {
        let line = log.iter().rfind(|line| line.contains("budget: "));
        let line = line.ok_or("the firmware logged no budget")?;
        Ok(Budget {
            samples: number(field(line, "samples")?)?,
            ticks: number(field(line, "ticks")?)?,
            dropped: number(field(line, "dropped")?)?,
            overruns: number(field(line, "overruns")?)?,
            missed: number(field(line, "missed")?)?,
            stack_free: number(field(line, "stack_free")?)?,
            tick: number(field(line, "tick")?)?,
            period: meter(field(line, "period")?)?,
            convert: meter(field(line, "convert")?)?,
            compensate: meter(field(line, "compensate")?)?,
            step: meter(field(line, "step")?)?,
            queue: meter(field(line, "queue")?)?,
            task: meter(field(line, "task")?)?,
            encode: meter(field(line, "encode")?)?,
        })
    }
}

fn field<'a>(line: &'a str, key: &str) -> Result<&'a str, String> {
    line.split_whitespace()
        .find_map(|word| word.strip_prefix(key)?.strip_prefix('='))
        .ok_or_else(|| format!("no {key} in `{line}`"))
}

fn number(text: &str) -> Result<u64, String> {
    text.parse().map_err(|e| format!("`{text}`: {e}"))
}

fn meter(text: &str) -> Result<Meter, String> {
    let numbers: Vec<u64> = text.split('/').map(number).collect::<Result<_, _>>()?;
    match numbers[..] {
        [min, mean, max] => Ok(Meter { min, mean, max }),
        _ => Err(format!("`{text}` is not min/mean/max")),
    }
}

/// Bytes of flash and of RAM (without stack) that an ELF for the board takes.
pub fn footprint(elf: &Path) -> Result<(u64, u64), String> {
    let bytes = fs::read(elf).map_err(|e| format!("{}: {e}", elf.display()))?;
    load_segments(&bytes).ok_or_else(|| format!("{}: not a 32-bit ELF", elf.display()))
}

/// Sums over the segments that are loaded: ELF32, little-endian.
fn load_segments(elf: &[u8]) -> Option<(u64, u64)> {
    let half = |at: usize| Some(u16::from_le_bytes(elf.get(at..at + 2)?.try_into().ok()?));
    let word = |at: usize| Some(u32::from_le_bytes(elf.get(at..at + 4)?.try_into().ok()?));
    if elf.get(..5)? != b"\x7fELF\x01" {
        return None;
    }
    let (table, size, count) = (word(28)?, half(42)?, half(44)?);
    let (mut flash, mut ram) = (0, 0);
    for index in 0..count {
        let header = table as usize + usize::from(index) * usize::from(size);
        const LOAD: u32 = 1;
        if word(header)? == LOAD {
            let (address, in_file, in_memory) =
                (word(header + 8)?, word(header + 16)?, word(header + 20)?);
            flash += u64::from(in_file);
            ram += u64::from(in_memory) * u64::from(address >= 0x2000_0000);
        }
    }
    Some((flash, ram))
}
