//! The low-pass that a force went through before it was logged, along the instants of a fit.
//!
//! Each pole p of a filter keeps a number z of its own, ż = pz + u, and what comes out is Re Σ rz with its residue r.
//! Butterworth's have m poles on a circle of 2πf; those of Bessel's have nearly the same delay at every frequency, as a moving
//! mean and most filters of finite length do. Between two nodes the force is a straight line, for which a step of z is exact,
//! however far apart they are. Order 1 is an RC element or an exponential mean. Both ways, forth and back, it has no delay.

use std::f64::consts::{PI, TAU};

use estimator_core::maths::scalar::Scalar;
use rustfft::num_complex::Complex;

/// Below this |ph| a step is a series, whose first omitted terms are (ph)³/120.
const SMALL: f64 = 1e-3;
/// Most poles above or on the real axis.
const MOST_POLES: usize = 2;

/// Poles of Bessel's filters of second and fourth order whose power is a half at 1 rad/s, those above the real axis.
const BESSEL_2: [(f64, f64); 1] = [(-1.101_601_3, 0.636_009_8)];
const BESSEL_4: [(f64, f64); 2] = [(-1.370_067_8, 0.410_249_7), (-0.995_208_8, 1.257_105_7)];

/// After whom a filter is called.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Shape {
    Butterworth,
    Bessel,
}

impl Shape {
    /// Its name in files.
    pub(super) const fn name(self) -> &'static str {
        match self {
            Shape::Butterworth => "butterworth",
            Shape::Bessel => "bessel",
        }
    }
}

/// A kind of low-pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Kind {
    /// After whom.
    pub(super) shape: Shape,
    /// The number of poles: 1 to 4 after Butterworth, 2 or 4 after Bessel.
    pub(super) order: u32,
    /// Whether it was applied forth and back, without delay.
    pub(super) both_ways: bool,
}

impl Kind {
    /// After Butterworth.
    pub(super) const fn butterworth(order: u32, both_ways: bool) -> Kind {
        Kind {
            shape: Shape::Butterworth,
            order,
            both_ways,
        }
    }

    /// After Bessel.
    pub(super) const fn bessel(order: u32, both_ways: bool) -> Kind {
        Kind {
            shape: Shape::Bessel,
            order,
            both_ways,
        }
    }
}

/// A low-pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LowPass {
    /// Where the power is a half, of one way (Hz).
    pub(super) corner_hz: f64,
    pub(super) kind: Kind,
}

/// A pole, its residue (doubled for the pair that it stands for), and its step over a period.
#[derive(Clone, Copy, Debug, Default)]
struct Pole {
    pole: Complex<f64>,
    residue: Complex<f64>,
    /// e^{ph}, and what the force before and its change over the step bring.
    keeps: Complex<f64>,
    before: Complex<f64>,
    change: Complex<f64>,
}

impl Pole {
    fn over(mut self, period_s: f64) -> Pole {
        let way = self.pole * period_s;
        self.keeps = way.exp();
        let (before, change) = match way.norm() < SMALL {
            true => (
                1.0 + way / 2.0 + way * way / 6.0,
                0.5 + way / 6.0 + way * way / 24.0,
            ),
            false => (
                (self.keeps - 1.0) / way,
                (self.keeps - 1.0 - way) / (way * way),
            ),
        };
        self.before = before * period_s;
        self.change = change * period_s;
        self
    }
}

impl LowPass {
    /// Of a kind, with a power of a half at `corner_hz`.
    pub(super) fn of_power(corner_hz: f64, kind: Kind) -> LowPass {
        // Forth and back that is where one way has 1/√2.
        let higher = match (kind.both_ways, kind.shape) {
            (true, Shape::Butterworth) => (2f64.sqrt() - 1.0).powf(-0.5 / f64::from(kind.order)),
            // Nearly Gauss's.
            (true, Shape::Bessel) => 2f64.sqrt(),
            (false, _) => 1.0,
        };
        LowPass {
            corner_hz: higher * corner_hz,
            kind,
        }
    }

    /// The same with its corner moved by a factor.
    pub(super) fn moved(self, factor: f64) -> LowPass {
        LowPass {
            corner_hz: factor * self.corner_hz,
            ..self
        }
    }

