//! `palpate config calibrate`: known weights onto the load cell, a known way for the encoder, and how
//! good what came out is.

use std::error::Error;
use std::io::{self, BufRead, Write};
use std::time::Instant;

use clap::Args;
use estimator_core::board::{
    calibration::Calibration, calibration::Point, calibration::Quality, frame::Frame,
    link::Command, sensing::Codes, settings::Key, settings::Settings,
};

use crate::diagnostic::Diagnostic;
use crate::link::{Device, Port, backup::restore, device::SILENCE};
use crate::number::quantity;
use crate::output::say;

/// Arguments of `palpate config calibrate`.
#[derive(Args, Clone, Debug)]
#[command(
    after_help = "Example:\n  palpate config --port /dev/ttyUSB0 calibrate --weights 0,0.5,1,2 --travel 10\n\n\
    Three weights or more, 0 among them, show whether the load cell is linear; two cannot."
)]
pub struct CalibrateArgs {
    /// Weights (kg) in the order in which they will be laid on, 0 for none.
    #[arg(long, value_delimiter = ',', value_name = "KG,KG,…")]
    pub weights: Vec<f64>,
    /// The weights pull the probe towards the material instead of pushing it out.
    #[arg(long)]
    pub pulling: bool,
    /// Acceleration of gravity (m/s²); 9.780 at the equator, 9.832 at the poles.
    #[arg(long, default_value_t = 9.80665, value_name = "M/S2")]
    pub gravity: f64,
    /// Known way (mm) into the material for the encoder, such as a gauge block.
    #[arg(long, value_name = "MM")]
    pub travel: Option<f64>,
    /// Write and save without asking.
    #[arg(long)]
    pub yes: bool,
}

/// Who lays the weights on.
pub trait Person {
    /// Says what to do and waits until it is done; gives what was answered.
    ///
    /// # Errors
    /// That nobody is there.
    fn asked(&mut self, request: &str) -> io::Result<String>;

    /// Says something.
    ///
    /// # Errors
    /// That nobody listens.
    fn told(&mut self, text: &str) -> io::Result<()>;
}

/// A person at the terminal.
#[derive(Debug)]
pub struct Terminal;

impl Person for Terminal {
    fn asked(&mut self, request: &str) -> io::Result<String> {
        say(request)?;
        io::stdout().flush()?;
        let mut answer = String::new();
        match io::stdin().lock().read_line(&mut answer)? {
            0 => Err(io::Error::other(
                "calibration asks for weights one by one, and nobody answers on standard input",
            )),
            _ => Ok(answer.trim().to_string()),
        }
    }

    fn told(&mut self, text: &str) -> io::Result<()> {
        say(text)
    }
}

/// Samples of a point: 1 s, in which a noise of 12 codes averages to 0.4.
const SAMPLES: usize = 1000;
/// A point is measured again while its two halves differ by more than this many standard errors of
/// their difference, and by more than 2 codes: the weight still swings.
const STILL: f64 = 6.0;
const STILL_CODES: f64 = 2.0;
const ATTEMPTS: usize = 20;

/// Guides through the calibration and writes it to the board.
///
/// # Errors
/// Nothing to calibrate, no codes from the board, weights that tell nothing, and whatever the board
/// refuses.
pub fn run<P: Port>(
    device: &mut Device<P>,
    args: &CalibrateArgs,
    person: &mut impl Person,
) -> Result<String, Box<dyn Error>> {
    check(args)?;
    let before = device.settings()?;
    // Every sample, whatever telemetry is set to: a point is then 1 s.
    device.set(Key::TelemetryEvery, 1.0)?;
    let measured = measured(device, args, person, before);
    // Back, also after an error; the error is what counts.
    let back = device.set(Key::TelemetryEvery, before.get(Key::TelemetryEvery));
    let wanted = measured?;
    back?;
    if !args.yes {
        let answer = person.asked("Write this to the board and save it? [y/N] ")?;
        if !answer.eq_ignore_ascii_case("y") {
            return Ok("nothing changed\n".into());
        }
    }
    // A zero that has crept under the weights looks like contact, in which nothing is taken.
    device.order(Command::Restart)?;
    let changed = restore(device, &before, &wanted)?;
    Ok(format!("{changed} settings changed, saved\n"))
}

