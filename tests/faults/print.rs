//! Prints the fault table, or writes single logs of it:
//! `cargo run --release -p tests --example faults -- table --logs 24`,
//! `cargo run --release -p tests --example faults -- gap --logs 3`,
//! `cargo run --release -p tests --example faults -- write DIR --fault skew --severity 1`.

use std::io::{IsTerminal, Write};
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use tests::arguments::{known, number, option};
use tests::faults::rig::case::Case;
use tests::faults::rig::fault::{self, Fault};
use tests::faults::score::cell::Cell;
use tests::faults::score::gap;
use tests::faults::score::judge::Look;
use tests::faults::score::table;

const USAGE: &str = "\
faults table [--logs N] [--seed S] [--fault NAME[,NAME…]] [--severity 0|1|2] [--list]
             (N logs a cell, 100 unless given; --list names each log that is wrong or recovers late)
faults gap [--logs N] [--seed S] [--fault NAME[,NAME…]] [--severity 0|1|2]
             (what `palpate gap` says of N logs a cell, 3 unless given; each that is wrong or in doubt is named)
faults write DIR [--logs N] [--log INDEX] [--seed S] [--fault NAME[,NAME…]] [--severity 0|1|2]
             (NAME.csv and NAME.json of the first N logs of each cell, 1 unless given, or of one)
faults list  (the faults, with their severities)";

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let done =
        known(&arguments, USAGE).and_then(|()| match arguments.first().map(String::as_str) {
            Some("table") => print(&arguments[1..]),
            Some("gap") => print_gap(&arguments[1..]),
            Some("write") => write(&arguments[1..]),
            Some("list") => list(),
            _ => Err(USAGE.into()),
        });
    if let Err(message) = done {
        eprintln!("{message}");
        std::process::exit(2);
    }
}

fn faults(arguments: &[String]) -> Result<Vec<&'static Fault>, String> {
    let Some(names) = option(arguments, "--fault") else {
        return Ok(fault::all().collect());
    };
    let named = |name: &str| {
        fault::named(name)
            .ok_or_else(|| format!("--fault {name}: no such fault; `faults list` names all"))
    };
    names.split(',').map(named).collect()
}

fn severities(arguments: &[String]) -> Result<Vec<usize>, String> {
    Ok(match option(arguments, "--severity") {
        None => vec![0, 1, 2],
        Some(_) => match number(arguments, "--severity", 0)? {
            one @ 0..=2 => vec![one as usize],
            other => return Err(format!("--severity {other}: 0, 1 or 2 is expected")),
        },
    })
}

fn list() -> Result<(), String> {
    for fault in fault::all() {
        println!("{:<20} {}", fault.name, fault.severities);
    }
    Ok(())
}

fn write(arguments: &[String]) -> Result<(), String> {
    let named = |a: &&String| !a.starts_with("--");
    let folder = Path::new(arguments.first().filter(named).ok_or(USAGE)?);
    let seed = number(arguments, "--seed", 1)?;
    let indices = match option(arguments, "--log") {
        Some(_) => {
            let one = number(arguments, "--log", 0)?;
            one..one + 1
        }
        None => 0..number(arguments, "--logs", 1)?,
    };
    for fault in faults(arguments)? {
        for severity in severities(arguments)? {
            for index in indices.clone() {
                let saved = Case::new(fault, severity, seed, index).save(folder);
                let path = saved.map_err(|e| format!("{}: {e}", folder.display()))?;
                println!("{}", path.display());
            }
        }
    }
    Ok(())
}

fn print_gap(arguments: &[String]) -> Result<(), String> {
    let (faults, severities) = (faults(arguments)?, severities(arguments)?);
    let (seed, logs) = (
        number(arguments, "--seed", 1)?,
        number(arguments, "--logs", 3)?,
    );
    print!("{}", gap::table(&faults, &severities, seed, logs));
    Ok(())
}

fn print(arguments: &[String]) -> Result<(), String> {
    let (faults, severities) = (faults(arguments)?, severities(arguments)?);
    let logs = number(arguments, "--logs", 100)?;
    let seed = number(arguments, "--seed", 1)?;
    let list = arguments.iter().any(|a| a == "--list");
    let all = faults.len() * severities.len() * logs as usize;
    let (count, shown) = (AtomicUsize::new(0), std::io::stderr().is_terminal());
    let done = || {
        let number = count.fetch_add(1, Ordering::Relaxed) + 1;
        if shown && number.is_multiple_of(10) {
            eprint!("\r{number} of {all} logs ");
        }
    };
    print!("{}", table::head());
    let mut cells = Vec::new();
    for fault in faults {
        for severity in &severities {
            let cell = Cell::run(fault, *severity, seed, logs, Look::Everywhere, done);
            print!("{}", table::row(&cell));
            if list {
                print!("{}{}", table::wrong_logs(&cell), table::late_logs(&cell));
            }
            let _ = std::io::stdout().flush();
            cells.push(cell);
        }
    }
    print!("\n{}", table::summary(&cells));
    Ok(())
}
