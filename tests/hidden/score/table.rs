//! The tables: a row of gap.md's bars each, within 100 columns.

use super::confusion;
use super::judge::{Mark, errors, mark};
use super::run::Scored;
use super::share::{Share, quantile};
use super::truth::CRUDE;
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// Widest line.
pub(crate) const WIDE: usize = 100;

/// Order of the rows.
pub(crate) const KINDS: [&str; 9] = [
    "single",
    "mismatched",
    "pair",
    "pair_mismatched",
    "triple",
    "weak",
    "poor",
    "none",
    "unknown",
];

/// What is in the catalogue, and shown: the rows of names.
const NAMED: [&str; 6] = [
    "single",
    "mismatched",
    "pair",
    "pair_mismatched",
    "triple",
    "weak",
];

type Runs<'a> = Vec<&'a Scored>;

impl Scored {
    /// What the answer is worth.
    pub(crate) fn mark(&self) -> Mark {
        let marked = |answer| mark(&self.truth, answer);
        self.answer.as_ref().map_or(Mark::Failed, marked)
    }

    /// Held-out RMSE after, over the true floor.
    pub(crate) fn ratio(&self) -> f64 {
        let ratio = |a: &super::answer::Answer| a.rmse_after_n / self.truth.floor_n;
        self.answer.as_ref().map_or(f64::NAN, ratio)
    }

    fn verdict(&self) -> &str {
        self.answer.as_ref().map_or("", |a| a.verdict.as_str())
    }

    fn names(&self) -> bool {
        self.answer.as_ref().is_ok_and(|a| !a.effects.is_empty())
    }
}

/// All tables; `list` every run, not only those that are not right.
pub(crate) fn text(scored: &[Scored], list: bool) -> String {
    let of = |kind: &str| -> Runs<'_> { scored.iter().filter(|s| s.truth.kind == kind).collect() };
    let parts = [
        names(&of),
        nothing(&of("none")),
        unknown(&of("unknown")),
        poor(&of("poor")),
        errors_and_times(&of),
        coverage(scored),
        confusion::text(scored),
        each(scored, list),
    ];
    let said: Vec<String> = parts.into_iter().filter(|part| !part.is_empty()).collect();
    said.join("\n")
}

fn share(of: &[&Scored], hit: impl Fn(&Scored) -> bool) -> Share {
    Share {
        hits: of.iter().filter(|one| hit(one)).count(),
        of: of.len(),
    }
}

fn count(of: &[&Scored], mark: Mark) -> usize {
    share(of, |one| one.mark() == mark).hits
}

/// Adds a line; writing to a String cannot fail.
macro_rules! line {
    ($to:expr, $($what:tt)*) => {{ let _ = writeln!($to, $($what)*); }};
}

/// A kind, and its close and crude forms by themselves where there are crude ones.
fn with_forms<'a>(kind: &'static str, runs: Runs<'a>) -> Vec<(&'static str, Runs<'a>)> {
    let (crude, close): (Runs<'_>, Runs<'_>) = runs.iter().partition(|s| s.truth.crude);
    let mut rows = vec![(kind, runs)];
    if !crude.is_empty() {
        rows.extend([("  close form", close), ("  crude form", crude)]);
    }
    rows
}

