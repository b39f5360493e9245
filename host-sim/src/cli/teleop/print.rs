//! The summary of a run and the table of a comparison, for the terminal.

use std::fmt::Write;

use crate::number::quantity;
use crate::report::teleop::verdict;
use crate::teleop::measure::felt::NotCompared;
use crate::teleop::measure::stability::Rest;
use crate::teleop::notice::notices;
use crate::teleop::{Cell, Measures, Options, SchemeId, Trace};

/// A run.
pub fn summary(options: &Options, trace: &Trace, measures: &Measures) -> String {
    let (_, badge, sentence) = verdict(options, measures);
    let [there, back] = options.channels;
    let mut text = format!("{} ({badge})\n", options.scheme.name());
    let mut line = |name: &str, value: String| {
        let _ = writeln!(text, "  {name:<12}{value}");
    };
    line("verdict", sentence);
    line(
        "channel",
        format!(
            "{} there, {} back, loss {:.0} %, jitter {:.0} %",
            quantity(there.delay_s, 3, "s"),
            quantity(back.delay_s, 3, "s"),
            100.0 * there.loss.max(back.loss),
            100.0 * there.jitter.max(back.jitter)
        ),
    );
    line("felt", felt(measures));
    line(
        "touch",
        format!("{} at first", quantity(measures.peak_touch_n, 2, "N")),
    );
    line("settled", times(measures));
    line("energy", energy(measures));
    for notice in notices(trace, measures)
        .iter()
        .filter(|notice| notice.is_noticed == Some(true))
    {
        line("noticed", notice.threshold.what.into());
    }
    if let Some([Some(stiffness), Some(damping), Some(mass)]) = measures.hand {
        line(
            "hand",
            format!(
                "{:.0} ± {:.0} N/m, {:.1} ± {:.1} N s/m, {:.2} ± {:.2} kg",
                stiffness.0, stiffness.1, damping.0, damping.1, mass.0, mass.1
            ),
        );
    }
    let packets = &measures.packets;
    line(
        "packets",
        format!(
            "{} sent, {} lost{}, {} rejected",
            packets.sent,
            packets.lost,
            by_rate(packets.lost_to_rate),
            packets.rejected
        ),
    );
    line("age", ages(measures));
    text
}

fn by_rate(lost: u64) -> String {
    match lost {
        0 => String::new(),
        lost => format!(" ({lost} of them to the limited rate)"),
    }
}

/// How old what is applied at either end is.
fn ages(measures: &Measures) -> String {
    let [slave, master] = measures
        .ages_s
        .map(|age_s| age_s.map_or("–".into(), |age_s| quantity(age_s, 2, "s")));
    format!("what the slave applies is {slave} old on average, what the master applies {master}")
}

fn energy(measures: &Measures) -> String {
    let created = match measures.coupling_energy_j > 0.0 {
        true => format!(
            "{} given out by the coupling, {} of it beyond the master's damping",
            quantity(measures.coupling_energy_j, 2, "J"),
            quantity(measures.created_energy_j, 2, "J"),
        ),
        false => "none given out beyond what was stored".into(),
    };
    let exchanged_j = quantity(measures.exchanged_energy_j, 2, "J");
    format!("{created}, {exchanged_j} exchanged and declared")
}

fn felt(measures: &Measures) -> String {
    let share =
        |value: Option<f64>| value.map_or("none".into(), |value| format!("{:.1} %", 100.0 * value));
    let force = match (
        measures.felt_force_rmse_share,
        measures.felt_force_not_compared,
    ) {
        (None, Some(why)) => why.word().into(),
        (known, _) => format!("{} off", share(known)),
    };
    format!(
        "force {force}, stiffness {}, damping {}",
        share(measures.felt_stiffness_error),
        share(measures.felt_damping_error)
    )
}

fn times(measures: &Measures) -> String {
    let time = |value: Option<f64>| value.map_or("never".into(), |value| quantity(value, 2, "s"));
    let change = match measures.changed_s {
        Some(_) => format!(", {} after the change", time(measures.resettled_s)),
        None => String::new(),
    };
    let first = match measures.settled_s {
        Some(settled_s) => format!("{} of contact and way back", quantity(settled_s, 2, "s")),
        None => "never".into(),
    };
    first + &change
}

/// How many runs of what length altogether took how long (s).
pub fn speed(runs: usize, simulated_s: f64, took_s: f64) -> String {
    let runs = match runs {
        1 => "a run".into(),
        more => format!("{more} runs"),
    };
    format!(
        "  time        {runs} of {} altogether in {}\n",
        quantity(simulated_s, 3, "s"),
        quantity(took_s, 2, "s")
    )
}

/// The comparison: a block per environment and channel, schemes over round trips.
pub fn table(cells: &[Cell]) -> String {
    let mut text = String::from(
        "felt minus true force, rms over peak, % (from when the scheme is ready); * does not come to rest on one of the \
         materials; ? cannot be told; ~ a limit of the renderer at work in more than 5 % of the contact; outside: the \
         hand did not reach the material after the scheme was ready\n",
    );
    let mut blocks: Vec<(&str, f64, f64)> = Vec::new();
    for cell in cells {
        let block = (cell.environment.as_str(), cell.jitter, cell.loss);
        if !blocks.contains(&block) {
            blocks.push(block);
        }
    }
    for (environment, jitter, loss) in blocks {
        let own: Vec<&Cell> = cells
            .iter()
            .filter(|cell| {
                (cell.environment.as_str(), cell.jitter, cell.loss) == (environment, jitter, loss)
            })
            .collect();
        let _ = writeln!(
            text,
            "\n{environment}, jitter {:.0} %, loss {:.0} %",
            100.0 * jitter,
            100.0 * loss
        );
        text += &block(&own);
    }
    text
}

fn block(cells: &[&Cell]) -> String {
    let mut trips: Vec<f64> = cells.iter().map(|cell| cell.round_trip_s).collect();
    trips.sort_by(f64::total_cmp);
    trips.dedup();
    let mut text = format!("  {:<19}", "round trip");
    for trip_s in &trips {
        let _ = write!(text, "{:>10}", quantity(*trip_s, 2, "s"));
    }
    text.push('\n');
    for id in SchemeId::ALL {
        let own: Vec<&&Cell> = cells.iter().filter(|cell| cell.scheme == id).collect();
        if own.is_empty() {
            continue;
        }
        let _ = write!(text, "  {:<19}", id.name());
        for trip_s in &trips {
            let cell = own.iter().find(|cell| cell.round_trip_s == *trip_s);
            let _ = write!(text, "{:>10}", cell.map_or("–".into(), |cell| entry(cell)));
        }
        text.push('\n');
    }
    text
}

fn entry(cell: &Cell) -> String {
    let share = cell.median(|run| run.felt_force_rmse_share);
    let number = match share {
        Some(share) if share < 10.0 => format!("{:.1}", 100.0 * share),
        Some(_) => "> 999".into(),
        None => cell.not_compared().map_or("none", NotCompared::word).into(),
    };
    let mark = match (cell.rest(), cell.is_limited()) {
        (Rest::Moves, _) => "*",
        (Rest::CannotTell, _) => "?",
        (Rest::Rests, true) => "~",
        (Rest::Rests, false) => " ",
    };
    format!("{number}{mark}")
}
