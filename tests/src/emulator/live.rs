//! An emulator that waits for its samples: time outside goes along with its own.

use super::{Emulator, LIMIT, encoded};
use estimator_core::board::frame::{Decoder, Frame};
use std::fs::{self, File, OpenOptions};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

/// A firmware that runs as far as it has samples.
pub struct Live {
    qemu: Child,
    /// The writing end of a named pipe, where the firmware reads its samples. `None`: they have ended.
    samples: Option<File>,
    telemetry: File,
    decoder: Decoder,
    frames: Vec<(u16, Frame)>,
    pipe: PathBuf,
}

impl Emulator {
    /// Starts the firmware, which waits for samples.
    pub fn start(&self) -> Result<Live, String> {
        let file = |name: &str| self.directory.join(name);
        for name in ["samples.frames", "telemetry.frames"] {
            let _ = fs::remove_file(file(name));
        }
        // The firmware looks for commands only if the file is there when it starts.
        fs::write(file("commands.frames"), []).map_err(|e| e.to_string())?;
        let pipe = file("samples.frames");
        make_pipe(&pipe)?;
        // Opened for both, it waits for nobody.
        let samples = OpenOptions::new().read(true).write(true).open(&pipe);
        let samples = samples.map_err(|e| format!("{}: {e}", pipe.display()))?;
        let mut qemu = self.machine();
        qemu.args(["-monitor", "none"])
            .args(["-semihosting-config", "enable=on,target=native"])
            .stdin(Stdio::null())
            .stdout(Stdio::null());
        let qemu = qemu
            .spawn()
            .map_err(|e| format!("{}: {e}", self.qemu.display()))?;
        // Until it is there, what has started ends with the guard.
        let mut guard = Ended(Some(qemu));
        let telemetry = file("telemetry.frames");
        wait_until("the firmware starts", || telemetry.exists())?;
        let telemetry = File::open(&telemetry);
        Ok(Live {
            telemetry: telemetry.map_err(|e| e.to_string())?,
            qemu: guard.0.take().ok_or("QEMU has ended")?,
            samples: Some(samples),
            decoder: Decoder::new(),
            frames: Vec::new(),
            pipe,
        })
    }
}

fn make_pipe(path: &Path) -> Result<(), String> {
    let made = Command::new("mkfifo").arg(path).status();
    match made {
        Ok(status) if status.success() => Ok(()),
        other => Err(format!("mkfifo {}: {other:?}", path.display())),
    }
}

/// Waits until something is so.
pub fn wait_until(what: &str, mut is: impl FnMut() -> bool) -> Result<(), String> {
    let start = Instant::now();
    while !is() {
        if start.elapsed() > LIMIT {
            return Err(format!("waited {} s in vain until {what}", LIMIT.as_secs()));
        }
        thread::sleep(Duration::from_millis(1));
    }
    Ok(())
}

impl Live {
    /// Gives it more samples or codes.
    pub fn feed(&mut self, frames: &[Frame]) -> Result<(), String> {
        let pipe = self.samples.as_mut().ok_or("its samples have ended")?;
        pipe.write_all(&encoded(frames)).map_err(|e| e.to_string())
    }

    /// What it has sent so far: the parts of its frames, with their numbers.
    pub fn frames(&mut self) -> Result<&[(u16, Frame)], String> {
        let mut bytes = Vec::new();
        let read = self.telemetry.read_to_end(&mut bytes);
        read.map_err(|e| format!("telemetry: {e}"))?;
        for frame in bytes.iter().filter_map(|byte| self.decoder.push(*byte)) {
            let (sequence, frame) = frame.map_err(|e| format!("telemetry: {e}"))?;
            self.frames
                .extend(frame.parts().map(|part| (sequence, part)));
        }
        Ok(&self.frames)
    }

    /// Ends the samples, and with them the run; gives all that it has sent.
    pub fn finish(mut self) -> Result<Vec<(u16, Frame)>, String> {
        self.samples = None;
        let qemu = &mut self.qemu;
        let ended = || qemu.try_wait().is_ok_and(|status| status.is_some());
        wait_until("the firmware ends", ended)?;
        self.frames()?;
        Ok(std::mem::take(&mut self.frames))
    }
}

impl Drop for Live {
    fn drop(&mut self) {
        let _ = self.qemu.kill();
        let _ = self.qemu.wait();
        let _ = fs::remove_file(&self.pipe);
    }
}

/// A process that is ended if nobody takes it.
struct Ended(Option<Child>);

impl Drop for Ended {
    fn drop(&mut self) {
        if let Some(child) = &mut self.0 {
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}
