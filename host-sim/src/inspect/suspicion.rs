//! Columns that look exchanged, units that look wrong: what a person should look at first.

use super::refreshed::refreshed_slowly;
use crate::kind::Kind;
use crate::log::{Channel, UniformLog};
use crate::number::quantity;
use crate::stats::{highest, median, range};

/// What looks wrong in the channels of a log, each with its remedy; empty if nothing does.
pub fn suspicions(log: &UniformLog) -> Vec<String> {
    [
        still_position,
        still_force,
        swapped,
        millimetres,
        metres,
        milliseconds,
        force_sign,
        refreshed_slowly,
    ]
    .into_iter()
    .filter_map(|look| look(log))
    .collect()
}

/// The same of a rig that touches nothing: its force may fall along the way.
pub fn suspicions_without_contact(log: &UniformLog) -> Vec<String> {
    [
        still_position,
        still_force,
        millimetres,
        milliseconds,
        refreshed_slowly,
    ]
    .into_iter()
    .filter_map(|look| look(log))
    .collect()
}

fn still_position(log: &UniformLog) -> Option<String> {
    still("position", "x", &log.position_m)
}

fn still_force(log: &UniformLog) -> Option<String> {
    still("force", "f", &log.force_n)
}

fn still(name: &str, letter: &str, channel: &[f64]) -> Option<String> {
    (range(channel) == 0.0).then(|| {
        format!(
            "the {name} never changes: another column may hold it (--columns {letter}=NAME), or the \
             sensor was off"
        )
    })
}

fn swapped(log: &UniformLog) -> Option<String> {
    let remedy = log.columns().exchanged();
    Some(format!("{} ({remedy})", exchanged(log)?))
}

/// Position and force in each other's column, without the remedy.
pub(crate) fn exchanged(log: &UniformLog) -> Option<String> {
    let (travel, span) = (range(&log.position_m), range(&log.force_n));
    // A joint that nothing turns back has as little torque in a turn: only its units could tell.
    if log.kind == Some(Kind::Rotary) {
        return None;
    }
    // Stiffness below 1 N per 100 m: no contact is that soft, but x and f exchanged look like it.
    (span > 0.0 && travel > 0.1 && span < 0.01 * travel).then(|| {
        format!(
            "x spans {} and f only {}: position and force may be exchanged",
            quantity(travel, 3, "m"),
            quantity(span, 3, "N")
        )
    })
}

fn millimetres(log: &UniformLog) -> Option<String> {
    let travel = range(&log.position_m);
    let span = range(&log.force_n);
    if log.kind == Some(Kind::Rotary) {
        return degrees(log, travel);
    }
    let columns = log.columns();
    // Half a metre is more than rigs that press travel; a tenth of one is, where nothing says the unit.
    let most_m = match columns.has_no_unit(Channel::Position) {
        true => 0.1,
        false => 0.5,
    };
    (travel > most_m && span >= 0.01 * travel).then(|| {
        format!(
            "the probe travels {}: millimetres or micrometres given as metres? ({})",
            quantity(travel, 3, "m"),
            columns.option(&[(Channel::Position, 1e-3)])
        )
    })
}

/// Metres taken as millimetres by a factor that a person gave: 0.1 MN/m over the whole travel, air included, is
/// beyond what palpation presses on (steel through a load cell is 1 MN/m).
fn metres(log: &UniformLog) -> Option<String> {
    const STIFFEST: f64 = 1e5;
    let columns = log.columns();
    let (travel, span) = (range(&log.position_m), range(&log.force_n));
    let is_stiff = travel > 0.0 && span > STIFFEST * travel && log.kind != Some(Kind::Rotary);
    (is_stiff && columns.has_given_factor(Channel::Position)).then(|| {
        format!(
            "the force changes by {} over {} of travel, {} at least: is the position in metres already, or in \
             another unit than its factor says? ({})",
            quantity(span, 3, "N"),
            quantity(travel, 3, "m"),
            quantity(span / travel, 2, "N/m"),
            columns.option(&[(Channel::Position, 1e3)])
        )
    })
}

/// Degrees given as radians: more than six turns of a machine that presses or swings, whose file does not say
/// that they are radians.
fn degrees(log: &UniformLog, travel_rad: f64) -> Option<String> {
    const MOST_RAD: f64 = 40.0;
    let columns = log.columns();
    (travel_rad > MOST_RAD && !columns.is_in_radians()).then(|| {
        format!(
            "the machine turns by {}: degrees given as radians? ({})",
            quantity(travel_rad, 3, "rad"),
            columns.option(&[(Channel::Position, 0.0174533)])
        )
    })
}

fn milliseconds(log: &UniformLog) -> Option<String> {
    let period = log.period_s();
    (0.5..=100.0).contains(&period).then(|| {
        format!(
            "a sample every {}: milliseconds given as seconds? ({})",
            quantity(period, 3, "s"),
            log.columns().option(&[(Channel::Time, 1e-3)])
        )
    })
}

/// Whether the force of a machine that touches nothing drives its motion: over a whole motion a passive load takes
/// work, ∮F dx > 0, and gives less than a third of what went in and out of it.
pub(crate) fn gives_work(log: &UniformLog) -> bool {
    const SHARE: f64 = 0.3;
    let middle = median(log.force_n.iter().copied());
    let (mut work, mut moved) = (0.0, 0.0);
    for (x, f) in log.position_m.windows(2).zip(log.force_n.windows(2)) {
        let step = (0.5 * (f[0] + f[1]) - middle) * (x[1] - x[0]);
        work += step;
        moved += step.abs();
    }
    work < -SHARE * moved
}

