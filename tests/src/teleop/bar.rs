//! The bar: each row is something that impedance reflection has to reach, with what it reached.

use palpate::teleop::environment::{Environment, Material};
use palpate::teleop::measure::stability::Rest;
use palpate::teleop::{Cell, Grid, Measures, Options, SchemeId, System, compare, measure};

use crate::quantile::quantile;
use crate::tolerance;

/// A row of the bar.
#[derive(Clone, Debug)]
pub struct Row {
    /// What is asked for.
    pub asked: String,
    /// What was measured.
    pub measured: String,
    /// Whether it is reached.
    pub reached: bool,
}

/// The materials of the bar, by their first one, and the bound of the felt force.
const MATERIALS: [(&str, f64); 3] = [
    ("gel", tolerance::FELT),
    ("plastic", tolerance::FELT),
    ("foam", tolerance::FELT_RELAXING),
];

fn of<'a>(
    cells: &'a [Cell],
    scheme: SchemeId,
    environment: &'a str,
) -> impl Iterator<Item = &'a Cell> {
    let own = move |cell: &&Cell| cell.scheme == scheme && cell.environment == environment;
    cells.iter().filter(own)
}

/// The felt force on each material: the worst cell's median over its seeds.
pub fn felt(cells: &[Cell]) -> Vec<Row> {
    let rows = MATERIALS.iter().map(|(name, bound)| {
        let cells: Vec<&Cell> = of(cells, SchemeId::Reflection, name).collect();
        let shares: Vec<f64> = cells
            .iter()
            .map(|cell| {
                cell.median(|run| run.felt_force_rmse_share)
                    .unwrap_or(f64::INFINITY)
            })
            .collect();
        let within = shares.iter().filter(|share| **share <= *bound).count();
        Row {
            asked: format!(
                "felt force on {name} within {:.0} % in every cell",
                100.0 * bound
            ),
            measured: format!(
                "{within} of {} cells; median {:.2} %, worst {:.2} %",
                shares.len(),
                100.0 * quantile(&shares, 0.5),
                100.0 * quantile(&shares, 1.0)
            ),
            reached: within == shares.len(),
        }
    });
    rows.collect()
}

/// The time after a change of the material, besides the way back.
pub fn resettled(cells: &[Cell]) -> Vec<Row> {
    let names = ["gel", "plastic"].into_iter();
    let there = names.filter(|name| of(cells, SchemeId::Reflection, name).next().is_some());
    let rows = there.map(|name| {
        let cells = of(cells, SchemeId::Reflection, name);
        let times: Vec<f64> = cells
            .flat_map(|cell| {
                let back_s = 0.5 * cell.round_trip_s;
                let runs = cell.runs.iter();
                runs.map(move |run| run.resettled_s.map_or(f64::INFINITY, |at_s| at_s - back_s))
            })
            .collect();
        let (median, slow) = (quantile(&times, 0.5), quantile(&times, 0.95));
        let (most, slowest) = tolerance::RESETTLES_S;
        Row {
            asked: format!(
                "from {name} to another: felt again after {most} s of contact, 95 % {slowest} s"
            ),
            measured: format!("{median:.2} s, 95 % {slow:.2} s, of {} runs", times.len()),
            reached: median <= most && slow <= slowest,
        }
    });
    rows.collect()
}

/// The energy that is created beyond what exchanges declare.
pub fn energy(cells: &[Cell]) -> Row {
    let own = cells
        .iter()
        .filter(|cell| cell.scheme == SchemeId::Reflection);
    let runs: Vec<&Measures> = own.flat_map(|cell| &cell.runs).collect();
    let most = |value: fn(&Measures) -> f64| runs.iter().map(|run| value(run)).fold(0.0, f64::max);
    let created_j = most(|run| run.created_energy_j);
    Row {
        asked: "no energy created beyond V_new − V_old of exchanged impedances".into(),
        measured: format!(
            "at most {:.2} mJ created, at most {:.0} mJ exchanged and declared, {} runs",
            1e3 * created_j,
            1e3 * most(|run| run.exchanged_energy_j),
            runs.len()
        ),
        // A thousandth of what a palpation moves.
        reached: created_j < 1e-4,
    }
}

/// The force of the first touch against position–force without delay.
pub fn touch(cells: &[Cell]) -> Vec<Row> {
    let names = ["gel", "plastic", "foam", "layered"].into_iter();
    let rows = names.filter_map(|name| {
        let direct = of(cells, SchemeId::PositionForce, name)
            .find(|cell| cell.round_trip_s == 0.0)?
            .median(|run| Some(run.peak_touch_n))?;
        let own = of(cells, SchemeId::Reflection, name);
        let most = own
            .flat_map(|cell| cell.runs.iter().map(|run| run.peak_touch_n))
            .fold(0.0, f64::max);
        Some(Row {
            asked: format!(
                "first touch of {name}: at most the force of position–force without delay"
            ),
            measured: format!("at most {most:.1} N for {direct:.1} N"),
            reached: most <= direct,
        })
    });
    rows.collect()
}

