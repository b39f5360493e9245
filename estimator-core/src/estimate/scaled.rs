//! The aligned signals in the scales of the estimators, with what is uncertain about them.

use crate::estimate::{
    Phase, contact::COUNT_ERROR, contact::Contact, filter::Aligned, identify::ForceNoise,
    identify::Instant, params::Params,
};
use crate::maths::scalar::{Real, seconds};

/// Largest number of samples that one count of the encoder is assumed to last, which bounds what a
/// hold is worth. A ramp of half a count a sample lasts two seconds: with 256 the damping of a plastic was 13 % off
/// at a claimed 3.8 %.
const LONGEST_COUNT: f64 = 1024.0;
/// Smallest standard error of a surface from an impact, over the reference depth: 5 µm at 1 mm.
const IMPACT_FLOOR: f64 = 5e-3;

/// Standard error of the surface position, scaled. It is at least [`IMPACT_FLOOR`] for an impact, and
/// the quantization error of the encoder for a configured surface.
fn surface_error<T: Real>(params: &Params<T>, contact: &Contact<T>) -> T {
    let depth_m = params.identify.scale.depth_m;
    if params.contact.surface_known() {
        return contact.count_m * T::from_f64(COUNT_ERROR) / depth_m;
    }
    let impact = contact.surface.unwrap_or_default().std_error_m / depth_m;
    impact.max_of(T::from_f64(IMPACT_FLOOR))
}

/// The aligned signals in the scales of the estimators.
pub(crate) fn scaled<T: Real>(
    params: &Params<T>,
    aligned: &Aligned<T>,
    contact: &Contact<T>,
    elapsed_us: u64,
    speed_error: T,
    last_speed_mps: T,
) -> Instant<T> {
    let scale = &params.identify.scale;
    let surface_m = match contact.surface {
        Some(surface) => surface.position_m,
        None => aligned.position_m,
    };
    Instant {
        depth: (aligned.position_m - surface_m) / scale.depth_m,
        speed: aligned.speed_mps / scale.speed_mps,
        force: (aligned.force_n - contact.resting_force_n) / scale.force_n,
        surface: surface_m / scale.depth_m,
        surface_error: surface_error(params, contact),
        position_variance: aligned.position_variance_m2 / (scale.depth_m * scale.depth_m),
        position_velocity_cov: aligned.position_velocity_cov_m2ps
            / (scale.depth_m * scale.speed_mps),
        elapsed_s: seconds(elapsed_us),
        rate: aligned.force_rate_nps * scale.depth_m / (scale.speed_mps * scale.force_n),
        quantization_variance: quantization_variance_m2(params, aligned, contact, last_speed_mps)
            / (scale.depth_m * scale.depth_m),
        rest_error: contact.resting_force_error_n / scale.force_n,
        rest_drift: contact.resting_force_drift_n / scale.force_n,
        loaded: T::from_u32(contact.loaded_samples),
        speed_error,
        noise: force_noise(params, contact),
    }
}

/// Variance of the position of an instant by the counts q of the encoder (m²): q²/12, times the number of
/// samples that an error of rounding lasts, since all of them have the same one.
fn quantization_variance_m2<T: Real>(
    params: &Params<T>,
    aligned: &Aligned<T>,
    contact: &Contact<T>,
    last_speed_mps: T,
) -> T {
    let count_m = contact.count_m;
    if contact.phase != Phase::Contact || count_m <= T::zero() {
        return T::zero();
    }
    let per_sample = params.period_s / count_m;
    let counts = aligned.speed_mps.abs() * per_sample;
    let change = (aligned.speed_mps - last_speed_mps).abs() * per_sample;
    // A mean of several readings in a sample has the error of a count at rest, and that of its own steps from a count
    // a sample on: the first harmonic of rounding goes with sin(πv)/(πv), which 1 − v² covers.
    let whole_m = count_m * (T::one() - counts * counts);
    let error_m = contact.position_step_m.max_of(whole_m) * T::from_f64(COUNT_ERROR);
    error_m * error_m * rounding_lasts(counts, change)
}

/// Number of samples that an error of rounding lasts at a speed in counts per sample that changes by so much
/// from sample to sample. At a whole number of counts per sample every sample is rounded alike, as at rest,
/// and at halves two errors take turns, of which a quarter of the variance stays. Ramps of 2 mm/s and counts
/// of 1 µm left the damping of a stiff material 17 % off at a claimed 2.6 %.
fn rounding_lasts<T: Real>(counts: T, change: T) -> T {
    let lasts = |counts: T, change: T| {
        let apart = (counts - counts.nearest()).abs() + T::from_f64(1.0 / LONGEST_COUNT);
        // A speed that changes leaves the phase after 1/√change samples.
        apart / (apart * apart + change) - T::one()
    };
    let two = T::from_f64(2.0);
    let alike = lasts(counts, change);
    let in_turn = T::from_f64(0.25) * lasts(two * counts, two * change);
    // Slower than a count per sample, however the speed changes.
    let slow = T::one() / (counts + T::from_f64(1.0 / LONGEST_COUNT));
    T::one().max_of(alike).max_of(in_turn).max_of(slow)
}

/// Standard deviations of the raw and of the filtered force, scaled.
fn force_noise<T: Real>(params: &Params<T>, contact: &Contact<T>) -> ForceNoise<T> {
    let raw = contact.force_noise_n / params.identify.scale.force_n;
    ForceNoise {
        raw,
        filtered: raw * params.filter.response().noise_amplitude,
    }
}
