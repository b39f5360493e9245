//! The chapter's state-variable filter: a second-order low-pass whose second state is the speed.

use super::{aligned::Aligned, response::Response};
use crate::estimate::sample::Sample;
use crate::maths::scalar::Real;

/// Coefficients of the filter ω²/(s² + 2ζωs + ω²) with trapezoidal integrators, g = tan(ωT/2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StateVariableParams<T> {
    g: T,
    a1: T,
    a2: T,
    a3: T,
    /// 2g/T, the rate of the low-pass output over the band-pass state (1/s).
    to_rate: T,
    response: Response<T>,
}

impl<T: Real> StateVariableParams<T> {
    pub(crate) fn new(cutoff_hz: f32, damping_ratio: f32, rate_hz: f32) -> Self {
        let (rate, damping) = (f64::from(rate_hz), f64::from(damping_ratio));
        let omega = core::f64::consts::TAU * f64::from(cutoff_hz);
        let g = libm::tan(0.5 * omega / rate);
        let k = 2.0 * damping;
        let a1 = 1.0 / (1.0 + g * (g + k));
        let delay_s = k / omega;
        // (1/π)∫|H|² over the unit circle, with the frequency warping of the bilinear transform.
        let noise_gain = g * (1.0 + k * g) / (k * (1.0 + k * g + g * g));
        StateVariableParams {
            g: T::from_f64(g),
            a1: T::from_f64(a1),
            a2: T::from_f64(g * a1),
            a3: T::from_f64(g * g * a1),
            to_rate: T::from_f64(2.0 * g * rate),
            response: Response {
                delay_us: (1e6 * delay_s) as u64,
                // A step is forgotten to 1 % after 3.3 delays at ζ = 1.
                memory_samples: (4.0 * delay_s * rate) as u32 + 1,
                noise_gain: T::from_f64(noise_gain),
                noise_amplitude: T::from_f64(noise_gain).sqrt(),
            },
        }
    }

    pub(super) fn response(&self) -> &Response<T> {
        &self.response
    }
}

/// The two integrators of one channel.
#[derive(Clone, Copy, Debug, Default)]
struct Channel<T> {
    band: T,
    low: T,
}

impl<T: Real> Channel<T> {
    /// Takes one input; gives the low-pass output and its rate.
    fn update(&mut self, p: &StateVariableParams<T>, input: T) -> (T, T) {
        let difference = input - self.low;
        let band = p.a1 * self.band + p.a2 * difference;
        let low = self.low + p.a2 * self.band + p.a3 * difference;
        self.band = band + band - self.band;
        self.low = low + low - self.low;
        (low, band * p.to_rate)
    }
}

/// Passes position and force through the same second-order low-pass, so that both have the same
/// delay: 2ζ/ω at low frequencies, 8 ms at 40 Hz. The speed is the exact rate, by the trapezoidal rule,
/// of the filtered position.
#[derive(Clone, Copy, Debug, Default)]
pub struct StateVariable<T> {
    position: Channel<T>,
    force: Channel<T>,
    started: bool,
}

impl<T: Real> StateVariable<T> {
    /// Sets the integrators to the steady state at this sample.
    pub fn restart(&mut self, sample: &Sample<T>) {
        self.position = Channel {
            band: T::zero(),
            low: sample.position_m,
        };
        self.force = Channel {
            band: T::zero(),
            low: sample.force_n,
        };
        self.started = true;
    }

    /// Takes one sample and gives the filtered signals.
    pub fn update(&mut self, params: &StateVariableParams<T>, sample: &Sample<T>) -> Aligned<T> {
        if !self.started {
            self.restart(sample);
        }
        let (position_m, speed_mps) = self.position.update(params, sample.position_m);
        let (force_n, force_rate_nps) = self.force.update(params, sample.force_n);
        Aligned {
            position_m,
            speed_mps,
            force_n,
            force_rate_nps,
            ..Aligned::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn params() -> StateVariableParams<f64> {
        StateVariableParams::new(40.0, 1.0, 1000.0)
    }

    fn at(position_m: f64, force_n: f64) -> Sample<f64> {
        Sample {
            position_m,
            force_n,
            ..Sample::default()
        }
    }

    #[test]
    fn a_ramp_comes_out_late_by_the_stated_delay_and_with_its_speed() {
        let p = params();
        let mut filter = StateVariable::default();
        let mut out = Aligned::default();
        for i in 0..1000 {
            out = filter.update(&p, &at(0.02 * f64::from(i) * 1e-3, 0.0));
        }
        // 2ζ/ω = 7.958 ms; the bilinear warp at 40 Hz changes it by 0.5 %.
        let late_s = 0.999 - out.position_m / 0.02;
        assert!((late_s - 7.958e-3).abs() < 0.06e-3, "{late_s}");
        assert!((out.speed_mps - 0.02).abs() < 1e-9);
        assert_eq!(p.response.delay_us, 7957);
    }

    #[test]
    fn the_noise_gain_is_the_energy_of_the_impulse_response() {
        let p = params();
        let mut filter = StateVariable::default();
        filter.update(&p, &at(0.0, 0.0));
        let energy: f64 = (0..2000)
            .map(|i| {
                filter
                    .update(&p, &at(0.0, if i == 0 { 1.0 } else { 0.0 }))
                    .force_n
            })
            .map(|h| h * h)
            .sum();
        assert!(
            (energy / p.response.noise_gain - 1.0).abs() < 0.01,
            "{energy} {}",
            p.response.noise_gain
        );
    }

    #[test]
    fn it_starts_at_the_first_sample_without_a_transient() {
        let mut filter = StateVariable::default();
        let out = filter.update(&params(), &at(0.3, -2.0));
        assert_eq!(
            (out.position_m, out.speed_mps, out.force_n),
            (0.3, 0.0, -2.0)
        );
    }
}