fn measured<P: Port>(
    device: &mut Device<P>,
    args: &CalibrateArgs,
    person: &mut impl Person,
    mut settings: Settings,
) -> Result<Settings, Box<dyn Error>> {
    if !args.weights.is_empty() {
        force(device, args, person, &mut settings)?;
    }
    if let Some(travel_mm) = args.travel {
        position(device, travel_mm * 1e-3, person, &mut settings)?;
    }
    Ok(settings)
}

fn check(args: &CalibrateArgs) -> Result<(), Diagnostic> {
    let wrong = |what: &str, value: String, remedy: &str| {
        Err(Diagnostic::new(what).value(value).remedy(remedy))
    };
    if args.weights.is_empty() && args.travel.is_none() {
        return Err(
            Diagnostic::new("nothing to calibrate").remedy("give --weights, --travel or both")
        );
    }
    let list = format!("{:?}", args.weights);
    if !args.weights.is_empty() && args.weights.len() < 2 {
        return wrong(
            "too few weights",
            list,
            "give two at least, better four, 0 among them",
        );
    }
    if args.weights.iter().any(|kg| !kg.is_finite() || *kg < 0.0) {
        return wrong(
            "this is not a weight",
            list,
            "give weights in kg; --pulling turns their direction",
        );
    }
    if !(9.0..=10.0).contains(&args.gravity) {
        let gravity = args.gravity.to_string();
        return wrong(
            "this is not the acceleration of gravity on the Earth",
            gravity,
            "give it in m/s², such as 9.80665",
        );
    }
    match args.travel {
        Some(mm) if !mm.is_finite() || mm <= 0.0 => wrong(
            "this is not a distance",
            mm.to_string(),
            "give it in mm, into the material",
        ),
        _ => Ok(()),
    }
}

fn force<P: Port>(
    device: &mut Device<P>,
    args: &CalibrateArgs,
    person: &mut impl Person,
    settings: &mut Settings,
) -> Result<(), Box<dyn Error>> {
    let sign = if args.pulling { -1.0 } else { 1.0 };
    let mut points = Vec::new();
    for kg in &args.weights {
        let force_n = sign * kg * args.gravity;
        let request = match *kg {
            0.0 => "Take every weight off the cell, then press Enter. ".to_string(),
            kg => format!("Lay {kg} kg on the cell, let it come to rest, then press Enter. "),
        };
        person.asked(&request)?;
        let mut point = still(device, person)?;
        point.force_n = force_n;
        person.told(&format!(
            "  {:>9}: code {:.1}, noise {:.1}\n",
            quantity(force_n, 4, "N"),
            point.code,
            point.noise_codes
        ))?;
        points.push(point);
    }
    let fit = Calibration::fit(&points)
        .map_err(|error| Diagnostic::new(error.to_string()).value(format!("{:?}", args.weights)))?;
    person.asked("Take every weight off again, for the zero, then press Enter. ")?;
    let empty = still(device, person)?;
    person.told(&judgement(&points, &fit, fit.drift_n(empty.code)))?;
    settings.put(Key::ForcePerCode, fit.n_per_code as f32);
    // As the cell is now, after having been loaded.
    settings.put(Key::ForceZeroCode, empty.code as f32);
    settings.put(Key::ForceResidualN, fit.residual_n.unwrap_or(0.0) as f32);
    settings.put(Key::ForceCalibrated, 1.0);
    Ok(())
}

/// The points, the line, and in one word how good it is.
fn judgement(points: &[Point], fit: &Calibration, drift_n: f64) -> String {
    let mut text = String::from("      weight       reads   deviation\n");
    for point in points {
        let reads_n = fit.drift_n(point.code);
        text.push_str(&format!(
            "  {:>10}  {:>10}  {:>10}\n",
            quantity(point.force_n, 4, "N"),
            quantity(reads_n, 4, "N"),
            quantity(reads_n - point.force_n, 2, "N"),
        ));
    }
    let (worst_n, worst) = fit.worst;
    let of_span = 100.0 * worst_n / fit.span_n;
    text.push_str(&format!(
        "scale {:.6e} N per code ± {:.3} %, noise {} rms\n",
        fit.n_per_code,
        100.0 * fit.scale_error,
        quantity(fit.noise_n, 2, "N"),
    ));
    text.push_str(&match fit.quality() {
        Quality::Good => format!("good: every weight within {of_span:.2} % of the largest\n"),
        Quality::Usable => format!(
            "usable: {} is off by {of_span:.2} % of the largest weight; good is 0.5 %\n",
            quantity(points[worst].force_n, 4, "N")
        ),
        Quality::Poor => format!(
            "poor: {} is off by {of_span:.1} % of the largest weight; is that weight right, does \
             anything touch the probe, is the cell loaded beyond its range?\n",
            quantity(points[worst].force_n, 4, "N")
        ),
        Quality::Unchecked => {
            "unchecked: a line through two weights always fits; a third weight shows whether the cell is linear\n".into()
        }
    });
    let drift = 100.0 * drift_n.abs() / fit.span_n;
    let stays = if drift <= 0.5 {
        "stays"
    } else {
        "drifts: let the cell warm up, check its mounting"
    };
    text.push_str(&format!(
        "zero {stays}: {} after the weights, {drift:.2} % of the largest\n",
        quantity(drift_n, 2, "N")
    ));
    text
}

