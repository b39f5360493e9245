//! A known effect put into a record that somebody measured: a formula on the record's columns.
//!
//! What adds to the force is a shape, scaled until its root mean square is the wanted change. Delay, lag and
//! saturation act on the force that was measured, a spring in series on the position. Their strength is
//! bisected until the force changes by as much.

use super::fit::rms;

/// A record: time (s), position (m), force (N).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Record {
    /// Time (s), increasing.
    pub t: Vec<f64>,
    /// Position (m).
    pub x: Vec<f64>,
    /// Force (N).
    pub f: Vec<f64>,
}

/// What was put into a record.
#[derive(Clone, Debug, PartialEq)]
pub struct Injection {
    /// The record with the effect.
    pub record: Record,
    /// The parameter that says how large the effect is, under the catalogue's name.
    pub name: &'static str,
    /// Its value.
    pub value: f64,
}

/// The effects that can be put into a record: the catalogue's id, and whether a contact is needed for it.
pub const EFFECTS: [(&str, bool); 12] = [
    ("coulomb_friction", false),
    ("time_delay", false),
    ("force_lag", false),
    ("cogging", false),
    ("periodic_disturbance", false),
    ("force_drift", false),
    ("force_saturation", false),
    ("series_compliance", true),
    ("tool_inertia", false),
    ("asymmetric_drag", false),
    ("buried_layer", true),
    ("cable_stiffness", false),
];

/// Halvings of a strength: 10⁻⁹ of the range it is sought in.
const HALVINGS: usize = 30;
/// The cogging has this many periods within the travel, which is no whole number.
const PERIODS: f64 = 7.3;
/// A line has this many periods in a log whose rate shows them, far above what motions repeat with.
const CYCLES: f64 = 180.0;
/// An acceleration is the probe's where parabolas twice as wide share at least this much of its variance. Where the
/// position is smoothed or its log thinned, noise is not what third differences and the mean interval say, and the
/// narrow parabola follows readings: a drive shares 1.00, a servo 0.87 to 0.91, a damper 0.76, a foot 0.81, an AFM 0.74; cells, foams and a
/// surgical tool 0.10 to 0.23.
const SHARED: f64 = 0.5;

/// Puts the effect `id` into a record so that the force changes by `size_n` (N rms).
///
/// # Errors
/// Why this record cannot have the effect in this size.
pub fn inject(id: &str, record: &Record, size_n: f64) -> Result<Injection, String> {
    let x_low = record.x.iter().copied().fold(f64::INFINITY, f64::min);
    let x_high = record.x.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let (way, tau) = (x_high - x_low, std::f64::consts::TAU);
    let added = |name: &'static str, shape: Vec<f64>| add(record, name, &shape, size_n);
    match id {
        "coulomb_friction" => added("force", rubbing(record, way)),
        "cogging" => {
            let turn = |x: &f64| (tau * PERIODS * (x - x_low) / way + 1.1).sin();
            added("amplitude", record.x.iter().map(turn).collect())
        }
        "periodic_disturbance" => {
            let hz = line_hz(record);
            let turn = |t: &f64| (tau * hz * (t - record.t[0]) + 0.4).sin();
            added("amplitude", record.t.iter().map(turn).collect())
        }
        "force_drift" => added("rate", record.t.iter().map(|t| t - record.t[0]).collect()),
        "cable_stiffness" => added("stiffness", record.x.clone()),
        "tool_inertia" => added("mass", accelerations(record)?),
        "asymmetric_drag" => {
            let speeds = speeds(record).into_iter();
            added("coefficient", speeds.map(f64::abs).collect())
        }
        "buried_layer" => {
            let touch = touch(record);
            let at = touch + 0.6 * (x_high - touch);
            added(
                "stiffness",
                record.x.iter().map(|x| (x - at).max(0.0)).collect(),
            )
        }
        "series_compliance" => {
            // k: the position moves by f/k, which is worth slope·f/k of force.
            let peak = record.f.iter().copied().fold(0.0, f64::max);
            let slope = peak / (x_high - touch(record));
            let stiffness = slope * rms(&record.f) / size_n;
            let moved = record
                .x
                .iter()
                .zip(&record.f)
                .map(|(x, f)| x + f / stiffness);
            let x = moved.collect();
            Ok(Injection {
                record: Record {
                    x,
                    ..record.clone()
                },
                name: "stiffness",
                value: stiffness,
            })
        }
        "time_delay" => sought(record, "delay", size_n, duration(record) / 20.0, late),
        "force_lag" => sought(
            record,
            "time_constant",
            size_n,
            duration(record) / 20.0,
            lagged,
        ),
        "force_saturation" => {
            let peak = record.f.iter().copied().fold(0.0, f64::max);
            // The bisected number is how far the limit lies below the peak.
            let cut = |record: &Record, below: f64| -> Vec<f64> {
                record.f.iter().map(|f| f.min(peak - below)).collect()
            };
            let found = sought(record, "limit", size_n, 0.9 * peak, cut)?;
            Ok(Injection {
                value: peak - found.value,
                ..found
            })
        }
        _ => Err(format!("{id} cannot be put into a record")),
    }
}

