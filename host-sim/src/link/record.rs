//! Recordings: the bytes of a board go into a file as they come, and the file becomes a log.
//!
//! The bytes are appended unchanged and are brought to the disk once a second. After a crash or a power cut
//! all but the last second is on the disk, and `--convert` makes a log of it.

use std::error::Error;
use std::fs::{self, File};
use std::io::{self, BufReader, Read, Write};
use std::path::Path;
use std::time::{Duration, Instant};

use estimator_core::board::{frame::Decoder, frame::Frame, link::Health, sensing::Codes};
use estimator_core::estimate::Phase;
use estimator_core::{Estimate, Sample};

use super::device::{SILENCE, Statistics};
use super::{Device, Port, backup};
use crate::diagnostic::Diagnostic;
use crate::interrupt;
use crate::kind::Kind;
use crate::log::{ExtraColumn, FEWEST_SAMPLES, Log};
use crate::number::counted;
use crate::output::say;

const RECORDING: &str = "recording.frames";
const TO_DISK: Duration = Duration::from_secs(1);

/// Records until the board's own time has advanced by `length_us`, until it falls silent, or until the process is
/// interrupted.
///
/// # Errors
/// The folder has a recording already, the port or the disk fails, or no frame comes.
pub fn record<P: Port>(
    device: &mut Device<P>,
    folder: &Path,
    length_us: Option<u64>,
) -> Result<Statistics, Box<dyn Error>> {
    let recording = begin(device, folder)?;
    if let Some(note) = &recording.note {
        say(format!("{note}\n"))?;
    }
    let recorded = listen(device, &recording.file, length_us);
    recording.end(device)?;
    recorded?;
    Ok(device.statistics())
}

/// A recording that runs: every byte that comes goes into its file.
pub struct Recording {
    file: File,
    /// What is to be said of it.
    pub note: Option<String>,
}

impl Recording {
    /// Ends it, with all that has come on the disk.
    ///
    /// # Errors
    /// What the disk says.
    pub fn end<P: Port>(self, device: &mut Device<P>) -> io::Result<()> {
        device.tap(None);
        self.file.sync_all()
    }
}

/// Begins a recording in a folder, with the settings of the board beside it.
///
/// # Errors
/// The folder has a recording already, or the port or the disk fails.
pub fn begin<P: Port>(device: &mut Device<P>, folder: &Path) -> Result<Recording, Box<dyn Error>> {
    fs::create_dir_all(folder)?;
    let path = folder.join(RECORDING);
    if path.exists() {
        return Err(Diagnostic::new("the folder has a recording already")
            .in_file(&path)
            .remedy("name another folder with --out")
            .into());
    }
    let file = File::create_new(&path)?;
    let mut bytes = file.try_clone()?;
    // From here on every byte is kept, also those that come while the settings are read.
    device.tap(Some(Box::new(move |come| bytes.write_all(come))));
    match keep_settings(device, folder) {
        Ok(note) => Ok(Recording { file, note }),
        Err(error) => {
            device.tap(None);
            Err(error)
        }
    }
}

/// Listens until the time of the board has advanced by `length_us`, or until the board falls silent.
fn listen<P: Port>(
    device: &mut Device<P>,
    file: &File,
    length_us: Option<u64>,
) -> Result<(), Box<dyn Error>> {
    let (mut first, mut heard, mut kept) = (None, Instant::now(), Instant::now());
    while heard.elapsed() <= SILENCE && !interrupt::is_interrupted() {
        let frame = device.next_frame()?;
        if frame.is_some() {
            heard = Instant::now();
        }
        if let Some(Frame::Sample(sample)) = frame {
            let start = *first.get_or_insert(sample.time_us);
            let so_far = sample.time_us.saturating_sub(start);
            if length_us.is_some_and(|length| so_far >= length) {
                break;
            }
        }
        if kept.elapsed() >= TO_DISK {
            file.sync_data()?;
            kept = Instant::now();
        }
    }
    Ok(())
}

/// Writes the settings that the samples are taken with. A board that only sends is recorded without them.
fn keep_settings<P: Port>(
    device: &mut Device<P>,
    folder: &Path,
) -> Result<Option<String>, Box<dyn Error>> {
    match device.identity() {
        Ok(identity) => {
            let name = identity.board.to_string();
            let (settings, unknown) = device.known_settings()?;
            backup::write(&folder.join("settings.toml"), &settings, &unknown, &name)?;
            Ok(None)
        }
        Err(error) => Ok(Some(format!("recording without settings: {error}"))),
    }
}

/// An instant of a recording.
#[derive(Clone, Copy, Debug, Default)]
struct Row {
    codes: Option<Codes>,
    sample: Sample<f32>,
    innovation_n: Option<f32>,
}

/// The content of a recording.
#[derive(Debug, Default)]
struct Content {
    /// The runs. A board that was reset starts its time anew, and with it a run.
    runs: Vec<Vec<Row>>,
    codes: Option<Codes>,
    garbled: u64,
    health: Option<Health>,
    missing: u64,
}

