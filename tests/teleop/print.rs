//! Prints the bar of impedance reflection in teleoperation, and the table that it is read off:
//! `cargo run --release -p tests --example teleop -- 2`, where 2 is the number of seeds of each cell. Names of
//! environments after it (`-- 2 foam layered`) are a part of the table; `hand` is the operator's hand alone.

use palpate::cli::teleop::print;
use std::time::Instant;
use tests::teleop::bar::{self, Row};
use tests::teleop::hand;

fn main() {
    let (numbers, names): (Vec<String>, Vec<String>) = std::env::args()
        .skip(1)
        .partition(|text| text.parse::<u64>().is_ok());
    let seeds = numbers.first().and_then(|text| text.parse().ok());
    let seeds: u64 = seeds.unwrap_or(2);
    let asked = |name: &str| names.is_empty() || names.iter().any(|own| own == name);
    let mut grid = bar::grid(seeds, false);
    grid.environments.retain(|own| asked(&own.first.name));
    if !grid.environments.is_empty() {
        table(&grid);
    }
    if asked("hand") {
        rows(hand::hand(seeds));
    }
}

fn table(grid: &palpate::teleop::Grid) {
    let clock = Instant::now();
    let cells = bar::cells(grid, &|done, total| {
        if done % 256 == 0 {
            eprintln!("{done} of {total}");
        }
    });
    let seconds = clock.elapsed().as_secs_f64();
    println!("{}", print::table(&cells));
    let runs: usize = cells.iter().map(|cell| cell.runs.len()).sum();
    println!("{runs} runs in {seconds:.0} s\n");
    rows(bar::rows(&cells));
}

fn rows(rows: Vec<Row>) {
    for row in rows {
        let reached = if row.reached { "reached" } else { "MISSED " };
        println!("{reached}  {}\n         {}", row.asked, row.measured);
    }
}