/// One, two or three effects of the catalogue.
fn names<'a>(of: &dyn Fn(&str) -> Runs<'a>) -> String {
    let mut text = format!(
        "{:<15}{:>5} {:>14} {:>14} {:>14}{:>5}{:>5}{:>5}{:>5}{:>5}{:>5}{:>5}\n",
        "named, %",
        "n",
        "alone",
        "and adequate",
        "or left open",
        "inad",
        "open",
        "part",
        "bad",
        "iffy",
        "null",
        "fail"
    );
    let mut rows = 0;
    let mut row = |kind: &str, runs: Runs<'_>| {
        if runs.is_empty() {
            return;
        }
        rows += 1;
        let one_of = |marks: &[Mark]| share(&runs, |one| marks.contains(&one.mark())).to_string();
        let _ = write!(
            text,
            "{kind:<15}{:>5} {:>14} {:>14} {:>14}",
            runs.len(),
            one_of(&[Mark::Exact, Mark::NotAdequate]),
            one_of(&[Mark::Exact]),
            one_of(&[Mark::Exact, Mark::NotAdequate, Mark::InGroup]),
        );
        let counts = [
            Mark::NotAdequate,
            Mark::InGroup,
            Mark::Incomplete,
            Mark::ConfidentWrong,
            Mark::Doubtful,
            Mark::Missed,
            Mark::Failed,
        ];
        for mark in counts {
            let _ = write!(text, "{:>5}", count(&runs, mark));
        }
        text.push('\n');
    };
    for kind in NAMED {
        for (name, runs) in with_forms(kind, of(kind)) {
            row(name, runs);
        }
    }
    if rows == 0 {
        return String::new();
    }
    line!(
        text,
        "alone: first and alone, of several all and only they, whether `missing_effects` or `unexplained`;\n\
         adequate: as `missing_effects`. open: `ambiguous`, what is there among names or alternatives; part:\n\
         some of it, nothing else; bad: a wrong name as `missing_effects`; iffy: `ambiguous` or\n\
         `unexplained` with something wrong. Best base fit at least 1.5 floors, `weak` less. Crude: the\n\
         catalogue's form leaves {CRUDE} floors and more, so that `unexplained` is the honest verdict."
    );
    text
}

/// False alarms.
fn nothing(of: &[&Scored]) -> String {
    if of.is_empty() {
        return String::new();
    }
    let mut text = format!(
        "{:<15}{:>5} {:>14} {:>14} {:>14} {:>14} {:>6}\n",
        "nothing hidden", "n", "false alarms", "at most, %", "named", "unexplained", "fail"
    );
    let mut row = |name: &str, runs: Runs<'_>| {
        if runs.is_empty() {
            return;
        }
        // A run that fails is no alarm, but no answer either.
        let alarms = share(&runs, |one| one.mark() != Mark::Exact);
        let of = |what: &dyn Fn(&Scored) -> bool| share(&runs, what).hits;
        line!(
            text,
            "{name:<15}{:>5} {:>14} {:>14.2} {:>14} {:>14} {:>6}",
            runs.len(),
            alarms.hits,
            100.0 * alarms.upper(),
            of(&|one| ["missing_effects", "ambiguous"].contains(&one.verdict())),
            of(&|one| one.verdict() == "unexplained"),
            count(&runs, Mark::Failed),
        );
    };
    row("all", of.to_vec());
    let by = |keep: &dyn Fn(&str) -> bool| -> Runs<'_> {
        of.iter()
            .copied()
            .filter(|s| keep(&s.truth.noise))
            .collect()
    };
    row("white", by(&|noise| noise == "white"));
    row("coloured", by(&|noise| !["", "white"].contains(&noise)));
    for colour in ["ar1", "pink", "hump"] {
        row(
            &format!("  {colour}"),
            by(&|noise| noise.starts_with(colour)),
        );
    }
    line!(
        text,
        "at most: the one-sided 95 % bound of Clopper and Pearson. A failed run counts as an alarm."
    );
    text
}

/// In no catalogue.
fn unknown(of: &[&Scored]) -> String {
    if of.is_empty() {
        return String::new();
    }
    let mut kinds: BTreeMap<&str, Runs<'_>> = BTreeMap::new();
    for one in of {
        kinds.entry(&one.truth.label).or_default().push(one);
    }
    let mut text = format!(
        "{:<15}{:>5} {:>16} {:>14} {:>16} {:>10} {:>6} {:>6}\n",
        "no catalogue's",
        "n",
        "unexplained, %",
        "no name, %",
        "wrong names, %",
        "ambiguous",
        "null",
        "fail"
    );
    let mut row = |name: &str, runs: &[&Scored]| {
        let says = |verdict: &str| share(runs, |one| one.verdict() == verdict);
        let silent = share(runs, |one| one.verdict() == "unexplained" && !one.names());
        line!(
            text,
            "{name:<15}{:>5} {:>16} {:>14} {:>16} {:>10} {:>6} {:>6}",
            runs.len(),
            says("unexplained").to_string(),
            silent.to_string(),
            says("missing_effects").to_string(),
            says("ambiguous").hits,
            says("no_missing_effect").hits,
            count(runs, Mark::Failed),
        );
    };
    row(&format!("{} kinds", kinds.len()), of);
    for (kind, runs) in &kinds {
        row(&format!("  {kind}"), runs);
    }
    line!(
        text,
        "wrong names: as a certainty, `missing_effects`. no name: of all, unexplained and nothing named."
    );
    text
}