impl Content {
    fn take(&mut self, frame: &Frame) {
        match frame {
            Frame::Codes(codes) => self.codes = Some(*codes),
            Frame::Sample(sample) => self.sample(sample),
            Frame::Estimate(estimate) => self.estimate(estimate),
            Frame::Health(health) => self.health = Some(*health),
            // A record comes as its parts.
            Frame::Record(_) | Frame::Command(_) | Frame::Reply(_) => {}
            Frame::Reflection(_) | Frame::Rendered(_) => {}
        }
    }

    fn sample(&mut self, sample: &Sample<f32>) {
        let codes = self.codes.take().filter(|c| c.time_us == sample.time_us);
        let last = self.runs.last().and_then(|run| run.last());
        let instant = Row {
            codes,
            sample: *sample,
            innovation_n: None,
        };
        match (last.map(|last| last.sample.time_us), self.runs.last_mut()) {
            (Some(before), Some(run)) if before < sample.time_us => {
                self.missing += ((sample.time_us - before + 500) / 1000).saturating_sub(1);
                run.push(instant);
            }
            // Of two samples of the same instant one is kept.
            (Some(before), Some(_)) if before == sample.time_us => {}
            _ => self.runs.push(vec![instant]),
        }
    }

    /// Adds an estimate, which follows its sample.
    fn estimate(&mut self, estimate: &Estimate<f32>) {
        if let Some(instant) = self.runs.last_mut().and_then(|run| run.last_mut()) {
            // In free air no force is predicted.
            let in_contact = estimate.phase == Phase::Contact;
            instant.innovation_n = in_contact.then_some(estimate.innovation.innovation_n);
        }
    }
}

/// Makes `log.csv` from `recording.frames` in a folder, and further logs if the board was reset; a machine that
/// turns has columns in rad and N m.
///
/// # Errors
/// There is no recording, or it has too few samples for a log.
pub fn convert(folder: &Path, kind: Kind) -> Result<String, Box<dyn Error>> {
    let path = folder.join(RECORDING);
    let file = File::open(&path).map_err(|error| {
        Diagnostic::new(format!("cannot read the recording: {error}"))
            .in_file(&path)
            .remedy("name the folder that `record --out` wrote")
    })?;
    let content = decoded(BufReader::new(file))?;
    let mut text = String::new();
    let usable = content
        .runs
        .iter()
        .filter(|run| run.len() >= FEWEST_SAMPLES);
    for (index, run) in usable.enumerate() {
        let name = match index {
            0 => "log.csv".to_string(),
            index => format!("log-{}.csv", index + 1),
        };
        let log = folder.join(name);
        let recorded = Log {
            kind: Some(kind),
            ..as_log(run)
        };
        recorded.write_csv(&log)?;
        text.push_str(&format!(
            "{}: {}\n",
            log.display(),
            counted(run.len(), "sample")
        ));
    }
    if text.is_empty() {
        return Err(Diagnostic::new("too few samples for a log")
            .in_file(&path)
            .remedy(format!("record {FEWEST_SAMPLES} samples or more"))
            .into());
    }
    text.push_str(&format!(
        "{} missing between the first and the last, {} garbled",
        counted(content.missing as usize, "sample"),
        counted(content.garbled as usize, "frame")
    ));
    if let Some(health) = content.health {
        text.push_str(&format!(
            "; the board dropped {}, missed {}, and was late {} times since its start",
            health.dropped, health.missed, health.overruns
        ));
    }
    text.push('\n');
    Ok(text)
}

fn decoded(mut file: impl Read) -> io::Result<Content> {
    let mut content = Content::default();
    let mut decoder = Decoder::new();
    let mut bytes = [0; 1 << 16];
    let mut in_step = false;
    loop {
        let count = file.read(&mut bytes)?;
        if count == 0 {
            return Ok(content);
        }
        for byte in bytes.iter().take(count) {
            match decoder.push(*byte) {
                Some(Ok((_, frame))) => frame.parts().for_each(|part| content.take(&part)),
                // The rest of a frame that began before the recording does not count.
                Some(Err(_)) => content.garbled += u64::from(in_step),
                None => {}
            }
            in_step |= *byte == 0;
        }
    }
}

fn as_log(run: &[Row]) -> Log {
    let start_us = run.first().map_or(0, |first| first.sample.time_us);
    let channel = |of: &dyn Fn(&Row) -> f64| -> Vec<f64> { run.iter().map(of).collect() };
    let mut log = Log::from_channels(
        channel(&|i| (i.sample.time_us - start_us) as f64 * 1e-6),
        channel(&|i| f64::from(i.sample.position_m)),
        channel(&|i| f64::from(i.sample.force_n)),
    );
    let code = |of: fn(&Codes) -> i32| {
        channel(&|i: &Row| {
            i.codes
                .as_ref()
                .map_or(f64::NAN, |codes| f64::from(of(codes)))
        })
    };
    let mut columns = vec![("faults", channel(&|i| f64::from(i.sample.faults.bits())))];
    if run.iter().any(|instant| instant.codes.is_some()) {
        columns.push(("force_code", code(|codes| codes.force)));
        columns.push(("position_code", code(|codes| codes.position)));
    }
    columns.push((
        "innovation_n",
        channel(&|i| i.innovation_n.map_or(f64::NAN, f64::from)),
    ));
    log.extra
        .extend(columns.into_iter().map(|(name, values)| ExtraColumn {
            name: name.into(),
            values,
        }));
    log
}
