//! `palpate monitor`: a board, watched by a person.

use std::error::Error;
use std::fmt::Write;
use std::io::{self, IsTerminal};
use std::time::{Duration, Instant};

use clap::Args;
use estimator_core::board::frame::Frame;
use estimator_core::board::link::{Health, Range};
use estimator_core::board::reflection::{Limit, Packet, Rendered};
use estimator_core::board::settings::Key;
use estimator_core::estimate::Phase;
use estimator_core::{Estimate, Fault, Faults, Status};

use crate::link::{Device, Port, condition, device::Statistics, port};
use crate::number::{Measured, quantity};
use crate::output::say;

/// Arguments of `palpate monitor`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Example:\n  palpate monitor --port /dev/ttyUSB0\n\n\
    On a terminal the picture stays in place; in a pipe it is a line for every look. Ctrl-C ends it.")]
pub struct MonitorArgs {
    /// Serial port, the emulator's working directory, or `simulated`: a new board every time.
    #[arg(long, value_name = "PORT")]
    pub port: String,
    /// Time between two looks (s).
    #[arg(long, value_name = "S", default_value_t = 0.2, value_parser = interval)]
    pub every: f64,
    /// End after so many looks.
    #[arg(long, value_name = "N")]
    pub looks: Option<u64>,
}

/// A port that says nothing for so long is not there any more.
const SILENCE: Duration = Duration::from_secs(3);

fn interval(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(seconds) if (0.02..=3600.0).contains(&seconds) => Ok(seconds),
        _ => Err("a time from 0.02 to 3600 s".into()),
    }
}

/// Runs the verb.
///
/// # Errors
/// A port that is not there or falls silent.
pub fn run(args: &MonitorArgs) -> Result<(), Box<dyn Error>> {
    let mut device = Device::new(port::open(&args.port)?);
    watch(&mut device, args, io::stdout().is_terminal(), say)
}

/// Looks as often as asked, by the board's own time, and says what it sees.
///
/// # Errors
/// What the port or `show` says, or silence.
pub fn watch<P: Port>(
    device: &mut Device<P>,
    args: &MonitorArgs,
    in_place: bool,
    mut show: impl FnMut(String) -> io::Result<()>,
) -> Result<(), Box<dyn Error>> {
    let mut view = View::default();
    let (mut looks, mut heard, mut height) = (0, Instant::now(), 0);
    while args.looks.is_none_or(|most| looks < most) {
        let Some(frame) = device.next_frame()? else {
            if heard.elapsed() > SILENCE {
                return Err(silence(&device.statistics()).into());
            }
            continue;
        };
        heard = Instant::now();
        if !view.take(&frame, (args.every * 1e6) as u64) {
            continue;
        }
        looks += 1;
        let statistics = device.statistics();
        if in_place {
            let screen = view.screen(&statistics);
            let back = if height > 0 {
                format!("\x1b[{height}A\x1b[J")
            } else {
                String::new()
            };
            height = screen.lines().count();
            show(back + &screen)?;
        } else {
            show(view.line(&statistics))?;
        }
    }
    Ok(())
}

fn silence(statistics: &Statistics) -> io::Error {
    io::Error::new(
        io::ErrorKind::TimedOut,
        format!(
            "nothing comes any more ({} frames so far, {} garbled)",
            statistics.frames, statistics.garbled
        ),
    )
}

/// What is known.
#[derive(Debug, Default)]
struct View {
    estimate: Option<Estimate<f32>>,
    health: Option<Health>,
    looked_us: Option<u64>,
    /// Stamp of the newest sample, and how much older its estimate's is (µs): the delay of filter and
    /// compensation.
    sampled_us: u64,
    late_us: u64,
    samples: u64,
    rate_hz: f64,
    /// Faults since the last look: one of a single sample must not be missed.
    faults: Faults,
    /// The last impedance for the other side, and how many came since the last look; its rate (Hz).
    packet: Option<Packet>,
    packets: u64,
    packet_hz: f64,
    rendered: Option<Rendered>,
}