/// The sign of the force where the probe is deepest, against where it is farthest out.
fn force_sign(log: &UniformLog) -> Option<String> {
    falls_inwards(log).map(|(out, deep)| {
        let columns = log.columns();
        let position = columns.option(&[(Channel::Position, -1.0)]);
        format!(
            "the force falls from {} to {} on the way in: its sign, or that of the position, may be \
             reversed ({} or {})",
            quantity(out, 3, "N"),
            quantity(deep, 3, "N"),
            columns.option(&[(Channel::Force, -1.0)]),
            position.trim_start_matches("--columns ")
        )
    })
}

/// The forces (N) where the probe is farthest out and where it is deepest, if they fall from one to the other.
pub(crate) fn falls_inwards(log: &UniformLog) -> Option<(f64, f64)> {
    let noise = log.force_noise_n();
    let travel = range(&log.position_m);
    let deepest = highest(log.position_m.iter().copied());
    let farthest = deepest - travel;
    let mean = |near: f64| {
        let here = log.position_m.iter().zip(&log.force_n);
        let here = here.filter(|(x, _)| (*x - near).abs() <= 0.05 * travel);
        median(here.map(|(_, f)| *f))
    };
    let (deep, out) = (mean(deepest), mean(farthest));
    let span = range(&log.force_n);
    let falls = deep < out - 0.2 * span && span > 20.0 * noise;
    (travel > 0.0 && falls).then_some((out, deep))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::Log;

    /// A 1 Hz press to 2 mm on 2 N/mm with the channels scaled.
    fn log(time: f64, position: f64, force: f64) -> UniformLog {
        let t: Vec<f64> = (0..2000).map(|i| f64::from(i) * 1e-3).collect();
        let depth = |t: &f64| 2e-3 * (1.0 - (std::f64::consts::TAU * t).cos()) - 1e-3;
        let x: Vec<f64> = t.iter().map(depth).collect();
        let f: Vec<f64> = x.iter().map(|x| force * 2000.0 * x.max(0.0)).collect();
        let t = t.iter().map(|t| t * time).collect();
        let x = x.iter().map(|x| x * position).collect();
        Log::from_channels(t, x, f).uniform().unwrap()
    }

    /// A log that was read with `--columns`.
    fn named(asked: &str, factor: f64) -> UniformLog {
        let text: String = (0..2000)
            .map(|i| {
                let t = f64::from(i) * 1e-3;
                let x = 2e-3 * (1.0 - (std::f64::consts::TAU * t).cos()) - 1e-3;
                format!("{t},{},{}\n", factor * x, 2000.0 * x.max(0.0))
            })
            .collect();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("named.csv");
        std::fs::write(&path, format!("time,position,force\n{text}")).unwrap();
        let options = crate::log::ReadOptions {
            columns: asked.parse().unwrap(),
            ..Default::default()
        };
        let log = Log::read(&path, &options).unwrap();
        log.uniform().unwrap()
    }

    #[test]
    fn units_that_a_person_gave_wrong_are_suspected_with_the_columns_of_the_file() {
        let metres = named("t=time,x=position,f=force", 1e3);
        only(&metres, "(--columns t=time,x=position*1e-3,f=force)");
        let millimetres = named("t=time,x=position*1e-3,f=force", 1.0);
        only(&millimetres, "(--columns t=time,x=position,f=force)");
        assert_eq!(
            suspicions(&named("t=time,x=position,f=force", 1.0)),
            [""; 0]
        );
    }

    #[test]
    fn angles_whose_column_says_radians_are_no_degrees() {
        let mut turns = log(1.0, 4e4, 1.0);
        turns.kind = Some(Kind::Rotary);
        assert_eq!(suspicions(&turns), [""; 0]);
        let mut stated = named("t=time,x=position,f=force", 1.0);
        assert!(!stated.columns().is_in_radians());
        stated.kind = Some(Kind::Rotary);
        stated.position_m.iter_mut().for_each(|x| *x *= 4e4);
        only(&stated, "(--columns t=time,x=position*0.0174533,f=force)");
    }

    fn only(log: &UniformLog, words: &str) {
        let found = suspicions(log);
        assert!(found.len() == 1 && found[0].contains(words), "{found:?}");
    }

    #[test]
    fn a_good_log_raises_no_suspicion() {
        assert_eq!(suspicions(&log(1.0, 1.0, 1.0)), [""; 0]);
        assert_eq!(suspicions(&log(1.0, 1e-3, 1e-6)), [""; 0]);
    }

    #[test]
    fn a_drive_whose_force_has_the_motors_sign_gives_work_and_one_that_is_dragged_takes_it() {
        let t: Vec<f64> = (0..4000).map(|i| f64::from(i) * 1e-3).collect();
        let x: Vec<f64> = t.iter().map(|t| (2.0 * t).sin()).collect();
        let drag = |sign: f64| -> UniformLog {
            let f = t
                .iter()
                .map(|t| sign * (2.0 * t).cos().signum() + 0.2 * (2.0 * t).sin());
            Log::from_channels(t.clone(), x.clone(), f.collect())
                .uniform()
                .unwrap()
        };
        assert!(gives_work(&drag(-1.0)) && !gives_work(&drag(1.0)));
        // A spring gives back what it took.
        assert!(!gives_work(&drag(0.0)));
    }

    #[test]
    fn wrong_units_signs_and_columns_are_recognised() {
        only(&log(1.0, 1000.0, 1.0), "millimetres");
        only(&log(1000.0, 1.0, 1.0), "milliseconds");
        only(&log(1.0, 1.0, -1.0), "sign");
        let mut exchanged = log(1.0, 1.0, 1.0);
        std::mem::swap(&mut exchanged.position_m, &mut exchanged.force_n);
        only(&exchanged, "exchanged");
        let mut still = log(1.0, 1.0, 1.0);
        still.position_m.fill(0.001);
        only(&still, "position never changes");
    }
}
