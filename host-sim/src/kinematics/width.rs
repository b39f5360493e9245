//! How much wider than at 1 kHz the windows of local polynomials may be.

use std::iter::successors;

/// Above this rate (Hz) the widest windows of a position in counts last as long as they do at it, so that
/// more samples of the same motion make less noise.
const WIDEST_AT_HZ: f64 = 1000.0;
/// Most samples of a half-width: 10 ms at 20 kHz. A noisy 0.3 Hz stroke at 1 kHz took 60 for its acceleration.
const WIDEST: f64 = 200.0;
/// Each wider window over the next: as 15 over 10.
const WIDER: f64 = 1.5;

/// Half-widths (samples) above the widest one at 1 kHz that a rate asks for, widest first.
pub(super) fn at_rate(rate_hz: f64, own: usize) -> Vec<usize> {
    let most = (own as f64 * rate_hz / WIDEST_AT_HZ).min(WIDEST);
    let least = WIDER.sqrt() * own as f64;
    successors(Some(most), |width| Some(width / WIDER))
        .take_while(|width| *width > least)
        .map(|width| width.round() as usize)
        .collect()
}

/// Half-widths (samples) above the widest one at 1 kHz that a noise may ask for, narrowest first.
pub(super) fn for_noise(own: usize) -> impl Iterator<Item = usize> {
    successors(Some(own as f64 * WIDER), |width| Some(width * WIDER))
        .take_while(|width| *width <= WIDEST)
        .map(|width| width.round() as usize)
}
