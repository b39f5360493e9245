//! The noise of a force from its differences, which slow signals hardly enter.

use crate::gap::thresholds::Floor;
use crate::log::UniformLog;
use crate::signal;
use crate::stats::{rms, rounding_deviation};

/// Sum of the squared weights of second differences, and of fourth ones.
const SECOND: f64 = 6.0;
const FOURTH: f64 = 70.0;

/// The noise of a force from its differences.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct HighPass {
    /// Standard deviation (N).
    pub(super) noise_n: f64,
    /// Whether it comes from fourth differences.
    pub(super) is_fourth: bool,
}

impl HighPass {
    /// From the mean square of the second differences that are no spikes, with the standard deviation of
    /// [`signal::noise`]. That function takes the median, which for a channel with coarse steps is good to half a step
    /// only.
    pub(super) fn second(log: &UniformLog, code_n: f64, spike_sigmas: f64) -> HighPass {
        // Of pink noise of half a code at 5 kHz more than half of the differences are 0; without a line that is no
        // difference at all, and the floor was 0.8 nN of 8 mN.
        let coarse = log.force_noise_n().max(rounding_deviation(code_n));
        let differences = signal::second_differences_of_measured(&log.force_n, &log.in_gap);
        let fine = noise_n(differences, SECOND, spike_sigmas * coarse);
        HighPass {
            noise_n: if fine > 0.0 { fine } else { coarse },
            is_fourth: false,
        }
    }

    /// What second differences would say where nothing moves: fourth ones see a hundredth of a motion of which second
    /// ones see a tenth. Strokes at 200 Hz made the floor 1.9 times what it was, and a stiffening seemed to be noise.
    pub(super) fn beside_motion(self, log: &UniformLog, decide: &Floor) -> HighPass {
        let windows = signal::measured_windows(&log.force_n, &log.in_gap, 5);
        let differences = windows.map(|f| f[0] - 4.0 * (f[1] + f[3]) + 6.0 * f[2] + f[4]);
        let fourth_n = noise_n(differences, FOURTH, decide.spike_sigmas * self.noise_n);
        if fourth_n > 0.0 && self.noise_n > decide.sees_motion * fourth_n {
            HighPass {
                noise_n: fourth_n,
                is_fourth: true,
            }
        } else {
            self
        }
    }
}

/// The standard deviation of the noise with these differences, without spikes.
fn noise_n(differences: impl Iterator<Item = f64>, squares: f64, spike_n: f64) -> f64 {
    let limit = spike_n * squares.sqrt();
    rms(differences.filter(|own| own.abs() <= limit)) / squares.sqrt()
}
