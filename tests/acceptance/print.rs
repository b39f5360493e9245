//! Prints the acceptance table: `cargo run --release -p tests --example acceptance -- 1000`.

// The table and its small version each use a part of it.
#[allow(dead_code)]
mod cases;
#[allow(dead_code)]
mod relaxing;

use cases::{Case, Row, SETTINGS, score};
use estimator_core::config::Method;

/// The methods side by side: name, method, whether the surface is told.
const METHODS: [(&str, Method, bool); 4] = [
    (
        "two stages, surface known",
        Method::HuntCrossleyTwoStage,
        true,
    ),
    (
        "two stages, surface from impact",
        Method::HuntCrossleyTwoStage,
        false,
    ),
    (
        "bank + refiner, surface known",
        Method::HuntCrossleyBank,
        true,
    ),
    (
        "bank + refiner, surface found",
        Method::HuntCrossleyBank,
        false,
    ),
];

fn main() {
    let argument = std::env::args().nth(1);
    let seeds: u64 = argument.and_then(|text| text.parse().ok()).unwrap_or(100);
    if std::env::args().nth(2).as_deref() == Some("relaxing") {
        return print_relaxing(seeds);
    }
    println!(
        "{seeds} seeds a setting\n{:<32} {:>6} {:>6} {:>13} {:>9} {:>16} {:>7}",
        "", "<1 %", "<5 %", "settles (s)", "surface", "coverage (%)", "false"
    );
    for (touched, stroke) in SETTINGS {
        println!("{touched:?}, {stroke:?}");
        let mut rows: Vec<Row> = METHODS.iter().map(|_| Row::default()).collect();
        for seed in 1..=seeds {
            let case = Case::new(touched, stroke, seed);
            for (row, (_, method, known)) in rows.iter_mut().zip(METHODS) {
                row.push(score(&case, method, known));
            }
        }
        for (row, (name, ..)) in rows.iter().zip(METHODS) {
            print(name, row);
        }
    }
    print_relaxing(seeds);
}

/// The materials that relax; as second argument, `relaxing` prints them alone.
fn print_relaxing(seeds: u64) {
    println!(
        "{seeds} seeds a setting\n{:<32} {:>6} {:>6} {:>13} {:>9} {:>7}  coverage, median error (%)",
        "", "<1 %", "<5 %", "settles (s)", "surface", "false"
    );
    for (touched, stroke, methods) in relaxing::SETTINGS {
        println!("{touched:?}, {stroke:?}");
        let mut rows: Vec<relaxing::Row> = methods.iter().map(|_| Default::default()).collect();
        for seed in 1..=seeds {
            let case = relaxing::Case::new(touched, stroke, seed);
            for (row, (_, method, known)) in rows.iter_mut().zip(methods) {
                row.push(relaxing::score(&case, *method, *known));
            }
        }
        for (row, (name, ..)) in rows.iter().zip(methods) {
            println!("  {name:<32} {row}");
        }
    }
}

fn print(name: &str, row: &Row) {
    let [stiffness, damping, exponent] = row.coverage().map(|share| 100.0 * share);
    println!(
        "  {name:<32} {:>5.1} {:>6.1} {:>6.2} / {:<5.2} {:>6.1} µm {stiffness:>5.0} {damping:>4.0} {exponent:>4.0} {:>7.3}",
        100.0 * row.within(0.01),
        100.0 * row.within(0.05),
        row.settles_s(0.5),
        row.settles_s(0.95),
        1e6 * row.surface_m(0.95),
        row.changed(),
    );
}