/// Where reflection is ahead of every other scheme in felt force.
pub fn ahead(cells: &[Cell]) -> Vec<Row> {
    // One that comes to rest only after the press counts with its force.
    let share = |cell: &Cell| match cell.rest() {
        Rest::Moves => f64::INFINITY,
        Rest::Rests | Rest::CannotTell => cell
            .median(|run| run.felt_force_rmse_share)
            .unwrap_or(f64::INFINITY),
    };
    let others = |own: &Cell| {
        let same = |cell: &&Cell| {
            !cell.scheme.reflects()
                && cell.environment == own.environment
                && (cell.round_trip_s, cell.jitter, cell.loss)
                    == (own.round_trip_s, own.jitter, own.loss)
        };
        let best = cells
            .iter()
            .filter(same)
            .min_by(|a, b| share(a).total_cmp(&share(b)));
        best.map(|cell| (share(cell), cell.scheme.name()))
    };
    let parts = [(true, "from 30 ms on"), (false, "below 30 ms")].map(|(late, name)| {
        let own = cells.iter().filter(|cell| {
            cell.scheme == SchemeId::Reflection && (cell.round_trip_s >= 0.0299) == late
        });
        let (mut ahead, mut all, mut behind) = (0, 0, Vec::new());
        for cell in own {
            let Some((best, scheme)) = others(cell) else {
                continue;
            };
            all += 1;
            if share(cell) < best {
                ahead += 1;
            } else {
                let trip_ms = 1e3 * cell.round_trip_s;
                behind.push(format!("{} {trip_ms} ms {scheme}", cell.environment));
            }
        }
        behind.dedup();
        let behind = match behind.is_empty() {
            true => String::new(),
            false => format!("; behind: {}", behind.join(", ")),
        };
        Row {
            asked: format!("ahead of every other scheme in felt force, {name}"),
            measured: format!("{ahead} of {all} cells{behind}"),
            reached: ahead == all || !late,
        }
    });
    parts.into()
}

/// Whether reflecting the operator's impedance as well helps.
pub fn both_sides(cells: &[Cell]) -> Row {
    let median = |id: SchemeId, value: fn(&Measures) -> Option<f64>| {
        let own = cells.iter().filter(|cell| cell.scheme == id);
        let values: Vec<f64> = own
            .flat_map(|cell| cell.runs.iter().filter_map(value))
            .collect();
        quantile(&values, 0.5)
    };
    let (one, both) = (SchemeId::Reflection, SchemeId::ReflectionBoth);
    let pair = |value: fn(&Measures) -> Option<f64>| (median(one, value), median(both, value));
    let felt = pair(|run| run.felt_force_rmse_share);
    let change = pair(|run| run.peak_change_n);
    let behind = pair(|run| Some(run.position_rmse_m));
    Row {
        asked: "whether the operator's impedance at the slave helps is measured".into(),
        measured: format!(
            "medians one-sided and two-sided: felt {:.1}, {:.1} %; peak at a change {:.1}, {:.1} N; slave off \
             master {:.1}, {:.1} mm",
            100.0 * felt.0,
            100.0 * felt.1,
            change.0,
            change.1,
            1e3 * behind.0,
            1e3 * behind.1
        ),
        reached: true,
    }
}

/// Packets and bytes a second.
pub fn packets(cells: &[Cell]) -> Row {
    let own = cells
        .iter()
        .filter(|cell| cell.scheme == SchemeId::Reflection);
    let most = own
        .flat_map(|cell| cell.runs.iter().map(|run| run.packets.bytes_per_s))
        .max();
    let most = most.unwrap_or(0);
    Row {
        asked: "at most 100 packets a second of at most 72 bytes".into(),
        measured: format!("{most} bytes a second the busier way"),
        reached: most <= 7200,
    }
}

/// Every packet lost for two seconds in the midst of a press.
pub fn outage() -> Row {
    let mut options = Options::default()
        .with_channel(0.05, 0.0, 0.0)
        .with_task_for_delay();
    options.environment = Environment::throughout(Material::gel());
    for channel in &mut options.channels {
        channel.outage_s = Some((5.0, 7.0));
    }
    let trace = System::new(&options, 1).run();
    let rendering = options.reflection.rendering;
    // The delay, the timeout and the fading, and a tick.
    let faded_s = 5.0 + 0.05 + rendering.timeout_s + rendering.fade_s + 2e-3;
    let dark = trace.between(faded_s, 7.0);
    let silent = dark.iter().all(|row| row.command_n == 0.0);
    let flagged = dark.iter().all(|row| row.faults != 0);
    let created_j = measure(&trace).created_energy_j;
    let back = trace.between(8.0, 9.0).iter().any(|row| row.felt_n > 1.0);
    Row {
        asked: "every packet lost for 2 s: faded out, flagged, passive, and back afterwards".into(),
        measured: format!(
            "force 0 N: {silent}, flagged: {flagged}, created {:.2} mJ, back: {back}",
            1e3 * created_j
        ),
        reached: silent && flagged && back && created_j < 1e-4,
    }
}

/// The grid of the bar: the whole table, or a small one.
pub fn grid(seeds: u64, small: bool) -> Grid {
    let mut grid = Grid::table(Options::default(), seeds);
    if small {
        grid.environments.truncate(2);
        grid.round_trips_s = vec![0.0, 0.3];
        grid.jitters = vec![0.3];
        grid.losses = vec![0.2];
    }
    grid
}

/// All rows of a grid.
pub fn rows(cells: &[Cell]) -> Vec<Row> {
    let mut rows = felt(cells);
    rows.retain(|row| !row.measured.starts_with("0 of 0"));
    rows.extend(resettled(cells));
    rows.push(energy(cells));
    rows.extend(touch(cells));
    rows.extend(ahead(cells));
    rows.push(both_sides(cells));
    rows.push(packets(cells));
    rows.push(outage());
    rows
}

/// Runs a grid.
pub fn cells(grid: &Grid, progress: &(dyn Fn(usize, usize) + Sync)) -> Vec<Cell> {
    compare(grid, progress)
}
