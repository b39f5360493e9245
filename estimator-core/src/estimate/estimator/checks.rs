//! Which samples are used, and which are learned from.

use crate::estimate::{fault::Fault, fault::Faults, params::Params, sample::Sample};
use crate::maths::scalar::Real;

/// Largest force and position of a usable sample, over the reference force and depth: beyond it,
/// squares would leave the range of single precision.
pub const RANGE: f64 = 1e6;
/// Faults with which a sample is dropped.
pub(super) const DROPPED: Faults = Faults::NONE
    .with(Fault::ForceUnusable)
    .with(Fault::PositionUnusable)
    .with(Fault::TimeNotAdvancing);
/// Faults with which a sample goes through filters and contact detection, but is not learned from, for
/// as long as the filter remembers it.
pub(super) const NOT_LEARNED_FROM: Faults = Faults::NONE
    .with(Fault::SampleMissed)
    .with(Fault::ForceSaturated)
    .with(Fault::ForceStuck)
    .with(Fault::PositionJump)
    .with(Fault::PositionStuck);

/// The faults of a sample: those that its reader reports, and those that are found here.
pub(super) fn faults<T: Real>(params: &Params<T>, sample: &Sample<T>, elapsed_us: u64) -> Faults {
    let mut faults = sample.faults;
    if !within_range(sample.force_n, params.identify.scale.force_n) {
        faults = faults.with(Fault::ForceUnusable);
    }
    if !within_range(sample.position_m, params.identify.scale.depth_m) {
        faults = faults.with(Fault::PositionUnusable);
    }
    if elapsed_us == 0 {
        faults = faults.with(Fault::TimeNotAdvancing);
    }
    if is_gap(params, elapsed_us) && !faults.intersects(DROPPED) {
        faults = faults.with(Fault::SampleMissed);
    }
    faults
}

/// Whether samples are missing: more than 1.5 periods have elapsed.
pub(super) fn is_gap<T: Real>(params: &Params<T>, elapsed_us: u64) -> bool {
    elapsed_us > params.period_us + params.period_us / 2
}

fn within_range<T: Real>(value: T, reference: T) -> bool {
    value.abs() < T::from_f64(RANGE) * reference
}
