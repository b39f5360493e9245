//! What `palpate gap` says of a log with a fault, when its model is the material that was pressed.
//!
//! A sensor or a clock that fails is no missing effect: nothing may be named. What an effect of the catalogue does is to
//! be named. Anything else, as another material, may be called unexplained, and nothing may stand for it.

use super::run::log;
use crate::faults::rig::case::Case;
use crate::faults::rig::fault::Fault;
use crate::hidden::score::answer::Answer;
use crate::hidden::score::injected::{is_left_open, stands};
use crate::hidden::score::records::parsed;
use crate::tolerance::CLOSE;
use palpate::gap::{Options, gap};
use rayon::prelude::*;
use std::fmt::Write;

/// What is right to say of a fault.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Right {
    /// That nothing is missing.
    Nothing,
    /// One of these effects.
    Effect(&'static [&'static str]),
    /// That something is not explained.
    Unexplained,
}

/// Other materials, and readings of which no line is true.
const UNEXPLAINED: [&str; 10] = [
    "swap_in_contact",
    "swap_in_air",
    "surface_drift",
    "yields",
    "power_cycle",
    "reversed_force",
    "reversed_position",
    "offset_step",
    "stuck_bit",
    "thinned_renumbered",
];

fn right(fault: &Fault) -> Right {
    match fault.name {
        "hum" => Right::Effect(&["periodic_disturbance"]),
        "skew" | "lag" => Right::Effect(&["time_delay", "force_lag"]),
        "saturated" => Right::Effect(&["force_saturation"]),
        "offset_drift" => Right::Effect(&["force_drift"]),
        "creep_fast" | "creep_slow" => Right::Effect(&["stress_relaxation"]),
        "breathing" => Right::Effect(&["surface_motion"]),
        "adhesion" => Right::Effect(&["adhesion"]),
        "compliance" => Right::Effect(&["series_compliance"]),
        "backlash" => Right::Effect(&["backlash"]),
        "stick_slip" => Right::Effect(&["coulomb_friction", "stribeck_friction", "bouc_wen"]),
        "tool_inertia" => Right::Effect(&["tool_inertia"]),
        name if UNEXPLAINED.contains(&name) => Right::Unexplained,
        _ => Right::Nothing,
    }
}

/// What an answer is worth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Worth {
    /// Nothing where nothing is missing, the effect where one is, no name else.
    Right,
    /// The effect is among what is left open, or it is too small to be seen and nothing is said.
    Open,
    /// It is called unexplained, although it is a sensor's fault or an effect of the catalogue.
    Doubtful,
    /// A name stands that is wrong.
    Wrong,
    /// The log is refused.
    Refused,
}

impl Worth {
    const ALL: [Worth; 5] = [
        Worth::Right,
        Worth::Open,
        Worth::Doubtful,
        Worth::Wrong,
        Worth::Refused,
    ];
}

/// The answer to a log, in short.
pub struct Asked {
    /// What it is worth.
    pub worth: Worth,
    /// Whether a parameter of the base is off by more than 5 % and three of its standard errors, where nothing is said
    /// to be missing.
    pub off: bool,
    /// The names, with `?`, `~` and `!` as in the table of hidden effects.
    pub label: String,
}

/// Asks the library what is missing in the material that was pressed; the model starts 15 % off it.
pub fn asked(case: &Case) -> Asked {
    let answer = answer(case);
    let Ok(answer) = answer else {
        return Asked {
            worth: Worth::Refused,
            off: false,
            label: answer.err().unwrap_or_default(),
        };
    };
    let nothing = answer.verdict == "no_missing_effect";
    Asked {
        worth: worth(right(case.fault), &answer),
        off: nothing && right(case.fault) == Right::Nothing && is_off(case, &answer),
        label: answer.label(),
    }
}

fn worth(right: Right, answer: &Answer) -> Worth {
    let ids: &[&str] = match right {
        Right::Effect(ids) => ids,
        Right::Nothing | Right::Unexplained => &[],
    };
    let mut standing = answer.effects.iter().filter(|named| stands(named));
    if standing
        .clone()
        .any(|named| !ids.contains(&named.id.as_str()))
    {
        return Worth::Wrong;
    }
    let is_named = standing.next().is_some();
    match (right, answer.verdict.as_str()) {
        (Right::Nothing, "no_missing_effect") | (Right::Unexplained, _) => Worth::Right,
        (Right::Nothing, _) => Worth::Doubtful,
        (Right::Effect(_), _) if is_named => Worth::Right,
        (Right::Effect(_), "no_missing_effect") => Worth::Open,
        (Right::Effect(ids), _) if is_left_open(ids, answer) => Worth::Open,
        (Right::Effect(_), _) => Worth::Doubtful,
    }
}

