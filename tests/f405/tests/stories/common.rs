//! What several stories need.

use estimator_core::Status;
use f405::bench::Bench;
use f405::chip::{Part, UNITS_PER_SECOND};
use f405::elf::Image;
use f405::world::{Material, Press, Strokes};
use std::sync::Arc;

/// A board whose probe presses into a material again and again, from 0.8 s on.
pub(crate) fn pressing(image: Arc<Image>, part: Part, material: Material, seed: u64) -> Bench {
    let motion = Strokes::random(seed, 0.8, 1000.0, Strokes::depths(material));
    Bench::new(image, part, Box::new(Press::new(motion, material, seed)))
}

/// K, λ and n of the last estimate that had converged.
pub(crate) fn identified(bench: &Bench) -> Option<[f64; 3]> {
    let (_, last) = bench
        .estimates()
        .rev()
        .find(|(_, estimate)| estimate.status == Status::Converged)?;
    let mut values = [0.0; 3];
    for (value, slot) in values.iter_mut().zip(&last.parameters) {
        *value = f64::from((*slot)?.value);
    }
    Some(values)
}

/// Nothing happened that the model does not have.
pub(crate) fn within_the_model(bench: &Bench) {
    let trace = &bench.machine.chip.trace;
    assert!(
        trace.undefined.is_empty() && trace.unmapped.is_empty(),
        "the model lacks instructions {:x?} or addresses {:x?}",
        trace.undefined,
        trace.unmapped
    );
}

/// Seconds of units.
pub(crate) fn seconds(units: u64) -> f64 {
    units as f64 / UNITS_PER_SECOND as f64
}
