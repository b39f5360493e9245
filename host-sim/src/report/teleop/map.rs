//! Maps of the schemes: the error of the felt force over delay and loss.

use super::words::words;
use crate::number::quantity;
use crate::report::{HeatMap, HeatScale, Section, Shaded};
use crate::teleop::measure::felt::NotCompared;
use crate::teleop::measure::stability::Rest;
use crate::teleop::{Cell, SchemeId};

/// The errors of no shade and of the darkest: what nobody feels, and the whole force.
const SHADES: [f64; 2] = [0.02, 1.0];

fn scale() -> HeatScale {
    let [from, to] = SHADES;
    let percent = |at: f64| (at, format!("{:.0} %", 100.0 * at));
    HeatScale {
        name: "Error of the felt force",
        from,
        to,
        ticks: [from, 0.05, 0.15, to].map(percent).into(),
        beyond: "does not come to rest",
    }
}

/// A map per loss and jitter of one environment.
pub(super) fn maps(cells: &[Cell]) -> Vec<HeatMap> {
    let mut channels: Vec<(f64, f64)> = Vec::new();
    for cell in cells {
        if !channels.contains(&(cell.jitter, cell.loss)) {
            channels.push((cell.jitter, cell.loss));
        }
    }
    let map = |(jitter, loss): (f64, f64)| {
        let own: Vec<&Cell> = cells
            .iter()
            .filter(|cell| (cell.jitter, cell.loss) == (jitter, loss))
            .collect();
        let mut caption = format!(
            "Loss {:.0} %, jitter {:.0} % of the delay: felt minus true force, rms over the peak, from when the scheme is ready. Unstable: on either material. Limited: a limit of the renderer is at work in more than 5 % of the contact.",
            100.0 * loss,
            100.0 * jitter
        );
        if own
            .iter()
            .any(|cell| cell.not_compared() == Some(NotCompared::NotInside))
        {
            caption += " Outside: the hand did not reach the material after the scheme was ready.";
        }
        if jitter > 0.0 {
            caption += &ages(&own);
        }
        one(&own).caption(caption)
    };
    channels.into_iter().map(map).collect()
}

/// How old what is applied is, where the delay varies.
fn ages(cells: &[&Cell]) -> String {
    let age = |reflects: bool| {
        let own = cells
            .iter()
            .filter(|cell| cell.scheme.reflects() == reflects && cell.round_trip_s > 0.0);
        let shares = own.filter_map(|cell| Some(2.0 * cell.age_s(1)? / cell.round_trip_s));
        let shares: Vec<f64> = shares.collect();
        (!shares.is_empty()).then(|| format!("{:.0} %", 100.0 * crate::stats::median(shares)))
    };
    match (age(false), age(true)) {
        (Some(other), Some(reflecting)) => format!(
            " Each message draws its own delay and the newest counts: what the master applies is {other} of the mean delay old with 1000 messages a second, {reflecting} with those of a reflection (medians)."
        ),
        _ => String::new(),
    }
}

/// A section per environment.
pub(super) fn sections(cells: &[Cell]) -> Vec<Section> {
    let mut names: Vec<&str> = cells.iter().map(|cell| cell.environment.as_str()).collect();
    names.dedup();
    let section = |name: &&str| {
        let own: Vec<Cell> = cells
            .iter()
            .filter(|cell| cell.environment == **name)
            .cloned()
            .collect();
        maps(&own)
            .into_iter()
            .fold(Section::new(format!("On {name}")), Section::heat_map)
    };
    names.iter().map(section).collect()
}

fn one(cells: &[&Cell]) -> HeatMap {
    let mut trips: Vec<f64> = cells.iter().map(|cell| cell.round_trip_s).collect();
    trips.sort_by(f64::total_cmp);
    trips.dedup();
    let heads = trips.iter().map(|trip_s| quantity(*trip_s, 2, "s"));
    let map = HeatMap::new("scheme \\ round trip", heads, scale());
    SchemeId::ALL
        .into_iter()
        .filter(|id| cells.iter().any(|cell| cell.scheme == *id))
        .fold(map, |map, id| {
            let find = |trip_s: &f64| {
                let mut own = cells.iter();
                own.find(|cell| cell.scheme == id && cell.round_trip_s == *trip_s)
            };
            map.row(
                words(id),
                trips
                    .iter()
                    .map(|trip_s| find(trip_s).map(|cell| shaded(cell)))
                    .collect(),
            )
        })
}

fn shaded(cell: &Cell) -> Shaded {
    let share = cell.median(|run| run.felt_force_rmse_share);
    let text = match share {
        Some(share) if share < 0.0995 => format!("{:.1} %", 100.0 * share),
        Some(share) if share < 10.0 => format!("{:.0} %", 100.0 * share),
        Some(_) => "> 1000 %".into(),
        None => cell.not_compared().map_or("none", NotCompared::word).into(),
    };
    let small = match (cell.rest(), cell.is_limited()) {
        (Rest::Moves, _) => "unstable",
        (Rest::CannotTell, _) => "rest not known",
        (Rest::Rests, true) => "limited",
        (Rest::Rests, false) => "",
    };
    Shaded {
        text,
        small: small.into(),
        // A scheme that puts no force out, or that keeps the hand outside, is as wrong as the whole force.
        value: (cell.rest() != Rest::Moves).then(|| share.unwrap_or(1.0)),
    }
}