/// One slow sine, and what its advice is worth.
fn poor(of: &[&Scored]) -> String {
    if of.is_empty() {
        return String::new();
    }
    let right = |one: &Scored| [Mark::Exact, Mark::InGroup].contains(&one.mark());
    let open: Runs<'_> = of
        .iter()
        .copied()
        .filter(|s| s.verdict() == "ambiguous")
        .collect();
    let sizes: Vec<f64> = open
        .iter()
        .filter_map(|s| Some(s.answer.as_ref().ok()?.group() as f64))
        .collect();
    let advised: Runs<'_> = open
        .iter()
        .copied()
        .filter(|s| s.further.is_some())
        .collect();
    let resolved = |one: &Scored| match &one.further {
        Some(Ok(answer)) => mark(&one.truth, answer) == Mark::Exact,
        _ => false,
    };
    let mut text = format!(
        "poor excitation: of {} the right name alone or the right group {} %",
        of.len(),
        share(of, right)
    );
    line!(text, "; left open {}", open.len());
    if open.is_empty() {
        return text;
    }
    line!(
        text,
        "  ids left open: median {:.0}, most {:.0}",
        quantile(&sizes, 0.5),
        quantile(&sizes, 1.0)
    );
    line!(
        text,
        "  a motion advised for {} of them; with its log as well exactly right {} % of {}",
        advised.len(),
        share(&open, resolved),
        open.len(),
    );
    for one in open.iter().filter(|one| !resolved(one)) {
        let label = match &one.further {
            None => "no motion advised".into(),
            Some(Ok(answer)) => answer.label(),
            Some(Err(error)) => error.clone(),
        };
        let said = format!("{}: {} → {label}", one.rig.display(), one.truth.label);
        text += &wrapped("  not resolved ", &said);
    }
    text
}

/// Held-out error and time, kind by kind.
fn errors_and_times<'a>(of: &dyn Fn(&str) -> Runs<'a>) -> String {
    let mut text = format!(
        "{:<15}{:>5}  {:>13}  {:>13}  {:>13}  {:>20}\n{:<15}{:>5}  {:>6} {:>6}  {:>6} {:>6}  {:>6} {:>6}  {:>6} {:>6} {:>6}\n",
        "",
        "",
        "R, named",
        "R, all",
        "CPU s",
        "wall s",
        "",
        "n",
        "median",
        "p90",
        "median",
        "p90",
        "median",
        "p90",
        "median",
        "p90",
        "most"
    );
    for (kind, runs) in KINDS
        .into_iter()
        .flat_map(|kind| with_forms(kind, of(kind)))
    {
        if runs.is_empty() {
            continue;
        }
        let ratios = |keep: &dyn Fn(&Scored) -> bool| -> Vec<f64> {
            runs.iter()
                .filter(|one| keep(one))
                .map(|one| one.ratio())
                .collect()
        };
        let named = ratios(&|one| [Mark::Exact, Mark::NotAdequate].contains(&one.mark()));
        let all = ratios(&|_| true);
        let time = |of: fn(&super::answer::Answer) -> f64| -> Vec<f64> {
            runs.iter()
                .filter_map(|s| Some(of(s.answer.as_ref().ok()?)))
                .collect()
        };
        let (cpu, wall) = (time(|a| a.cpu_s), time(|a| a.seconds));
        let shown = |values: &[f64], share: f64, decimals: usize| {
            let value = quantile(values, share);
            let text = format!("{value:.decimals$}");
            format!("{:>6}", if value.is_nan() { "–" } else { &text })
        };
        line!(
            text,
            "{kind:<15}{:>5}  {} {}  {} {}  {} {}  {} {} {}",
            runs.len(),
            shown(&named, 0.5, 3),
            shown(&named, 0.9, 3),
            shown(&all, 0.5, 3),
            shown(&all, 0.9, 3),
            shown(&cpu, 0.5, 2),
            shown(&cpu, 0.9, 2),
            shown(&wall, 0.5, 2),
            shown(&wall, 0.9, 2),
            shown(&wall, 1.0, 2),
        );
    }
    line!(
        text,
        "R: RMSE of the raw force on the held-out part, after, over the true noise floor."
    );
    text
}