impl View {
    /// Takes a frame; whether it is time to look.
    fn take(&mut self, frame: &Frame, every_us: u64) -> bool {
        match frame {
            Frame::Health(health) => self.health = Some(*health),
            Frame::Sample(sample) => {
                self.samples += 1;
                self.sampled_us = sample.time_us;
            }
            Frame::Estimate(estimate) => {
                self.late_us = self.sampled_us.saturating_sub(estimate.time_us);
                self.estimate = Some(*estimate);
                self.faults = self.faults | estimate.faults;
                return self.is_due(estimate.time_us, every_us);
            }
            Frame::Reflection(packet) => {
                self.packet = Some(*packet);
                self.packets += 1;
            }
            Frame::Rendered(rendered) => {
                self.rendered = Some(*rendered);
                self.faults = self.faults | rendered.faults;
            }
            // A device gives a record as its parts.
            Frame::Record(_) | Frame::Codes(_) | Frame::Command(_) | Frame::Reply(_) => {}
        }
        false
    }

    fn is_due(&mut self, now_us: u64, every_us: u64) -> bool {
        let last = *self.looked_us.get_or_insert(now_us);
        // A board that was reset starts its time anew.
        let elapsed = now_us.checked_sub(last).unwrap_or(every_us);
        if elapsed < every_us {
            return false;
        }
        self.rate_hz = self.samples as f64 * 1e6 / elapsed as f64;
        self.packet_hz = self.packets as f64 * 1e6 / elapsed as f64;
        (self.looked_us, self.samples, self.packets) = (Some(now_us), 0, 0);
        true
    }

    /// For a pipe.
    fn line(&mut self, statistics: &Statistics) -> String {
        let Some(estimate) = self.estimate else {
            return String::new();
        };
        let mut text = format!(
            "{:9.3} s  {}  F {}  depth {}  {}",
            estimate.time_us as f64 * 1e-6,
            phase(estimate.phase),
            quantity(f64::from(estimate.force_n), 3, "N"),
            quantity(f64::from(estimate.depth_m), 3, "m"),
            estimate.status.name(),
        );
        for (name, value) in parameters(&estimate) {
            text.push_str(&format!("  {name} {value}"));
        }
        for said in self.teleoperation().into_iter().flatten() {
            text.push_str(&format!("  {said}"));
        }
        for fault in self.seen(&estimate).iter() {
            text.push_str(&format!("  fault {}", fault.code()));
        }
        text.push_str(&format!("  lost {}\n", statistics.lost));
        text
    }

    /// For a terminal.
    fn screen(&mut self, statistics: &Statistics) -> String {
        let mut text = String::new();
        if let Some(estimate) = self.estimate {
            // Writing into a String cannot fail.
            let _ = self.write_screen(&mut text, &estimate, statistics);
        }
        text
    }

    fn write_screen(
        &mut self,
        text: &mut String,
        estimate: &Estimate<f32>,
        statistics: &Statistics,
    ) -> std::fmt::Result {
        writeln!(
            text,
            "{:.1} s  {}  {}  ({}, of {} ms ago)",
            estimate.time_us as f64 * 1e-6,
            phase(estimate.phase),
            estimate.status.name(),
            estimate.law.name(),
            self.late_us / 1000,
        )?;
        let force = quantity(f64::from(estimate.force_n), 3, "N");
        writeln!(text, "  force      {force:>12}  {}", bar(estimate.force_n))?;
        let depth = quantity(f64::from(estimate.depth_m), 3, "m");
        writeln!(text, "  depth      {depth:>12}")?;
        for (name, value) in parameters(estimate) {
            writeln!(text, "  {name:<10} {value}")?;
        }
        writeln!(
            text,
            "  link       {:.0} Hz, {} lost, {} garbled",
            self.rate_hz, statistics.lost, statistics.garbled
        )?;
        for said in self.teleoperation().into_iter().flatten() {
            writeln!(text, "  {said}")?;
        }
        if let Some(health) = &self.health {
            health_lines(text, health)?;
        }
        for fault in self.seen(estimate).iter() {
            write!(text, "  fault {:>2}   {}", fault.code(), fault.describe())?;
            match Key::deciding(fault) {
                Some(key) => writeln!(text, " ({})", key.info().name)?,
                None => writeln!(text)?,
            }
        }
        Ok(())
    }

