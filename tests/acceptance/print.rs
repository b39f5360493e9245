//! Prints the acceptance table: `cargo run --release -p tests --example acceptance -- 1000`, where 1000 is
//! the number of seeds in each setting.

use estimator_core::estimate::method::Method;
use tests::acceptance::cases::{Case, SETTINGS, Touched};
use tests::acceptance::rows::{Skew, Swap};
use tests::acceptance::score::{Row, score};
use tests::acceptance::{relaxing, rows};
use tests::quantile::quantile;
use tests::tolerance::{CLOSE, STRICT};

/// The methods side by side: name, method, whether the surface is known.
const METHODS: [(&str, Method, bool); 6] = [
    (
        "two stages, surface known",
        Method::HUNT_CROSSLEY_TWO_STAGE,
        true,
    ),
    (
        "two stages, surface from impact",
        Method::HUNT_CROSSLEY_TWO_STAGE,
        false,
    ),
    (
        "log-linear, surface known",
        Method::HUNT_CROSSLEY_LOG_LINEAR,
        true,
    ),
    (
        "log-linear, surface from impact",
        Method::HUNT_CROSSLEY_LOG_LINEAR,
        false,
    ),
    (
        "bank + refiner, surface known",
        Method::HUNT_CROSSLEY_BANK,
        true,
    ),
    (
        "bank + refiner, surface found",
        Method::HUNT_CROSSLEY_BANK,
        false,
    ),
];

/// The methods that find the surface by themselves.
const BLIND: [(&str, Method); 3] = [
    ("two stages", Method::HUNT_CROSSLEY_TWO_STAGE),
    ("log-linear", Method::HUNT_CROSSLEY_LOG_LINEAR),
    ("bank + refiner", Method::HUNT_CROSSLEY_BANK),
];

/// Ten minutes (s).
const TEN_MINUTES: f64 = 600.0;
/// An hour (s).
const AN_HOUR: f64 = 3600.0;

fn main() {
    let argument = std::env::args().nth(1);
    let seeds: u64 = argument.and_then(|text| text.parse().ok()).unwrap_or(100);
    if std::env::args().nth(2).as_deref() == Some("relaxing") {
        return print_relaxing(seeds, &std::env::args().nth(3).unwrap_or_default());
    }
    palpations(seeds);
    skews(seeds);
    swaps(seeds);
    for touched in [Touched::Gel, Touched::Plastic] {
        let flags = rows::false_flags(touched, AN_HOUR, 1);
        println!("an hour of palpation, {touched:?}: {flags} false flags");
    }
    for touched in [Touched::Gel, Touched::Plastic] {
        let (moved, grew) = rows::hold(touched, TEN_MINUTES, 1);
        println!(
            "ten-minute hold, {touched:?}: K, λ, n move {:.3} %, standard errors grow {grew:.2} times",
            100.0 * moved
        );
    }
    for touched in [Touched::Gel, Touched::Plastic] {
        let apart = rows::single_against_double(touched, TEN_MINUTES, 1);
        println!(
            "f32 against f64 after ten minutes, {touched:?}: {:.1e} %",
            100.0 * apart
        );
    }
    let row = rows::at_noise(0.1, seeds);
    println!(
        "noise 0.1 N, all settings, surface found: {:.1} ({:.1}) % within 5 %",
        100.0 * row.within(CLOSE),
        100.0 * row.floor_within(CLOSE)
    );
    for (name, method) in BLIND {
        let runs: Vec<[f64; 3]> = (1..=seeds).map(|seed| rows::armcmc(method, seed)).collect();
        let [k, b, n] = [0, 1, 2].map(|slot| 100.0 * quantile(runs.iter().map(|e| e[slot]), 0.5));
        println!(
            "ARMCMC's setting, {name:<15} K {k:.2} B {b:.2} n {n:.2} % (median; published 11.9, 12.5, 10.8)"
        );
    }
}

fn palpations(seeds: u64) {
    println!(
        "{seeds} seeds a setting; (…): an estimator at the Cramér–Rao bound\n{:<32} {:>13} {:>6} {:>25} {:>9} {:>16} {:>21} {:>6}",
        "", "<1 %", "<5 %", "settles (s)", "surface", "coverage (%)", "rms error / bound", "false"
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
    print_relaxing(seeds, "");
}

/// Prints the rows of the materials that relax, of the settings whose name contains `wanted`; with the second argument
/// `relaxing` nothing else is printed, and the third is what is wanted ("TwoModes, Sine").
fn print_relaxing(seeds: u64, wanted: &str) {
    println!(
        "{seeds} seeds a setting\n{:<32} {:>6} {:>6} {:>13} {:>9} {:>7}  coverage, median error (%)",
        "", "<1 %", "<5 %", "settles (s)", "surface", "false"
    );
    for (touched, stroke, methods) in relaxing::SETTINGS {
        let setting = format!("{touched:?}, {stroke:?}");
        if !setting.contains(wanted) {
            continue;
        }
        println!("{setting}");
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
    let ratios: Vec<String> = row
        .over_floor()
        .iter()
        .map(|r| format!("{r:>4.1}"))
        .collect();
    println!(
        "  {name:<32} {:>5.1} ({:>5.1}) {:>6.1} {:>5.2} / {:<5.2}({:.2} / {:.2}) {:>6.1} µm {stiffness:>5.0} {damping:>4.0} {exponent:>4.0} {:>21} {:>7.3}",
        100.0 * row.within(STRICT),
        100.0 * row.floor_within(STRICT),
        100.0 * row.within(CLOSE),
        row.settles_s(0.5),
        row.settles_s(0.95),
        row.floor_settles_s(0.5),
        row.floor_settles_s(0.95),
        1e6 * row.surface_m(0.95),
        ratios.join(" "),
        row.changed(),
    );
}

fn skews(seeds: u64) {
    let methods = [
        ("skew not asked for", Method::HUNT_CROSSLEY_BANK),
        ("skew estimated", Method::HUNT_CROSSLEY_BANK_SKEW),
    ];
    for (name, method) in methods {
        let skew = Skew::of(method, seeds);
        let ((median, _), (damping, skew_s)) = (skew.errors(0.5), skew.errors(0.95));
        println!(
            "skew of ±2 ms on plastic, {name}: λ {:.2} / {:.2} %, skew {:.0} µs (median / 95 %, 95 %), rms error of λ {:.1} bounds",
            100.0 * median,
            100.0 * damping,
            1e6 * skew_s,
            skew.over_floor()
        );
    }
}

fn swaps(seeds: u64) {
    for (name, method) in BLIND {
        let swaps: Vec<Swap> = (1..=seeds).map(|seed| Swap::of(method, seed)).collect();
        let settles = |share| quantile(swaps.iter().map(|swap| swap.settles_s), share);
        let once = swaps.iter().filter(|swap| swap.flags == [0, 1]).count();
        println!(
            "material swap, {name}: settles {:.2} / {:.2} s, flagged once and only then {:.1} %",
            settles(0.5),
            settles(0.95),
            100.0 * once as f64 / swaps.len() as f64
        );
    }
}