/// 95 % intervals of answers that name the set in the catalogue's form.
fn coverage(scored: &[Scored]) -> String {
    let (mut added, mut base) = (Share::default(), Share::default());
    let (mut numbers, mut without) = (0, 0);
    let mut each: BTreeMap<String, Share> = BTreeMap::new();
    for one in scored {
        let Ok(answer) = &one.answer else { continue };
        let same_form = one.truth.params.len() == one.truth.effects.len();
        let shown = !["none", "poor"].contains(&one.truth.kind.as_str());
        if !same_form || !shown || one.mark() != Mark::Exact {
            continue;
        }
        let (of_added, of_base) = errors(&one.truth, answer);
        // A number without an interval, at a bound perhaps, is not covered and not in the share.
        for effect in &answer.effects {
            numbers += effect.params.len() + effect.without_error;
            without += effect.without_error;
        }
        for (name, error) in of_added {
            added.push(error.abs() <= 1.96);
            each.entry(name).or_default().push(error.abs() <= 1.96);
        }
        for (name, error) in of_base {
            base.push(error.abs() <= 1.96);
            let name = format!("base.{name}");
            each.entry(name).or_default().push(error.abs() <= 1.96);
        }
    }
    if added.of + base.of == 0 {
        return String::new();
    }
    let mut text = format!(
        "95 % intervals cover: added parameters {added} % of {}, base {base} % of {}\n",
        added.of, base.of
    );
    line!(
        text,
        "  without an interval: {without} of the {numbers} numbers of named effects"
    );
    // Lists only what is unlikely (< 5 %) for a true 95 %.
    let poor = each.iter().filter(|(_, share)| share.interval().1 < 0.95);
    let poor: Vec<String> = poor
        .map(|(name, s)| format!("{name} {}/{}", s.hits, s.of))
        .collect();
    if !poor.is_empty() {
        text += &wrapped("  too narrow: ", &poor.join(", "));
    }
    text
}

/// Every run that is not right, or every run.
fn each(scored: &[Scored], list: bool) -> String {
    let right = |one: &Scored| [Mark::Exact, Mark::InGroup].contains(&one.mark());
    let listed = scored.iter().filter(|one| list || !right(one));
    listed.map(|one| wrapped("", &story(one))).collect()
}

fn story(one: &Scored) -> String {
    let truth = &one.truth;
    let lead = format!("{} {}: {} →", one.rig.display(), truth.kind, truth.label);
    match &one.answer {
        Ok(answer) => format!(
            "{lead} {} [{:?}] R {:.3} floor {:.2} {:.1} s",
            answer.label(),
            one.mark(),
            one.ratio(),
            answer.floor_n / truth.floor_n,
            answer.seconds,
        ),
        Err(error) => format!("{lead} {error}"),
    }
}

/// Lines of [`WIDE`] columns at most, the further ones indented by four; a word that is longer has its own.
pub(crate) fn wrapped(lead: &str, text: &str) -> String {
    let mut lines = String::new();
    let mut line = lead.to_string();
    for word in text.split(' ') {
        if line.chars().count() + word.chars().count() > WIDE && !line.trim().is_empty() {
            lines += line.trim_end();
            lines.push('\n');
            line = "    ".into();
        }
        line += word;
        line.push(' ');
    }
    lines + line.trim_end() + "\n"
}