fn position<P: Port>(
    device: &mut Device<P>,
    travel_m: f64,
    person: &mut impl Person,
    settings: &mut Settings,
) -> Result<(), Box<dyn Error>> {
    person.asked("Hold the probe at its start, then press Enter. ")?;
    let from = mean_of(&codes(device)?, |codes| f64::from(codes.position));
    person.asked(&format!(
        "Move it {} into the material and hold it, then press Enter. ",
        quantity(travel_m, 4, "m")
    ))?;
    let to = mean_of(&codes(device)?, |codes| f64::from(codes.position));
    let counts = to - from;
    if counts.abs() < 32.0 {
        return Err(Diagnostic::new("the encoder does not move")
            .value(format!("{counts:.1} codes"))
            .remedy("check its supply and both channels; the probe must move by the whole way")
            .into());
    }
    let m_per_code = travel_m / counts;
    person.told(&format!(
        "encoder {m_per_code:.6e} m per code, counting {} into the material\n",
        if m_per_code > 0.0 { "up" } else { "down" }
    ))?;
    settings.put(Key::PositionPerCode, m_per_code as f32);
    settings.put(Key::PositionCalibrated, 1.0);
    Ok(())
}

/// A point whose weight lies still.
fn still<P: Port>(
    device: &mut Device<P>,
    person: &mut impl Person,
) -> Result<Point, Box<dyn Error>> {
    for attempt in 0..ATTEMPTS {
        let codes = codes(device)?;
        let (first, second) = codes.split_at(SAMPLES / 2);
        let force = |codes: &Codes| f64::from(codes.force);
        let moved = mean_of(second, force) - mean_of(first, force);
        let code = mean_of(&codes, force);
        let squares = mean_of(&codes, |codes| (f64::from(codes.force) - code).powi(2));
        let noise_codes = squares.sqrt();
        let error = noise_codes * (4.0 / SAMPLES as f64).sqrt();
        if moved.abs() <= (STILL * error).max(STILL_CODES) {
            return Ok(Point {
                code,
                noise_codes,
                force_n: 0.0,
            });
        }
        if attempt == 0 {
            person.told("  it still moves, waiting\n")?;
        }
    }
    Err(io::Error::other("the force does not come to rest").into())
}

/// The next [`SAMPLES`] codes: from now on, not what has waited in the line.
fn codes<P: Port>(device: &mut Device<P>) -> Result<Vec<Codes>, Box<dyn Error>> {
    // The answer comes after everything that was measured before the question.
    device.identity()?;
    let mut codes = Vec::with_capacity(SAMPLES);
    let mut heard = Instant::now();
    // The records that were in the queue then: 64, and a line's worth.
    let mut old = 80;
    while codes.len() < SAMPLES {
        match device.next_frame()? {
            Some(Frame::Codes(_)) if old > 0 => (old, heard) = (old - 1, Instant::now()),
            Some(Frame::Codes(next)) => {
                heard = Instant::now();
                codes.push(next);
            }
            Some(_) | None if heard.elapsed() > SILENCE => {
                return Err(io::Error::new(
                    io::ErrorKind::TimedOut,
                    "the board sends no raw codes: a recording in the emulator has none",
                )
                .into());
            }
            Some(_) | None => {}
        }
    }
    Ok(codes)
}

fn mean_of(codes: &[Codes], of: impl Fn(&Codes) -> f64) -> f64 {
    codes.iter().map(of).sum::<f64>() / codes.len() as f64
}
