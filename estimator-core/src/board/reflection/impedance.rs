//! The law that a packet holds, no stiffer and no more damped than the master can render.

use super::renderable::{NotRenderable, PACKET_SLOTS};
use crate::maths::scalar::Scalar;
use crate::physics::law::{
    Elastic, HuntCrossley, KelvinVoigt, Law, LawKind, LawState, QuasiLinear, RelaxationMode,
    RelaxingLaw, Zener,
};

/// A law with the parameters of a packet. A Zener material (2) comes as the quasi-linear law (9) with
/// n = 1 and one mode.
pub type Impedance = Law<f32, 2>;

/// What there is to render: an impedance, and where it begins (m).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reflected {
    /// The law.
    pub impedance: Impedance,
    /// The position of the surface (m); master and slave measure from the same zero.
    pub surface_m: f32,
}

/// The state of the law; `None` at rest.
pub(super) type RenderedState = Option<LawState<f32, 2>>;

/// Beyond every material and device, and far within f32 when multiplied.
const LARGEST: f32 = 1e9;
const UNUSED: RelaxationMode<f32> = RelaxationMode {
    fraction: 0.0,
    rate_per_s: 1.0,
};

/// The values of a packet, judged one by one.
struct Values<'a> {
    law: LawKind,
    values: &'a [f32; PACKET_SLOTS],
}

impl Values<'_> {
    #[inline(never)]
    fn within(&self, slot: usize, low: f32, high: f32) -> Result<f32, NotRenderable> {
        let value = self.values.get(slot).copied().unwrap_or(f32::NAN);
        let law = self.law;
        match (low..=high).contains(&value) {
            true => Ok(value),
            false => Err(NotRenderable { law, slot, value }),
        }
    }

    /// One whose estimate may stray below zero where the material has none of it.
    fn not_negative(&self, slot: usize, high: f32) -> Result<f32, NotRenderable> {
        Ok(self.within(slot, -high, high)?.max(0.0))
    }

    fn mode(&self, slot: usize) -> Result<RelaxationMode<f32>, NotRenderable> {
        Ok(RelaxationMode {
            fraction: self.not_negative(slot, 1.0)?,
            rate_per_s: self.within(slot + 1, 0.0, 1e6)?,
        })
    }
}

impl Reflected {
    /// Of the values of a law, in the order of [`LawKind::parameters`].
    pub(super) fn of(
        law: LawKind,
        values: &[f32; PACKET_SLOTS],
        reference_depth_m: f32,
    ) -> Result<Self, NotRenderable> {
        let of = Values { law, values };
        let surface_m = of.within(law.parameters().len() - 1, -LARGEST, LARGEST)?;
        let stiffness_n_per_m = of.within(0, 0.0, LARGEST)?;
        let elastic = |exponent| Elastic::Power {
            stiffness_n_per_m,
            exponent,
            reference_depth_m,
        };
        let exponent = |slot| of.within(slot, 0.3, 5.0);
        let impedance = match law {
            LawKind::KelvinVoigt => Impedance::KelvinVoigt(KelvinVoigt {
                stiffness_n_per_m,
                damping_ns_per_m: of.not_negative(1, LARGEST)?,
            }),
            LawKind::HuntCrossley | LawKind::HuntCrossleySkew => {
                Impedance::HuntCrossley(HuntCrossley::new(
                    stiffness_n_per_m,
                    of.not_negative(1, LARGEST)?,
                    exponent(2)?,
                    reference_depth_m,
                ))
            }
            LawKind::Zener => {
                let law = Zener {
                    stiffness_n_per_m,
                    second_stiffness_n_per_m: of.not_negative(1, LARGEST)?,
                    // Without it there is no time in which it relaxes.
                    damping_ns_per_m: of.within(2, 1e-3, LARGEST)?,
                };
                // Two springs of no stiffness share nothing.
                let modes = match stiffness_n_per_m > 0.0 {
                    true => [law.mode(), UNUSED],
                    false => [UNUSED; 2],
                };
                let elastic = elastic(1.0);
                Impedance::QuasiLinear(QuasiLinear { elastic, modes })
            }
            LawKind::QuasiLinear | LawKind::QuasiLinear2 => {
                let second = match law {
                    LawKind::QuasiLinear2 => of.mode(4)?,
                    _ => UNUSED,
                };
                let (elastic, modes) = (elastic(exponent(1)?), [of.mode(2)?, second]);
                Impedance::QuasiLinear(QuasiLinear { elastic, modes })
            }
        };
        Ok(Reflected {
            impedance,
            surface_m,
        })
    }
}

/// The law with stiffness and damping times a factor: Colgate's impedance shaping.
fn shaped(mut law: Impedance, by: f32) -> Impedance {
    match &mut law {
        Law::KelvinVoigt(law) => {
            law.stiffness_n_per_m *= by;
            law.damping_ns_per_m *= by;
        }
        Law::HuntCrossley(law) => {
            law.stiffness_n_per_m *= by;
            law.damping_ns_per_m *= by;
        }
        Law::QuasiLinear(law) => {
            let (Elastic::Power {
                stiffness_n_per_m, ..
            }
            | Elastic::Exponential {
                stiffness_n_per_m, ..
            }) = &mut law.elastic;
            *stiffness_n_per_m *= by;
        }
        // Comes in no packet.
        Law::Zener(_) | Law::Free => {}
    }
    law
}