    /// By how much it delays what is slow (s).
    pub(super) fn delay_s(self) -> f64 {
        if self.kind.both_ways {
            return 0.0;
        }
        self.all().map(|pole| -pole.inv().re).sum()
    }

    /// Its name.
    pub(super) fn title(self) -> String {
        let Kind {
            shape,
            order,
            both_ways,
        } = self.kind;
        let after = match shape {
            Shape::Butterworth if order == 1 => "of first order".into(),
            Shape::Butterworth => format!("of order {order} after Butterworth"),
            Shape::Bessel => format!("of order {order} after Bessel"),
        };
        match both_ways {
            true => format!("{after}, forth and back"),
            false => after,
        }
    }

    /// The poles (rad/s) above the real axis, and on it.
    fn upper(self) -> impl Iterator<Item = Complex<f64>> {
        let order = f64::from(self.kind.order);
        let butterworth = move |k: u32| {
            let angle = PI * (2.0 * f64::from(k) + order - 1.0) / (2.0 * order);
            // The middle one of an odd order is real.
            let is_real = 2 * k == self.kind.order + 1;
            (angle.cos(), if is_real { 0.0 } else { angle.sin() })
        };
        let bessel = move |k: u32| match self.kind.order {
            2 => BESSEL_2[k as usize - 1],
            _ => BESSEL_4[k as usize - 1],
        };
        (1..=self.kind.order.div_ceil(2)).map(move |k| {
            let (re, im) = match self.kind.shape {
                Shape::Butterworth => butterworth(k),
                Shape::Bessel => bessel(k),
            };
            TAU * self.corner_hz * Complex::new(re, im)
        })
    }

    /// All of them.
    fn all(self) -> impl Iterator<Item = Complex<f64>> {
        let both = |pole: Complex<f64>| {
            let other = (pole.im > 0.0).then_some(pole.conj());
            std::iter::once(pole).chain(other)
        };
        self.upper().flat_map(both)
    }

    fn poles(self) -> [Pole; MOST_POLES] {
        let mut poles = [Pole::default(); MOST_POLES];
        let gain: Complex<f64> = self.all().map(|pole| -pole).product();
        for (own, pole) in poles.iter_mut().zip(self.upper()) {
            let others = self.all().filter(|other| *other != pole);
            let apart: Complex<f64> = others.map(|other| pole - other).product();
            let count = if pole.im > 0.0 { 2.0 } else { 1.0 };
            own.pole = pole;
            own.residue = gain / apart * count;
        }
        poles
    }

    /// Passes forces (N) through the filter, which has rested at the first of them; each so long (s) after the one before.
    pub(super) fn through<S: Scalar>(self, forces: &mut [S], period_s: impl Fn(usize) -> f64) {
        let places = 0..forces.len();
        self.one_way(forces, places.clone(), &period_s);
        if self.kind.both_ways {
            self.one_way(forces, places.rev(), |at| period_s(at + 1));
        }
    }