/// Where something is wrong with a scale, the numbers are of that scale.
fn is_off(case: &Case, answer: &Answer) -> bool {
    let [stiffness, damping, exponent] = case.truth(0.0);
    let truth = [
        ("stiffness", stiffness),
        ("damping", damping),
        ("exponent", exponent),
    ];
    let is_scaled = case.fault.name.starts_with("scaled") || case.fault.name == "clock_speed";
    let is_off = |(name, truth): (&str, f64)| {
        let found = answer.base.get(name);
        found.is_some_and(|(value, error)| {
            (value / truth - 1.0).abs() > CLOSE && (value - truth).abs() > 3.0 * error
        })
    };
    !is_scaled && truth.into_iter().any(is_off)
}

fn answer(case: &Case) -> Result<Answer, String> {
    let [stiffness, damping, exponent] = case.truth(0.0);
    let model = parsed(&format!(
        "[environment]\nlaw = \"hunt_crossley\"\nstiffness = {}\ndamping = {}\nexponent = {exponent}\nsurface = {}\n",
        1.15 * stiffness,
        0.85 * damping,
        case.surface_m,
    ));
    let model = model.map_err(|e| e.to_string())?;
    let uniform = log(&case.rows).uniform().map_err(|e| e.to_string())?;
    let found = gap(&model, &[uniform], &Options::default()).map_err(|e| e.to_string())?;
    Answer::of(&found, f64::NAN)
}

/// The table: a row for each fault, the three severities beside each other; with the logs that are wrong.
pub fn table(faults: &[&'static Fault], severities: &[usize], seed: u64, logs: u64) -> String {
    let mut text = format!(
        "{:<19} {:>2} {:>5} {:>6} {:>5} {:>9} {:>6} {:>8} {:>5}\n",
        "fault", "#", "logs", "right", "open", "doubtful", "wrong", "refused", "off"
    );
    let mut all: Vec<(bool, Asked)> = Vec::new();
    for fault in faults {
        for severity in severities {
            let each = (0..logs).into_par_iter();
            let cell: Vec<Asked> = each
                .map(|index| asked(&Case::new(fault, *severity, seed, index)))
                .collect();
            let counts =
                Worth::ALL.map(|worth| cell.iter().filter(|one| one.worth == worth).count());
            let [right, open, doubtful, wrong, refused] = counts;
            let off = cell.iter().filter(|one| one.off).count();
            let _ = writeln!(
                text,
                "{:<19} {severity:>2} {logs:>5} {right:>6} {open:>5} {doubtful:>9} {wrong:>6} {refused:>8} {off:>5}",
                fault.name
            );
            for (index, one) in cell.iter().enumerate() {
                if matches!(one.worth, Worth::Wrong | Worth::Doubtful) {
                    let _ = writeln!(text, "    log {index}: {}", one.label);
                }
            }
            let is_sensor = self::right(fault) == Right::Nothing;
            all.extend(cell.into_iter().map(|one| (is_sensor, one)));
        }
    }
    for (is_sensor, name) in [(true, "nothing is missing"), (false, "something is")] {
        let own = || {
            all.iter()
                .filter(|(own, _)| *own == is_sensor)
                .map(|(_, one)| one)
        };
        let share = |worth: Worth| {
            let count = own().filter(|one| one.worth == worth).count();
            100.0 * count as f64 / own().count().max(1) as f64
        };
        let _ = writeln!(
            text,
            "{name}, {} logs: right {:.1} %, open {:.1} %, doubtful {:.1} %, wrong {:.1} %, refused {:.1} %; base off {}",
            own().count(),
            share(Worth::Right),
            share(Worth::Open),
            share(Worth::Doubtful),
            share(Worth::Wrong),
            share(Worth::Refused),
            own().filter(|one| one.off).count(),
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn answer(verdict: &str, effects: &str) -> Answer {
        let text = format!(
            r#"{{"verdict": "{verdict}", "effects": {effects}, "rmse_n": {{"before": 1, "after": 0.02}}}}"#
        );
        Answer::parse(&text).unwrap_or_else(|e| panic!("{e}"))
    }

    #[test]
    fn an_answer_is_worth_what_it_names() {
        let lag = |grade: &str| format!(r#"[{{"id": "force_lag", "grade": "{grade}"}}]"#);
        let of_lag = Right::Effect(&["force_lag"]);
        for (right, verdict, effects, expected) in [
            (
                Right::Nothing,
                "no_missing_effect",
                "[]".to_string(),
                Worth::Right,
            ),
            (Right::Nothing, "unexplained", "[]".into(), Worth::Doubtful),
            (
                Right::Nothing,
                "missing_effects",
                lag("certain"),
                Worth::Wrong,
            ),
            (Right::Nothing, "ambiguous", lag("open"), Worth::Doubtful),
            (Right::Unexplained, "unexplained", "[]".into(), Worth::Right),
            (
                Right::Unexplained,
                "partly_explained",
                lag("strong"),
                Worth::Wrong,
            ),
            (of_lag, "missing_effects", lag("certain"), Worth::Right),
            (of_lag, "ambiguous", lag("open"), Worth::Open),
            (of_lag, "unexplained", "[]".into(), Worth::Doubtful),
        ] {
            let worth = worth(right, &answer(verdict, &effects));
            assert_eq!(worth, expected, "{right:?}: {verdict} {effects}");
        }
    }
}
