//! What the two tasks cost on the board itself, and what they do without.

use crate::common::{pressing, within_the_model};
use f405::bench::{analog, spi};
use f405::calls::reached;
use f405::chip::Part;
use f405::report::Report;
use f405::world::Material;

/// The numbers of the exceptions of the sampling task with analog sensors, DMA2 stream 0, and of telemetry.
const SAMPLE: u32 = 16 + 56;
const TELEMETRY: u32 = 16 + 19;

/// The bars, in instructions without compensation: of a tick in the mean and at most, and of telemetry a tick.
const SAMPLE_MEAN: u64 = 5_500;
const SAMPLE_MOST: u64 = 17_000;
const TELEMETRY_MEAN: u64 = 4_000;

#[test]
fn a_tick_and_its_telemetry_cost_what_the_bars_allow() {
    let mut report = Report::new("cost, in instructions");
    for (name, material) in [("gel", Material::GEL), ("plastic", Material::PLASTIC)] {
        let mut bench = pressing(analog(), Part::default(), material, 1);
        bench.run(12.0);
        within_the_model(&bench);
        let costs = &bench.machine.chip.trace.costs;
        let (sample, telemetry) = (costs[&SAMPLE], costs[&TELEMETRY]);
        let mean = sample.instructions / sample.count;
        let sending = telemetry.own / sample.count;
        report.row(
            format!("{name}: sampling task"),
            format!(
                "{mean} mean, {} at most, {:.0} µs at most",
                sample.most,
                sample.longest_s * 1e6
            ),
        );
        report.row(format!("{name}: telemetry, a tick"), sending);
        assert!(mean <= SAMPLE_MEAN, "{mean}");
        assert!(sample.most <= SAMPLE_MOST, "{}", sample.most);
        assert!(sending <= TELEMETRY_MEAN, "{sending}");
    }
}

/// The helpers of a compiler for numbers that the core has no instructions for: double precision, and `u64` as a
/// float, or divided.
fn in_software(name: &str) -> bool {
    let Some(helper) = name.strip_prefix("__aeabi_") else {
        return false;
    };
    let doubles = helper.starts_with('d') || helper.ends_with("2d");
    doubles
        || matches!(
            helper,
            "ul2f" | "l2f" | "f2ulz" | "f2lz" | "uldivmod" | "ldivmod"
        )
}

// Before the repair: 186 of 5164 instructions.
#[test]
fn the_sampling_task_has_no_arithmetic_in_software() {
    for (name, image, task) in [("analog", analog(), "TICK"), ("spi", spi(), "TICK")] {
        let helpers = |from: &str| {
            let all = reached(&image, from).unwrap_or_else(|| panic!("{name}: no {from}"));
            let helpers = all.into_iter().filter(|(called, _)| in_software(called));
            helpers.collect::<Vec<_>>()
        };
        assert_eq!(helpers(task), [], "{name}");
        // The start has some, so a helper of that name would have been found.
        assert!(helpers("main").len() > 3, "{name}");
    }
}
