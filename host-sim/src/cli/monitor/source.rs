//! Where the frames come from: a board behind a port, or a log that the board's step is run over.

use std::collections::VecDeque;
use std::error::Error;
use std::io;
use std::path::{Path, PathBuf};
use std::thread::sleep;
use std::time::{Duration, Instant};

use estimator_core::board::frame::Frame;
use estimator_core::estimate::method::Method;
use estimator_core::{Config, Sample, State, estimate::params::Params, step};

use crate::estimate::{Choices, setup};
use crate::kind::Kind;
use crate::link::record::{self, Recording};
use crate::link::{Device, Port, device::Statistics};
use crate::log::{Log, ReadOptions};
use crate::replay::samples;
use crate::report::called;

/// What is said of a port that has fallen silent.
pub(super) fn silence(statistics: &Statistics) -> io::Error {
    io::Error::new(
        io::ErrorKind::TimedOut,
        format!(
            "the port has fallen silent ({} frames so far, {} garbled)",
            statistics.frames, statistics.garbled
        ),
    )
}

/// Where frames come from.
pub(super) trait Source {
    /// What is watched.
    fn name(&self) -> &str;

    /// Whether the machine that is watched moves along a line or turns.
    fn kind(&self) -> Kind;

    /// The next frame, if one has come; it waits a little.
    ///
    /// # Errors
    /// The connection is lost.
    fn next_frame(&mut self) -> io::Result<Option<Frame>>;

    /// Whether nothing will come any more.
    fn has_ended(&self) -> bool;

    /// The counts of what has come.
    fn statistics(&self) -> Statistics;

    /// Begins a recording in a folder; what is to be said of it.
    ///
    /// # Errors
    /// What the disk says, or that there is nothing to record.
    fn begin_recording(&mut self, folder: &Path) -> Result<Option<String>, Box<dyn Error>>;

    /// Ends the recording and makes its log; what is to be said of it.
    ///
    /// # Errors
    /// What the disk says.
    fn end_recording(&mut self) -> Result<String, Box<dyn Error>>;
}

/// A board behind a port.
pub(super) struct Board<P> {
    name: String,
    kind: Kind,
    device: Device<P>,
    recording: Option<(PathBuf, Recording)>,
}

impl<P: Port> Board<P> {
    pub(super) fn new(name: &str, kind: Kind, device: Device<P>) -> Self {
        Board {
            name: name.into(),
            kind,
            device,
            recording: None,
        }
    }
}

impl<P: Port> Source for Board<P> {
    fn name(&self) -> &str {
        &self.name
    }

    fn kind(&self) -> Kind {
        self.kind
    }

    fn next_frame(&mut self) -> io::Result<Option<Frame>> {
        self.device.next_frame()
    }

    fn has_ended(&self) -> bool {
        false
    }

    fn statistics(&self) -> Statistics {
        self.device.statistics()
    }

    fn begin_recording(&mut self, folder: &Path) -> Result<Option<String>, Box<dyn Error>> {
        let recording = record::begin(&mut self.device, folder)?;
        let note = recording.note.clone();
        self.recording = Some((folder.to_path_buf(), recording));
        Ok(note)
    }

    fn end_recording(&mut self) -> Result<String, Box<dyn Error>> {
        let Some((folder, recording)) = self.recording.take() else {
            return Ok(String::new());
        };
        recording.end(&mut self.device)?;
        record::convert(&folder, self.kind)
    }
}

/// A log, and the board's step over it at the log's own pace.
pub(super) struct Replayed {
    name: String,
    kind: Kind,
    params: Params<f32>,
    state: State<f32>,
    samples: VecDeque<Sample<f32>>,
    /// The estimate that belongs to the sample that went out last.
    waiting: Option<Frame>,
    started: Option<(Instant, u64)>,
    times: f64,
    frames: u64,
}

impl Replayed {
    /// Reads a log and chooses the settings that `estimate` would.
    ///
    /// # Errors
    /// A log that cannot be read or used.
    pub(super) fn read(path: &Path, times: f64) -> Result<Replayed, Box<dyn Error>> {
        let log = Log::read(path, &ReadOptions::default())?.into_uniform()?;
        let method = Method::HUNT_CROSSLEY_BANK;
        let setup = setup(&log, Config::default(), method, Choices::default());
        let params = setup.config.validate::<f32>().map_err(|error| {
            io::Error::new(
                io::ErrorKind::InvalidInput,
                format!("this log needs settings that cannot be used: {error}"),
            )
        })?;
        Ok(Replayed {
            name: called(path),
            kind: log.kind.unwrap_or_default(),
            state: State::new(&params),
            params,
            samples: samples(&log).collect(),
            waiting: None,
            started: None,
            times,
            frames: 0,
        })
    }

    /// How long it is until a sample is due.
    fn until(&mut self, time_us: u64) -> Duration {
        let (start, first_us) = *self.started.get_or_insert((Instant::now(), time_us));
        let due_s = time_us.saturating_sub(first_us) as f64 * 1e-6 / self.times;
        Duration::from_secs_f64(due_s).saturating_sub(start.elapsed())
    }
}

impl Source for Replayed {
    fn name(&self) -> &str {
        &self.name
    }

    fn kind(&self) -> Kind {
        self.kind
    }

    fn next_frame(&mut self) -> io::Result<Option<Frame>> {
        if let Some(estimate) = self.waiting.take() {
            return Ok(Some(estimate));
        }
        let Some(next) = self.samples.front().copied() else {
            sleep(Duration::from_millis(20));
            return Ok(None);
        };
        let wait = self.until(next.time_us);
        if !wait.is_zero() {
            sleep(wait.min(Duration::from_millis(20)));
            return Ok(None);
        }
        self.samples.pop_front();
        let estimate = step(&self.params, &mut self.state, next);
        self.waiting = Some(Frame::Estimate(estimate));
        self.frames += 1;
        Ok(Some(Frame::Sample(next)))
    }

    fn has_ended(&self) -> bool {
        self.samples.is_empty() && self.waiting.is_none()
    }

    fn statistics(&self) -> Statistics {
        Statistics {
            frames: self.frames,
            ..Statistics::default()
        }
    }

    fn begin_recording(&mut self, _folder: &Path) -> Result<Option<String>, Box<dyn Error>> {
        Err("a log is being replayed: there is no board to record".into())
    }

    fn end_recording(&mut self) -> Result<String, Box<dyn Error>> {
        Ok(String::new())
    }
}
