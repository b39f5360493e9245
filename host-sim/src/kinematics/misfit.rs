//! What a polynomial may leave of a position.

/// How often a true polynomial leaves no more than is allowed: all but 3 % of a normal distribution's.
const PASSES: f64 = 1.86;

/// The least that any window may leave: the errors of counts repeat with the motion, and 151 samples of them are
/// not as near their mean as white noise would be. With 1.11 half of the widest windows failed at 5 kHz,
/// and the speed was ten times as noisy as with 1.25.
const LEAST: f64 = 1.25;

/// What a polynomial may leave of the position, in standard deviations of its noise, rms: √(χ²/f) of f degrees
/// of freedom as Wilson & Hilferty have it. 1.25 of the widest cubic, 2.1 of one degree: a limit for all made
/// narrow windows fail by chance, one after the other, down to three samples and 0.2 mm/s of noise.
pub(super) fn within(freedom: f64) -> f64 {
    let share = 2.0 / (9.0 * freedom);
    (1.0 - share + PASSES * share.sqrt()).powf(1.5).max(LEAST)
}
