//! Writes rigs with hidden effects, and scores `palpate gap` on them:
//! `cargo run --release -p tests --example hidden -- write DIR --cases 52 --kind single --seed 1`,
//! `cargo run --release -p tests --example hidden -- score DIR --palpate target/release/palpate`,
//! `cargo run --release -p tests --example hidden -- sweep explained.residuals --kind single --kind none --cases 26 --seed 1`.

use std::path::{Path, PathBuf};
use tests::arguments::{known, number, option};
use tests::hidden::rig::case::Case;
use tests::hidden::rig::harder::{GROUPS, Group, Rig};
use tests::hidden::rig::kind::Kind;
use tests::hidden::rig::write::Units;
use tests::hidden::score::injected::{self, Question};
use tests::hidden::score::{further, library, run, sweep, table};

const USAGE: &str = "\
hidden write DIR [--cases N] [--kind single|mismatched|pair|triple|none|unknown|poor|weak|pair_mismatched|foreign|machine|machine_mismatched] [--seed S] [--jobs J] [--brief]
             [--hand]   (one that pushes each rig once)
             [--length A] [--force B] [--time C]   (a metre, newton, second in the files' units)
hidden record RIG --motion FILE --out DIR   (the same rig under another motion, to DIR/further.csv)
hidden score DIR… [--palpate PATH] [--out OUT] [--jobs J] [--args \"…\"] [--reuse] [--list] [--richer]
hidden hard [DIR…] [--rigs N] [--only NAME[,NAME]…] [--seed S] [--out OUT] [--jobs J] [--list]
             (the library's answers to harder rigs, by group: those below DIR or, without one, N fresh ones of
             each group whose name contains a NAME)
hidden injected [--sizes 1,2,5] [--records DIR] [--only NAME[,NAME]…] [--every N] [--keep OUT]
             (effects put into measured records, of the repository and of DIR; NAME: a part of the name of a
             record or an effect; OUT gets the logs and models that are asked)
hidden sweep [NAME [DIR…]] [--cases N] [--kind K]… [--seed S] [--jobs J] [--brief] [--out OUT]
             (scores the library with the threshold NAME at -25 %, 0 and +25 %, on the rigs below DIR or, without
             one, on N rigs of each kind; a line for each threshold where NAME is all;
             without NAME: all thresholds, their defaults and reasons)";

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let done =
        known(&arguments, USAGE).and_then(|()| match arguments.first().map(String::as_str) {
            Some("write") => write(&arguments[1..]),
            Some("record") => record(&arguments[1..]),
            Some("score") => score(&arguments[1..]),
            Some("sweep") => swept(&arguments[1..]),
            Some("hard") => hard(&arguments[1..]),
            Some("injected") => inject(&arguments[1..]),
            _ => Err(USAGE.into()),
        });
    if let Err(message) = done {
        eprintln!("{message}");
        std::process::exit(2);
    }
}

fn write(arguments: &[String]) -> Result<(), String> {
    let dir = arguments
        .first()
        .filter(|a| !a.starts_with("--"))
        .ok_or(USAGE)?;
    let cases = number(arguments, "--cases", 26)?;
    let seed = number(arguments, "--seed", 1)?;
    let jobs = number(arguments, "--jobs", 2)?.max(1);
    let size = |name: &str| -> Result<f64, String> {
        let wrong = |text: &str| format!("{name} {text}: a positive number is expected");
        let text = option(arguments, name).unwrap_or("1");
        text.parse()
            .ok()
            .filter(|size: &f64| *size > 0.0)
            .ok_or_else(|| wrong(text))
    };
    let units = Units {
        length: size("--length")?,
        force: size("--force")?,
        time: size("--time")?,
        turns: false,
    };
    let kind = kind(option(arguments, "--kind").unwrap_or("single"))?;
    let brief = arguments.iter().any(|a| a == "--brief");
    let draw = if brief { Case::brief } else { Case::generate };
    let is_pushed = arguments.iter().any(|a| a == "--hand");
    let drawn = |index| {
        let mut case = draw(kind, seed, index);
        if !case.units.turns {
            case.units = units;
        }
        match is_pushed {
            true => case.pushed(),
            false => case,
        }
    };
    save_all(Path::new(dir), cases, jobs, drawn, |line| {
        println!("{line}")
    });
    Ok(())
}

/// The kind of a name.
fn kind(name: &str) -> Result<Kind, String> {
    let name = if name == "same" { "single" } else { name };
    let found = Kind::ALL.iter().find(|(_, known)| *known == name);
    Ok(found.ok_or(USAGE)?.0)
}

/// Draws and saves cases, several at a time.
fn save_all(dir: &Path, cases: u64, jobs: u64, draw: impl Fn(u64) -> Case + Sync, say: fn(&str)) {
    for_each(cases, jobs, |index| say(&save(dir, &draw(index), index)));
}

/// Does something for each index, several at a time.
fn for_each(count: u64, jobs: u64, act: impl Fn(u64) + Sync) {
    std::thread::scope(|scope| {
        for job in 0..jobs {
            let act = &act;
            scope.spawn(move || {
                (job..count).step_by(jobs as usize).for_each(act);
            });
        }
    });
}

/// Scores the library with a threshold changed, or lists the thresholds.
fn swept(arguments: &[String]) -> Result<(), String> {
    let mut words = arguments.iter().take_while(|a| !a.starts_with("--"));
    let Some(name) = words.next() else {
        print!("{}", sweep::list());
        return Ok(());
    };
    if name != "all" {
        sweep::known(name)?;
    }
    let (cases, seed) = (
        number(arguments, "--cases", 13)?,
        number(arguments, "--seed", 1)?,
    );
    let jobs = number(arguments, "--jobs", 2)?.max(1);
    let mut dirs: Vec<PathBuf> = words.map(PathBuf::from).collect();
    if dirs.is_empty() {
        let brief = arguments.iter().any(|a| a == "--brief");
        let draw = if brief { Case::brief } else { Case::generate };
        let out = Path::new(option(arguments, "--out").unwrap_or("target/hidden-sweep"));
        let after_kind = arguments.windows(2).filter(|pair| pair[0] == "--kind");
        let mut kinds: Vec<&str> = after_kind.map(|pair| pair[1].as_str()).collect();
        if kinds.is_empty() {
            kinds = sweep::KINDS.to_vec();
        }
        for name in kinds {
            let kind = kind(name)?;
            let length = if brief { "brief" } else { "whole" };
            let dir = out.join(format!("{name}-{seed}-{cases}-{length}"));
            let drawn = |index| draw(kind, seed, index);
            save_all(&dir, cases, jobs, drawn, |line| eprintln!("{line}"));
            dirs.push(dir);
        }
    }
    let rigs: Vec<PathBuf> = dirs.iter().flat_map(|dir| run::rigs(dir)).collect();
    if rigs.is_empty() {
        return Err(format!("no truth.json below the folders given\n{USAGE}"));
    }
    if name != "all" {
        print!("{}", sweep::text(name, &rigs, jobs as usize)?);
        return Ok(());
    }
    // Line by line: it takes half an hour.
    let options = palpate::gap::Options::default();
    let usual = run::each(&rigs, jobs as usize, |rig, _| library::score(rig, &options))?;
    print!("{}", sweep::heading(&usual));
    for name in sweep::names() {
        print!("{}", sweep::row(name, &usual, &rigs, jobs as usize)?);
    }
    Ok(())
}

/// Scores the library on harder rigs: on those below folders, or on fresh ones.
fn hard(arguments: &[String]) -> Result<(), String> {
    let words = arguments.iter().take_while(|a| !a.starts_with("--"));
    let mut dirs: Vec<PathBuf> = words.map(PathBuf::from).collect();
    let jobs = number(arguments, "--jobs", 1)?.max(1);
    if dirs.is_empty() {
        dirs = fresh(arguments, jobs)?;
    }
    let rigs: Vec<PathBuf> = dirs.iter().flat_map(|dir| run::rigs(dir)).collect();
    if rigs.is_empty() {
        return Err(format!("no truth.json below the folders given\n{USAGE}"));
    }
    let options = palpate::gap::Options::default();
    let jobs = jobs as usize;
    let scored = run::each(&rigs, jobs, |rig, _| library::score(rig, &options))?;
    let list = arguments.iter().any(|a| a == "--list");
    print!("{}", table::hard::text(&scored, list));
    Ok(())
}

/// Draws harder rigs of each group, and says where they are.
fn fresh(arguments: &[String], jobs: u64) -> Result<Vec<PathBuf>, String> {
    let (rigs, seed) = (
        number(arguments, "--rigs", 6)?,
        number(arguments, "--seed", 1)?,
    );
    let only = option(arguments, "--only").unwrap_or("");
    let chosen = |group: &&Group| only.split(',').any(|part| group.name.contains(part));
    let out = Path::new(option(arguments, "--out").unwrap_or("target/hidden-hard"));
    let mut dirs = Vec::new();
    for group in GROUPS.iter().filter(chosen) {
        let name = group.name.replace([' ', ',', '%', '.'], "");
        let dir = out.join(format!("{seed}-{rigs}")).join(name);
        // An hour takes minutes to draw.
        let rigs = if group.name == "an hour" {
            rigs.min(3)
        } else {
            rigs
        };
        for_each(rigs, jobs, |index| {
            let rig = Rig::draw(group, seed, index);
            let to = dir.join(format!("rig-{:03}", index + 1));
            match rig.save(&to) {
                Ok(()) => eprintln!("{} {rig}", to.display()),
                Err(error) => eprintln!("{}: {error}", to.display()),
            }
        });
        dirs.push(dir);
    }
    match dirs.is_empty() {
        true => Err(format!("--only {only}: no group has such a name")),
        false => Ok(dirs),
    }
}

/// Puts effects into measured records.
fn inject(arguments: &[String]) -> Result<(), String> {
    let sizes = option(arguments, "--sizes").unwrap_or("1,2,5");
    let size = |text: &str| {
        let size = text.parse().ok().filter(|size: &f64| *size > 0.0);
        size.ok_or_else(|| format!("--sizes {sizes}: numbers such as 1,2,5 are expected"))
    };
    let question = Question {
        sizes: sizes.split(',').map(size).collect::<Result<_, _>>()?,
        only: option(arguments, "--only").map_or(Vec::new(), |names| {
            names.split(',').map(String::from).collect()
        }),
        every: number(arguments, "--every", 1)?.max(1) as usize,
        keep: option(arguments, "--keep").map(PathBuf::from),
    };
    let mut roots = vec![Path::new(env!("CARGO_MANIFEST_DIR")).join("data")];
    if let Some(more) = option(arguments, "--records") {
        if !Path::new(more).is_dir() {
            return Err(format!(
                "--records {more}: a folder with folders of records is expected"
            ));
        }
        roots.push(more.into());
    }
    // Before the ten minutes that it takes.
    if let Some(keep) = &question.keep {
        std::fs::create_dir_all(keep).map_err(|e| format!("--keep {}: {e}", keep.display()))?;
    }
    let examined = injected::examine(&question, &roots, &|at| eprint!("\r\x1b[K{at} "));
    eprintln!();
    if examined.is_empty() {
        let only = question.only.join(",");
        return Err(format!(
            "--only {only}: no such record in the repository, or below --records"
        ));
    }
    print!("{}", table::injected::text(&examined));
    Ok(())
}

fn record(arguments: &[String]) -> Result<(), String> {
    let rig = arguments.first().ok_or(USAGE)?;
    let file = |name: &str| option(arguments, name).map(Path::new).ok_or(USAGE);
    let (motion, out) = (file("--motion")?, file("--out")?);
    let log = further::record(Path::new(rig), motion, out)?;
    println!("{}", log.display());
    Ok(())
}

fn score(arguments: &[String]) -> Result<(), String> {
    let dirs = arguments.iter().take_while(|a| !a.starts_with("--"));
    let rigs: Vec<PathBuf> = dirs.flat_map(|dir| run::rigs(Path::new(dir))).collect();
    if rigs.is_empty() {
        return Err(format!("no truth.json below the folders given\n{USAGE}"));
    }
    let flag = |name: &str| arguments.iter().any(|a| a == name);
    let options = run::Options {
        palpate: option(arguments, "--palpate")
            .unwrap_or("target/release/palpate")
            .into(),
        out: option(arguments, "--out").unwrap_or("target/hidden").into(),
        jobs: number(arguments, "--jobs", 2)? as usize,
        reuse: flag("--reuse"),
        richer: flag("--richer"),
        arguments: option(arguments, "--args")
            .unwrap_or("")
            .split_whitespace()
            .map(String::from)
            .collect(),
    };
    let scored = run::all(&rigs, &options)?;
    print!("{}", table::text(&scored, flag("--list")));
    Ok(())
}

/// Writes the files of a case, and says which.
fn save(dir: &Path, case: &Case, index: u64) -> String {
    let to: PathBuf = dir.join(format!("rig-{:03}", index + 1));
    if let Err(error) = case.save(&to) {
        eprintln!("{}: {error}", to.display());
        std::process::exit(1);
    }
    format!("{} {case}", to.display())
}