fn duration(record: &Record) -> f64 {
    record.t[record.t.len() - 1] - record.t[0]
}

/// Adds a shape of the force, scaled to the wanted size.
fn add(
    record: &Record,
    name: &'static str,
    shape: &[f64],
    size_n: f64,
) -> Result<Injection, String> {
    let value = size_n / rms(shape);
    if !value.is_finite() {
        return Err("the record does not move so".into());
    }
    let f = record
        .f
        .iter()
        .zip(shape)
        .map(|(f, s)| f + value * s)
        .collect();
    Ok(Injection {
        record: Record {
            f,
            ..record.clone()
        },
        name,
        value,
    })
}

/// Bisects a strength up to `most` until the changed force differs by the wanted size.
fn sought(
    record: &Record,
    name: &'static str,
    size_n: f64,
    most: f64,
    changed: impl Fn(&Record, f64) -> Vec<f64>,
) -> Result<Injection, String> {
    let by = |f: &[f64]| {
        let by: Vec<f64> = f.iter().zip(&record.f).map(|(f, was)| f - was).collect();
        rms(&by)
    };
    if by(&changed(record, most)) < size_n {
        return Err("it would have to be absurdly strong".into());
    }
    let (mut low, mut high) = (0.0, most);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        match by(&changed(record, middle)) < size_n {
            true => low = middle,
            false => high = middle,
        }
    }
    let f = changed(record, high);
    Ok(Injection {
        record: Record {
            f,
            ..record.clone()
        },
        name,
        value: high,
    })
}

/// The force as it was `by` seconds ago.
fn late(record: &Record, by: f64) -> Vec<f64> {
    let mut at = 0;
    let one = |t: &f64| {
        let then = t - by;
        while at + 2 < record.t.len() && record.t[at + 1] <= then {
            at += 1;
        }
        let share = ((then - record.t[at]) / (record.t[at + 1] - record.t[at])).clamp(0.0, 1.0);
        record.f[at] + share * (record.f[at + 1] - record.f[at])
    };
    record.t.iter().map(one).collect()
}

/// The force behind a low-pass of first order, exact for a force that is linear between the samples.
fn lagged(record: &Record, time: f64) -> Vec<f64> {
    let mut read = record.f[0];
    let mut out = vec![read];
    for (t, f) in record.t.windows(2).zip(record.f.windows(2)) {
        let u = (t[1] - t[0]) / time.max(1e-12);
        let keep = (-u).exp();
        // A ramp from f₀ to f₁ lags by its slope times the time constant.
        let slope = (f[1] - f[0]) / u;
        read = f[1] - slope + keep * (read - f[0] + slope);
        out.push(read);
    }
    out
}

/// −1 to 1: an element that is dragged along with the motion, and first bends by 0.2 % of the travel, or by
/// four counts of the encoder.
fn rubbing(record: &Record, way: f64) -> Vec<f64> {
    let bends = f64::max(4.0 * count(record), 2e-3 * way);
    let mut state: f64 = 0.0;
    let mut out = vec![0.0];
    for x in record.x.windows(2) {
        state = (state + (x[1] - x[0]) / bends).clamp(-1.0, 1.0);
        out.push(state);
    }
    out
}

/// The smallest step of the position (m).
fn count(record: &Record) -> f64 {
    let steps = record.x.windows(2).map(|x| (x[1] - x[0]).abs());
    let range = record.x.iter().fold(0.0_f64, |top, x| x.abs().max(top));
    steps
        .filter(|step| *step > 1e-9 * range)
        .fold(range, f64::min)
}

/// The position at which the force first exceeds a twentieth of its peak (m).
fn touch(record: &Record) -> f64 {
    let peak = record.f.iter().copied().fold(0.0, f64::max);
    let first = record.f.iter().position(|f| *f > 0.05 * peak);
    record.x[first.unwrap_or(0)]
}

