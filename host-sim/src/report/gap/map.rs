//! Maps of depth and speed that show where the residuals exceed what is allowed.

use super::bins::LogCurves;
use crate::number::quantity;
use crate::report::{HeatMap, HeatScale, Shaded};

/// The number of rows in contact, or of the whole travel where nothing is touched; each covers the same range.
const PLACES: usize = 5;
const COLUMNS: [&str; 5] = ["out, fast", "out, slow", "still", "in, slow", "in, fast"];
/// The same where nothing is touched.
const WAYS: [&str; 5] = [
    "back, fast",
    "back, slow",
    "still",
    "forward, slow",
    "forward, fast",
];
/// A cell is shown if it has at least this many samples.
const FEWEST: f64 = 20.0;
/// The ratios of no shade and of the darkest.
const SHADES: [f64; 2] = [1.0, 30.0];

#[derive(Clone, Copy, Default)]
struct Tally {
    /// Σ r²/σ².
    ratio: f64,
    /// Σ (r² − σ²) (N²).
    excess_n2: f64,
    /// Samples.
    count: f64,
}

/// The maps of the base model and of the model with the effects.
pub(super) fn maps(log: &LogCurves<'_>) -> Vec<HeatMap> {
    let (before, after) = (tally(log, &log.before_n), tally(log, &log.after_n));
    let all: f64 = before
        .iter()
        .flatten()
        .map(|tally| tally.excess_n2.max(0.0))
        .sum();
    let what = format!(
        "residual (rms) over what is allowed; small: share of the excess. Fast: above {}",
        quantity(log.typical_mps, 2, "m/s")
    );
    let first = if log.changed { "Before" } else { "Base model" };
    let mut maps = vec![map(log, &before, all).caption(format!("{first}: {what}"))];
    if log.changed {
        let caption = "After: the same on the same scale; the shares are of the excess before";
        maps.push(map(log, &after, all).caption(caption));
    }
    maps
}

fn tally(log: &LogCurves<'_>, residuals: &[f64]) -> Vec<[Tally; COLUMNS.len()]> {
    let curves = log.curves;
    let mut tallies = vec![[Tally::default(); COLUMNS.len()]; PLACES + 1];
    let (contact, place) = (log.touches(), log.place());
    let width_m = (place.to_m - place.from_m).max(f64::MIN_POSITIVE);
    for (at, residual) in residuals.iter().enumerate().filter(|(_, r)| r.is_finite()) {
        let within_m = place.each_m[at] - place.from_m;
        let row = match contact && within_m <= 0.0 {
            true => 0,
            false => 1 + ((PLACES as f64 * within_m / width_m) as usize).min(PLACES - 1),
        };
        let fast = curves.speed_mps[at].abs() > log.typical_mps;
        let column = match (log.direction(at), fast) {
            (-1, true) => 0,
            (-1, false) => 1,
            (0, _) => 2,
            (_, false) => 3,
            (_, true) => 4,
        };
        let (tally, allowed_n2) = (&mut tallies[row][column], curves.allowed_n[at].powi(2));
        tally.ratio += residual * residual / allowed_n2;
        tally.excess_n2 += residual * residual - allowed_n2;
        tally.count += 1.0;
    }
    tallies
}

fn map(log: &LogCurves<'_>, tallies: &[[Tally; COLUMNS.len()]], all_n2: f64) -> HeatMap {
    let filled = tallies
        .iter()
        .enumerate()
        .filter(|(_, row)| row.iter().any(|tally| tally.count >= FEWEST));
    filled.fold(
        HeatMap::new(
            format!("{} \\ motion", log.place().name),
            columns(log),
            scale(),
        ),
        |map, (at, row)| {
            let cells = row.iter().map(|tally| cell(tally, all_n2)).collect();
            map.row(row_name(at, log), cells)
        },
    )
}

fn scale() -> HeatScale {
    let [from, to] = SHADES;
    HeatScale {
        name: "Residual over what is allowed",
        from,
        to,
        ticks: [from, 3.0, 10.0, to]
            .map(|at| (at, format!("{at} ×")))
            .into(),
        beyond: "",
    }
}

fn columns(log: &LogCurves<'_>) -> [&'static str; 5] {
    match log.touches() {
        true => COLUMNS,
        false => WAYS,
    }
}

/// The name of a row: free air, or its lower end.
fn row_name(row: usize, log: &LogCurves<'_>) -> String {
    let place = log.place();
    let width_m = place.to_m - place.from_m;
    let end = |at: usize| place.from_m + at as f64 / PLACES as f64 * width_m;
    match row {
        0 => "free air".into(),
        1 => format!("to {}", quantity(end(1), 2, "m")),
        row => format!("to {}", quantity(end(row), 3, "m")),
    }
}

fn cell(tally: &Tally, all_n2: f64) -> Option<Shaded> {
    if tally.count < FEWEST {
        return None;
    }
    let times = (tally.ratio / tally.count).sqrt();
    let share = tally.excess_n2 / all_n2.max(f64::MIN_POSITIVE);
    Some(Shaded {
        text: if times < 10.0 {
            format!("{times:.2} ×")
        } else {
            format!("{times:.0} ×")
        },
        small: if share >= 0.005 {
            format!("{:.0} %", 100.0 * share)
        } else {
            String::new()
        },
        value: Some(times),
    })
}