    /// What goes to the other side, and what is rendered of what comes from there.
    fn teleoperation(&self) -> [Option<String>; 2] {
        let reflects = self.packet.map(|packet| {
            let what = packet.status.name();
            format!("reflects   {:.0} Hz, {what}", self.packet_hz)
        });
        let renders = self.rendered.map(|rendered| {
            let force = quantity(f64::from(rendered.force_n), 3, "N");
            let limits = Limit::ALL.into_iter().filter(|limit| rendered.has(*limit));
            let limits: Vec<_> = limits.map(Limit::name).collect();
            match limits.is_empty() {
                true => format!("renders    {force}"),
                false => format!("renders    {force} ({})", limits.join(", ")),
            }
        });
        [reflects, renders]
    }

    /// Faults since the last look, and the estimator's doubts.
    fn seen(&mut self, estimate: &Estimate<f32>) -> Faults {
        let seen = std::mem::take(&mut self.faults);
        match estimate.status {
            Status::ModelSuspect => seen.with(Fault::EstimatorSuspect),
            _ => seen,
        }
    }
}

fn health_lines(text: &mut String, health: &Health) -> std::fmt::Result {
    let Range { min, max, .. } = health.period;
    writeln!(
        text,
        "  board      step {} … {}, task up to {}, response up to {}, period {min} … {max}",
        health.step.min, health.step.max, health.task.max, health.response.max
    )?;
    writeln!(
        text,
        "             {} late, {} missed, {} dropped, {} garbled, {} bytes of stack free",
        health.overruns, health.missed, health.dropped, health.garbled, health.stack_free
    )?;
    for said in condition::lines(health) {
        writeln!(text, "             {said}")?;
    }
    if health.clock_fallback {
        writeln!(text, "             no crystal: times are off by up to 1 %")?;
    }
    if let Some(key) = health.concerns {
        writeln!(
            text,
            "             saved {} cannot be used",
            key.info().name
        )?;
    }
    Ok(())
}

/// The parameters of the law by name; those that are not observable as such.
fn parameters(estimate: &Estimate<f32>) -> impl Iterator<Item = (&'static str, String)> {
    let slots = estimate.parameters;
    let infos = estimate.law.parameters().iter();
    infos.zip(slots).map(|(info, slot)| {
        let text = match slot {
            Some(p) => {
                let error = Some(f64::from(p.std_error));
                Measured::new(f64::from(p.value), error, info.unit.symbol()).to_string()
            }
            None => "–".to_string(),
        };
        (info.name, text)
    })
}

fn phase(phase: Phase) -> &'static str {
    match phase {
        Phase::Settling => "settling",
        Phase::Free => "free    ",
        Phase::Contact => "contact ",
    }
}

/// A newton a mark, up to 40.
fn bar(force_n: f32) -> String {
    "▮".repeat(force_n.clamp(0.0, 40.0) as usize)
}

#[cfg(test)]
mod tests {
    use super::*;
    use estimator_core::{Config, Sample, State, step};

    #[test]
    fn the_screen_says_how_old_the_estimate_is() {
        let params = Config::default().validate::<f32>().unwrap();
        let mut state = State::new(&params);
        let sample = Sample {
            time_us: 1_000_000,
            ..Sample::default()
        };
        // 8 samples of filter, and 6 ms of a compensation.
        let mut estimate = step(&params, &mut state, sample);
        estimate.time_us -= 6000;
        let mut view = View::default();
        view.take(&Frame::Sample(sample), 1);
        view.take(&Frame::Estimate(estimate), 1);
        let screen = view.screen(&Statistics::default());
        assert!(screen.contains("of 14 ms ago"), "{screen}");
    }
}
