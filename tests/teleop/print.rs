//! Prints the bar of impedance reflection in teleoperation, and the table that it is read off:
//! `cargo run --release -p tests --example teleop -- 2`, where 2 is the number of seeds of each cell.

use palpate::cli::teleop::print;
use std::time::Instant;
use tests::teleop::{bar, hand};

fn main() {
    let argument = std::env::args().nth(1);
    let seeds: u64 = argument.and_then(|text| text.parse().ok()).unwrap_or(2);
    let grid = bar::grid(seeds, false);
    let clock = Instant::now();
    let cells = bar::cells(&grid, &|done, total| {
        if done % 256 == 0 {
            eprintln!("{done} of {total}");
        }
    });
    let seconds = clock.elapsed().as_secs_f64();
    println!("{}", print::table(&cells));
    let runs: usize = cells.iter().map(|cell| cell.runs.len()).sum();
    println!("{runs} runs in {seconds:.0} s\n");
    for row in bar::rows(&cells).into_iter().chain(hand::hand(seeds)) {
        let reached = if row.reached { "reached" } else { "MISSED " };
        println!("{reached}  {}\n         {}", row.asked, row.measured);
    }
}
