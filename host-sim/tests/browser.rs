//! Every report of every verb in a headless browser: `cargo xtask test` sets the browser up and runs this.

#[path = "common/browser.rs"]
mod browser;
mod common;

use browser::{WIDTHS, assert_good, opened};
use common::Folder;

/// The gel of the demo, as a model that knows it.
const KNOWN: &str = "[environment]\nlaw = \"hunt_crossley\"\nstiffness = 1350.0\ndamping = 36.0\n\
    exponent = 1.35\nsurface = 0.0\n";

#[test]
fn every_report_is_silent_fetches_nothing_fits_400_px_and_answers_the_pointer() {
    let folder = Folder::new();
    folder.write("known.toml", KNOWN);
    // GIVEN a report of each kind: found and not found, with and without a loop, one log and two
    folder.succeeds("demo --out demo");
    folder.succeeds("estimate demo/gel.csv --out estimate");
    folder.succeeds("estimate demo/gel.csv --method batch --out batch");
    folder.succeeds("gap --model demo/base.toml --log demo/hidden.csv --out missing");
    folder.succeeds("gap --model known.toml --log demo/gel.csv --out nothing");
    folder.succeeds("effects coulomb_friction --out effects");
    folder.succeeds("teleop --delay-ms 100 --out teleop");
    let kinds = [
        "demo", "estimate", "batch", "missing", "nothing", "effects", "teleop",
    ];
    let reports = kinds.map(|kind| (kind, folder.path(kind).join("report.html")));
    // WHEN a browser opens them as wide as a telephone, a window and a screen
    let looked = opened(&folder.path(""), &reports, &WIDTHS);
    assert_eq!(looked.len(), kinds.len() * WIDTHS.len());
    // THEN each is as it should be.
    assert_good(&looked);
    for (kind, path) in &reports {
        let size = std::fs::metadata(path).unwrap().len();
        assert!(size < 2_000_000, "{kind}: {size} bytes");
    }
    // Nothing was added there, so nothing is before or after.
    let nothing = folder.read("nothing/report.html");
    let nothing = nothing.split("<script>").next().unwrap();
    for word in ["before", "Before", "after (", ">after<"] {
        assert!(!nothing.contains(word), "{word}");
    }
}
