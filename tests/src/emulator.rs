//! Runs a firmware in QEMU: samples in, log lines and telemetry out.

use estimator_core::Sample;
use estimator_core::board::frame::{Decoder, Frame, MAX_ENCODED, encode};
use std::io::{BufRead, BufReader, Write};
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

    /// What a board's image logs, up to a line with `last`. It logs into its memory, where a debug probe
    /// finds it (RTT); here the emulator's monitor is the probe.
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

    /// Complete lines of a log, from its bytes.
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

    /// `shift=0`: an instruction is a nanosecond; `sleep=off`: and nothing else is, so that every
    /// run takes the same path to the instruction.
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

/// Where the RAM begins.
const RAM: usize = 0x2000_0000;

/// The bytes that a program has logged by RTT, which nobody has fetched: its control block has a name,
/// two counts, and for the first channel name, memory, size, and how far it is written.
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
    pub render: Meter,
    /// Of what the rig adds, taken off.
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
            render: meter(field(line, "render")?)?,
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
