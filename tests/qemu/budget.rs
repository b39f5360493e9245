//! What the firmware may cost: tests/budget.toml.

use std::fs;
use std::ops::RangeInclusive;
use std::sync::LazyLock;
use tests::emulator::Meter;

/// Asserts that mean and largest value of a stage are within the budget.
pub(crate) fn within(key: &str, meter: &Meter) {
    contains(&format!("{key}.mean"), meter.mean);
    contains(&format!("{key}.max"), meter.max);
}

/// Asserts that a cost is within the budget, on both sides: one that is suddenly much lower is as suspect as
/// one that is higher.
pub(crate) fn contains(key: &str, value: u64) {
    let allowed = bounds(key);
    assert!(
        allowed.contains(&value),
        "{key} = {value} is outside {allowed:?} of tests/budget.toml"
    );
}

fn bounds(key: &str) -> RangeInclusive<u64> {
    static TEXT: LazyLock<String> = LazyLock::new(|| {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/budget.toml");
        fs::read_to_string(path).expect("tests/budget.toml")
    });
    let pair = TEXT
        .lines()
        .find_map(|line| line.strip_prefix(key)?.trim_start().strip_prefix("= ["))
        .and_then(|rest| rest.split_once(']')?.0.split_once(','))
        .unwrap_or_else(|| panic!("no `{key} = [low, high]` in tests/budget.toml"));
    let number = |text: &str| text.trim().replace('_', "").parse().expect(key);
    number(pair.0)..=number(pair.1)
}