/// The elastic part Kδ₀(δ/δ₀)ⁿ and the damping λ(δ/δ₀)^q.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Parts {
    /// K (N/m)
    stiffness: f32,
    /// n
    n: f32,
    /// δ₀ (m)
    reference_m: f32,
    /// λ (N s/m); a law that relaxes is a spring at first, and has none.
    damping: f32,
    /// q
    q: f32,
}

impl Parts {
    fn of(law: &Impedance) -> Parts {
        let parts = law.parts(1.0);
        let (stiffness, n, reference_m) = match parts.elastic {
            Some(Elastic::Power {
                stiffness_n_per_m,
                exponent,
                reference_depth_m,
            }) => (stiffness_n_per_m, exponent, reference_depth_m),
            // Comes in no packet.
            Some(Elastic::Exponential { .. }) | None => (0.0, 1.0, 1.0),
        };
        let (damping, q) = parts
            .damping
            .map_or((0.0, 0.0), |own| (own.coefficient_ns_per_m, own.exponent));
        Parts {
            stiffness,
            n,
            reference_m,
            damping,
            q,
        }
    }
}

/// A power. Never inlined: it takes 250 bytes of flash each time, and it is needed when a packet comes
/// or a limit holds.
#[inline(never)]
fn power(base: f32, exponent: f32) -> f32 {
    base.pow_positive(exponent)
}

/// An impedance that is rendered as it is, up to a stiffness and a damping; beyond them it is rendered
/// as if at a smaller depth and a lower speed, where it has just these.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bounded {
    law: Impedance,
    parts: Parts,
    surface_m: f32,
    /// The largest slope of the elastic part (N/m).
    stiffest: f32,
    /// The depth at which the slope is as large (m), and the elastic force there (N). For n < 1, where
    /// the slope falls with the depth, it is that of the secant.
    knee_m: f32,
    knee_n: f32,
    /// The depth at which the damping is as large as can be rendered (m).
    damped_m: f32,
    /// The share of a damping that is the same everywhere which can be rendered.
    damped_share: f32,
}

impl Bounded {
    /// The impedance within the largest stiffness (N/m) and damping (N s/m) that the master can render,
    /// both above 0.
    #[inline(never)]
    pub(super) fn new(of: Reflected, shaping: f32, stiffest: f32, most_damping: f32) -> Self {
        let law = shaped(of.impedance, shaping);
        let parts = Parts::of(&law);
        let Parts {
            stiffness,
            n,
            reference_m,
            damping,
            q,
        } = parts;
        let knee_m = if n > 1.0 {
            // nK(δ/δ₀)^(n−1) = stiffest
            reference_m * power(stiffest / (n * stiffness), 1.0 / (n - 1.0))
        } else if n < 1.0 {
            // K(δ/δ₀)^(n−1) = stiffest
            reference_m * power(stiffest / stiffness, 1.0 / (n - 1.0))
        } else if stiffness > stiffest {
            0.0
        } else {
            f32::INFINITY
        };
        let damped_m = match q > 0.0 {
            true => reference_m * power(most_damping / damping, 1.0 / q),
            false => f32::INFINITY,
        };
        Bounded {
            law,
            parts,
            surface_m: of.surface_m,
            stiffest,
            knee_m,
            knee_n: match knee_m.is_finite() {
                true => stiffness * reference_m * power(knee_m / reference_m, n),
                false => 0.0,
            },
            damped_m,
            damped_share: match q > 0.0 || damping <= most_damping {
                true => 1.0,
                false => most_damping / damping,
            },
        }
    }

    /// Force on the master (N), and whether stiffness and damping were limited.
    pub(super) fn force_n(
        &self,
        state: &mut RenderedState,
        position_m: f32,
        speed_mps: f32,
        period_s: f32,
    ) -> (f32, bool, bool) {
        let depth_m = position_m - self.surface_m;
        let rendered_m = self.depth_within(depth_m);
        let rendered_mps = speed_mps * self.share_of_damping(rendered_m);
        let state = state.get_or_insert(self.law.at_rest());
        let force_n = self.law.step(state, rendered_m, rendered_mps, period_s);
        (force_n, rendered_m < depth_m, rendered_mps != speed_mps)
    }

    /// The depth at which the law has the force that it would have had, had its slope stayed within
    /// the bound.
    fn depth_within(&self, depth_m: f32) -> f32 {
        let Parts {
            stiffness,
            n,
            reference_m,
            ..
        } = self.parts;
        let rising = n >= 1.0;
        if depth_m <= 0.0 || rising == (depth_m <= self.knee_m) {
            return depth_m;
        }
        let bounded_n = match rising {
            true => self.knee_n + self.stiffest * (depth_m - self.knee_m),
            false => self.stiffest * depth_m,
        };
        let rendered_m = match n == 1.0 {
            true => bounded_n / stiffness,
            false => reference_m * power(bounded_n / (stiffness * reference_m), 1.0 / n),
        };
        rendered_m.min(depth_m)
    }

    fn share_of_damping(&self, depth_m: f32) -> f32 {
        match depth_m > self.damped_m {
            true => power(self.damped_m / depth_m, self.parts.q),
            false => self.damped_share,
        }
    }
}