/// The frequency of the line: as high as the slower part of the log shows.
fn line_hz(record: &Record) -> f64 {
    let mut steps: Vec<f64> = record.t.windows(2).map(|t| t[1] - t[0]).collect();
    steps.sort_by(f64::total_cmp);
    let slow = steps[steps.len() * 19 / 20];
    f64::min(0.15 / slow, CYCLES / duration(record))
}

/// Speed at every sample, of parabolas over as long as the probe needs for thirty counts of its encoder on average.
fn speeds(record: &Record) -> Vec<f64> {
    let (n, counts) = (record.x.len(), 30.0 * count(record));
    let mut half = 2;
    while half < n / 50 {
        let way: f64 = (half..n - half)
            .map(|k| (record.x[k + half] - record.x[k - half]).abs())
            .sum();
        if way / (n - 2 * half) as f64 > counts {
            break;
        }
        half *= 2;
    }
    derivatives(record, half).map(|d| d[0]).collect()
}

/// Acceleration at every sample, of parabolas that are as narrow as a noise of a tenth of it allows: over thirty
/// counts of a servo's encoder, 0.35 s, a seventh of its acceleration was left.
///
/// # Errors
/// The position does not show it.
fn accelerations(record: &Record) -> Result<Vec<f64>, String> {
    let n = record.x.len();
    let mut thirds: Vec<f64> = record.x.windows(4).map(third).collect();
    thirds.sort_by(f64::total_cmp);
    // The median of |normal| is 0.6745 σ, that of a third difference √20 as large; at rest it is 0.
    let noise = thirds[thirds.len() / 2] / (0.6745 * 20.0_f64.sqrt());
    let noise = noise.max(count(record) / 12.0_f64.sqrt());
    let step = duration(record) / (n - 1) as f64;
    let second = |half: usize| -> Vec<f64> { derivatives(record, half).map(|d| d[1]).collect() };
    let mut half = 2;
    loop {
        let each = second(half);
        let error = noise * 720.0_f64.sqrt() / ((2 * half + 1) as f64).powf(2.5) / step.powi(2);
        if error <= 0.1 * rms(&each) || half >= n / 50 {
            return match shared(&each, &second(2 * half)) < SHARED {
                true => Err("the position does not show how it accelerates".into()),
                false => Ok(each),
            };
        }
        half = half * 3 / 2;
    }
}

/// The share of the variance that two shapes have in common, R²; 1 where both are 0.
fn shared(one: &[f64], other: &[f64]) -> f64 {
    let product: f64 = one.iter().zip(other).map(|(a, b)| a * b).sum();
    let apart = product / one.len() as f64 / (rms(one) * rms(other));
    match apart.is_finite() {
        true => apart * apart,
        false => 1.0,
    }
}

fn third(x: &[f64]) -> f64 {
    (x[3] - x[0] + 3.0 * (x[1] - x[2])).abs()
}

/// Speed and acceleration at every sample: a parabola by least squares through as many samples on either side.
fn derivatives(record: &Record, half: usize) -> impl Iterator<Item = [f64; 2]> {
    let n = record.x.len();
    (0..n).map(move |k| {
        let (from, to) = (k.saturating_sub(half), (k + half + 1).min(n));
        parabola(record, from, to, record.t[k])
    })
}

/// The first two derivatives at `t` of the parabola through the samples `from..to`.
fn parabola(record: &Record, from: usize, to: usize, t: f64) -> [f64; 2] {
    let scale = record.t[to - 1] - record.t[from];
    let mut m = [[0.0; 4]; 3];
    for k in from..to {
        let u = (record.t[k] - t) / scale;
        let row = [1.0, u, u * u];
        for i in 0..3 {
            for j in 0..3 {
                m[i][j] += row[i] * row[j];
            }
            m[i][3] += row[i] * (record.x[k] - record.x[from]);
        }
    }
    for i in 0..3 {
        let pivot = m[i];
        for row in &mut m[i + 1..] {
            let factor = row[i] / pivot[i];
            for (cell, above) in row.iter_mut().zip(pivot) {
                *cell -= factor * above;
            }
        }
    }
    let c = m[2][3] / m[2][2];
    let b = (m[1][3] - m[1][2] * c) / m[1][1];
    [b / scale, 2.0 * c / (scale * scale)]
}