    fn one_way<S: Scalar>(
        self,
        forces: &mut [S],
        order: impl Iterator<Item = usize>,
        period_s: impl Fn(usize) -> f64,
    ) {
        let number = S::from_f64;
        let mut poles = self.poles();
        let used = self.kind.order.div_ceil(2) as usize;
        let mut states = [[S::zero(); 2]; MOST_POLES];
        let mut before: Option<S> = None;
        let mut last_s = 0.0;
        for at in order {
            let force = forces[at];
            let Some(was) = before.replace(force) else {
                // At rest z = −u/p.
                for (state, own) in states.iter_mut().zip(&poles).take(used) {
                    let rest = -own.pole.inv();
                    *state = [force * number(rest.re), force * number(rest.im)];
                }
                continue;
            };
            let step_s = period_s(at);
            if (step_s - last_s).abs() > 1e-9 * step_s {
                last_s = step_s;
                for own in poles.iter_mut().take(used) {
                    *own = own.over(step_s);
                }
            }
            let change = force - was;
            let mut out = S::zero();
            for (state, own) in states.iter_mut().zip(&poles).take(used) {
                let [re, im] = *state;
                let part = |keeps: [f64; 2], before: f64, changes: f64| {
                    re * number(keeps[0])
                        + im * number(keeps[1])
                        + was * number(before)
                        + change * number(changes)
                };
                let (keeps, own_before, own_change) = (own.keeps, own.before, own.change);
                *state = [
                    part([keeps.re, -keeps.im], own_before.re, own_change.re),
                    part([keeps.im, keeps.re], own_before.im, own_change.im),
                ];
                out = out + state[0] * number(own.residue.re) - state[1] * number(own.residue.im);
            }
            forces[at] = out;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Amplitude and phase (rad) of a sine of 10 Hz behind a filter of 20 Hz, by least squares over its last second.
    fn response(kind: Kind) -> (f64, f64) {
        // Steps of 0.5 and 1 ms.
        let period_s = |at: usize| 5e-4 * (1 + at % 2) as f64;
        let times_s: Vec<f64> = (0..4000)
            .scan(0.0, |time_s, at| {
                *time_s += period_s(at);
                Some(*time_s)
            })
            .collect();
        let omega = TAU * 10.0;
        let mut forces: Vec<f64> = times_s.iter().map(|own| (omega * own).sin()).collect();
        let own = LowPass {
            corner_hz: 20.0,
            kind,
        };
        own.through(&mut forces, period_s);
        let (mut sine, mut cosine, mut count) = (0.0, 0.0, 0.0);
        for ((at, time_s), force) in times_s.into_iter().enumerate().zip(forces) {
            if (1.0..2.0).contains(&time_s) {
                let weight = period_s(at);
                sine += weight * force * (omega * time_s).sin();
                cosine += weight * force * (omega * time_s).cos();
                count += weight;
            }
        }
        let (sine, cosine) = (2.0 * sine / count, 2.0 * cosine / count);
        (sine.hypot(cosine), cosine.atan2(sine))
    }

    #[test]
    fn a_sine_comes_out_as_butterworths_filter_has_it() {
        for order in 1..=4 {
            let power = 1.0 / (1.0 + 0.5f64.powi(2 * order as i32));
            let (amplitude, phase) = response(Kind::butterworth(order, false));
            // Straight lines between nodes take (ωh)²/12 off, 3·10⁻⁴.
            assert!(
                (amplitude - power.sqrt()).abs() < 1e-3,
                "{order}: {amplitude}"
            );
            assert!(phase < -0.3, "{order}: {phase}");
            let (amplitude, phase) = response(Kind::butterworth(order, true));
            assert!((amplitude - power).abs() < 1e-3, "{order}: {amplitude}");
            assert!(phase.abs() < 2e-3, "{order}: {phase}");
        }
        // Half way to its corner one pole is arctan ½ late.
        let (_, phase) = response(Kind::butterworth(1, false));
        assert!((phase + 0.5f64.atan()).abs() < 1e-3, "{phase}");
    }

    #[test]
    fn bessels_filters_have_half_of_the_power_at_their_corner_and_one_delay() {
        for order in [2, 4] {
            let kind = Kind::bessel(order, false);
            let own = LowPass {
                corner_hz: 20.0,
                kind,
            };
            let expected = |hz: f64| -> Complex<f64> {
                let each = |pole: Complex<f64>| -pole / (Complex::new(0.0, TAU * hz) - pole);
                own.all().map(each).product()
            };
            assert!((expected(20.0).norm_sqr() - 0.5).abs() < 1e-5, "{order}");
            let delay_s = -expected(2.0).arg() / (TAU * 2.0);
            assert!(
                (delay_s / own.delay_s() - 1.0).abs() < 1e-4,
                "{order}: {delay_s}"
            );
            let (amplitude, _) = response(kind);
            let expected = expected(10.0).norm();
            assert!((amplitude - expected).abs() < 1e-3, "{order}: {amplitude}");
        }
    }

    #[test]
    fn a_ramp_is_late_by_the_delay_and_a_rest_stays() {
        for order in 1..=4 {
            let own = LowPass {
                corner_hz: 5.0,
                kind: Kind::butterworth(order, false),
            };
            let mut forces: Vec<f64> = (0..3000).map(|at| 1e-3 * f64::from(at)).collect();
            own.through(&mut forces, |_| 1e-3);
            let late_s = 2.999 - forces[2999];
            assert!((late_s - own.delay_s()).abs() < 1e-9, "{order}: {late_s}");
            let mut rest = vec![0.7; 3000];
            own.through(&mut rest, |_| 1e-3);
            assert!(rest.iter().all(|own| (own - 0.7).abs() < 1e-12));
        }
    }
}
